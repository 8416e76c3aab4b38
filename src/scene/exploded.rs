//! Detects exploded bodies by their elastic energy.

use super::Scene;

/// A body or net that stores more than so many times its energy at a strain of one has exploded.
const EXPLODED: f64 = 100.0;

/// With many triangles inside out, so many times is enough.
const EXPLODED_INVERTED: f64 = 10.0;

/// One triangle of so many inside out is many.
const MANY: usize = 20;

impl Scene {
    /// Whether a body, or after the bodies a net, that stores this elastic energy [J] and has so many triangles inside out has
    /// exploded. A body that fills its world as a tangle counts too.
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
