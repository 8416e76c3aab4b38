//! Obstacle with a prescribed motion.

use super::{
    MotionKind, Obstacle, ObstacleKind, ObstacleParameters, Plane, Similarity, Surfaces, Triangulation, check,
};
use crate::quantity::{Point, Quantity};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// An obstacle that moves as it is told, whatever bumps into it. What it touches is stopped relative to it, and it supplies
/// what energy that takes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Moving {
    /// What it is, where it would be without moving.
    pub obstacle: Box<ObstacleKind>,
    /// How it moves: each motion takes along what the ones before it have moved.
    pub motions: Vec<MotionKind>,
}

impl Default for Moving {
    fn default() -> Self {
        let obstacle = Box::new(ObstacleKind::Ball(super::Ball::default()));
        Self { obstacle, motions: vec![MotionKind::Swing(super::Swing::default())] }
    }
}

impl ObstacleParameters for Moving {
    fn dimension(&self) -> usize {
        self.obstacle.kind().dimension()
    }

    fn build(&self) -> Result<Box<dyn Obstacle>, String> {
        check(&self.motions, 2)?;
        self.obstacle.kind().build()
    }

    fn build_in_space(&self, surfaces: &Surfaces) -> Result<Box<dyn Obstacle<3>>, String> {
        check(&self.motions, 3)?;
        self.obstacle.kind().build_in_space(surfaces)
    }

    fn triangulation(&self, surfaces: &Surfaces) -> Triangulation {
        self.obstacle.kind().triangulation(surfaces)
    }

    fn path(&self) -> Option<&Path> {
        self.obstacle.kind().path()
    }

    fn path_mut(&mut self) -> Option<&mut PathBuf> {
        self.obstacle.kind_mut().path_mut()
    }

    fn notes(&self) -> Option<String> {
        self.obstacle.kind().notes()
    }

    fn place(&self) -> [f64; 3] {
        self.obstacle.kind().place()
    }

    fn arrange(&mut self, by: &Similarity) -> Option<()> {
        self.motions.iter_mut().try_for_each(|motion| motion.kind_mut().arrange(by))?;
        self.obstacle.kind_mut().arrange(by)
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        let own = self.motions.iter_mut().flat_map(|motion| motion.kind_mut().parameters());
        self.obstacle.kind_mut().parameters().into_iter().chain(own).collect()
    }

    fn motions(&self) -> Vec<MotionKind> {
        let mut motions = self.obstacle.kind().motions();
        motions.extend_from_slice(&self.motions);
        motions
    }

    fn outline(&self) -> Vec<[f64; 2]> {
        self.obstacle.kind().outline()
    }

    fn plane(&self) -> Option<&Plane> {
        self.obstacle.kind().plane()
    }
}

impl Plane {
    /// The plane after a rigid motion; unchanged if the result is out of range.
    #[must_use]
    pub fn moved(&self, to: &super::Rigid) -> Self {
        let point = Point::new(to.point(self.point.get())).unwrap_or(self.point);
        let normal = Point::new(to.normal(self.normal.get())).unwrap_or(self.normal);
        Self { point, normal, eps: self.eps }
    }
}
