//! Nearest points of points, segments and triangles in space.

use super::{candidates::minus, touch::dot};

/// A point or vector in space.
pub(super) type Point = [f64; 3];

/// Part of a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Feature {
    /// Its interior.
    Face,
    /// The side from this corner to the next.
    Side(usize),
    /// A corner.
    Corner(usize),
}

/// Nearest point of a triangle: the part that it is on, and its barycentric coordinates (Ericson, *Real-Time Collision
/// Detection*, 2004, section 5.1.5).
pub(super) fn nearest_of_triangle(p: Point, [a, b, c]: [Point; 3]) -> (Feature, [f64; 3]) {
    let (ab, ac, ap) = (minus(b, a), minus(c, a), minus(p, a));
    let (d1, d2) = (dot(ab, ap), dot(ac, ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return (Feature::Corner(0), [1.0, 0.0, 0.0]);
    }
    let bp = minus(p, b);
    let (d3, d4) = (dot(ab, bp), dot(ac, bp));
    if d3 >= 0.0 && d4 <= d3 {
        return (Feature::Corner(1), [0.0, 1.0, 0.0]);
    }
    let of_c = d1 * d4 - d3 * d2;
    if of_c <= 0.0 && d1 >= 0.0 && d3 <= 0.0 && d1 > d3 {
        let t = d1 / (d1 - d3);
        return (Feature::Side(0), [1.0 - t, t, 0.0]);
    }
    let cp = minus(p, c);
    let (d5, d6) = (dot(ab, cp), dot(ac, cp));
    if d6 >= 0.0 && d5 <= d6 {
        return (Feature::Corner(2), [0.0, 0.0, 1.0]);
    }
    let of_b = d5 * d2 - d1 * d6;
    if of_b <= 0.0 && d2 >= 0.0 && d6 <= 0.0 && d2 > d6 {
        let t = d2 / (d2 - d6);
        return (Feature::Side(2), [1.0 - t, 0.0, t]);
    }
    let of_a = d3 * d6 - d5 * d4;
    if of_a <= 0.0 && d4 >= d3 && d5 >= d6 {
        let t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return (Feature::Side(1), [0.0, 1.0 - t, t]);
    }
    let sum = of_a + of_b + of_c;
    (Feature::Face, [of_a / sum, of_b / sum, of_c / sum])
}

/// Position along a segment from 0 to 1 of its nearest point to a point.
pub(super) fn nearest_of_segment(p: Point, [a, b]: [Point; 2]) -> f64 {
    let along = minus(b, a);
    let square = dot(along, along);
    if square > 0.0 { (dot(minus(p, a), along) / square).clamp(0.0, 1.0) } else { 0.0 }
}

/// Positions along two segments from 0 to 1 of their nearest points (Ericson, section 5.1.9).
pub(super) fn nearest_of_segments(one: [Point; 2], other: [Point; 2]) -> [f64; 2] {
    let (u, w, r) = (minus(one[1], one[0]), minus(other[1], other[0]), minus(one[0], other[0]));
    let (a, b, e) = (dot(u, u), dot(u, w), dot(w, w));
    let (c, f, between) = (dot(u, r), dot(w, r), a * e - b * b);
    // The nearest point of the line of the first one; any where they are parallel.
    let s = if between > 0.0 { ((b * f - c * e) / between).clamp(0.0, 1.0) } else { 0.0 };
    if e == 0.0 {
        return [nearest_of_segment(other[0], one), 0.0];
    }
    let t = (b * s + f) / e;
    if (0.0..=1.0).contains(&t) {
        return [s, t];
    }
    let t = t.clamp(0.0, 1.0);
    let end = if t > 0.0 { other[1] } else { other[0] };
    [nearest_of_segment(end, one), t]
}

/// Point of a segment.
pub(super) fn along([a, b]: [Point; 2], t: f64) -> Point {
    std::array::from_fn(|axis| a[axis] + t * (b[axis] - a[axis]))
}

/// Vector product.
pub(super) const fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// A vector of length one in the direction of another, and the length of that; zero where it has none.
pub(super) fn direction(vector: Point) -> (Point, f64) {
    let length = dot(vector, vector).sqrt();
    let scale = if length > 0.0 { 1.0 / length } else { 0.0 };
    (vector.map(|number| number * scale), length)
}
