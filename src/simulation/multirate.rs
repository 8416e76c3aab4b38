//! Multirate stepping: each body and net divides a step by itself.
//!
//! Bodies and nets do not touch each other, so that each may take a step of the scene, of length h, in as many equal parts as it
//! needs; at the end of the step all meet again. Each needs n = h / ([`SHARE`] `h_critical`) parts, rounded up: one if its step is
//! short enough as it is. What is stepped is a scene of its own with its own part of the state ([`SubScene`]), so that its motion has
//! every bit that it would have alone with n times as many steps, and costs no more. Time is cut into equal parts of h, so what
//! depends on time, which is only obstacles that move, has it to round-off.
//!
//! `h_critical` is that at rest. It depends on nothing but the scene: it is found when the scene is built or changed and never
//! while time runs, so that a checkpoint, a rewind or a saved level goes on with the same steps and the same bits, and no change
//! of steps lets the energy of a symplectic scheme drift. What is stiff beside what is soft hardly deforms, and half of
//! `h_critical` leaves room for four times the stiffness. Beyond that the guard notices, as it does everywhere, and takes steps of
//! the scene in shorter ones, and with them the parts of all.

use super::{
    Simulation,
    sleep::ASLEEP,
    system::{ASLEEP as WHY_ASLEEP, Scratch, System},
};
use crate::{
    effects::Grab,
    integrators::Integrator,
    level::Substeps,
    obstacles::Inside,
    report::SubstepPlan,
    scene::{Scene, SubScene},
    stability::critical_step,
    state::State,
};
use std::{ops::Range, sync::Arc};

/// The greatest share of its longest stable step at rest that a body or net steps with.
const SHARE: f64 = 0.5;

/// All bodies and nets with their paces, if they have their own.
#[derive(Default)]
pub(super) struct Multirate {
    all: Vec<SubstepStepper>,
    /// Whether any of them takes more steps than the scene.
    is_active: bool,
    /// Whether each stops after the first part of a step.
    first_only: bool,
}

/// A body or net that goes at its own pace.
struct SubstepStepper {
    sub_scene: Arc<SubScene>,
    plan: SubstepPlan,
    /// Its part of the state.
    state: State,
    /// Where in what the integrator remembers its own part is.
    memory: Range<usize>,
    scratch: Scratch,
}

/// A stretch of time that is walked.
#[derive(Clone, Copy)]
struct StepInterval<'a> {
    integrator: &'a dyn Integrator,
    /// Length of a part [s].
    h: f64,
    /// Where it begins and ends [s].
    time: [f64; 2],
    /// How many parts are taken of how many.
    taken: u32,
    substeps: u32,
    grab: Option<Grab>,
}

impl Multirate {
    /// Those of a scene.
    pub fn new(scene: &Scene) -> Self {
        let mut all: Vec<_> = scene.sub_scenes.iter().map(|sub_scene| SubstepStepper::new(scene, sub_scene)).collect();
        let is_active = all.iter().any(|stepper| stepper.plan.steps > 1);
        for stepper in all.iter_mut().filter(|_| is_active) {
            stepper.scratch.fit(&stepper.sub_scene.scene);
        }
        Self { all, is_active, first_only: false }
    }

    /// Whether any of them takes more steps than the scene.
    pub const fn is_active(&self) -> bool {
        self.is_active
    }

    /// Length of the steps of a body or net [s], where those of the scene have length `h`.
    pub fn step(&self, number: usize, h: f64) -> f64 {
        self.all.get(number).map_or(h, |stepper| stepper.plan.step)
    }

    /// Length of the shortest step that any of them takes [s], where those of the scene have length `h`.
    pub fn shortest(&self, h: f64) -> f64 {
        self.all.iter().map(|stepper| stepper.plan.step).fold(h, f64::min)
    }

    /// Lets each stop after the first part of a step, or not.
    pub const fn stop_early(&mut self, first_only: bool) {
        self.first_only = first_only;
    }

    /// Finds the part of each in what the integrator remembers: how many numbers it is, and these. What was written otherwise
    /// belongs to none.
    fn read_memory(&mut self, memory: &[f64]) {
        let mut at = 0;
        for stepper in &mut self.all {
            let count = memory.get(at).filter(|count| **count >= 0.0 && **count < memory.len() as f64 - at as f64);
            let begin = at + usize::from(count.is_some());
            at = begin + count.map_or(0, |count| *count as usize);
            stepper.memory = begin..at;
        }
    }

    /// And writes it.
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
        let limit = sub_scene.limit(|scene| {
            let rest = State { x: scene.rest.clone(), v: vec![0.0; scene.rest.len()], ..State::default() };
            critical_step(scene, &rest)
        });
        // Vibrations that a scheme lets grow at every step it lets grow at this one.
        let stability_limit = whole.integrator.kind().stability_limit().filter(|limit| *limit > 0.0).unwrap_or(2.0);
        let most = (f64::from(Substeps::MAX) * 60.0 * whole.step).max(1.0);
        let wanted = limit.map_or(1.0, |limit| whole.step / (SHARE * 0.5 * stability_limit * limit));
        let steps = libm::ceil(wanted).clamp(1.0, libm::floor(most)) as u32;
        Self {
            sub_scene: Arc::clone(sub_scene),
            plan: SubstepPlan { steps, step: substep(whole.step, steps), limit },
            state: State::default(),
            memory: 0..0,
            scratch: Scratch::default(),
        }
    }

    fn numbers(&self) -> Range<usize> {
        2 * self.sub_scene.vertices.start..2 * self.sub_scene.vertices.end
    }

    /// Takes what the integrator remembers from the whole state.
    fn load_memory(&mut self, whole: &State) {
        self.state.memory.clear();
        self.state.memory.extend_from_slice(&whole.memory[self.memory.clone()]);
    }

    /// Goes a way from where the whole state says, and writes to it where that led.
    fn advance(&mut self, interval: StepInterval<'_>, whole: &mut State, parent: &mut Scratch) {
        (self.scratch.timed, self.scratch.clear_box, self.scratch.supplied) = (parent.timed, parent.clear_box, 0.0);
        self.scratch.inside = Inside::Nothing;
        self.state.x.clear();
        self.state.x.extend_from_slice(&whole.x[self.numbers()]);
        self.state.v.clear();
        self.state.v.extend_from_slice(&whole.v[self.numbers()]);
        self.load_memory(whole);
        self.take_substeps(interval);
        whole.x[self.numbers()].copy_from_slice(&self.state.x);
        whole.v[self.numbers()].copy_from_slice(&self.state.v);
        parent.inside = parent.inside.max(self.scratch.inside);
        parent.merge(&mut self.scratch, &self.sub_scene.effects);
    }

    /// Takes all parts; or all up to the first that leaves the box in which no constraint is asked: whoever looks where the step
    /// led finds that, and has it taken again with the constraints.
    fn take_substeps(&mut self, interval: StepInterval<'_>) {
        let [start, end] = interval.time;
        let length = (end - start) / f64::from(interval.substeps);
        let at = |substep: u32| if substep == interval.substeps { end } else { start + f64::from(substep) * length };
        for substep in 0..interval.taken {
            let mut workspace = std::mem::take(&mut self.scratch.workspace);
            let scene = &self.sub_scene.scene;
            let time = [at(substep), at(substep + 1)];
            let mut system = System { scene, scratch: &mut self.scratch, grab: interval.grab, time };
            let counts = interval.integrator.step(&mut system, &mut self.state, &mut workspace, interval.h);
            self.scratch.workspace = workspace;
            self.scratch.counts.add(&counts);
            if let Some(clear_box) = self.scratch.clear_box {
                if !self.state.is_within(clear_box) {
                    return;
                }
                self.scratch.pass_over_constraints();
            }
        }
    }
}

impl Simulation {
    /// Bodies and then nets with their paces; nothing if all take the same steps, whatever they are.
    pub fn substep_plans(&self) -> impl Iterator<Item = SubstepPlan> {
        self.multirate.all.iter().map(|stepper| stepper.plan)
    }

    /// One step of length h, from one time to another [s], of each body and net that is awake at its own pace.
    pub(super) fn integrate_each(&mut self, h: f64, time: [f64; 2]) {
        let Self { multirate, scene, state, scratch, grab, guard, .. } = self;
        let integrator = scene.integrator.kind();
        // The guard may have cut the step in two, four, ..., which is exact.
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
        guard.supply(supplied);
    }
}

/// The length of one of so many parts of a step [s]: just that of as many times more steps in a frame.
fn substep(step: f64, substeps: u32) -> f64 {
    let of = |count: f64| Substeps::new(count as u32).ok().map(Substeps::step);
    let frame = libm::round(1.0 / (60.0 * step));
    let exact = of(frame).filter(|whole| *whole == step).and_then(|_| of(frame * f64::from(substeps)));
    exact.unwrap_or(step / f64::from(substeps))
}
