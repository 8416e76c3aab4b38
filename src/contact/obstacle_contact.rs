//! Contact of the vertices of a scene with obstacles.

use super::{
    ContactName, ContactTerm, Curvature, Place, Potential, Skin, SurfaceVertex, SurfaceVertices, Touch, touch::vector,
};
use crate::{
    effects::{Bounds, Motion, NO_OBSTACLE_NEAR},
    obstacles::{MotionKind, Obstacle, Rigid, placed},
};

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

impl ObstacleContact {
    /// Contact with some obstacles, where the surface has a skin and friction.
    pub fn new((skin, friction): (Skin, f64), surface: &SurfaceVertices, obstacles: Vec<PlacedObstacle>) -> Self {
        let vertices: Vec<_> = surface.iter().map(|vertex| (*vertex, surface.potential(skin, vertex))).collect();
        let reach = vertices.iter().map(|(_, potential)| potential.thickness).fold(0.0, f64::max);
        Self { number: 0, skin, friction, reach, vertices, obstacles }
    }

    /// Box around the vertices.
    fn bounds(&self, x: &[f64]) -> Bounds {
        let mut bounds = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        for (vertex, _) in &self.vertices {
            let point = vector(x, vertex.vertex);
            for axis in 0..2 {
                bounds[0][axis] = bounds[0][axis].min(point[axis]);
                bounds[1][axis] = bounds[1][axis].max(point[axis]);
            }
        }
        Bounds(bounds)
    }

    /// Tells it the number of its effect in the scene.
    pub const fn set_number(&mut self, number: usize) {
        self.number = number as u32;
    }
}

impl ContactTerm for ObstacleContact {
    fn each(&self, motion: Motion<'_>, act: &mut dyn FnMut(&Touch)) {
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
                let x = vector(motion.x, vertex.vertex);
                let seen = if still { x } else { at.back(x) };
                // The skin begins at the contact margin, or at its thickness if that is greater.
                let offset = (obstacle.margin() - potential.thickness).max(0.0);
                let Some(contact) = obstacle.distance(seen, potential.thickness + offset) else { continue };
                let [nx, ny] = if still { contact.normal } else { at.normal(contact.normal) };
                let ([vx, vy], [wx, wy]) =
                    (vector(motion.v, vertex.vertex), if still { [0.0; 2] } else { at.velocity_at(x) });
                let (vx, vy) = (vx - wx, vy - wy);
                let name = ContactName { effect: self.number, surface: number as u32, vertex: vertex.vertex };
                let mut touch = Touch {
                    name,
                    vertices: [vertex.vertex; 3],
                    count: 1,
                    weights: [1.0, 0.0, 0.0],
                    normal: [nx, ny],
                    slips: [[ny, -nx], [0.0; 2], [0.0; 2]],
                    area: vertex.area,
                    potential: *potential,
                    dissipation: self.skin.dissipation,
                    friction: self.friction,
                    depenetration_speed: vertex.depenetration_speed,
                    gap: contact.distance - offset,
                    approach: nx * vx + ny * vy,
                    sliding: ny * vx - nx * vy,
                    obstacle_velocity: [wx, wy],
                    // That of the obstacle, which is omitted: it only slows Newton's method down.
                    curvature: Curvature::Flat,
                    place: Place::Obstacle(at, x),
                    memory: None,
                    kept: None,
                };
                while anchors.next_if(|anchor| anchor.contact < name).is_some() {}
                if let Some(anchor) = anchors.peek().filter(|anchor| anchor.contact == name) {
                    touch.remember(**anchor);
                }
                act(&touch);
            }
        }
    }

    fn square_frequency(&self, motion: Motion<'_>) -> f64 {
        let square = |(vertex, potential): &(SurfaceVertex, Potential)| {
            let inverse = vector(motion.inverse_mass, vertex.vertex);
            vertex.area * potential.greatest_stiffness() * inverse[0].max(inverse[1])
        };
        self.vertices.iter().map(square).fold(0.0, f64::max)
    }

    fn moves(&self) -> bool {
        self.obstacles.iter().any(|placed| !placed.motions.is_empty())
    }

    fn idle(&self, motion: Motion<'_>) -> Option<&'static str> {
        let [least, greatest] = self.bounds(motion.x).grown(self.reach).0;
        let near = |placed: &PlacedObstacle| !placed.motions.is_empty() || placed.obstacle.is_near(least, greatest);
        (!self.obstacles.iter().any(near)).then_some(NO_OBSTACLE_NEAR)
    }
}
