//! Time integration. An integrator is independent of physics and dimension: it works on flat vectors and calls an
//! [`Ode`] for rates or a [`Dynamics`] for forces. Each scheme is one file; [`IntegratorKind`] lists them all.
//!
//! ```
//! use gingerbread::{
//!     integrators::{IntegratorKind, Ode, RungeKutta4, Scheme, Workspace},
//!     state::State,
//! };
//!
//! /// dX/dt = -X.
//! struct Decay;
//!
//! impl Ode for Decay {
//!     fn rate(&mut self, _time: f64, x: &[f64], rate: &mut [f64]) {
//!         rate.iter_mut().zip(x).for_each(|(rate, x)| *rate = -x);
//!     }
//! }
//!
//! let kind: IntegratorKind = RungeKutta4::default().into();
//! let mut state = State { x: vec![1.0], ..State::default() };
//! if let Scheme::First(scheme) = kind.kind().scheme() {
//!     for _ in 0..10 {
//!         scheme.step(&mut Decay, &mut state, &mut Workspace::default(), 0.1);
//!     }
//! }
//! assert!((state.x[0] - (-1.0_f64).exp()).abs() < 1e-6);
//! ```

mod bdf2;
mod dormand_prince;
mod energy_momentum;
mod forward_euler;
mod heun;
mod implicit;
mod implicit_euler;
mod implicit_midpoint;
mod linearly_implicit_euler;
mod memory;
mod position_verlet;
mod runge_kutta4;
mod symplectic_euler;
mod system;
mod velocity_verlet;

pub use bdf2::Bdf2;
pub use dormand_prince::DormandPrince;
pub use energy_momentum::EnergyMomentum;
pub use forward_euler::ForwardEuler;
pub use heun::Heun;
pub use implicit_euler::ImplicitEuler;
pub use implicit_midpoint::ImplicitMidpoint;
pub use linearly_implicit_euler::LinearlyImplicitEuler;
pub use position_verlet::PositionVerlet;
pub use runge_kutta4::RungeKutta4;
pub use symplectic_euler::SymplecticEuler;
pub use system::{Dynamics, Ode, Rates, symplectic_euler_update};
pub use velocity_verlet::VelocityVerlet;

use crate::{
    quantity::Quantity,
    registry::registry,
    solvers::{LinearSolver, Newton, NewtonCounts},
    state::State,
};

registry! {
    /// Time-stepping schemes.
    pub enum IntegratorKind: dyn Integrator {
        SymplecticEuler(SymplecticEuler),
        ForwardEuler(ForwardEuler),
        VelocityVerlet(VelocityVerlet),
        PositionVerlet(PositionVerlet),
        Heun(Heun),
        RungeKutta4(RungeKutta4),
        DormandPrince(DormandPrince),
        LinearlyImplicitEuler(LinearlyImplicitEuler),
        ImplicitEuler(ImplicitEuler),
        ImplicitMidpoint(ImplicitMidpoint),
        Bdf2(Bdf2),
        EnergyMomentum(EnergyMomentum),
    }
}

/// An integrator by its name in level files, in any case; also e, t, r and i for forward Euler, the trapezoidal scheme (Heun), classical Runge-Kutta
/// and implicit Euler.
impl std::str::FromStr for IntegratorKind {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let name = match text {
            "e" => "ForwardEuler",
            "t" => "Heun",
            "r" => "RungeKutta4",
            "i" => "ImplicitEuler",
            name => name,
        };
        let mut known = Self::all();
        let names: Vec<_> = known.iter().map(Self::name).collect();
        let found = names.iter().position(|known| known.eq_ignore_ascii_case(name));
        found.map(|at| known.swap_remove(at)).ok_or_else(|| format!("expected one of {}", names.join(", ")))
    }
}

impl Default for IntegratorKind {
    fn default() -> Self {
        Self::SymplecticEuler(SymplecticEuler::default())
    }
}

/// A time-stepping scheme with its parameters.
pub trait Integrator: Send + Sync {
    /// Name in the window, such as `Symplectic Euler`.
    fn title(&self) -> &'static str;

    /// The scheme, its order and its stability, for a tooltip.
    fn about(&self) -> &'static str;

    /// The order p: the error of positions at a fixed time shrinks as h^p.
    fn order(&self) -> u32;

    /// Limit of the step.
    fn class(&self) -> Class;

    /// The largest z = h w at which an undamped vibration of angular frequency w does not grow; `None` if there is no
    /// such limit, or the scheme controls its step.
    fn stability_limit(&self) -> Option<f64> {
        None
    }

    /// Forces that are means over a step.
    fn mean_forces(&self) -> MeanForces {
        MeanForces::None
    }

    /// Whether it continues from positions that [`crate::effects::Projection`] changed at the end of its step.
    fn allows_projection(&self) -> bool {
        true
    }

    /// The numbers a panel may change.
    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        Vec::new()
    }

    /// The scheme itself, for the kind of system it needs.
    fn scheme(&self) -> Scheme<'_>;
}

/// Limit of the step of a scheme.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// Stability: steps above some h are unstable.
    Explicit,
    /// Accuracy alone; equations are solved in every step.
    Implicit,
    /// The scheme itself, by an estimate of its error.
    ErrorControlled,
}

/// Forces that are means over a step: they do as much work along its displacement as their energy changes. Schemes with them take forces
/// at the midpoint of a step, with its displacement over its length as the velocity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum MeanForces {
    /// None: all forces are those of a moment.
    None,
    /// Those of contact.
    Contact,
    /// Those of contact and of elements.
    All,
}

/// A scheme, by the kind of system it advances.
#[derive(Clone, Copy)]
pub enum Scheme<'a> {
    /// Any system: it needs rates alone.
    First(&'a dyn FirstOrder),
    /// Systems of second order only: it treats positions and velocities differently.
    Second(&'a dyn SecondOrder),
}

/// A scheme for any [`Ode`].
pub trait FirstOrder {
    /// Advances the state by `h` \[s\].
    fn step(&self, system: &mut dyn Ode, state: &mut State, workspace: &mut Workspace, h: f64) -> StepCounts;
}

/// A scheme for [`Dynamics`].
pub trait SecondOrder {
    /// Advances the state by `h` \[s\].
    fn step(&self, system: &mut dyn Dynamics, state: &mut State, workspace: &mut Workspace, h: f64) -> StepCounts;
}

impl dyn Integrator + '_ {
    /// Advances a system of second order by `h` \[s\]: every scheme can.
    pub fn step(&self, system: &mut dyn Dynamics, state: &mut State, workspace: &mut Workspace, h: f64) -> StepCounts {
        match self.scheme() {
            Scheme::First(scheme) => scheme.step(&mut Rates(system), state, workspace, h),
            Scheme::Second(scheme) => scheme.step(system, state, workspace, h),
        }
    }
}

/// Buffers that are kept between steps, so that none after the first allocates; they do not affect results.
#[derive(Default)]
pub struct Workspace {
    numbers: Vec<f64>,
    past: Vec<f64>,
    newton: Newton,
}

impl Workspace {
    /// Makes buffers for schemes with this linear solver.
    pub fn new(linear_solver: LinearSolver) -> Self {
        Self { newton: Newton::new(linear_solver), ..Self::default() }
    }

    /// Vectors of equal length, whose content is undefined.
    pub fn vectors<const COUNT: usize>(&mut self, length: usize) -> [&mut [f64]; COUNT] {
        parts(&mut self.numbers, length)
    }

    /// Invalidates the sparsity pattern, for a new scene.
    pub fn forget(&mut self) {
        self.newton.forget();
    }
}

/// Counts of a step, beside force evaluations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StepCounts {
    /// Inner steps taken; 1 unless the error is controlled.
    pub inner_steps: u64,
    /// Inner steps rejected for their error.
    pub rejected: u64,
    /// Counts of Newton's method.
    pub newton: NewtonCounts,
}

impl StepCounts {
    /// One step with no equations to solve.
    pub const ONE: Self = Self { inner_steps: 1, rejected: 0, newton: NewtonCounts::NONE };
}

/// Splits a buffer into equal parts, after enlarging it if necessary. Their content is undefined.
fn parts<const COUNT: usize>(numbers: &mut Vec<f64>, length: usize) -> [&mut [f64]; COUNT] {
    if numbers.len() < COUNT * length {
        numbers.resize(COUNT * length, 0.0);
    }
    let mut rest = numbers.as_mut_slice();
    [(); COUNT].map(|()| {
        let (part, others) = std::mem::take(&mut rest).split_at_mut(length);
        rest = others;
        part
    })
}
