//! Contact with obstacles by a velocity filter, in place of a potential.

use super::{ObstacleContact, touch::vector};
use crate::{effects::Bounds, obstacles::Rigid};

impl ObstacleContact {
    /// Filters the end of a step at a time \[s\]: a vertex within the contact margin of an obstacle loses its velocity towards it,
    /// `v - (1 + e) min(0, v n) n`, and as much of that along it as friction takes, at most mu times the change along the normal. A
    /// vertex inside is put on the surface. Velocities are relative to an obstacle that moves. Returns the number of vertices
    /// changed, and the work of moving obstacles \[J\].
    pub fn filter(&self, time: f64, inverse_mass: &[f64], [x, v]: [&mut [f64]; 2]) -> (usize, f64) {
        let (mut changed, mut supplied) = (0, 0.0);
        let bounds = Bounds::of(x);
        for placed in &self.obstacles {
            let at = placed.at(time);
            if !placed.is_near(bounds, at) {
                continue;
            }
            for vertex in self.surface.all() {
                let point = vector(x, vertex.vertex);
                let Some(contact) = placed.obstacle.contact(at.map_or(point, |at| at.back(point))) else { continue };
                let normal = at.map_or(contact.normal, |at| at.normal(contact.normal));
                let [a, b] = vector(inverse_mass, vertex.vertex);
                // Along coordinates that are held nothing moves.
                let [nx, ny] = [if a == 0.0 { 0.0 } else { normal[0] }, if b == 0.0 { 0.0 } else { normal[1] }];
                let length = super::touch::length([nx, ny]);
                if length == 0.0 {
                    continue;
                }
                let [nx, ny] = [nx / length, ny / length];
                let wall = at.unwrap_or(Rigid::STILL).velocity_at(point);
                let at = 2 * vertex.vertex as usize;
                let (dx, dy) = (v[at] - wall[0], v[at + 1] - wall[1]);
                let (towards, along) = (nx * dx + ny * dy, ny * dx - nx * dy);
                let impulse = -(1.0 + self.model.restitution) * towards.min(0.0);
                let held = a == 0.0 || b == 0.0;
                let friction = if held { 0.0 } else { along.abs().min(self.friction(vertex.part) * impulse) };
                let slowed = -friction * along.signum();
                let change = [impulse * nx + slowed * ny, impulse * ny - slowed * nx];
                if impulse > 0.0 || contact.distance < 0.0 {
                    changed += 1;
                }
                for axis in (0..2).filter(|axis| inverse_mass[at + axis] != 0.0) {
                    v[at + axis] += change[axis];
                    supplied += (change[axis] / inverse_mass[at + axis] * wall[axis]).max(0.0);
                    x[at + axis] -= contact.distance.min(0.0) / length * [nx, ny][axis];
                }
            }
        }
        (changed, supplied)
    }
}
