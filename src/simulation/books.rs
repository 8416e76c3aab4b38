//! Books of several that are stepped by themselves, kept as those of one.

use super::system::{ASLEEP, Scratch};
use crate::report::Counts;
use std::time::Duration;

impl Scratch {
    /// Begins a step of several: what none of them books belongs to who sleeps.
    pub fn begin_books(&mut self) {
        for cost in &mut self.costs {
            cost.idle = Some(ASLEEP);
        }
    }

    /// Takes over what one of them has booked since the last time; `effects` are the numbers of its effects here.
    pub fn take_over(&mut self, one: &mut Self, effects: &[usize]) {
        for (cost, &number) in one.costs.iter().zip(effects) {
            let whole = &mut self.costs[number];
            whole.time += cost.time;
            whole.calls += cost.calls;
            whole.elements += cost.elements;
            whole.skipped += cost.skipped;
            // Called, if it was for any of them.
            whole.idle = whole.idle.and(cost.idle);
        }
        self.counts.take_over(&one.counts);
        one.clear();
    }

    /// Empties the books.
    pub fn clear(&mut self) {
        self.counts = Counts::default();
        for cost in &mut self.costs {
            (cost.time, cost.calls, cost.elements, cost.skipped) = (Duration::ZERO, 0, 0, 0);
        }
    }
}
