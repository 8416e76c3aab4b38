//! What a scene tells constraints, and whether there are any for the effects that need one.

use super::Scene;
use crate::{effects::Effect, obstacles::Surface};

impl Scene {
    /// Writes a vector outwards from the body at each vertex of a boundary, as long as the edges beside it: zero inside bodies,
    /// and not a number for the particles of nets, which have no inside.
    pub fn outward(&self, x: &[f64], outward: &mut Vec<f64>) {
        outward.clear();
        outward.resize(2 * self.bodies.last().map_or(0, |body| body.vertices.end), 0.0);
        outward.resize(x.len(), f64::NAN);
        for [a, b] in self.boundary.iter().map(|edge| edge.map(|vertex| 2 * vertex as usize)) {
            let right = [x[b + 1] - x[a + 1], x[a] - x[b]];
            for at in [a, b] {
                outward[at] += right[0];
                outward[at + 1] += right[1];
            }
        }
    }
}

/// Which effects of a level say what touching does, and whether there is anything to touch.
#[derive(Default)]
pub(super) struct Touching {
    coatings: Vec<&'static str>,
    constraints: bool,
}

impl Touching {
    /// Looks at an effect, whether it is switched on or not.
    pub(super) fn add(&mut self, effect: &dyn Effect) {
        let mut surface = Surface::default();
        effect.coat(&mut surface);
        if surface != Surface::default() {
            self.coatings.push(effect.name());
        }
        self.constraints |= effect.constrains();
    }

    /// What a person should know.
    pub(super) fn messages(self) -> impl Iterator<Item = String> {
        let idle = if self.constraints { Vec::new() } else { self.coatings };
        idle.into_iter().map(|name| format!("{name} needs walls or edges of the world: without them nothing touches"))
    }
}
