//! Toys: small first-order systems with closed-form solutions. Each kind is one file; [`ToyKind`] lists them all.

mod circle;
mod pendulum;

pub use circle::Circle;
pub use pendulum::{Pendulum, period_ratio};

use crate::{quantity::Quantity, registry::registry};

registry! {
    /// Systems of two numbers with an exact solution.
    pub enum ToyKind: dyn Toy {
        Circle(Circle),
        Pendulum(Pendulum),
    }
}

/// A system `dX/dt = f(X, t)` of two numbers with an exact solution.
pub trait Toy: Send + Sync {
    /// Name as it is said.
    fn title(&self) -> &'static str;

    /// The equation, for a tooltip.
    fn about(&self) -> &'static str;

    /// The numbers a panel may change.
    fn parameters(&mut self) -> Vec<&mut dyn Quantity>;

    /// Names of the two numbers of a state, with their unit, as column names of a table.
    fn columns(&self) -> [&'static str; 2];

    /// f(X, t): how fast the state changes.
    fn rate(&self, state: [f64; 2]) -> [f64; 2];

    /// The exact state at a time [s]; at 0 it is the start.
    fn exact(&self, time: f64) -> [f64; 2];

    /// The exact period [s].
    fn period(&self) -> f64;

    /// Kinetic and stored energy for a mass of 1 kg [J]; their sum is constant in the exact solution.
    fn energies(&self, state: [f64; 2]) -> [f64; 2];

    /// Where a state lies in the world [m].
    fn place(&self, state: [f64; 2]) -> [f64; 2];

    /// What the moving point hangs on, if it hangs on anything [m].
    fn pivot(&self) -> Option<[f64; 2]> {
        None
    }

    /// The exact path in the world [m], and whether it closes.
    fn path(&self) -> (Vec<[f64; 2]>, bool);

    /// What is worth reading beside the picture, in a state at a time [s].
    fn readings(&self, time: f64, state: [f64; 2]) -> Vec<Reading>;
}

/// A number to read.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// What it is.
    pub name: &'static str,
    /// How much.
    pub value: f64,
    /// In which unit.
    pub unit: &'static str,
    /// The formula, for a tooltip.
    pub help: &'static str,
}

/// Distance of two states over the size of the start.
fn relative_error(toy: &dyn Toy, time: f64, state: [f64; 2]) -> f64 {
    let (exact, start) = (toy.exact(time), toy.exact(0.0));
    let size = |a: f64, b: f64| (a * a + b * b).sqrt();
    size(state[0] - exact[0], state[1] - exact[1]) / size(start[0], start[1])
}
