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
    pub state: State,
    /// What had been counted and booked then.
    pub counts: Counts,
    pub costs: Vec<EffectCost>,
    /// What the guard knew.
    pub guard: Guard,
}

impl Checkpoint {
    /// One of an earlier part of the run, of which nothing was counted here.
    pub fn new(state: State, guard: Guard, (counts, costs): (Counts, &[EffectCost])) -> Self {
        Self { state, counts, costs: costs.to_vec(), guard }
    }
}

impl Simulation {
    /// From here on steps that fail are gone back for to here.
    pub(super) fn set_checkpoint(&mut self) {
        std::mem::swap(&mut self.checkpoint, &mut self.older);
        self.joined = !std::mem::take(&mut self.stale);
        self.checkpoint.state.clone_from(&self.state);
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
        self.guard.set_put_in(self.checkpoint.guard.put_in());
        self.scratch.workspace.forget();
        self.scratch.displacement_bound = -1.0;
        while self.state.steps < step {
            self.step();
        }
    }
}
