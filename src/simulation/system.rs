//! A scene as the integrator sees it.

use crate::{
    effects::{Bounds, Grab, Motion, NO_CONTACT, OUT_OF_REACH, around},
    integrators::{Dynamics, Ode, Work},
    obstacles::{Start, Surface},
    report::{Counts, EffectCost},
    scene::Scene,
    solvers::{BlockMatrix, Weights},
    toys::Toy,
};
use std::{cell::Cell, ops::Range};
use web_time::Instant;

/// Why the elements of what sleeps are passed over.
pub(super) const ASLEEP: &str = "asleep";

/// Most turns that constraints take in a step.
const TURNS: usize = 4;

/// The effects of a scene by the part they take in a step, each by its number: what is not listed is not asked.
#[derive(Default)]
pub(super) struct Plan {
    /// What adds forces.
    pub forces: Vec<usize>,
    /// What constrains.
    pub constraints: Vec<usize>,
    /// What has a say where constraints touch.
    pub coatings: Vec<usize>,
    /// Elements of what sleeps, which are not asked.
    pub sleeping: Vec<usize>,
    /// What touching does.
    pub surface: Surface,
}

impl Plan {
    /// For a scene in which some elements sleep, the first of its effects.
    fn new(scene: &Scene, asleep: impl Iterator<Item = bool>) -> Self {
        let mut plan = Self::default();
        let asleep = asleep.chain(std::iter::repeat(false));
        for ((number, effect), asleep) in scene.effects.iter().enumerate().zip(asleep) {
            let part = match (effect.constrains(), effect.coats()) {
                _ if asleep => &mut plan.sleeping,
                (true, _) => &mut plan.constraints,
                (_, true) => &mut plan.coatings,
                _ => &mut plan.forces,
            };
            part.push(number);
            effect.coat(&mut plan.surface);
        }
        plan
    }
}

/// Everything that stepping writes to beside the state.
#[derive(Default)]
pub(super) struct Scratch {
    /// For the integrator.
    pub work: Work,
    /// For the effects.
    pub effects: Vec<f64>,
    /// Outward normals of the vertices.
    pub outward: Vec<f64>,
    /// Work of moving obstacles in this step [J].
    pub supplied: f64,
    pub plan: Plan,
    /// 1/mass [1/kg] with zero for what sleeps, while something does.
    pub held: Vec<f64>,
    /// The box in which no constraint has anything to say, while all ways lie in it.
    pub free: Option<Bounds>,
    pub counts: Counts,
    pub costs: Vec<EffectCost>,
    /// Whether effects are timed.
    pub timed: bool,
}

impl Scratch {
    pub fn fit(&mut self, scene: &Scene) {
        self.work.forget();
        self.effects.resize(scene.effects.iter().map(|effect| effect.scratch()).max().unwrap_or(0), 0.0);
        self.rest(scene, std::iter::empty());
        self.free = None;
        let named = || scene.effects.iter().map(|effect| effect.name()).zip(scene.auto.iter().copied());
        if !self.costs.iter().map(|cost| cost.name).eq(named().map(|(name, _)| name)) {
            self.costs = named().map(|(name, auto)| EffectCost::none(name, auto)).collect();
        }
        for (cost, (_, auto)) in self.costs.iter_mut().zip(named()) {
            (cost.auto, cost.idle) = (auto, None);
        }
    }

    /// Notes which bodies and nets of a scene sleep; none of their vertices is held yet.
    pub fn rest(&mut self, scene: &Scene, asleep: impl Iterator<Item = bool>) {
        self.plan = Plan::new(scene, asleep);
        self.held.clear();
        if !self.plan.sleeping.is_empty() {
            self.held.extend_from_slice(&scene.inverse_mass);
        }
    }

    /// Holds vertices that sleep.
    pub fn hold(&mut self, vertices: &Range<usize>) {
        self.held[2 * vertices.start..2 * vertices.end].fill(0.0);
    }

    /// Runs one effect and books its time and, if it is a call of its own, its elements.
    fn booked<T>(&mut self, number: usize, elements: Option<usize>, run: impl FnOnce(&mut [f64]) -> T) -> T {
        let start = self.timed.then(Instant::now);
        let result = run(&mut self.effects);
        let cost = &mut self.costs[number];
        if let Some(start) = start {
            cost.time += start.elapsed();
        }
        if let Some(elements) = elements {
            cost.call(elements);
        }
        result
    }

    /// Books that all constraints were passed over, and with them what has a say where they touch.
    pub fn pass_over_constraints(&mut self) {
        for number in &self.plan.constraints {
            self.costs[*number].pass_over(OUT_OF_REACH);
        }
        for number in &self.plan.coatings {
            let cost = &mut self.costs[*number];
            if cost.auto { cost.pass_over(NO_CONTACT) } else { cost.call(0) }
        }
    }
}

/// A scene as the integrator sees it.
pub(super) struct System<'a> {
    pub scene: &'a Scene,
    pub scratch: &'a mut Scratch,
    pub grab: Option<Grab>,
    /// Simulated time where the step begins and where it ends [s].
    pub time: [f64; 2],
}

impl System<'_> {
    fn motion<'a>(&'a self, x: &'a [f64], v: &'a [f64]) -> Motion<'a> {
        let (mass, inverse_mass) = (&self.scene.mass, self.inverse_mass());
        Motion { x, v, mass, inverse_mass, grab: self.grab }
    }
}

impl Dynamics for System<'_> {
    fn force(&mut self, x: &[f64], v: &[f64], force: &mut [f64]) {
        let scene = self.scene;
        let motion = Motion { x, v, mass: &scene.mass, inverse_mass: &scene.inverse_mass, grab: self.grab };
        self.scratch.counts.force_evaluations += 1;
        force.fill(0.0);
        for number in &self.scratch.plan.sleeping {
            self.scratch.costs[*number].pass_over(ASLEEP);
        }
        for turn in 0..self.scratch.plan.forces.len() {
            let number = self.scratch.plan.forces[turn];
            let (effect, cost) = (&scene.effects[number], &mut self.scratch.costs[number]);
            if cost.auto
                && let Some(why) = effect.idle(motion)
            {
                cost.pass_over(why);
                continue;
            }
            let (size, elements) = (effect.scratch(), Some(effect.elements(motion)));
            self.scratch.booked(number, elements, |scratch| effect.force(motion, &mut scratch[..size], force));
        }
    }

    fn mass(&self) -> &[f64] {
        &self.scene.mass
    }

    fn inverse_mass(&self) -> &[f64] {
        if self.scratch.held.is_empty() { &self.scene.inverse_mass } else { &self.scratch.held }
    }

    fn stiffness_times(&mut self, x: &[f64], v: &[f64], d: &[f64], product: &mut [f64]) {
        let motion = self.motion(x, v);
        for effect in &self.scene.effects {
            effect.stiffness_times(motion, d, product);
        }
    }

    fn couples(&self, add: &mut dyn FnMut(u32, u32)) {
        for effect in &self.scene.effects {
            effect.couples(add);
        }
    }

    fn add_stiffness(&mut self, x: &[f64], v: &[f64], weights: Weights, matrix: &mut BlockMatrix) {
        let motion = self.motion(x, v);
        for effect in &self.scene.effects {
            effect.add_stiffness(motion, weights, matrix);
        }
    }

    fn longest_step(&self, x: &[f64], d: &[f64]) -> f64 {
        self.scene.effects.iter().map(|effect| effect.longest_step(x, d)).fold(f64::INFINITY, f64::min)
    }

    fn constrains(&self) -> bool {
        self.scratch.free.is_none() && !self.scratch.plan.constraints.is_empty()
    }

    fn grips(&self) -> bool {
        self.scratch.plan.surface.friction != 0.0
    }

    /// Walls and edges of the world may push where the others do not allow: they take turns until no other has anything to say.
    fn constrain(&mut self, [before_x, before_v]: [&[f64]; 2], x: &mut [f64], v: &mut [f64], faces: bool) {
        if !self.constrains() {
            return;
        }
        let scene = self.scene;
        let held = std::mem::take(&mut self.scratch.held);
        let inverse_mass = if held.is_empty() { scene.inverse_mass.as_slice() } else { &held };
        let mut outward = std::mem::take(&mut self.scratch.outward);
        if faces {
            scene.outward(before_x, &mut outward);
        }
        let (time, supplied) = (self.time, Cell::new(0.0));
        let start = Start {
            x: before_x,
            v: before_v,
            inverse_mass,
            surface: self.scratch.plan.surface,
            outward: faces.then_some(outward.as_slice()),
            time,
            supplied: &supplied,
        };
        let count = self.scratch.plan.constraints.len();
        let (mut quiet, mut all) = (0, 0);
        // The box around the ways of all vertices, as long as nobody has touched one.
        let mut ways = None;
        for turn in 0..TURNS * count {
            if turn >= count && quiet + 1 >= count {
                break;
            }
            let number = self.scratch.plan.constraints[turn % count];
            let (effect, cost) = (&scene.effects[number], &mut self.scratch.costs[number]);
            if cost.auto && effect.is_clear(*ways.get_or_insert_with(|| around(before_x, x))) {
                if turn < count {
                    cost.pass_over(OUT_OF_REACH);
                }
                quiet += 1;
                continue;
            }
            let motion = Motion { x, v, mass: &scene.mass, inverse_mass, grab: self.grab };
            let elements = (turn < count).then(|| effect.elements(motion));
            let touched = self.scratch.booked(number, elements, |_| effect.constrain(&start, x, v));
            if touched > 0 {
                ways = None;
            }
            quiet = if touched == 0 { quiet + 1 } else { 0 };
            all += touched;
        }
        self.scratch.supplied += supplied.get();
        self.scratch.counts.constrained += all as u64;
        for number in &self.scratch.plan.coatings {
            let cost = &mut self.scratch.costs[*number];
            if all > 0 || !cost.auto { cost.call(all) } else { cost.pass_over(NO_CONTACT) }
        }
        (self.scratch.outward, self.scratch.held) = (outward, held);
    }
}

/// A toy as the integrator sees it; its rates count as forces.
pub(super) struct ToySystem<'a> {
    pub toy: &'a dyn Toy,
    pub counts: &'a mut Counts,
}

impl Ode for ToySystem<'_> {
    fn rate(&mut self, x: &[f64], rate: &mut [f64]) {
        self.counts.force_evaluations += 1;
        if let &[a, b] = x {
            rate.copy_from_slice(&self.toy.rate([a, b]));
        }
    }
}
