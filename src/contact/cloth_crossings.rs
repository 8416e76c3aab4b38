//! Certificate that cloth has not passed through itself or other cloth: an exact test, independent of how contact is computed.

use crate::obstacles::segments_meet;
use robust::{Coord3D, orient3d};

/// A point in space \[m\].
type Point = [f64; 3];

/// Triangles of cloth in space and their edges.
#[derive(Clone, Debug, Default)]
pub struct ClothSurface {
    triangles: Vec<[u32; 3]>,
    edges: Vec<[u32; 2]>,
}

impl ClothSurface {
    /// The surface of some triangles, by the numbers of their corners in the scene.
    pub fn new(triangles: Vec<[u32; 3]>) -> Self {
        let sides = |[a, b, c]: &[u32; 3]| [[*a, *b], [*b, *c], [*c, *a]];
        let mut edges: Vec<_> = triangles.iter().flat_map(sides).map(|[a, b]| [a.min(b), a.max(b)]).collect();
        edges.sort_unstable();
        edges.dedup();
        Self { triangles, edges }
    }

    /// Number of triangles.
    pub const fn count(&self) -> usize {
        self.triangles.len()
    }

    /// Number of pairs of an edge and a triangle that meet at positions x \[m\], without those that share a vertex. Zero is a proof,
    /// because the test of each pair is exact. Positions that are not finite count as one.
    pub fn count_crossings(&self, x: &[f64]) -> usize {
        self.count_between(x, |_| true)
    }

    /// The same of pairs with a vertex of each that `may_touch` tells of.
    pub fn count_between(&self, x: &[f64], may_touch: impl Fn([u32; 2]) -> bool) -> usize {
        let points: &[Point] = x.as_chunks().0;
        let used = self.triangles.as_flattened().iter().map(|vertex| points[*vertex as usize]);
        if !used.clone().flatten().all(f64::is_finite) {
            return 1;
        }
        // Along the axis of the greatest extent, edges are sorted by their lower ends.
        let extent = |axis: usize| {
            let along = used.clone().map(|point| point[axis]);
            along.clone().fold(f64::NEG_INFINITY, f64::max) - along.fold(f64::INFINITY, f64::min)
        };
        let axis = [0, 1, 2].into_iter().max_by(|a, b| extent(*a).total_cmp(&extent(*b))).unwrap_or(0);
        let mut edges: Vec<_> = self.edges.iter().map(|edge| (edge, edge.map(|end| points[end as usize]))).collect();
        let low = |ends: &[Point; 2]| ends[0][axis].min(ends[1][axis]);
        edges.sort_unstable_by(|(one, a), (other, b)| low(a).total_cmp(&low(b)).then(one.cmp(other)));
        let longest = edges.iter().map(|(_, [a, b])| (a[axis] - b[axis]).abs()).fold(0.0, f64::max);
        let mut count = 0;
        for triangle in &self.triangles {
            let corners = triangle.map(|corner| points[corner as usize]);
            let [least, greatest] = bounds(&corners);
            let first = edges.partition_point(|(_, ends)| low(ends) < least[axis] - longest);
            let near = edges[first..].iter().take_while(|(_, ends)| low(ends) <= greatest[axis]);
            let meets = |(edge, ends): &&(&[u32; 2], [Point; 2])| {
                let [low, high] = bounds(ends);
                let overlaps = (0..3).all(|axis| low[axis] <= greatest[axis] && least[axis] <= high[axis]);
                let is_free = may_touch([edge[0], triangle[0]]) && !edge.iter().any(|end| triangle.contains(end));
                overlaps && is_free && segment_meets_triangle(*ends, corners)
            };
            count += near.filter(meets).count();
        }
        count
    }
}

/// Least and greatest corner of the box around some points.
fn bounds(points: &[Point]) -> [Point; 2] {
    let along = |axis: usize| points.iter().map(move |point| point[axis]);
    [
        [0, 1, 2].map(|axis| along(axis).fold(f64::INFINITY, f64::min)),
        [0, 1, 2].map(|axis| along(axis).fold(f64::NEG_INFINITY, f64::max)),
    ]
}

/// Whether a segment and a triangle have a point in common, exactly (Shewchuk, *Adaptive Precision Floating-Point Arithmetic and Fast Robust
/// Geometric Predicates*, Discrete & Computational Geometry 18, 1997).
pub fn segment_meets_triangle([p, q]: [Point; 2], [a, b, c]: [Point; 3]) -> bool {
    let (above, below) = (side(a, b, c, p), side(a, b, c, q));
    if above > 0.0 && below > 0.0 || above < 0.0 && below < 0.0 {
        return false;
    }
    if above == 0.0 && below == 0.0 {
        return meets_in_plane([p, q], [a, b, c]);
    }
    // The line passes all three sides of the triangle in one direction.
    let sides = [side(p, q, a, b), side(p, q, b, c), side(p, q, c, a)];
    sides.iter().all(|side| *side >= 0.0) || sides.iter().all(|side| *side <= 0.0)
}

/// The same for a segment in the plane of the triangle, or a triangle without area: seen along the axis that is nearest to the normal.
fn meets_in_plane(segment: [Point; 2], [a, b, c]: [Point; 3]) -> bool {
    let edge = |from: Point, to: Point| [0, 1, 2].map(|axis| to[axis] - from[axis]);
    let (one, two) = (edge(a, b), edge(a, c));
    let normal = [0, 1, 2].map(|axis| {
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        (one[i] * two[j] - one[j] * two[i]).abs()
    });
    let axis = [0, 1, 2].into_iter().max_by(|a, b| normal[*a].total_cmp(&normal[*b])).unwrap_or(0);
    let flat = |point: Point| [point[(axis + 1) % 3], point[(axis + 2) % 3]];
    let [a, b, c] = [a, b, c].map(flat);
    let segment = segment.map(flat);
    let is_inside = |point: [f64; 2]| {
        let sides = [[a, b], [b, c], [c, a]].map(|line| crate::obstacles::side_of(line, point));
        sides.iter().all(|side| *side > 0.0) || sides.iter().all(|side| *side < 0.0)
    };
    [[a, b], [b, c], [c, a]].iter().any(|side| segments_meet(*side, segment)) || is_inside(segment[0])
}

/// Positive if d is below the plane through a, b and c, which are counter-clockwise seen from above: the sign is exact.
fn side(a: Point, b: Point, c: Point, d: Point) -> f64 {
    let [a, b, c, d] = [a, b, c, d].map(|[x, y, z]| Coord3D { x, y, z });
    orient3d(a, b, c, d)
}
