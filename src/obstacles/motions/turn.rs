//! Motion: rotation about a point.

use super::{Motion, Rigid};
use crate::quantity::{Coordinate, Point, Quantity, Spin};
use serde::{Deserialize, Serialize};

/// About a point at a constant rate: `angle = spin t`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Turn {
    /// The point that stays \[m\].
    pub about: Point,
    /// Angular velocity, counter-clockwise [rad/s].
    pub spin: Spin,
}

impl Default for Turn {
    fn default() -> Self {
        let half = Coordinate::literal(0.5);
        Self { about: Point(half, half), spin: Spin::literal(1.0) }
    }
}

impl Motion for Turn {
    fn at(&self, time: f64) -> Rigid {
        let (spin, [x, y]) = (self.spin.get(), self.about.get());
        let angle = spin * time;
        let (c, s) = (libm::cos(angle), libm::sin(angle));
        Rigid { turn: [c, s], shift: [x - (c * x - s * y), y - (s * x + c * y)], velocity: [spin * y, -spin * x], spin }
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.spin]
    }
}
