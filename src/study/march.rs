//! Runs of a study: steps frame by frame, their processor time, repetitions, threads.

use super::Setting;
use crate::{
    clock::{Duration, Instant, RESOLUTION, Stopwatch},
    level::Sleep,
    scene::Scene,
    simulation::Simulation,
    state::State,
};
use std::ops::ControlFlow;
#[cfg(not(target_arch = "wasm32"))]
use std::sync::{Mutex, PoisonError};

/// End of the time budget of a call.
#[derive(Clone, Copy, Debug)]
pub struct Deadline(Option<Instant>);

impl Deadline {
    /// Deadline after a duration; none if the instant cannot be represented.
    pub fn after(budget: Duration) -> Self {
        Self(Instant::now().checked_add(budget))
    }

    /// Whether the deadline has passed.
    pub fn passed(self) -> bool {
        self.0.is_some_and(|moment| Instant::now() >= moment)
    }
}

/// Simulation of a number of frames of 1/60 s, each of a whole number of steps.
pub(super) struct March {
    pub simulation: Simulation,
    /// Processor time of stepping.
    pub spent: Duration,
    /// Number of frames to compute.
    pub frames: u32,
    /// Number of frames computed.
    pub frame: u32,
    substeps: u64,
    /// Steps computed in the present frame.
    taken: u64,
    /// Steps between two readings of the clock.
    bunch: u64,
}

/// Longest time between two readings of the clock, if a single step is shorter.
const POLL_INTERVAL: Duration = Duration::from_micros(400);

impl March {
    /// Simulation of `frames` frames from a state.
    pub fn new(scene: &Scene, start: &State, setting: &Setting, frames: u32) -> Self {
        // A study measures the setting itself, including its instability. Guard and sleep are therefore off.
        let (integrator, step) = (setting.integrator.clone(), setting.substeps.step());
        let scene =
            Scene { integrator, step, guard: false, sleep: Sleep::Off, sub_scenes: Vec::new(), ..scene.clone() };
        // The memory of another integrator is invalid for this one.
        let start = State { memory: Vec::new(), ..start.clone() };
        let simulation = Simulation::new(scene, start);
        let substeps = u64::from(setting.substeps.get());
        Self { simulation, spent: Duration::ZERO, frames, frame: 0, substeps, taken: 0, bunch: 1 }
    }

    /// Steps until the deadline, the last frame, a fault, or until `seen` breaks off. Returns whether the march is
    /// over.
    /// `seen` is called at the end of every frame.
    pub fn advance(&mut self, deadline: Deadline, seen: &mut dyn FnMut(u32, &Simulation) -> ControlFlow<()>) -> bool {
        let mut stopwatch = Stopwatch::start();
        while self.frame < self.frames {
            let begin = Instant::now();
            let taken = self.simulation.advance(self.bunch.min(self.substeps - self.taken), &mut || true);
            let elapsed = begin.elapsed();
            self.taken += taken;
            // The number of steps per bunch changes only how often the clock is read.
            self.bunch = if elapsed < POLL_INTERVAL { (2 * self.bunch).min(256) } else { (self.bunch / 2).max(1) };
            if self.simulation.fault().is_some() {
                self.spent += stopwatch.elapsed();
                return true;
            }
            if self.taken == self.substeps {
                self.taken = 0;
                self.frame += 1;
                self.spent += stopwatch.elapsed();
                if seen(self.frame, &self.simulation).is_break() {
                    return true;
                }
                // The time of `seen` is not part of the measured time.
                stopwatch = Stopwatch::start();
            }
            if deadline.passed() {
                break;
            }
        }
        self.spent += stopwatch.elapsed();
        self.frame == self.frames
    }

    /// Steps until the deadline, the last frame or a fault, without a callback. Returns whether the march is over.
    pub fn repeat(&mut self, deadline: Deadline) -> bool {
        self.advance(deadline, &mut |_, _| ControlFlow::Continue(()))
    }

    /// Share of the frames computed.
    pub fn done(&self) -> f64 {
        (f64::from(self.frame) + self.taken as f64 / self.substeps as f64) / f64::from(self.frames.max(1))
    }

    /// Processor time per second of simulated time \[ms\]; no less than [`RESOLUTION`].
    pub fn ms_per_second(&self) -> f64 {
        let seconds = (f64::from(self.frame) + self.taken as f64 / self.substeps as f64) / 60.0;
        if seconds > 0.0 { self.spent.max(RESOLUTION).as_secs_f64() * 1e3 / seconds } else { 0.0 }
    }
}

/// Rounds of repetitions after the first runs.
const ROUNDS: u32 = 4;
/// Budget of all repetitions, as a share of the processor time of the first runs; and the least budget.
const SHARE: f64 = 0.4;
const LEAST: Duration = Duration::from_millis(100);

/// Greatest number of runs of one setting. The stated time is the least of them.
pub const MOST_RUNS: u32 = 1 + ROUNDS;

/// Repetition rounds of one study.
#[derive(Default)]
pub(super) struct Repetitions {
    round: u32,
    /// Time budget of the remaining rounds. `None` before the first round.
    budget: Option<Duration>,
}

impl Repetitions {
    /// Runs to repeat in the next round, the shortest first. Empty after the last round.
    /// `costs` holds the time of each run, `first` the time of all first runs. A round takes at most half of the
    /// remaining budget, the last round all of it.
    pub fn next(&mut self, costs: &[Option<Duration>], first: Duration) -> Vec<usize> {
        if self.round == ROUNDS {
            return Vec::new();
        }
        self.round += 1;
        let budget = self.budget.unwrap_or_else(|| first.mul_f64(SHARE).max(LEAST));
        let most = if self.round == ROUNDS { budget } else { budget / 2 };
        let mut known: Vec<_> =
            costs.iter().enumerate().filter_map(|(number, cost)| Some((number, (*cost)?))).collect();
        known.sort_by_key(|(_, cost)| *cost);
        let mut spent = Duration::ZERO;
        let chosen = known.iter().take_while(|(_, cost)| {
            let fits = spent + *cost <= most;
            spent += if fits { *cost } else { Duration::ZERO };
            fits
        });
        let chosen: Vec<_> = chosen.map(|(number, _)| *number).collect();
        self.budget = Some(budget.saturating_sub(spent));
        chosen
    }

    /// Share of the rounds that have begun.
    pub fn done(&self) -> f64 {
        f64::from(self.round) / f64::from(ROUNDS)
    }
}

/// Number of threads that this machine runs at once; 1 in a browser.
pub fn threads() -> usize {
    #[cfg(target_arch = "wasm32")]
    return 1;
    #[cfg(not(target_arch = "wasm32"))]
    std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
}

/// Shares the partitions of large bodies among several cores, wherever this thread steps them.
/// This thread becomes the first of a pool of `threads` threads. The bits do not depend on their number. Call it once
/// per process; further calls change nothing. Elsewhere, step inside of [`rayon::ThreadPool::install`].
pub fn share_partitions(threads: usize) {
    if threads > 1 {
        // If no threads are available, or in a second call, the existing threads are used.
        let _as_it_is = rayon::ThreadPoolBuilder::new().num_threads(threads).use_current_thread().build_global();
    }
}

/// Runs tasks in order, each on the next free thread. `work` returns false to start no further task.
/// Tasks are independent, so the result does not depend on the number of threads.
#[cfg(not(target_arch = "wasm32"))]
pub fn spread<T: Send>(threads: usize, tasks: Vec<T>, work: impl Fn(T) -> bool + Sync) {
    if threads <= 1 || tasks.len() <= 1 {
        tasks.into_iter().all(work);
        return;
    }
    let helpers = threads.min(tasks.len());
    let queue = Mutex::new(tasks.into_iter());
    let next = || queue.lock().unwrap_or_else(PoisonError::into_inner).next();
    std::thread::scope(|scope| {
        for _ in 0..helpers {
            scope.spawn(|| while next().is_some_and(&work) {});
        }
    });
}

/// Runs tasks in order. `work` returns false to stop.
#[cfg(target_arch = "wasm32")]
pub fn spread<T: Send>(_: usize, tasks: Vec<T>, work: impl Fn(T) -> bool + Sync) {
    tasks.into_iter().all(work);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repetitions_are_bounded_by_time_and_by_number() {
        let ms = Duration::from_millis;
        let costs = [Some(ms(400)), None, Some(ms(10)), Some(ms(100))];
        let (mut repetitions, mut runs) = (Repetitions::default(), [0; 4]);
        for _ in 0..10 {
            for number in repetitions.next(&costs, ms(1000)) {
                runs[number] += 1;
            }
        }
        assert_eq!(runs, [0, 0, 4, 3], "at most 0.4 s, the shortest most often");
    }
}
