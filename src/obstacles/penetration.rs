//! What begins inside an obstacle, or beyond an edge of the world, leaves it slowly.
//!
//! No step gets a vertex in there, but a level may begin so, a wall may be switched on where a body already is, and a pin may be
//! taken out. Put on the surface at once, everything inside would be flat on it, with an energy that came from nowhere. Instead
//! the surface counts as beginning where the vertex is, and comes out with it at a [`Depenetration::speed`] at which the body keeps its
//! shape: what is inside then moves as one, and a front at speed u in a medium whose waves have the speed c strains it by no more
//! than u/c (Graff, *Wave Motion in Elastic Solids*, 1975, section 2.1).
//!
//! A body goes along the one direction in which it is soonest past all that it begins inside of, and what else of it follows may
//! enter solids from behind meanwhile: nearest surfaces would tear it to all sides ([`Penetration`]). What else moves in there fades, and
//! nothing of that body bounces: between walls that come out to different sides it would gather speed. Where there is no room beyond,
//! or a pin keeps it, it stays inside.

use super::{Contact, ContactQuery, Start, Surface};
use std::ops::Range;

/// Whether something is deep inside an obstacle or beyond an edge of the world.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Inside {
    /// Nothing is.
    #[default]
    Nothing,
    /// Something is, and stays there: a pin keeps it, or there is no room beyond.
    Stays,
    /// Something is, and comes out.
    ComesOut,
}

/// Which obstacle: the number of the effect that it belongs to, and its own among those of that effect.
pub type Name = [usize; 2];

/// How some vertices leave what they begin inside of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Depenetration {
    /// One past the last of these vertices; the first follows on those of the exit before.
    pub end: usize,
    /// How fast they come out [m/s]; infinite if at once.
    pub speed: f64,
    /// From no deeper than this they come out at once [m]: a small share of a triangle or spring.
    pub shallow: f64,
    /// In this time every other motion of what is inside fades to 1/e of what it was [s].
    pub decay: f64,
}

/// A vertex that is near or inside an obstacle where the step begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touching {
    /// The obstacle.
    pub obstacle: Name,
    /// The vertex.
    pub vertex: usize,
    /// Where it is, carried along with the obstacle.
    pub contact: Contact,
    /// Whether it is deep inside, and can be moved: see [`Start::step`].
    pub is_deep: bool,
    /// The velocity of the obstacle there [m/s].
    pub wall: [f64; 2],
}

/// A body or net that begins inside an obstacle, and its way out.
#[derive(Clone, Debug, PartialEq)]
pub struct Penetration {
    /// The obstacle.
    pub obstacle: Name,
    /// The vertices of the body or net.
    pub vertices: Range<usize>,
    /// Unit vector along the way out; zero if a pin keeps it inside, or if there is no room beyond.
    pub direction: [f64; 2],
}

impl Penetration {
    /// Whether the body stays inside.
    pub fn stays(&self) -> bool {
        self.direction == [0.0; 2]
    }

    /// Whether a surface with this normal lies behind, where the rest of the body may enter.
    pub fn lets_in(&self, [nx, ny]: [f64; 2]) -> bool {
        self.direction[0] * nx + self.direction[1] * ny < 0.0
    }
}

/// What is known of a step before anything is stopped, kept to be written again without asking for memory.
#[derive(Clone, Debug, Default)]
pub struct ContactCache {
    /// By obstacles, then by vertices.
    pub touching: Vec<Touching>,
    /// By obstacles.
    pub penetrations: Vec<Penetration>,
    /// Unit vectors to choose from.
    pub(super) directions: Vec<[f64; 2]>,
}

impl ContactCache {
    /// Nothing.
    pub const NONE: &Self = &Self { touching: Vec::new(), penetrations: Vec::new(), directions: Vec::new() };

    /// Notes which vertices are near an obstacle or inside where the step begins; obstacles come in the order of their names.
    pub fn record(&mut self, obstacle: &ContactQuery<'_>, start: &Start<'_>) {
        obstacle.find_touching(start, &mut self.touching);
    }

    /// Whether anything begins deep inside.
    pub fn is_inside(&self) -> bool {
        self.touching.iter().any(|touching| touching.is_deep)
    }

    /// Ready for another step.
    pub fn clear(&mut self) {
        self.touching.clear();
        self.penetrations.clear();
    }
}

/// What a vertex has to do that begins deep inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepenetrationStep {
    /// How fast it comes out at least [m/s].
    pub speed: f64,
    /// How far it comes in the step at least [m].
    pub length: f64,
}

impl Start<'_> {
    /// Notes that something is inside.
    pub fn record_inside(&self, inside: Inside) {
        self.inside.set(self.inside.get().max(inside));
    }

    /// How a vertex leaves what it begins inside of, if that is not at once.
    pub fn depenetration(&self, vertex: usize) -> Option<&Depenetration> {
        depenetration_of(self.depenetrations, vertex)
    }

    /// How a vertex comes out that begins at a distance from a surface [m], moves away from it at a speed [m/s] and is to be kept
    /// `offset` from it, if it begins deeper inside than it can come in this step. What little another wall may have pressed it in is
    /// put back at once, but not the last bit of a long way, on which it is as fast as it should be. What stays inside does not come
    /// out at all.
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

    /// What touching does to a vertex. Nothing of what is on its way out bounces: between two walls that it comes out of, it would
    /// gather speed.
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

    /// The way out of the obstacle at hand for the body of a vertex, if that begins inside.
    pub fn penetration(&self, vertex: usize) -> Option<&Penetration> {
        self.penetrations.iter().find(|penetration| penetration.vertices.contains(&vertex))
    }

    /// Takes a share of all motion of what begins deep inside but the one along its way out, once a step and obstacle that it is
    /// in: shaken between two walls it would gather more of it than it has to.
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

    /// What a surface does to the velocity of a vertex that comes out with it at a speed along its unit normal: see
    /// [`Surface::impact_response`]. It gives nothing back, and its work is booked.
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

/// How one of several vertices leaves what it begins inside of.
pub fn depenetration_of(depenetrations: &[Depenetration], vertex: usize) -> Option<&Depenetration> {
    depenetrations.get(depenetrations.partition_point(|depenetration| depenetration.end <= vertex))
}
