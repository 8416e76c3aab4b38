//! Bodies and one obstacle in one step.

use super::{Carry, Contact, Corner, Exit, Inside, Name, Noted, Obstacle, Overlap, Start, Touching, corner, meet};

/// An obstacle on its way through a step, and a box around the ways of all vertices.
#[derive(Clone, Copy)]
pub struct Encounter<'a> {
    name: Name,
    obstacle: &'a dyn Obstacle,
    carry: Carry,
    bounds: [[f64; 2]; 2],
}

impl<'a> Encounter<'a> {
    /// An obstacle by its name; `bounds` are the least and the greatest corner of the box around the ways of all
    /// vertices in the world.
    pub fn new((name, obstacle): (Name, &'a dyn Obstacle), carry: Carry, bounds: [[f64; 2]; 2]) -> Self {
        Self { name, obstacle, carry, bounds: carry.bounds(bounds) }
    }

    /// Whether any vertex could touch; false only if none can.
    pub fn is_near(&self) -> bool {
        let [least, greatest] = self.carry.built(self.bounds);
        self.obstacle.is_near(least, greatest)
    }

    /// The obstacle's motion in this step.
    pub const fn carry(&self) -> &Carry {
        &self.carry
    }

    /// Its name.
    pub const fn name(&self) -> Name {
        self.name
    }

    /// The start of the step as this obstacle sees it.
    pub fn at_hand<'s>(&self, start: &Start<'s>) -> Start<'s> {
        let Noted { touching, overlaps, .. } = start.noted;
        let [effect, number] = self.name;
        let own = |before: &dyn Fn(Name) -> usize| before(self.name)..before([effect, number + 1]);
        let touched = own(&|name| touching.partition_point(|touching| touching.obstacle < name));
        let left = own(&|name| overlaps.partition_point(|overlap| overlap.obstacle < name));
        Start { touching: &touching[touched], overlaps: &overlaps[left], ..*start }
    }

    /// Adds which vertices are near it or inside where the step begins.
    pub fn find_touching(&self, start: &Start<'_>, found: &mut Vec<Touching>) {
        let before = found.len();
        if self.carry.is_still() {
            self.obstacle.find_touching(self.name, start.x, found);
        } else {
            for (vertex, point) in start.x.as_chunks().0.iter().enumerate() {
                let place = self.carry.place(*point);
                let wall = self.carry.velocity_at(place);
                let touching = |contact| Touching { obstacle: self.name, vertex, contact, is_deep: false, wall };
                let contact = self.contact(place);
                found.extend(contact.map(touching));
            }
        }
        for own in &mut found[before..] {
            let pair = |values: &[f64]| [values[2 * own.vertex], values[2 * own.vertex + 1]];
            let outwards = own.contact.along(self.carry.relative(pair(start.v), pair(start.x)));
            own.is_deep = pair(start.inverse_mass) != [0.0; 2]
                && start.rise(own.vertex, own.contact.distance, outwards, self.skin()).is_some();
        }
    }

    /// Stops vertices: see [`Obstacle::constrain`].
    pub fn constrain(&self, start: &Start<'_>, x: &mut [f64], v: &mut [f64]) -> usize {
        let start = &self.at_hand(start);
        if self.carry.is_still() {
            return self.obstacle.constrain(start, x, v);
        }
        let reach = self.obstacle.reach() * self.obstacle.reach();
        let mut touching = start.touching.iter().peekable();
        let mut touched = 0;
        for (vertex, (x, v)) in x.chunks_exact_mut(2).zip(v.chunks_exact_mut(2)).enumerate() {
            let from = start.x[2 * vertex..][..2].try_into().map_or([f64::NAN; 2], |from| self.carry.place(from));
            let begun = touching.next_if(|touching| touching.vertex == vertex).map(|touching| touching.contact);
            let way = [x[0] - from[0], x[1] - from[1]];
            if begun.is_some() || way[0] * way[0] + way[1] * way[1] >= reach {
                touched += usize::from(self.meet(start, (vertex, from, begun), x, v));
            }
        }
        touched
    }

    /// Stops one vertex as the obstacle sees it, which itself does not move.
    fn meet(
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
        let before = self.carry.relative(pair(start.v), pair(start.x));
        let outward = start.outward.map(|outward| self.carry.direction(pair(outward)));
        let outward = outward.as_ref().map(<[f64; 2]>::as_slice);
        let exit = start.exit(vertex).map(|exit| Exit { end: 1, ..*exit });
        let overlap = start.overlap(vertex).map(|overlap| Overlap { vertices: 0..1, ..*overlap });
        // Pressed on by what moves a body would be torn from what keeps it inside.
        if overlap.as_ref().is_some_and(Overlap::stays) {
            start.note_inside(Inside::Stays);
            return false;
        }
        let (exits, overlaps) = (exit.as_slice(), overlap.as_slice());
        let (surface, noted) = (start.surface_at(vertex), Noted::NONE);
        let seen = Start { x: &from, v: &before, inverse_mass, surface, outward, exits, overlaps, noted, ..*start };
        let wall = self.carry.velocity_at([x[0], x[1]]);
        let (mut to, mut relative) = ([x[0], x[1]], [v[0] - wall[0], v[1] - wall[1]]);
        if !meet::meet(self, &seen, (0, begun), &mut to, &mut relative) {
            return false;
        }
        let wall = self.carry.velocity_at(to);
        let mut work = 0.0;
        for axis in (0..2).filter(|axis| inverse_mass[*axis] != 0.0) {
            let after = relative[axis] + wall[axis];
            work += (after - v[axis]) / inverse_mass[axis] * wall[axis];
            (x[axis], v[axis]) = (to[axis], after);
        }
        start.supply(work);
        true
    }

    /// Where a corner is near an edge of a body, that may not move towards it. Returns how many edges were touched.
    pub fn press_edges(&self, boundary: &[[u32; 2]], start: &Start<'_>, x: &mut [f64], v: &mut [f64]) -> usize {
        let start = &self.at_hand(start);
        corner::press_edges((self.obstacle.corners(), &self.carry, boundary, self.bounds), start, x, v)
    }

    /// Stops edges of bodies where a corner would first touch on their way. Returns how many there were.
    pub fn stop_edges(&self, boundary: &[[u32; 2]], start: &Start<'_>, x: &mut [f64], v: &mut [f64]) -> usize {
        let start = &self.at_hand(start);
        corner::stop_edges((self.obstacle.corners(), &self.carry, boundary, self.bounds), start, x, v)
    }
}

/// The obstacle at its place at the end of the step.
impl Obstacle for Encounter<'_> {
    fn contact(&self, point: [f64; 2]) -> Option<Contact> {
        let contact = self.obstacle.contact(self.carry.end.back(point))?;
        Some(Contact { normal: self.carry.end.normal(contact.normal), ..contact })
    }

    fn is_near(&self, least: [f64; 2], greatest: [f64; 2]) -> bool {
        let [least, greatest] = self.carry.built([least, greatest]);
        self.obstacle.is_near(least, greatest)
    }

    /// It is looked at in one step, and may be anywhere in the next.
    fn may_reach(&self, _least: [f64; 2], _greatest: [f64; 2]) -> bool {
        true
    }

    fn reach(&self) -> f64 {
        self.obstacle.reach()
    }

    fn skin(&self) -> f64 {
        self.obstacle.skin()
    }

    fn cast(&self, from: [f64; 2], way: [f64; 2]) -> Option<(f64, [f64; 2])> {
        let end = &self.carry.end;
        let (share, normal) = self.obstacle.cast(end.back(from), end.direction_back(way))?;
        Some((share, end.normal(normal)))
    }

    /// For a point where the step begins.
    fn way_past(&self, point: [f64; 2], direction: [f64; 2]) -> Option<f64> {
        self.obstacle.way_past(self.carry.start.back(point), self.carry.end.direction_back(direction))
    }

    fn each_way(&self, act: &mut dyn FnMut([f64; 2])) {
        self.obstacle.each_way(&mut |way| act(self.carry.end.normal(way)));
    }

    fn is_solid(&self) -> bool {
        self.obstacle.is_solid()
    }

    fn corners(&self) -> &[Corner] {
        self.obstacle.corners()
    }
}
