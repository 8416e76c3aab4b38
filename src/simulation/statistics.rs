//! Books of several that are stepped by themselves, kept as those of one.

use super::system::{ASLEEP, Scratch};
use crate::report::EffectCost;

impl Scratch {
    /// Begins a step of several: what none of them books belongs to who sleeps.
    pub fn begin_statistics(&mut self) {
        for cost in &mut self.costs {
            cost.idle = Some(ASLEEP);
        }
    }

    /// Books steps of the scene: the triangles of bodies that sleep were not computed.
    pub fn count_steps(&mut self, steps: u64) {
        self.counts.steps += steps;
        self.counts.triangle_steps += steps * self.plan.triangles as u64;
        for number in &self.plan.sleeping {
            self.costs[*number].slept += steps;
        }
    }

    /// Takes over what one of them has booked since the last time; `effects` are the numbers of its effects here.
    pub fn merge(&mut self, one: &mut Self, effects: &[usize]) {
        for (cost, &number) in one.costs.iter_mut().zip(effects) {
            let whole = &mut self.costs[number];
            whole.time += cost.time;
            whole.calls += cost.calls;
            whole.elements += cost.elements;
            whole.skipped += cost.skipped;
            // Called, if it was for any of them.
            whole.idle = whole.idle.and(cost.idle);
            *cost = EffectCost { idle: cost.idle, ..EffectCost::none(cost.name, cost.auto) };
        }
        self.counts.merge(&std::mem::take(&mut one.counts));
    }
}
