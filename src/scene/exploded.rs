//! Detects exploded bodies by their elastic energy.

use super::Scene;

/// A body or net with more than this multiple of its energy at a strain of one has exploded.
const EXPLODED: f64 = 100.0;

/// The multiple with many inverted triangles.
const EXPLODED_INVERTED: f64 = 10.0;

/// More than one inverted triangle in this many counts as many.
const MANY: usize = 20;

impl Scene {
    /// Whether a body, or after the bodies a net, with this elastic energy [J] and number of inverted triangles has
    /// exploded. A tangled body that fills the domain counts too.
    ///
    /// The energy is measured by `(2 mu + lambda) A` for a body of rest area A, and by the sum of k L² for a net.
    pub fn has_exploded(&self, number: usize, energy: f64, inverted: usize) -> bool {
        let (scale, triangles) = if let Some(body) = self.bodies.get(number) {
            let lame = body.elements.lame();
            let area: f64 = body.elements.rest_areas().sum();
            ((2.0 * lame.mu + lame.lambda) * area, body.elements.corners().len())
        } else if let Some(net) = self.nets.get(number - self.bodies.len()) {
            (net.springs.links().iter().map(|link| link.stiffness * link.rest * link.rest).sum(), 0)
        } else {
            return false;
        };
        let times = if inverted * MANY > triangles { EXPLODED_INVERTED } else { EXPLODED };
        scale > 0.0 && (energy > times * scale || energy.is_nan())
    }

    /// The same for flat positions.
    pub fn has_exploded_at(&self, number: usize, x: &[f64]) -> bool {
        let (energy, inverted) = if let Some(body) = self.bodies.get(number) {
            let inverted = body.elements.volume_ratios(x).filter(|ratio| *ratio <= 0.0).count();
            (body.elements.elastic_energy(x), inverted)
        } else if let Some(net) = self.nets.get(number - self.bodies.len()) {
            (net.springs.elastic_energy(x), 0)
        } else {
            return false;
        };
        self.has_exploded(number, energy, inverted)
    }
}
