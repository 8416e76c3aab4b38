//! Random variations of the built-in levels, and random scenes of contact, with every integrator and every constitutive model.

use super::{Account, random_contact, verdict::Count};
use crate::{
    clock::Stopwatch,
    elements::ElementKind,
    files,
    guard::Guard,
    integrators::IntegratorKind,
    level::{Action, BodyLevel, Level, MassLevel, ScriptedAction, StartShape, Substeps},
    levels,
    materials::{MaterialParameters, Model},
    quantity::{Angle, Coordinate, Density, Factor, Mass, Point, Poisson, Position, Spin, Time, Velocity, Young},
    random,
    scene::Scene,
    simulation::Simulation,
    study::with_triangles,
};

/// Random variation of a level: other materials, masses, effects, steps, start shapes and velocities, and a pull by the mouse. Or a random
/// scene of contact.
#[derive(Clone, Debug, PartialEq)]
pub struct Variation {
    /// Number in the sequence of its seed.
    pub number: u32,
    /// Name of the built-in level; [`Variation::CONTACT`] for a scene of contact.
    pub base: String,
    /// Constitutive model of all bodies.
    pub model: Model,
    /// The level.
    pub level: Level,
}

/// What is wrong with a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Wrong {
    /// A position, velocity or energy is not finite.
    NotFinite,
    /// Surfaces crossed, at so many places.
    Crossed(usize),
    /// The energy grew without a cause, by this multiple of what was put in.
    Energy(f64),
    /// It took so much processor time \[s\].
    Slow(f64),
}

impl Wrong {
    /// Whether another run went wrong in the same way.
    pub fn is_like(self, other: Self) -> bool {
        std::mem::discriminant(&self) == std::mem::discriminant(&other)
    }
}

impl std::fmt::Display for Wrong {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match *self {
            Self::NotFinite => write!(out, "not finite"),
            Self::Crossed(count) => write!(out, "surfaces crossed at {}", Count(count, "place", "places")),
            Self::Energy(gain) => write!(out, "energy from nowhere: {gain:.2} times what was put in"),
            Self::Slow(seconds) => write!(out, "took {seconds:.1} s"),
        }
    }
}

/// Result of a run of a [`Variation`].
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Why the level cannot be built, if so.
    pub refused: Option<String>,
    /// Fault that stopped the run, if any.
    pub fault: Option<String>,
    /// Number of steps taken.
    pub steps: u64,
    /// Steps that the guard divided.
    pub guarded: u64,
    /// Greatest energy from nowhere, as a share of the energy put in (see [`Account`]).
    pub gain: f64,
    /// Greatest number of crossings of surfaces after a step, if there were none at the start.
    pub crossings: usize,
    /// Whether the last state and its energies are finite.
    pub finite: bool,
    /// Processor time \[s\].
    pub seconds: f64,
}

impl Variation {
    /// Steps of a run.
    pub const STEPS: u64 = 100;

    /// Base of a scene of contact.
    pub const CONTACT: &str = "contact";

    /// Greatest processor time of a run \[s\].
    pub const SECONDS: f64 = 10.0;

    /// Variation by its number. All integrators and models occur with every level in turn.
    ///
    /// # Errors
    /// If a built-in level cannot be read.
    pub fn new(seed: u32, number: u32) -> Result<Self, files::FileError> {
        let (_, _, turn) = in_turn(number);
        let mut bases = Vec::new();
        for (file, text) in levels::BUILT_IN {
            let level = files::parse(text, file)?;
            if level.toy.is_none() {
                bases.push((file.strip_suffix(".ron").unwrap_or(file), level));
            }
        }
        let (base, level) = bases.swap_remove(turn % bases.len());
        Ok(Self::of(base, &level, seed, number))
    }

    /// Variation of a level by its number. All integrators and models occur in turn.
    pub fn of(base: &str, level: &Level, seed: u32, number: u32) -> Self {
        let (integrator, model, _) = in_turn(number);
        let mut draw = Draw::new(seed, number);
        let mut level = vary(Level { integrator, state: None, ..level.clone() }, model, &mut draw);
        let kind = ElementKind::ALL[draw.count(0, ElementKind::ALL.len() as u32 - 1) as usize];
        // With as many vertices, where the meshes can be coarser.
        if kind.has_six_nodes()
            && let Ok(coarser) = with_triangles(&level, 0.25)
        {
            level = coarser;
            level.bodies.iter_mut().for_each(|body| body.element = kind);
        }
        Self { number, base: base.to_owned(), model, level }
    }

    /// Scene of contact by its number: bodies that fly at each other and at obstacles that move, or cloth in space. All integrators and models occur in
    /// turn.
    ///
    /// # Errors
    /// If what is drawn is no level.
    pub fn contact(seed: u32, number: u32) -> Result<Self, files::FileError> {
        let (integrator, model, _) = in_turn(number);
        let level = random_contact::scene(model, &mut Draw::new(seed, number))?;
        Ok(Self { number, base: Self::CONTACT.to_owned(), model, level: Level { integrator, ..level } })
    }

    /// Runs the variation, with the guard.
    pub fn run(&self) -> Outcome {
        Outcome::of(&self.level)
    }
}

impl Outcome {
    /// Runs a level for [`Variation::STEPS`] steps.
    pub fn of(level: &Level) -> Self {
        let stopwatch = Stopwatch::start();
        let mut outcome = Self {
            refused: None,
            fault: None,
            steps: 0,
            guarded: 0,
            gain: 0.0,
            crossings: 0,
            finite: true,
            seconds: 0.0,
        };
        match Scene::build(level, level.mode, &files::Disk, None)
            .and_then(|scene| Simulation::open(scene, level, level.mode))
        {
            Ok(simulation) => step(simulation, &mut outcome),
            Err(error) => outcome.refused = Some(error.to_string()),
        }
        outcome.seconds = stopwatch.elapsed().as_secs_f64();
        outcome
    }

    /// What is wrong with the run, if anything: a run may only end or stop with a cause.
    pub fn wrong(&self) -> Option<Wrong> {
        if !self.finite {
            return Some(Wrong::NotFinite);
        }
        if self.crossings > 0 {
            return Some(Wrong::Crossed(self.crossings));
        }
        if self.fault.is_none() && self.gain > Guard::EXCESS {
            return Some(Wrong::Energy(self.gain));
        }
        (self.seconds > Variation::SECONDS).then_some(Wrong::Slow(self.seconds))
    }
}

fn step(mut simulation: Simulation, outcome: &mut Outcome) {
    let mut account = Account::new(simulation.scene(), simulation.energies());
    let begins_apart = simulation.count_crossings() == Some(0);
    for _ in 0..Variation::STEPS {
        simulation.perform_due(&mut |before, after| account.changed(before, after));
        let work = simulation.work_of_obstacles();
        simulation.advance(1, &mut || true);
        simulation.check_energy();
        account.supply(simulation.work_of_obstacles() - work);
        account.record_steps(&mut simulation);
        if begins_apart && let Some(crossings) = simulation.count_crossings() {
            outcome.crossings = outcome.crossings.max(crossings);
        }
        if simulation.fault().is_some() {
            break;
        }
    }
    outcome.fault = simulation.fault().map(ToString::to_string);
    (outcome.steps, outcome.guarded) = (simulation.state().steps, simulation.counts().guarded);
    outcome.gain = account.gain();
    outcome.finite = simulation.state().is_finite() && simulation.energies().total().is_finite();
}

/// Integrator and model of a number, and the rest of it.
fn in_turn(number: u32) -> (IntegratorKind, Model, usize) {
    let (mut integrators, models, number) = (IntegratorKind::all(), Model::ALL, number as usize);
    let (count, turn) = (integrators.len(), number / integrators.len());
    (integrators.swap_remove(number % count), models[turn % models.len()], turn / models.len())
}

/// Random choices.
pub(super) struct Draw<R>(R);

impl Draw<()> {
    /// Those of a number in the sequence of a seed.
    fn new(seed: u32, number: u32) -> Draw<impl Iterator<Item = f64>> {
        Draw(random::stream(seed.wrapping_mul(1_000_003).wrapping_add(number)))
    }
}

impl<R: Iterator<Item = f64>> Draw<R> {
    /// Number in [-1, 1).
    pub fn number(&mut self) -> f64 {
        self.0.next().unwrap_or(0.0)
    }

    /// Number between two.
    pub fn between(&mut self, least: f64, greatest: f64) -> f64 {
        least + 0.5 * (self.number() + 1.0) * (greatest - least)
    }

    /// Whole number between two, these included.
    pub fn count(&mut self, least: u32, greatest: u32) -> u32 {
        self.between(f64::from(least), f64::from(greatest + 1)) as u32
    }

    /// True with a probability.
    pub fn chance(&mut self, probability: f64) -> bool {
        0.5 * (self.number() + 1.0) < probability
    }

    /// Factor up to `decades` powers of ten either way.
    pub fn factor(&mut self, decades: f64) -> f64 {
        libm::pow(10.0, decades * self.number())
    }

    /// Point about the middle of the view \[m\].
    fn point(&mut self) -> Point {
        let at = [0.5 + 0.5 * self.number(), 0.5 + 0.5 * self.number()];
        Point::new(at).unwrap_or(Point(Coordinate::literal(0.0), Coordinate::literal(0.0)))
    }
}

fn vary<R: Iterator<Item = f64>>(mut level: Level, model: Model, draw: &mut Draw<R>) -> Level {
    let substeps = f64::from(level.substeps.get()) * libm::exp2((3.0 * draw.number()).round());
    level.substeps = Substeps::nearest(substeps.max(1.0));
    for body in &mut level.bodies {
        vary_body(body, model, draw);
    }
    for membrane in &mut level.membranes {
        let now = membrane.material;
        membrane.energy = None;
        let young = Young::new(now.young().get() * draw.factor(2.0)).unwrap_or(now.young());
        membrane.material = MaterialParameters::new(model, young, now.poisson(), now.plane()).unwrap_or(now);
    }
    for listed in &mut level.effects {
        for number in listed.effect.kind_mut().parameters() {
            if draw.chance(0.3) {
                // A value beyond the range leaves the old one.
                let _ = number.set(number.get() * draw.factor(1.5));
            }
        }
    }
    if draw.chance(0.4) {
        let time = |seconds: f64| Time::new(seconds).unwrap_or(Time::literal(0.0));
        let mut point = || Position::Plane(draw.point());
        let actions = [Action::Grab(point()), Action::Pull { to: point(), over: time(0.2) }, Action::Release];
        level.actions = actions
            .into_iter()
            .zip([0.0, 0.0, 0.5])
            .map(|(action, at)| ScriptedAction { at: time(at), every: None, action })
            .collect();
    }
    level
}

fn vary_body<R: Iterator<Item = f64>>(body: &mut BodyLevel, model: Model, draw: &mut Draw<R>) {
    (body.material, body.energy) = (body.material.with_model(model), None);
    let young = Young::new(body.material.young().get() * draw.factor(2.0)).unwrap_or(body.material.young());
    let poisson = if draw.chance(0.2) { 0.499 } else { 0.45 * draw.number().abs() };
    let poisson = Poisson::new(poisson).unwrap_or(body.material.poisson());
    body.material = MaterialParameters::new(model, young, poisson, body.material.plane()).unwrap_or(body.material);
    let factor = draw.factor(2.0);
    body.mass = match body.mass {
        MassLevel::Density(density) => MassLevel::Density(Density::new(density.get() * factor).unwrap_or(density)),
        MassLevel::Consistent(density) => {
            MassLevel::Consistent(Density::new(density.get() * factor).unwrap_or(density))
        }
        MassLevel::Total(mass) => MassLevel::Total(Mass::new(mass.get() * factor).unwrap_or(mass)),
    };
    if draw.chance(0.3) {
        let stretch = [body.stretch.0, body.stretch.1];
        let [x, y] = stretch.map(|old| Factor::new(old.get() * draw.factor(0.3)).unwrap_or(old));
        body.stretch = (x, y);
    }
    if draw.chance(0.05) {
        body.start = StartShape::Scrambled { seed: (1e6 * draw.number().abs()) as u32 };
    }
    if draw.chance(0.2) {
        body.spin = Spin::new(50.0 * draw.number()).unwrap_or(body.spin);
    }
    if draw.chance(0.2) {
        let old = body.velocity;
        let mut speed = |old: Velocity| Velocity::new(20.0 * draw.number()).unwrap_or(old);
        body.velocity = (speed(old.0), speed(old.1));
    }
    if draw.chance(0.2) {
        body.place.turn = Angle::new(180.0 * draw.number()).unwrap_or(body.place.turn);
    }
}
