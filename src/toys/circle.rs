//! Toy: rotation on a circle.

use super::{Reading, Toy, relative_error};
use crate::quantity::{Quantity, Radius};
use std::f64::consts::TAU;

/// The circle: `dx/dt = -y`, `dy/dt = x`. The exact point goes around at one radian a second and keeps its distance.
///
/// Forward Euler multiplies the distance by `sqrt(1 + h²)` in every step: it spirals out however small h is.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Circle {
    /// Distance from the centre of the world at the start \[m\].
    pub radius: Radius,
}

impl Default for Circle {
    fn default() -> Self {
        Self { radius: Radius::literal(0.3) }
    }
}

/// The centre of the world \[m\].
const CENTRE: [f64; 2] = [0.5, 0.5];

impl Toy for Circle {
    fn title(&self) -> &'static str {
        "Circle"
    }

    fn about(&self) -> &'static str {
        "dx/dt = −y, dy/dt = x: once around in 2π s, at a constant distance from the centre."
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.radius]
    }

    fn columns(&self) -> [&'static str; 2] {
        ["x_m", "y_m"]
    }

    fn rate(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [-y, x]
    }

    fn exact(&self, time: f64) -> [f64; 2] {
        [self.radius.get() * libm::cos(time), self.radius.get() * libm::sin(time)]
    }

    fn period(&self) -> f64 {
        TAU
    }

    /// Energies of an oscillator with position x and velocity -y.
    fn energies(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [0.5 * y * y, 0.5 * x * x]
    }

    fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [CENTRE[0] + x, CENTRE[1] + y]
    }

    fn path(&self) -> (Vec<[f64; 2]>, bool) {
        let at = |i: u32| self.place(self.exact(TAU * f64::from(i) / 180.0));
        ((0..180).map(at).collect(), true)
    }

    fn readings(&self, time: f64, [x, y]: [f64; 2]) -> Vec<Reading> {
        let distance = (x * x + y * y).sqrt();
        let reading = |name, value, unit, help| Reading { name, value, unit, help };
        vec![
            reading("Turns", time / TAU, "", "t / 2π: how often the exact point has gone around"),
            reading("Distance", distance, "m", "√(x² + y²) [m]; exactly, it stays what it was at the start"),
            reading("Drift", distance / self.radius.get() - 1.0, "", "Distance over radius, less 1; exactly 0"),
            reading("Error", relative_error(self, time, [x, y]), "", "Distance from the exact point, over the radius"),
        ]
    }
}
