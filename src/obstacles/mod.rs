//! Rigid obstacles, represented by shapes of parry2d. Only this module uses that library; its interface takes points as
//! `[f64; 2]`. Each kind is one file; [`ObstacleKind`] lists them all.
//!
//! An obstacle gives distances and normals, and its convex corners; [`crate::contact`] is what it does to bodies.
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

mod ball;
mod corner;
mod cuboid;
mod motions;
mod moving;
mod plane;
mod polygon;
mod rigid;
mod segments;
mod solid;

pub use ball::Ball;
pub use corner::Corner;
pub use cuboid::Cuboid;
pub use motions::{Motion, MotionKind, Slide, Swing, Turn, placed};
pub use moving::Moving;
pub use plane::{HalfPlane, Plane, free_region};
pub use polygon::Polygon;
pub use rigid::{Rigid, SweptMotion};
pub use segments::{segments_meet, side_of};

use crate::{quantity::Quantity, registry::registry};

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

    /// Contact margin eps \[m\].
    fn margin(&self) -> f64;

    /// Whether it is bounded.
    fn is_solid(&self) -> bool {
        false
    }

    /// Whether it is convex.
    fn is_convex(&self) -> bool {
        true
    }

    /// Its convex corners, which can touch an edge of a body between two vertices.
    fn corners(&self) -> &[Corner] {
        &[]
    }
}
