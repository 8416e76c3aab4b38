//! Compares a run with the recorded end of its level.

use super::Simulation;
use crate::level::{Level, RecordedEnd, RunMode};

/// The recorded end of a run, and whether this run came to the same.
#[derive(Default)]
pub(super) struct Replay {
    /// The recorded end, unless something other than the level has acted since the start.
    end: Option<RecordedEnd>,
    /// Whether the state at the end was the same, once it has been reached.
    same: Option<bool>,
}

impl Replay {
    /// The comparison for a level in a mode. In another mode than that of the recording, effects differ: then there is none.
    pub fn of(level: &Level, mode: RunMode) -> Self {
        Self { end: level.recorded.clone().filter(|_| mode == level.mode), same: None }
    }
}

impl Simulation {
    /// Whether the state at the recorded end of the level was the recorded one, bit for bit; `None` before the end, or if nothing was
    /// recorded.
    pub const fn replayed(&self) -> Option<bool> {
        self.replay.same
    }

    /// Number of steps to the recorded end of the level; `None` behind it, or if nothing was recorded.
    pub fn steps_to_end(&self) -> Option<u64> {
        let end = self.replay.end.as_ref()?.steps;
        end.checked_sub(self.state.steps).filter(|left| *left > 0)
    }

    /// Stops comparing this run with a recording: something that was not recorded has acted on it.
    pub fn forget_recording(&mut self) {
        self.replay = Replay::default();
    }

    /// Compares the state with the recorded one, if steps have just led to the end.
    pub(super) fn compare_end(&mut self) {
        if let Some(end) = self.replay.end.as_ref().filter(|end| end.steps == self.state.steps) {
            self.replay.same = Some(end.is(&self.state));
        }
    }

    /// A state was set: the end is still to come, or was never reached.
    pub(super) fn await_end(&mut self) {
        self.replay.same = None;
    }
}
