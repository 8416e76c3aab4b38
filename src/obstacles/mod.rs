//! What bodies bump into, realised as shapes of parry2d: the one room that knows that library. Each kind is one file;
//! [`ObstacleKind`] lists them all. Points leave this room as `[f64; 2]`.
//!
//! Every obstacle has a reach eps: a vertex nearer than that to the surface may not move towards it.

mod ball;
mod cuboid;
mod plane;
mod polygon;
mod solid;

pub use ball::Ball;
pub use cuboid::Cuboid;
pub use plane::{Plane, room};
pub use polygon::Polygon;

use crate::{quantity::Quantity, registry::registry};

registry! {
    /// What can stand in the way.
    pub enum ObstacleKind: dyn ObstacleParameters {
        Plane(Plane),
        Ball(Ball),
        Cuboid(Cuboid),
        Polygon(Polygon),
    }
}

/// The parameters of an obstacle.
pub trait ObstacleParameters {
    /// Readies the obstacle for stepping.
    ///
    /// # Errors
    /// A sentence, if the parameters do not make a shape.
    fn build(&self) -> Result<Box<dyn Obstacle>, String>;

    /// The numbers a panel may change.
    fn parameters(&mut self) -> Vec<&mut dyn Quantity>;

    /// The surface at which vertices stop (eps outside the shape), counter-clockwise [m]; empty for planes, which have no
    /// outline of their own.
    fn outline(&self) -> Vec<[f64; 2]>;
}

/// Where a point is, seen from an obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Distance to the surface [m]; negative inside.
    pub distance: f64,
    /// Unit vector from the obstacle outwards.
    pub normal: [f64; 2],
}

/// An obstacle ready for stepping.
pub trait Obstacle: Send + Sync {
    /// The nearest surface, if the point is within eps of it or inside.
    fn contact(&self, point: [f64; 2]) -> Option<Contact>;

    /// Whether any point between two corners could be within eps; false only if none is.
    fn is_near(&self, least: [f64; 2], greatest: [f64; 2]) -> bool;

    /// Velocities of vertices within eps that move inwards lose that part: `v <- v - min(0, v . n) n`. Tangential motion
    /// stays, and so does motion outwards, so that nothing sticks. Returns the number of vertices touched.
    fn constrain_velocity(&self, x: &[f64], v: &mut [f64], inverse_mass: &[f64]) -> usize {
        let mut touched = 0;
        for ((x, v), inverse_mass) in x.chunks_exact(2).zip(v.chunks_exact_mut(2)).zip(inverse_mass.chunks_exact(2)) {
            let Some(Contact { normal: [nx, ny], .. }) = self.contact([x[0], x[1]]) else { continue };
            let inwards = v[0] * nx + v[1] * ny;
            let [nx, ny] = movable([nx, ny], inverse_mass);
            if inwards < 0.0 && (nx, ny) != (0.0, 0.0) {
                v[0] -= inwards * nx;
                v[1] -= inwards * ny;
                touched += 1;
            }
        }
        touched
    }

    /// Vertices inside are put back on the surface and lose their velocity inwards. They get none outwards: kinetic
    /// energy never grows. Returns the number of vertices touched.
    fn constrain_position(&self, x: &mut [f64], v: &mut [f64], inverse_mass: &[f64]) -> usize {
        let mut touched = 0;
        for ((x, v), inverse_mass) in x.chunks_exact_mut(2).zip(v.chunks_exact_mut(2)).zip(inverse_mass.chunks_exact(2))
        {
            let Some(Contact { distance, normal: [nx, ny] }) = self.contact([x[0], x[1]]) else { continue };
            let inwards = (v[0] * nx + v[1] * ny).min(0.0);
            let [nx, ny] = movable([nx, ny], inverse_mass);
            if distance < 0.0 && (nx, ny) != (0.0, 0.0) {
                x[0] -= distance * nx;
                x[1] -= distance * ny;
                v[0] -= inwards * nx;
                v[1] -= inwards * ny;
                touched += 1;
            }
        }
        touched
    }
}

/// A push without the coordinates that are held.
fn movable(push: [f64; 2], inverse_mass: &[f64]) -> [f64; 2] {
    [0, 1].map(|axis| if inverse_mass[axis] == 0.0 { 0.0 } else { push[axis] })
}
