//! Toys: small first-order systems with closed-form solutions. Each kind is one file; [`ToyKind`] lists them all.
//!
//! ```
//! use gingerbread::toys::{Circle, Toy as _};
//!
//! let circle = Circle::default();
//! let [a, b] = [circle.exact(0.0), circle.exact(circle.period())];
//! assert!((a[0] - b[0]).abs() < 1e-12 && (a[1] - b[1]).abs() < 1e-12);
//! ```

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

/// System `dX/dt = f(X, t)` of two numbers with an exact solution.
pub trait Toy: Send + Sync {
    /// Name in plain words.
    fn title(&self) -> &'static str;

    /// Equation, for a tooltip.
    fn about(&self) -> &'static str;

    /// Quantities that a panel may change.
    fn parameters(&mut self) -> Vec<&mut dyn Quantity>;

    /// Names of the two numbers of a state, with their unit, as column names of a table.
    fn columns(&self) -> [&'static str; 2];

    /// Rate of change of the state, f(X, t).
    fn rate(&self, state: [f64; 2]) -> [f64; 2];

    /// Exact state at a time \[s\]. At 0 it is the start state.
    fn exact(&self, time: f64) -> [f64; 2];

    /// Exact period \[s\].
    fn period(&self) -> f64;

    /// Kinetic and stored energy for a mass of 1 kg \[J\]; their sum is constant in the exact solution.
    fn energies(&self, state: [f64; 2]) -> [f64; 2];

    /// Position of a state in the world \[m\].
    fn place(&self, state: [f64; 2]) -> [f64; 2];

    /// Pivot of the moving point, if it has one \[m\].
    fn pivot(&self) -> Option<[f64; 2]> {
        None
    }

    /// Exact path in the world \[m\], and whether it closes.
    fn path(&self) -> (Vec<[f64; 2]>, bool);

    /// Readings to show beside the picture, for a state at a time \[s\].
    fn readings(&self, time: f64, state: [f64; 2]) -> Vec<Reading>;
}

/// Reading of a toy.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// Name.
    pub name: &'static str,
    /// Value.
    pub value: f64,
    /// Unit.
    pub unit: &'static str,
    /// Formula, for a tooltip.
    pub help: &'static str,
}

/// Distance of a state from the exact one, over the size of the start state.
fn relative_error(toy: &dyn Toy, time: f64, state: [f64; 2]) -> f64 {
    let (exact, start) = (toy.exact(time), toy.exact(0.0));
    let size = |a: f64, b: f64| (a * a + b * b).sqrt();
    size(state[0] - exact[0], state[1] - exact[1]) / size(start[0], start[1])
}
