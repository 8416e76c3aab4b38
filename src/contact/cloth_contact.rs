//! Contact of cloth in space with itself and with other cloth.

use super::{
    Anchor, AnyContact, Candidates, ClothMesh, ClothSurface, ClothTriangle, ContactModel, ContactName,
    ContactParameters, ContactTerm, Grid, Means, Members, Pair, Skin, SurfaceTerm, SurfaceVertex, SurfaceVertices,
    Surfaces as _, Touch, Truncation,
    candidates::minus,
    cloth_mesh::ClothPair,
    cloth_query::{ClothQuery, ClothStencil, between_edges},
    friction::{anchor_of, anchors_of},
    surface_term::{Between, with_candidates},
    touch::{coordinates, dot},
    truncation::MeetingPairs,
};
use crate::{
    effects::{Motion, NO_OBSTACLE_NEAR},
    solvers::{SparseMatrix, Weights},
};
use std::sync::Arc;

/// A contact of cloth.
type ClothTouch = Touch<3, 2, 4>;

/// Contact of vertices that have a skin with triangles in space, and of edges of triangles with each other.
///
/// A vertex touches both sides of a surface alike, by the distance from it (`ClothQuery`); each of two surfaces counts half. Edges that cross
/// between vertices add to that (`between_edges`). Truncation keeps surfaces from passing through each other; cloth
/// that begins crossed stays so.
pub struct ClothContact {
    /// Number of the effect in the scene.
    number: u32,
    skin: Skin,
    mesh: ClothMesh,
    /// Positions at rest \[m\].
    rest: Arc<Vec<f64>>,
    /// What holds between each two parts.
    between: Vec<Between>,
    /// Share of the area of the vertices of each part that counts.
    shares: Vec<f64>,
    /// Greatest area of a vertex of each part, twice its share \[m²\].
    areas: Vec<f64>,
    /// Pairs of a part that are within their skin at rest, which do not touch, ascending.
    excluded: Vec<Pair>,
    /// Where those of each first member begin, and their number.
    excluded_from: Vec<usize>,
    /// Greatest thickness of the skin \[m\].
    reach: f64,
    /// The triangles, for the exact test.
    certificate: ClothSurface,
}

/// Distance within which pairs have blocks in the matrix, as a multiple of the thickness of the skin.
const NEAR: f64 = 1.1;

impl ClothContact {
    /// Contact of triangles with these corners, by their numbers in the scene; `rest` are the positions at rest \[m\].
    pub fn new(
        model: &ContactModel,
        surface: &Arc<SurfaceVertices>,
        corners: impl Iterator<Item = [u32; 3]>,
        rest: &Arc<Vec<f64>>,
    ) -> Self {
        let mesh = ClothMesh::new(surface, corners, rest);
        let between = Between::all(model, surface);
        let share = |part: u32| if mesh.has_triangles(part) { 0.5 } else { 1.0 };
        let area = |part: u32| {
            let own = surface.vertices_of(part as usize).map(|place| surface.at(place as u32).area);
            2.0 * share(part) * own.fold(0.0, f64::max)
        };
        let mut contact = Self {
            number: 0,
            skin: model.skin,
            rest: Arc::clone(rest),
            shares: (0..surface.parts() as u32).map(share).collect(),
            areas: (0..surface.parts() as u32).map(area).collect(),
            reach: between.iter().map(|pair| pair.potential.thickness).fold(0.0, f64::max),
            between,
            excluded: Vec::new(),
            excluded_from: Vec::new(),
            certificate: ClothSurface::new(mesh.triangles().iter().map(|triangle| triangle.corners).collect()),
            mesh,
        };
        let mut near = Vec::new();
        contact.mesh.find(&mut Grid::default(), rest, contact.reach, &mut near);
        near.retain(|pair| {
            let [one, other] = contact.parts(*pair);
            one == other && contact.mesh.is_within(rest, *pair, contact.thickness(*pair))
        });
        let members = 0..=(contact.mesh.triangles().len() + contact.mesh.edges().len()) as u32;
        contact.excluded_from = members.map(|first| near.partition_point(|pair| pair[0] < first)).collect();
        contact.excluded = near;
        contact
    }

    /// Whether there are no triangles.
    pub fn is_empty(&self) -> bool {
        self.mesh.triangles().is_empty()
    }

    /// The triangles.
    pub(super) const fn mesh(&self) -> &ClothMesh {
        &self.mesh
    }

    /// Distance within which candidates contain all pairs \[m\].
    pub(super) fn reach(&self) -> f64 {
        NEAR * self.reach
    }

    /// Whether a pair of a part is within its skin at rest.
    pub(super) fn is_excluded(&self, pair: Pair) -> bool {
        let first = pair[0] as usize;
        self.excluded[self.excluded_from[first]..self.excluded_from[first + 1]].binary_search(&pair).is_ok()
    }

    /// Parts of both surfaces of a pair.
    pub(super) fn parts_of(&self, pair: Pair) -> [u32; 2] {
        match self.mesh.members(pair) {
            ClothPair::Vertex(triangle, place) => {
                [self.mesh.triangles()[triangle as usize].part, self.mesh.surface().at(place).part]
            }
            ClothPair::Edges(one, other) => [one, other].map(|edge| self.mesh.edges()[edge as usize].part),
        }
    }

    /// What holds between two parts.
    pub(super) fn between(&self, [one, other]: [u32; 2]) -> &Between {
        &self.between[one as usize * self.mesh.surface().parts() + other as usize]
    }

    /// Calls `act` for everything that touches in the candidates. Most of them are too far apart.
    fn each_of_all(&self, motion: Motion<'_>, candidates: &Candidates, act: &mut dyn FnMut(Pair, &ClothTouch)) {
        /// Far more than the round-off of a distance.
        const SLACK: f64 = 1.0 + 1e-9;
        let motion = Motion { anchors: anchors_of(motion.anchors, self.number), ..motion };
        let is_near = |pair: Pair| self.mesh.is_within(motion.x, pair, SLACK * self.thickness(pair));
        let penetrates = penetrates(motion);
        candidates.each(is_near, |pair| self.each_of((motion, penetrates), pair, &mut |touch| act(pair, touch)));
    }

    /// Whether a vertex may touch all triangles that have a corner in common with one that it touches: of other cloth, or far from it at rest.
    fn touches_all_around(&self, triangle: u32, vertex: &SurfaceVertex) -> bool {
        let ClothTriangle { corners: [corner, ..], part, .. } = self.mesh.triangles()[triangle as usize];
        let [one, other] = [corner, vertex.vertex].map(|vertex| coordinates::<3>(&self.rest, vertex));
        let between = minus(one, other);
        let far = self.reach + 2.0 * self.mesh.longest_edge();
        part != vertex.part || dot(between, between) > far * far
    }

    /// Calls `act` for everything that touches in a pair that can. `penetrates` says whether [some contacts do](penetrates).
    fn each_of(&self, (motion, penetrates): (Motion<'_>, bool), pair: Pair, act: &mut dyn FnMut(&ClothTouch)) {
        match self.mesh.members(pair) {
            ClothPair::Vertex(triangle, place) => {
                let vertex = *self.mesh.surface().at(place);
                let corners = self.mesh.triangles()[triangle as usize].corners;
                let query = ClothQuery {
                    mesh: &self.mesh,
                    rest: &self.rest,
                    x: motion.x,
                    point: coordinates(motion.x, vertex.vertex),
                    thickness: self.thickness(pair),
                    can_touch: |triangle: u32| self.can_touch([triangle, place]),
                    touches_all: self.touches_all_around(triangle, &vertex),
                };
                let area = self.shares[vertex.part as usize] * vertex.area;
                let name = ContactName { effect: self.number, surface: triangle, vertex: vertex.vertex };
                let own = anchor_of(motion.anchors, name);
                let begun = if own.is_none() && penetrates { self.penetration_beside(motion, name) } else { 0.0 };
                let vertices = [vertex.vertex, corners[0], corners[1], corners[2]];
                let mut is_first = true;
                query.each(triangle, &mut |stencil| {
                    let mut touch = self.touch(motion, pair, (name, vertices, area), stencil);
                    touch.keeps_anchor = std::mem::take(&mut is_first);
                    if let Some(anchor) = own {
                        touch.remember(anchor);
                    } else if begun > 0.0 {
                        touch.begin(begun);
                    }
                    act(&touch);
                });
            }
            ClothPair::Edges(one, other) => {
                let [first, second] = [one, other].map(|edge| &self.mesh.edges()[edge as usize]);
                let [a, b] = [one, other].map(|edge| self.mesh.ends(motion.x, edge));
                let Some(stencil) = between_edges(a, b, first.length * second.length, self.thickness(pair)) else {
                    return;
                };
                let [surface, vertex] = self.mesh.name_of_edges(one, other);
                let name = ContactName { effect: self.number, surface, vertex };
                let vertices = [first.ends[0], first.ends[1], second.ends[0], second.ends[1]];
                let area = 0.5 * (first.area + second.area);
                let mut touch = self.touch(motion, pair, (name, vertices, area), stencil);
                if let Some(anchor) = anchor_of(motion.anchors, name) {
                    touch.remember(anchor);
                }
                act(&touch);
            }
        }
    }

    /// A contact of a pair with its velocities, without memory.
    fn touch(
        &self,
        motion: Motion<'_>,
        pair: Pair,
        (name, vertices, area): (ContactName, [u32; 4], f64),
        stencil: ClothStencil,
    ) -> ClothTouch {
        let parts = self.parts_of(pair);
        let between = self.between(parts);
        let parameters = ContactParameters {
            potential: between.potential,
            dissipation: self.skin.dissipation,
            friction: between.friction,
            depenetration_speed: self.mesh.surface().depenetration_speed(parts[1]),
        };
        let mut touch = stencil.touch(name, (vertices, Members::Both), area, parameters);
        touch.span = motion.span;
        touch.add_velocities(motion.v);
        touch
    }

    /// Greatest initial penetration of a vertex at the triangles around one that it is new at \[m\].
    fn penetration_beside(&self, motion: Motion<'_>, name: ContactName) -> f64 {
        let around = self.mesh.connected(name.surface);
        let anchors = around.filter_map(|surface| anchor_of(motion.anchors, ContactName { surface, ..name }));
        anchors.map(|anchor| anchor.penetration).fold(0.0, f64::max)
    }
}

impl SurfaceTerm for ClothContact {
    fn contact(&self) -> AnyContact<'_> {
        AnyContact::Space(self)
    }

    fn set_number(&mut self, number: usize) {
        self.number = number as u32;
    }

    fn count_crossings(&self, x: &[f64]) -> usize {
        let part = |vertex: u32| self.mesh.surface().numbered(vertex).map_or(0, |vertex| vertex.part);
        self.certificate.count_between(x, |pair| !self.between(pair.map(part)).is_apart)
    }

    fn update(&self, candidates: &mut Candidates, x: &[f64], _: &[Anchor]) {
        candidates.update(&self.mesh, x, self.reach(), |pair| self.can_touch(pair));
    }

    fn add_near(&self, candidates: &Candidates, x: &[f64], near: &mut Vec<Pair>) {
        let is_near = |pair: &&Pair| self.mesh.is_within(x, **pair, self.reach());
        near.extend(candidates.touching().iter().filter(is_near));
    }

    fn each_pressing(&self, motion: Motion<'_>, act: &mut dyn FnMut([usize; 2], &[u32])) {
        with_candidates(self, motion, |candidates| {
            self.each_of_all(motion, candidates, &mut |pair, touch| {
                if touch.pressure() > 0.0 {
                    act(self.parts_of(pair).map(|part| self.mesh.surface().owner(part)), &touch.vertices);
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

impl ContactTerm<3, 2, 4> for ClothContact {
    fn each(&self, motion: Motion<'_>, act: &mut dyn FnMut(&ClothTouch)) {
        with_candidates(self, motion, |candidates| {
            self.each_of_all(motion, candidates, &mut |_, touch| act(touch));
        });
    }

    /// Both sides of a contact and the edges around add to the stiffness of a vertex, and a pair takes part with both masses.
    fn square_frequency(&self, motion: Motion<'_>) -> f64 {
        /// Greatest square of the frequency as a multiple of that of a vertex on a skin at rest.
        const MANY: f64 = 4.0;
        let surface = self.mesh.surface();
        let square = |vertex: &SurfaceVertex| {
            let inverse: [f64; 3] = coordinates(motion.inverse_mass, vertex.vertex);
            let stiffness = |(part, area): (u32, &f64)| {
                let between = self.between([vertex.part, part]);
                if between.is_apart { 0.0 } else { area.max(vertex.area) * between.potential.greatest_stiffness() }
            };
            // A vertex of another part with a greater area may press on this one.
            let stiffness = (0..).zip(&self.areas).map(stiffness).fold(0.0, f64::max);
            MANY * stiffness * inverse.into_iter().fold(0.0, f64::max)
        };
        if self.is_empty() { 0.0 } else { surface.iter().map(square).fold(0.0, f64::max) }
    }

    fn idle(&self, motion: Motion<'_>) -> Option<&'static str> {
        let mut none = true;
        with_candidates(self, motion, |candidates| none = candidates.is_empty());
        none.then_some(NO_OBSTACLE_NEAR)
    }

    fn sparsity_pattern(&self, pairs: &[Pair], add: &mut dyn FnMut(u32, u32)) {
        for pair in pairs {
            let vertices = self.vertices(*pair).map(|vertex| vertex as u32);
            for [i, j] in BLOCKS {
                add(vertices[i], vertices[j]);
            }
        }
    }

    /// Adds six blocks for each pair of the pattern, whether it touches or not.
    fn add_stiffness(&self, motion: Motion<'_>, weights: Weights, matrix: &mut dyn SparseMatrix) {
        let Some(matrix) = matrix.blocks::<3>() else { return };
        let motion = Motion { anchors: anchors_of(motion.anchors, self.number), ..motion };
        let penetrates = penetrates(motion);
        for pair in motion.pattern {
            let mut blocks = [nalgebra::Matrix3::zeros(); 6];
            if self.mesh.is_within(motion.x, *pair, self.thickness(*pair)) {
                self.each_of((motion, penetrates), *pair, &mut |touch| {
                    let linearised = touch.linearised(weights);
                    for (i, vertex) in touch.vertices.iter().enumerate() {
                        matrix.diagonal(*vertex as usize, &linearised.block(i, i));
                    }
                    for (block, [i, j]) in blocks.iter_mut().zip(BLOCKS) {
                        *block += linearised.block(i, j);
                    }
                });
            }
            for block in &blocks {
                matrix.off_diagonal(block);
            }
        }
    }
}

/// Whether there are contacts with an initial penetration.
fn penetrates(motion: Motion<'_>) -> bool {
    motion.anchors.iter().any(|anchor| anchor.penetration != 0.0)
}

/// Pairs of the four vertices.
const BLOCKS: [[usize; 2]; 6] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];
