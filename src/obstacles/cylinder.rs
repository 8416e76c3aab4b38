//! Obstacle in space: a cylinder.

use super::{Obstacle, ObstacleParameters, Similarity, Surfaces, Triangulation, solid::Solid};
use crate::quantity::{Coordinate, Height, Quantity, Radius, Reach, SpacePoint};
use parry3d::{
    math::{Pose, Vector},
    shape,
};
use serde::{Deserialize, Serialize};

/// An upright cylinder in space, such as the top of a round table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cylinder {
    /// Middle \[m\].
    pub centre: SpacePoint,
    /// Radius \[m\].
    pub radius: Radius,
    /// Height along y \[m\].
    pub height: Height,
    /// How near a vertex feels it \[m\].
    pub eps: Reach,
}

impl Default for Cylinder {
    fn default() -> Self {
        let zero = Coordinate::literal(0.0);
        Self {
            centre: SpacePoint(zero, zero, zero),
            radius: Radius::literal(0.4),
            height: Height::literal(0.04),
            eps: Reach::literal(0.01),
        }
    }
}

impl Cylinder {
    fn shape(&self) -> (shape::Cylinder, Pose) {
        let [x, y, z] = self.centre.get();
        let shape = shape::Cylinder::new(0.5 * self.height.get(), self.radius.get());
        (shape, Pose::from_translation(Vector::new(x, y, z)))
    }
}

impl ObstacleParameters for Cylinder {
    fn dimension(&self) -> usize {
        3
    }

    fn build_in_space(&self, _: &Surfaces) -> Result<Box<dyn Obstacle<3>>, String> {
        let (shape, pose) = self.shape();
        Ok(Box::new(Solid::in_space(shape, pose, self.eps.get())))
    }

    fn place(&self) -> [f64; 3] {
        self.centre.get()
    }

    fn arrange(&mut self, by: &Similarity) -> Option<()> {
        self.centre = by.of_space_point(self.centre)?;
        by.scale([&mut self.radius, &mut self.height])
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.radius, &mut self.height, &mut self.eps]
    }

    fn triangulation(&self, _: &Surfaces) -> Triangulation {
        let (shape, pose) = self.shape();
        Triangulation::new(shape.to_trimesh(48), pose).refined(0.2 * self.radius.get().max(self.height.get()))
    }
}
