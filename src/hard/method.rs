//! The integrators of the hard cases, with the step of each.

use crate::{
    integrators::{Class, IntegratorKind},
    scene::Scene,
    stability::critical_step,
};
use serde::{Deserialize, Serialize};

/// Integrator of a hard case. An explicit scheme takes a share of its longest stable step, which is computed in every
/// frame; the others take steps of 1/60 s.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Method {
    /// Symplectic Euler.
    SymplecticEuler,
    /// Forward Euler.
    ForwardEuler,
    /// Velocity Verlet.
    VelocityVerlet,
    /// Position Verlet.
    PositionVerlet,
    /// Heun's method.
    Heun,
    /// Classical Runge-Kutta method.
    RungeKutta4,
    /// Dormand-Prince, with error control within frames of 1/60 s.
    DormandPrince,
    /// Linearly implicit Euler.
    LinearlyImplicitEuler,
    /// Implicit Euler.
    ImplicitEuler,
    /// Implicit midpoint rule.
    ImplicitMidpoint,
    /// Second backward differentiation formula.
    Bdf2,
    /// Energy-momentum method.
    EnergyMomentum,
}

impl Method {
    /// All methods, in the order of the integrators.
    pub const ALL: [Self; 12] = [
        Self::SymplecticEuler,
        Self::ForwardEuler,
        Self::VelocityVerlet,
        Self::PositionVerlet,
        Self::Heun,
        Self::RungeKutta4,
        Self::DormandPrince,
        Self::LinearlyImplicitEuler,
        Self::ImplicitEuler,
        Self::ImplicitMidpoint,
        Self::Bdf2,
        Self::EnergyMomentum,
    ];

    /// Share of the longest stable step that an explicit scheme takes.
    pub const SHARE: f64 = 0.25;

    /// Energy tolerance of the other schemes, relative to the energy put in.
    const SMALL: f64 = 0.02;

    /// Integrator with its default parameters.
    pub fn integrator(self) -> IntegratorKind {
        // The variants have the names of the integrators, in their order.
        IntegratorKind::all().swap_remove(self as usize)
    }

    /// Name in case files and tables.
    pub fn name(self) -> &'static str {
        self.integrator().name()
    }

    /// Name in plain words.
    pub fn title(self) -> &'static str {
        self.integrator().kind().title()
    }

    /// Description of the step, for a tooltip.
    pub fn about(self) -> &'static str {
        match self.integrator().kind().class() {
            Class::Explicit => "A quarter of its longest stable step, computed in every frame.",
            Class::Implicit => "Steps of 1/60 s, however stiff the scene is.",
            Class::ErrorControlled => "Frames of 1/60 s, in which it chooses its steps by their error.",
        }
    }

    /// Whether the fastest vibration limits the step.
    pub fn is_explicit(self) -> bool {
        self.integrator().kind().class() == Class::Explicit
    }

    /// Whether it is stable at no step without damping, as forward Euler and Heun's method.
    pub fn is_never_stable(self) -> bool {
        self.integrator().kind().stability_limit() == Some(0.0)
    }

    /// Longest stable step relative to that of symplectic Euler. Forward Euler and Heun's method have none without
    /// damping and take that of symplectic Euler.
    pub fn relative_limit(self) -> f64 {
        0.5 * self.integrator().kind().stability_limit().filter(|limit| *limit > 0.0).unwrap_or(2.0)
    }

    /// Number of steps in a frame of 1/60 s at the start of a scene.
    pub(super) fn steps_a_frame(self, scene: &Scene) -> f64 {
        if !self.is_explicit() {
            return 1.0;
        }
        let limit = critical_step(scene, &scene.start, None).unwrap_or(f64::INFINITY);
        1.0 / (60.0 * Self::SHARE * self.relative_limit() * limit)
    }

    /// Energy tolerance, relative to the energy put in.
    ///
    /// Symplectic Euler keeps `E - h/2 v . dU/dx`, not E. For a vibration w at a step `h = s 2/w`, E swings by up to
    /// `s / (1 - s)` above its start value at rest (Hairer, Lubich and Wanner, *Geometric Numerical Integration*,
    /// section I.1). The other explicit schemes have the same tolerance.
    pub fn energy_tolerance(self) -> f64 {
        if self.is_explicit() { Self::SHARE / (1.0 - Self::SHARE) } else { Self::SMALL }
    }
}
