//! Advances a simulation frame by frame and measures its time.

use super::{Setting, stopwatch::Stopwatch};
use crate::{scene::Scene, simulation::Simulation, state::State};
use std::{ops::ControlFlow, time::Duration};
use web_time::Instant;

/// When to stop working for now.
#[derive(Clone, Copy, Debug)]
pub struct Deadline(Option<Instant>);

impl Deadline {
    /// After so much time; never, if that is out of all bounds.
    pub fn after(budget: Duration) -> Self {
        Self(Instant::now().checked_add(budget))
    }

    /// Whether it has passed.
    pub fn passed(self) -> bool {
        self.0.is_some_and(|moment| Instant::now() >= moment)
    }
}

/// Frames of 1/60 s, each a whole number of steps.
pub(super) struct March {
    pub simulation: Simulation,
    /// Processor time spent stepping.
    pub spent: Duration,
    /// Frames to take.
    pub frames: u32,
    /// Frames taken.
    pub frame: u32,
    substeps: u64,
    /// Steps taken in the present frame.
    taken: u64,
    /// Steps between two looks at the clock.
    bunch: u64,
}

/// Longest time between two looks at the clock, where single steps allow it.
const POLL_INTERVAL: Duration = Duration::from_micros(400);

impl March {
    /// A march of so many frames from a state.
    pub fn new(scene: &Scene, start: &State, setting: &Setting, frames: u32) -> Self {
        // A study is about the setting as it is, and wants to see it blow up.
        let (integrator, step) = (setting.integrator.clone(), setting.substeps.step());
        let scene = Scene { integrator, step, guard: false, sleep: false, sub_scenes: Vec::new(), ..scene.clone() };
        // What another integrator remembers means nothing to this one.
        let start = State { memory: Vec::new(), ..start.clone() };
        let simulation = Simulation::new(scene, start);
        let substeps = u64::from(setting.substeps.get());
        Self { simulation, spent: Duration::ZERO, frames, frame: 0, substeps, taken: 0, bunch: 1 }
    }

    /// Goes on until the deadline, the last frame, a fault or until `seen` breaks off; `seen` is shown the end of every frame.
    /// Returns whether the march is over.
    pub fn advance(&mut self, deadline: Deadline, seen: &mut dyn FnMut(u32, &Simulation) -> ControlFlow<()>) -> bool {
        let mut stopwatch = Stopwatch::start();
        while self.frame < self.frames {
            let begin = Instant::now();
            let taken = self.simulation.advance(self.bunch.min(self.substeps - self.taken), &mut || true);
            let elapsed = begin.elapsed();
            self.taken += taken;
            // How steps are bunched changes nothing but how often the clock is read.
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
                // What is done with a frame is no part of the price.
                stopwatch = Stopwatch::start();
            }
            if deadline.passed() {
                break;
            }
        }
        self.spent += stopwatch.elapsed();
        self.frame == self.frames
    }

    /// Goes on until the deadline, the last frame or a fault, with nobody looking. Returns whether the march is over.
    pub fn repeat(&mut self, deadline: Deadline) -> bool {
        self.advance(deadline, &mut |_, _| ControlFlow::Continue(()))
    }

    /// Share of the frames taken.
    pub fn done(&self) -> f64 {
        (f64::from(self.frame) + self.taken as f64 / self.substeps as f64) / f64::from(self.frames.max(1))
    }

    /// Processor time spent for a second of simulated time [ms].
    pub fn ms_per_second(&self) -> f64 {
        let seconds = (f64::from(self.frame) + self.taken as f64 / self.substeps as f64) / 60.0;
        if seconds > 0.0 { self.spent.as_secs_f64() * 1e3 / seconds } else { 0.0 }
    }
}
