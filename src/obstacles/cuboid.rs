//! Obstacle: a rectangle.

use super::{Obstacle, ObstacleParameters, Polygon, Similarity};
use crate::quantity::{Angle, Coordinate, Height, Point, Quantity, Reach, Width};
use serde::{Deserialize, Serialize};

/// A box, turned about its middle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cuboid {
    /// Middle \[m\].
    pub centre: Point,
    /// Width \[m\].
    pub width: Width,
    /// Height \[m\].
    pub height: Height,
    /// Turn \[degrees\], counter-clockwise.
    #[serde(default = "level")]
    pub turn: Angle,
    /// How near a vertex feels it \[m\].
    pub eps: Reach,
}

const fn level() -> Angle {
    Angle::literal(0.0)
}

impl Default for Cuboid {
    fn default() -> Self {
        Self {
            centre: Point(Coordinate::literal(0.5), Coordinate::literal(0.2)),
            width: Width::literal(0.2),
            height: Height::literal(0.1),
            turn: level(),
            eps: Reach::literal(0.01),
        }
    }
}

impl Cuboid {
    /// The box as a polygon, counter-clockwise.
    fn polygon(&self) -> Polygon {
        let ([x, y], turn) = (self.centre.get(), self.turn.get().to_radians());
        let (c, s) = (libm::cos(turn), libm::sin(turn));
        let (w, h) = (0.5 * self.width.get(), 0.5 * self.height.get());
        let corner =
            |[a, b]: [f64; 2]| Point(Coordinate::literal(x + c * a - s * b), Coordinate::literal(y + s * a + c * b));
        Polygon { points: [[-w, -h], [w, -h], [w, h], [-w, h]].map(corner).to_vec(), eps: self.eps }
    }
}

impl ObstacleParameters for Cuboid {
    fn build(&self) -> Result<Box<dyn Obstacle>, String> {
        self.polygon().build()
    }

    fn place(&self) -> [f64; 3] {
        let [x, y] = self.centre.get();
        [x, y, 0.0]
    }

    fn arrange(&mut self, by: &Similarity) -> Option<()> {
        (self.centre, self.turn) = (by.of_point(self.centre)?, by.of_angle(self.turn)?);
        by.scale([&mut self.width, &mut self.height])
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.width, &mut self.height, &mut self.turn, &mut self.eps]
    }

    fn outline(&self) -> Vec<[f64; 2]> {
        self.polygon().outline()
    }
}
