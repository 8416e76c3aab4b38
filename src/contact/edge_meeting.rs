//! Vertices and edges in the plane that meet in a step.

use super::{
    Pair, SurfaceContact, SurfaceVertices,
    edge_query::Seen,
    touch::length,
    truncation::{MeetingPairs, Nearest, advance},
};

/// A vertex and the ends of an edge at one moment.
pub(super) type Points = [[f64; 2]; 3];

/// Unit vector from the nearest point of an edge to a vertex, the position of that point along the edge, and the distance \[m\].
pub(super) fn nearest([p, a, b]: Points) -> ([f64; 2], f64, f64) {
    let ([ex, ey], [px, py]) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let square = ex * ex + ey * ey;
    let t = if square > 0.0 { ((px * ex + py * ey) / square).clamp(0.0, 1.0) } else { 0.0 };
    let (dx, dy) = (px - t * ex, py - t * ey);
    let distance = length([dx, dy]);
    if t > 0.0 && t < 1.0 {
        // Exact at any distance.
        let length = square.sqrt();
        let side = if px * ey - py * ex < 0.0 { -1.0 } else { 1.0 };
        return ([side * ey / length, -side * ex / length], t, distance);
    }
    ([dx / distance, dy / distance], t, distance)
}

/// Fraction of the displacement at which a vertex and an edge come within a radius and a distance; see [`advance`].
pub(super) fn meeting(from: Points, to: Points, radius: f64, distance: f64) -> Option<f64> {
    advance((from, to), 1, [radius, distance], |at| {
        let (normal, _, gap) = nearest(at);
        (normal, gap)
    })
}

impl MeetingPairs<2, 3> for SurfaceContact {
    type All = SurfaceVertices;

    fn surfaces(&self) -> &SurfaceVertices {
        self.surface()
    }

    fn near(&self) -> f64 {
        self.reach()
    }

    fn parts(&self, pair: Pair) -> [u32; 2] {
        let (edge, vertex) = self.members(pair);
        [edge.part, vertex.part]
    }

    fn are_apart(&self, [one, other]: [u32; 2]) -> bool {
        !self.between(one, other).touch()
    }

    fn can_touch(&self, pair: Pair) -> bool {
        let (edge, vertex) = self.members(pair);
        let touch = self.between(edge.part, vertex.part).touch();
        if edge.part != vertex.part {
            return touch;
        }
        !edge.ends.contains(&vertex.vertex) && touch && !self.excluded(pair[0]).contains(&pair)
    }

    fn thickness(&self, pair: Pair) -> f64 {
        let [one, other] = self.parts(pair);
        self.between(one, other).potential.thickness
    }

    fn vertices(&self, pair: Pair) -> [usize; 3] {
        let (edge, vertex) = self.members(pair);
        [vertex.vertex, edge.ends[0], edge.ends[1]].map(|vertex| vertex as usize)
    }

    fn first(&self, _: Pair) -> usize {
        1
    }

    fn nearest(&self, _: Pair, points: Points) -> Nearest<2, 3> {
        let (normal, t, distance) = nearest(points);
        Nearest { normal, weights: [1.0, t - 1.0, -t], distance }
    }

    /// A vertex inside another body may leave that: where bodies do not cross themselves, it began there. One that begins exactly
    /// on an edge meets it only on its way to the inner side.
    fn meeting(&self, start: &[f64], x: &[f64], pair: Pair) -> Option<f64> {
        if self.is_far(start, x, pair) {
            return None;
        }
        let (from, to) = (self.points(start, pair), self.points(x, pair));
        if nearest(from).2 == 0.0 {
            let ends = Seen::new(x, self.members(pair).0, to[0]);
            return (ends.is_within() && ends.distance < 0.0).then_some(0.0);
        }
        let share = self.advanced(start, x, pair)?;
        (self.is_outside(start, pair) || !self.is_inside(start, pair)).then_some(share)
    }
}
