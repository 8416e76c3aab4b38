//! Contact of the vertices of a scene with obstacles.

use super::{Anchor, ContactName, Potential, Skin, SurfaceVertex, SurfaceVertices};
use crate::{
    effects::{Bounds, Motion, NO_OBSTACLE_NEAR},
    obstacles::{Contact, MotionKind, Obstacle, Rigid, placed},
    solvers::{SparseMatrix, Weights},
};
use nalgebra::Matrix2;

/// An obstacle with the motion that it is told.
pub struct PlacedObstacle {
    /// The obstacle, where it is without its motions.
    pub obstacle: Box<dyn Obstacle>,
    /// Its motions; empty for an obstacle at rest.
    pub motions: Vec<MotionKind>,
}

/// Contact of all vertices that have a skin with the obstacles of an effect.
pub struct ObstacleContact {
    /// Number of the effect in the scene.
    number: u32,
    skin: Skin,
    /// mu.
    friction: f64,
    /// Greatest thickness of the skin \[m\].
    reach: f64,
    /// The vertices with the potentials of their skins.
    vertices: Vec<(SurfaceVertex, Potential)>,
    obstacles: Vec<PlacedObstacle>,
}

/// A vertex in contact with an obstacle.
struct Touch<'a> {
    vertex: &'a SurfaceVertex,
    name: ContactName,
    potential: Potential,
    /// c [s/m], mu.
    dissipation: f64,
    friction: f64,
    /// Placement of the obstacle.
    at: Rigid,
    contact: Contact,
    /// Position \[m\], and velocity relative to the obstacle [m/s].
    x: [f64; 2],
    v: [f64; 2],
    /// Displacement from the anchor along the tangent \[m\], and initial penetration \[m\]; `None` for a new contact.
    memory: Option<(f64, f64)>,
    /// The same as it is kept.
    kept: Option<Anchor>,
}

impl Touch<'_> {
    /// The normal turned clockwise.
    const fn tangent(&self) -> [f64; 2] {
        let [nx, ny] = self.contact.normal;
        [ny, -nx]
    }

    /// Components of a vector along the normal and along the tangent.
    fn components(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let ([nx, ny], [tx, ty]) = (self.contact.normal, self.tangent());
        [nx * x + ny * y, tx * x + ty * y]
    }

    /// The vector with these components.
    fn vector(&self, [along, across]: [f64; 2]) -> [f64; 2] {
        let ([nx, ny], [tx, ty]) = (self.contact.normal, self.tangent());
        [along * nx + across * tx, along * ny + across * ty]
    }

    /// Memory of the contact with a displacement from the anchor and an initial penetration \[m\].
    fn anchor(&self, u: f64, penetration: f64) -> Anchor {
        let [dx, dy] = self.vector([0.0, u]);
        let point = self.at.back([self.x[0] - dx, self.x[1] - dy]);
        Anchor { contact: self.name, point, penetration }
    }

    fn pressure(&self) -> f64 {
        self.potential.pressure(self.contact.distance)
    }

    /// Greatest friction \[Pa\].
    fn limit(&self) -> f64 {
        self.friction * self.pressure() * self.damped()
    }

    /// Factor of the pressure by dissipation (Hunt and Crossley, 1975): `(1 - c dg/dt)`, never negative.
    fn damped(&self) -> f64 {
        let [approach, _] = self.components(self.v);
        (1.0 - self.dissipation * approach).max(0.0)
    }

    /// Energy \[J\].
    fn energy(&self) -> f64 {
        let friction = self.memory.map_or(0.0, |(u, _)| self.potential.friction_energy(u, self.limit()));
        self.vertex.area * (self.potential.energy(self.contact.distance) + friction)
    }

    /// Traction of friction against the tangent \[Pa\], and whether it sticks.
    fn traction(&self) -> (f64, bool) {
        let Some((u, _)) = self.memory else { return (0.0, false) };
        let [_, sliding] = self.components(self.v);
        self.potential.traction(u, self.dissipation * self.pressure() * sliding, self.limit())
    }

    /// Force on the vertex \[N\].
    fn force(&self) -> [f64; 2] {
        let area = self.vertex.area;
        self.vector([area * self.pressure() * self.damped(), -area * self.traction().0])
    }

    /// Stiffness and damping of the force along the normal and along the tangent [N/m, N s/m]. The curvature of the obstacle
    /// and the change of the greatest friction with the pressure are omitted: the first is small, the second not symmetric.
    fn stiffness(&self) -> [[f64; 2]; 2] {
        let (area, damped, pressure) = (self.vertex.area, self.damped(), self.pressure());
        let damping = if damped > 0.0 { area * self.dissipation * pressure } else { 0.0 };
        let along = [area * damped * self.potential.stiffness(self.contact.distance), damping];
        let across = if self.traction().1 {
            [area * self.potential.tangential_stiffness(), area * self.dissipation * pressure]
        } else {
            [0.0; 2]
        };
        [along, across]
    }
}

impl ObstacleContact {
    /// Contact with some obstacles, where the surface has a skin and friction.
    pub fn new((skin, friction): (Skin, f64), surface: &SurfaceVertices, obstacles: Vec<PlacedObstacle>) -> Self {
        let vertices: Vec<_> = surface.iter().map(|vertex| (*vertex, surface.potential(skin, vertex))).collect();
        let reach = vertices.iter().map(|(_, potential)| potential.thickness).fold(0.0, f64::max);
        Self { number: 0, skin, friction, reach, vertices, obstacles }
    }

    /// Calls `act` for each vertex within its skin of an obstacle, in the order of their names.
    fn each(&self, motion: Motion<'_>, mut act: impl FnMut(&Touch<'_>)) {
        let [least, greatest] = self.bounds(motion.x).grown(self.reach).0;
        let mut anchors = motion.anchors.iter().peekable();
        for (number, placed_obstacle) in self.obstacles.iter().enumerate() {
            let PlacedObstacle { obstacle, motions } = placed_obstacle;
            let still = motions.is_empty();
            let at = if still { Rigid::STILL } else { placed(motions, motion.time) };
            if still && !obstacle.is_near(least, greatest) {
                continue;
            }
            for (vertex, potential) in &self.vertices {
                let first = 2 * vertex.vertex as usize;
                let x = pair(motion.x, first);
                let seen = if still { x } else { at.back(x) };
                // The skin begins at the contact margin, or at its thickness if that is greater.
                let offset = (obstacle.margin() - potential.thickness).max(0.0);
                let Some(contact) = obstacle.distance(seen, potential.thickness + offset) else { continue };
                let v = pair(motion.v, first);
                let normal = if still { contact.normal } else { at.normal(contact.normal) };
                let wall = if still { [0.0; 2] } else { at.velocity_at(x) };
                let name = ContactName { effect: self.number, obstacle: number as u32, vertex: vertex.vertex };
                let mut touch = Touch {
                    vertex,
                    name,
                    potential: *potential,
                    dissipation: self.skin.dissipation,
                    friction: self.friction,
                    at,
                    contact: Contact { normal, distance: contact.distance - offset },
                    x,
                    v: [v[0] - wall[0], v[1] - wall[1]],
                    memory: None,
                    kept: None,
                };
                while anchors.next_if(|anchor| anchor.contact < name).is_some() {}
                touch.kept = anchors.peek().filter(|anchor| anchor.contact == name).map(|anchor| **anchor);
                touch.memory = touch.kept.map(|anchor| {
                    let [ax, ay] = at.point(anchor.point);
                    touch.contact.distance += anchor.penetration;
                    (touch.components([x[0] - ax, x[1] - ay])[1], anchor.penetration)
                });
                act(&touch);
            }
        }
    }

    /// Box around the vertices.
    fn bounds(&self, x: &[f64]) -> Bounds {
        let mut bounds = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        for (vertex, _) in &self.vertices {
            let point = pair(x, 2 * vertex.vertex as usize);
            for axis in 0..2 {
                bounds[0][axis] = bounds[0][axis].min(point[axis]);
                bounds[1][axis] = bounds[1][axis].max(point[axis]);
            }
        }
        Bounds(bounds)
    }

    /// Whether a skin is compressed.
    pub fn touches(&self, motion: Motion<'_>) -> bool {
        let mut touches = false;
        self.each(motion, |touch| touches |= touch.pressure() > 0.0);
        touches
    }

    /// Power of the moving obstacles on the bodies, and of the decrease of initial penetration \[W\].
    pub fn power_of_obstacles(&self, motion: Motion<'_>) -> f64 {
        let mut power = 0.0;
        if self.moves() || motion.anchors.iter().any(|anchor| anchor.penetration > 0.0) {
            self.each(motion, |touch| {
                let ([fx, fy], [vx, vy]) = (touch.force(), touch.at.velocity_at(touch.x));
                power += fx * vx + fy * vy;
                if touch.memory.is_some_and(|(_, penetration)| penetration > 0.0) {
                    power += touch.vertex.area * touch.pressure() * touch.vertex.depenetration_speed;
                }
            });
        }
        power
    }

    /// Greatest square of the angular frequency of a vertex on its fully compressed skin [1/s²].
    pub fn square_frequency(&self, motion: Motion<'_>) -> f64 {
        let square = |(vertex, potential): &(SurfaceVertex, Potential)| {
            let inverse = pair(motion.inverse_mass, 2 * vertex.vertex as usize);
            vertex.area * potential.greatest_stiffness() * inverse[0].max(inverse[1])
        };
        self.vertices.iter().map(square).fold(0.0, f64::max)
    }

    /// Adds the memory of all contacts after a step of length h \[s\], in the order of their names: new contacts get an anchor,
    /// those that slide drag theirs, and the initial penetration decreases.
    pub fn drag_anchors(&self, motion: Motion<'_>, h: f64, anchors: &mut Vec<Anchor>) {
        self.each(motion, |touch| {
            let (u, penetration) = touch.memory.unwrap_or_default();
            let penetration = (penetration - h * touch.vertex.depenetration_speed).max(0.0);
            anchors.push(touch.anchor(touch.potential.dragged(u, touch.limit()), penetration));
        });
    }

    /// Adds the memory of all contacts of a state that was not stepped to: those without memory begin without a force.
    pub fn add_penetrations(&self, motion: Motion<'_>, anchors: &mut Vec<Anchor>) {
        self.each(motion, |touch| {
            let missing = touch.potential.thickness - touch.contact.distance;
            anchors.push(touch.kept.unwrap_or_else(|| touch.anchor(0.0, missing)));
        });
    }

    fn moves(&self) -> bool {
        self.obstacles.iter().any(|placed| !placed.motions.is_empty())
    }

    /// Tells it the number of its effect in the scene.
    pub const fn set_number(&mut self, number: usize) {
        self.number = number as u32;
    }

    /// Reason why no skin can be compressed, if so.
    pub fn idle(&self, motion: Motion<'_>) -> Option<&'static str> {
        let [least, greatest] = self.bounds(motion.x).grown(self.reach).0;
        let near = |placed: &PlacedObstacle| !placed.motions.is_empty() || placed.obstacle.is_near(least, greatest);
        (!self.obstacles.iter().any(near)).then_some(NO_OBSTACLE_NEAR)
    }

    /// Energy \[J\].
    pub fn energy(&self, motion: Motion<'_>) -> f64 {
        let mut energy = 0.0;
        self.each(motion, |touch| energy += touch.energy());
        energy
    }

    /// Adds the forces \[N\].
    pub fn force(&self, motion: Motion<'_>, force: &mut [f64]) {
        self.each_force(motion, |vertex, [x, y]| {
            force[2 * vertex] += x;
            force[2 * vertex + 1] += y;
        });
    }

    /// Calls `act` for each vertex in contact with the force on it \[N\].
    pub fn each_force(&self, motion: Motion<'_>, mut act: impl FnMut(usize, [f64; 2])) {
        self.each(motion, |touch| act(touch.vertex.vertex as usize, touch.force()));
    }

    /// Adds the product of the stiffness with a displacement \[N\].
    pub fn stiffness_times(&self, motion: Motion<'_>, d: &[f64], product: &mut [f64]) {
        self.each(motion, |touch| {
            let at = 2 * touch.vertex.vertex as usize;
            let ([along, across], [[normal, _], [tangential, _]]) = (touch.components(pair(d, at)), touch.stiffness());
            let [x, y] = touch.vector([normal * along, tangential * across]);
            product[at] += x;
            product[at + 1] += y;
        });
    }

    /// Adds the weighted stiffness and damping.
    pub fn add_stiffness(&self, motion: Motion<'_>, weights: Weights, matrix: &mut dyn SparseMatrix) {
        let Some(matrix) = matrix.blocks::<2>() else { return };
        self.each(motion, |touch| {
            let [normal, tangential] =
                touch.stiffness().map(|[stiffness, damping]| weights.position * stiffness + weights.velocity * damping);
            let ([nx, ny], [tx, ty]) = (touch.contact.normal, touch.tangent());
            let entry = |a: f64, b: f64, c: f64, d: f64| normal * a * b + tangential * c * d;
            let cross = entry(nx, ny, tx, ty);
            let block = Matrix2::new(entry(nx, nx, tx, tx), cross, cross, entry(ny, ny, ty, ty));
            matrix.diagonal(touch.vertex.vertex as usize, &block);
        });
    }

    /// Rates of damping, as [`crate::effects::Effect::damping`].
    pub fn damping(&self, motion: Motion<'_>) -> [f64; 2] {
        let mut greatest = 0.0_f64;
        self.each(motion, |touch| {
            let inverse = pair(motion.inverse_mass, 2 * touch.vertex.vertex as usize);
            let [[_, normal], [_, tangential]] = touch.stiffness();
            greatest = greatest.max(normal.max(tangential) * inverse[0].max(inverse[1]));
        });
        [greatest, 0.0]
    }
}

/// The two numbers of a vertex.
fn pair(values: &[f64], at: usize) -> [f64; 2] {
    [values[at], values[at + 1]]
}
