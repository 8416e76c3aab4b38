//! Obstacle in space: a sphere.

use super::{Obstacle, ObstacleParameters, Similarity, Surfaces, Triangulation, solid::Solid};
use crate::quantity::{Coordinate, Quantity, Radius, Reach, SpacePoint};
use parry3d::{
    math::{Pose, Vector},
    shape::Ball,
};
use serde::{Deserialize, Serialize};

/// A sphere in space.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sphere {
    /// Middle \[m\].
    pub centre: SpacePoint,
    /// Radius \[m\].
    pub radius: Radius,
    /// How near a vertex feels it \[m\].
    pub eps: Reach,
}

impl Default for Sphere {
    fn default() -> Self {
        let zero = Coordinate::literal(0.0);
        Self { centre: SpacePoint(zero, zero, zero), radius: Radius::literal(0.3), eps: Reach::literal(0.01) }
    }
}

impl Sphere {
    fn pose(&self) -> Pose {
        let [x, y, z] = self.centre.get();
        Pose::from_translation(Vector::new(x, y, z))
    }
}

impl ObstacleParameters for Sphere {
    fn dimension(&self) -> usize {
        3
    }

    fn build_in_space(&self, _: &Surfaces) -> Result<Box<dyn Obstacle<3>>, String> {
        let radius = self.radius.get();
        Ok(Box::new(Solid::in_space(Ball::new(radius), self.pose(), self.eps.get()).with_radius(radius)))
    }

    fn place(&self) -> [f64; 3] {
        self.centre.get()
    }

    fn arrange(&mut self, by: &Similarity) -> Option<()> {
        self.centre = by.of_space_point(self.centre)?;
        by.scale([&mut self.radius])
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.radius, &mut self.eps]
    }

    fn triangulation(&self, _: &Surfaces) -> Triangulation {
        Triangulation::new(Ball::new(self.radius.get()).to_trimesh(48, 24), self.pose())
    }
}
