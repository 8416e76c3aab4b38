//! Detects exploded bodies by their elastic energy.

use super::Scene;

/// A body or net with more than this multiple of its energy at a strain of one has exploded.
const EXPLODED: f64 = 100.0;

/// The multiple with many inverted elements.
const EXPLODED_INVERTED: f64 = 10.0;

/// More than one inverted element in this many counts as many.
const MANY: usize = 20;

impl Scene {
    /// Whether a body, or after the bodies a net, with this elastic energy [J] has exploded at these positions [m]. A
    /// tangled body that fills the domain counts too.
    pub fn has_exploded(&self, number: usize, energy: f64, x: &[f64]) -> bool {
        let Some(part) = self.parts.get(number) else { return false };
        let [_, scale] = part.energy_scales();
        let exceeds = |times: f64| energy > times * scale || energy.is_nan();
        let has_many_inverted = || {
            let [inverted, all] = part.inverted(x);
            inverted * MANY > all
        };
        scale > 0.0 && (exceeds(EXPLODED) || (exceeds(EXPLODED_INVERTED) && has_many_inverted()))
    }
}
