//! Penetration: vertices that begin a step inside an obstacle or outside the domain leave it at a limited speed.
//!
//! No step moves a vertex inside, but a level may begin so, a wall may be switched on at the place of a body, and a pin
//! may be removed. Projection on the surface in one step would flatten the penetrating part and add energy. Instead the
//! surface is taken to begin at the vertex and moves out with it at [`Depenetration::speed`], at which the body keeps
//! its shape: the penetrating part moves as one, and a front at speed u in a medium with wave speed c strains it by no
//! more than u/c (Graff, *Wave Motion in Elastic Solids*, 1975, section 2.1).
//!
//! A body moves along the one direction that leads it out of all penetrated obstacles over the least distance, and the
//! rest of it may enter solids from behind meanwhile: nearest surfaces would pull it to all sides ([`Penetration`]).
//! Other motion of the penetrating part is damped, and restitution is zero for that body: between walls that push to
//! different sides it would gain speed. A body stays inside if the space beyond is too small or if a pin keeps it.

use super::{Contact, ContactQuery, Start, Surface};
use std::ops::Range;

/// Whether a vertex is deep inside an obstacle or outside the domain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Inside {
    /// No vertex is.
    #[default]
    Nothing,
    /// A vertex is, and stays there: a pin keeps it, or the space beyond is too small.
    Stays,
    /// A vertex is, and is pushed out.
    ComesOut,
}

/// Name of an obstacle: the number of its effect, and its number within that effect.
pub type Name = [usize; 2];

/// Depenetration parameters of a range of vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Depenetration {
    /// End of the range of vertices; it starts at the end of the range before.
    pub end: usize,
    /// Depenetration speed [m/s]; infinite if in one step.
    pub speed: f64,
    /// Depth up to which a vertex is projected out in one step \[m\]: a small fraction of a triangle or spring.
    pub shallow: f64,
    /// Time constant with which other motion of the penetrating part decays \[s\].
    pub decay: f64,
}

/// A vertex within the margin of an obstacle, or inside it, at the start of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touching {
    /// The obstacle.
    pub obstacle: Name,
    /// The vertex.
    pub vertex: usize,
    /// The contact, mapped to the end of the step with the obstacle.
    pub contact: Contact,
    /// Whether it is deep inside and movable: see [`Start::depenetration_step`].
    pub is_deep: bool,
    /// The velocity of the obstacle there [m/s].
    pub wall: [f64; 2],
}

/// A body or net that penetrates an obstacle, and its direction of depenetration.
#[derive(Clone, Debug, PartialEq)]
pub struct Penetration {
    /// The obstacle.
    pub obstacle: Name,
    /// The vertices of the body or net.
    pub vertices: Range<usize>,
    /// Unit vector of depenetration; zero if a pin keeps the body inside, or if the space beyond is too small.
    pub direction: [f64; 2],
}

impl Penetration {
    /// Whether the body stays inside.
    pub fn stays(&self) -> bool {
        self.direction == [0.0; 2]
    }

    /// Whether a surface with this normal lies behind the body, where the rest of it may enter.
    pub fn lets_in(&self, [nx, ny]: [f64; 2]) -> bool {
        self.direction[0] * nx + self.direction[1] * ny < 0.0
    }
}

/// Contacts and penetrations at the start of a step. The buffers are reused, so that no step allocates.
#[derive(Clone, Debug, Default)]
pub struct ContactCache {
    /// Contacts, sorted by obstacles, then by vertices.
    pub touching: Vec<Touching>,
    /// Penetrations, sorted by obstacles.
    pub penetrations: Vec<Penetration>,
    /// Candidate directions of depenetration.
    pub(super) directions: Vec<[f64; 2]>,
}

impl ContactCache {
    /// An empty cache.
    pub const NONE: &Self = &Self { touching: Vec::new(), penetrations: Vec::new(), directions: Vec::new() };

    /// Records the vertices that are within the margin of an obstacle, or inside, at the start of the step. Obstacles
    /// come in the order of their names.
    pub fn record(&mut self, obstacle: &ContactQuery<'_>, start: &Start<'_>) {
        obstacle.find_touching(start, &mut self.touching);
    }

    /// Whether any vertex begins deep inside.
    pub fn is_inside(&self) -> bool {
        self.touching.iter().any(|touching| touching.is_deep)
    }

    /// Clears the cache for another step.
    pub fn clear(&mut self) {
        self.touching.clear();
        self.penetrations.clear();
    }
}

/// Motion of a vertex in depenetration in one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepenetrationStep {
    /// Least outward speed [m/s].
    pub speed: f64,
    /// Least outward displacement in the step \[m\].
    pub length: f64,
}

impl Start<'_> {
    /// Records that a vertex is inside.
    pub fn record_inside(&self, inside: Inside) {
        self.inside.set(self.inside.get().max(inside));
    }

    /// Depenetration parameters of a vertex.
    pub fn depenetration(&self, vertex: usize) -> Option<&Depenetration> {
        depenetration_of(self.depenetrations, vertex)
    }

    /// Depenetration step of a vertex at a signed distance from a surface \[m\], with an outward speed [m/s] and a
    /// contact offset; `None` if it leaves the obstacle within this step. A small depth, such as another wall may
    /// cause, is projected out in one step, except the last part of a long depenetration, where the vertex keeps the
    /// depenetration speed. A body that stays inside has speed zero.
    pub fn depenetration_step(
        &self,
        vertex: usize,
        distance: f64,
        outwards: f64,
        offset: f64,
    ) -> Option<DepenetrationStep> {
        const ROUND_OFF: f64 = 1e-3;
        let depenetration = self.depenetration(vertex)?;
        let time = self.time[1] - self.time[0];
        let step_at = |speed: f64| DepenetrationStep { speed, length: speed * time };
        if distance < offset && self.penetration(vertex).is_some_and(Penetration::stays) {
            return Some(step_at(0.0));
        }
        let least = depenetration.shallow * if outwards >= 0.5 * depenetration.speed { ROUND_OFF } else { 1.0 };
        (distance < offset - least && distance + depenetration.speed * time < offset)
            .then(|| step_at(depenetration.speed))
    }

    /// Surface properties at a vertex. Restitution is zero for a body in depenetration: between two walls that push it
    /// out it would gain speed.
    pub fn surface_at(&self, vertex: usize) -> Surface {
        let leaves = || {
            self.contact_cache
                .penetrations
                .iter()
                .any(|penetration| !penetration.stays() && penetration.vertices.contains(&vertex))
        };
        if self.surface.restitution != 0.0 && leaves() {
            return Surface { restitution: 0.0, ..self.surface };
        }
        self.surface
    }

    /// Penetration of the body of a vertex in the current obstacle.
    pub fn penetration(&self, vertex: usize) -> Option<&Penetration> {
        self.penetrations.iter().find(|penetration| penetration.vertices.contains(&vertex))
    }

    /// Damps the motion of deep vertices, except along the direction of depenetration, once for each step and obstacle:
    /// between two walls a vertex would gain more speed than needed.
    pub fn damp(&self, v: &mut [f64]) {
        for Touching { obstacle, vertex, wall, .. } in
            self.contact_cache.touching.iter().filter(|touching| touching.is_deep)
        {
            let is_own =
                |penetration: &&Penetration| penetration.obstacle == *obstacle && penetration.vertices.contains(vertex);
            let Some((penetration, depenetration)) =
                self.contact_cache.penetrations.iter().find(is_own).zip(self.depenetration(*vertex))
            else {
                continue;
            };
            let share = 1.0 - libm::exp((self.time[0] - self.time[1]) / depenetration.decay);
            for axis in (0..2).filter(|axis| self.inverse_mass[2 * vertex + axis] != 0.0) {
                let own = if penetration.stays() {
                    0.0
                } else {
                    wall[axis] + depenetration.speed * penetration.direction[axis]
                };
                let v = &mut v[2 * vertex + axis];
                *v -= share * (*v - own);
            }
        }
    }

    /// Velocity of a vertex in depenetration, at a speed along its unit normal; see [`Surface::impact_response`].
    /// Restitution is zero, and the work is added to the supplied energy.
    pub fn lift(&self, vertex: usize, normal: [f64; 2], speed: f64, v: &mut [f64; 2]) -> Option<f64> {
        self.record_inside(Inside::ComesOut);
        let outwards = normal.map(|along| speed * along);
        let mut after = [v[0] - outwards[0], v[1] - outwards[1]];
        let surface = Surface { restitution: 0.0, ..self.surface };
        let kept = surface.impact_response(normal, [0.0; 2], &mut after)?;
        let mut work = 0.0;
        for axis in (0..2).filter(|axis| self.inverse_mass[2 * vertex + axis] != 0.0) {
            let given = after[axis] + outwards[axis];
            work += (given - v[axis]) / self.inverse_mass[2 * vertex + axis] * outwards[axis];
            v[axis] = given;
        }
        self.supply(work);
        Some(kept)
    }
}

/// Depenetration parameters of a vertex, from those of all ranges.
pub fn depenetration_of(depenetrations: &[Depenetration], vertex: usize) -> Option<&Depenetration> {
    depenetrations.get(depenetrations.partition_point(|depenetration| depenetration.end <= vertex))
}
