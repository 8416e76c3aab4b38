//! Truncation of steps at obstacles: where the skin is used up, displacements and velocities are changed so that no vertex enters
//! an obstacle, no edge passes over one of its corners, and no point of a triangle that touches obstacles enters one.
//!
//! All motion is seen in the frame of the obstacle at the end of the step: points at its start are mapped there as if attached to
//! it, so that nothing passes through at any speed of either. An inelastic impulse along the normal takes away the approach: that
//! of the obstacle on one vertex, of a corner on both ends of an edge, or on the corners of a triangle. Where that does not suffice in a few rounds, because
//! several obstacles act on connected edges, vertices stay where they began, attached to the obstacle.

use super::{
    Anchor, BetweenVertices, ContactName, ContactTerm as _, ObstacleContact, SurfaceVertex,
    friction::anchor_of,
    touch::{coordinates, dot, length},
    truncation::{ADVANCES, Clearance, FLOOR},
};
use crate::{
    effects::Bounds,
    obstacles::{Contact, Obstacle, SweptMotion},
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
    pub(super) fn known(&self) -> &'a [Anchor] {
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
    /// Scratch: what may meet an obstacle.
    pub found: &'a mut Vec<Candidate>,
    /// Scratch: positions before a round \[m\].
    pub before: &'a mut Vec<f64>,
    /// Work of moving obstacles by impulses \[J\].
    pub supplied: f64,
    /// Whether a moving obstacle moved a vertex, which may do more work.
    pub is_pushed: bool,
}

/// What may meet an obstacle.
#[derive(Clone, Copy, Debug)]
pub enum Candidate {
    /// A vertex.
    Vertex(SurfaceVertex),
    /// An edge and the number of a corner of the obstacle, or a triangle and the number of its point.
    Between(u32, u32),
}

/// A vertex, an edge or a triangle that meets an obstacle, as a stencil with weights.
pub struct Met<const D: usize> {
    /// Its vertices.
    pub vertices: [usize; 3],
    /// Their weights.
    pub weights: [f64; 3],
    /// Unit normal from the obstacle.
    pub normal: [f64; D],
    /// Displacement along it that is missing at the end \[m\].
    pub missing: f64,
    /// Velocity of the obstacle there [m/s].
    pub wall: [f64; D],
    /// Fraction of the displacement until it meets.
    pub share: f64,
}

impl TruncatedStep<'_> {
    fn path(&self) -> Path<'_> {
        Path { time: self.time, start: self.start, end: self.x, anchors: Some(self.anchors) }
    }

    /// Takes away the approach of positions and velocities by an impulse in proportion to the inverse masses.
    fn push<const D: usize>(&mut self, met: &Met<D>) {
        let Met { vertices, weights, normal, missing, wall, .. } = met;
        let all = || vertices.iter().zip(weights).filter(|(_, weight)| **weight != 0.0);
        let inverse = |vertex: usize| {
            let inverse: [f64; D] = coordinates(self.inverse_mass, vertex as u32);
            dot(normal.map(|along| along * along), inverse)
        };
        let mobility: f64 = all().map(|(vertex, w)| w * w * inverse(*vertex)).sum();
        let along: f64 = all().map(|(vertex, w)| w * dot(*normal, coordinates(self.v, *vertex as u32))).sum();
        let wall = dot(*normal, *wall);
        let approach = (wall - along).max(0.0);
        if mobility <= 0.0 {
            return;
        }
        self.supplied += (approach / mobility * wall).max(0.0);
        for (values, wanted) in [(&mut *self.x, missing.max(0.0)), (&mut *self.v, approach)] {
            for (vertex, w) in all() {
                let change = w * wanted / mobility;
                for (axis, along) in normal.iter().enumerate() {
                    values[D * vertex + axis] += change * along * self.inverse_mass[D * vertex + axis];
                }
            }
        }
        self.moved.extend(all().map(|(vertex, _)| *vertex));
    }

    /// Puts vertices back to their start, attached to the obstacle.
    fn put_back<const D: usize>(&mut self, met: &Met<D>, motion: &SweptMotion<D>) {
        for (vertex, _) in met.vertices.iter().zip(met.weights).filter(|(_, weight)| *weight != 0.0) {
            let from = motion.place(coordinates(self.start, *vertex as u32));
            let wall = motion.velocity_at(from);
            for axis in 0..D {
                let (number, inverse) = (D * vertex + axis, self.inverse_mass[D * vertex + axis]);
                if inverse != 0.0 {
                    self.supplied += ((wall[axis] - self.v[number]) / inverse * wall[axis]).max(0.0);
                    (self.x[number], self.v[number]) = (from[axis], wall[axis]);
                }
            }
            self.moved.push(*vertex);
        }
    }
}

impl<const D: usize, const T: usize, const N: usize> ObstacleContact<D, T, N>
where
    Self: BetweenVertices<D, T, N>,
{
    /// Truncates a step; returns the number of vertices and edges that met an obstacle.
    pub(super) fn truncated(&self, step: &mut TruncatedStep<'_>) -> usize {
        let (mut all, mut found, mut before) = (0, std::mem::take(step.found), std::mem::take(step.before));
        for round in 0..ROUNDS + self.rounds_between() {
            before.clear();
            before.extend_from_slice(step.x);
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
            // What meets where it was put back, as between two obstacles, does so in every further round.
            if count == 0 || round >= ROUNDS && *before == *step.x {
                break;
            }
        }
        (*step.found, *step.before) = (found, before);
        all
    }

    /// Most rounds in which connected vertices are put back, one after the other; in space where all obstacles are at rest.
    fn rounds_between(&self) -> usize {
        if self.faces.is_some() && !self.moves() { self.surface.len() } else { self.surface.edges().len() }
    }

    /// Fraction of the displacements until something meets an obstacle; with `solids`, only obstacles that are bounded.
    pub(super) fn meeting_of_path(&self, path: &Path<'_>, solids: bool) -> Option<f64> {
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
    fn is_near(&self, path: &Path<'_>, number: usize, [start, end]: [Bounds<D>; 2]) -> Option<(SweptMotion<D>, bool)> {
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
        let is_short = |(from, to): (&[f64; D], &[f64; D])| {
            let from = motion.place(*from);
            let gone: [f64; D] = std::array::from_fn(|axis| to[axis] - from[axis]);
            dot(gone, gone) <= limit * limit
        };
        let mut displacements = path.start.as_chunks().0.iter().zip(path.end.as_chunks().0);
        Some((motion, path.anchors.is_some() && displacements.all(is_short)))
    }

    /// Boxes around the start and the end of a path, with the skin.
    fn bounds(&self, path: &Path<'_>) -> [Bounds<D>; 2] {
        [path.start, path.end].map(|x| Bounds::of(x).grown(self.greatest_thickness()))
    }

    /// Calls `act` with what may meet an obstacle.
    fn each_candidate(
        &self,
        path: &Path<'_>,
        (number, motion, is_short): (usize, &SweptMotion<D>, bool),
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
        self.each_candidate_between(path, (number, motion, is_short), &mut |surface, number| {
            act(Candidate::Between(surface, number));
        });
    }

    /// How a candidate meets an obstacle, if it does.
    fn find(&self, path: &Path<'_>, obstacle: (usize, &SweptMotion<D>), candidate: Candidate) -> Option<Met<D>> {
        match candidate {
            Candidate::Vertex(vertex) => self.find_vertex(path, obstacle, vertex),
            Candidate::Between(surface, number) => self.find_between(path, obstacle, (surface, number)),
        }
    }

    /// A vertex that comes too near to an obstacle, or goes deeper into one that it begins in.
    fn find_vertex(
        &self,
        path: &Path<'_>,
        (number, motion): (usize, &SweptMotion<D>),
        vertex: SurfaceVertex,
    ) -> Option<Met<D>> {
        let ends = [path.start, path.end].map(|x| coordinates(x, vertex.vertex));
        let met = self.find_point(path, (number, motion), (ends, vertex.part, self.name(number, vertex.vertex)))?;
        Some(Met { vertices: [vertex.vertex as usize; 3], ..met })
    }

    /// The same for any point of the surface, from its positions at the start and the end, its part and the name of its contact. Vertices and weights are those
    /// of a vertex.
    pub(super) fn find_point(
        &self,
        path: &Path<'_>,
        (number, motion): (usize, &SweptMotion<D>),
        ([start, end], part, name): ([[f64; D]; 2], u32, ContactName),
    ) -> Option<Met<D>> {
        let obstacle = &*self.obstacles[number].obstacle;
        let thickness = self.potential(part).thickness;
        let [from, to] = [motion.place(start), end].map(|at| motion.to_shape(at));
        let displacement = std::array::from_fn(|axis| to[axis] - from[axis]);
        let begins =
            obstacle.distance(from, length(displacement) + thickness + self.offset(part, obstacle.margin()))?;
        let kept = anchor_of(path.known(), name);
        let floor = self.offset(part, obstacle.margin()) + FLOOR * thickness;
        let clearance = Clearance::new(floor, begins.distance, kept.map_or(0.0, |anchor| anchor.penetration));
        let (share, at, contact) = if begins.distance > 0.0 {
            let (share, contact) = advance(obstacle, (from, displacement), clearance.least)?;
            (share, std::array::from_fn(|axis| from[axis] + share * displacement[axis]), contact)
        } else {
            (0.0, to, obstacle.distance(to, clearance.least)?)
        };
        let reached = contact.distance + contact.along(std::array::from_fn(|axis| to[axis] - at[axis]));
        Some(Met {
            vertices: [0; 3],
            weights: [1.0, 0.0, 0.0],
            normal: motion.direction(contact.normal),
            missing: clearance.wanted - reached,
            wall: motion.velocity_at(end),
            share,
        })
    }
}

/// Fraction of a displacement at which a point comes within a distance of an obstacle, and the surface there; `None` if it stays
/// farther than half of the way from there.
///
/// The tangent of a convex obstacle at the nearest point separates the two; a point is nowhere nearer to any obstacle than its
/// distance.
fn advance<const D: usize>(
    obstacle: &dyn Obstacle<D>,
    (from, displacement): ([f64; D], [f64; D]),
    floor: f64,
) -> Option<(f64, Contact<D>)> {
    let speed = length(displacement);
    let mut share = 0.0;
    let mut found = None;
    for _ in 0..ADVANCES {
        let at = std::array::from_fn(|axis| from[axis] + share * displacement[axis]);
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
