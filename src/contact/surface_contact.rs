//! Contact of the boundaries of bodies with each other and with themselves, and of the particles of nets with bodies.

use super::{
    Anchor, Candidates, ContactName, ContactTerm, Curvature, Pair, Place, Potential, Skin, SurfaceEdge, SurfaceVertex,
    SurfaceVertices, Touch,
    candidates::squared_distance,
    count_crossings,
    touch::{length, vector},
};
use crate::{
    effects::{Motion, NO_OBSTACLE_NEAR},
    solvers::{SparseMatrix, Weights},
};
use std::sync::Arc;

/// Contact of vertices that have a skin with the edges of boundaries.
///
/// A vertex touches an edge that it is outside of and nearer to than the thickness of the skin, or the corner between two edges.
/// Along a boundary the gap is the distance from it: where two edges are equally near, the sum over edges less the term of their
/// corner makes the energy continuously differentiable (Li et al., *Convergent Incremental Potential Contact*, 2023). Between
/// two bodies the vertices of both touch the edges of the other; each half counts.
pub struct SurfaceContact {
    /// Number of the effect in the scene.
    number: u32,
    skin: Skin,
    /// mu.
    friction: f64,
    surface: Arc<SurfaceVertices>,
    /// Potential between each two parts.
    potentials: Vec<Potential>,
    /// Pairs of a part that are within their skin at rest, which do not touch.
    excluded: Vec<Pair>,
    /// Greatest thickness of the skin \[m\].
    reach: f64,
}

/// A vertex relative to an edge.
#[derive(Clone, Copy)]
struct Seen {
    /// Position of the nearest point of the line along the edge: 0 to 1 within it.
    share: f64,
    /// Distance from the line, positive outside of the body \[m\].
    distance: f64,
    /// Unit vector from the first to the second end, and length of the edge \[m\].
    along: [f64; 2],
    length: f64,
}

impl Seen {
    fn new(x: &[f64], edge: &SurfaceEdge, [px, py]: [f64; 2]) -> Self {
        let [[ax, ay], [bx, by]] = edge.ends.map(|end| vector(x, end));
        let length = length([bx - ax, by - ay]);
        let [ex, ey] = [(bx - ax) / length, (by - ay) / length];
        let (px, py) = (px - ax, py - ay);
        Self { share: (px * ex + py * ey) / length, distance: px * ey - py * ex, along: [ex, ey], length }
    }

    /// The outward unit normal.
    const fn normal(&self) -> [f64; 2] {
        let [ex, ey] = self.along;
        [ey, -ex]
    }
}

/// Depth at which a vertex inside another body still touches, as a fraction of the thickness of the skin.
const DEPTH: f64 = 0.5;

/// Distance within which pairs have blocks in the matrix, as a multiple of the thickness of the skin.
const NEAR: f64 = 1.1;

impl SurfaceContact {
    /// Contact of all surfaces, where they have a skin and friction; `rest` are the positions at rest \[m\].
    pub fn new((skin, friction): (Skin, f64), surface: &Arc<SurfaceVertices>, rest: &[f64]) -> Self {
        let parts = surface.parts();
        let between = |at: usize| surface.potential_between(skin, [at / parts, at % parts]);
        let potentials: Vec<_> = (0..parts * parts).map(between).collect();
        let reach = potentials.iter().map(|potential| potential.thickness).fold(0.0, f64::max);
        let surface = Arc::clone(surface);
        let mut contact = Self { number: 0, skin, friction, surface, potentials, excluded: Vec::new(), reach };
        let mut near = Vec::new();
        Candidates::default().find(&contact.surface, rest, reach, &mut near);
        near.retain(|pair| {
            let (edge, vertex) = contact.members(*pair);
            let within = contact.potential(edge.part, vertex.part).thickness;
            edge.part == vertex.part && contact.distance(rest, *pair) < within
        });
        contact.excluded = near;
        contact
    }

    /// Whether nothing can touch: a single body that is convex may still fold, so that only nets alone cannot.
    pub fn is_empty(&self) -> bool {
        self.surface.edges().is_empty()
    }

    /// Number of crossings at positions x \[m\]; see [`count_crossings`].
    pub fn count_crossings(&self, x: &[f64]) -> usize {
        count_crossings(&self.surface, x)
    }

    /// Tells it the number of its effect in the scene.
    pub const fn set_number(&mut self, number: usize) {
        self.number = number as u32;
    }

    /// The surfaces.
    pub(super) fn surface(&self) -> &SurfaceVertices {
        &self.surface
    }

    /// Distance within which candidates contain all pairs \[m\].
    pub(super) fn near(&self) -> f64 {
        NEAR * self.reach
    }

    /// The edge and the vertex of a pair.
    pub(super) fn members(&self, [edge, vertex]: Pair) -> (&SurfaceEdge, &SurfaceVertex) {
        (&self.surface.edges()[edge as usize], self.surface.at(vertex))
    }

    /// Potential between two parts.
    pub(super) fn potential(&self, one: u32, other: u32) -> Potential {
        self.potentials[one as usize * self.surface.parts() + other as usize]
    }

    /// Distance of a pair \[m\].
    fn distance(&self, x: &[f64], pair: Pair) -> f64 {
        let (edge, vertex) = self.members(pair);
        let point = vector(x, vertex.vertex);
        let seen = Seen::new(x, edge, point);
        if seen.share > 0.0 && seen.share < 1.0 {
            return seen.distance.abs();
        }
        let [px, py] = vector(x, edge.ends[usize::from(seen.share >= 1.0)]);
        length([point[0] - px, point[1] - py])
    }

    /// Whether an edge and a vertex can touch.
    fn can_touch(&self, pair: Pair) -> bool {
        let (edge, vertex) = self.members(pair);
        !edge.ends.contains(&vertex.vertex) && self.excluded.binary_search(&pair).is_err()
    }

    /// Whether the vertex of a pair is not inside another body, as far as the edge tells.
    pub(super) fn is_outside(&self, x: &[f64], pair: Pair) -> bool {
        let (edge, vertex) = self.members(pair);
        if edge.part == vertex.part {
            return true;
        }
        let point = vector(x, vertex.vertex);
        let seen = Seen::new(x, edge, point);
        if seen.share > 0.0 && seen.share < 1.0 {
            return seen.distance > 0.0;
        }
        let end = usize::from(seen.share >= 1.0);
        let beyond = Seen::new(x, &self.surface.edges()[edge.neighbours[end] as usize], point);
        seen.distance > 0.0 && beyond.distance > 0.0
    }

    /// Makes the candidates contain all pairs that may touch at positions x \[m\] with this memory of contacts.
    pub fn update(&self, candidates: &mut Candidates, x: &[f64], anchors: &[Anchor]) {
        let deepest = self.own_anchors(anchors).iter().map(|anchor| anchor.penetration).fold(0.0, f64::max);
        candidates.update(&self.surface, x, self.near() + deepest);
    }

    /// Adds the pairs that are near at positions x \[m\], in their order: a function of the positions alone.
    pub fn add_near(&self, candidates: &Candidates, x: &[f64], near: &mut Vec<Pair>) {
        let is_near = |pair: &&Pair| self.can_touch(**pair) && self.distance(x, **pair) < self.near();
        near.extend(candidates.pairs().iter().filter(is_near));
    }

    /// Sparsity pattern of some pairs: calls `add` with each two of their vertices.
    pub fn sparsity_pattern(&self, pairs: &[Pair], add: &mut dyn FnMut(u32, u32)) {
        for pair in pairs {
            let (SurfaceEdge { ends: [a, b], .. }, vertex) = self.members(*pair);
            add(vertex.vertex, *a);
            add(vertex.vertex, *b);
            add(*a, *b);
        }
    }

    /// Calls `act` for everything that touches in some pairs. Most of them are too far apart.
    fn each_of_all(&self, motion: Motion<'_>, pairs: &[Pair], act: &mut dyn FnMut(Pair, &Touch)) {
        let anchors = self.own_anchors(motion.anchors);
        let motion = Motion { anchors, ..motion };
        let deepest = anchors.iter().map(|anchor| anchor.penetration).fold(0.0, f64::max);
        let within = (self.reach + deepest) * (self.reach + deepest);
        for pair in pairs.iter().filter(|pair| squared_distance(&self.surface, motion.x, **pair) < within) {
            self.each_of(motion, *pair, &mut |touch| act(*pair, touch));
        }
    }

    /// Calls `act` for everything that touches in a pair.
    fn each_of(&self, motion: Motion<'_>, pair: Pair, act: &mut dyn FnMut(&Touch)) {
        let (edge, vertex) = self.members(pair);
        if !self.can_touch(pair) {
            return;
        }
        let (point, potential) = (vector(motion.x, vertex.vertex), self.potential(edge.part, vertex.part));
        let seen = Seen::new(motion.x, edge, point);
        let own = edge.part == vertex.part;
        // A vertex inside its own body may be next to the opposite boundary; one that began inside another body is let out.
        let penetration = || self.kept(motion, pair).map_or(0.0, |anchor| anchor.penetration);
        let deepest = match seen.distance {
            0.0.. => 0.0,
            _ if own => 0.0,
            _ => -DEPTH * potential.thickness - penetration(),
        };
        let outside = |seen: &Seen| seen.distance > deepest;
        let within = |seen: &Seen| seen.share > 0.0 && seen.share < 1.0;
        let is_nearest = |other: u32| {
            let other = Seen::new(motion.x, &self.surface.edges()[other as usize], point);
            !within(&other) || other.distance <= seen.distance
        };
        // Inside a body only the nearest edge pushes.
        let acts = outside(&seen) && (seen.distance > 0.0 || edge.neighbours.into_iter().all(is_nearest));
        if within(&seen) && acts && seen.distance < potential.thickness {
            act(&self.at_edge(motion, pair, &seen));
        }
        let [before, after] = edge.neighbours;
        let next = Some([after, pair[1]]).filter(|pair| self.can_touch(*pair));
        let next = next.map(|pair| Seen::new(motion.x, &self.surface.edges()[pair[0] as usize], point));
        // The corner at the end belongs to this edge, and that at the start only if the edge before cannot touch.
        let (at_end, at_start) = (seen.share >= 1.0, seen.share <= 0.0);
        match next {
            Some(next) if at_end && next.share <= 0.0 => {
                self.at_corner(motion, pair, (1, [seen.normal(), next.normal()]), 1.0, act);
            }
            Some(next) if within(&seen) && within(&next) && seen.distance.min(next.distance) > 0.0 => {
                self.at_corner(motion, pair, (1, [seen.normal(), next.normal()]), -1.0, act);
            }
            None if at_end => self.at_corner(motion, pair, (1, [seen.normal(); 2]), 1.0, act),
            _ => {}
        }
        if at_start && !self.can_touch([before, pair[1]]) {
            self.at_corner(motion, pair, (0, [seen.normal(); 2]), 1.0, act);
        }
    }

    /// A vertex that touches an edge between its ends.
    fn at_edge(&self, motion: Motion<'_>, pair: Pair, seen: &Seen) -> Touch {
        let (edge, vertex) = self.members(pair);
        let (t, [ex, ey], [nx, ny]) = (seen.share, seen.along, seen.normal());
        let weights = [1.0, t - 1.0, -t];
        // The slip is the length times the derivative of the share.
        let turn = seen.distance / seen.length;
        let slip = |w: f64, d: f64| [w * ex + d * turn * nx, w * ey + d * turn * ny];
        let slips = [slip(1.0, 0.0), slip(weights[1], -1.0), slip(weights[2], 1.0)];
        let [a, b] = edge.ends;
        self.touch(
            motion,
            pair,
            Touch {
                vertices: [vertex.vertex, a, b],
                count: 3,
                weights,
                normal: [nx, ny],
                slips,
                gap: seen.distance,
                curvature: Curvature::Edge(seen.length),
                place: Place::Loop {
                    along: edge.arc[0] + t * edge.length,
                    around: edge.arc[1],
                    stretch: seen.length / edge.length,
                },
                ..self.blank(pair)
            },
        )
    }

    /// Calls `act` with a vertex near the corner at an end of an edge, if it is outside of the edges with these normals.
    fn at_corner(
        &self,
        motion: Motion<'_>,
        pair: Pair,
        (end, normals): (usize, [[f64; 2]; 2]),
        sign: f64,
        act: &mut dyn FnMut(&Touch),
    ) {
        let (edge, vertex) = self.members(pair);
        let corner = edge.ends[end];
        let ([px, py], [cx, cy]) = (vector(motion.x, vertex.vertex), vector(motion.x, corner));
        let (dx, dy) = (px - cx, py - cy);
        let gap = length([dx, dy]);
        let outward = normals.iter().map(|[nx, ny]| nx * dx + ny * dy).sum::<f64>();
        let is_outside = outward > 0.0 || sign < 0.0;
        if !(is_outside && gap > 0.0 && gap < self.potential(edge.part, vertex.part).thickness) {
            return;
        }
        let [nx, ny] = [dx / gap, dy / gap];
        let along = [-ny, nx];
        // The edge turns with the corner, so that friction has no moment.
        let [ax, ay] = vector(motion.x, edge.ends[0]);
        let [bx, by] = vector(motion.x, edge.ends[1]);
        let square = (bx - ax) * (bx - ax) + (by - ay) * (by - ay);
        let turn = [gap * (by - ay) / square, gap * (ax - bx) / square];
        let mut slips = [along, [-turn[0], -turn[1]], turn];
        slips[1 + end][0] -= along[0];
        slips[1 + end][1] -= along[1];
        let mut weights = [1.0, 0.0, 0.0];
        weights[1 + end] = -1.0;
        let blank = self.blank(pair);
        act(&self.touch(
            motion,
            pair,
            Touch {
                vertices: [vertex.vertex, edge.ends[0], edge.ends[1]],
                count: 3,
                weights,
                normal: [nx, ny],
                slips,
                area: sign * blank.area,
                gap,
                curvature: Curvature::Points,
                place: Place::Loop { along: edge.arc[0] + end as f64 * edge.length, around: edge.arc[1], stretch: 1.0 },
                ..blank
            },
        ));
    }

    /// What all contacts of a pair have in common.
    fn blank(&self, pair: Pair) -> Touch {
        let (edge, vertex) = self.members(pair);
        // Between bodies each side counts half; the particles of nets have no edges that would count the other half.
        let share = if self.surface.is_body(vertex.part) { 0.5 } else { 1.0 };
        Touch {
            name: ContactName { effect: self.number, surface: pair[0], vertex: vertex.vertex },
            vertices: [vertex.vertex; 3],
            count: 0,
            weights: [0.0; 3],
            normal: [0.0; 2],
            slips: [[0.0; 2]; 3],
            area: share * vertex.area,
            potential: self.potential(edge.part, vertex.part),
            dissipation: self.skin.dissipation,
            friction: self.friction,
            depenetration_speed: vertex.depenetration_speed,
            gap: 0.0,
            approach: 0.0,
            sliding: 0.0,
            obstacle_velocity: [0.0; 2],
            curvature: Curvature::Flat,
            place: Place::Loop { along: 0.0, around: 1.0, stretch: 1.0 },
            memory: None,
            kept: None,
        }
    }

    /// Completes a contact: velocities, and its memory or that of the next edge that the vertex came from.
    fn touch(&self, motion: Motion<'_>, pair: Pair, mut touch: Touch) -> Touch {
        let [nx, ny] = touch.normal;
        for i in 0..touch.count {
            let [vx, vy] = vector(motion.v, touch.vertices[i]);
            touch.approach += touch.weights[i] * (nx * vx + ny * vy);
            touch.sliding += touch.slips[i][0] * vx + touch.slips[i][1] * vy;
        }
        if let Some(anchor) = self.kept(motion, pair) {
            touch.remember(anchor);
        }
        touch
    }

    /// Memory of a vertex at an edge, or at the edge that it came from.
    fn kept(&self, motion: Motion<'_>, [edge, vertex]: Pair) -> Option<Anchor> {
        let [before, after] = self.surface.edges()[edge as usize].neighbours;
        [edge, before, after].into_iter().find_map(|surface| {
            let name = ContactName { effect: self.number, surface, vertex: self.surface.at(vertex).vertex };
            let at = motion.anchors.binary_search_by(|anchor| anchor.contact.cmp(&name)).ok()?;
            Some(motion.anchors[at])
        })
    }

    /// The anchors of this contact.
    fn own_anchors<'a>(&self, anchors: &'a [Anchor]) -> &'a [Anchor] {
        let place = |effect: u32| anchors.partition_point(|anchor| anchor.contact.effect < effect);
        &anchors[place(self.number)..place(self.number + 1)]
    }

    /// Pairs of each vertex that is inside another body with the nearest edge of that body.
    fn inside(&self, x: &[f64]) -> Vec<Pair> {
        let all = 0..self.surface.edges().len() as u32;
        let mut found = Vec::new();
        for (place, vertex) in self.surface.iter().enumerate() {
            for part in (0..self.surface.parts() as u32).filter(|part| *part != vertex.part) {
                let own = |edge: &u32| self.surface.edges()[*edge as usize].part == part;
                let Some(first) = all.clone().find(own) else { continue };
                if self.is_inside(x, [first, place as u32]) {
                    let pairs = all.clone().filter(own).map(|edge| [edge, place as u32]);
                    found.extend(pairs.min_by(|a, b| self.distance(x, *a).total_cmp(&self.distance(x, *b))));
                }
            }
        }
        found
    }

    /// Calls `act` with the numbers of the bodies or nets of each pair that presses on each other.
    pub fn each_pressing(&self, motion: Motion<'_>, act: &mut dyn FnMut([usize; 2])) {
        self.with_candidates(motion, |pairs| {
            self.each_of_all(motion, pairs, &mut |pair, touch| {
                if touch.pressure() > 0.0 {
                    let (edge, vertex) = self.members(pair);
                    act([edge.part, vertex.part].map(|part| self.surface.owner(part)));
                }
            });
        });
    }

    /// Calls `act` for each pair of candidates at the positions of a motion.
    fn with_candidates(&self, motion: Motion<'_>, act: impl FnOnce(&[Pair])) {
        if let Some(candidates) = motion.candidates {
            return act(candidates.pairs());
        }
        let mut candidates = Candidates::default();
        self.update(&mut candidates, motion.x, motion.anchors);
        act(candidates.pairs());
    }
}

impl ContactTerm for SurfaceContact {
    fn each(&self, motion: Motion<'_>, act: &mut dyn FnMut(&Touch)) {
        self.with_candidates(motion, |pairs| self.each_of_all(motion, pairs, &mut |_, touch| act(touch)));
    }

    fn each_at_start(&self, motion: Motion<'_>, act: &mut dyn FnMut(&Touch)) {
        self.each(motion, act);
        for pair in self.inside(motion.x) {
            let (edge, vertex) = self.members(pair);
            let seen = Seen::new(motion.x, edge, vector(motion.x, vertex.vertex));
            if seen.share > 0.0 && seen.share < 1.0 && seen.distance < 0.0 {
                act(&self.at_edge(motion, pair, &seen));
            }
        }
    }

    /// A pair takes part with both masses, which can double the square.
    fn square_frequency(&self, motion: Motion<'_>) -> f64 {
        let parts = self.surface.parts();
        let square = |vertex: &SurfaceVertex| {
            let inverse = vector(motion.inverse_mass, vertex.vertex);
            let stiffness = (0..parts).map(|part| self.potential(vertex.part, part as u32).greatest_stiffness());
            2.0 * vertex.area * stiffness.fold(0.0, f64::max) * inverse[0].max(inverse[1])
        };
        if self.is_empty() { 0.0 } else { self.surface.iter().map(square).fold(0.0, f64::max) }
    }

    fn idle(&self, motion: Motion<'_>) -> Option<&'static str> {
        let mut none = true;
        self.with_candidates(motion, |pairs| none = pairs.is_empty());
        none.then_some(NO_OBSTACLE_NEAR)
    }

    /// Adds three blocks for each pair of the pattern, whether it touches or not.
    fn add_stiffness(&self, motion: Motion<'_>, weights: Weights, matrix: &mut dyn SparseMatrix) {
        let Some(matrix) = matrix.blocks::<2>() else { return };
        for pair in motion.pattern {
            let mut blocks = [nalgebra::Matrix2::zeros(); 3];
            self.each_of(motion, *pair, &mut |touch| {
                let linearised = touch.linearised(weights);
                for (i, vertex) in touch.vertices.iter().enumerate() {
                    matrix.diagonal(*vertex as usize, &linearised.block(i, i));
                }
                for (block, [i, j]) in blocks.iter_mut().zip([[0, 1], [0, 2], [1, 2]]) {
                    *block += linearised.block(i, j);
                }
            });
            for block in &blocks {
                matrix.off_diagonal(block);
            }
        }
    }
}
