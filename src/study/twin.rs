//! Error of a running simulation, against a closed form if there is one.
//! Otherwise it is against a twin: a run with a fine step beside it, which the same mouse pulls.

use super::{
    ClosedForm,
    march::Deadline,
    reference::{STILL, finest},
    trial::{Deviation, limit},
};
use crate::{clock::Stopwatch, effects::Grab, level::Sleep, scene::Scene, simulation::Simulation, state::State};
use std::{collections::VecDeque, sync::Arc, time::Duration};

/// Fine reference run beside a live simulation. It takes a whole number of shorter steps for each live step.
///
/// For the first half second it checks itself against a second twin with half the step. If the two differ by more
/// than a hundredth of the live simulation's error, the twin halves its step and restarts from the live state.
///
/// If the live simulation has a [`ClosedForm`], the error is against that, and no twin runs.
pub struct Twin {
    /// Closed form, if there is one.
    exact: Option<ClosedForm>,
    fine: Simulation,
    /// Second twin with half the step, during the check.
    finer: Option<Simulation>,
    /// Twin steps per live step.
    per_step: u64,
    /// Step of the live simulation at the last call \[s\].
    step: f64,
    /// Start state.
    start: State,
    /// Step count of the live simulation at the last call.
    seen: u64,
    /// Motion of the live simulation that the twin has not computed yet.
    legs: VecDeque<Leg>,
    live: Tally,
    own: Deviation,
    spent: Duration,
    simulated: f64,
}

/// Statistics of the live simulation's error.
struct Tally {
    /// Sums over all comparisons.
    all: Deviation,
    /// Number of comparisons.
    moments: f64,
    /// Relative error at the last comparison.
    error: Option<f64>,
    /// Simulated time of the last comparison \[s\].
    time: Option<f64>,
}

impl Tally {
    /// No comparisons yet, in so many dimensions.
    const fn new(dimension: usize) -> Self {
        Self { all: Deviation::new(dimension), moments: 0.0, error: None, time: None }
    }

    /// Adds a comparison of positions with exact ones at a time \[s\]. The motion is measured from `origin`.
    fn note(&mut self, x: &[f64], exact: &[f64], origin: &[f64], time: f64) {
        let mut now = self.all.anew();
        now.add(x, exact, origin);
        self.all.add(x, exact, origin);
        self.moments += 1.0;
        let extent = origin.iter().fold(0.0_f64, |greatest, x| greatest.max(x.abs()));
        let moves = self.all.motion() > STILL * extent;
        self.error = moves.then(|| now.relative_to(self.all, self.moments));
        self.time = Some(time);
    }
}

/// Interval of the live simulation without a change from outside.
struct Leg {
    steps: u64,
    /// Steps of the twin computed.
    taken: u64,
    grab: Option<Grab>,
    /// Scene, if it has changed.
    scene: Option<Box<Scene>>,
    /// Live positions at the end of the interval \[m\].
    x: Vec<f64>,
    /// Simulated time at the end of the interval \[s\].
    time: f64,
}

/// Duration of the check \[s\].
const CHECK: f64 = 0.5;
/// Greatest number of waiting legs. Beyond it the twin restarts.
const BEHIND: usize = 240;
/// Greatest number of twin steps per live step.
const MOST: u64 = 1 << 14;

impl Twin {
    /// Starts a twin at the present state of a live simulation.
    pub fn new(live: &Simulation) -> Self {
        let share = 2.0 * limit(live.scene(), live.state()) * 60.0 * live.scene().step;
        Self::seeded(live, libm::ceil(share.max(4.0)).min(MOST as f64) as u64)
    }

    /// Restarts the twin at the present state of the live simulation, for example after it was moved.
    pub fn seed(&mut self, live: &Simulation) {
        let (spent, simulated) = (self.spent, self.simulated);
        *self = Self { spent, simulated, ..Self::seeded(live, self.per_step) };
    }

    fn seeded(live: &Simulation, per_step: u64) -> Self {
        let start = State { memory: Vec::new(), ..live.state().clone() };
        let exact = ClosedForm::of_running(live.scene(), &start, live.grab());
        let run = |per_step: u64| Simulation::new(finer_scene(live.scene(), per_step), start.clone());
        Self {
            fine: run(per_step),
            finer: exact.is_none().then(|| run(2 * per_step)),
            exact,
            per_step,
            step: live.scene().step,
            seen: start.steps,
            start,
            legs: VecDeque::new(),
            live: Tally::new(live.scene().dimension),
            own: Deviation::new(live.scene().dimension),
            spent: Duration::ZERO,
            simulated: 0.0,
        }
    }

    /// Records the motion of the live simulation since the last call.
    /// Call it after every frame and before every change from outside. If the live simulation was set back, or is
    /// another one, the twin restarts.
    pub fn follow(&mut self, live: &Simulation) {
        let (state, scene) = (live.state(), live.scene());
        let known = self.legs.iter().rev().find_map(|leg| leg.scene.as_deref()).unwrap_or(self.fine.scene());
        let changed = self.step != scene.step || !same(known, scene);
        let elsewhere = state.steps < self.seen || state.x.len() != self.start.x.len();
        // A closed form does not include a grab or a change.
        let unforeseen = self.exact.is_some() && (changed || live.grab().is_some());
        if elsewhere || unforeseen || self.legs.len() > BEHIND {
            self.seed(live);
            return;
        }
        if state.steps == self.seen && !changed {
            return;
        }
        let scene = changed.then(|| Box::new(scene.clone()));
        let steps = state.steps - self.seen;
        self.legs.push_back(Leg { steps, taken: 0, grab: live.grab(), scene, x: state.x.clone(), time: state.time });
        (self.seen, self.step) = (state.steps, live.scene().step);
    }

    /// Works for about `budget`. Returns whether the twin has caught up.
    pub fn advance(&mut self, live: &Simulation, budget: Duration) -> bool {
        if let Some(exact) = &self.exact {
            for leg in self.legs.drain(..) {
                self.live.note(&leg.x, &exact.positions(leg.time), &exact.origin, leg.time);
            }
            return true;
        }
        let (stopwatch, deadline) = (Stopwatch::start(), Deadline::after(budget));
        while let Some(leg) = self.legs.front_mut() {
            if let Some(scene) = leg.scene.take() {
                self.fine.replace_scene(finer_scene(&scene, self.per_step));
                if let Some(finer) = &mut self.finer {
                    finer.replace_scene(finer_scene(&scene, 2 * self.per_step));
                }
            }
            self.fine.set_grab(leg.grab);
            let all = leg.steps * self.per_step;
            while leg.taken < all && self.fine.fault().is_none() && !deadline.passed() {
                let bunch = (all - leg.taken).min(16);
                self.fine.advance(bunch, &mut || true);
                if let Some(finer) = &mut self.finer {
                    finer.set_grab(leg.grab);
                    finer.advance(2 * bunch, &mut || true);
                }
                leg.taken += bunch;
                self.simulated += bunch as f64 * self.fine.scene().step;
            }
            if self.fine.fault().is_some() {
                self.refine(live);
                break;
            }
            if leg.taken < all {
                break;
            }
            if let Some(leg) = self.legs.pop_front() {
                self.compare(&leg, live);
            }
        }
        self.spent += stopwatch.elapsed();
        self.legs.is_empty()
    }

    /// Compares positions at the end of a leg.
    fn compare(&mut self, leg: &Leg, live: &Simulation) {
        let exact = &self.fine.state().x;
        self.live.note(&leg.x, exact, &self.start.x, leg.time);
        let Some(finer) = &self.finer else { return };
        if finer.fault().is_none() {
            self.own.add(exact, &finer.state().x, &self.start.x);
        }
        let (own, error) = (self.own.relative(), self.live.all.relative());
        if self.live.error.is_some() && own > 0.01 * error && own > 1e-12 && self.per_step < MOST {
            self.refine(live);
        } else if self.fine.state().time - self.start.time >= CHECK {
            self.finer = None;
        }
    }

    /// Restarts with half the step.
    fn refine(&mut self, live: &Simulation) {
        self.per_step = (2 * self.per_step).min(MOST);
        self.seed(live);
    }

    /// Relative RMS error of the live positions at the last comparison.
    /// It is `sqrt(mean |x - x_ref|²)` over the root mean square of `x_ref - x_start` so far. `None` before the first
    /// comparison, and while the motion is only round-off.
    pub const fn error(&self) -> Option<f64> {
        self.live.error
    }

    /// Closed form of the error, if there is one.
    pub const fn exact(&self) -> Option<&ClosedForm> {
        self.exact.as_ref()
    }

    /// The twin's own error by the same measure, over the time of its check.
    pub fn own_error(&self) -> f64 {
        self.own.relative()
    }

    /// Whether the check is still running.
    pub const fn is_checking(&self) -> bool {
        self.finer.is_some()
    }

    /// Time from the start to the last comparison \[s\].
    pub fn age(&self) -> f64 {
        self.live.time.map_or(0.0, |time| time - self.start.time)
    }

    /// Total processor time of the twin.
    pub const fn spent(&self) -> Duration {
        self.spent
    }

    /// Processor time of the twin per second of simulated time \[ms\].
    pub fn ms_per_second(&self) -> f64 {
        if self.simulated > 0.0 { self.spent.as_secs_f64() * 1e3 / self.simulated } else { 0.0 }
    }
}

fn finer_scene(live: &Scene, per_step: u64) -> Scene {
    Scene {
        integrator: finest(),
        step: live.step / per_step as f64,
        guard: false,
        sleep: Sleep::Off,
        sub_scenes: Vec::new(),
        ..live.clone()
    }
}

/// Whether two scenes have the same effects and masses. Integrator and step may differ.
fn same(known: &Scene, live: &Scene) -> bool {
    let effects = known.effects.len() == live.effects.len()
        && known.effects.iter().zip(&live.effects).all(|(a, b)| Arc::ptr_eq(a, b));
    effects && known.inverse_mass == live.inverse_mass && known.coupled_mass == live.coupled_mass
}
