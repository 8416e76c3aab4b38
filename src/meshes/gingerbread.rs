//! Mesh of the gingerbread man.

use super::{
    Files, Locator, Mesh, MeshError, MeshSource, Whole, gingerbread_icing, gingerbread_shape, ordering, polygon,
    triangulate,
};
use crate::quantity::{Quantity, Triangles};

/// The gingerbread man, 0.56 m wide and 0.65 m tall in the middle of the 1 m x 1 m world, with his icing. Left and right
/// are mirror images in outline, and no angle is below 25 degrees.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Gingerbread {
    /// Number of triangles to aim for.
    pub resolution: Whole<Triangles>,
}

impl Default for Gingerbread {
    fn default() -> Self {
        Self { resolution: Whole::literal(Triangles::literal(2000.0)) }
    }
}

impl MeshSource for Gingerbread {
    fn build(&self, _: &dyn Files) -> Result<Mesh, MeshError> {
        let half = gingerbread_shape::outline();
        let area = polygon::signed_area(&mirrored(&half));
        let target = f64::from(self.resolution.count());
        let (points, triangles) = triangulate::fill(target, area, &|edge| sampled(&half, edge))?;
        let (points, triangles) = ordering::by_place(&points, &triangles);
        let icing = gingerbread_icing::icing(&Locator::new(&points, &triangles));
        Ok(Mesh::new(points, triangles)?.with_icing(icing))
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.resolution]
    }
}

/// Outline in points about one edge length [m] apart, counter-clockwise, with equal numbers on the left and right.
fn sampled(half: &[[f64; 2]], edge: f64) -> Vec<[f64; 2]> {
    let length: f64 = 0.5 * polygon::perimeter(&mirrored(half));
    let pieces = ((length / edge).round() as usize).max(2);
    mirrored(&polygon::spaced(half, pieces + 1))
}

/// Whole outline from its right half, which runs from crown to crotch: up on the right, down on the left.
fn mirrored(half: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let left = half.iter().take(half.len() - 1).skip(1).map(|&[x, y]| [1.0 - x, y]);
    half.iter().rev().copied().chain(left).collect()
}
