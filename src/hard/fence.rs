//! Distance by which vertices leave their domain.

use crate::{
    effects::EffectKind,
    level::{Level, RunMode, Switch, When},
    obstacles::Obstacle,
    quantity::Point,
    scene::{Scene, extent},
};

/// Boundaries that no vertex may cross: the walls of a level, the edges of its world, and a box.
pub struct Fence {
    obstacles: Vec<Box<dyn Obstacle>>,
    /// Lower left and upper right corners [m].
    boxes: Vec<[[f64; 2]; 2]>,
    /// Longest side of the bounding boxes of the bodies at rest [m].
    size: f64,
}

impl Fence {
    /// Boundaries of a level, and an additional box.
    pub fn new(level: &Level, scene: &Scene, within: Option<(Point, Point)>) -> Self {
        let mut obstacles = Vec::new();
        let mut boxes: Vec<_> = within.iter().map(|(least, greatest)| [least.get(), greatest.get()]).collect();
        let acts = |when: When| when == When::Always || level.mode == RunMode::Collide;
        for listed in level.effects.iter().filter(|listed| listed.switch == Switch::On && acts(listed.when)) {
            match &listed.effect {
                EffectKind::Boundary(edges) => boxes.push([edges.least.get(), edges.greatest.get()]),
                // A wall that cannot be built also prevents the scene.
                EffectKind::Walls(walls) => {
                    obstacles.extend(walls.obstacles.iter().filter_map(|kind| kind.kind().build().ok()));
                }
                _ => {}
            }
        }
        let sides = scene.bodies.iter().flat_map(|body| {
            let rest = &scene.rest[2 * body.vertices.start..2 * body.vertices.end];
            [0, 1].map(|axis| extent(rest, axis)).map(|(least, greatest)| greatest - least)
        });
        Self { obstacles, boxes, size: sides.fold(0.0, f64::max) }
    }

    /// Greatest distance of the points (flat, [m]) beyond the boundaries, as a share of the size of the bodies.
    pub fn beyond(&self, x: &[f64]) -> f64 {
        let mut farthest = 0.0_f64;
        for point in x.chunks_exact(2) {
            for [least, greatest] in &self.boxes {
                for axis in 0..2 {
                    farthest = farthest.max(least[axis] - point[axis]).max(point[axis] - greatest[axis]);
                }
            }
            for obstacle in &self.obstacles {
                let depth = obstacle.contact([point[0], point[1]]).map_or(0.0, |contact| -contact.distance);
                farthest = farthest.max(depth);
            }
        }
        farthest / self.size
    }
}
