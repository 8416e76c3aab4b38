//! Finds the cause of a problem and the remedies that remove it. It uses plain data only.
//!
//! A step above the stability limit needs shorter steps. Steps that cost too much need to be longer, if these are still below the
//! limit, or a coarser mesh. The steps that the guard adds do not count as this cost. A model that does not resist inversion needs
//! another model, or the compression effect.

use super::panels::View;
use crate::{
    command::{Command, Mode},
    effects::{Compression, EffectKind},
    fault,
    integrators::{Class, IntegratorKind},
    level::{EffectLevel, Substeps, Switch, Toggle, When},
    materials::Model,
    meshes::MeshKind,
    quantity::{Cells, Rings, Triangles},
    snapshot::{Field, Snapshot},
};

/// Time of stepping in a frame above which simulated time becomes slow \[s\].
const MUCH: f64 = 0.009;

/// Ratio of the steps computed to undivided steps above which the guard is the cause of slowness.
const DIVIDED: f64 = 1.2;

/// Safety factor between recommended steps and the stability limit.
const MARGIN: f64 = 1.2;

/// Kinds of problems that have remedies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Trouble {
    /// Triangles are inverted.
    Inverted,
    /// A body is many times as large as at rest.
    Exploded,
    /// Stepping stopped with a fault.
    Fault(fault::Cause),
    /// Simulated time runs slower than real time.
    Slow(Load),
}

/// Cost of stepping in a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load {
    /// Time spent on stepping in a frame \[s\].
    pub physics: f64,
    /// Ratio of the steps computed to undivided steps: above 1 the guard divides steps or takes them again.
    pub effort: f64,
}

/// The longest stable step of a scheme.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Limit {
    /// Not measured yet.
    Unknown,
    /// The scheme has no limit.
    Nothing,
    /// The limit \[s\]; 0 if no step is stable.
    Step(f64),
}

/// Facts about a scene that determine a cause.
#[derive(Clone, Debug)]
pub struct Facts {
    /// Number of steps in 1/60 s.
    pub substeps: Substeps,
    /// The longest stable step at rest.
    pub limit: Limit,
    /// Class of the scheme, which determines what limits its step.
    pub class: Class,
    /// Whether multirate stepping is on: each body takes as many substeps as it needs.
    pub multirate: bool,
    /// Whether the guard is on.
    pub guard: bool,
    /// Whether a body has a model that does not resist inversion, without an active compression effect.
    pub weak: bool,
    /// Whether all models are shown side by side, so that none can be chosen.
    pub side_by_side: bool,
    /// Whether fewer triangles are inverted at the start.
    pub better_start: bool,
    /// A coarser mesh for the largest body: its number, the mesh, and the approximate number of triangles.
    pub coarser: Option<(usize, MeshKind, usize)>,
    /// Whether colours, edges or vertices are drawn.
    pub decorated: bool,
}

/// Causes of problems.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cause {
    /// The step is above the stability limit.
    StepTooLong {
        /// Length of the step \[s\].
        step: f64,
        /// Longest stable step \[s\].
        limit: f64,
    },
    /// The scheme is stable at no step.
    NeverStable,
    /// A model does not resist inversion: St. Venant-Kirchhoff.
    NoResistance,
    /// A triangle is inverted, and its model is undefined there.
    Crushed,
    /// The equations of an implicit step were not solved.
    Unsolved,
    /// The guard divides steps that are below the stability limit.
    Guard,
    /// The steps take more time than a frame has.
    Cost,
    /// Painting takes most of a frame.
    Painting,
    /// Large forces, such as a pull, a wall or the start shape; no setting is the cause.
    Forces,
}

/// Remedies: changes that remove a cause.
#[derive(Clone, Debug, PartialEq)]
pub enum Remedy {
    /// Shorter steps: the present number and the factor by which it grows.
    ShorterSteps(Substeps, u32),
    /// Longer steps: the present number, which is halved.
    LongerSteps(Substeps),
    /// Another constitutive model for all bodies.
    Model(Model),
    /// The effect that resists compression.
    Compression,
    /// The guard is switched on.
    Guard,
    /// Another time-stepping scheme.
    Scheme(IntegratorKind),
    /// A coarser mesh for a body: its number, the mesh, and the approximate number of triangles.
    CoarserMesh(usize, MeshKind, usize),
    /// Resets bodies to a shape without inverted triangles and folds.
    Untangle,
    /// Resets the scene to the start.
    StartOver,
    /// Switches colours, edges and vertices off.
    PlainDrawing,
}

/// A cause with its remedies, the best first.
#[derive(Clone, Debug, PartialEq)]
pub struct Advice {
    /// The cause.
    pub cause: Cause,
    /// Remedies for the cause.
    pub remedies: Vec<Remedy>,
    /// Whether the scene must also start over.
    restart: bool,
}

impl Facts {
    /// Collects the facts of a snapshot; `limit` is the longest stable step at rest, and `view` has the display options.
    pub fn of(now: &Snapshot, limit: Limit, view: &View) -> Self {
        let level = &now.level;
        let acts = |listed: &EffectLevel| {
            let here = listed.when == When::Always || now.mode == Mode::Collide;
            matches!(listed.effect, EffectKind::Compression(_)) && listed.switch.is_on() && here
        };
        let compression = level.effects.iter().any(acts);
        let inverted_at_start = || {
            let at = |vertex: u32| [now.start[2 * vertex as usize], now.start[2 * vertex as usize + 1]];
            let turned = |triangle: &&[u32; 3]| {
                let [a, b, c] = triangle.map(at);
                (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) <= 0.0
            };
            now.triangles.iter().filter(turned).count()
        };
        Self {
            substeps: level.substeps,
            limit,
            class: level.integrator.kind().class(),
            multirate: !now.substep_plans.is_empty(),
            guard: level.guard == Toggle::On,
            weak: !compression && now.bodies.iter().any(|body| body.material.model() == Some(Model::StVenantKirchhoff)),
            side_by_side: now.side_by_side,
            better_start: now.inverted > 0 && inverted_at_start() < now.inverted,
            coarser: coarser(now),
            decorated: view.stage.field != Field::None || view.stage.wireframe || view.stage.vertices,
        }
    }

    /// The step and the limit, if the step is above it.
    fn excess(&self) -> Option<(f64, f64)> {
        let step = self.substeps.step();
        match self.limit {
            Limit::Step(limit) if self.class == Class::Explicit && !self.multirate && step > limit => {
                Some((step, limit))
            }
            _ => None,
        }
    }

    /// Remedy with steps so short that they are below a limit \[s\].
    fn shorter(&self, limit: f64) -> Option<Remedy> {
        let factor = (MARGIN * self.substeps.step() / limit).ceil().max(2.0);
        let fits = f64::from(self.substeps.get()) * factor <= f64::from(Substeps::MAX);
        (limit > 0.0 && fits).then_some(Remedy::ShorterSteps(self.substeps, factor as u32))
    }

    /// Remedy with steps twice as long, if they are stable and cost less.
    fn longer(&self) -> Option<Remedy> {
        let half = Substeps::new(self.substeps.get() / 2).ok()?;
        let stable = match (self.class, self.limit) {
            (Class::Explicit, Limit::Unknown) => false,
            (Class::Explicit, Limit::Step(limit)) => MARGIN * half.step() <= limit,
            _ => true,
        };
        (stable && !self.multirate).then_some(Remedy::LongerSteps(self.substeps))
    }

    /// Remedies against inversion: a model that resists it, and the compression effect.
    fn resistance(&self) -> impl Iterator<Item = Remedy> {
        self.other_model().into_iter().chain([Remedy::Compression])
    }

    /// Remedy with a model whose energy is finite for every shape and grows with compression, where models can be chosen.
    fn other_model(&self) -> Option<Remedy> {
        (!self.side_by_side).then_some(Remedy::Model(Model::StableNeoHookean))
    }

    /// Finds the cause of a problem.
    pub fn cause(&self, trouble: Trouble) -> Cause {
        let unstable = self
            .excess()
            .map(|(step, limit)| if limit > 0.0 { Cause::StepTooLong { step, limit } } else { Cause::NeverStable });
        let weak = self.weak.then_some(Cause::NoResistance);
        match trouble {
            Trouble::Fault(fault::Cause::StepTooLong { step, limit }) if limit > 0.0 => {
                Cause::StepTooLong { step, limit }
            }
            Trouble::Fault(fault::Cause::StepTooLong { .. }) => Cause::NeverStable,
            Trouble::Fault(fault::Cause::Crushed(_)) => Cause::Crushed,
            Trouble::Fault(fault::Cause::Unsolved) => Cause::Unsolved,
            Trouble::Fault(fault::Cause::Inverted(_)) => unstable.or(weak).unwrap_or(Cause::Unsolved),
            Trouble::Inverted | Trouble::Exploded | Trouble::Fault(fault::Cause::Overflow | fault::Cause::Energy) => {
                unstable.or(weak).unwrap_or(Cause::Forces)
            }
            Trouble::Slow(load) if load.physics < MUCH => Cause::Painting,
            Trouble::Slow(load) if load.effort > DIVIDED && load.physics / load.effort < MUCH => {
                unstable.unwrap_or(Cause::Guard)
            }
            Trouble::Slow(_) => Cause::Cost,
        }
    }

    /// Finds the cause of a problem and its remedies.
    pub fn advise(&self, trouble: Trouble) -> Advice {
        let cause = self.cause(trouble);
        let slow = matches!(trouble, Trouble::Slow(_));
        let guard = (!self.guard && !slow).then_some(Remedy::Guard);
        let mut remedies: Vec<Remedy> = match cause {
            Cause::StepTooLong { limit, .. } => self.shorter(limit).into_iter().chain(guard).collect(),
            Cause::NeverStable => vec![Remedy::Scheme(IntegratorKind::default())],
            Cause::NoResistance => self.resistance().collect(),
            Cause::Crushed => self.other_model().into_iter().collect(),
            Cause::Unsolved => {
                let doubled = f64::from(self.substeps.get()) * 2.0 <= f64::from(Substeps::MAX);
                doubled.then_some(Remedy::ShorterSteps(self.substeps, 2)).into_iter().collect()
            }
            Cause::Guard if self.weak => self.resistance().collect(),
            Cause::Guard => vec![Remedy::StartOver],
            Cause::Cost => {
                let (longer, coarser) = (self.longer(), self.coarser.clone());
                let coarser = coarser.map(|(body, mesh, triangles)| Remedy::CoarserMesh(body, mesh, triangles));
                longer.or(coarser).into_iter().collect()
            }
            Cause::Painting => self.decorated.then_some(Remedy::PlainDrawing).into_iter().collect(),
            Cause::Forces => guard.into_iter().filter(|_| self.class == Class::Explicit).collect(),
        };
        match trouble {
            Trouble::Inverted => {
                remedies.push(Remedy::Untangle);
                remedies.extend(self.better_start.then_some(Remedy::StartOver));
            }
            Trouble::Exploded => remedies.push(Remedy::StartOver),
            Trouble::Fault(_) | Trouble::Slow(_) => {}
        }
        Advice { cause, remedies, restart: !slow }
    }
}

/// Mesh parameters for the body with most triangles that give about half as many.
fn coarser(now: &Snapshot) -> Option<(usize, MeshKind, usize)> {
    let largest = now.bodies.iter().enumerate().max_by_key(|(_, body)| body.triangles.len())?;
    let (number, triangles) = (largest.0, largest.1.triangles.len());
    let before = &now.level.bodies.get(number)?.mesh;
    let mut mesh = before.clone();
    for parameter in mesh.kind_mut().parameters() {
        let name = parameter.spec().name;
        let share = if name == Triangles::SPEC.name {
            0.5
        } else if [Cells::SPEC.name, Rings::SPEC.name].contains(&name) {
            0.5_f64.sqrt()
        } else {
            continue;
        };
        parameter.set((share * parameter.get()).floor().max(1.0)).ok()?;
    }
    (mesh != *before && !now.side_by_side).then_some((number, mesh, triangles / 2))
}

impl Cause {
    /// Cause as the end of a sentence, after a colon; `None` if no cause is known.
    pub fn words(self) -> Option<String> {
        let length = |seconds: f64| super::numbers::si(seconds, "s");
        match self {
            Self::StepTooLong { step, limit } => {
                Some(format!("the step of {} is above the stability limit of {}", length(step), length(limit)))
            }
            Self::NeverStable => Some("this scheme is stable at no step".to_owned()),
            Self::NoResistance => Some("St. Venant-Kirchhoff does not resist inversion".to_owned()),
            _ => None,
        }
    }
}

impl Advice {
    /// Advice with a single remedy.
    pub fn just(cause: Cause, remedy: Remedy) -> Self {
        Self { cause, remedies: vec![remedy], restart: false }
    }

    /// Commands of a remedy of the list. Changes of the display options are applied to `view` directly.
    pub fn apply(&self, number: usize, now: &Snapshot, view: &mut View) -> Vec<Command> {
        let Some(remedy) = self.remedies.get(number) else { return Vec::new() };
        let mut commands = remedy.commands(now, view);
        if self.restart && remedy.is_setting() {
            commands.extend([Command::EndGesture, Command::Reset]);
        }
        commands
    }
}

impl Remedy {
    /// Label of its button.
    pub fn label(&self) -> String {
        match self {
            Self::ShorterSteps(now, factor) => {
                format!("Shorter steps ({} × {factor} = {})", now.get(), now.get() * factor)
            }
            Self::LongerSteps(now) => format!("Longer steps ({} / 2 = {})", now.get(), now.get() / 2),
            Self::Model(model) => format!("Use {}", lower(model.title())),
            Self::Compression => "Add the compression guard".to_owned(),
            Self::Guard => "Switch the guard on".to_owned(),
            Self::Scheme(scheme) => format!("Use {}", lower(scheme.kind().title())),
            Self::CoarserMesh(_, _, triangles) => format!("Coarser mesh (about {triangles} triangles)"),
            Self::Untangle => "Untangle".to_owned(),
            Self::StartOver => "Start over".to_owned(),
            Self::PlainDrawing => "Plain drawing".to_owned(),
        }
    }

    /// Tooltip of its button.
    pub const fn help(&self) -> &'static str {
        match self {
            Self::ShorterSteps(..) => {
                "More substeps in 1/60 s, so each step is shorter: stable for stiffer bodies, and more computing time."
            }
            Self::LongerSteps(_) => "Half as many substeps in 1/60 s: less computing time. The steps stay stable.",
            Self::Model(_) => "Its energy grows ever faster as a triangle is pressed flat. All bodies start over.",
            Self::Compression => {
                "Adds an effect: triangles that are pressed flat push back, and inverted ones turn back."
            }
            Self::Guard => "The guard divides a step into up to 64 shorter ones when it is unstable.",
            Self::Scheme(_) => "A time-stepping scheme that is stable below a limit.",
            Self::CoarserMesh(..) => "Half as many triangles: less computing time. The scene starts over.",
            Self::Untangle => {
                "Moves bodies that overlap themselves into a nearby shape without inverted triangles and folds. Momentum is kept. [U]"
            }
            Self::StartOver => "Positions and velocities go back to the start. [R]",
            Self::PlainDrawing => "Draws bodies without colours, edges and vertices.",
        }
    }

    /// Whether the remedy changes a setting without starting the scene over.
    const fn is_setting(&self) -> bool {
        matches!(
            self,
            Self::ShorterSteps(..) | Self::LongerSteps(_) | Self::Compression | Self::Guard | Self::Scheme(_)
        )
    }

    fn commands(&self, now: &Snapshot, view: &mut View) -> Vec<Command> {
        let steps = |count: u32| Substeps::new(count).ok().map(Command::SetSubsteps);
        let command = match self {
            Self::ShorterSteps(now, factor) => steps(now.get().saturating_mul(*factor)),
            Self::LongerSteps(now) => steps(now.get() / 2),
            Self::Model(model) => Some(Command::SetModel(*model)),
            Self::Compression => Some(compression(now)),
            Self::Guard => Some(Command::SetGuard(Toggle::On)),
            Self::Scheme(scheme) => Some(Command::SetIntegrator(scheme.clone())),
            Self::CoarserMesh(body, mesh, _) => Some(Command::SetMesh(*body, mesh.clone())),
            Self::Untangle => Some(Command::Untangle),
            Self::StartOver => Some(Command::Reset),
            Self::PlainDrawing => {
                (view.stage.field, view.stage.wireframe, view.stage.vertices) = (Field::None, false, false);
                None
            }
        };
        command.into_iter().chain([Command::EndGesture]).collect()
    }
}

/// Command that switches the compression effect on, or adds it.
fn compression(now: &Snapshot) -> Command {
    let listed = &now.level.effects;
    let known = listed.iter().position(|listed| matches!(listed.effect, EffectKind::Compression(_)));
    let kind = EffectKind::Compression(Compression::default());
    match known.and_then(|number| Some((number, listed.get(number)?.clone()))) {
        Some((number, effect)) => {
            Command::SetEffect(number, EffectLevel { switch: Switch::default(), when: When::Always, ..effect })
        }
        None => Command::AddEffect(kind),
    }
}

/// Title within a sentence: with a small first letter, except for names of people.
fn lower(title: &str) -> String {
    let mut letters = title.chars();
    let first = letters.next().map(|first| first.to_lowercase().collect::<String>()).unwrap_or_default();
    let name = ["Heun", "Hencky", "Dormand", "Runge", "St. "].iter().any(|name| title.starts_with(name));
    if name { title.to_owned() } else { first + letters.as_str() }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::panic, reason = "a failing test should panic")]

    use super::*;
    use crate::{files, levels, meshes::NoFiles, sandbox::Sandbox, simulation::Simulation, stability::critical_step};

    const TOO_LONG: fault::Cause = fault::Cause::StepTooLong { step: 1e-3, limit: 1e-4 };

    fn troubles() -> Vec<Trouble> {
        let faults = [
            TOO_LONG,
            fault::Cause::StepTooLong { step: 1e-3, limit: 0.0 },
            fault::Cause::Crushed("Hencky"),
            fault::Cause::Overflow,
            fault::Cause::Energy,
            fault::Cause::Unsolved,
            fault::Cause::Inverted(3),
        ];
        let loads = [(0.001, 1.0), (0.1, 1.0), (0.1, 64.0), (10.0, 64.0)];
        let slow = loads.map(|(physics, effort)| Trouble::Slow(Load { physics, effort }));
        [Trouble::Inverted, Trouble::Exploded].into_iter().chain(faults.map(Trouble::Fault)).chain(slow).collect()
    }

    /// All combinations of facts about a scene.
    fn all_facts() -> Vec<Facts> {
        let mut all = Vec::new();
        let flags = |bits: u32| move |bit: u32| bits >> bit & 1 == 1;
        for (substeps, class) in [1, 2, 100, 90_000]
            .into_iter()
            .flat_map(|n| [Class::Explicit, Class::Implicit, Class::ErrorControlled].map(|class| (n, class)))
        {
            let step = 1.0 / (60.0 * f64::from(substeps));
            let limits = [0.0, 0.1 * step, 0.99 * step, 1.01 * step, 2.0 * step, 15.0 * step].map(Limit::Step);
            for limit in limits.into_iter().chain([Limit::Unknown, Limit::Nothing]) {
                for bits in 0..64 {
                    let is = flags(bits);
                    all.push(Facts {
                        substeps: Substeps::new(substeps).unwrap(),
                        limit,
                        class,
                        multirate: is(0),
                        guard: is(1),
                        weak: is(2),
                        side_by_side: is(3),
                        better_start: is(4),
                        coarser: is(5).then(|| (0, MeshKind::all()[0].clone(), 10)),
                        decorated: is(0),
                    });
                }
            }
        }
        all
    }

    #[test]
    fn over_all_causes_no_remedy_works_against_its_cause() {
        for facts in all_facts() {
            for trouble in troubles() {
                let advice = facts.advise(trouble);
                let context = format!("{trouble:?}, {facts:?}: {advice:?}");
                let (step, slow) = (facts.substeps.step(), matches!(trouble, Trouble::Slow(_)));
                let above = matches!(facts.limit, Limit::Step(limit) if step > limit)
                    && facts.class == Class::Explicit
                    && !facts.multirate;
                let ways = advice.remedies.iter().filter(|remedy| {
                    matches!(remedy, Remedy::ShorterSteps(..) | Remedy::LongerSteps(_) | Remedy::CoarserMesh(..))
                });
                assert!(ways.count() <= 1, "{context}");
                for remedy in &advice.remedies {
                    let fits = match remedy {
                        Remedy::ShorterSteps(_, factor) => {
                            let shorter = step / f64::from(*factor);
                            let stable = |limit: f64| shorter * MARGIN <= limit * 1.001;
                            match trouble {
                                Trouble::Fault(fault::Cause::Unsolved | fault::Cause::Inverted(_)) => true,
                                Trouble::Fault(fault::Cause::StepTooLong { limit, .. }) => stable(limit),
                                _ => above && matches!(facts.limit, Limit::Step(limit) if stable(limit)),
                            }
                        }
                        Remedy::LongerSteps(_) => {
                            let Trouble::Slow(load) = trouble else { panic!("{context}") };
                            let stable = match (facts.class, facts.limit) {
                                (Class::Explicit, Limit::Step(limit)) => 2.0 * step <= limit,
                                (Class::Explicit, Limit::Unknown) => false,
                                _ => true,
                            };
                            stable && load.physics / load.effort >= MUCH
                        }
                        Remedy::CoarserMesh(..) => slow && advice.cause == Cause::Cost,
                        Remedy::Model(_) => !facts.side_by_side && (facts.weak || advice.cause == Cause::Crushed),
                        Remedy::Compression => facts.weak && !above,
                        Remedy::Guard => !facts.guard && !slow,
                        Remedy::Scheme(_) => advice.cause == Cause::NeverStable,
                        Remedy::Untangle => trouble == Trouble::Inverted,
                        Remedy::StartOver => trouble != Trouble::Inverted || facts.better_start,
                        Remedy::PlainDrawing => facts.decorated && advice.cause == Cause::Painting,
                    };
                    assert!(fits, "{remedy:?} for {context}");
                }
            }
        }
    }

    #[test]
    fn the_cause_is_the_step_the_model_the_guard_or_the_cost() {
        let facts = |share: f64, weak| Facts {
            substeps: Substeps::new(100).unwrap(),
            limit: Limit::Step(share / 6000.0),
            class: Class::Explicit,
            multirate: false,
            guard: true,
            weak,
            side_by_side: false,
            better_start: true,
            coarser: None,
            decorated: false,
        };
        let is = |facts: &Facts, trouble| facts.cause(trouble);
        let slow = |physics, effort| Trouble::Slow(Load { physics, effort });
        assert!(matches!(is(&facts(0.5, true), Trouble::Inverted), Cause::StepTooLong { .. }));
        assert_eq!(is(&facts(15.0, true), Trouble::Inverted), Cause::NoResistance);
        assert_eq!(is(&facts(15.0, false), Trouble::Inverted), Cause::Forces);
        assert_eq!(is(&facts(15.0, false), slow(0.05, 1.0)), Cause::Cost);
        assert_eq!(is(&facts(15.0, false), slow(0.05, 16.0)), Cause::Guard);
        assert!(matches!(is(&facts(0.5, false), slow(0.05, 16.0)), Cause::StepTooLong { .. }));
        assert_eq!(is(&facts(15.0, false), slow(0.001, 1.0)), Cause::Painting);
    }

    /// A built-in level with this number of substeps, in simulate mode.
    fn running(substeps: u32) -> Sandbox {
        let mut level = files::parse(levels::built_in("gingerbread").unwrap(), "gingerbread").unwrap();
        level.substeps = Substeps::new(substeps).unwrap();
        let mut sandbox = Sandbox::new(level, Box::new(NoFiles)).unwrap();
        sandbox.apply(Command::SetMode(Mode::Simulate)).unwrap();
        sandbox
    }

    fn limit(simulation: &Simulation) -> f64 {
        critical_step(simulation.scene(), &simulation.scene().start, None).unwrap()
    }

    fn facts(sandbox: &Sandbox) -> (Facts, Snapshot) {
        let mut now = Snapshot::default();
        sandbox.snapshot(Field::None, &mut now);
        let facts = Facts::of(&now, Limit::Step(limit(sandbox.simulation())), &View::default());
        (facts, now)
    }

    /// Pulls for half a second. Returns the number of force evaluations, and the ratio of computed steps to undivided steps.
    fn cost(sandbox: &mut Sandbox) -> (u64, f64) {
        sandbox.apply(Command::Reset).unwrap();
        sandbox.apply(Command::Grab(100, [0.9, 0.9, 0.0])).unwrap();
        let before = sandbox.simulation().counts();
        let steps = 30 * u64::from(sandbox.document().level.substeps.get());
        assert_eq!(sandbox.advance(steps, &mut || true), steps);
        let now = sandbox.simulation().counts();
        let work = now.inner_steps - before.inner_steps + now.retaken - before.retaken;
        (now.force_evaluations - before.force_evaluations, work as f64 / steps as f64)
    }

    fn take(sandbox: &mut Sandbox, advice: &Advice, number: usize, now: &Snapshot) {
        for command in advice.apply(number, now, &mut View::default()) {
            sandbox.apply(command).unwrap();
        }
    }

    #[test]
    fn steps_that_the_guard_divides_get_shorter_and_cost_less() {
        let mut sandbox = running(2);
        let (before, effort) = cost(&mut sandbox);
        assert!(effort > 4.0, "the guard divides steps: {effort}");
        let (facts, now) = facts(&sandbox);
        let advice = facts.advise(Trouble::Slow(Load { physics: 0.02, effort }));
        assert!(matches!(advice.remedies[..], [Remedy::ShorterSteps(..)]), "{advice:?}");
        take(&mut sandbox, &advice, 0, &now);
        let (after, effort) = cost(&mut sandbox);
        assert!(effort < DIVIDED && after < before, "{after} force evaluations in place of {before}, effort {effort}");
    }

    #[test]
    fn steps_that_cost_too_much_get_longer_and_stay_stable() {
        let mut sandbox = running(400);
        let (before, effort) = cost(&mut sandbox);
        let (facts, now) = facts(&sandbox);
        let advice = facts.advise(Trouble::Slow(Load { physics: 0.02, effort }));
        assert_eq!(advice.remedies[0].label(), "Longer steps (400 / 2 = 200)");
        take(&mut sandbox, &advice, 0, &now);
        let (after, effort) = cost(&mut sandbox);
        assert!(2 * after <= before + 2 && effort < DIVIDED, "{after} force evaluations in place of {before}");
        assert!(sandbox.step_length() <= limit(sandbox.simulation()));
    }

    #[test]
    fn where_longer_steps_would_be_unstable_the_mesh_gets_coarser() {
        let mut sandbox = running(100);
        let stable = (MARGIN / (60.0 * limit(sandbox.simulation()))).ceil() as u32;
        sandbox.apply(Command::SetSubsteps(Substeps::new(stable).unwrap())).unwrap();
        let (facts, now) = facts(&sandbox);
        let advice = facts.advise(Trouble::Slow(Load { physics: 0.02, effort: 1.0 }));
        assert!(matches!(advice.remedies[..], [Remedy::CoarserMesh(..)]), "{advice:?}");
        let triangles = |sandbox: &Sandbox| sandbox.simulation().scene().triangles.len();
        let (before, longest) = (triangles(&sandbox), limit(sandbox.simulation()));
        take(&mut sandbox, &advice, 0, &now);
        assert!(3 * triangles(&sandbox) < 2 * before && limit(sandbox.simulation()) > longest);
    }

    #[test]
    fn plain_drawing_takes_away_what_is_drawn_besides_bodies() {
        let mut view = View::default();
        (view.stage.wireframe, view.stage.field) = (true, Field::Volume);
        let sandbox = running(100);
        let (_, now) = facts(&sandbox);
        let facts = Facts::of(&now, Limit::Unknown, &view);
        let advice = facts.advise(Trouble::Slow(Load { physics: 0.001, effort: 1.0 }));
        assert_eq!(advice.remedies, [Remedy::PlainDrawing]);
        advice.apply(0, &now, &mut view);
        assert_eq!((view.stage.wireframe, view.stage.field), (false, Field::None));
    }

    #[test]
    fn every_remedy_says_what_it_does_with_its_numbers() {
        let substeps = Substeps::new(100).unwrap();
        assert_eq!(Remedy::ShorterSteps(substeps, 2).label(), "Shorter steps (100 × 2 = 200)");
        assert_eq!(Remedy::LongerSteps(substeps).label(), "Longer steps (100 / 2 = 50)");
        assert_eq!(Remedy::Model(Model::StableNeoHookean).label(), "Use stable neo-Hookean");
        assert_eq!(Remedy::Model(Model::Hencky).label(), "Use Hencky");
    }
}
