//! Truncation of steps: where the skin is used up, displacements and velocities are changed so that no surfaces cross.
//!
//! In the plane a pair is a vertex and an edge; in space a vertex and a triangle, or two edges. Two such surfaces whose vertices
//! move along straight lines do not meet before the line or plane across their nearest points, which separates them, is reached by
//! one of them. Conservative advancement repeats that from there (Mirtich, *Impulse-based Dynamic
//! Simulation of Rigid Body Systems*, 1996, section 2.3), so that a pair it finds free has not met. The others are treated in
//! three ways, each where a few rounds of the one before do not suffice:
//!
//! 1. An inelastic impulse along the normal takes away the approach of each pair, in positions and velocities alike and in
//!    proportion to the inverse masses: it keeps linear momentum, and angular momentum where the pair does not slide.
//! 2. All vertices that such pairs connect move alike: their displacements and velocities become the means over their masses.
//!    This keeps linear momentum too, and never adds kinetic energy.
//! 3. Each vertex of a pair stays on its side of the line or plane halfway between them, a planar division of space, and its velocity is
//!    scaled as its displacement. Displacements only shrink, and a vertex that stays on its side once does so from then on, so
//!    that this ends; with no displacement left, nothing has crossed.
//!
//! Impulses may bring together pairs that were too far apart before, so that a second call with [`Means::Cuts`] ends the step.
//! Moved vertices may deform elements. If that gives more elastic energy than was lost, it is taken from the velocities of these
//! vertices relative to each other, and what they do not have from those of their bodies.

use super::{
    Candidate, Candidates, Pair,
    candidates::{Grid, Surfaces, greater, minus, spread},
    touch::{coordinates, dot, length},
};
use std::ops::Range;

/// Scratch for truncation.
#[derive(Clone, Debug, Default)]
pub struct Truncation {
    /// Pairs that may meet in the step.
    pairs: Vec<Pair>,
    /// Those that do.
    meeting: Vec<Pair>,
    /// What may meet an obstacle.
    pub found: Vec<Candidate>,
    /// Positions before a round of truncation at obstacles \[m\].
    pub before: Vec<f64>,
    /// All vertices that truncation moved in this step.
    pub moved: Vec<usize>,
    /// Fraction of its displacement that each vertex of the scene keeps.
    kept: Vec<f64>,
    /// Of each part, a bound on the deviations of its displacements from a common one \[m\].
    displaced: Vec<f64>,
    /// Scratch for the search of pairs farther apart than the candidates.
    search: Grid,
    /// A vertex that each vertex is connected to, itself if it is the first; and by first vertices the sums of their masses along
    /// each axis, of these times displacements and times velocities, and their number.
    connected: Vec<u32>,
    sums: Vec<([[f64; 3]; 3], usize)>,
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

/// Nearest points of two surfaces.
pub(super) struct Nearest<const D: usize, const N: usize> {
    /// Unit vector from the second one to the first.
    pub normal: [f64; D],
    /// Weights w, so that the distance is `normal . sum(w x)`: of one sign for each surface.
    pub weights: [f64; N],
    /// Distance \[m\].
    pub distance: f64,
}

/// Surfaces with D coordinates, pairs of which may meet: N vertices each.
pub(super) trait MeetingPairs<const D: usize, const N: usize> {
    /// Kind of surfaces.
    type All: Surfaces<D>;

    /// All surfaces.
    fn surfaces(&self) -> &Self::All;

    /// Distance within which candidates contain all pairs \[m\].
    fn near(&self) -> f64;

    /// Parts of both surfaces of a pair.
    fn parts(&self, pair: Pair) -> [u32; 2];

    /// Whether two parts do not touch.
    fn are_apart(&self, parts: [u32; 2]) -> bool;

    /// Whether contact may act between the surfaces of a pair.
    fn can_touch(&self, pair: Pair) -> bool;

    /// Thickness of the skin between the surfaces of a pair \[m\].
    fn thickness(&self, pair: Pair) -> f64;

    /// Numbers of the vertices of a pair.
    fn vertices(&self, pair: Pair) -> [usize; N];

    /// How many of them are of the first surface.
    fn first(&self, pair: Pair) -> usize;

    /// Nearest points of a pair at some positions of its vertices.
    fn nearest(&self, pair: Pair, points: [[f64; D]; N]) -> Nearest<D, N>;

    /// Fraction of a step from `start` to `x` at which a pair meets; `None` if it does not, or is free to pass.
    fn meeting(&self, start: &[f64], x: &[f64], pair: Pair) -> Option<f64>;

    /// Positions of the vertices of a pair.
    fn points(&self, x: &[f64], pair: Pair) -> [[f64; D]; N] {
        self.vertices(pair).map(|vertex| coordinates(x, vertex as u32))
    }

    /// Distances that a pair keeps in a step from `start`.
    fn clearance(&self, start: &[f64], pair: Pair) -> Clearance {
        let begins = self.nearest(pair, self.points(start, pair)).distance;
        Clearance::new(FLOOR * self.thickness(pair), begins, 0.0)
    }

    /// Fraction of a step from `start` to `x` at which a pair comes within its clearance; see [`advance`].
    fn advanced(&self, start: &[f64], x: &[f64], pair: Pair) -> Option<f64> {
        let (from, to) = (self.points(start, pair), self.points(x, pair));
        let nearest = |at| {
            let Nearest { normal, distance, .. } = self.nearest(pair, at);
            (normal, distance)
        };
        advance((from, to), self.first(pair), [0.0, self.clearance(start, pair).least], nearest)
    }

    /// Whether a pair is too far apart to meet in a step from `start` to x.
    fn is_far(&self, start: &[f64], x: &[f64], pair: Pair) -> bool {
        let (from, to) = (self.points(start, pair), self.points(x, pair));
        let moved = |i: usize| length(minus(to[i], from[i]));
        let farthest = |range: Range<usize>| range.map(moved).fold(0.0, greater);
        let first = self.first(pair);
        let reach = farthest(0..first) + farthest(first..N) + FLOOR * self.thickness(pair);
        !self.surfaces().is_within(start, pair, reach)
    }

    /// Finds all pairs that are near enough to each other to meet in a step from `start` to `x`.
    fn find_pairs(&self, scratch: &mut Truncation, candidates: &mut Candidates, start: &[f64], x: &[f64]) {
        let Truncation { pairs, displaced, search, .. } = scratch;
        let vertices = self.surfaces().vertices();
        let ends = [start, x].map(|at| at.as_chunks::<D>().0);
        let displacement = |_, vertex: u32| minus(ends[1][vertex as usize], ends[0][vertex as usize]);
        let farthest = 2.0 * spread(vertices, displacement, displaced);
        pairs.clear();
        if !farthest.is_finite() {
            return;
        }
        if farthest <= self.near() {
            candidates.update(self.surfaces(), start, self.near(), |pair| self.can_touch(pair));
            if candidates.are_apart(farthest + FLOOR * self.near()) {
                return;
            }
            let may_meet =
                |pair: &&Pair| self.surfaces().is_within(start, **pair, farthest + FLOOR * self.thickness(**pair));
            pairs.extend(candidates.pairs().iter().filter(may_meet));
        } else {
            self.surfaces().find_swept(search, [start, x], (farthest, self.near()), pairs);
            pairs.retain(|pair| {
                let [one, other] = self.parts(*pair);
                let reach = 2.0 * displaced[one as usize];
                one != other || self.nearest(*pair, self.points(start, *pair)).distance <= reach
            });
        }
        pairs.retain(|pair| !self.are_apart(self.parts(*pair)));
    }

    /// Largest multiple of the displacement from positions x to `end` \[m\] in which no surfaces meet.
    fn longest_step(&self, scratch: &mut Truncation, candidates: &mut Candidates, x: &[f64], end: &[f64]) -> f64 {
        self.find_pairs(scratch, candidates, x, end);
        scratch.pairs.iter().filter_map(|pair| self.meeting(x, end, *pair)).fold(f64::INFINITY, f64::min)
    }

    /// Whether a step from `start` to x \[m\] has pairs that meet.
    fn meets(&self, scratch: &mut Truncation, candidates: &mut Candidates, start: &[f64], x: &[f64]) -> bool {
        self.find_pairs(scratch, candidates, start, x);
        scratch.pairs.iter().any(|pair| self.meeting(start, x, *pair).is_some())
    }

    /// Changes positions and velocities at the end of a step from `start` so that no surfaces have crossed. Returns the
    /// number of pairs that met.
    fn truncate(
        &self,
        (scratch, candidates): (&mut Truncation, &mut Candidates),
        means: Means,
        (start, inverse_mass): (&[f64], &[f64]),
        [x, v]: [&mut [f64]; 2],
    ) -> usize {
        self.find_pairs(scratch, candidates, start, x);
        let Truncation { pairs, meeting, moved, connected, sums, .. } = &mut *scratch;
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
            connected.extend(0..(x.len() / D) as u32);
            for _ in 0..COMMON {
                touch(meeting);
                for pair in &*meeting {
                    connect(connected, self.vertices(*pair));
                }
                unite::<D>(connected, sums, (start, inverse_mass), [&mut *x, &mut *v]);
                self.find_meeting(pairs, start, x, meeting);
                if meeting.is_empty() {
                    return count;
                }
            }
        }
        self.cut((scratch, candidates), start, [x, v]);
        count
    }

    /// Cuts the displacements of pairs that meet until none do. A cut may bring together what moved alike before, so that pairs are
    /// found anew until there are none.
    fn cut(&self, (scratch, candidates): (&mut Truncation, &mut Candidates), start: &[f64], [x, v]: [&mut [f64]; 2]) {
        for round in 0.. {
            let Truncation { pairs, meeting, moved, kept, .. } = &mut *scratch;
            kept.clear();
            kept.resize(x.len() / D, 1.0);
            moved.extend(meeting.iter().flat_map(|pair| self.vertices(*pair)));
            for pair in &*meeting {
                self.divide(start, x, *pair, kept, round >= CUTS);
            }
            let mut has_moved = false;
            for (vertex, kept) in kept.iter().enumerate().filter(|(_, kept)| **kept < 1.0) {
                for number in D * vertex..D * vertex + D {
                    has_moved |= x[number] != start[number];
                    x[number] = start[number] + kept * (x[number] - start[number]);
                    v[number] *= kept;
                }
            }
            self.find_meeting(pairs, start, x, meeting);
            if meeting.is_empty() {
                self.find_pairs(scratch, candidates, start, x);
                let Truncation { pairs, meeting, .. } = &mut *scratch;
                self.find_meeting(pairs, start, x, meeting);
            }
            // What meets with every vertex at its start was beyond repair before the step. Numbers that are not finite never return there.
            if scratch.meeting.is_empty() || round > CUTS && (!has_moved || round > CUTS + x.len() / D) {
                break;
            }
        }
    }

    /// Writes those of some pairs that meet.
    fn find_meeting(&self, pairs: &[Pair], start: &[f64], x: &[f64], found: &mut Vec<Pair>) {
        found.clear();
        found.extend(pairs.iter().filter(|pair| self.meeting(start, x, **pair).is_some()));
    }

    /// Takes away the approach of a pair along the normal where it meets, beyond the distance that it keeps.
    fn stop(&self, start: &[f64], inverse_mass: &[f64], [x, v]: [&mut [f64]; 2], pair: Pair) {
        let Some(share) = self.advanced(start, x, pair) else { return };
        let (from, to) = (self.points(start, pair), self.points(x, pair));
        let clearance = self.clearance(start, pair);
        let Nearest { normal, weights, .. } = self.nearest(pair, between(from, to, share));
        let vertices = self.vertices(pair);
        let along =
            |of: &[f64]| (0..N).map(|i| weights[i] * dot(normal, coordinates(of, vertices[i] as u32))).sum::<f64>();
        let square = normal.map(|n| n * n);
        let inverse = |i: usize| dot(square, coordinates(inverse_mass, vertices[i] as u32));
        let mobility: f64 = (0..N).map(|i| weights[i] * weights[i] * inverse(i)).sum();
        if mobility.is_nan() || mobility <= 0.0 {
            return;
        }
        let missing = (clearance.wanted - along(x)).max(0.0);
        let approach = (-along(v)).max(0.0);
        for (values, wanted) in [(x, missing), (v, approach)] {
            for i in 0..N {
                let change = weights[i] * wanted / mobility;
                for (axis, normal) in normal.iter().enumerate() {
                    let number = D * vertices[i] + axis;
                    values[number] += change * normal * inverse_mass[number];
                }
            }
        }
    }

    /// Cuts the displacements of a pair at the line or plane halfway between them at the start, or to nothing.
    fn divide(&self, start: &[f64], x: &[f64], pair: Pair, kept: &mut [f64], entirely: bool) {
        let points = self.points(start, pair);
        let Nearest { normal, weights, distance } = self.nearest(pair, points);
        let first = self.first(pair);
        // Positions along the normal of the nearest points of both surfaces.
        let near = (0..first).map(|i| weights[i] * dot(normal, points[i])).sum::<f64>();
        let margin = 0.5 * (distance - self.clearance(start, pair).least);
        for (i, vertex) in self.vertices(pair).into_iter().enumerate() {
            // A vertex may approach the other surface by the margin, and by more as far as it is behind the nearest point.
            let along = dot(normal, points[i]);
            let (sign, behind) = if i < first { (-1.0, along - near) } else { (1.0, near - distance - along) };
            let approach = sign * (dot(normal, coordinates(x, vertex as u32)) - along);
            let limit = if entirely { 0.0 } else { (margin + behind.max(0.0)) / approach };
            if approach > 0.0 && limit < kept[vertex] || entirely {
                kept[vertex] = limit.max(0.0);
            }
        }
    }
}

/// Points between those at the start and at the end of a step.
fn between<const D: usize, const N: usize>(from: [[f64; D]; N], to: [[f64; D]; N], share: f64) -> [[f64; D]; N] {
    std::array::from_fn(|i| std::array::from_fn(|axis| from[i][axis] + share * (to[i][axis] - from[i][axis])))
}

/// Fraction of the displacement at which two surfaces come within a radius and a distance \[m\]; `None` if they stay
/// farther than the radius and half of the distance apart all the way. The first of their points are of one of them; `nearest`
/// gives the normal and the distance.
pub(super) fn advance<const D: usize, const N: usize>(
    (from, to): ([[f64; D]; N], [[f64; D]; N]),
    first: usize,
    [radius, distance]: [f64; 2],
    nearest: impl Fn([[f64; D]; N]) -> ([f64; D], f64),
) -> Option<f64> {
    let mut share = 0.0;
    for _ in 0..ADVANCES {
        let at = between(from, to, share);
        let (normal, gap) = nearest(at);
        if gap <= radius + distance || gap.is_nan() {
            return Some(share);
        }
        let mut next = f64::INFINITY;
        for one in 0..first {
            for other in first..N {
                let apart = dot(normal, minus(at[one], at[other]));
                let rate = minus(minus(to[other], from[other]), minus(to[one], from[one]));
                let approach = dot(normal, rate);
                if approach > 0.0 {
                    next = f64::min(next, (apart - radius - distance + 0.5 * distance.abs()) / approach);
                }
            }
        }
        share += next;
        if share >= 1.0 {
            return None;
        }
    }
    Some(share)
}

impl Truncation {
    /// Takes kinetic energy \[J\] from the vertices that were moved, as far as they have it relative to each
    /// other, and the rest from their whole bodies, whose vertices `parts` gives: mean velocities stay.
    pub fn dissipate(
        &mut self,
        energy: f64,
        [mass, inverse_mass]: [&[f64]; 2],
        (dimension, parts): (usize, impl Iterator<Item = Range<usize>>),
        v: &mut [f64],
    ) {
        let Self { moved, .. } = self;
        moved.sort_unstable();
        moved.dedup();
        let left = dissipate(energy, [mass, inverse_mass], (dimension, moved), v);
        if left > 0.0 {
            let found = moved.len();
            for part in parts {
                if moved[..found].iter().any(|vertex| part.contains(vertex)) {
                    moved.extend(part);
                }
            }
            dissipate(left, [mass, inverse_mass], (dimension, &moved[found..]), v);
        }
    }
}

/// Takes kinetic energy \[J\] from the motion of some vertices relative to each other; returns what they do not have.
fn dissipate(
    energy: f64,
    [mass, inverse_mass]: [&[f64]; 2],
    (dimension, vertices): (usize, &[usize]),
    v: &mut [f64],
) -> f64 {
    let along = |axis: usize| {
        let numbers = vertices.iter().map(move |vertex| dimension * vertex + axis);
        numbers.filter(|number| inverse_mass[*number] != 0.0)
    };
    let means = [0, 1, 2].map(|axis| {
        if axis >= dimension {
            return 0.0;
        }
        let sums = along(axis).map(|number| [mass[number], mass[number] * v[number]]);
        let [total, momentum] = sums.fold([0.0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
        if total > 0.0 { momentum / total } else { 0.0 }
    });
    let relative = |axis: usize| {
        let square = |number: usize| (v[number] - means[axis]) * (v[number] - means[axis]);
        along(axis).map(|number| 0.5 * mass[number] * square(number)).sum::<f64>()
    };
    let there = (0..dimension).map(relative).sum::<f64>();
    let share = if energy < there { (1.0 - energy / there).sqrt() } else { 0.0 };
    for (axis, mean) in means.into_iter().enumerate().take(dimension) {
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
fn connect<const N: usize>(connected: &mut [u32], vertices: [usize; N]) {
    let all = vertices.map(|vertex| first(connected, vertex));
    let least = all.into_iter().fold(usize::MAX, usize::min);
    for vertex in all {
        connected[vertex] = least as u32;
    }
}

/// Gives connected vertices their mean displacement and velocity over their masses: none where one of them is held.
fn unite<const D: usize>(
    connected: &mut [u32],
    sums: &mut Vec<([[f64; 3]; 3], usize)>,
    (start, inverse_mass): (&[f64], &[f64]),
    [x, v]: [&mut [f64]; 2],
) {
    sums.clear();
    sums.resize(connected.len(), ([[0.0; 3]; 3], 0));
    for vertex in 0..connected.len() {
        let ([masses, displacements, momenta], count) = &mut sums[first(connected, vertex)];
        *count += 1;
        for axis in 0..D {
            let number = D * vertex + axis;
            let mass = 1.0 / inverse_mass[number];
            masses[axis] += mass;
            if mass.is_finite() {
                displacements[axis] += mass * (x[number] - start[number]);
                momenta[axis] += mass * v[number];
            }
        }
    }
    for vertex in 0..connected.len() {
        let ([masses, displacements, momenta], count) = sums[first(connected, vertex)];
        for axis in (0..D).filter(|_| count > 1) {
            let number = D * vertex + axis;
            x[number] = start[number] + displacements[axis] / masses[axis];
            v[number] = momenta[axis] / masses[axis];
        }
    }
}
