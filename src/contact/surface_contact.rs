//! Contact of the boundaries of bodies with each other and with themselves, and of the particles of nets with bodies.

use super::{
    Anchor, AnyContact, Candidates, ContactModel, ContactName, ContactParameters, ContactTerm, Means, Members, Overlap,
    Pair, Skin, SurfaceEdge, SurfaceTerm, SurfaceVertex, SurfaceVertices, Touch, Truncation,
    candidates::{Grid, Surfaces as _},
    count_crossings,
    edge_query::{DEPTH, EdgeQuery, Seen},
    friction::{anchor_of, anchors_of, penetration_of},
    stencil::Stencil,
    surface_term::{Between, with_candidates},
    touch::{length, vector},
    truncation::MeetingPairs,
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
#[derive(Clone)]
pub struct SurfaceContact {
    /// Number of the effect in the scene.
    number: u32,
    skin: Skin,
    surface: Arc<SurfaceVertices>,
    /// What holds between each two parts.
    between: Vec<Between>,
    /// Pairs of a part that are within their skin at rest, which do not touch.
    excluded: Vec<Pair>,
    /// Where those of each edge begin, and their number.
    excluded_from: Vec<usize>,
    /// Greatest thickness of the skin \[m\].
    reach: f64,
}

/// Distance within which pairs have blocks in the matrix, as a multiple of the thickness of the skin.
const NEAR: f64 = 1.1;

impl SurfaceContact {
    /// Contact of all surfaces with this model; `rest` are the positions at rest \[m\].
    pub fn new(model: &ContactModel, surface: &Arc<SurfaceVertices>, rest: &[f64]) -> Self {
        let skin = model.skin;
        let between = Between::all(model, surface);
        let reach = between.iter().map(|pair| pair.potential.thickness).fold(0.0, f64::max);
        let surface = Arc::clone(surface);
        let mut contact =
            Self { number: 0, skin, surface, between, excluded: Vec::new(), excluded_from: Vec::new(), reach };
        let mut near = Vec::new();
        contact.surface.find(&mut Grid::default(), rest, reach, &mut near);
        near.retain(|pair| {
            let [one, other] = contact.parts(*pair);
            one == other && contact.distance(rest, *pair) < contact.thickness(*pair)
        });
        let edges = 0..=contact.surface.edges().len() as u32;
        contact.excluded_from = edges.map(|edge| near.partition_point(|pair| pair[0] < edge)).collect();
        contact.excluded = near;
        contact
    }

    /// Whether nothing can touch: a single body that is convex may still fold, so that only nets alone cannot.
    pub fn is_empty(&self) -> bool {
        self.surface.edges().is_empty()
    }

    /// The surfaces.
    pub(super) fn surface(&self) -> &SurfaceVertices {
        &self.surface
    }

    /// Distance within which candidates contain all pairs \[m\].
    pub(super) fn reach(&self) -> f64 {
        NEAR * self.reach
    }

    /// The edge and the vertex of a pair.
    pub(super) fn members(&self, [edge, vertex]: Pair) -> (&SurfaceEdge, &SurfaceVertex) {
        (&self.surface.edges()[edge as usize], self.surface.at(vertex))
    }

    /// What holds between two parts.
    pub(super) fn between(&self, one: u32, other: u32) -> &Between {
        &self.between[one as usize * self.surface.parts() + other as usize]
    }

    /// Distance of a pair \[m\].
    pub(super) fn distance(&self, x: &[f64], pair: Pair) -> f64 {
        let (edge, vertex) = self.members(pair);
        let point = vector(x, vertex.vertex);
        let seen = Seen::new(x, edge, point);
        if seen.is_within() {
            return seen.distance.abs();
        }
        let [px, py] = vector(x, edge.ends[usize::from(seen.share >= 1.0)]);
        length([point[0] - px, point[1] - py])
    }

    /// Pairs of an edge that are within their skin at rest, which do not touch.
    pub(super) fn excluded(&self, edge: u32) -> &[Pair] {
        let edge = edge as usize;
        &self.excluded[self.excluded_from[edge]..self.excluded_from[edge + 1]]
    }

    /// Whether the vertex of a pair is inside the part of the edge.
    pub(super) fn is_inside(&self, x: &[f64], pair: Pair) -> bool {
        let (edge, vertex) = self.members(pair);
        self.surface.is_inside(edge.part, |end| vector(x, end), vector(x, vertex.vertex))
    }

    /// Whether the vertex of a pair is not inside another body, as far as the edge tells.
    pub(super) fn is_outside(&self, x: &[f64], pair: Pair) -> bool {
        let (edge, vertex) = self.members(pair);
        if edge.part == vertex.part {
            return true;
        }
        let point = vector(x, vertex.vertex);
        let seen = Seen::new(x, edge, point);
        if seen.is_within() {
            return seen.distance > 0.0;
        }
        let end = usize::from(seen.share >= 1.0);
        let beyond = Seen::new(x, &self.surface.edges()[edge.neighbours[end] as usize], point);
        seen.distance > 0.0 && beyond.distance > 0.0
    }

    /// Calls `act` for everything that touches in the candidates. Most of them are too far apart.
    fn each_of_all(&self, motion: Motion<'_>, candidates: &Candidates, act: &mut dyn FnMut(Pair, &Touch)) {
        /// Far more than the round-off of a distance.
        const SLACK: f64 = 1.0 + 1e-9;
        let motion = Motion { anchors: self.own_anchors(motion.anchors), ..motion };
        let is_near = |pair: Pair| self.surface.is_within(motion.x, pair, SLACK * self.thickness(pair));
        candidates.each(is_near, |pair| self.each_of(motion, pair, &mut |touch| act(pair, touch)));
    }

    /// The vertex of a pair as a query of the edge.
    fn query<'a>(&'a self, x: &'a [f64], pair: Pair) -> EdgeQuery<'a> {
        let (point, thickness) = (vector(x, self.members(pair).1.vertex), self.thickness(pair));
        EdgeQuery { surface: &self.surface, x, point, radius: 0.0, thickness }
    }

    /// Calls `act` for everything that touches in a pair.
    fn each_of(&self, motion: Motion<'_>, pair: Pair, act: &mut dyn FnMut(&Touch)) {
        let (edge, vertex) = self.members(pair);
        let query = self.query(motion.x, pair);
        // A vertex inside its own body may be next to the opposite boundary; one that began inside another body is let out.
        let is_own = edge.part == vertex.part;
        let deepest = || if is_own { 0.0 } else { DEPTH * query.thickness + penetration_of(self.kept(motion, pair)) };
        query.each(pair[0], |edge| self.can_touch([edge, pair[1]]), deepest, &mut |stencil| {
            act(&self.touch(motion, pair, stencil));
        });
    }

    /// A contact of a pair with its velocities and its memory, or that of the next edge that the vertex came from.
    fn touch(&self, motion: Motion<'_>, pair: Pair, stencil: Stencil) -> Touch {
        let (edge, vertex) = self.members(pair);
        // Between bodies each side counts half; the particles of nets have no edges that would count the other half.
        let share = if self.surface.is_body(vertex.part) { 0.5 } else { 1.0 };
        let name = ContactName { effect: self.number, surface: pair[0], vertex: vertex.vertex };
        let ([a, b], between) = (edge.ends, self.between(edge.part, vertex.part));
        let parameters = ContactParameters {
            potential: between.potential,
            dissipation: self.skin.dissipation,
            friction: between.friction,
            depenetration_speed: self.surface.depenetration_speed(vertex.part),
        };
        let mut touch = stencil.touch(name, ([vertex.vertex, a, b], Members::Both), share * vertex.area, parameters);
        touch.span = motion.span;
        touch.add_velocities(motion.v);
        touch.remember_along(self.kept(motion, pair));
        touch
    }

    /// Memory of a vertex at an edge, and at the edges before and after.
    fn kept(&self, motion: Motion<'_>, [edge, vertex]: Pair) -> [Option<Anchor>; 3] {
        let [before, after] = self.surface.edges()[edge as usize].neighbours;
        [edge, before, after].map(|surface| {
            let name = ContactName { effect: self.number, surface, vertex: self.surface.at(vertex).vertex };
            anchor_of(motion.anchors, name)
        })
    }

    /// The anchors of this contact.
    fn own_anchors<'a>(&self, anchors: &'a [Anchor]) -> &'a [Anchor] {
        anchors_of(anchors, self.number)
    }

    /// Pairs of each vertex that is inside another body with the nearest edge of that body.
    fn inside(&self, x: &[f64]) -> Vec<Pair> {
        let all = 0..self.surface.edges().len() as u32;
        let mut found = Vec::new();
        for (place, vertex) in self.surface.iter().enumerate() {
            let touches = |part: &u32| *part != vertex.part && self.between(*part, vertex.part).touch();
            for part in (0..self.surface.parts() as u32).filter(touches) {
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
}

impl SurfaceTerm for SurfaceContact {
    fn contact(&self) -> AnyContact<'_> {
        AnyContact::Plane(self)
    }

    fn set_number(&mut self, number: usize) {
        self.number = number as u32;
    }

    fn count_crossings(&self, x: &[f64]) -> usize {
        count_crossings(&self.surface, x, |one, other| !self.between(one, other).is_apart)
    }

    fn overlaps(&self, x: &[f64]) -> Vec<Overlap> {
        self.overlapping(x)
    }

    fn setting_aside(&self, bodies: &[[usize; 2]]) -> Option<Box<dyn SurfaceTerm>> {
        let parts = self.surface.parts();
        let is_set_aside = |at: usize| {
            let [one, other] = [at / parts, at % parts].map(|part| self.surface.owner(part as u32));
            bodies.contains(&[one, other]) || bodies.contains(&[other, one])
        };
        let changes = |(at, between): (usize, &Between)| between.is_set_aside != is_set_aside(at);
        self.between.iter().enumerate().any(changes).then(|| {
            let mut contact = self.clone();
            contact.between.iter_mut().enumerate().for_each(|(at, between)| between.is_set_aside = is_set_aside(at));
            Box::new(contact) as Box<dyn SurfaceTerm>
        })
    }

    fn owners(&self, contact: ContactName) -> Option<[usize; 2]> {
        let edge = self.surface.edges().get(contact.surface as usize)?;
        let vertex = self.surface.at(self.surface.place_of(contact.vertex)?);
        Some([edge.part, vertex.part].map(|part| self.surface.owner(part)))
    }

    /// Vertices with an initial penetration touch their edges and the neighbours of these at any depth.
    fn update(&self, candidates: &mut Candidates, x: &[f64], anchors: &[Anchor]) {
        candidates.update(&*self.surface, x, self.reach(), |pair| self.can_touch(pair));
        let deep = self.own_anchors(anchors).iter().filter(|anchor| anchor.penetration > 0.0);
        let deep = deep.filter_map(|anchor| {
            let (edge, place) = (anchor.contact.surface, self.surface.place_of(anchor.contact.vertex)?);
            let [before, after] = self.surface.edges().get(edge as usize)?.neighbours;
            Some([before, edge, after].map(|edge| [edge, place]))
        });
        let deep = deep.flatten();
        candidates.set_deep(deep.filter(|pair| self.can_touch(*pair)));
    }

    fn add_near(&self, candidates: &Candidates, x: &[f64], near: &mut Vec<Pair>) {
        let is_near = |pair: &&Pair| self.distance(x, **pair) < self.reach();
        near.extend(candidates.touching().iter().filter(is_near));
    }

    fn each_pressing(&self, motion: Motion<'_>, act: &mut dyn FnMut([usize; 2], &[u32])) {
        with_candidates(self, motion, |candidates| {
            self.each_of_all(motion, candidates, &mut |pair, touch| {
                if touch.pressure() > 0.0 {
                    act(self.parts(pair).map(|part| self.surface.owner(part)), &touch.vertices);
                }
            });
        });
    }

    fn longest_step(&self, scratch: &mut Truncation, candidates: &mut Candidates, x: &[f64], end: &[f64]) -> f64 {
        MeetingPairs::longest_step(self, scratch, candidates, x, end)
    }

    fn meets(&self, scratch: &mut Truncation, candidates: &mut Candidates, start: &[f64], x: &[f64]) -> bool {
        MeetingPairs::meets(self, scratch, candidates, start, x)
    }

    fn truncate(
        &self,
        scratch: (&mut Truncation, &mut Candidates),
        means: Means,
        start: (&[f64], &[f64]),
        end: [&mut [f64]; 2],
    ) -> usize {
        MeetingPairs::truncate(self, scratch, means, start, end)
    }
}

impl ContactTerm for SurfaceContact {
    fn each(&self, motion: Motion<'_>, act: &mut dyn FnMut(&Touch)) {
        with_candidates(self, motion, |candidates| {
            self.each_of_all(motion, candidates, &mut |_, touch| act(touch));
        });
    }

    fn each_at_start(&self, motion: Motion<'_>, act: &mut dyn FnMut(&Touch)) {
        self.each(motion, act);
        for pair in self.inside(motion.x) {
            if let Some(stencil) = self.query(motion.x, pair).inside(pair[0]) {
                act(&self.touch(motion, pair, stencil));
            }
        }
    }

    /// A pair takes part with both masses, which can double the square.
    fn square_frequency(&self, motion: Motion<'_>) -> f64 {
        let parts = self.surface.parts();
        let square = |vertex: &SurfaceVertex| {
            let inverse = vector(motion.inverse_mass, vertex.vertex);
            let others = (0..parts as u32).filter(|part| !self.between(vertex.part, *part).is_apart);
            let stiffness = others.map(|part| self.between(vertex.part, part).potential.greatest_stiffness());
            2.0 * vertex.area * stiffness.fold(0.0, f64::max) * inverse[0].max(inverse[1])
        };
        if self.is_empty() { 0.0 } else { self.surface.iter().map(square).fold(0.0, f64::max) }
    }

    fn idle(&self, motion: Motion<'_>) -> Option<&'static str> {
        let mut none = true;
        with_candidates(self, motion, |candidates| none = candidates.is_empty());
        none.then_some(NO_OBSTACLE_NEAR)
    }

    fn sparsity_pattern(&self, pairs: &[Pair], add: &mut dyn FnMut(u32, u32)) {
        for pair in pairs {
            let (SurfaceEdge { ends: [a, b], .. }, vertex) = self.members(*pair);
            add(vertex.vertex, *a);
            add(vertex.vertex, *b);
            add(*a, *b);
        }
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
