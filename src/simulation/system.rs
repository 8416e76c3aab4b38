//! A scene as the integrator sees it.

use crate::{
    effects::{Effect, Grab, Motion},
    integrators::{Dynamics, Ode, Work},
    obstacles::{Start, Surface},
    report::{Counts, EffectCost},
    scene::Scene,
    solvers::{BlockMatrix, Weights},
    toys::Toy,
};
use std::{cell::Cell, time::Duration};
use web_time::Instant;

/// Most turns that constraints take in a step.
const TURNS: usize = 4;

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
    pub counts: Counts,
    pub costs: Vec<EffectCost>,
    /// Whether effects are timed.
    pub timed: bool,
}

impl Scratch {
    pub fn fit(&mut self, scene: &Scene) {
        self.work.forget();
        self.effects.resize(scene.effects.iter().map(|effect| effect.scratch()).max().unwrap_or(0), 0.0);
        let cost = |effect: &std::sync::Arc<dyn Effect>| EffectCost {
            name: effect.name(),
            time: Duration::ZERO,
            calls: 0,
            elements: 0,
        };
        if !self.costs.iter().map(|cost| cost.name).eq(scene.effects.iter().map(|effect| effect.name())) {
            self.costs = scene.effects.iter().map(cost).collect();
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

impl Scratch {
    /// Runs one effect and books its time and, if it is a call of its own, its elements.
    fn booked<T>(&mut self, number: usize, elements: Option<usize>, run: impl FnOnce(&mut [f64]) -> T) -> T {
        let start = self.timed.then(Instant::now);
        let result = run(&mut self.effects);
        let cost = &mut self.costs[number];
        if let Some(start) = start {
            cost.time += start.elapsed();
        }
        if let Some(elements) = elements {
            cost.calls += 1;
            cost.elements += elements as u64;
        }
        result
    }
}

impl System<'_> {
    /// What touching does here.
    fn surface(&self) -> Surface {
        let mut surface = Surface::default();
        self.scene.effects.iter().for_each(|effect| effect.coat(&mut surface));
        surface
    }

    fn motion<'a>(&'a self, x: &'a [f64], v: &'a [f64]) -> Motion<'a> {
        let (mass, inverse_mass) = (&self.scene.mass, &self.scene.inverse_mass);
        Motion { x, v, mass, inverse_mass, grab: self.grab }
    }
}

impl Dynamics for System<'_> {
    fn force(&mut self, x: &[f64], v: &[f64], force: &mut [f64]) {
        let scene = self.scene;
        let motion = Motion { x, v, mass: &scene.mass, inverse_mass: &scene.inverse_mass, grab: self.grab };
        self.scratch.counts.force_evaluations += 1;
        force.fill(0.0);
        for (number, effect) in scene.effects.iter().enumerate().filter(|(_, effect)| !effect.constrains()) {
            let size = effect.scratch();
            let elements = Some(effect.elements(motion));
            self.scratch.booked(number, elements, |scratch| effect.force(motion, &mut scratch[..size], force));
        }
    }

    fn mass(&self) -> &[f64] {
        &self.scene.mass
    }

    fn inverse_mass(&self) -> &[f64] {
        &self.scene.inverse_mass
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
        self.scene.effects.iter().any(|effect| effect.constrains())
    }

    fn grips(&self) -> bool {
        self.surface().friction != 0.0
    }

    /// Walls and edges of the world may push where the others do not allow: they take turns until no other has anything to say.
    fn constrain(&mut self, [before_x, before_v]: [&[f64]; 2], x: &mut [f64], v: &mut [f64], faces: bool) {
        let scene = self.scene;
        let surface = self.surface();
        let mut outward = std::mem::take(&mut self.scratch.outward);
        if faces {
            scene.outward(before_x, &mut outward);
        }
        let (time, supplied) = (self.time, Cell::new(0.0));
        let outward_of = faces.then_some(outward.as_slice());
        let start = Start {
            x: before_x,
            v: before_v,
            inverse_mass: &scene.inverse_mass,
            surface,
            outward: outward_of,
            time,
            supplied: &supplied,
        };
        let constraints = scene.effects.iter().enumerate().filter(|(_, effect)| effect.constrains());
        let count = constraints.clone().count();
        let mut quiet = 0;
        for (turn, (number, effect)) in constraints.cycle().take(TURNS * count).enumerate() {
            if turn >= count && quiet + 1 >= count {
                break;
            }
            let motion = Motion { x, v, mass: &scene.mass, inverse_mass: &scene.inverse_mass, grab: self.grab };
            let elements = (turn < count).then(|| effect.elements(motion));
            let touched = self.scratch.booked(number, elements, |_| effect.constrain(&start, x, v));
            quiet = if touched == 0 { quiet + 1 } else { 0 };
            self.scratch.counts.constrained += touched as u64;
        }
        self.scratch.outward = outward;
        self.scratch.supplied += supplied.get();
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
