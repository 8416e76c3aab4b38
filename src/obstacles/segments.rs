//! Exact test of two segments.

use robust::{Coord, orient2d};

/// Whether two segments have a point in common, exactly (Shewchuk, *Adaptive Precision Floating-Point Arithmetic and Fast Robust
/// Geometric Predicates*, Discrete & Computational Geometry 18, 1997).
pub fn segments_meet(one: [[f64; 2]; 2], other: [[f64; 2]; 2]) -> bool {
    let apart = |axis: usize| {
        let extent = |[a, b]: [[f64; 2]; 2]| (a[axis].min(b[axis]), a[axis].max(b[axis]));
        let ((low, high), (least, greatest)) = (extent(one), extent(other));
        high < least || greatest < low
    };
    let splits = |line: [[f64; 2]; 2], [a, b]: [[f64; 2]; 2]| {
        let (a, b) = (side_of(line, a), side_of(line, b));
        !(a > 0.0 && b > 0.0 || a < 0.0 && b < 0.0)
    };
    // Where all points are on one line, they meet if their boxes do.
    !apart(0) && !apart(1) && splits(one, other) && splits(other, one)
}

/// Whether each of two segments has the ends of the other on both sides, exactly: they cross and do not merely touch.
pub fn segments_cross(one: [[f64; 2]; 2], other: [[f64; 2]; 2]) -> bool {
    let splits = |line: [[f64; 2]; 2], [a, b]: [[f64; 2]; 2]| {
        let (a, b) = (side_of(line, a), side_of(line, b));
        a > 0.0 && b < 0.0 || a < 0.0 && b > 0.0
    };
    splits(one, other) && splits(other, one)
}

/// Positive if a point is on the left of the line through two points, negative on the right, zero on it: the sign is exact.
pub fn side_of([a, b]: [[f64; 2]; 2], point: [f64; 2]) -> f64 {
    let [a, b, point] = [a, b, point].map(|[x, y]| Coord { x, y });
    orient2d(a, b, point)
}
