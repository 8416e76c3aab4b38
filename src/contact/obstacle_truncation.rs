//! Truncation of steps at obstacles: where the skin is used up, displacements and velocities are changed so that no vertex enters
//! an obstacle, and no edge passes over one of its corners.
//!
//! All motion is seen in the frame of the obstacle at the end of the step: points at its start are mapped there as if attached to
//! it, so that nothing passes through at any speed of either. An inelastic impulse along the normal takes away the approach: that
//! of the obstacle on one vertex, or of a corner on both ends of an edge. Where that does not suffice in a few rounds, because
//! several obstacles act on connected edges, vertices stay where they began, attached to the obstacle.

use super::{
    Anchor, ObstacleContact, SurfaceEdge, SurfaceVertex,
    friction::{anchor_of, penetration_of},
    touch::{length, vector},
    truncation::{ADVANCES, Clearance, FLOOR, meeting, nearest},
};
use crate::{
    effects::Bounds,
    obstacles::{Contact, Corner, Obstacle, SweptMotion},
};

/// Rounds of impulses.
const ROUNDS: usize = 8;
/// Displacement below which only vertices and edges in contact at the start can meet an obstacle, as a fraction of the thickness
/// of the skin.
const SHORT: f64 = 0.9;

/// Displacements of all vertices in a step, flat.
#[derive(Clone, Copy)]
pub struct Path<'a> {
    /// Times of the start and the end \[s\].
    pub time: [f64; 2],
    /// Positions at the start \[m\].
    pub start: &'a [f64],
    /// Positions at the end \[m\].
    pub end: &'a [f64],
    /// Contacts at the start, if they are known.
    pub anchors: Option<&'a [Anchor]>,
}

impl<'a> Path<'a> {
    fn known(&self) -> &'a [Anchor] {
        self.anchors.unwrap_or_default()
    }
}

/// A step to truncate, flat.
pub struct TruncatedStep<'a> {
    /// Times of its start and its end \[s\].
    pub time: [f64; 2],
    /// Positions at the start \[m\].
    pub start: &'a [f64],
    /// 1/mass [1/kg].
    pub inverse_mass: &'a [f64],
    /// Contacts at the start.
    pub anchors: &'a [Anchor],
    /// Positions at the end \[m\].
    pub x: &'a mut [f64],
    /// Velocities at the end [m/s].
    pub v: &'a mut [f64],
    /// Vertices that were moved.
    pub moved: &'a mut Vec<usize>,
    /// Scratch.
    pub found: &'a mut Vec<Candidate>,
    /// Work of moving obstacles by impulses \[J\].
    pub supplied: f64,
    /// Whether a moving obstacle moved a vertex, which may do more work.
    pub is_pushed: bool,
}

/// A vertex, or an edge and the number of a corner of an obstacle.
#[derive(Clone, Copy, Debug)]
pub enum Candidate {
    /// A vertex.
    Vertex(SurfaceVertex),
    /// An edge and a corner.
    Edge(u32, usize),
}

/// A vertex or an edge that meets an obstacle, as a stencil with weights.
struct Met {
    vertices: [usize; 2],
    weights: [f64; 2],
    /// Unit normal from the obstacle.
    normal: [f64; 2],
    /// Displacement along it that is missing at the end \[m\].
    missing: f64,
    /// Velocity of the obstacle there [m/s].
    wall: [f64; 2],
    /// Fraction of the displacement until it meets.
    share: f64,
}

impl TruncatedStep<'_> {
    fn path(&self) -> Path<'_> {
        Path { time: self.time, start: self.start, end: self.x, anchors: Some(self.anchors) }
    }

    /// Takes away the approach of positions and velocities by an impulse in proportion to the inverse masses.
    fn push(&mut self, met: &Met) {
        let Met { vertices, weights, normal: [nx, ny], missing, wall, .. } = met;
        let all = || vertices.iter().zip(weights).filter(|(_, weight)| **weight != 0.0);
        let inverse = |at: usize| nx * nx * self.inverse_mass[at] + ny * ny * self.inverse_mass[at + 1];
        let mobility: f64 = all().map(|(vertex, w)| w * w * inverse(2 * vertex)).sum();
        let along: f64 = all().map(|(vertex, w)| w * (nx * self.v[2 * vertex] + ny * self.v[2 * vertex + 1])).sum();
        let wall = nx * wall[0] + ny * wall[1];
        let approach = (wall - along).max(0.0);
        if mobility <= 0.0 {
            return;
        }
        self.supplied += (approach / mobility * wall).max(0.0);
        for (values, wanted) in [(&mut *self.x, missing.max(0.0)), (&mut *self.v, approach)] {
            for (vertex, w) in all() {
                let change = w * wanted / mobility;
                values[2 * vertex] += change * nx * self.inverse_mass[2 * vertex];
                values[2 * vertex + 1] += change * ny * self.inverse_mass[2 * vertex + 1];
            }
        }
        self.moved.extend(all().map(|(vertex, _)| *vertex));
    }

    /// Puts vertices back to their start, attached to the obstacle.
    fn put_back(&mut self, met: &Met, motion: &SweptMotion) {
        for (vertex, _) in met.vertices.iter().zip(met.weights).filter(|(_, weight)| *weight != 0.0) {
            let from = motion.place(vector(self.start, *vertex as u32));
            let wall = motion.velocity_at(from);
            for axis in 0..2 {
                let (number, inverse) = (2 * vertex + axis, self.inverse_mass[2 * vertex + axis]);
                if inverse != 0.0 {
                    self.supplied += ((wall[axis] - self.v[number]) / inverse * wall[axis]).max(0.0);
                    (self.x[number], self.v[number]) = (from[axis], wall[axis]);
                }
            }
            self.moved.push(*vertex);
        }
    }
}

impl ObstacleContact {
    /// Truncates a step; returns the number of vertices and edges that met an obstacle.
    pub fn truncate(&self, step: &mut TruncatedStep<'_>) -> usize {
        let (mut all, mut found) = (0, std::mem::take(step.found));
        for round in 0..ROUNDS + self.surface.edges().len() {
            let (mut count, bounds) = (0, self.bounds(&step.path()));
            for number in 0..self.obstacles.len() {
                let Some((motion, is_short)) = self.is_near(&step.path(), number, bounds) else { continue };
                found.clear();
                self.each_candidate(&step.path(), (number, &motion, is_short), |candidate| found.push(candidate));
                for candidate in found.drain(..) {
                    let Some(met) = self.find(&step.path(), (number, &motion), candidate) else { continue };
                    if round < ROUNDS {
                        step.push(&met);
                    } else {
                        step.put_back(&met, &motion);
                    }
                    step.is_pushed |= motion.end().is_some();
                    count += 1;
                }
            }
            all += count;
            if count == 0 {
                break;
            }
        }
        *step.found = found;
        all
    }

    /// Fraction of the displacements until something meets an obstacle; with `solids`, only obstacles that are bounded.
    pub fn first_meeting(&self, path: &Path<'_>, solids: bool) -> Option<f64> {
        let (mut first, bounds): (Option<f64>, _) = (None, self.bounds(path));
        for number in (0..self.obstacles.len()).filter(|number| !solids || self.obstacles[*number].obstacle.is_solid())
        {
            let Some((motion, is_short)) = self.is_near(path, number, bounds) else { continue };
            self.each_candidate(path, (number, &motion, is_short), |candidate| {
                if let Some(met) = self.find(path, (number, &motion), candidate) {
                    first = Some(first.map_or(met.share, |share| share.min(met.share)));
                }
            });
        }
        first
    }

    /// Motion of an obstacle, if it may be met, and whether displacements relative to it are so short that only what touches at
    /// the start can meet it; `bounds` are boxes around the start and the end.
    fn is_near(&self, path: &Path<'_>, number: usize, [start, end]: [Bounds; 2]) -> Option<(SweptMotion, bool)> {
        let placed = &self.obstacles[number];
        let motion = placed.swept_motion(path.time);
        let Bounds([least, greatest]) = match motion.end() {
            None => start.with(end),
            Some(_) => start.mapped(|corner| motion.place(corner)).with(end).mapped(|corner| motion.to_shape(corner)),
        };
        if !placed.obstacle.is_near(least, greatest) {
            return None;
        }
        let limit = SHORT * self.least_thickness();
        let is_short = |(from, to): (&[f64; 2], &[f64; 2])| {
            let [fx, fy] = motion.place(*from);
            (to[0] - fx) * (to[0] - fx) + (to[1] - fy) * (to[1] - fy) <= limit * limit
        };
        let mut displacements = path.start.as_chunks().0.iter().zip(path.end.as_chunks().0);
        Some((motion, path.anchors.is_some() && displacements.all(is_short)))
    }

    /// Boxes around the start and the end of a path, with the skin.
    fn bounds(&self, path: &Path<'_>) -> [Bounds; 2] {
        [path.start, path.end].map(|x| Bounds::of(x).grown(self.greatest_thickness()))
    }

    /// Calls `act` with what may meet an obstacle.
    fn each_candidate(
        &self,
        path: &Path<'_>,
        (number, motion, is_short): (usize, &SweptMotion, bool),
        mut act: impl FnMut(Candidate),
    ) {
        if is_short {
            for anchor in self.own_anchors(path.known()) {
                let name = anchor.contact;
                if let (true, Some(vertex)) = (name.surface as usize == number, self.surface.numbered(name.vertex)) {
                    act(Candidate::Vertex(*vertex));
                }
            }
        } else {
            self.surface.all().iter().for_each(|vertex| act(Candidate::Vertex(*vertex)));
        }
        let placed = &self.obstacles[number];
        let corners = placed.obstacle.corners();
        for edge in 0..if corners.is_empty() { 0 } else { self.surface.edges().len() as u32 } {
            let ends = self.surface.edges()[edge as usize].ends;
            let [a, b] = ends.map(|end| motion.place(vector(path.start, end)));
            let [c, d] = ends.map(|end| vector(path.end, end));
            let bounds = Bounds::of([a, b, c, d].as_flattened()).grown(self.greatest_thickness());
            if placed.is_near(bounds, motion.end()) {
                for (number, corner) in corners.iter().enumerate() {
                    let Corner { middle, radius, margin } = corner.placed(motion.end());
                    let Bounds([least, greatest]) = bounds.grown(radius + margin);
                    if (0..2).all(|axis| middle[axis] > least[axis] && middle[axis] < greatest[axis]) {
                        act(Candidate::Edge(edge, number));
                    }
                }
            }
        }
    }

    /// How a candidate meets an obstacle, if it does.
    fn find(&self, path: &Path<'_>, obstacle: (usize, &SweptMotion), candidate: Candidate) -> Option<Met> {
        match candidate {
            Candidate::Vertex(vertex) => self.find_vertex(path, obstacle, vertex),
            Candidate::Edge(edge, corner) => self.find_edge(path, obstacle, (edge, corner)),
        }
    }

    /// A vertex that comes too near to an obstacle, or goes deeper into one that it begins in.
    fn find_vertex(
        &self,
        path: &Path<'_>,
        (number, motion): (usize, &SweptMotion),
        vertex: SurfaceVertex,
    ) -> Option<Met> {
        let obstacle = &*self.obstacles[number].obstacle;
        let thickness = self.potential(vertex.part).thickness;
        let [from, to] = [motion.place(vector(path.start, vertex.vertex)), vector(path.end, vertex.vertex)]
            .map(|at| motion.to_shape(at));
        let displacement = [to[0] - from[0], to[1] - from[1]];
        let begins =
            obstacle.distance(from, length(displacement) + thickness + self.offset(vertex.part, obstacle.margin()))?;
        let kept = anchor_of(path.known(), self.name(number, vertex.vertex));
        let floor = self.offset(vertex.part, obstacle.margin()) + FLOOR * thickness;
        let clearance = Clearance::new(floor, begins.distance, kept.map_or(0.0, |anchor| anchor.penetration));
        let (share, at, contact) = if begins.distance > 0.0 {
            let (share, contact) = advance(obstacle, (from, displacement), clearance.least)?;
            (share, [0, 1].map(|axis| from[axis] + share * displacement[axis]), contact)
        } else {
            (0.0, to, obstacle.distance(to, clearance.least)?)
        };
        let reached = contact.distance + contact.along([to[0] - at[0], to[1] - at[1]]);
        Some(Met {
            vertices: [vertex.vertex as usize; 2],
            weights: [1.0, 0.0],
            normal: motion.direction(contact.normal),
            missing: clearance.wanted - reached,
            wall: motion.velocity_at(vector(path.end, vertex.vertex)),
            share,
        })
    }

    /// An edge that comes too near to a corner of an obstacle.
    fn find_edge(
        &self,
        path: &Path<'_>,
        (number, motion): (usize, &SweptMotion),
        (edge, corner): (u32, usize),
    ) -> Option<Met> {
        let SurfaceEdge { ends, part, .. } = self.surface.edges()[edge as usize];
        let Corner { middle, radius, margin } = self.obstacles[number].obstacle.corners()[corner].placed(motion.end());
        let kept = self.kept(path.known(), edge, self.first_corner(number) + corner as u32);
        let floor = self.offset(part, margin) + FLOOR * self.potential(part).thickness;
        let from = ends.map(|end| motion.place(vector(path.start, end)));
        let to = ends.map(|end| vector(path.end, end));
        let is_apart = |axis: usize| {
            let all = [from[0][axis], from[1][axis], to[0][axis], to[1][axis]];
            let reach = radius + floor;
            all.iter().all(|p| *p > middle[axis] + reach) || all.iter().all(|p| *p < middle[axis] - reach)
        };
        if is_apart(0) || is_apart(1) {
            return None;
        }
        let (from, to) = ([middle, from[0], from[1]], [middle, to[0], to[1]]);
        let begins = nearest(from).2 - radius;
        let clearance = Clearance::new(floor, begins, penetration_of(kept));
        let (share, at) = if begins > 0.0 {
            let share = meeting(from, to, radius, clearance.least)?;
            (share, [0, 1, 2].map(|i| [0, 1].map(|axis| from[i][axis] + share * (to[i][axis] - from[i][axis]))))
        } else if nearest(to).2 - radius < clearance.least {
            (0.0, to)
        } else {
            return None;
        };
        // An edge may leave a corner that began inside its body.
        let penetrates = || self.penetrates(path.known(), part, self.first_corner(number) + corner as u32);
        if penetrates() && self.surface.is_inside(part, |end| motion.place(vector(path.start, end)), middle) {
            return None;
        }
        let ([nx, ny], t, _) = nearest(at);
        let along = |[px, py]: [f64; 2]| nx * px + ny * py;
        let reached = along(to[0]) - (1.0 - t) * along(to[1]) - t * along(to[2]);
        Some(Met {
            vertices: ends.map(|end| end as usize),
            weights: [1.0 - t, t],
            normal: [-nx, -ny],
            missing: radius + clearance.wanted - reached,
            wall: motion.velocity_at(middle),
            share,
        })
    }
}

/// Fraction of a displacement at which a point comes within a distance of an obstacle, and the surface there; `None` if it stays
/// farther than half of the way from there.
///
/// The tangent of a convex obstacle at the nearest point separates the two; a point is nowhere nearer to any obstacle than its
/// distance.
fn advance(obstacle: &dyn Obstacle, (from, displacement): ([f64; 2], [f64; 2]), floor: f64) -> Option<(f64, Contact)> {
    let speed = length(displacement);
    let mut share = 0.0;
    let mut found = None;
    for _ in 0..ADVANCES {
        let at = [0, 1].map(|axis| from[axis] + share * displacement[axis]);
        let contact = obstacle.distance(at, (1.0 - share) * speed + floor.max(0.0))?;
        found = Some((share, contact));
        if contact.distance <= floor {
            break;
        }
        let approach = if obstacle.is_convex() { -contact.along(displacement) } else { speed };
        if approach <= 0.0 {
            return None;
        }
        share += (contact.distance - floor + 0.5 * floor.abs()) / approach;
        if share >= 1.0 {
            return None;
        }
    }
    found
}
