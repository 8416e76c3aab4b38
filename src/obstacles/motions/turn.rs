//! Motion: rotation about a point, or in space about an axis.

use super::{Motion, Rigid, Similarity};
use crate::quantity::{Coordinate, Point, Position, Quantity, SpacePoint, Spin};
use serde::{Deserialize, Serialize};

/// About a point at a constant rate: `angle = spin t`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Turn {
    /// The point that stays \[m\].
    pub about: Position,
    /// Direction of the axis in space, of any length but zero; along z, if it is not said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub axis: Option<SpacePoint>,
    /// Angular velocity, counter-clockwise [rad/s].
    pub spin: Spin,
}

impl Default for Turn {
    fn default() -> Self {
        let half = Coordinate::literal(0.5);
        Self { about: Position::Plane(Point(half, half)), axis: None, spin: Spin::literal(1.0) }
    }
}

impl Motion for Turn {
    fn at(&self, time: f64) -> Rigid<3> {
        let (spin, about) = (self.spin.get(), self.about.get());
        let angle = spin * time;
        let (c, s) = (libm::cos(angle), libm::sin(angle));
        let axis = self.axis.map_or([0.0, 0.0, 1.0], SpacePoint::get);
        let length = axis.iter().map(|along| along * along).sum::<f64>().sqrt();
        // An axis without a direction is refused where the obstacle is built.
        let [x, y, z] = if length > 0.0 { axis.map(|along| along / length) } else { [0.0; 3] };
        let (d, cross) = (1.0 - c, [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]]);
        let axis = [x, y, z];
        // Rodrigues' formula: R = c I + s [a]x + (1 - c) a a'.
        let entry = |row: usize, column: usize| {
            let straight = if row == column { c } else { 0.0 };
            straight + s * cross[row][column] + d * axis[row] * axis[column]
        };
        let turn = [0, 1, 2].map(|row| [0, 1, 2].map(|column| entry(row, column)));
        let spin = cross.map(|row| row.map(|along| spin * along));
        let times = |matrix: [[f64; 3]; 3]| matrix.map(|[a, b, c]| a * about[0] + b * about[1] + c * about[2]);
        let (turned, velocity) = (times(turn), times(spin).map(|along| -along));
        Rigid { turn, shift: [0, 1, 2].map(|axis| about[axis] - turned[axis]), velocity, spin }
    }

    fn is_in_space(&self) -> bool {
        self.axis.is_some() || self.about.dimension() == 3
    }

    fn arrange(&mut self, by: &Similarity) -> Option<()> {
        self.about = by.of_position(self.about)?;
        Some(())
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.spin]
    }
}
