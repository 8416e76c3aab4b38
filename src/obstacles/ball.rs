//! Obstacle: a disk.

use super::{Obstacle, ObstacleParameters, Similarity, solid::Solid};
use crate::quantity::{Coordinate, Point, Quantity, Radius, Reach};
use serde::{Deserialize, Serialize};

/// A round obstacle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ball {
    /// Middle \[m\].
    pub centre: Point,
    /// Radius \[m\].
    pub radius: Radius,
    /// How near a vertex feels it \[m\].
    pub eps: Reach,
}

impl Default for Ball {
    fn default() -> Self {
        let half = Coordinate::literal(0.5);
        Self { centre: Point(half, Coordinate::literal(0.2)), radius: Radius::literal(0.1), eps: Reach::literal(0.01) }
    }
}

impl ObstacleParameters for Ball {
    fn build(&self) -> Result<Box<dyn Obstacle>, String> {
        let (centre, radius) = (self.centre.get(), self.radius.get());
        let shape = parry2d::shape::Ball::new(radius);
        Ok(Box::new(Solid::in_plane(shape, centre, self.eps.get()).with_corners(radius, &[centre], true)))
    }

    fn place(&self) -> [f64; 3] {
        let [x, y] = self.centre.get();
        [x, y, 0.0]
    }

    fn arrange(&mut self, by: &Similarity) -> Option<()> {
        self.centre = by.of_point(self.centre)?;
        by.scale([&mut self.radius])
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.radius, &mut self.eps]
    }

    fn outline(&self) -> Vec<[f64; 2]> {
        const CORNERS: u32 = 64;
        let ([x, y], radius) = (self.centre.get(), self.radius.get() + self.eps.get());
        let turn = |i| f64::from(i) * std::f64::consts::TAU / f64::from(CORNERS);
        (0..CORNERS).map(|i| [x + radius * libm::cos(turn(i)), y + radius * libm::sin(turn(i))]).collect()
    }
}
