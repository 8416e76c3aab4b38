//! Measures the time that skipping effects saves.

use super::{Progress, StudyError, march::Deadline, stopwatch::Stopwatch};
use crate::{
    level::{Level, Switch},
    meshes::Files,
    scene::Scene,
    simulation::Simulation,
};
use std::time::Duration;

/// Frames of 1/60 s that both take.
const FRAMES: u32 = 60;

/// Longest time for one of the two [s].
const LONGEST: f64 = 2.0;

/// A turn that takes longer is not made longer still [s].
const TURN: f64 = 1e-3;

/// Two runs from the same state, in turns: one as the level says, one with every effect that is switched on
/// forced and nobody asleep. Both come to the same bits but for sleep; what differs is the time they take.
pub struct Savings {
    runs: [Simulation; 2],
    /// Processor time spent on all of a run [s].
    spent: [f64; 2],
    /// Steps that each has taken, and how many they take in turn: as many as take a short time, a frame of them at most.
    steps: u64,
    turn: u64,
    substeps: u64,
}

/// What one effect takes, and what it would.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Saving {
    /// Name of the effect.
    pub name: &'static str,
    /// As it is [s in a frame].
    pub own: f64,
    /// If it were forced [s in a frame].
    pub forced: f64,
}

impl Saving {
    /// What is saved [s in a frame]; below zero if asking costs more than doing.
    pub const fn saved(&self) -> f64 {
        self.forced - self.own
    }
}

impl Savings {
    /// From the state a level was saved in, or from its start.
    ///
    /// # Errors
    /// If the level cannot be built.
    pub fn new(level: &Level, files: &dyn Files) -> Result<Self, StudyError> {
        let own = Scene::build(level, level.mode, files, None)?;
        let mut everything = level.clone();
        for listed in everything.effects.iter_mut().filter(|listed| listed.switch.is_on()) {
            listed.switch = Switch::On;
        }
        let forced = Scene { sleep: false, ..Scene::build(&everything, level.mode, files, Some(&own))? };
        let state = own.first_state(level.state.as_ref())?;
        let mut runs = [own, forced].map(|scene| Simulation::new(scene, state.clone()));
        for run in &mut runs {
            run.set_timed(true);
        }
        Ok(Self { runs, spent: [0.0; 2], steps: 0, turn: 1, substeps: u64::from(level.substeps.get()) })
    }

    /// Works for about `budget`.
    pub fn advance(&mut self, budget: Duration) -> Progress {
        let deadline = Deadline::after(budget);
        loop {
            let slowest = self.spent[0].max(self.spent[1]);
            let stopped = self.runs.iter().any(|run| run.fault().is_some());
            let most = u64::from(FRAMES) * self.substeps;
            if self.steps >= most || slowest > LONGEST || stopped {
                return Progress::FINISHED;
            }
            // Who goes first finds cold caches.
            let turn = self.turn.min(most - self.steps);
            let first = (self.steps / turn) as usize % 2;
            let mut longest = 0.0_f64;
            for number in [first, 1 - first] {
                let stopwatch = Stopwatch::start();
                self.runs[number].advance(turn, &mut || true);
                let spent = stopwatch.elapsed().as_secs_f64();
                longest = longest.max(spent);
                self.spent[number] += spent;
            }
            self.steps += turn;
            if longest < TURN {
                self.turn = (2 * self.turn).min(self.substeps);
            }
            if deadline.passed() {
                let done = self.steps as f64 / most as f64;
                return Progress { done: done.max(slowest / LONGEST).min(1.0), finished: false };
            }
        }
    }

    /// How many frames of 1/60 s each has simulated.
    fn frames(&self) -> f64 {
        self.steps as f64 / self.substeps as f64
    }

    /// What each effect takes, in the order of the scene; nothing before the first step.
    pub fn each(&self) -> Vec<Saving> {
        let frames = self.frames();
        let costs = self.runs[0].costs().iter().zip(self.runs[1].costs()).filter(|_| self.steps > 0);
        let saving = costs.map(|(own, forced)| {
            let [own_time, forced_time] = [own, forced].map(|cost| cost.time.as_secs_f64() / frames);
            Saving { name: own.name, own: own_time, forced: forced_time }
        });
        saving.collect()
    }

    /// What a whole frame takes, as it is and forced [s]; nothing before the first.
    pub fn whole(&self) -> Option<[f64; 2]> {
        (self.steps > 0).then(|| self.spent.map(|spent| spent / self.frames()))
    }

    /// The two runs: as it is, and forced.
    pub const fn runs(&self) -> &[Simulation; 2] {
        &self.runs
    }
}
