//! Obstacle in space: a box.

use super::{Obstacle, ObstacleParameters, Similarity, Surfaces, Triangulation, solid::Solid};
use crate::quantity::{Coordinate, Depth, Height, Quantity, Reach, SpacePoint, Width};
use parry3d::{
    math::{Pose, Vector},
    shape::Cuboid,
};
use serde::{Deserialize, Serialize};

/// A box in space, with its sides along the axes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Block {
    /// Middle \[m\].
    pub centre: SpacePoint,
    /// Width along x \[m\].
    pub width: Width,
    /// Height along y \[m\].
    pub height: Height,
    /// Depth along z \[m\].
    pub depth: Depth,
    /// How near a vertex feels it \[m\].
    pub eps: Reach,
}

impl Default for Block {
    fn default() -> Self {
        let zero = Coordinate::literal(0.0);
        Self {
            centre: SpacePoint(zero, zero, zero),
            width: Width::literal(0.5),
            height: Height::literal(0.2),
            depth: Depth::literal(0.5),
            eps: Reach::literal(0.01),
        }
    }
}

impl Block {
    fn shape(&self) -> (Cuboid, Pose) {
        let [x, y, z] = self.centre.get();
        let half = Vector::new(0.5 * self.width.get(), 0.5 * self.height.get(), 0.5 * self.depth.get());
        (Cuboid::new(half), Pose::from_translation(Vector::new(x, y, z)))
    }
}

impl ObstacleParameters for Block {
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
        by.scale([&mut self.width, &mut self.height, &mut self.depth])
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.width, &mut self.height, &mut self.depth, &mut self.eps]
    }

    fn triangulation(&self, _: &Surfaces) -> Triangulation {
        let (shape, pose) = self.shape();
        let longest = self.width.get().max(self.height.get()).max(self.depth.get());
        Triangulation::new(shape.to_trimesh(), pose).refined(0.1 * longest)
    }
}
