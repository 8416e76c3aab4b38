//! Warnings about the start of a scene.

use super::Scene;
use crate::state::State;

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
