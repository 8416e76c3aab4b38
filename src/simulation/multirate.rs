//! Multirate stepping: each body and net divides a step by its own number of substeps.
//!
//! Without a contact potential bodies and nets do not interact, so that each may divide a step of the scene, of length h, into n equal substeps; at
//! the end of the step all have the same time. n = h / ([`SAFETY_FACTOR`] z/2 `h_critical`), rounded up, and
//! 1 if the step is short enough; z is the stability limit of the scheme, 2 for symplectic Euler. A sub-scene with its own part of the state ([`SubScene`]) is stepped, so that its motion has the same bits,
//! and the same cost, as alone with n times as many steps. Substeps are equal parts of h; what depends on time,
//! such as moving obstacles, is exact to round-off.
//!
//! `h_critical` is the critical step of symplectic Euler at rest. It depends on the scene alone and is computed when the scene is built or
//! changed, never while time runs. So a checkpoint, a rewind or a saved level continues with the same steps and bits.
//! As the step never changes, a symplectic scheme has no drift of energy from that. A stiff body beside a soft one hardly
//! deforms, and half of `h_critical` leaves a margin for four times the stiffness. Beyond that the guard detects the
//! instability and divides the steps of the scene, and with them all substeps.

use super::{
    Simulation,
    sleep::ASLEEP,
    system::{ASLEEP as WHY_ASLEEP, Scratch, System},
};
use crate::{
    contact::{Anchor, ContactName},
    effects::Grab,
    integrators::Integrator,
    level::Substeps,
    report::SubstepPlan,
    scene::{Scene, SubScene},
    stability::critical_step_at_rest,
    state::State,
};
use std::{ops::Range, sync::Arc};

/// Greatest substep as a fraction of the critical step at rest.
const SAFETY_FACTOR: f64 = 0.5;

/// Number of substeps between two checks for numbers that are not finite or far too large.
const FINITE_CHECK: u32 = 64;

/// Steppers of all bodies and nets; empty without multirate stepping.
#[derive(Default)]
pub(super) struct Multirate {
    all: Vec<SubstepStepper>,
    /// Whether any body or net takes more than one substep.
    is_active: bool,
    /// Whether each stops after its first substep.
    first_only: bool,
}

/// Stepper of one body or net.
struct SubstepStepper {
    sub_scene: Arc<SubScene>,
    plan: SubstepPlan,
    /// Its part of the state of the scene.
    state: State,
    /// Its range in the memory of the integrator.
    memory: Range<usize>,
    scratch: Scratch,
}

/// An interval of time and its substeps.
#[derive(Clone, Copy)]
struct StepInterval<'a> {
    integrator: &'a dyn Integrator,
    /// Length of a substep \[s\].
    h: f64,
    /// Start and end of the interval \[s\].
    time: [f64; 2],
    /// Number of substeps to take, and number of substeps in the interval.
    taken: u32,
    substeps: u32,
    grab: Option<Grab>,
}

impl Multirate {
    /// Makes the steppers of a scene.
    pub fn new(scene: &Scene) -> Self {
        let mut all: Vec<_> = scene.sub_scenes.iter().map(|sub_scene| SubstepStepper::new(scene, sub_scene)).collect();
        let is_active = all.iter().any(|stepper| stepper.plan.steps > 1);
        for stepper in all.iter_mut().filter(|_| is_active) {
            stepper.scratch.fit(&stepper.sub_scene.scene);
        }
        Self { all, is_active, first_only: false }
    }

    /// Whether any body or net takes more than one substep.
    pub const fn is_active(&self) -> bool {
        self.is_active
    }

    /// Step length of a body or net \[s\], where the scene has step length `h`.
    pub fn step(&self, number: usize, h: f64) -> f64 {
        self.all.get(number).map_or(h, |stepper| stepper.plan.step)
    }

    /// Least step length of all bodies and nets \[s\], where the scene has step length `h`.
    pub fn shortest(&self, h: f64) -> f64 {
        self.all.iter().map(|stepper| stepper.plan.step).fold(h, f64::min)
    }

    /// Sets whether each stops after its first substep.
    pub const fn stop_early(&mut self, first_only: bool) {
        self.first_only = first_only;
    }

    /// Finds the range of each stepper in the memory of the integrator: a length and that many numbers. Memory in
    /// another format belongs to none.
    fn read_memory(&mut self, memory: &[f64]) {
        let mut at = 0;
        for stepper in &mut self.all {
            let count = memory.get(at).filter(|count| **count >= 0.0 && **count < memory.len() as f64 - at as f64);
            let begin = at + usize::from(count.is_some());
            at = begin + count.map_or(0, |count| *count as usize);
            stepper.memory = begin..at;
        }
    }

    /// Writes the memory of all steppers in that format.
    fn write_memory(&self, memory: &mut Vec<f64>) {
        memory.clear();
        if self.all.iter().any(|stepper| !stepper.state.memory.is_empty()) {
            for stepper in &self.all {
                memory.push(stepper.state.memory.len() as f64);
                memory.extend_from_slice(&stepper.state.memory);
            }
        }
    }
}

impl SubstepStepper {
    fn new(whole: &Scene, sub_scene: &Arc<SubScene>) -> Self {
        let limit = sub_scene.limit(critical_step_at_rest);
        // Forward Euler and Heun have no stable step without damping: the limit of symplectic Euler is taken for them.
        let stability_limit = whole.integrator.kind().stability_limit().filter(|limit| *limit > 0.0).unwrap_or(2.0);
        let wanted = limit.map_or(1.0, |limit| whole.step / (SAFETY_FACTOR * 0.5 * stability_limit * limit));
        let steps = libm::ceil(wanted).clamp(1.0, Substeps::most_parts(whole.step)) as u32;
        Self {
            sub_scene: Arc::clone(sub_scene),
            plan: SubstepPlan { steps, step: substep(whole.step, steps), limit },
            state: State::default(),
            memory: 0..0,
            scratch: Scratch::default(),
        }
    }

    /// Loads the anchors of its contacts, with the numbers of its own scene.
    fn load_anchors(&mut self, whole: &State) {
        let SubScene { vertices, effects, .. } = &*self.sub_scene;
        self.state.anchors.clear();
        for anchor in &whole.anchors {
            let ContactName { effect, surface, vertex } = anchor.contact;
            let own = effects.iter().position(|number| *number == effect as usize);
            if let Some(own) = own.filter(|_| vertices.contains(&(vertex as usize))) {
                let contact = ContactName { effect: own as u32, surface, vertex: vertex - vertices.start as u32 };
                self.state.anchors.push(Anchor { contact, ..*anchor });
            }
        }
    }

    /// Replaces the anchors of its contacts in the state of the scene.
    fn store_anchors(&self, whole: &mut State) {
        let SubScene { vertices, effects, .. } = &*self.sub_scene;
        whole.anchors.retain(|anchor| !vertices.contains(&(anchor.contact.vertex as usize)));
        whole.anchors.extend(self.state.anchors.iter().map(|anchor| {
            let ContactName { effect, surface, vertex } = anchor.contact;
            let (effect, vertex) = (effects[effect as usize] as u32, vertex + vertices.start as u32);
            Anchor { contact: ContactName { effect, surface, vertex }, ..*anchor }
        }));
    }

    fn numbers(&self) -> Range<usize> {
        self.sub_scene.scene.numbers(&self.sub_scene.vertices)
    }

    /// Loads its memory from the state of the scene.
    fn load_memory(&mut self, whole: &State) {
        self.state.memory.clear();
        self.state.memory.extend_from_slice(&whole.memory[self.memory.clone()]);
    }

    /// Steps over an interval from the state of the scene, and writes the result back.
    fn advance(&mut self, interval: StepInterval<'_>, whole: &mut State, parent: &mut Scratch) {
        (self.scratch.measured, self.scratch.clear_box, self.scratch.supplied) =
            (parent.measured, parent.clear_box, 0.0);
        self.scratch.pushes_out = false;
        self.state.x.clear();
        self.state.x.extend_from_slice(&whole.x[self.numbers()]);
        self.state.v.clear();
        self.state.v.extend_from_slice(&whole.v[self.numbers()]);
        self.load_memory(whole);
        self.load_anchors(whole);
        self.take_substeps(interval);
        whole.x[self.numbers()].copy_from_slice(&self.state.x);
        whole.v[self.numbers()].copy_from_slice(&self.state.v);
        self.store_anchors(whole);
        parent.pushes_out |= self.scratch.pushes_out;
        parent.merge(&mut self.scratch, &self.sub_scene.effects);
    }

    /// Takes all substeps, or those up to the first that leaves the box in which constraints are skipped: the
    /// caller then repeats the step with the constraints.
    fn take_substeps(&mut self, interval: StepInterval<'_>) {
        let [start, end] = interval.time;
        let length = (end - start) / f64::from(interval.substeps);
        let at = |substep: u32| if substep == interval.substeps { end } else { start + f64::from(substep) * length };
        for substep in 0..interval.taken {
            let mut workspace = std::mem::take(&mut self.scratch.workspace);
            let scene = &self.sub_scene.scene;
            let time = [at(substep), at(substep + 1)];
            let mut system =
                System::begin((scene, &scene.effects), &mut self.scratch, interval.grab, time, &mut self.state);
            let counts = interval.integrator.step(&mut system, &mut self.state, &mut workspace, interval.h);
            system.end(interval.h, &mut self.state);
            self.scratch.workspace = workspace;
            self.scratch.counts.add(&counts);
            // The whole step is refused then.
            if substep % FINITE_CHECK == 0 && !self.state.is_finite() {
                return;
            }
            if self.scratch.clear_box.is_some() {
                if !self.state.is_within(self.scratch.clear_box) {
                    return;
                }
                self.scratch.pass_over_obstacles();
            }
        }
    }
}

impl Simulation {
    /// Substeps of bodies and then nets; empty if all take the steps of the scene.
    pub fn substep_plans(&self) -> impl Iterator<Item = SubstepPlan> {
        self.multirate.all.iter().map(|stepper| stepper.plan)
    }

    /// Takes one step of length h, from one time to another \[s\], of each awake body and net with its own substeps.
    pub(super) fn integrate_each(&mut self, h: f64, time: [f64; 2]) {
        let Self { multirate, scene, state, scratch, grab, guard, .. } = self;
        let integrator = scene.integrator.kind();
        // The guard may have divided the step by 2, 4, ..., which is exact in floating point.
        let cut = h / scene.step;
        multirate.read_memory(&state.memory);
        scratch.begin_statistics();
        let mut supplied = 0.0;
        for (number, stepper) in multirate.all.iter_mut().enumerate() {
            if state.slow_checks.get(number) == Some(&ASLEEP) {
                stepper.load_memory(state);
                scratch.costs[number].pass_over(WHY_ASLEEP);
                continue;
            }
            let Range { start, end } = stepper.sub_scene.vertices;
            let pulled = grab.filter(|grab| (start..end).contains(&grab.vertex));
            let grab = pulled.map(|grab| Grab { vertex: grab.vertex - start, ..grab });
            let SubstepPlan { steps: substeps, step, .. } = stepper.plan;
            let taken = if multirate.first_only { 1 } else { substeps };
            stepper.advance(StepInterval { integrator, h: step * cut, time, taken, substeps, grab }, state, scratch);
            supplied += stepper.scratch.supplied;
        }
        multirate.write_memory(&mut state.memory);
        state.anchors.sort_unstable_by_key(|anchor| anchor.contact);
        guard.supply(supplied);
    }
}

/// Length of one of n equal substeps \[s\]: exactly the step length for n times as many steps a frame.
fn substep(step: f64, substeps: u32) -> f64 {
    let of = |count: f64| Substeps::new(count as u32).ok().map(Substeps::step);
    let frame = libm::round(1.0 / (60.0 * step));
    let exact = of(frame).filter(|whole| *whole == step).and_then(|_| of(frame * f64::from(substeps)));
    exact.unwrap_or(step / f64::from(substeps))
}
