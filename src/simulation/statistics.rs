//! Statistics of sub-scenes that are stepped separately, merged into those of the scene.

use super::system::{ASLEEP, Scratch};
use crate::report::EffectCost;

impl Scratch {
    /// Begins a step of several sub-scenes: effects that none of them calls belong to sleeping ones.
    pub fn begin_statistics(&mut self) {
        for cost in &mut self.costs {
            cost.idle = Some(ASLEEP);
        }
    }

    /// Counts steps of the scene; triangles of sleeping bodies were not computed.
    pub fn count_steps(&mut self, steps: u64) {
        self.counts.steps += steps;
        self.counts.triangle_steps += steps * self.plan.triangles as u64;
        for number in &self.plan.sleeping {
            self.costs[*number].slept += steps;
        }
    }

    /// Merges and resets the statistics of a sub-scene; `effects` are the numbers of its effects in the scene.
    pub fn merge(&mut self, one: &mut Self, effects: &[usize]) {
        for (cost, &number) in one.costs.iter_mut().zip(effects) {
            let whole = &mut self.costs[number];
            whole.time += cost.time;
            whole.calls += cost.calls;
            whole.elements += cost.elements;
            whole.skipped += cost.skipped;
            // Called if any sub-scene called it.
            whole.idle = whole.idle.and(cost.idle);
            *cost = EffectCost { idle: cost.idle, ..EffectCost::none(cost.name, cost.auto) };
        }
        self.counts.merge(&std::mem::take(&mut one.counts));
    }
}
