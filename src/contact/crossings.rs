//! Certificate that nothing has crossed: an exact test, independent of how contact is computed.

use super::{SurfaceVertices, touch::pair};
use robust::{Coord, orient2d};

/// Number of pairs of boundary edges that cross or touch each other at positions x \[m\], without those that share a vertex, and of
/// particles of nets inside bodies. Zero is a proof: the predicates are exact (Shewchuk, *Adaptive Precision Floating-Point
/// Arithmetic and Fast Robust Geometric Predicates*, Discrete & Computational Geometry 18, 1997). Positions that are not finite count
/// as one.
pub fn count_crossings(surface: &SurfaceVertices, x: &[f64]) -> usize {
    let at = |vertex: u32| {
        let [x, y] = pair(x, vertex);
        Coord { x, y }
    };
    if !surface.iter().all(|vertex| pair(x, vertex.vertex).iter().all(|number| number.is_finite())) {
        return 1;
    }
    // Sorted by their left ends, so that only edges that overlap along x are compared.
    let mut edges: Vec<_> = surface.edges().iter().map(|edge| (edge.ends, edge.ends.map(at))).collect();
    let extent = |[a, b]: [Coord<f64>; 2], axis: fn(Coord<f64>) -> f64| {
        let [a, b] = [a, b].map(axis);
        [a.min(b), a.max(b)]
    };
    let along = |coord: Coord<f64>| coord.x;
    let across = |coord: Coord<f64>| coord.y;
    edges.sort_unstable_by(|(_, a), (_, b)| extent(*a, along)[0].total_cmp(&extent(*b, along)[0]));
    let mut count = 0;
    for (number, (names, one)) in edges.iter().enumerate() {
        let ([_, right], [bottom, top]) = (extent(*one, along), extent(*one, across));
        for (others, other) in edges[number + 1..].iter().take_while(|(_, other)| extent(*other, along)[0] <= right) {
            let [low, high] = extent(*other, across);
            let apart = low > top || high < bottom || names.iter().any(|name| others.contains(name));
            count += usize::from(!apart && cross(*one, *other));
        }
    }
    count
        + surface.iter().filter(|vertex| !surface.is_body(vertex.part) && is_inside(&edges, at(vertex.vertex))).count()
}

/// Side of a point from the line through an edge: the sign is exact.
fn side([a, b]: [Coord<f64>; 2], point: Coord<f64>) -> f64 {
    orient2d(a, b, point)
}

/// Whether two segments have a point in common, if their boxes have.
fn cross(one: [Coord<f64>; 2], other: [Coord<f64>; 2]) -> bool {
    let splits = |line: [Coord<f64>; 2], [a, b]: [Coord<f64>; 2]| {
        let (a, b) = (side(line, a), side(line, b));
        !(a > 0.0 && b > 0.0 || a < 0.0 && b < 0.0)
    };
    splits(one, other) && splits(other, one)
}

/// Whether a point is inside the boundary: a ray to the right crosses it an odd number of times.
fn is_inside(edges: &[([u32; 2], [Coord<f64>; 2])], point: Coord<f64>) -> bool {
    let crossed = edges.iter().filter(|(_, [a, b])| {
        let upwards = a.y <= point.y && b.y > point.y;
        let downwards = b.y <= point.y && a.y > point.y;
        upwards && side([*a, *b], point) > 0.0 || downwards && side([*a, *b], point) < 0.0
    });
    crossed.count() % 2 == 1
}
