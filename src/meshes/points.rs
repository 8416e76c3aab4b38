//! Mesh given by points and triangles in the level.

use super::{Files, Mesh, MeshError, MeshSource};
use crate::quantity::{Coordinate, Point};

/// Points `(x, y)` \[m\] and triangles `(a, b, c)` that count them from 0.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Points {
    /// Where the vertices are \[m\].
    pub points: Vec<Point>,
    /// Three vertices each, counted from 0, in either direction.
    pub triangles: Vec<(u32, u32, u32)>,
}

impl Default for Points {
    /// Square of side 0.5 m, cut into two triangles.
    fn default() -> Self {
        let at = |x, y| Point(Coordinate::literal(x), Coordinate::literal(y));
        Self {
            points: vec![at(0.25, 0.25), at(0.75, 0.25), at(0.75, 0.75), at(0.25, 0.75)],
            triangles: vec![(0, 1, 2), (0, 2, 3)],
        }
    }
}

impl MeshSource for Points {
    fn build(&self, _: &dyn Files) -> Result<Mesh, MeshError> {
        let points = self.points.iter().map(|point| point.get()).collect();
        Mesh::new(points, self.triangles.iter().map(|&(a, b, c)| [a, b, c]).collect())
    }
}
