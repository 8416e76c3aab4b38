//! Contact of edges with the convex corners of obstacles in the plane.

use super::{
    Anchor, BetweenVertices, ContactName, Members, Met, ObstacleContact, Path, PlacedObstacle, SurfaceEdge, Touch,
    edge_meeting::{meeting, nearest},
    edge_query::{DEPTH, EdgeQuery},
    friction::{anchor_of, penetration_of},
    stencil::Stencil,
    touch::vector,
    truncation::{Clearance, FLOOR},
};
use crate::{
    effects::{Bounds, Motion},
    obstacles::{Corner, Rigid, SweptMotion},
    solvers::{SparseMatrix, Weights},
};

/// A corner touches edges as the vertex of another body would; its area is the mean length of the edges.
impl BetweenVertices<2, 1, 3> for ObstacleContact {
    fn each_between(&self, motion: Motion<'_>, act: &mut dyn FnMut(&Touch)) {
        self.each_cornered(motion, |corners| {
            for edge in 0..self.surface.edges().len() as u32 {
                self.each_of_edge(motion, edge, corners, act);
            }
        });
    }

    fn each_between_inside(&self, motion: Motion<'_>, act: &mut dyn FnMut(&Touch)) {
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

    fn between_pattern(&self, add: &mut dyn FnMut(u32, u32)) {
        for _ in self.obstacles.iter().filter(|placed| !placed.obstacle.corners().is_empty()) {
            self.surface.edges().iter().for_each(|edge| add(edge.ends[0], edge.ends[1]));
        }
    }

    fn add_between_stiffness(&self, motion: Motion<'_>, weights: Weights, matrix: &mut dyn SparseMatrix) {
        let Some(matrix) = matrix.blocks::<2>() else { return };
        let mut first = 0;
        for placed in self.obstacles.iter().filter(|placed| !placed.obstacle.corners().is_empty()) {
            let corners = Corners::new(first, placed, placed.within(motion.time, motion.span), motion);
            for edge in 0..self.surface.edges().len() as u32 {
                let mut block = nalgebra::Matrix2::zeros();
                self.each_of_edge(motion, edge, &corners, &mut |touch| {
                    let linearised = touch.linearised(weights);
                    for i in touch.range() {
                        matrix.diagonal(touch.vertices[i] as usize, &linearised.block(i, i));
                    }
                    block += linearised.block(1, 2);
                });
                matrix.off_diagonal(&block);
            }
            first += placed.obstacle.corners().len() as u32;
        }
    }

    fn each_candidate_between(
        &self,
        path: &Path<'_>,
        (number, motion, _): (usize, &SweptMotion, bool),
        act: &mut dyn FnMut(u32, u32),
    ) {
        let placed = &self.obstacles[number];
        let corners = placed.obstacle.corners();
        for edge in 0..if corners.is_empty() { 0 } else { self.surface.edges().len() as u32 } {
            let ends = self.surface.edges()[edge as usize].ends;
            let [a, b] = ends.map(|end| motion.place(vector(path.start, end)));
            let [c, d] = ends.map(|end| vector(path.end, end));
            let bounds = Bounds::of([a, b, c, d].as_flattened()).grown(self.greatest_thickness());
            if placed.is_near(bounds, motion.end()) {
                for (number, corner) in (0..).zip(corners) {
                    let Corner { middle, radius, margin } = corner.placed(motion.end());
                    let Bounds([least, greatest]) = bounds.grown(radius + margin);
                    if (0..2).all(|axis| middle[axis] > least[axis] && middle[axis] < greatest[axis]) {
                        act(edge, number);
                    }
                }
            }
        }
    }

    fn find_between(
        &self,
        path: &Path<'_>,
        (number, motion): (usize, &SweptMotion),
        (edge, corner): (u32, u32),
    ) -> Option<Met<2>> {
        let SurfaceEdge { ends, part, .. } = self.surface.edges()[edge as usize];
        let Corner { middle, radius, margin } =
            self.obstacles[number].obstacle.corners()[corner as usize].placed(motion.end());
        let kept = self.kept(path.known(), edge, self.first_corner(number) + corner);
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
        let penetrates = || self.penetrates(path.known(), part, self.first_corner(number) + corner);
        if penetrates() && self.surface.is_inside(part, |end| vector(path.start, end), motion.back(middle)) {
            return None;
        }
        let ([nx, ny], t, _) = nearest(at);
        let along = |[px, py]: [f64; 2]| nx * px + ny * py;
        let reached = along(to[0]) - (1.0 - t) * along(to[1]) - t * along(to[2]);
        Some(Met {
            vertices: [ends[0], ends[1], ends[1]].map(|end| end as usize),
            weights: [1.0 - t, t, 0.0],
            normal: [-nx, -ny],
            missing: radius + clearance.wanted - reached,
            wall: motion.velocity_at(middle),
            share,
        })
    }

    fn split_surface(&self, surface: u32) -> Option<(usize, u32)> {
        let count = self.obstacles.len();
        let Some(mut corner) = (surface as usize).checked_sub(count) else { return Some((surface as usize, 0)) };
        for (number, placed) in self.obstacles.iter().enumerate() {
            let own = placed.obstacle.corners().len();
            if corner < own {
                return Some((number, 1 + corner as u32));
            }
            corner -= own;
        }
        None
    }

    fn join_surface(&self, obstacle: usize, part: u32) -> Option<u32> {
        let own = self.obstacles.get(obstacle)?.obstacle.corners().len();
        let Some(corner) = part.checked_sub(1) else { return Some(obstacle as u32) };
        ((corner as usize) < own).then(|| self.obstacles.len() as u32 + self.first_corner(obstacle) + corner)
    }

    /// A vertex may touch an obstacle while one of its edges touches a corner.
    fn area_around(&self, _: u32, part: u32, own: f64) -> f64 {
        if self.has_corners { own + self.surface.mean_edge(part) } else { own }
    }
}

impl ObstacleContact {
    /// Name of the contact of an edge, by the vertex where it begins, with a corner, which counts on through all obstacles.
    fn corner_name(&self, edge: u32, corner: u32) -> ContactName {
        let vertex = self.surface.edges()[edge as usize].ends[0];
        ContactName { effect: self.number(), surface: self.obstacles.len() as u32 + corner, vertex }
    }

    /// Number of the first corner of an obstacle.
    fn first_corner(&self, obstacle: usize) -> u32 {
        self.obstacles[..obstacle].iter().map(|placed| placed.obstacle.corners().len()).sum::<usize>() as u32
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
        let (name, vertices) = (self.corner_name(edge, number), ([a, a, b], Members::Surface));
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
    fn penetrates(&self, anchors: &[Anchor], part: u32, corner: u32) -> bool {
        let surface = self.obstacles.len() as u32 + corner;
        let own = self.own_anchors(anchors).iter().filter(|anchor| anchor.contact.surface == surface);
        let mut own = own.filter(|anchor| anchor.penetration > 0.0);
        own.any(|anchor| self.surface.numbered(anchor.contact.vertex).is_some_and(|vertex| vertex.part == part))
    }

    /// Memory of a corner at an edge, and at the edges before and after.
    fn kept(&self, anchors: &[Anchor], edge: u32, corner: u32) -> [Option<Anchor>; 3] {
        let [before, after] = self.surface.edges()[edge as usize].neighbours;
        [edge, before, after].map(|edge| anchor_of(anchors, self.corner_name(edge, corner)))
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
