use super::{
    DepenetrationStep, Inside, Start, Surface, SweptMotion,
    advance::{self, Seen},
};
use parry2d::math::Vector;

/// A convex corner of an obstacle, round or sharp: it can touch an edge of a body between two vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// Centre of its rounding \[m\].
    pub middle: [f64; 2],
    /// Radius of its rounding \[m\].
    pub radius: f64,
    /// Contact margin \[m\].
    pub margin: f64,
    /// Contact offset \[m\].
    pub offset: f64,
}

impl Corner {
    /// Whether a box is within its contact margin.
    fn is_near(&self, [least, greatest]: [Vector; 2]) -> bool {
        let (middle, margin) = (Vector::from(self.middle), Vector::splat(self.radius + self.margin));
        middle.cmpge(least - margin).all() && middle.cmple(greatest + margin).all()
    }
}

/// A boundary edge of a body in a step, with the body on its left.
struct Edge<'a> {
    start: &'a Start<'a>,
    /// Motion of the corner.
    swept_motion: &'a SweptMotion,
    vertices: [usize; 2],
    /// The ends at the start of the step, mapped to its end with the motion of the corner.
    from: [Vector; 2],
    to: [Vector; 2],
}

fn at(values: &[f64], vertex: usize) -> Vector {
    Vector::new(values[2 * vertex], values[2 * vertex + 1])
}

fn put(values: &mut [f64], vertex: usize, value: Vector) {
    values[2 * vertex] = value.x;
    values[2 * vertex + 1] = value.y;
}

impl<'a> Edge<'a> {
    fn new((start, swept_motion): (&'a Start<'a>, &'a SweptMotion), edge: [u32; 2], x: &[f64]) -> Self {
        let vertices = edge.map(|vertex| vertex as usize);
        Self {
            start,
            swept_motion,
            vertices,
            from: vertices.map(|vertex| swept_motion.place(at(start.x, vertex).into()).into()),
            to: vertices.map(|vertex| at(x, vertex)),
        }
    }

    /// Whether the box around the swept edge is within the contact margin of a corner.
    fn is_near(&self, corner: &Corner) -> bool {
        let least = self.from[0].min(self.from[1]).min(self.to[0].min(self.to[1]));
        let greatest = self.from[0].max(self.from[1]).max(self.to[0].max(self.to[1]));
        corner.is_near([least, greatest])
    }

    /// Value at the position `along` the edge, interpolated between its ends.
    fn mean(&self, values: &[f64], along: f64) -> Vector {
        at(values, self.vertices[0]) * (1.0 - along) + at(values, self.vertices[1]) * along
    }

    /// Whether a corner in this direction may enter the body, because depenetration moves the body past it.
    fn lets_in(&self, normal: Vector) -> bool {
        self.start.penetration(self.vertices[0]).is_some_and(|penetration| penetration.lets_in((-normal).into()))
    }

    /// Mobility of that point along a direction: its velocity change per unit impulse [1/kg].
    fn mobility(&self, along: f64, direction: Vector) -> f64 {
        let shares = [1.0 - along, along];
        let of = |end: usize| (at(self.start.inverse_mass, self.vertices[end]) * direction * direction).element_sum();
        shares[0] * shares[0] * of(0) + shares[1] * shares[1] * of(1)
    }

    /// Moves that point along a direction, distributed on both ends like an impulse at the point.
    fn shift(&self, values: &mut [f64], along: f64, direction: Vector, by: f64) {
        let mobility = self.mobility(along, direction);
        if by == 0.0 || mobility == 0.0 {
            return;
        }
        for (vertex, share) in self.vertices.into_iter().zip([1.0 - along, along]) {
            let moved = at(self.start.inverse_mass, vertex) * direction * (share * by / mobility);
            put(values, vertex, at(values, vertex) + moved);
        }
    }

    /// Removes the velocity of that point towards a corner, with friction and restitution; returns the fraction of
    /// tangential velocity that is left.
    fn impact_response(
        &self,
        corner: &Corner,
        v: &mut [f64],
        (along, normal): (f64, Vector),
        step: Option<DepenetrationStep>,
    ) -> Option<f64> {
        let wall = Vector::from(self.swept_motion.velocity_at(corner.middle));
        let wall = step.map_or(wall, |step| wall - normal * step.speed);
        let free = self.mean(v, along) - wall;
        let (start_x, start_v) = (self.mean(self.start.x, along), self.mean(self.start.v, along));
        let before = self.swept_motion.relative(start_v.into(), start_x.into());
        let mut after: [f64; 2] = free.into();
        let surface = self.start.surface_at(self.vertices[0]);
        let surface = if step.is_some() { Surface { restitution: 0.0, ..surface } } else { surface };
        let kept = surface.impact_response((-normal).into(), before, &mut after)?;
        let change = Vector::from(after) - free;
        let tangent = normal.perp();
        let ends = self.vertices.map(|vertex| at(v, vertex));
        self.shift(v, along, normal, change.dot(normal));
        self.shift(v, along, tangent, change.dot(tangent));
        if wall != Vector::ZERO {
            for (vertex, end) in self.vertices.into_iter().zip(ends) {
                let (change, inverse) = (at(v, vertex) - end, at(self.start.inverse_mass, vertex));
                let impulse = |change: f64, inverse: f64| if inverse == 0.0 { 0.0 } else { change / inverse };
                self.start.supply(impulse(change.x, inverse.x) * wall.x + impulse(change.y, inverse.y) * wall.y);
            }
        }
        Some(kept)
    }

    /// Depenetration step of the edge, if that point of it begins inside the rounding of a corner, by a negative gap
    /// \[m\].
    fn depenetration_step(
        &self,
        corner: &Corner,
        (along, normal): (f64, Vector),
        gap: f64,
    ) -> Option<DepenetrationStep> {
        let (x, v) = (self.mean(self.start.x, along), self.mean(self.start.v, along));
        let outwards = -Vector::from(self.swept_motion.relative(v.into(), x.into())).dot(normal);
        self.start.depenetration_step(self.vertices[0], gap, outwards, corner.offset)
    }

    /// Resolves contact with a corner within the contact margin at the start of the step.
    fn press(&self, corner: &Corner, x: &mut [f64], v: &mut [f64]) -> bool {
        let Some(Seen { normal, distance, along }) = advance::seen(self.from, Vector::from(corner.middle)) else {
            return false;
        };
        let gap = distance - corner.radius;
        // The ends are vertices, which the obstacle constrains itself.
        if gap >= corner.margin || along <= 0.0 || along >= 1.0 || self.lets_in(normal) {
            return false;
        }
        let step = self.depenetration_step(corner, (along, normal), gap);
        if step.is_some_and(|step| step.speed == 0.0) && !self.swept_motion.is_still() {
            return false;
        }
        let moves = step.is_some() && self.mobility(along, normal) > 0.0;
        if moves {
            let stays = step.is_some_and(|step| step.speed == 0.0);
            self.start.record_inside(if stays { Inside::Stays } else { Inside::ComesOut });
        }
        let kept = self.impact_response(corner, v, (along, normal), step);
        let displacement = self.mean(x, along) - (self.from[0] * (1.0 - along) + self.from[1] * along);
        let least = step.map_or((corner.offset - gap).max(0.0), |step| step.length);
        let excess = displacement.dot(normal) + least;
        if let Some(kept) = kept {
            let tangent = normal.perp();
            self.shift(x, along, tangent, (kept - 1.0) * displacement.dot(tangent));
        }
        self.shift(x, along, normal, -excess.max(0.0));
        kept.is_some() || excess > 0.0
    }

    /// Stops the edge at the first touch of a corner within the step.
    fn stop(&self, corner: &Corner, x: &mut [f64], v: &mut [f64]) -> bool {
        let middle = Vector::from(corner.middle);
        let Some((share, normal)) = advance::edge(self.from, self.to, middle, corner.radius, corner.offset) else {
            return false;
        };
        // An edge in depenetration continues from its start.
        let comes_out = || {
            let seen = advance::seen(self.from, middle);
            seen.is_some_and(|seen| {
                self.depenetration_step(corner, (seen.along, seen.normal), seen.distance - corner.radius).is_some()
            })
        };
        if self.lets_in(normal) || (share == 0.0 && comes_out()) {
            return false;
        }
        let reached = [0, 1].map(|end| self.from[end] + (self.to[end] - self.from[end]) * share);
        if let Some(Seen { along, .. }) = advance::seen(reached, middle) {
            self.impact_response(corner, v, (along, normal), None);
        }
        for (vertex, reached) in self.vertices.into_iter().zip(reached) {
            // A constrained coordinate keeps its value, also when a corner moves to it.
            let free = at(self.start.inverse_mass, vertex).cmpne(Vector::ZERO);
            put(x, vertex, Vector::select(free, reached, at(x, vertex)));
            if share == 0.0 {
                // An edge that cannot move within the step takes the velocity of the corner.
                let wall = Vector::from(self.swept_motion.velocity_at(reached.into()));
                put(v, vertex, Vector::select(free, wall, at(v, vertex)));
            }
        }
        true
    }
}

/// The corners of an obstacle and their motion, the edges of bodies, and the least and greatest corner of the box
/// around the swept edges.
pub type Bodies<'a> = (&'a [Corner], &'a SweptMotion, &'a [[u32; 2]], [[f64; 2]; 2]);

/// Calls `visit` for every edge and every corner near the swept edge; returns the number of edges changed.
fn each<'a>(
    (corners, swept_motion, edges, bounds): Bodies<'a>,
    start: &'a Start<'a>,
    x: &mut [f64],
    v: &mut [f64],
    visit: impl Fn(&Edge<'a>, &Corner, &mut [f64], &mut [f64]) -> bool,
) -> usize {
    let mut touched = 0;
    let corners = corners.iter().map(|corner| swept_motion.corner(corner));
    for corner in corners.filter(|corner| corner.is_near(bounds.map(Vector::from))) {
        let mut free = None;
        let is_free = || !is_inside(swept_motion.place_back(corner.middle), edges, start.x);
        for &vertices in edges {
            let edge = Edge::new((start, swept_motion), vertices, x);
            if edge.is_near(&corner) && *free.get_or_insert_with(is_free) {
                touched += usize::from(visit(&edge, &corner, x, v));
            }
        }
    }
    touched
}

/// Whether a point is inside the bodies with these edges, by the parity of the crossings of a ray, for either
/// orientation. A body that begins over a corner may leave it.
fn is_inside([px, py]: [f64; 2], edges: &[[u32; 2]], x: &[f64]) -> bool {
    let crosses = |edge: &&[u32; 2]| {
        let [a, b] = edge.map(|vertex| at(x, vertex as usize));
        (a.y > py) != (b.y > py) && px < a.x + (py - a.y) / (b.y - a.y) * (b.x - a.x)
    };
    edges.iter().filter(crosses).count() % 2 == 1
}

/// Applies contact between corners and edges within the contact margin: an impulse on both ends, distributed by their
/// masses, removes the approach velocity and displacement of the nearest point. Returns the number of edges changed.
pub fn press_edges<'a>(bodies: Bodies<'a>, start: &'a Start<'a>, x: &mut [f64], v: &mut [f64]) -> usize {
    each(bodies, start, x, v, Edge::press)
}

/// Stops edges at the first touch of a corner and removes the approach velocity. Returns the number of edges changed;
/// edges share vertices, so that another pass may find more.
pub fn stop_edges<'a>(bodies: Bodies<'a>, start: &'a Start<'a>, x: &mut [f64], v: &mut [f64]) -> usize {
    each(bodies, start, x, v, Edge::stop)
}
