//! Advances a simulation frame by frame and measures its time.

use super::{Setting, stopwatch::Stopwatch};
use crate::{scene::Scene, simulation::Simulation, state::State};
use std::{ops::ControlFlow, time::Duration};
use web_time::Instant;

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
        let scene = Scene { integrator, step, guard: false, sleep: false, sub_scenes: Vec::new(), ..scene.clone() };
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

    /// Processor time per second of simulated time [ms].
    pub fn ms_per_second(&self) -> f64 {
        let seconds = (f64::from(self.frame) + self.taken as f64 / self.substeps as f64) / 60.0;
        if seconds > 0.0 { self.spent.as_secs_f64() * 1e3 / seconds } else { 0.0 }
    }
}
