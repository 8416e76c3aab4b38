//! Integrators and step lengths that hard cases run with.

use crate::integrators::{Bdf2, ImplicitEuler, IntegratorKind, SymplecticEuler};
use serde::{Deserialize, Serialize};

/// Integrator and step of a hard case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Method {
    /// Symplectic Euler at [`Self::SHARE`] of its longest stable step, which is found again at every frame.
    SymplecticEuler,
    /// Implicit Euler with steps of 1/60 s.
    ImplicitEuler,
    /// BDF2 with steps of 1/60 s.
    Bdf2,
}

impl Method {
    /// All methods, in the order of the table.
    pub const ALL: [Self; 3] = [Self::SymplecticEuler, Self::ImplicitEuler, Self::Bdf2];

    /// Greatest share of the longest stable step that an explicit scheme takes.
    pub const SHARE: f64 = 0.25;

    /// Energy tolerance of an implicit scheme, relative to the greatest possible mechanical energy.
    const IMPLICIT: f64 = 0.02;

    /// Name in case files and tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::SymplecticEuler => "SymplecticEuler",
            Self::ImplicitEuler => "ImplicitEuler",
            Self::Bdf2 => "Bdf2",
        }
    }

    /// Name in plain words.
    pub const fn title(self) -> &'static str {
        match self {
            Self::SymplecticEuler => "Symplectic Euler",
            Self::ImplicitEuler => "Implicit Euler",
            Self::Bdf2 => "BDF2",
        }
    }

    /// Description of the step, for a tooltip.
    pub const fn about(self) -> &'static str {
        match self {
            Self::SymplecticEuler => "A quarter of its longest stable step, found again at every frame.",
            Self::ImplicitEuler | Self::Bdf2 => "Steps of 1/60 s, however stiff the scene is.",
        }
    }

    /// Integrator.
    pub fn integrator(self) -> IntegratorKind {
        match self {
            Self::SymplecticEuler => IntegratorKind::SymplecticEuler(SymplecticEuler::default()),
            Self::ImplicitEuler => IntegratorKind::ImplicitEuler(ImplicitEuler::default()),
            Self::Bdf2 => IntegratorKind::Bdf2(Bdf2::default()),
        }
    }

    /// Whether the scheme is explicit, so that its step is limited by the fastest vibration.
    pub const fn is_explicit(self) -> bool {
        matches!(self, Self::SymplecticEuler)
    }

    /// Energy tolerance, relative to the greatest possible mechanical energy.
    ///
    /// Symplectic Euler keeps `E - h/2 v . dU/dx`, not E. For a vibration w at a step `h = s 2/w`, E swings by up to
    /// `s / (1 - s)` above its start value at rest (Hairer, Lubich and Wanner, *Geometric Numerical Integration*,
    /// section I.1).
    pub fn energy_tolerance(self) -> f64 {
        if self.is_explicit() { Self::SHARE / (1.0 - Self::SHARE) } else { Self::IMPLICIT }
    }
}
