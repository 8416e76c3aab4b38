//! Energy balance of a run.

use crate::{report::Energies, scene::Scene};

/// Keeps the books of energy: between two changes from outside nothing in a scene supplies any.
///
/// With the mechanical energy M and the potential P, `M + P` can never be above what was put in: what there was at the start, and
/// what every change from outside added to it or took. What was dissipated until a change is gone, so that an excess cannot hide
/// behind it. Excesses count as shares of the most that M could ever have been, `put in - P`.
#[derive(Clone, Debug)]
pub struct Ledger {
    put_in: f64,
    scale: f64,
    gain: f64,
}

/// An energy that is round-off to a scene, as a share of what its elements store at a stretch of one.
const NEGLIGIBLE: f64 = 1e-12;

impl Ledger {
    /// Begins with a scene and its energies.
    pub fn new(scene: &Scene, energies: Energies) -> Self {
        let elastic = |body: &crate::scene::Body| body.elements.lame().mu * body.elements.rest_areas().sum::<f64>();
        let scale = NEGLIGIBLE * scene.bodies.iter().map(elastic).sum::<f64>();
        let mut ledger = Self { put_in: energies.total(), scale, gain: 0.0 };
        ledger.record(energies);
        ledger
    }

    /// Books a change from outside.
    pub fn changed(&mut self, before: Energies, after: Energies) {
        self.record(before);
        self.put_in = self.put_in.min(before.total()) + after.total() - before.total();
        self.record(after);
    }

    /// Looks at the energies now.
    pub fn record(&mut self, energies: Energies) {
        self.scale = self.scale.max(self.put_in - energies.potential);
        let gain = (energies.total() - self.put_in) / self.scale;
        // What is not a number is worse than any.
        self.gain = if gain.is_nan() { f64::INFINITY } else { self.gain.max(gain) };
    }

    /// The most that the energy was above what was put in, as a share of what there could be.
    pub const fn gain(&self) -> f64 {
        self.gain
    }
}
