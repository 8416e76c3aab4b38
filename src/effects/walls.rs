use super::{Effect, EffectParameters, Motion, Shape};
use crate::{
    elements::Elements,
    obstacles::{Ball, Obstacle, ObstacleKind, room},
    quantity::Quantity,
};
use serde::{Deserialize, Serialize};

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
        "A vertex within ε of a wall that moves inwards: v ← v − min(0, v·n) n. One that got inside is put back."
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

    fn build(&self, _: &Elements) -> Result<Box<dyn Effect>, String> {
        let build = |(number, kind): (usize, &ObstacleKind)| {
            kind.kind().build().map_err(|why| format!("obstacle {number} ({}): {why}", kind.name()))
        };
        let obstacles = self.obstacles.iter().enumerate().map(build).collect::<Result<_, _>>()?;
        Ok(Box::new(Contacts(obstacles)))
    }
}

struct Contacts(Vec<Box<dyn Obstacle>>);

impl Contacts {
    /// The obstacles that are near enough to the box around all vertices to be worth a look at each of them.
    fn near<'a>(&'a self, x: &[f64]) -> impl Iterator<Item = &'a dyn Obstacle> + use<'a> {
        let (mut least, mut greatest) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for point in x.chunks_exact(2) {
            for axis in 0..2 {
                least[axis] = if point[axis] < least[axis] { point[axis] } else { least[axis] };
                greatest[axis] = if point[axis] > greatest[axis] { point[axis] } else { greatest[axis] };
            }
        }
        self.0.iter().map(AsRef::as_ref).filter(move |obstacle| obstacle.is_near(least, greatest))
    }
}

impl Effect for Contacts {
    fn name(&self) -> &'static str {
        "Walls"
    }

    fn elements(&self, motion: Motion<'_>) -> usize {
        self.0.len() * motion.x.len() / 2
    }

    fn constrains(&self) -> bool {
        true
    }

    fn constrain_velocity(&self, x: &[f64], v: &mut [f64], inverse_mass: &[f64]) -> usize {
        self.near(x).map(|obstacle| obstacle.constrain_velocity(x, v, inverse_mass)).sum()
    }

    fn constrain_position(&self, x: &mut [f64], v: &mut [f64], inverse_mass: &[f64]) -> usize {
        self.near(x).map(|obstacle| obstacle.constrain_position(x, v, inverse_mass)).sum()
    }
}
