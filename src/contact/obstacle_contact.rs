//! Contact of the boundaries of bodies and the particles of nets with obstacles.

use super::{
    Anchor, ContactModel, ContactName, ContactParameters, ContactTerm, Curvature, Members, Pair, Place, Potential,
    Surface, SurfaceEdge, SurfaceVertex, SurfaceVertices, Touch,
    edge_query::{DEPTH, EdgeQuery, Stencil},
    friction::{anchor_of, anchors_of, penetration_of},
    touch::vector,
};
use crate::{
    effects::{Bounds, Motion, NO_OBSTACLE_NEAR},
    obstacles::{Corner, MotionKind, Obstacle, Rigid, SweptMotion, placed},
    solvers::{SparseMatrix, Weights},
};
use std::sync::Arc;

/// Number of successive vertices that are tested at once.
const BLOCK: usize = 32;

/// An obstacle with the motion that it is told.
pub struct PlacedObstacle {
    /// The obstacle, where it is without its motions.
    pub obstacle: Box<dyn Obstacle>,
    /// Its motions; empty for an obstacle at rest.
    pub motions: Vec<MotionKind>,
}

impl PlacedObstacle {
    /// An obstacle at rest.
    pub fn still(obstacle: Box<dyn Obstacle>) -> Self {
        Self { obstacle, motions: Vec::new() }
    }

    /// Where it is at a time \[s\]; `None` for an obstacle at rest.
    pub fn at(&self, time: f64) -> Option<Rigid> {
        (!self.motions.is_empty()).then(|| placed(&self.motions, time))
    }

    /// Where it is in the middle of a span of time about a moment \[s\]: its translation and its velocity are means of those at both ends, so that
    /// these are half of the displacement away. `None` for an obstacle at rest.
    fn within(&self, time: f64, span: f64) -> Option<Rigid> {
        let middle = self.at(time)?;
        if span == 0.0 {
            return Some(middle);
        }
        let [start, end] = [-0.5, 0.5].map(|part| placed(&self.motions, time + part * span).shift);
        let shift @ [x, y] = [0, 1].map(|axis| 0.5 * (start[axis] + end[axis]));
        let turning = [-middle.spin * y, middle.spin * x];
        let velocity = [0, 1].map(|axis| (end[axis] - start[axis]) / span - turning[axis]);
        Some(Rigid { shift, velocity, ..middle })
    }

    /// Where it is in a motion, and how fast it moves; `None` for an obstacle at rest.
    fn moving(&self, motion: Motion<'_>) -> Option<Rigid> {
        if motion.span == 0.0 { self.at(motion.time - motion.lag) } else { self.within(motion.time, motion.span) }
    }

    /// Its motion between two times \[s\].
    pub fn swept_motion(&self, time: [f64; 2]) -> SweptMotion {
        let [start, end] = time.map(|time| self.at(time));
        start.zip(end).map_or(SweptMotion::STILL, |(start, end)| SweptMotion::new(start, end))
    }

    /// Whether any point of a box could be within its contact margin at a time \[s\]; conservative.
    pub(super) fn is_near(&self, bounds: Bounds, at: Option<Rigid>) -> bool {
        let Bounds([least, greatest]) = at.map_or(bounds, |at| bounds.mapped(|corner| at.back(corner)));
        self.obstacle.is_near(least, greatest)
    }
}

/// The corners of an obstacle at one moment.
struct Corners<'a> {
    /// Number of the first among those of all obstacles.
    first: u32,
    at_rest: &'a [Corner],
    /// Where the obstacle is, and how it moves; `None` at rest.
    at: Option<Rigid>,
    moves: Option<Rigid>,
}

impl<'a> Corners<'a> {
    fn new(first: u32, placed: &'a PlacedObstacle, at: Option<Rigid>, motion: Motion<'_>) -> Self {
        Self { first, at_rest: placed.obstacle.corners(), at, moves: placed.moving(motion) }
    }

    /// The corners where they are, with their numbers.
    fn each(&self) -> impl Iterator<Item = (u32, Corner)> {
        (self.first..).zip(self.at_rest.iter().map(|corner| corner.placed(self.at)))
    }

    /// Velocity of a corner [m/s]; `None` at rest.
    fn velocity(&self, corner: &Corner) -> Option<[f64; 2]> {
        self.moves.map(|moves| moves.velocity_at(corner.middle))
    }
}

/// Contact of all vertices with the obstacles of an effect, and of the edges of boundaries with the convex corners
/// of these obstacles.
///
/// A corner touches edges as the vertex of another body would; its area is the mean length of the edges.
pub struct ObstacleContact {
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
    pub(super) obstacles: Vec<PlacedObstacle>,
    /// Whether any of them has corners.
    has_corners: bool,
}

impl ObstacleContact {
    /// Contact with some obstacles, where the surface has a skin and friction.
    pub fn new(model: ContactModel, surface: &Arc<SurfaceVertices>, obstacles: Vec<PlacedObstacle>) -> Self {
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
        }
    }

    /// The obstacles.
    pub fn obstacles(&self) -> &[PlacedObstacle] {
        &self.obstacles
    }

    /// Whether nothing touches, now and at any later time, while all vertices stay in a box; conservative.
    pub fn is_clear(&self, bounds: Bounds) -> bool {
        let Bounds([least, greatest]) = bounds.grown(self.greatest_thickness());
        self.obstacles.iter().all(|placed| placed.motions.is_empty() && !placed.obstacle.is_near(least, greatest))
    }

    /// Whether anything may be within the contact margin of an obstacle at a time \[s\]; conservative.
    pub fn may_touch(&self, time: f64, x: &[f64]) -> bool {
        let mut any = false;
        self.each_near(Motion { x, time, ..Motion::NONE }, self.greatest_thickness(), |_, _, _| any = true);
        any
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

    /// Name of the contact of an edge, by the vertex where it begins, with a corner, which counts on through all obstacles.
    fn corner_name(&self, edge: u32, corner: u32) -> ContactName {
        let vertex = self.surface.edges()[edge as usize].ends[0];
        ContactName { effect: self.number, surface: self.obstacles.len() as u32 + corner, vertex }
    }

    /// Number of the first corner of an obstacle.
    pub(super) fn first_corner(&self, obstacle: usize) -> u32 {
        self.obstacles[..obstacle].iter().map(|placed| placed.obstacle.corners().len()).sum::<usize>() as u32
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

    fn parameters(&self, part: u32) -> ContactParameters {
        ContactParameters {
            potential: self.potential(part),
            dissipation: self.model.skin.dissipation,
            friction: self.friction(part),
            depenetration_speed: self.surface.depenetration_speed(part),
        }
    }

    /// Calls `act` with the number, the obstacle and its place, of each obstacle that the skin may touch in a motion.
    fn each_near(&self, motion: Motion<'_>, reach: f64, mut act: impl FnMut(usize, &PlacedObstacle, Option<Rigid>)) {
        let bounds = Bounds::of(motion.x).grown(reach);
        for (number, obstacle) in self.obstacles.iter().enumerate() {
            let at = obstacle.within(motion.time, motion.span);
            if obstacle.is_near(bounds, at) {
                act(number, obstacle, at);
            }
        }
    }

    /// Calls `act` for each vertex that touches an obstacle.
    fn each_vertex(&self, motion: Motion<'_>, act: &mut dyn FnMut(&Touch)) {
        let moved = motion.half_displacement();
        let reach = self.greatest_thickness() + moved;
        self.each_near(motion, reach, |number, placed, at| {
            let obstacle = &placed.obstacle;
            let near = |block: &&[SurfaceVertex]| {
                let [first, .., last] = [block[0], block[block.len() - 1]].map(|vertex| 2 * vertex.vertex as usize);
                placed.is_near(Bounds::of(&motion.x[first..last + 2]).grown(reach), at)
            };
            for vertex in self.surface.all().chunks(BLOCK).filter(near).flatten() {
                let (x, potential) = (vector(motion.x, vertex.vertex), self.potential(vertex.part));
                let seen = at.map_or(x, |at| at.back(x));
                let offset = self.offset(vertex.part, obstacle.margin());
                let Some(contact) = obstacle.distance(seen, potential.thickness + offset + moved) else { continue };
                let [nx, ny] = at.map_or(contact.normal, |at| at.normal(contact.normal));
                let mut touch = Touch {
                    name: self.name(number, vertex.vertex),
                    vertices: [vertex.vertex; 3],
                    members: Members::Vertex,
                    weights: [1.0, 0.0, 0.0],
                    normal: [nx, ny],
                    slips: [[ny, -nx], [0.0; 2], [0.0; 2]],
                    area: vertex.area,
                    parameters: self.parameters(vertex.part),
                    gap: contact.distance - offset,
                    distance: contact.distance,
                    approach: 0.0,
                    sliding: 0.0,
                    span: motion.span,
                    obstacle_velocity: [0.0; 2],
                    // That of the obstacle, which is omitted: it only slows Newton's method down.
                    curvature: Curvature::Flat,
                    place: Place::Obstacle(at.unwrap_or(Rigid::STILL), x),
                    memory: None,
                    kept: None,
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
        });
    }

    /// Calls `act` for each obstacle with corners that may touch.
    fn each_cornered(&self, motion: Motion<'_>, mut act: impl FnMut(&Corners<'_>)) {
        if !self.has_corners {
            return;
        }
        self.each_near(motion, self.greatest_thickness(), |number, placed, at| {
            act(&Corners::new(self.first_corner(number), placed, at, motion));
        });
    }

    /// Calls `act` for each of some corners that touches an edge.
    fn each_of_edge(&self, motion: Motion<'_>, edge: u32, corners: &Corners<'_>, act: &mut dyn FnMut(&Touch)) {
        let SurfaceEdge { ends, part, .. } = self.surface.edges()[edge as usize];
        let [[ax, ay], [bx, by]] = ends.map(|end| vector(motion.x, end));
        for (number, corner) in corners.each() {
            let reach = self.greatest_thickness() + corner.radius + corner.margin;
            let [px, py] = corner.middle;
            let is_near = |p: f64, a: f64, b: f64| p > a.min(b) - reach && p < a.max(b) + reach;
            if !(is_near(px, ax, bx) && is_near(py, ay, by)) {
                continue;
            }
            let query = self.query(motion.x, part, &corner);
            let kept = || self.kept(motion.anchors, edge, number);
            let deepest = || DEPTH * query.thickness + penetration_of(kept());
            query.each(edge, |_| true, deepest, &mut |stencil| {
                act(&self.corner_touch(motion, (edge, number), corners.velocity(&corner), stencil));
            });
        }
    }

    /// A corner as a query of the edges of a part.
    fn query<'a>(&'a self, x: &'a [f64], part: u32, corner: &Corner) -> EdgeQuery<'a> {
        EdgeQuery {
            surface: &self.surface,
            x,
            point: corner.middle,
            radius: corner.radius + self.offset(part, corner.margin),
            thickness: self.potential(part).thickness,
        }
    }

    /// A contact of an edge and a corner with its velocities and its memory.
    fn corner_touch(
        &self,
        motion: Motion<'_>,
        (edge, number): (u32, u32),
        velocity: Option<[f64; 2]>,
        stencil: Stencil,
    ) -> Touch {
        let SurfaceEdge { ends: [a, b], part, .. } = self.surface.edges()[edge as usize];
        let (name, vertices) = (self.corner_name(edge, number), ([a, a, b], Members::Edge));
        let mut touch = stencil.touch(name, vertices, self.surface.mean_edge(part), self.parameters(part));
        touch.span = motion.span;
        touch.add_velocities(motion.v);
        if let Some(velocity) = velocity {
            touch.add_obstacle(velocity);
        }
        touch.remember_along(self.kept(motion.anchors, edge, number));
        touch
    }

    /// Whether a corner has an initial penetration into a part.
    pub(super) fn penetrates(&self, anchors: &[Anchor], part: u32, corner: u32) -> bool {
        let surface = self.obstacles.len() as u32 + corner;
        let own = self.own_anchors(anchors).iter().filter(|anchor| anchor.contact.surface == surface);
        let mut own = own.filter(|anchor| anchor.penetration > 0.0);
        own.any(|anchor| self.surface.numbered(anchor.contact.vertex).is_some_and(|vertex| vertex.part == part))
    }

    /// Memory of a corner at an edge, and at the edges before and after.
    pub(super) fn kept(&self, anchors: &[Anchor], edge: u32, corner: u32) -> [Option<Anchor>; 3] {
        let [before, after] = self.surface.edges()[edge as usize].neighbours;
        [edge, before, after].map(|edge| anchor_of(anchors, self.corner_name(edge, corner)))
    }
}

impl ContactTerm for ObstacleContact {
    fn each(&self, motion: Motion<'_>, act: &mut dyn FnMut(&Touch)) {
        self.each_vertex(motion, act);
        self.each_cornered(motion, |corners| {
            for edge in 0..self.surface.edges().len() as u32 {
                self.each_of_edge(motion, edge, corners, act);
            }
        });
    }

    fn each_at_start(&self, motion: Motion<'_>, act: &mut dyn FnMut(&Touch)) {
        self.each(motion, act);
        self.each_cornered(motion, |corners| {
            for (number, corner) in corners.each() {
                for (part, edges) in self.surface.bodies() {
                    let query = self.query(motion.x, part, &corner);
                    if !self.surface.is_inside(part, |end| vector(motion.x, end), corner.middle) {
                        continue;
                    }
                    let nearest = query.nearest(edges);
                    if let Some((edge, stencil)) = nearest.and_then(|edge| Some((edge, query.inside(edge)?))) {
                        act(&self.corner_touch(motion, (edge, number), corners.velocity(&corner), stencil));
                    }
                }
            }
        });
    }

    /// A vertex may touch an obstacle while one of its edges touches a corner.
    fn square_frequency(&self, motion: Motion<'_>) -> f64 {
        let square = |vertex: &SurfaceVertex| {
            let inverse = vector(motion.inverse_mass, vertex.vertex);
            let area = if self.has_corners { vertex.area + self.surface.mean_edge(vertex.part) } else { vertex.area };
            area * self.potential(vertex.part).greatest_stiffness() * inverse[0].max(inverse[1])
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

    /// The ends of each edge, once for each obstacle with corners.
    fn sparsity_pattern(&self, _: &[Pair], add: &mut dyn FnMut(u32, u32)) {
        for _ in self.obstacles.iter().filter(|placed| !placed.obstacle.corners().is_empty()) {
            self.surface.edges().iter().for_each(|edge| add(edge.ends[0], edge.ends[1]));
        }
    }

    fn add_stiffness(&self, motion: Motion<'_>, weights: Weights, matrix: &mut dyn SparseMatrix) {
        let Some(matrix) = matrix.blocks::<2>() else { return };
        self.each_vertex(motion, &mut |touch| {
            matrix.diagonal(touch.vertices[0] as usize, &touch.linearised(weights).block(0, 0));
        });
        let mut first = 0;
        for placed in self.obstacles.iter().filter(|placed| !placed.obstacle.corners().is_empty()) {
            let corners = Corners::new(first, placed, placed.within(motion.time, motion.span), motion);
            for edge in 0..self.surface.edges().len() as u32 {
                let mut block = nalgebra::Matrix2::zeros();
                self.each_of_edge(motion, edge, &corners, &mut |touch| {
                    let linearised = touch.linearised(weights);
                    for i in touch.members.range() {
                        matrix.diagonal(touch.vertices[i] as usize, &linearised.block(i, i));
                    }
                    block += linearised.block(1, 2);
                });
                matrix.off_diagonal(&block);
            }
            first += placed.obstacle.corners().len() as u32;
        }
    }
}
