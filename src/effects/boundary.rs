//! Effect: contact with the domain boundary.

use super::{Effect, EffectParameters, ObstacleEffect, Shape};
use crate::{
    contact::PlacedObstacle,
    elements::Elements,
    obstacles::{HalfPlane, Surfaces},
    quantity::{Coordinate, Point, Quantity},
};
use serde::{Deserialize, Serialize};

/// The four edges of the world, which touch bodies as planes do.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Boundary {
    /// Corner with the least coordinates \[m\].
    pub least: Point,
    /// Corner with the greatest coordinates \[m\].
    pub greatest: Point,
}

impl Default for Boundary {
    fn default() -> Self {
        let (zero, one) = (Coordinate::literal(0.0), Coordinate::literal(1.0));
        Self { least: Point(zero, zero), greatest: Point(one, one) }
    }
}

impl EffectParameters for Boundary {
    fn title(&self) -> &'static str {
        "Domain boundary"
    }

    fn about(&self) -> &'static str {
        "A rectangle that vertices cannot leave. What begins outside comes in slowly."
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        Vec::new()
    }

    fn shapes(&self, _: f64, _: &Surfaces) -> Vec<Shape> {
        vec![Shape::Edges(self.least.get(), self.greatest.get())]
    }

    fn build(&self, elements: &Elements) -> Result<Box<dyn Effect>, String> {
        let (least, greatest) = (self.least.get(), self.greatest.get());
        if !(least[0] < greatest[0] && least[1] < greatest[1]) {
            return Err(format!(
                "the lower left corner {least:?} of the domain must lie below and left of its upper right corner {greatest:?}"
            ));
        }
        let side = |point, normal| PlacedObstacle::still(Box::new(HalfPlane::new(point, normal, 0.0)));
        let sides = [(least, [1.0, 0.0]), (greatest, [-1.0, 0.0]), (least, [0.0, 1.0]), (greatest, [0.0, -1.0])];
        let sides = sides.map(|(point, normal)| side(point, normal)).into();
        Ok(Box::new(ObstacleEffect::new("Domain boundary", elements, sides)))
    }
}
