//! Any simple outline, filled with triangles.

use super::{Files, Mesh, MeshError, MeshSource, Whole, mesh::squared_distance, ordering, polygon, triangulate};
use crate::quantity::{Coordinate, Point, Quantity, Triangles};

/// Cosine of the turn above which a point of the outline is a corner: 20 degrees.
const CORNER: f64 = 0.939_692_620_785_908_4;

/// Most points along an outline. Compact ones stay far below, and the triangulation of long thin ones takes very long.
const MOST_ALONG: f64 = 10_000.0;

/// The inside of a polygon, in about `resolution` triangles. Corners stay sharp; a run of sides shorter than the
/// triangles is taken for a curve. No angle is below 25 degrees unless the polygon itself has corners that sharp.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Outline {
    /// The corners in order, in either direction, the first not repeated [m].
    pub points: Vec<Point>,
    /// Number of triangles to aim for.
    #[serde(default = "thousand")]
    pub resolution: Whole<Triangles>,
}

/// A thousand triangles.
fn thousand() -> Whole<Triangles> {
    Whole::literal(Triangles::literal(1000.0))
}

impl Default for Outline {
    /// A fir tree.
    fn default() -> Self {
        let at = |x, y| Point(Coordinate::literal(x), Coordinate::literal(y));
        let right = [
            (0.5, 0.84),
            (0.62, 0.64),
            (0.57, 0.64),
            (0.7, 0.44),
            (0.63, 0.44),
            (0.77, 0.23),
            (0.55, 0.23),
            (0.55, 0.14),
        ];
        let left = right.iter().rev().take(right.len() - 1).map(|&(x, y)| at(1.0 - x, y));
        Self { points: right.iter().map(|&(x, y)| at(x, y)).chain(left).collect(), resolution: thousand() }
    }
}

impl MeshSource for Outline {
    fn build(&self, _: &dyn Files) -> Result<Mesh, MeshError> {
        let mut corners: Vec<[f64; 2]> = self.points.iter().map(|point| point.get()).collect();
        if corners.len() < 3 {
            return Err(MeshError::Recipe(format!("an outline needs at least 3 points, got {}", corners.len())));
        }
        if let Some((first, second)) = polygon::crossing(&corners) {
            return Err(MeshError::Crossing { first, second });
        }
        if polygon::signed_area(&corners) < 0.0 {
            corners.reverse();
        }
        let area = polygon::signed_area(&corners);
        let target = f64::from(self.resolution.count());
        // n points along the edge make at least n - 2 triangles. Refused here, before they fill the memory.
        let along = polygon::perimeter(&corners) / triangulate::edge_length(area / target);
        if along > target.min(MOST_ALONG) {
            let reason =
                format!("the outline is too long and thin: {along:.0} points would lie along it; make it wider");
            return Err(MeshError::Recipe(reason));
        }
        let (points, triangles) = triangulate::fill(target, area, &|edge| sampled(&corners, edge))?;
        let (points, triangles) = ordering::by_place(&points, &triangles);
        let mesh = Mesh::new(points, triangles)?;
        let angle = mesh.min_angle();
        if angle < triangulate::GOOD_ANGLE {
            let message = format!("the outline's sharp corners leave triangles with an angle of {angle:.1}°");
            return Ok(mesh.with_message(message));
        }
        Ok(mesh)
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.resolution]
    }
}

/// Points along the outline about one edge length [m] apart, its corners among them.
fn sampled(corners: &[[f64; 2]], edge: f64) -> Vec<[f64; 2]> {
    let count = corners.len();
    let mut kept: Vec<usize> = (0..count)
        .filter(|&index| {
            let ring = [corners[(index + count - 1) % count], corners[index], corners[(index + 1) % count]];
            is_corner(ring, edge)
        })
        .collect();
    if kept.is_empty() {
        kept.push(0);
    }
    // One or two corners alone must still bound an area.
    let least = 3_usize.div_ceil(kept.len());
    let mut points = Vec::new();
    for (index, &from) in kept.iter().enumerate() {
        let to = if index + 1 < kept.len() { kept[index + 1] } else { kept[0] + count };
        let run: Vec<_> = (from..=to).map(|corner| corners[corner % count]).collect();
        let length: f64 = run.windows(2).map(|pair| squared_distance(pair[0], pair[1]).sqrt()).sum();
        let pieces = ((length / edge).round() as usize).max(least);
        points.extend_from_slice(&polygon::spaced(&run, pieces + 1)[..pieces]);
    }
    points
}

/// Whether the outline turns sharply at the middle point, or a side there is longer than an edge.
fn is_corner([before, here, after]: [[f64; 2]; 3], edge: f64) -> bool {
    let (came, goes) = (squared_distance(before, here), squared_distance(here, after));
    let along = (here[0] - before[0]) * (after[0] - here[0]) + (here[1] - before[1]) * (after[1] - here[1]);
    came > edge * edge || goes > edge * edge || along < CORNER * (came * goes).sqrt()
}
