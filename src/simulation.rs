//! A scene with its state: taking steps, keeping the books, and never letting a number that is none reach anyone.

use crate::{
    effects::{Effect, Grab, Motion},
    fault::Fault,
    integrators::{Dynamics, Ode, Scheme, StepCounts, Work},
    obstacles::{Start, Surface},
    report::{Counts, EffectCost, Energies},
    scene::Scene,
    solvers::{BlockMatrix, Weights},
    state::State,
    toys::Toy,
};
use std::time::Duration;
use web_time::Instant;

/// A running scene.
pub struct Simulation {
    scene: Scene,
    state: State,
    /// Where the current batch of steps began, to go back to when a step fails.
    checkpoint: State,
    /// What had been counted and booked then.
    booked: (Counts, Vec<EffectCost>),
    scratch: Scratch,
    grab: Option<Grab>,
    fault: Option<Fault>,
}

/// Everything that stepping writes to beside the state.
#[derive(Default)]
struct Scratch {
    /// For the integrator.
    work: Work,
    /// For the effects.
    effects: Vec<f64>,
    /// Outward normals of the vertices.
    outward: Vec<f64>,
    counts: Counts,
    costs: Vec<EffectCost>,
    /// Whether effects are timed.
    timed: bool,
}

/// How many steps are taken between two looks at the clock.
const BATCH: u64 = 10;

/// Most turns that constraints take in a step.
const TURNS: usize = 4;

impl Simulation {
    /// A scene in a state. The state must belong to the scene (see [`Scene::first_state`]).
    pub fn new(scene: Scene, state: State) -> Self {
        let mut scratch = Scratch::default();
        scratch.fit(&scene);
        Self {
            checkpoint: state.clone(),
            booked: (Counts::default(), Vec::new()),
            scene,
            state,
            scratch,
            grab: None,
            fault: None,
        }
    }

    /// Swaps the scene; the state stays, and newly pinned vertices stop. A scene with other vertices needs another state at
    /// once (see [`Self::set_state`]). Counts go on.
    pub fn replace_scene(&mut self, scene: Scene) {
        for (v, _) in self.state.v.iter_mut().zip(&scene.inverse_mass).filter(|(_, inverse)| **inverse == 0.0) {
            *v = 0.0;
        }
        self.scene = scene;
        self.scratch.fit(&self.scene);
    }

    /// Puts the simulation into a state; a fault is forgotten.
    pub fn set_state(&mut self, state: State) {
        self.state = state;
        self.grab = None;
        self.fault = None;
    }

    /// Pulls a vertex, or lets go.
    pub fn set_grab(&mut self, grab: Option<Grab>) {
        self.grab = grab;
    }

    /// What the mouse pulls.
    pub const fn grab(&self) -> Option<Grab> {
        self.grab
    }

    /// The constant side.
    pub const fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The moving side.
    pub const fn state(&self) -> &State {
        &self.state
    }

    /// Why stepping stopped, if it did.
    pub const fn fault(&self) -> Option<&Fault> {
        self.fault.as_ref()
    }

    /// What stepping cost so far.
    pub const fn counts(&self) -> Counts {
        self.scratch.counts
    }

    /// What each effect cost so far.
    pub fn costs(&self) -> &[EffectCost] {
        &self.scratch.costs
    }

    /// Whether the time spent in each effect is measured; reading the clock costs a few per cent.
    pub fn set_timed(&mut self, timed: bool) {
        self.scratch.timed = timed;
    }

    /// Takes up to `steps` steps; every few, `more` is asked whether to go on. Returns how many were taken.
    ///
    /// Every step is checked. If one leaves anything that is not a number, the state before it is restored, exactly, and
    /// the fault is kept until the state is set anew.
    pub fn advance(&mut self, steps: u64, more: &mut dyn FnMut() -> bool) -> u64 {
        let mut taken = 0;
        while taken < steps && self.fault.is_none() && (taken == 0 || more()) {
            let batch = BATCH.min(steps - taken);
            taken += self.batch(batch);
        }
        taken
    }

    fn batch(&mut self, steps: u64) -> u64 {
        self.checkpoint.clone_from(&self.state);
        self.booked.0 = self.scratch.counts;
        self.booked.1.clone_from(&self.scratch.costs);
        for taken in 0..steps {
            self.step();
            if !self.state.is_finite() {
                self.fail(taken);
                return taken;
            }
        }
        steps
    }

    fn step(&mut self) {
        let h = self.scene.step;
        let mut work = std::mem::take(&mut self.scratch.work);
        let integrator = self.scene.integrator.kind();
        let counts = match (&self.scene.toy, integrator.scheme()) {
            (Some(toy), Scheme::First(scheme)) => {
                let mut system = ToySystem { toy: toy.kind(), counts: &mut self.scratch.counts };
                scheme.step(&mut system, &mut self.state, &mut work, h)
            }
            // A toy with another scheme is not built.
            (Some(_), Scheme::Second(_)) => StepCounts::ONE,
            (None, _) => {
                let mut system = System { scene: &self.scene, scratch: &mut self.scratch, grab: self.grab };
                integrator.step(&mut system, &mut self.state, &mut work, h)
            }
        };
        self.scratch.work = work;
        self.scratch.counts.add(&counts);
        self.state.steps += 1;
        self.state.time += h;
    }

    /// Goes back to the last finite state: the same steps from the checkpoint give the same bits again.
    fn fail(&mut self, good: u64) {
        self.state.clone_from(&self.checkpoint);
        self.scratch.counts = self.booked.0;
        self.scratch.costs.clone_from(&self.booked.1);
        self.scratch.work.forget();
        for _ in 0..good {
            self.step();
        }
        self.fault = Some(Fault::find(&self.scene, &self.state, &self.checkpoint));
    }

    /// Energies now [J].
    pub fn energies(&self) -> Energies {
        if let (Some(toy), &[a, b]) = (&self.scene.toy, self.state.x.as_slice()) {
            let [kinetic, potential] = toy.kind().energies([a, b]);
            return Energies { kinetic, elastic: 0.0, potential };
        }
        let motion = self.scene.motion(&self.state, self.grab);
        let speeds = motion.v.iter().zip(motion.mass);
        let kinetic = 0.5 * speeds.map(|(v, mass)| mass * v * v).sum::<f64>();
        let (elastic, other) = self.scene.effects.split_at(self.scene.element_count());
        let stored = |effects: &[std::sync::Arc<dyn Effect>]| effects.iter().map(|effect| effect.energy(motion)).sum();
        Energies { kinetic, elastic: stored(elastic), potential: stored(other) }
    }

    /// Least det F of all triangles (infinite if there are none), and how many have det F <= 0.
    pub fn inversion(&self) -> (f64, usize) {
        let ratios = self.scene.bodies.iter().flat_map(|body| body.elements.volume_ratios(&self.state.x));
        ratios.fold((f64::INFINITY, 0), |(least, count), j| (least.min(j), count + usize::from(j <= 0.0)))
    }
}

impl Scratch {
    fn fit(&mut self, scene: &Scene) {
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
struct System<'a> {
    scene: &'a Scene,
    scratch: &'a mut Scratch,
    grab: Option<Grab>,
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

    /// Walls and edges of the world may push where the others do not allow: they take turns until no other has anything to say.
    fn constrain(&mut self, [before_x, before_v]: [&[f64]; 2], x: &mut [f64], v: &mut [f64], faces: bool) {
        let scene = self.scene;
        let mut surface = Surface::default();
        scene.effects.iter().for_each(|effect| effect.coat(&mut surface));
        let mut outward = std::mem::take(&mut self.scratch.outward);
        if faces {
            scene.outward(before_x, &mut outward);
        }
        let outward_of = faces.then_some(outward.as_slice());
        let start = Start { x: before_x, v: before_v, inverse_mass: &scene.inverse_mass, surface, outward: outward_of };
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
    }
}

/// A toy as the integrator sees it; its rates count as forces.
struct ToySystem<'a> {
    toy: &'a dyn Toy,
    counts: &'a mut Counts,
}

impl Ode for ToySystem<'_> {
    fn rate(&mut self, x: &[f64], rate: &mut [f64]) {
        self.counts.force_evaluations += 1;
        if let &[a, b] = x {
            rate.copy_from_slice(&self.toy.rate([a, b]));
        }
    }
}
