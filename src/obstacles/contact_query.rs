//! Contact query: the bodies against one obstacle in one step.

use super::{
    Contact, ContactCache, Corner, Depenetration, Inside, Name, Obstacle, Penetration, Start, SweptMotion, Touching,
    corner, resolve,
};

/// An obstacle with its motion in a step, and a box around the swept vertices.
#[derive(Clone, Copy)]
pub struct ContactQuery<'a> {
    name: Name,
    obstacle: &'a dyn Obstacle,
    swept_motion: SweptMotion,
    bounds: [[f64; 2]; 2],
}

impl<'a> ContactQuery<'a> {
    /// Makes a query for a named obstacle; `bounds` are the least and the greatest corner of the box around the swept
    /// vertices in the world.
    pub fn new((name, obstacle): (Name, &'a dyn Obstacle), swept_motion: SweptMotion, bounds: [[f64; 2]; 2]) -> Self {
        Self { name, obstacle, swept_motion, bounds: swept_motion.bounds(bounds) }
    }

    /// Whether any vertex could touch; conservative.
    pub fn is_near(&self) -> bool {
        let [least, greatest] = self.swept_motion.built(self.bounds);
        self.obstacle.is_near(least, greatest)
    }

    /// The obstacle's motion in this step.
    pub const fn swept_motion(&self) -> &SweptMotion {
        &self.swept_motion
    }

    /// Its name.
    pub const fn name(&self) -> Name {
        self.name
    }

    /// The start of the step with the contacts and penetrations of this obstacle alone.
    pub fn for_obstacle<'s>(&self, start: &Start<'s>) -> Start<'s> {
        let ContactCache { touching, penetrations, .. } = start.contact_cache;
        let [effect, number] = self.name;
        let own = |before: &dyn Fn(Name) -> usize| before(self.name)..before([effect, number + 1]);
        let touched = own(&|name| touching.partition_point(|touching| touching.obstacle < name));
        let left = own(&|name| penetrations.partition_point(|penetration| penetration.obstacle < name));
        Start { touching: &touching[touched], penetrations: &penetrations[left], ..*start }
    }

    /// Adds the vertices that are within the margin of the obstacle, or inside, at the start of the step.
    pub fn find_touching(&self, start: &Start<'_>, found: &mut Vec<Touching>) {
        let before = found.len();
        if self.swept_motion.is_still() {
            self.obstacle.find_touching(self.name, start.x, found);
        } else {
            for (vertex, point) in start.x.as_chunks().0.iter().enumerate() {
                let place = self.swept_motion.place(*point);
                let wall = self.swept_motion.velocity_at(place);
                let touching = |contact| Touching { obstacle: self.name, vertex, contact, is_deep: false, wall };
                let contact = self.contact(place);
                found.extend(contact.map(touching));
            }
        }
        for own in &mut found[before..] {
            let pair = |values: &[f64]| [values[2 * own.vertex], values[2 * own.vertex + 1]];
            let outwards = own.contact.along(self.swept_motion.relative(pair(start.v), pair(start.x)));
            own.is_deep = pair(start.inverse_mass) != [0.0; 2]
                && start.depenetration_step(own.vertex, own.contact.distance, outwards, self.offset()).is_some();
        }
    }

    /// Applies contact to vertices; see [`Obstacle::constrain`].
    pub fn constrain(&self, start: &Start<'_>, x: &mut [f64], v: &mut [f64]) -> usize {
        let start = &self.for_obstacle(start);
        if self.swept_motion.is_still() {
            return self.obstacle.constrain(start, x, v);
        }
        let margin = self.obstacle.margin() * self.obstacle.margin();
        let mut touching = start.touching.iter().peekable();
        let mut touched = 0;
        for (vertex, (x, v)) in x.chunks_exact_mut(2).zip(v.chunks_exact_mut(2)).enumerate() {
            let from =
                start.x[2 * vertex..][..2].try_into().map_or([f64::NAN; 2], |from| self.swept_motion.place(from));
            let begun = touching.next_if(|touching| touching.vertex == vertex).map(|touching| touching.contact);
            let displacement = [x[0] - from[0], x[1] - from[1]];
            if begun.is_some() || displacement[0] * displacement[0] + displacement[1] * displacement[1] >= margin {
                touched += usize::from(self.resolve_contact(start, (vertex, from, begun), x, v));
            }
        }
        touched
    }

    /// Resolves contact of one vertex in the frame of the obstacle.
    fn resolve_contact(
        &self,
        start: &Start<'_>,
        (vertex, from, begun): (usize, [f64; 2], Option<Contact>),
        x: &mut [f64],
        v: &mut [f64],
    ) -> bool {
        let numbers = 2 * vertex..2 * vertex + 2;
        let inverse_mass = &start.inverse_mass[numbers.clone()];
        if inverse_mass == [0.0; 2] {
            return false;
        }
        let pair = |values: &[f64]| [values[2 * vertex], values[2 * vertex + 1]];
        let before = self.swept_motion.relative(pair(start.v), pair(start.x));
        let outward = start.outward.map(|outward| self.swept_motion.direction(pair(outward)));
        let outward = outward.as_ref().map(<[f64; 2]>::as_slice);
        let depenetration = start.depenetration(vertex).map(|depenetration| Depenetration { end: 1, ..*depenetration });
        let penetration = start.penetration(vertex).map(|penetration| Penetration { vertices: 0..1, ..*penetration });
        // A body that a pin keeps inside is not pushed: a moving obstacle would tear it from the pin.
        if penetration.as_ref().is_some_and(Penetration::stays) {
            start.record_inside(Inside::Stays);
            return false;
        }
        let (depenetrations, penetrations) = (depenetration.as_slice(), penetration.as_slice());
        let (surface, contact_cache) = (start.surface_at(vertex), ContactCache::NONE);
        let seen = Start {
            x: &from,
            v: &before,
            inverse_mass,
            surface,
            outward,
            depenetrations,
            penetrations,
            contact_cache,
            ..*start
        };
        let wall = self.swept_motion.velocity_at([x[0], x[1]]);
        let (mut to, mut relative) = ([x[0], x[1]], [v[0] - wall[0], v[1] - wall[1]]);
        if !resolve::resolve_contact(self, &seen, (0, begun), &mut to, &mut relative) {
            return false;
        }
        let wall = self.swept_motion.velocity_at(to);
        let mut work = 0.0;
        for axis in (0..2).filter(|axis| inverse_mass[*axis] != 0.0) {
            let after = relative[axis] + wall[axis];
            work += (after - v[axis]) / inverse_mass[axis] * wall[axis];
            (x[axis], v[axis]) = (to[axis], after);
        }
        start.supply(work);
        true
    }

    /// Applies contact between near corners and edges of bodies. Returns the number of edges changed.
    pub fn press_edges(&self, boundary: &[[u32; 2]], start: &Start<'_>, x: &mut [f64], v: &mut [f64]) -> usize {
        let start = &self.for_obstacle(start);
        corner::press_edges((self.obstacle.corners(), &self.swept_motion, boundary, self.bounds), start, x, v)
    }

    /// Stops edges of bodies at the first touch of a corner within the step. Returns their number.
    pub fn stop_edges(&self, boundary: &[[u32; 2]], start: &Start<'_>, x: &mut [f64], v: &mut [f64]) -> usize {
        let start = &self.for_obstacle(start);
        corner::stop_edges((self.obstacle.corners(), &self.swept_motion, boundary, self.bounds), start, x, v)
    }
}

/// The obstacle at the end of the step.
impl Obstacle for ContactQuery<'_> {
    fn distance(&self, point: [f64; 2], reach: f64) -> Option<Contact> {
        let contact = self.obstacle.distance(self.swept_motion.end.back(point), reach)?;
        Some(Contact { normal: self.swept_motion.end.normal(contact.normal), ..contact })
    }

    fn is_near(&self, least: [f64; 2], greatest: [f64; 2]) -> bool {
        let [least, greatest] = self.swept_motion.built([least, greatest]);
        self.obstacle.is_near(least, greatest)
    }

    /// A query covers one step; the obstacle may be anywhere in the next.
    fn may_touch(&self, _least: [f64; 2], _greatest: [f64; 2]) -> bool {
        true
    }

    fn margin(&self) -> f64 {
        self.obstacle.margin()
    }

    fn offset(&self) -> f64 {
        self.obstacle.offset()
    }

    fn cast(&self, from: [f64; 2], displacement: [f64; 2]) -> Option<(f64, [f64; 2])> {
        let end = &self.swept_motion.end;
        let (share, normal) = self.obstacle.cast(end.back(from), end.direction_back(displacement))?;
        Some((share, end.normal(normal)))
    }

    /// For a point at the start of the step.
    fn depenetration_distance(&self, point: [f64; 2], direction: [f64; 2]) -> Option<f64> {
        self.obstacle.depenetration_distance(
            self.swept_motion.start.back(point),
            self.swept_motion.end.direction_back(direction),
        )
    }

    fn each_direction(&self, act: &mut dyn FnMut([f64; 2])) {
        self.obstacle.each_direction(&mut |direction| act(self.swept_motion.end.normal(direction)));
    }

    fn is_solid(&self) -> bool {
        self.obstacle.is_solid()
    }

    fn corners(&self) -> &[Corner] {
        self.obstacle.corners()
    }
}
