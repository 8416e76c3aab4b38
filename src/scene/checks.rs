//! Checks of a scene: exploded bodies, and warnings about its start.

use super::Scene;
use crate::state::State;

/// A body or net with more than this multiple of its energy at a strain of one has exploded.
const EXPLODED: f64 = 100.0;

/// The multiple with many inverted elements.
const EXPLODED_INVERTED: f64 = 10.0;

/// More than one inverted element in this many counts as many.
const MANY: usize = 20;

impl Scene {
    /// Whether a body, or after the bodies a net, with this elastic energy \[J\] has exploded at these positions \[m\]. A
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

impl Scene {
    /// Number of vertices deep inside walls or outside the domain in a state.
    pub fn count_inside(&self, state: &State) -> usize {
        self.effects.iter().map(|effect| effect.count_inside(&state.x, state.time, &self.depenetrations)).sum()
    }

    /// Warnings about a scene that begins in a state, one sentence each: [`Scene::messages`], and how many vertices begin inside a wall.
    pub fn warnings(&self, start: &State) -> Vec<String> {
        let inside = match self.count_inside(start) {
            0 => None,
            1 => Some(
                "1 vertex begins inside a wall or outside the domain: it is pushed out slowly, if there is a way"
                    .to_owned(),
            ),
            many => Some(format!(
                "{many} vertices begin inside walls or outside the domain: they are pushed out slowly, if there is a way"
            )),
        };
        self.messages.iter().cloned().chain(inside).collect()
    }
}
