//! Contact with obstacles by a velocity filter, in place of a potential.

use super::{
    BetweenVertices, ObstacleContact,
    obstacle_contact::{FilteredStep, tangents},
    touch::{coordinates, dot, length},
};
use crate::{effects::Bounds, obstacles::Rigid};

impl<const D: usize, const T: usize, const N: usize> ObstacleContact<D, T, N>
where
    Self: BetweenVertices<D, T, N>,
{
    /// Filters the end of a step; see [`super::ObstacleTerm::filter`].
    pub(super) fn filter_velocities(&self, step: FilteredStep<'_>) -> (usize, f64) {
        let FilteredStep { time: [_, time], inverse_mass, x, v, .. } = step;
        let (mut changed, mut supplied) = (0, 0.0);
        let bounds = Bounds::of(x);
        for placed in &self.obstacles {
            let at = placed.at(time);
            if !placed.is_near(bounds, at) {
                continue;
            }
            for vertex in self.surface.all() {
                let point: [f64; D] = coordinates(x, vertex.vertex);
                let Some(contact) = placed.obstacle.contact(at.map_or(point, |at| at.back(point))) else { continue };
                let normal = at.map_or(contact.normal, |at| at.normal(contact.normal));
                let inverse: [f64; D] = coordinates(inverse_mass, vertex.vertex);
                // Along coordinates that are held nothing moves.
                let free: [f64; D] = std::array::from_fn(|axis| if inverse[axis] == 0.0 { 0.0 } else { normal[axis] });
                let length = length(free);
                if length == 0.0 {
                    continue;
                }
                let normal = free.map(|along| along / length);
                let wall = at.unwrap_or(Rigid::STILL).velocity_at(point);
                let at = D * vertex.vertex as usize;
                let relative = std::array::from_fn(|axis| v[at + axis] - wall[axis]);
                let impulse = -(1.0 + self.model.restitution) * dot(normal, relative).min(0.0);
                let slowed = if inverse.contains(&0.0) {
                    [0.0; D]
                } else {
                    slowed::<D, T>(normal, relative, self.friction(vertex.part) * impulse)
                };
                let change: [f64; D] = std::array::from_fn(|axis| impulse * normal[axis] + slowed[axis]);
                if impulse > 0.0 || contact.distance < 0.0 {
                    changed += 1;
                }
                for axis in (0..D).filter(|axis| inverse[*axis] != 0.0) {
                    v[at + axis] += change[axis];
                    supplied += (change[axis] / inverse[axis] * wall[axis]).max(0.0);
                    x[at + axis] -= contact.distance.min(0.0) / length * normal[axis];
                }
            }
        }
        (changed, supplied)
    }
}

/// Change of a velocity along the surface by friction, at most `most` [m/s].
fn slowed<const D: usize, const T: usize>(normal: [f64; D], velocity: [f64; D], most: f64) -> [f64; D] {
    let tangents: [[f64; D]; T] = tangents(normal);
    let along = tangents.map(|tangent| dot(tangent, velocity));
    let speed = if let [along] = along[..] { along.abs() } else { length(along) };
    if speed == 0.0 {
        return [0.0; D];
    }
    let along = along.map(|along| -(speed.min(most) * (along / speed)));
    std::array::from_fn(|axis| (0..T).map(|way| along[way] * tangents[way][axis]).sum())
}
