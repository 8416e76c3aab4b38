//! Conservative advancement: the safe fraction of a displacement before contact.
//!
//! The line across the segment between the nearest points separates the two shapes. Nothing can touch before one of
//! them crosses the line, so the motion up to there is safe; the method then repeats from there.

use parry2d::{
    math::Vector,
    query::{PointQuery, PointQueryWithLocation},
    shape::{Segment, SegmentPointLocation},
};

/// Most iterations for one displacement; stopping at any of them is safe. Straight sides need one or two, round ones a
/// few more.
const MOST: usize = 32;

/// Fraction t of the displacement at which the point `from + t displacement` comes within half an offset of all points
/// at `radius` from a segment, and the normal there; `None` if it does not.
pub fn point(side: &Segment, radius: f64, offset: f64, from: Vector, displacement: Vector) -> Option<(f64, Vector)> {
    let mut t = 0.0;
    let mut touch = None;
    for _ in 0..MOST {
        let at = from + displacement * t;
        let away = at - side.project_local_point(at, false).point;
        let normal = away.try_normalize()?;
        let gap = away.dot(normal) - radius - 0.5 * offset;
        let (ends, next) = ahead(gap, -displacement.dot(normal), offset, t)?;
        touch = Some((t, normal));
        if ends {
            break;
        }
        t = next;
    }
    touch
}

/// The same for an edge with moving ends that comes within half an offset of all points at `radius` from a point. The
/// normal points from the edge to the point.
pub fn edge(from: [Vector; 2], to: [Vector; 2], middle: Vector, radius: f64, offset: f64) -> Option<(f64, Vector)> {
    let displacement = [to[0] - from[0], to[1] - from[1]];
    let mut t = 0.0;
    let mut touch = None;
    for _ in 0..MOST {
        let at = [from[0] + displacement[0] * t, from[1] + displacement[1] * t];
        let normal = seen(at, middle)?.normal;
        // Both ends stay behind the separating line until the first of them reaches it.
        let next = |end: usize| {
            let gap = (middle - at[end]).dot(normal) - radius - 0.5 * offset;
            ahead(gap, displacement[end].dot(normal), offset, t)
        };
        let first = match (next(0), next(1)) {
            (Some(a), Some(b)) => Some(if a.1 < b.1 { a } else { b }),
            (a, b) => a.or(b),
        };
        let (ends, next) = first?;
        touch = Some((t, normal));
        if ends {
            break;
        }
        t = next;
    }
    touch
}

/// A point relative to the nearest point of an edge.
pub struct Seen {
    /// Unit vector to the point.
    pub normal: Vector,
    /// Distance \[m\].
    pub distance: f64,
    /// Position of the nearest point along the edge (0 to 1).
    pub along: f64,
}

/// Direction and distance from an edge to a point; `None` if the point is on the edge. Within the edge the direction is
/// the normal of the edge, which is exact at any distance.
pub fn seen(ends: [Vector; 2], point: Vector) -> Option<Seen> {
    let (projection, location) = Segment::new(ends[0], ends[1]).project_local_point_and_get_location(point, false);
    let from = |normal: Vector, along: f64, end: Vector| Seen { normal, distance: normal.dot(point - end), along };
    match location {
        SegmentPointLocation::OnVertex(end) => {
            let normal = (point - projection.point).try_normalize()?;
            Some(from(normal, f64::from(end), projection.point))
        }
        SegmentPointLocation::OnEdge(shares) => {
            let left = (ends[1] - ends[0]).perp().try_normalize()?;
            let side = left.dot(point - ends[0]);
            (side != 0.0).then(|| from(left * side.signum(), shares[1], ends[0]))
        }
    }
}

/// Whether the advancement ends here, within a tenth of an offset of the touch, and the next safe fraction; `None` if
/// the end of the displacement is safe.
fn ahead(gap: f64, approach: f64, offset: f64, t: f64) -> Option<(bool, f64)> {
    let next = t + gap.max(0.0) / approach;
    (approach > 0.0 && next < 1.0).then_some((gap <= 0.1 * offset, next))
}
