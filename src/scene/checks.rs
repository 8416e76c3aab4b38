//! Checks of a scene: exploded bodies, and warnings about its start.

use super::Scene;
use crate::state::State;
use nalgebra::{Matrix3, Vector3};
use std::ops::Range;

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
    /// The diagonal of the box around some vertices at rest \[m\].
    pub fn size(&self, vertices: &Range<usize>) -> f64 {
        let own = &self.rest[self.numbers(vertices)];
        let length = |axis: usize| {
            let along = || own.iter().skip(axis).step_by(self.dimension).copied();
            along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min)
        };
        (0..self.dimension).map(length).map(|length| length * length).sum::<f64>().sqrt()
    }

    /// Whether pins and rollers leave no rigid motion of the whole scene: in the plane, whether the sum of the squares of the velocities along the fixed coordinates
    /// is positive for each combination of two translations and a rotation. In space two pins count as enough.
    pub fn is_held(&self) -> bool {
        self.holds(&(0..self.vertices()))
    }

    /// Whether pins and rollers of these vertices leave no rigid motion of them.
    pub fn holds(&self, vertices: &Range<usize>) -> bool {
        let is_own = |vertex: u32| vertices.contains(&(vertex as usize));
        let pins = self.pins.iter().copied().filter(|pin| is_own(*pin));
        if self.dimension != 2 || pins.clone().count() > 1 {
            return pins.count() > 1;
        }
        let rollers = self.rollers.iter().copied().filter(|(vertex, _)| is_own(*vertex));
        let fixed = || pins.clone().flat_map(|pin| [(pin, 0), (pin, 1)]).chain(rollers.clone());
        let point = |vertex: u32| [0, 1].map(|axis| self.rest[2 * vertex as usize + axis]);
        let count = fixed().count().max(1) as f64;
        let middle = [0, 1].map(|axis| fixed().map(|(vertex, _)| point(vertex)[axis]).sum::<f64>() / count);
        let size = self.size(vertices);
        let sum = fixed().fold(Matrix3::zeros(), |sum, (vertex, axis)| {
            let [x, y] = [0, 1].map(|axis| (point(vertex)[axis] - middle[axis]) / size);
            let row = if axis == 0 { Vector3::new(1.0, 0.0, -y) } else { Vector3::new(0.0, 1.0, x) };
            sum + row * row.transpose()
        });
        let eigenvalues = sum.symmetric_eigenvalues();
        eigenvalues.min() > 1e-9 * eigenvalues.max()
    }

    /// Number of vertices inside walls, outside the domain, or inside other bodies in a state.
    pub fn count_inside(&self, state: &State) -> usize {
        let motion = self.motion(state, None);
        let mut inside = Vec::new();
        self.effects
            .iter()
            .filter_map(|effect| effect.contact())
            .for_each(|contact| contact.add_inside(motion, &mut inside));
        inside.sort_unstable();
        inside.dedup();
        inside.len()
    }

    /// Warnings about a scene that begins in a state, one sentence each: [`Scene::messages`], and how many vertices begin inside a wall.
    pub fn warnings(&self, start: &State) -> Vec<String> {
        let inside = match self.count_inside(start) {
            0 => None,
            1 => Some(
                "1 vertex begins inside a wall, another body or outside the domain: it is pushed out slowly, if there is a way"
                    .to_owned(),
            ),
            many => Some(format!(
                "{many} vertices begin inside walls, other bodies or outside the domain: they are pushed out slowly, if there is a way"
            )),
        };
        self.messages.iter().cloned().chain(inside).collect()
    }
}
