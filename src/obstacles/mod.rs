//! What bodies bump into, realised as shapes of parry2d: the one room that knows that library. Each kind is one file;
//! [`ObstacleKind`] lists them all. Points leave this room as `[f64; 2]`.
//!
//! Every obstacle has a reach eps: a vertex nearer than that to the surface may not move towards it. Beside that no speed
//! gets a vertex through a surface, nor a corner of an obstacle through an edge of a body: where they would meet within a
//! step is found by conservative advancement (Mirtich, *Impulse-based Dynamic Simulation of Rigid Body Systems*, 1996,
//! section 2.3), which never passes the first touch, and there they stop. All that is relative to an obstacle that moves.

mod advance;
mod ball;
mod contact_query;
mod corner;
mod cuboid;
mod depenetration;
mod motions;
mod moving;
mod penetration;
mod plane;
mod polygon;
mod resolve;
mod solid;
mod surface;
mod swept_motion;

pub use ball::Ball;
pub use contact_query::ContactQuery;
pub use corner::Corner;
pub use cuboid::Cuboid;
pub use depenetration::find_penetrations;
pub use motions::{Motion, MotionKind, Slide, Swing, Turn, placed};
pub use moving::Moving;
pub use penetration::{
    ContactCache, Depenetration, DepenetrationStep, Inside, Name, Penetration, Touching, depenetration_of,
};
pub use plane::{Plane, STEEP, free_region};
pub use polygon::Polygon;
pub use resolve::push_out_vertex;
pub use surface::Surface;
pub use swept_motion::{Rigid, SweptMotion};

use crate::{quantity::Quantity, registry::registry};
use std::cell::Cell;

registry! {
    /// What can stand in the way.
    pub enum ObstacleKind: dyn ObstacleParameters {
        Plane(Plane),
        Ball(Ball),
        Cuboid(Cuboid),
        Polygon(Polygon),
        Moving(Moving),
    }
}

impl ObstacleKind {
    /// What it is called beside others.
    pub fn title(&self) -> String {
        match self {
            Self::Moving(moving) => format!("{}, moving", moving.obstacle.title()),
            still => still.name().to_owned(),
        }
    }
}

/// The parameters of an obstacle.
pub trait ObstacleParameters {
    /// Readies the obstacle for stepping.
    ///
    /// # Errors
    /// A sentence, if the parameters do not make a shape.
    fn build(&self) -> Result<Box<dyn Obstacle>, String>;

    /// What the user should know of its shape.
    fn notes(&self) -> Option<String> {
        None
    }

    /// The numbers a panel may change.
    fn parameters(&mut self) -> Vec<&mut dyn Quantity>;

    /// The surface at which vertices stop (eps outside the shape), counter-clockwise [m]; empty for planes, which have no
    /// outline of their own.
    fn outline(&self) -> Vec<[f64; 2]>;

    /// How it moves, one motion on top of the other; most stand still.
    fn motions(&self) -> Vec<MotionKind> {
        Vec::new()
    }

    /// The plane, if it is one: several make a room.
    fn plane(&self) -> Option<&Plane> {
        None
    }
}

/// Where a point is, seen from an obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Distance to the surface [m]; negative inside.
    pub distance: f64,
    /// Unit vector from the obstacle outwards.
    pub normal: [f64; 2],
}

impl Contact {
    /// The part of a vector away from the surface.
    pub fn along(&self, [x, y]: [f64; 2]) -> f64 {
        self.normal[0] * x + self.normal[1] * y
    }
}

/// What a step began with, flat: two numbers a vertex.
#[derive(Clone, Copy, Debug)]
pub struct Start<'a> {
    /// Positions [m].
    pub x: &'a [f64],
    /// Velocities [m/s].
    pub v: &'a [f64],
    /// 1/mass [1/kg]; zero for coordinates that are held.
    pub inverse_mass: &'a [f64],
    /// What touching does.
    pub surface: Surface,
    /// If only what faces an obstacle is to be stopped: the outward normal of each vertex on the boundary of a body, zero
    /// inside it, and not a number where there is no inside.
    pub outward: Option<&'a [f64]>,
    /// Simulated time at the start and at the end [s].
    pub time: [f64; 2],
    /// Where the work of obstacles that move is added up [J].
    pub supplied: &'a Cell<f64>,
    /// How fast vertices leave what they begin inside of.
    pub depenetrations: &'a [Depenetration],
    /// Which effect the obstacle at hand belongs to.
    pub effect: usize,
    /// Which vertices touch the obstacle at hand.
    pub touching: &'a [Touching],
    /// Who begins inside of it, and the way out.
    pub penetrations: &'a [Penetration],
    /// The same of all obstacles.
    pub contact_cache: &'a ContactCache,
    /// Where it is noted that something began inside anything.
    pub inside: &'a Cell<Inside>,
}

impl Start<'_> {
    /// Books work of an obstacle on what it pushed [J]. What it takes away is lost like what any contact takes.
    fn supply(&self, work: f64) {
        self.supplied.set(self.supplied.get() + work.max(0.0));
    }

    /// Whether a vertex is to be stopped by a surface with this normal.
    pub fn faces(&self, vertex: usize, [nx, ny]: [f64; 2]) -> bool {
        self.outward.is_none_or(|outward| {
            let along = outward[2 * vertex] * nx + outward[2 * vertex + 1] * ny;
            along < 0.0 || along.is_nan()
        })
    }

    /// The direction in which a vertex can be pushed by a surface with this normal: without the coordinates that are held.
    pub fn movable(&self, vertex: usize, normal: [f64; 2]) -> Option<[f64; 2]> {
        let free = |axis: usize| self.inverse_mass[2 * vertex + axis] != 0.0;
        if free(0) && free(1) {
            return Some(normal);
        }
        let [x, y] = [0, 1].map(|axis| if free(axis) { normal[axis] } else { 0.0 });
        let length = (x * x + y * y).sqrt();
        (length > 0.0).then(|| [x / length, y / length])
    }
}

/// An obstacle ready for stepping.
pub trait Obstacle: Send + Sync {
    /// The nearest surface, if the point is within eps of it or inside.
    fn contact(&self, point: [f64; 2]) -> Option<Contact>;

    /// Whether any point between two corners could be within eps; false only if none is.
    fn is_near(&self, least: [f64; 2], greatest: [f64; 2]) -> bool;

    /// Whether a point on a way between two corners could ever be within eps: now or at any later time, so that an obstacle
    /// that moves answers for all the places it gets to. Where it says no, a step need not ask again.
    fn may_touch(&self, least: [f64; 2], greatest: [f64; 2]) -> bool;

    /// eps [m].
    fn margin(&self) -> f64;

    /// How far from the surface a vertex is put that would be nearer or inside [m].
    fn offset(&self) -> f64 {
        0.0
    }

    /// Where a point outside that goes a way first touches, as a share of the way and the normal there. What is not there
    /// for a half-plane: whoever ends outside it never was inside.
    fn cast(&self, _from: [f64; 2], _displacement: [f64; 2]) -> Option<(f64, [f64; 2])> {
        None
    }

    /// How far a point has to go in a direction to be past it [m], if it is inside, or before what is solid; infinite if that
    /// leads ever deeper into a half-plane.
    fn depenetration_distance(&self, point: [f64; 2], direction: [f64; 2]) -> Option<f64>;

    /// Calls `act` with unit vectors along ways out of it.
    fn each_direction(&self, act: &mut dyn FnMut([f64; 2]));

    /// Whether it is bounded, so that ways lead out of it to all sides.
    fn is_solid(&self) -> bool {
        false
    }

    /// Its corners that point outwards, which can touch between two vertices of a body.
    fn corners(&self) -> &[Corner] {
        &[]
    }

    /// Adds which of some points, flat, are within eps of the surface or inside, as vertices of the obstacle with this name.
    fn find_touching(&self, name: Name, x: &[f64], found: &mut Vec<Touching>) {
        for (vertex, point) in x.as_chunks().0.iter().enumerate() {
            found.extend(self.contact(*point).map(|contact| Touching {
                obstacle: name,
                vertex,
                contact,
                is_deep: false,
                wall: [0.0; 2],
            }));
        }
    }

    /// Stops vertices that would come too near in a step that would end at positions x with velocities v: the velocity
    /// inwards is removed, and so is the way inwards, as [`Surface::impact_response`] says. Motion outwards stays, so that nothing
    /// sticks. Returns the number of vertices touched.
    fn constrain(&self, start: &Start<'_>, x: &mut [f64], v: &mut [f64]) -> usize {
        let margin = self.margin() * self.margin();
        let mut touching = start.touching.iter().peekable();
        let mut touched = 0;
        for (vertex, ((from, x), v)) in
            start.x.chunks_exact(2).zip(x.chunks_exact_mut(2)).zip(v.chunks_exact_mut(2)).enumerate()
        {
            let begun = touching.next_if(|touching| touching.vertex == vertex).map(|touching| touching.contact);
            let displacement = [x[0] - from[0], x[1] - from[1]];
            // From beyond eps, a shorter way does not reach the surface.
            if begun.is_some() || displacement[0] * displacement[0] + displacement[1] * displacement[1] >= margin {
                touched += usize::from(resolve::resolve_contact(self, start, (vertex, begun), x, v));
            }
        }
        touched
    }
}
