//! Contact with obstacles by a filter of positions, in place of a potential.

use super::{BetweenVertices, ObstacleContact, obstacle_contact::FilteredStep, touch::coordinates};
use crate::{effects::Bounds, obstacles::Rigid};

impl<const D: usize, const T: usize, const N: usize> ObstacleContact<D, T, N>
where
    Self: BetweenVertices<D, T, N>,
{
    /// Filters the end of a step; see [`super::ObstacleTerm::filter`]. Returns the number of vertices changed.
    pub(super) fn filter_positions(&self, step: FilteredStep<'_>) -> usize {
        let FilteredStep { time, start, inverse_mass, x, v } = step;
        let (mut changed, h) = (0, time[1] - time[0]);
        let bounds = Bounds::of(x);
        for placed in &self.obstacles {
            let [before, now] = time.map(|time| placed.at(time));
            if !placed.is_near(bounds, now) {
                continue;
            }
            for vertex in self.surface.all() {
                let inverse: [f64; D] = coordinates(inverse_mass, vertex.vertex);
                let point: [f64; D] = coordinates(x, vertex.vertex);
                let Some(contact) = placed.obstacle.contact(to_shape(now, point)).filter(|_| inverse != [0.0; D])
                else {
                    continue;
                };
                let normal = now.map_or(contact.normal, |now| now.normal(contact.normal));
                let out = placed.obstacle.margin() - contact.distance;
                let nearest: [f64; D] = std::array::from_fn(|axis| point[axis] + out * normal[axis]);
                let origin = to_shape(before, coordinates(start, vertex.vertex));
                // What was put at the margin is outside, whatever round-off says.
                let least = placed.obstacle.margin() * (1.0 - ROUND_OFF);
                let was_inside = placed.obstacle.contact(origin).is_some_and(|contact| contact.distance < least);
                let stuck = if was_inside { 0.0 } else { self.friction(vertex.part).min(1.0) };
                let carried = now.map_or(origin, |now| now.point(origin));
                let at = D * vertex.vertex as usize;
                for axis in (0..D).filter(|axis| inverse[*axis] != 0.0) {
                    let to = stuck * carried[axis] + (1.0 - stuck) * nearest[axis];
                    v[at + axis] += (to - point[axis]) / h;
                    x[at + axis] = to;
                }
                changed += 1;
            }
        }
        changed
    }
}

/// Part of the margin that may be round-off.
const ROUND_OFF: f64 = 1e-9;

/// Maps a point of the world to the shape of an obstacle.
fn to_shape<const D: usize>(at: Option<Rigid<D>>, point: [f64; D]) -> [f64; D] {
    at.map_or(point, |at| at.back(point))
}
