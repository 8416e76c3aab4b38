//! A toy problem as a system of first order for integrators.

use crate::{integrators::Ode, report::Counts, toys::Toy};

/// A toy problem; evaluations of its rate count as force evaluations.
pub(super) struct ToySystem<'a> {
    pub toy: &'a dyn Toy,
    pub counts: &'a mut Counts,
}

impl Ode for ToySystem<'_> {
    fn rate(&mut self, x: &[f64], rate: &mut [f64]) {
        self.counts.force_evaluations += 1;
        if let &[a, b] = x {
            rate.copy_from_slice(&self.toy.rate([a, b]));
        }
    }
}
