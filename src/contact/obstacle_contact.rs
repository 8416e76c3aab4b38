//! Contact of the boundaries of bodies and the particles of nets with obstacles.

use super::{
    Anchor, BetweenVertices, ContactModel, ContactName, ContactParameters, ContactTerm, Curvature, FacePoints, Filter,
    Members, Pair, Path, Place, Potential, Surface, SurfaceVertex, SurfaceVertices, Touch, TruncatedStep,
    friction::{anchor_of, anchors_of},
    touch::{coordinates, dot},
};
use crate::{
    effects::{Bounds, Motion, NO_OBSTACLE_NEAR},
    obstacles::{MotionKind, Obstacle, Rigid, SweptMotion, placed},
    solvers::{SparseMatrix, Weights},
};
use std::sync::Arc;

/// Number of successive vertices that are tested at once.
const BLOCK: usize = 32;

/// An obstacle with the motion that it is told.
pub struct PlacedObstacle<const D: usize = 2> {
    /// The obstacle, where it is without its motions.
    pub obstacle: Box<dyn Obstacle<D>>,
    /// Its motions; empty for an obstacle at rest.
    pub motions: Vec<MotionKind>,
}

impl<const D: usize> PlacedObstacle<D> {
    /// An obstacle at rest.
    pub fn still(obstacle: Box<dyn Obstacle<D>>) -> Self {
        Self { obstacle, motions: Vec::new() }
    }

    /// Where it is at a time \[s\]; `None` for an obstacle at rest.
    pub fn at(&self, time: f64) -> Option<Rigid<D>> {
        (!self.motions.is_empty()).then(|| placed(&self.motions, time))
    }

    /// Where it is in the middle of a span of time about a moment \[s\]: its translation and its velocity are means of those at both ends, so that
    /// these are half of the displacement away. `None` for an obstacle at rest.
    pub(super) fn within(&self, time: f64, span: f64) -> Option<Rigid<D>> {
        let middle = self.at(time)?;
        if span == 0.0 {
            return Some(middle);
        }
        let [start, end]: [[f64; D]; 2] = [-0.5, 0.5].map(|part| placed(&self.motions, time + part * span).shift);
        let shift = std::array::from_fn(|axis| 0.5 * (start[axis] + end[axis]));
        let turning = middle.spin.map(|row| dot(row, shift));
        let velocity = std::array::from_fn(|axis| (end[axis] - start[axis]) / span - turning[axis]);
        Some(Rigid { shift, velocity, ..middle })
    }

    /// Where it is in a motion, and how fast it moves; `None` for an obstacle at rest.
    pub(super) fn moving(&self, motion: Motion<'_>) -> Option<Rigid<D>> {
        if motion.span == 0.0 { self.at(motion.time - motion.lag) } else { self.within(motion.time, motion.span) }
    }

    /// Its motion between two times \[s\].
    pub fn swept_motion(&self, time: [f64; 2]) -> SweptMotion<D> {
        let [start, end] = time.map(|time| self.at(time));
        start.zip(end).map_or(SweptMotion::STILL, |(start, end)| SweptMotion::new(start, end))
    }

    /// Whether any point of a box could be within its contact margin at a time \[s\]; conservative.
    pub(super) fn is_near(&self, bounds: Bounds<D>, at: Option<Rigid<D>>) -> bool {
        let Bounds([least, greatest]) = at.map_or(bounds, |at| bounds.mapped(|corner| at.back(corner)));
        self.obstacle.is_near(least, greatest)
    }
}

/// Contact of all vertices with the obstacles of an effect, and of what is between them ([`BetweenVertices`]).
pub struct ObstacleContact<const D: usize = 2, const T: usize = 1, const N: usize = 3> {
    /// Number of the effect in the scene.
    number: u32,
    pub(super) model: ContactModel,
    /// Least and greatest thickness of the skin \[m\].
    thickness: [f64; 2],
    pub(super) surface: Arc<SurfaceVertices>,
    /// Potential of the skin of each part.
    potentials: Vec<Potential>,
    /// mu of each part on obstacles.
    frictions: Vec<f64>,
    pub(super) obstacles: Vec<PlacedObstacle<D>>,
    /// Whether any of them has corners.
    pub(super) has_corners: bool,
    /// Points of triangles that touch between vertices, in space.
    pub(super) faces: Option<FacePoints>,
    /// Numbers of parts that sides of triangles are divided into, for each obstacle and part.
    pub(super) divisions: Vec<usize>,
}

/// A point of a surface that touches an obstacle.
pub(super) struct SurfacePoint<const N: usize> {
    /// Name of the contact.
    pub name: ContactName,
    /// Vertices, members and weights of a [`Touch`].
    pub vertices: [u32; N],
    pub members: Members,
    pub weights: [f64; N],
    /// Its area \[m²\].
    pub area: f64,
}

impl<const D: usize, const T: usize, const N: usize> ObstacleContact<D, T, N>
where
    Self: BetweenVertices<D, T, N>,
{
    /// Contact with some obstacles, where the surface has a skin and friction.
    pub fn new(model: ContactModel, surface: &Arc<SurfaceVertices>, obstacles: Vec<PlacedObstacle<D>>) -> Self {
        let potentials: Vec<_> = (0..surface.parts()).map(|part| surface.potential(model.skin, part)).collect();
        let mu = |part| model.friction.between(Surface::Owner(surface.owner(part)), Surface::Obstacles);
        let frictions = (0..surface.parts() as u32).map(mu).collect();
        let all = potentials.iter().map(|potential| potential.thickness);
        let thickness = all.fold([f64::INFINITY, 0.0], |[least, most]: [f64; 2], d| [least.min(d), most.max(d)]);
        let has_corners = obstacles.iter().any(|placed| !placed.obstacle.corners().is_empty());
        Self {
            number: 0,
            model,
            thickness,
            surface: Arc::clone(surface),
            potentials,
            frictions,
            obstacles,
            has_corners,
            faces: None,
            divisions: Vec::new(),
        }
    }

    /// The obstacles.
    pub fn obstacles(&self) -> &[PlacedObstacle<D>] {
        &self.obstacles
    }

    /// Whether nothing touches, now and at any later time, while all vertices stay in a box; conservative.
    pub fn is_clear(&self, bounds: Bounds<D>) -> bool {
        let Bounds([least, greatest]) = bounds.grown(self.greatest_thickness());
        self.obstacles.iter().all(|placed| placed.motions.is_empty() && !placed.obstacle.is_near(least, greatest))
    }

    /// Least thickness of the skin \[m\].
    pub(super) const fn least_thickness(&self) -> f64 {
        self.thickness[0]
    }

    /// Greatest thickness of the skin \[m\].
    pub(super) const fn greatest_thickness(&self) -> f64 {
        self.thickness[1]
    }

    /// Tells it the number of its effect in the scene.
    pub const fn set_number(&mut self, number: usize) {
        self.number = number as u32;
    }

    /// Number of the effect in the scene.
    pub(super) const fn number(&self) -> u32 {
        self.number
    }

    /// Potential of the skin of a part.
    pub(super) fn potential(&self, part: u32) -> Potential {
        self.potentials[part as usize]
    }

    /// mu of a part on obstacles.
    pub(super) fn friction(&self, part: u32) -> f64 {
        self.frictions[part as usize]
    }

    /// Name of the contact of an obstacle with a vertex.
    pub(super) const fn name(&self, obstacle: usize, vertex: u32) -> ContactName {
        ContactName { effect: self.number, surface: obstacle as u32, vertex }
    }

    /// The anchors of this contact.
    pub(super) fn own_anchors<'a>(&self, anchors: &'a [Anchor]) -> &'a [Anchor] {
        anchors_of(anchors, self.number)
    }

    /// Distance from an obstacle at which the skin of a part is used up \[m\]: the skin begins at the contact margin, or at its
    /// thickness if that is greater.
    pub(super) fn offset(&self, part: u32, margin: f64) -> f64 {
        (margin - self.potential(part).thickness).max(0.0)
    }

    pub(super) fn parameters(&self, part: u32) -> ContactParameters {
        ContactParameters {
            potential: self.potential(part),
            dissipation: self.model.skin.dissipation,
            friction: self.friction(part),
            depenetration_speed: self.surface.depenetration_speed(part),
        }
    }

    /// Calls `act` with the number, the obstacle and its place, of each obstacle that the skin may touch in a motion.
    pub(super) fn each_near(
        &self,
        motion: Motion<'_>,
        reach: f64,
        mut act: impl FnMut(usize, &PlacedObstacle<D>, Option<Rigid<D>>),
    ) {
        let bounds = Bounds::of(motion.x).grown(reach);
        for (number, obstacle) in self.obstacles.iter().enumerate() {
            let at = obstacle.within(motion.time, motion.span);
            if obstacle.is_near(bounds, at) {
                act(number, obstacle, at);
            }
        }
    }

    /// Calls `act` for each vertex that touches an obstacle; those of one vertex in the order of the obstacles.
    fn each_vertex(&self, motion: Motion<'_>, act: &mut dyn FnMut(&Touch<D, T, N>)) {
        /// Obstacles that are tested against one box.
        const GROUP: usize = 8;
        let moved = motion.half_displacement();
        let reach = self.greatest_thickness() + moved;
        let all = Bounds::of(motion.x).grown(reach);
        for (group, obstacles) in self.obstacles.chunks(GROUP).enumerate() {
            let places: [_; GROUP] = std::array::from_fn(|own| {
                obstacles.get(own).and_then(|placed| placed.within(motion.time, motion.span))
            });
            let near: [bool; GROUP] =
                std::array::from_fn(|own| obstacles.get(own).is_some_and(|placed| placed.is_near(all, places[own])));
            if near == [false; GROUP] {
                continue;
            }
            for block in self.surface.all().chunks(BLOCK) {
                let [first, last] = [block[0], block[block.len() - 1]].map(|vertex| D * vertex.vertex as usize);
                let bounds = Bounds::of(&motion.x[first..last + D]).grown(reach);
                for (own, placed) in obstacles.iter().enumerate() {
                    if near[own] && placed.is_near(bounds, places[own]) {
                        let obstacle = (GROUP * group + own, places[own]);
                        for vertex in block {
                            let x = coordinates(motion.x, vertex.vertex);
                            let point = || self.vertex_point(obstacle.0, *vertex);
                            self.touch_of((motion, moved), obstacle, (x, vertex.part), point, act);
                        }
                    }
                }
            }
        }
    }

    /// A vertex as a point.
    fn vertex_point(&self, obstacle: usize, vertex: SurfaceVertex) -> SurfacePoint<N> {
        let mut weights = [0.0; N];
        weights[0] = 1.0;
        SurfacePoint {
            name: self.name(obstacle, vertex.vertex),
            vertices: [vertex.vertex; N],
            members: Members::Vertex,
            weights,
            area: (1.0 - self.share_between(obstacle, vertex.part)) * vertex.area,
        }
    }

    /// Calls `act` if a point of a part at x \[m\] touches an obstacle, which is at a place. In the span of a motion it may move by a distance \[m\].
    pub(super) fn touch_of(
        &self,
        (motion, moved): (Motion<'_>, f64),
        (number, at): (usize, Option<Rigid<D>>),
        (x, part): ([f64; D], u32),
        point: impl FnOnce() -> SurfacePoint<N>,
        act: &mut dyn FnMut(&Touch<D, T, N>),
    ) {
        let placed = &self.obstacles[number];
        let obstacle = &placed.obstacle;
        let potential = self.potential(part);
        let seen = at.map_or(x, |at| at.back(x));
        let offset = self.offset(part, obstacle.margin());
        let Some(contact) = obstacle.distance(seen, potential.thickness + offset + moved) else { return };
        let normal = at.map_or(contact.normal, |at| at.normal(contact.normal));
        let SurfacePoint { name, vertices, members, weights, area } = point();
        let ways: [[f64; D]; T] = tangents(normal);
        let mut slips = weights.map(|weight| ways.map(|way| way.map(|along| weight * along)));
        slips[0] = ways;
        let mut touch = Touch {
            name,
            vertices,
            members,
            weights,
            normal,
            slips,
            area,
            area_gradient: None,
            parameters: self.parameters(part),
            gap: contact.distance - offset,
            distance: contact.distance,
            approach: 0.0,
            sliding: [0.0; T],
            span: motion.span,
            obstacle_velocity: [0.0; D],
            // That of the obstacle, which is omitted: it only slows Newton's method down.
            curvature: Curvature::Flat,
            place: Place::Obstacle(at.unwrap_or(Rigid::STILL), x),
            memory: None,
            kept: None,
            keeps_anchor: area > 0.0,
        };
        touch.add_velocities(motion.v);
        if let Some(at) = placed.moving(motion) {
            touch.add_obstacle(at.velocity_at(x));
        }
        if let Some(anchor) = anchor_of(motion.anchors, touch.name) {
            touch.remember(anchor);
        }
        act(&touch);
    }
}

/// Unit vectors along the surface: one in the plane; in space two that are orthogonal to each other (Duff et al., *Building an
/// Orthonormal Basis, Revisited*, Journal of Computer Graphics Techniques 6, 2017).
pub(super) fn tangents<const D: usize, const T: usize>(normal: [f64; D]) -> [[f64; D]; T] {
    let mut all = [[0.0; D]; T];
    if D == 2 {
        (all[0][0], all[0][1]) = (normal[1], -normal[0]);
        return all;
    }
    let (x, y, z) = (normal[0], normal[1], normal[2]);
    let sign = 1.0_f64.copysign(z);
    let a = -1.0 / (sign + z);
    let b = x * y * a;
    let basis = [[1.0 + sign * x * x * a, sign * b, -sign * x], [b, sign + y * y * a, -y]];
    for (all, vector) in all.iter_mut().zip(basis) {
        all.copy_from_slice(&vector);
    }
    all
}

impl<const D: usize, const T: usize, const N: usize> ContactTerm<D, T, N> for ObstacleContact<D, T, N>
where
    Self: BetweenVertices<D, T, N>,
{
    fn each(&self, motion: Motion<'_>, act: &mut dyn FnMut(&Touch<D, T, N>)) {
        self.each_vertex(motion, act);
        self.each_between(motion, act);
    }

    fn each_at_start(&self, motion: Motion<'_>, act: &mut dyn FnMut(&Touch<D, T, N>)) {
        self.each(motion, act);
        self.each_between_inside(motion, act);
    }

    fn square_frequency(&self, motion: Motion<'_>) -> f64 {
        let square = |vertex: &SurfaceVertex| {
            let inverse: [f64; D] = coordinates(motion.inverse_mass, vertex.vertex);
            let area = self.area_around(vertex.vertex, vertex.part, vertex.area);
            area * self.potential(vertex.part).greatest_stiffness() * inverse.into_iter().fold(0.0, f64::max)
        };
        self.surface.all().iter().map(square).fold(0.0, f64::max)
    }

    fn moves(&self) -> bool {
        self.obstacles.iter().any(|placed| !placed.motions.is_empty())
    }

    /// Within the span of a motion a vertex may touch that is farther away in its middle.
    fn idle(&self, motion: Motion<'_>) -> Option<&'static str> {
        let (mut any, reach) = (false, self.greatest_thickness() + motion.half_displacement());
        self.each_near(motion, reach, |_, _, _| any = true);
        (!any).then_some(NO_OBSTACLE_NEAR)
    }

    fn sparsity_pattern(&self, _: &[Pair], add: &mut dyn FnMut(u32, u32)) {
        self.between_pattern(add);
    }

    fn add_stiffness(&self, motion: Motion<'_>, weights: Weights, matrix: &mut dyn SparseMatrix) {
        let Some(blocks) = matrix.blocks::<D>() else { return };
        self.each_vertex(motion, &mut |touch| {
            blocks.diagonal(touch.vertices[0] as usize, &touch.linearised(weights).block(0, 0));
        });
        self.add_between_stiffness(motion, weights, matrix);
    }
}

/// Contact with obstacles, in the plane or in space.
pub trait ObstacleTerm: Send + Sync {
    /// Number of obstacles.
    fn count(&self) -> usize;

    /// The obstacle of a contact by the number of its surface, and a number of what touches there, which does not depend on other obstacles.
    fn split(&self, surface: u32) -> Option<(usize, u32)>;

    /// The number of the surface of a contact by these; `None` if there is no such.
    fn surface_of(&self, obstacle: usize, part: u32) -> Option<u32>;

    /// Whether anything may be within the contact margin of an obstacle at a time \[s\]; conservative.
    fn may_touch(&self, time: f64, x: &[f64]) -> bool;

    /// Truncates a step; returns the number of vertices and edges that met an obstacle.
    fn truncate(&self, step: &mut TruncatedStep<'_>) -> usize;

    /// Fraction of the displacements until something meets an obstacle; with `solids`, only obstacles that are bounded.
    fn first_meeting(&self, path: &Path<'_>, solids: bool) -> Option<f64>;

    /// Filters the end of a step, by the rule of [`super::Filter`].
    ///
    /// By velocities: a vertex within the contact margin of an obstacle loses its velocity towards it,
    /// `v - (1 + e) min(0, v n) n`, and as much of that along it as friction takes, at most mu times the change along the normal. A
    /// vertex inside is put on the surface. Velocities are relative to an obstacle that moves.
    ///
    /// By positions: a vertex within the contact margin is put at `mu p + (1 - mu) n`, where n is the nearest point at the margin, and p the
    /// position at the start of the step, moved along with the obstacle. If it was within the margin there already, it is put at
    /// n. The velocity changes by the displacement over the length of the step.
    ///
    /// Returns the number of vertices changed, and the work of moving obstacles as far as it is known \[J\].
    fn filter(&self, step: FilteredStep<'_>) -> (usize, f64);

    /// Whether [`Self::filter`] changes positions without telling its work.
    fn filters_positions(&self) -> bool;
}

/// The end of a step that a filter changes.
pub struct FilteredStep<'a> {
    /// Simulated time at the start and at the end \[s\].
    pub time: [f64; 2],
    /// Positions at the start, flat \[m\].
    pub start: &'a [f64],
    /// 1/mass, flat [1/kg].
    pub inverse_mass: &'a [f64],
    /// Positions at the end, flat \[m\].
    pub x: &'a mut [f64],
    /// Velocities at the end, flat [m/s].
    pub v: &'a mut [f64],
}

impl<const D: usize, const T: usize, const N: usize> ObstacleTerm for ObstacleContact<D, T, N>
where
    Self: BetweenVertices<D, T, N>,
{
    fn count(&self) -> usize {
        self.obstacles.len()
    }

    fn split(&self, surface: u32) -> Option<(usize, u32)> {
        self.split_surface(surface)
    }

    fn surface_of(&self, obstacle: usize, part: u32) -> Option<u32> {
        self.join_surface(obstacle, part)
    }

    fn may_touch(&self, time: f64, x: &[f64]) -> bool {
        let mut any = false;
        self.each_near(Motion { x, time, ..Motion::NONE }, self.greatest_thickness(), |_, _, _| any = true);
        any
    }

    fn truncate(&self, step: &mut TruncatedStep<'_>) -> usize {
        self.truncated(step)
    }

    fn first_meeting(&self, path: &Path<'_>, solids: bool) -> Option<f64> {
        self.meeting_of_path(path, solids)
    }

    fn filter(&self, step: FilteredStep<'_>) -> (usize, f64) {
        match self.model.filter {
            Some(Filter::Position) => (self.filter_positions(step), 0.0),
            _ => self.filter_velocities(step),
        }
    }

    fn filters_positions(&self) -> bool {
        self.model.filter == Some(Filter::Position)
    }
}
