use super::{Bounds, Effect, EffectParameters, Motion, Shape, around};
use crate::{
    elements::Elements,
    obstacles::{Ball, Obstacle, ObstacleKind, Start, press_edges, room, stop_edges},
    quantity::Quantity,
};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Obstacles that vertices bump into: planes that make a room, and solids inside it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Walls {
    /// The obstacles.
    pub obstacles: Vec<ObstacleKind>,
}

impl Default for Walls {
    fn default() -> Self {
        Self { obstacles: vec![ObstacleKind::Ball(Ball::default())] }
    }
}

impl EffectParameters for Walls {
    fn title(&self) -> &'static str {
        "Walls"
    }

    fn about(&self) -> &'static str {
        "A vertex within ε of a wall that moves inwards: v ← v − min(0, v·n) n. At any speed it stops where it first touches, and so does an edge at a corner."
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        self.obstacles
            .iter_mut()
            .filter(|kind| !matches!(kind, ObstacleKind::Plane(_)))
            .flat_map(|kind| kind.kind_mut().parameters())
            .collect()
    }

    fn shapes(&self) -> Vec<Shape> {
        let planes = || {
            self.obstacles
                .iter()
                .filter_map(|kind| if let ObstacleKind::Plane(plane) = kind { Some(plane) } else { None })
        };
        let solids = self.obstacles.iter().map(|kind| kind.kind().outline()).filter(|outline| !outline.is_empty());
        let room = planes().next().is_some().then(|| Shape::Room(room(planes(), [0.0, 0.0], [1.0, 1.0])));
        room.into_iter().chain(solids.map(Shape::Solid)).collect()
    }

    fn vain(&self) -> Option<&'static str> {
        self.obstacles.is_empty().then_some("there are no obstacles in it")
    }

    fn build(&self, elements: &Elements) -> Result<Box<dyn Effect>, String> {
        let build = |(number, kind): (usize, &ObstacleKind)| {
            kind.kind().build().map_err(|why| format!("obstacle {number} ({}): {why}", kind.name()))
        };
        let obstacles = self.obstacles.iter().enumerate().map(build).collect::<Result<Vec<_>, _>>()?;
        Ok(Box::new(Contacts { obstacles, boundary: Arc::clone(&elements.boundary) }))
    }
}

struct Contacts {
    obstacles: Vec<Box<dyn Obstacle>>,
    /// Edges of the bodies' boundaries, with the body on their left.
    boundary: Arc<Vec<[u32; 2]>>,
}

/// How often what was stopped is looked at again, as that may make others touch, before it stays where the step began.
const ROUNDS: usize = 8;

impl Contacts {
    /// The obstacles that are near enough to a box to be worth a look at each vertex in it.
    fn near(&self, [least, greatest]: [[f64; 2]; 2]) -> impl Iterator<Item = &dyn Obstacle> + Clone {
        self.obstacles.iter().map(AsRef::as_ref).filter(move |obstacle| obstacle.is_near(least, greatest))
    }

    /// Edges stop at corners, and vertices that this turned aside at obstacles, until nothing touches any more; what still
    /// would stays where it was when the step began, where nothing touched.
    fn stop_edges(&self, bounds: [[f64; 2]; 2], start: &Start<'_>, x: &mut [f64], v: &mut [f64]) -> usize {
        let near = self.near(bounds);
        let mut touched = 0;
        let stop = |x: &mut [f64], v: &mut [f64]| -> usize {
            near.clone().map(|obstacle| stop_edges((obstacle.corners(), &self.boundary, bounds), start, x, v)).sum()
        };
        for _ in 0..ROUNDS {
            let stopped = stop(x, v);
            if stopped == 0 {
                return touched;
            }
            touched += stopped;
            near.clone().for_each(|obstacle| touched += obstacle.constrain(start, x, v));
        }
        let mut held = x.to_vec();
        for _ in 0..self.boundary.len() {
            if stop(x, v) == 0 {
                break;
            }
            let changed = x.chunks_exact_mut(2).zip(held.chunks_exact_mut(2)).zip(v.chunks_exact_mut(2)).enumerate();
            for (vertex, ((x, held), v)) in changed.filter(|(_, ((x, held), _))| x != held) {
                let from = &start.x[2 * vertex..][..2];
                x.copy_from_slice(from);
                held.copy_from_slice(from);
                v.fill(0.0);
            }
        }
        touched
    }
}

impl Effect for Contacts {
    fn name(&self) -> &'static str {
        "Walls"
    }

    fn elements(&self, motion: Motion<'_>) -> usize {
        self.obstacles.len() * motion.x.len() / 2
    }

    fn is_clear(&self, [least, greatest]: Bounds) -> bool {
        !self.obstacles.iter().any(|obstacle| obstacle.may_reach(least, greatest))
    }

    fn constrains(&self) -> bool {
        true
    }

    fn constrain(&self, start: &Start<'_>, x: &mut [f64], v: &mut [f64]) -> usize {
        let bounds = around(start.x, x);
        let mut touched = 0;
        for obstacle in self.near(bounds) {
            touched += press_edges((obstacle.corners(), &self.boundary, bounds), start, x, v);
        }
        for obstacle in self.near(bounds) {
            touched += obstacle.constrain(start, x, v);
        }
        touched + self.stop_edges(bounds, start, x, v)
    }
}
