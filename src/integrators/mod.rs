//! Time stepping. An integrator knows no physics and no dimension: it sees flat numbers and asks a [`Dynamics`] for
//! forces. Each scheme is one file; [`IntegratorKind`] lists them all.

mod symplectic_euler;

pub use symplectic_euler::SymplecticEuler;

use crate::{registry::registry, state::State};

registry! {
    /// How a scene is advanced in time.
    pub enum IntegratorKind: dyn Integrator {
        SymplecticEuler(SymplecticEuler),
    }
}

impl Default for IntegratorKind {
    fn default() -> Self {
        Self::SymplecticEuler(SymplecticEuler::default())
    }
}

/// A system of second order, `M a = f(x, v)`, with a diagonal mass matrix and constraints on single vertices.
pub trait Dynamics {
    /// Writes the force [N] at these positions [m] and velocities [m/s]; all flat and of one length.
    fn force(&mut self, x: &[f64], v: &[f64], force: &mut [f64]);

    /// 1/mass [1/kg] for each number; zero where nothing may move.
    fn inverse_mass(&self) -> &[f64];

    /// Changes velocities that are not allowed, before positions move by them.
    fn constrain_velocity(&mut self, x: &[f64], v: &mut [f64]);

    /// Changes positions that are not allowed, after they have moved.
    fn constrain_position(&mut self, x: &mut [f64], v: &mut [f64]);
}

/// A time-stepping scheme.
pub trait Integrator: Send + Sync {
    /// Name as it is said, such as `Symplectic Euler`.
    fn title(&self) -> &'static str;

    /// The scheme, its order and its stability, for a tooltip.
    fn about(&self) -> &'static str;

    /// Advances the state by `h` [s]. `work` is kept between steps so that no step after the first allocates.
    fn step(&self, system: &mut dyn Dynamics, state: &mut State, work: &mut Vec<f64>, h: f64);
}
