//! Motion: harmonic oscillation along a line.

use super::{Motion, Rigid, Similarity};
use crate::quantity::{Angle, Coordinate, Period, Point, Position, Quantity};
use serde::{Deserialize, Serialize};

/// To and fro along a line: `d = way sin(2 pi t/period + phase)`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Swing {
    /// From the middle to the farthest point \[m\].
    pub way: Position,
    /// Time for one swing to and fro \[s\].
    pub period: Period,
    /// Where in the swing it starts \[degrees\]: 0 in the middle, on the way out; 90 at the farthest point.
    #[serde(default = "middle")]
    pub phase: Angle,
}

const fn middle() -> Angle {
    Angle::literal(0.0)
}

impl Default for Swing {
    fn default() -> Self {
        let way = Position::Plane(Point(Coordinate::literal(0.2), Coordinate::literal(0.0)));
        Self { way, period: Period::literal(2.0), phase: middle() }
    }
}

impl Motion for Swing {
    fn at(&self, time: f64) -> Rigid<3> {
        let rate = std::f64::consts::TAU / self.period.get();
        // Whole swings are taken off first, so that late ones are as exact as early ones.
        let turns = time / self.period.get();
        let angle = std::f64::consts::TAU * (turns - libm::floor(turns)) + self.phase.get().to_radians();
        let (out, speed, way) = (libm::sin(angle), rate * libm::cos(angle), self.way.get());
        Rigid { shift: way.map(|way| out * way), velocity: way.map(|way| speed * way), ..Rigid::STILL }
    }

    fn is_in_space(&self) -> bool {
        self.way.dimension() == 3
    }

    fn arrange(&mut self, by: &Similarity) -> Option<()> {
        self.way = by.of_displacement(self.way)?;
        Some(())
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.period]
    }
}
