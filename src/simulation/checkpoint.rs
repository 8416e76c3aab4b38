//! Checkpoints, from which a rejected step is replayed.

use super::Simulation;
use crate::{
    guard::Guard,
    report::{Counts, EffectCost},
    state::State,
};

/// A checkpoint.
#[derive(Clone, Default)]
pub(super) struct Checkpoint {
    pub state: State,
    /// Counts and costs at that moment.
    pub counts: Counts,
    pub costs: Vec<EffectCost>,
    /// The guard at that moment.
    pub guard: Guard,
}

impl Checkpoint {
    /// Makes a checkpoint of an earlier part of the run, with the given counts and costs.
    pub fn new(state: State, guard: Guard, (counts, costs): (Counts, &[EffectCost])) -> Self {
        Self { state, counts, costs: costs.to_vec(), guard }
    }
}

impl Simulation {
    /// Sets a checkpoint at the present state.
    pub(super) fn set_checkpoint(&mut self) {
        std::mem::swap(&mut self.checkpoint, &mut self.older);
        self.joined = !std::mem::take(&mut self.stale);
        self.checkpoint.state.clone_from(&self.state);
        self.checkpoint.counts = self.scratch.counts;
        self.checkpoint.costs.clone_from(&self.scratch.costs);
        self.checkpoint.guard = self.guard.clone();
    }

    /// Returns to a step since the checkpoint by replay: the same steps give the same bits.
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
