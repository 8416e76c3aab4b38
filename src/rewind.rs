//! The last seconds, kept so that time can be turned back.

use crate::state::State;
use std::collections::VecDeque;

/// States of the last seconds, one for every frame of simulated time, as far as the memory allows.
#[derive(Debug, Default)]
pub struct Rewind {
    states: VecDeque<State>,
}

impl Rewind {
    /// Simulated time that is kept [s].
    pub const SECONDS: f64 = 10.0;
    /// Time between two kept states [s].
    pub const FRAME: f64 = 1.0 / 60.0;
    /// Most numbers that are kept: 64 MB.
    const MOST: usize = 8_000_000;

    /// Keeps a state, unless the last one kept is less than a frame older. A state of an earlier time, or of another scene, is a
    /// new beginning.
    pub fn keep(&mut self, state: &State) {
        if let Some(last) = self.states.back() {
            let elsewhere = state.steps < last.steps || state.x.len() != last.x.len();
            if elsewhere {
                self.states.clear();
            } else if state.time - last.time < Self::FRAME * (1.0 - 1e-6) {
                return;
            }
        }
        let numbers = (state.x.len() + state.v.len() + state.memory.len()).max(1);
        let full = self.states.len() > Self::MOST / numbers;
        let old = self.states.front().is_some_and(|first| first.time < state.time - Self::SECONDS);
        // The buffers of the one that goes are good for the one that comes.
        let mut kept = if full || old { self.states.pop_front().unwrap_or_default() } else { State::default() };
        kept.clone_from(state);
        self.states.push_back(kept);
    }

    /// The latest state that is at least so much older than a time [s], or the oldest there is; later ones are forgotten. Never one
    /// of a later time.
    pub fn back(&mut self, now: f64, seconds: f64) -> Option<State> {
        let wanted = now - seconds + 1e-6 * Self::FRAME;
        while self.states.len() > 1 && self.states.back().is_some_and(|last| last.time > wanted) {
            self.states.pop_back();
        }
        self.states.back().filter(|last| last.time <= now).cloned()
    }

    /// How far back one can go from a time [s].
    pub fn reach(&self, now: f64) -> f64 {
        self.states.front().map_or(0.0, |first| (now - first.time).max(0.0))
    }

    /// Forgets all.
    pub fn clear(&mut self) {
        self.states.clear();
    }
}
