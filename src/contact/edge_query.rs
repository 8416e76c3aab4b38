//! A point near the boundary of a body: which edges and corners it touches, and how the gap depends on the vertices.

use super::{
    Curvature, Place, SurfaceEdge, SurfaceVertices,
    edge_meeting::nearest,
    stencil::Stencil,
    touch::{length, vector},
};

/// A point relative to an edge.
#[derive(Clone, Copy)]
pub(super) struct Seen {
    /// Position of the nearest point of the line along the edge: 0 to 1 within it.
    pub share: f64,
    /// Distance from the line, positive outside of the body \[m\].
    pub distance: f64,
    /// Unit vector from the first to the second end, and length of the edge \[m\].
    along: [f64; 2],
    length: f64,
}

impl Seen {
    pub fn new(x: &[f64], edge: &SurfaceEdge, [px, py]: [f64; 2]) -> Self {
        let [[ax, ay], [bx, by]] = edge.ends.map(|end| vector(x, end));
        let length = length([bx - ax, by - ay]);
        let [ex, ey] = [(bx - ax) / length, (by - ay) / length];
        let (px, py) = (px - ax, py - ay);
        Self { share: (px * ex + py * ey) / length, distance: px * ey - py * ex, along: [ex, ey], length }
    }

    /// Whether the nearest point is between the ends.
    pub fn is_within(&self) -> bool {
        self.share > 0.0 && self.share < 1.0
    }

    /// The outward unit normal.
    const fn normal(&self) -> [f64; 2] {
        let [ex, ey] = self.along;
        [ey, -ex]
    }
}

/// Depth at which a point inside another body still touches, as a fraction of the thickness of the skin.
pub(super) const DEPTH: f64 = 0.5;

/// A point that edges can touch: a vertex with a skin, or the centre of a round corner of an obstacle.
pub(super) struct EdgeQuery<'a> {
    pub surface: &'a SurfaceVertices,
    /// Positions of the vertices \[m\].
    pub x: &'a [f64],
    /// The point \[m\].
    pub point: [f64; 2],
    /// Distance from the point at which what it belongs to begins \[m\].
    pub radius: f64,
    /// Thickness of the skin \[m\].
    pub thickness: f64,
}

impl EdgeQuery<'_> {
    fn edge(&self, number: u32) -> &SurfaceEdge {
        &self.surface.edges()[number as usize]
    }

    /// The nearest of some edges.
    pub fn nearest(&self, edges: std::ops::Range<u32>) -> Option<u32> {
        let distance = |number: &u32| {
            let [a, b] = self.edge(*number).ends.map(|end| vector(self.x, end));
            nearest([self.point, a, b]).2
        };
        edges.min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }

    fn see(&self, number: u32) -> Seen {
        Seen::new(self.x, self.edge(number), self.point)
    }

    /// Calls `act` for what the point touches of an edge and of the corners at its ends.
    ///
    /// A point touches an edge that it is outside of and nearer to than the thickness of the skin, or the corner between two
    /// edges. Inside a body it touches the nearest edge, down to a depth \[m\] that `deepest` gives. `can_touch` tells which edges it
    /// may touch at all.
    pub fn each(
        &self,
        number: u32,
        can_touch: impl Fn(u32) -> bool,
        deepest: impl FnOnce() -> f64,
        act: &mut dyn FnMut(Stencil),
    ) {
        let (edge, seen) = (self.edge(number), self.see(number));
        let is_nearest = |other: u32| {
            let other = self.see(other);
            !other.is_within() || other.distance <= seen.distance
        };
        let is_inside = seen.distance <= 0.0;
        let acts = !is_inside || seen.distance > -deepest() && edge.neighbours.into_iter().all(is_nearest);
        if seen.is_within() && acts && seen.distance - self.radius < self.thickness {
            act(self.at_edge(number, &seen));
        }
        let [before, after] = edge.neighbours;
        for (end, other) in [(0, before), (1, after)] {
            let is_beyond = |seen: &Seen, end: usize| if end == 1 { seen.share >= 1.0 } else { seen.share <= 0.0 };
            let may_be_beyond = is_beyond(&seen, end) || seen.is_within() && seen.distance > 0.0;
            if !(may_be_beyond && self.is_near(edge.ends[end])) {
                continue;
            }
            if !can_touch(other) {
                if is_beyond(&seen, end) {
                    self.at_corner(number, (end, [seen.normal(); 2]), 1.0, act);
                }
                continue;
            }
            // Each of two edges has half of their corner, so that both turn with it.
            let next = self.see(other);
            if is_beyond(&seen, end) && is_beyond(&next, 1 - end) {
                self.at_corner(number, (end, [seen.normal(), next.normal()]), 0.5, act);
            } else if seen.is_within() && next.is_within() && seen.distance.min(next.distance) > 0.0 {
                self.at_corner(number, (end, [seen.normal(), next.normal()]), -0.5, act);
            }
        }
    }

    /// Whether the point may touch a corner.
    fn is_near(&self, corner: u32) -> bool {
        /// Far more than the round-off of a distance.
        const SLACK: f64 = 1.0 + 1e-9;
        let ([px, py], [cx, cy]) = (self.point, vector(self.x, corner));
        let (dx, dy, reach) = (px - cx, py - cy, SLACK * (self.thickness + self.radius));
        dx * dx + dy * dy < reach * reach
    }

    /// Contact with the edge that the point is inside of, at any depth.
    pub fn inside(&self, number: u32) -> Option<Stencil> {
        let seen = self.see(number);
        (seen.is_within() && seen.distance < 0.0).then(|| self.at_edge(number, &seen))
    }

    /// Contact with an edge between its ends.
    fn at_edge(&self, number: u32, seen: &Seen) -> Stencil {
        let edge = self.edge(number);
        let (t, [ex, ey], [nx, ny]) = (seen.share, seen.along, seen.normal());
        let weights = [1.0, t - 1.0, -t];
        // The slip is the length times the derivative of the share.
        let turn = seen.distance / seen.length;
        let slip = |w: f64, d: f64| [w * ex + d * turn * nx, w * ey + d * turn * ny];
        Stencil {
            weights,
            normal: [nx, ny],
            slips: [slip(1.0, 0.0), slip(weights[1], -1.0), slip(weights[2], 1.0)].map(|slip| [slip]),
            distance: seen.distance,
            curvature: Curvature::Edge(seen.length),
            place: Place::Loop {
                along: edge.arc[0] + t * edge.length,
                around: edge.arc[1],
                stretch: seen.length / edge.length,
            },
            radius: self.radius,
            share: 1.0,
            share_gradient: None,
        }
    }

    /// Calls `act` with the corner at an end of an edge, if the point is near it and outside of the edges with these normals.
    fn at_corner(&self, number: u32, (end, normals): (usize, [[f64; 2]; 2]), share: f64, act: &mut dyn FnMut(Stencil)) {
        let edge = self.edge(number);
        let ([px, py], [cx, cy]) = (self.point, vector(self.x, edge.ends[end]));
        let (dx, dy) = (px - cx, py - cy);
        let distance = length([dx, dy]);
        let outward = normals.iter().map(|[nx, ny]| nx * dx + ny * dy).sum::<f64>();
        let is_outside = outward > 0.0 || share < 0.0;
        if !(is_outside && distance > 0.0 && distance - self.radius < self.thickness) {
            return;
        }
        let [nx, ny] = [dx / distance, dy / distance];
        let along = [-ny, nx];
        // The edge turns with the corner, so that friction has no moment.
        let [ax, ay] = vector(self.x, edge.ends[0]);
        let [bx, by] = vector(self.x, edge.ends[1]);
        let square = (bx - ax) * (bx - ax) + (by - ay) * (by - ay);
        let turn = [distance * (by - ay) / square, distance * (ax - bx) / square];
        let mut slips = [along, [-turn[0], -turn[1]], turn];
        slips[1 + end][0] -= along[0];
        slips[1 + end][1] -= along[1];
        let mut weights = [1.0, 0.0, 0.0];
        weights[1 + end] = -1.0;
        act(Stencil {
            weights,
            normal: [nx, ny],
            slips: slips.map(|slip| [slip]),
            distance,
            curvature: Curvature::Points,
            place: Place::Loop { along: edge.arc[0] + end as f64 * edge.length, around: edge.arc[1], stretch: 1.0 },
            radius: self.radius,
            share,
            share_gradient: None,
        });
    }
}
