//! Checkpoints that a refused step is taken again from.

use super::Simulation;
use crate::{
    guard::Guard,
    report::{Counts, EffectCost},
    state::State,
};

/// A moment to go back to.
#[derive(Clone, Default)]
pub(super) struct Checkpoint {
    /// Its positions and velocities may be [`due`](Self::due).
    pub state: State,
    /// Whether positions and velocities are still only where everything is, and nothing has moved since.
    due: bool,
    /// What had been counted and booked then.
    pub counts: Counts,
    pub costs: Vec<EffectCost>,
    /// What the guard knew.
    pub guard: Guard,
}

impl Checkpoint {
    /// One of an earlier part of the run, of which nothing was counted here.
    pub fn new(state: State, guard: Guard, (counts, costs): (Counts, &[EffectCost])) -> Self {
        Self { state, due: false, counts, costs: costs.to_vec(), guard }
    }

    /// Writes its state to another one, where everything is now.
    pub fn write_state(&self, now: &State, to: &mut State) {
        to.clone_from(&self.state);
        if self.due {
            to.x.clone_from(&now.x);
            to.v.clone_from(&now.v);
        }
    }

    /// Takes positions and velocities from where everything is, if they are due.
    pub fn keep(&mut self, state: &State) {
        if std::mem::take(&mut self.due) {
            self.state.x.clone_from(&state.x);
            self.state.v.clone_from(&state.v);
        }
    }

    /// Takes positions and velocities themselves, if they are due, and leaves others to be written over.
    pub fn take_over(&mut self, state: &mut State) {
        if std::mem::take(&mut self.due) {
            for (own, moving) in [(&mut self.state.x, &mut state.x), (&mut self.state.v, &mut state.v)] {
                std::mem::swap(own, moving);
                moving.resize(own.len(), 0.0);
            }
        }
    }
}

impl Simulation {
    /// From here on steps that fail are gone back for to here.
    pub(super) fn set_checkpoint(&mut self) {
        std::mem::swap(&mut self.checkpoint, &mut self.older);
        self.joined = !std::mem::take(&mut self.stale);
        self.team.pass_checkpoint();
        let State { x: _, v: _, time, steps, memory, calm } = &self.state;
        let kept = &mut self.checkpoint.state;
        (kept.time, kept.steps) = (*time, *steps);
        kept.memory.clone_from(memory);
        kept.calm.clone_from(calm);
        self.checkpoint.due = true;
        self.checkpoint.counts = self.scratch.counts;
        self.checkpoint.costs.clone_from(&self.scratch.costs);
        self.checkpoint.guard = self.guard.clone();
    }

    /// Back to a step since the checkpoint: the same steps from there give the same bits again.
    pub(super) fn go_back_to(&mut self, step: u64) {
        self.state.clone_from(&self.checkpoint.state);
        self.shape += 1;
        self.scratch.counts = self.checkpoint.counts;
        self.scratch.costs.clone_from(&self.checkpoint.costs);
        self.guard.book(self.checkpoint.guard.put_in());
        self.scratch.work.forget();
        self.scratch.room = -1.0;
        while self.state.steps < step {
            self.step();
        }
    }
}
