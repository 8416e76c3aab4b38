//! Time saved by skipping inactive effects.

use super::{Progress, StudyError, march::Deadline};
use crate::{
    clock::Stopwatch,
    level::{Level, Sleep, Switch},
    meshes::Files,
    scene::Scene,
    simulation::Simulation,
};
use std::time::Duration;

/// Number of frames of 1/60 s of each run.
const FRAMES: u32 = 60;

/// Time limit of one run \[s\].
const LONGEST: f64 = 2.0;

/// A turn longer than this is not lengthened further \[s\].
const TURN: f64 = 1e-3;

/// Two runs from the same state, in turns: the level as it is, and one with every switched-on effect forced and no sleep.
/// Without sleep both give the same bits. Only the times differ.
pub struct Savings {
    runs: [Simulation; 2],
    /// Processor time of each run \[s\].
    spent: [f64; 2],
    /// Steps computed by each run.
    steps: u64,
    turn: u64,
    substeps: u64,
}

/// Time of one effect in both runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Saving {
    /// Name of the effect.
    pub name: &'static str,
    /// Time in the level as it is [s/frame].
    pub own: f64,
    /// Time if the effect is forced [s/frame].
    pub forced: f64,
}

impl Saving {
    /// Time saved [s/frame]. Negative if the check costs more than the effect.
    pub const fn saved(&self) -> f64 {
        self.forced - self.own
    }
}

impl Savings {
    /// Prepares both runs from the saved state of a level, or from its start.
    ///
    /// # Errors
    /// If the level cannot be built.
    pub fn new(level: &Level, files: &dyn Files) -> Result<Self, StudyError> {
        let own = Scene::build(level, level.mode, files, None)?;
        let mut everything = level.clone();
        for listed in everything.effects.iter_mut().filter(|listed| listed.switch.is_on()) {
            listed.switch = Switch::On;
        }
        let forced = Scene { sleep: Sleep::Off, ..Scene::build(&everything, level.mode, files, Some(&own))? };
        let state = own.first_state(level.state.as_ref())?;
        let mut runs = [own, forced].map(|scene| Simulation::new(scene, state.clone()));
        for run in &mut runs {
            run.set_measured(true);
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
            // The first run finds cold caches, so the order alternates.
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

    /// Number of frames of 1/60 s computed by each run.
    fn frames(&self) -> f64 {
        self.steps as f64 / self.substeps as f64
    }

    /// Times of each effect, in the order of the scene. Empty before the first step.
    pub fn each(&self) -> Vec<Saving> {
        let frames = self.frames();
        let costs = self.runs[0].costs().iter().zip(self.runs[1].costs()).filter(|_| self.steps > 0);
        let saving = costs.map(|(own, forced)| {
            let [own_time, forced_time] = [own, forced].map(|cost| cost.time.as_secs_f64() / frames);
            Saving { name: own.name, own: own_time, forced: forced_time }
        });
        saving.collect()
    }

    /// Time of a whole frame, as it is and forced \[s\]. `None` before the first step.
    pub fn whole(&self) -> Option<[f64; 2]> {
        (self.steps > 0).then(|| self.spent.map(|spent| spent / self.frames()))
    }

    /// Both runs: as it is, and forced.
    pub const fn runs(&self) -> &[Simulation; 2] {
        &self.runs
    }
}
