//! Truncation of steps: where the skin is used up, displacements and velocities are changed so that no vertex crosses an edge.
//!
//! A vertex and an edge whose vertices move along straight lines do not meet before the line across their nearest points, which
//! separates them, is reached by one of them. Conservative advancement repeats that from there (Mirtich, *Impulse-based Dynamic
//! Simulation of Rigid Body Systems*, 1996, section 2.3), so that a pair it finds free has not met. The others are treated in
//! three ways, each where a few rounds of the one before do not suffice:
//!
//! 1. An inelastic impulse along the normal takes away the approach of each pair, in positions and velocities alike and in
//!    proportion to the inverse masses: it keeps linear momentum, and angular momentum where the pair does not slide.
//! 2. All vertices that such pairs connect move alike: their displacements and velocities become the means over their masses.
//!    This keeps linear momentum too, and never adds kinetic energy.
//! 3. Each vertex of a pair stays on its side of the line halfway between them, a planar division of space, and its velocity is
//!    scaled as its displacement. Displacements only shrink, and a vertex that stays on its side once does so from then on, so
//!    that this ends; with no displacement left, nothing has crossed.
//!
//! Impulses may bring together pairs that were too far apart before, so that a second call with [`Means::Cuts`] ends the step.
//! Moved vertices may deform elements. If that gives more elastic energy than was lost, it is taken from the velocities of these
//! vertices relative to each other, and what they do not have from those of their bodies.

use super::{
    Candidate, Candidates, Pair, SurfaceContact,
    candidates::{greater, squared_distance},
    edge_query::Seen,
    touch::{length, vector},
};
use std::ops::Range;

/// Scratch for [`SurfaceContact::truncate`].
#[derive(Clone, Debug, Default)]
pub struct Truncation {
    /// Pairs that may meet in the step.
    pairs: Vec<Pair>,
    /// Those that do.
    meeting: Vec<Pair>,
    /// What may meet an obstacle.
    pub found: Vec<Candidate>,
    /// All vertices that truncation moved in this step.
    pub moved: Vec<usize>,
    /// Fraction of its displacement that each vertex of the scene keeps.
    kept: Vec<f64>,
    /// Mean displacement of each part, and the greatest deviation from it \[m\].
    displaced: Vec<([f64; 2], f64)>,
    /// Search of pairs farther apart than the candidates.
    search: Candidates,
    /// A vertex that each vertex is connected to, itself if it is the first; and by first vertices the sums of their masses along
    /// both axes, of these times displacements and times velocities, and their number.
    connected: Vec<u32>,
    sums: Vec<[f64; 7]>,
}

/// What may be done to keep a step from crossing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Means {
    /// Impulses and common displacements, which keep momentum, and where they do not suffice, displacements are cut.
    All,
    /// Displacements are cut: every vertex ends on the straight line of its displacement.
    Cuts,
}

/// Rounds of impulses, and of common displacements.
const IMPULSES: usize = 8;
const COMMON: usize = 16;
/// Rounds of cutting displacements, after which vertices that are still in a pair that meets stay in place.
const CUTS: usize = 16;
/// Least gap that a step leaves, as a fraction of the thickness of the skin: far above round-off.
pub(super) const FLOOR: f64 = 0.02;
/// Share of its distance that a pair may lose in a step where its skin is used up: far above round-off.
const CREEP: f64 = 0.02;
/// Most iterations of conservative advancement; stopping at any of them is safe.
pub(super) const ADVANCES: usize = 64;

/// Distances that a vertex keeps from an edge or an obstacle \[m\].
pub(super) struct Clearance {
    /// Least distance within the step.
    pub least: f64,
    /// Distance at the end of a step that comes nearer.
    pub wanted: f64,
}

impl Clearance {
    /// Distances where the skin is used up at a floor \[m\]. What begins nearer to the surface may lose a small share of its
    /// distance. What begins on the surface, as exactly as the floor, goes no deeper; what begins deeper inside may do so until the skin is
    /// used up that its initial penetration leaves.
    pub fn new(floor: f64, begins: f64, penetration: f64) -> Self {
        if begins > 0.0 {
            return Self { least: floor.min((1.0 - CREEP) * begins), wanted: floor.min(2.0 * begins) };
        }
        let least = if begins > -floor { begins } else { (floor - penetration).min(begins) };
        Self { least, wanted: least }
    }
}

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

/// Fraction of the displacement at which a vertex and an edge come within a radius and a distance \[m\]; `None` if they stay
/// farther than the radius and half of the distance apart all the way.
pub(super) fn meeting(from: Points, to: Points, radius: f64, distance: f64) -> Option<f64> {
    let mut share = 0.0;
    for _ in 0..ADVANCES {
        let at = [0, 1, 2].map(|i| [0, 1].map(|axis| from[i][axis] + share * (to[i][axis] - from[i][axis])));
        let ([nx, ny], _, gap) = nearest(at);
        if gap <= radius + distance || gap.is_nan() {
            return Some(share);
        }
        let mut next = f64::INFINITY;
        for end in 1..3 {
            let apart = nx * (at[0][0] - at[end][0]) + ny * (at[0][1] - at[end][1]);
            let rate = |axis: usize| (to[end][axis] - from[end][axis]) - (to[0][axis] - from[0][axis]);
            let approach = nx * rate(0) + ny * rate(1);
            if approach > 0.0 {
                next = f64::min(next, (apart - radius - distance + 0.5 * distance.abs()) / approach);
            }
        }
        share += next;
        if share >= 1.0 {
            return None;
        }
    }
    Some(share)
}

impl SurfaceContact {
    /// The vertex and the ends of the edge of a pair.
    fn points(&self, x: &[f64], pair: Pair) -> Points {
        let (edge, vertex) = self.members(pair);
        [vertex.vertex, edge.ends[0], edge.ends[1]].map(|vertex| vector(x, vertex))
    }

    /// Numbers of the same vertices.
    fn vertices(&self, pair: Pair) -> [usize; 3] {
        let (edge, vertex) = self.members(pair);
        [vertex.vertex, edge.ends[0], edge.ends[1]].map(|vertex| vertex as usize)
    }

    /// Distances that a pair keeps in a step from `start`.
    fn clearance(&self, start: &[f64], pair: Pair) -> Clearance {
        Clearance::new(FLOOR * self.thickness(pair), nearest(self.points(start, pair)).2, 0.0)
    }

    /// Thickness of the skin between a vertex and an edge \[m\].
    fn thickness(&self, pair: Pair) -> f64 {
        let (edge, vertex) = self.members(pair);
        self.potential(edge.part, vertex.part).thickness
    }

    /// Finds all pairs that are near enough to each other to meet in a step from `start` to `x`.
    fn find_pairs(&self, scratch: &mut Truncation, candidates: &mut Candidates, start: &[f64], x: &[f64]) {
        let Truncation { pairs, displaced, search, .. } = scratch;
        displaced.clear();
        let displacement = |place: usize| {
            let vertex = self.surface().at(place as u32).vertex;
            let ([ax, ay], [bx, by]) = (vector(start, vertex), vector(x, vertex));
            [bx - ax, by - ay]
        };
        let mut all = [0.0; 2];
        for part in 0..self.surface().parts() {
            let vertices = self.surface().vertices_of(part);
            let count = vertices.len().max(1) as f64;
            let sum = vertices.clone().map(displacement).fold([0.0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
            let mean = sum.map(|sum| sum / count);
            let deviation = |place: usize| {
                let [dx, dy] = displacement(place);
                (dx - mean[0]) * (dx - mean[0]) + (dy - mean[1]) * (dy - mean[1])
            };
            displaced.push((mean, vertices.map(deviation).fold(0.0, greater).sqrt()));
            all = [all[0] + mean[0], all[1] + mean[1]];
        }
        let all = all.map(|all| all / self.surface().parts().max(1) as f64);
        let single = displaced.len() == 1;
        let from_all = |(mean, deviation): &([f64; 2], f64)| {
            deviation + if single { 0.0 } else { length([mean[0] - all[0], mean[1] - all[1]]) }
        };
        let farthest = 2.0 * displaced.iter().map(from_all).fold(0.0, greater);
        pairs.clear();
        if !farthest.is_finite() {
            return;
        }
        if farthest <= self.near() {
            candidates.update(self.surface(), start, self.near());
            let may_meet = |pair: &&Pair| {
                let reach = farthest + FLOOR * self.thickness(**pair);
                squared_distance(self.surface(), start, **pair) <= reach * reach
            };
            pairs.extend(candidates.pairs().iter().filter(may_meet));
        } else {
            search.find(self.surface(), start, farthest, pairs);
            pairs.retain(|pair| {
                let (edge, vertex) = self.members(*pair);
                let own = edge.part == vertex.part;
                !own || nearest(self.points(start, *pair)).2 <= 2.0 * displaced[edge.part as usize].1
            });
        }
        pairs.retain(|pair| {
            let (edge, vertex) = self.members(*pair);
            !self.are_apart(edge.part, vertex.part)
        });
    }

    /// Largest multiple of the displacement from positions x to `end` \[m\] in which no vertex meets an edge.
    pub fn longest_step(&self, scratch: &mut Truncation, candidates: &mut Candidates, x: &[f64], end: &[f64]) -> f64 {
        self.find_pairs(scratch, candidates, x, end);
        scratch.pairs.iter().filter_map(|pair| self.meeting(x, end, *pair)).fold(f64::INFINITY, f64::min)
    }

    /// Changes positions and velocities at the end of a step from `start` so that no vertex has crossed an edge. Returns the
    /// number of pairs that met.
    pub fn truncate(
        &self,
        (scratch, candidates): (&mut Truncation, &mut Candidates),
        means: Means,
        (start, inverse_mass): (&[f64], &[f64]),
        [x, v]: [&mut [f64]; 2],
    ) -> usize {
        self.find_pairs(scratch, candidates, start, x);
        let Truncation { pairs, meeting, moved, kept, connected, sums, .. } = scratch;
        self.find_meeting(pairs, start, x, meeting);
        let count = meeting.len();
        if count == 0 {
            return 0;
        }
        let mut touch = |meeting: &[Pair]| moved.extend(meeting.iter().flat_map(|pair| self.vertices(*pair)));
        if means == Means::All {
            for _ in 0..IMPULSES {
                touch(meeting);
                for pair in &*meeting {
                    self.stop(start, inverse_mass, [&mut *x, &mut *v], *pair);
                }
                self.find_meeting(pairs, start, x, meeting);
                if meeting.is_empty() {
                    return count;
                }
            }
            connected.clear();
            connected.extend(0..x.len() as u32 / 2);
            for _ in 0..COMMON {
                touch(meeting);
                for pair in &*meeting {
                    connect(connected, self.vertices(*pair));
                }
                unite(connected, sums, (start, inverse_mass), [&mut *x, &mut *v]);
                self.find_meeting(pairs, start, x, meeting);
                if meeting.is_empty() {
                    return count;
                }
            }
        }
        kept.clear();
        kept.resize(x.len() / 2, 1.0);
        for round in 0.. {
            touch(meeting);
            for pair in &*meeting {
                self.divide(start, x, *pair, kept, round >= CUTS);
            }
            let mut has_moved = false;
            for (vertex, kept) in kept.iter_mut().enumerate().filter(|(_, kept)| **kept < 1.0) {
                for number in [2 * vertex, 2 * vertex + 1] {
                    has_moved |= x[number] != start[number];
                    x[number] = start[number] + *kept * (x[number] - start[number]);
                    v[number] *= *kept;
                }
                *kept = 1.0;
            }
            self.find_meeting(pairs, start, x, meeting);
            // What meets with every vertex at its start was beyond repair before the step. Numbers that are not finite never return there.
            if meeting.is_empty() || round > CUTS && (!has_moved || round > CUTS + pairs.len()) {
                break;
            }
        }
        count
    }

    /// Fraction of a step from `start` to `x` at which the vertex and the edge of a pair meet. A vertex inside another
    /// body may leave that: where bodies do not cross themselves, it began there. One that begins exactly on an edge meets it
    /// only on its way to the inner side.
    fn meeting(&self, start: &[f64], x: &[f64], pair: Pair) -> Option<f64> {
        let (from, to) = (self.points(start, pair), self.points(x, pair));
        // Most pairs are farther apart than they move.
        let moved = |i: usize| length([to[i][0] - from[i][0], to[i][1] - from[i][1]]);
        let reach = moved(0) + moved(1).max(moved(2)) + FLOOR * self.thickness(pair);
        if squared_distance(self.surface(), start, pair) > reach * reach {
            return None;
        }
        if nearest(from).2 == 0.0 {
            let ends = Seen::new(x, self.members(pair).0, to[0]);
            return (ends.is_within() && ends.distance < 0.0).then_some(0.0);
        }
        let share = meeting(from, to, 0.0, self.clearance(start, pair).least)?;
        (self.is_outside(start, pair) || !self.is_inside(start, pair)).then_some(share)
    }

    /// Whether the vertex of a pair is inside the part of the edge.
    pub(super) fn is_inside(&self, x: &[f64], [edge, vertex]: Pair) -> bool {
        let part = self.surface().edges()[edge as usize].part;
        self.surface().is_inside(part, |end| vector(x, end), vector(x, self.surface().at(vertex).vertex))
    }

    /// Writes those of some pairs that meet.
    fn find_meeting(&self, pairs: &[Pair], start: &[f64], x: &[f64], found: &mut Vec<Pair>) {
        found.clear();
        found.extend(pairs.iter().filter(|pair| self.meeting(start, x, **pair).is_some()));
    }

    /// Takes away the approach of a pair along the normal where it meets, beyond the distance that it keeps.
    fn stop(&self, start: &[f64], inverse_mass: &[f64], [x, v]: [&mut [f64]; 2], pair: Pair) {
        let (from, to) = (self.points(start, pair), self.points(x, pair));
        let clearance = self.clearance(start, pair);
        let Some(share) = meeting(from, to, 0.0, clearance.least) else { return };
        let at = [0, 1, 2].map(|i| [0, 1].map(|axis| from[i][axis] + share * (to[i][axis] - from[i][axis])));
        let ([nx, ny], t, _) = nearest(at);
        let (weights, vertices) = ([1.0, t - 1.0, -t], self.vertices(pair));
        let along = |of: &[f64]| {
            (0..3).map(|i| weights[i] * (nx * of[2 * vertices[i]] + ny * of[2 * vertices[i] + 1])).sum::<f64>()
        };
        let inverse = |i: usize| nx * nx * inverse_mass[2 * vertices[i]] + ny * ny * inverse_mass[2 * vertices[i] + 1];
        let mobility: f64 = (0..3).map(|i| weights[i] * weights[i] * inverse(i)).sum();
        if mobility.is_nan() || mobility <= 0.0 {
            return;
        }
        let missing = (clearance.wanted - along(x)).max(0.0);
        let approach = (-along(v)).max(0.0);
        for (values, wanted) in [(x, missing), (v, approach)] {
            for i in 0..3 {
                let change = weights[i] * wanted / mobility;
                values[2 * vertices[i]] += change * nx * inverse_mass[2 * vertices[i]];
                values[2 * vertices[i] + 1] += change * ny * inverse_mass[2 * vertices[i] + 1];
            }
        }
    }

    /// Cuts the displacements of a pair at the line halfway between them at the start, or to nothing.
    fn divide(&self, start: &[f64], x: &[f64], pair: Pair, kept: &mut [f64], entirely: bool) {
        let points = self.points(start, pair);
        let (normal, _, gap) = nearest(points);
        let along = |[px, py]: [f64; 2]| normal[0] * px + normal[1] * py;
        let margin = 0.5 * (gap - self.clearance(start, pair).least);
        for (i, vertex) in self.vertices(pair).into_iter().enumerate() {
            // The vertex may approach the edge by the margin, and the ends of the edge, as far as they are behind it, by more.
            let sign = if i == 0 { -1.0 } else { 1.0 };
            let behind = if i == 0 { 0.0 } else { along(points[0]) - gap - along(points[i]) };
            let approach = sign * (along(vector(x, vertex as u32)) - along(points[i]));
            let limit = if entirely { 0.0 } else { (margin + behind.max(0.0)) / approach };
            if approach > 0.0 && limit < kept[vertex] || entirely {
                kept[vertex] = limit.max(0.0);
            }
        }
    }
}

impl Truncation {
    /// Whether a step from `start` to x \[m\] has pairs that meet.
    pub fn meets(&mut self, contact: &SurfaceContact, candidates: &mut Candidates, start: &[f64], x: &[f64]) -> bool {
        contact.find_pairs(self, candidates, start, x);
        self.pairs.iter().any(|pair| contact.meeting(start, x, *pair).is_some())
    }

    /// Takes kinetic energy \[J\] from the vertices that were moved, as far as they have it relative to each
    /// other, and the rest from their whole bodies, whose vertices `parts` gives: mean velocities stay.
    pub fn dissipate(
        &mut self,
        energy: f64,
        [mass, inverse_mass]: [&[f64]; 2],
        parts: impl Iterator<Item = Range<usize>>,
        v: &mut [f64],
    ) {
        let Self { moved, .. } = self;
        moved.sort_unstable();
        moved.dedup();
        let left = dissipate(energy, [mass, inverse_mass], moved, v);
        if left > 0.0 {
            let found = moved.len();
            for part in parts {
                if moved[..found].iter().any(|vertex| part.contains(vertex)) {
                    moved.extend(part);
                }
            }
            dissipate(left, [mass, inverse_mass], &moved[found..], v);
        }
    }
}

/// Takes kinetic energy \[J\] from the motion of some vertices relative to each other; returns what they do not have.
fn dissipate(energy: f64, [mass, inverse_mass]: [&[f64]; 2], vertices: &[usize], v: &mut [f64]) -> f64 {
    let along = |axis: usize| {
        let numbers = vertices.iter().map(move |vertex| 2 * vertex + axis);
        numbers.filter(|number| inverse_mass[*number] != 0.0)
    };
    let means = [0, 1].map(|axis| {
        let sums = along(axis).map(|number| [mass[number], mass[number] * v[number]]);
        let [total, momentum] = sums.fold([0.0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
        if total > 0.0 { momentum / total } else { 0.0 }
    });
    let relative = |axis: usize| {
        let square = |number: usize| (v[number] - means[axis]) * (v[number] - means[axis]);
        along(axis).map(|number| 0.5 * mass[number] * square(number)).sum::<f64>()
    };
    let there = relative(0) + relative(1);
    let share = if energy < there { (1.0 - energy / there).sqrt() } else { 0.0 };
    for (axis, mean) in means.into_iter().enumerate() {
        along(axis).for_each(|number| v[number] = mean + share * (v[number] - mean));
    }
    (energy - there).max(0.0)
}

/// First vertex that a vertex is connected to.
fn first(connected: &mut [u32], vertex: usize) -> usize {
    let mut at = vertex;
    while connected[at] as usize != at {
        // Shortens the way for the next call.
        connected[at] = connected[connected[at] as usize];
        at = connected[at] as usize;
    }
    at
}

/// Connects vertices.
fn connect(connected: &mut [u32], vertices: [usize; 3]) {
    let all = vertices.map(|vertex| first(connected, vertex));
    let least = all[0].min(all[1]).min(all[2]);
    for vertex in all {
        connected[vertex] = least as u32;
    }
}

/// Gives connected vertices their mean displacement and velocity over their masses: none where one of them is held.
fn unite(
    connected: &mut [u32],
    sums: &mut Vec<[f64; 7]>,
    (start, inverse_mass): (&[f64], &[f64]),
    [x, v]: [&mut [f64]; 2],
) {
    sums.clear();
    sums.resize(connected.len(), [0.0; 7]);
    for vertex in 0..connected.len() {
        let sum = first(connected, vertex);
        sums[sum][6] += 1.0;
        for axis in 0..2 {
            let number = 2 * vertex + axis;
            let mass = 1.0 / inverse_mass[number];
            sums[sum][axis] += mass;
            if mass.is_finite() {
                sums[sum][2 + axis] += mass * (x[number] - start[number]);
                sums[sum][4 + axis] += mass * v[number];
            }
        }
    }
    for vertex in 0..connected.len() {
        let sum = first(connected, vertex);
        for axis in (0..2).filter(|_| sums[sum][6] > 1.0) {
            let number = 2 * vertex + axis;
            x[number] = start[number] + sums[sum][2 + axis] / sums[sum][axis];
            v[number] = sums[sum][4 + axis] / sums[sum][axis];
        }
    }
}
