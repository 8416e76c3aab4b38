//! Rigid obstacles, represented by shapes of parry2d. Only this module uses that library; its interface takes points as
//! `[f64; 2]`. Each kind is one file; [`ObstacleKind`] lists them all.
//!
//! Every obstacle has a contact margin eps: a vertex nearer than eps to the surface may not move towards it. Continuous
//! collision detection stops a vertex at the first touch of a surface, and an edge of a body at the first touch of a
//! corner of an obstacle, at any speed. Conservative advancement finds the time of the first touch and never passes it
//! (Mirtich, *Impulse-based Dynamic Simulation of Rigid Body Systems*, 1996, section 2.3). All motion is relative to an
//! obstacle that moves.
//!
//! ```
//! use gingerbread::obstacles::{Ball, ObstacleParameters as _};
//!
//! // A ball at (0.5, 0.2) of radius 0.1, with a margin of 0.01.
//! let ball = Ball::default().build()?;
//! let contact = ball.contact([0.5, 0.305]).ok_or("it is within the margin")?;
//! assert!((contact.distance - 0.005).abs() < 1e-12 && contact.normal == [0.0, 1.0]);
//! assert!(ball.contact([0.5, 0.32]).is_none());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod active_set;
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
mod segments;
mod solid;
mod swept_motion;

pub use active_set::{ActiveSet, ActiveSetStatus, is_touched};
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
pub use resolve::{Surface, push_out_vertex};
pub use segments::{segments_meet, side_of};
pub use swept_motion::{Rigid, SweptMotion};

use crate::{
    quantity::{Quantity, Reach},
    registry::registry,
};
use std::cell::Cell;

registry! {
    /// Kinds of obstacles.
    pub enum ObstacleKind: dyn ObstacleParameters {
        Plane(Plane),
        Ball(Ball),
        Cuboid(Cuboid),
        Polygon(Polygon),
        Moving(Moving),
    }
}

impl ObstacleKind {
    /// Name in a list of obstacles.
    pub fn title(&self) -> String {
        match self {
            Self::Moving(moving) => format!("{}, moving", moving.obstacle.title()),
            still => still.name().to_owned(),
        }
    }
}

/// The parameters of an obstacle.
pub trait ObstacleParameters {
    /// Builds the obstacle for stepping.
    ///
    /// # Errors
    /// A sentence, if the parameters do not define a shape.
    fn build(&self) -> Result<Box<dyn Obstacle>, String>;

    /// A note for the user on the shape.
    fn notes(&self) -> Option<String> {
        None
    }

    /// Replaces the contact margin eps.
    fn set_margin(&mut self, margin: Reach);

    /// The numbers a panel may change.
    fn parameters(&mut self) -> Vec<&mut dyn Quantity>;

    /// The surface at which vertices stop (eps outside the shape), counter-clockwise \[m\]; empty for planes, which have no
    /// outline of their own.
    fn outline(&self) -> Vec<[f64; 2]>;

    /// Its motions, applied one after another; empty for an obstacle at rest.
    fn motions(&self) -> Vec<MotionKind> {
        Vec::new()
    }

    /// The plane, if the obstacle is one. Several planes bound a free region.
    fn plane(&self) -> Option<&Plane> {
        None
    }
}

/// Distance and normal of the surface nearest to a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Distance to the surface \[m\]; negative inside.
    pub distance: f64,
    /// Unit vector from the obstacle outwards.
    pub normal: [f64; 2],
}

impl Contact {
    /// Component of a vector along the normal.
    pub fn along(&self, [x, y]: [f64; 2]) -> f64 {
        self.normal[0] * x + self.normal[1] * y
    }
}

/// State at the start of a step, for constraints; flat, two numbers a vertex.
#[derive(Clone, Copy, Debug)]
pub struct Start<'a> {
    /// Positions \[m\].
    pub x: &'a [f64],
    /// Velocities [m/s].
    pub v: &'a [f64],
    /// 1/mass [1/kg]; zero for constrained coordinates.
    pub inverse_mass: &'a [f64],
    /// Surface properties of contacts.
    pub surface: Surface,
    /// Outward normal of each vertex on the boundary of a body, if only vertices that face an obstacle are stopped;
    /// zero inside the body, NaN where there is no inside.
    pub outward: Option<&'a [f64]>,
    /// Simulated time at the start and at the end \[s\].
    pub time: [f64; 2],
    /// Sum of the work of moving obstacles \[J\].
    pub supplied: &'a Cell<f64>,
    /// Depenetration parameters of the bodies and nets.
    pub depenetrations: &'a [Depenetration],
    /// Number of the effect that the current obstacle belongs to.
    pub effect: usize,
    /// Vertices that touch the current obstacle.
    pub touching: &'a [Touching],
    /// Bodies and nets that penetrate the current obstacle.
    pub penetrations: &'a [Penetration],
    /// Contacts and penetrations of all obstacles.
    pub contact_cache: &'a ContactCache,
    /// Whether anything penetrates an obstacle in this step.
    pub inside: &'a Cell<Inside>,
}

impl Start<'_> {
    /// Adds work of an obstacle on a vertex \[J\]. Negative work is dissipated, as in any contact.
    fn supply(&self, work: f64) {
        self.supplied.set(self.supplied.get() + work.max(0.0));
    }

    /// Whether a surface with this normal stops a vertex.
    pub fn faces(&self, vertex: usize, [nx, ny]: [f64; 2]) -> bool {
        self.outward.is_none_or(|outward| {
            let along = outward[2 * vertex] * nx + outward[2 * vertex + 1] * ny;
            along < 0.0 || along.is_nan()
        })
    }

    /// The normal projected on the free coordinates of a vertex, normalised; `None` if nothing is left.
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
    /// The nearest surface, if the point is nearer to it than `reach` \[m\] or inside.
    fn distance(&self, point: [f64; 2], reach: f64) -> Option<Contact>;

    /// The nearest surface, if the point is within eps of it or inside.
    fn contact(&self, point: [f64; 2]) -> Option<Contact> {
        self.distance(point, self.margin())
    }

    /// Whether any point of a box could be within eps; conservative.
    fn is_near(&self, least: [f64; 2], greatest: [f64; 2]) -> bool;

    /// Whether any point of a box could be within eps at any time, over the whole motion of the obstacle; conservative.
    fn may_touch(&self, least: [f64; 2], greatest: [f64; 2]) -> bool;

    /// Contact margin eps \[m\].
    fn margin(&self) -> f64;

    /// Contact offset: distance from the surface at which a penetrating vertex is placed \[m\].
    fn offset(&self) -> f64 {
        0.0
    }

    /// First touch of a point that moves along a displacement: fraction of the displacement, and normal. `None` for
    /// half-planes, where the end point decides.
    fn cast(&self, _from: [f64; 2], _displacement: [f64; 2]) -> Option<(f64, [f64; 2])> {
        None
    }

    /// Distance that a penetrating point has to move along a direction to leave the obstacle \[m\]; for a point in front
    /// of a solid, to pass it. Infinite if the direction leads deeper into a half-plane.
    fn depenetration_distance(&self, point: [f64; 2], direction: [f64; 2]) -> Option<f64>;

    /// Calls `act` with unit vectors that lead out of the obstacle.
    fn each_direction(&self, act: &mut dyn FnMut([f64; 2]));

    /// Whether it is bounded.
    fn is_solid(&self) -> bool {
        false
    }

    /// Its convex corners, which can touch an edge of a body between two vertices.
    fn corners(&self) -> &[Corner] {
        &[]
    }

    /// Adds the points, flat, that are within eps of the surface or inside, as vertices that touch the obstacle with
    /// this name.
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

    /// Applies contact to vertices whose step ends at positions x with velocities v: removes the inward velocity and
    /// the inward displacement, with [`Surface::impact_response`]. Outward motion stays, so that contacts do not
    /// adhere. Returns the number of vertices changed.
    fn constrain(&self, start: &Start<'_>, x: &mut [f64], v: &mut [f64]) -> usize {
        let margin = self.margin() * self.margin();
        let mut touching = start.touching.iter().peekable();
        let mut touched = 0;
        for (vertex, ((from, x), v)) in
            start.x.chunks_exact(2).zip(x.chunks_exact_mut(2)).zip(v.chunks_exact_mut(2)).enumerate()
        {
            let begun = touching.next_if(|touching| touching.vertex == vertex).map(|touching| touching.contact);
            let displacement = [x[0] - from[0], x[1] - from[1]];
            // A vertex beyond eps with a shorter displacement does not reach the surface.
            if begun.is_some() || displacement[0] * displacement[0] + displacement[1] * displacement[1] >= margin {
                touched += usize::from(resolve::resolve_contact(self, start, (vertex, begun), x, v));
            }
        }
        touched
    }
}
