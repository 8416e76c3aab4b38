//! Energy balance of a run.

use crate::{guard::negligible, report::Energies, scene::Scene};

/// Energy balance of a run. Between two changes from outside nothing in a scene supplies energy.
///
/// With the mechanical energy M and the potential P, `M + P` cannot exceed the energy put in. That is the energy at
/// the start plus the gain or loss by every change from outside. Energy dissipated before a change is subtracted, so
/// that it cannot hide an excess. The excess is relative to the greatest possible M, `put in - P`.
#[derive(Clone, Debug)]
pub struct Ledger {
    put_in: f64,
    scale: f64,
    gain: f64,
}

impl Ledger {
    /// Starts the balance with a scene and its energies.
    pub fn new(scene: &Scene, energies: Energies) -> Self {
        let mut ledger = Self { put_in: energies.total(), scale: negligible(scene), gain: 0.0 };
        ledger.record(energies);
        ledger
    }

    /// Records a change from outside.
    pub fn changed(&mut self, before: Energies, after: Energies) {
        self.record(before);
        self.put_in = self.put_in.min(before.total()) + after.total() - before.total();
        self.record(after);
    }

    /// Records the present energies.
    pub fn record(&mut self, energies: Energies) {
        self.scale = self.scale.max(self.put_in - energies.potential);
        let gain = (energies.total() - self.put_in) / self.scale;
        // NaN counts as an infinite excess.
        self.gain = if gain.is_nan() { f64::INFINITY } else { self.gain.max(gain) };
    }

    /// Greatest excess over the energy put in, relative to the greatest possible mechanical energy.
    pub const fn gain(&self) -> f64 {
        self.gain
    }
}
