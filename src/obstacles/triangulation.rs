//! Surfaces of obstacles in space, to be drawn.

use super::Rigid;
use parry3d::math::{Pose, Vector};

/// Triangles of a surface in space, counter-clockwise seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Triangulation {
    /// Corners \[m\].
    pub points: Vec<[f64; 3]>,
    /// Triangles, by the numbers of their corners.
    pub triangles: Vec<[u32; 3]>,
}

impl Triangulation {
    /// Triangles of a shape at a place.
    pub(super) fn new((points, triangles): (Vec<Vector>, Vec<[u32; 3]>), pose: Pose) -> Self {
        Self { points: points.into_iter().map(|point| (pose * point).into()).collect(), triangles }
    }

    /// The same surface after a rigid motion.
    #[must_use]
    pub fn moved(mut self, to: &Rigid<3>) -> Self {
        self.points.iter_mut().for_each(|point| *point = to.point(*point));
        self
    }
}
