//! Symplectic Euler method.

use super::{Class, Dynamics, Integrator, Scheme, SecondOrder, StepCounts, Workspace, parts};
use crate::state::State;
use serde::{Deserialize, Serialize};

/// Symplectic (semi-implicit) Euler: `v += h f(x, v)/m`, then `x += h v`.
///
/// First order. Without damping it is stable for h < 2/w, w the highest natural angular frequency, and keeps a
/// modified energy exactly for linear forces, so that the true one swings but does not drift
/// (Hairer, Lubich and Wanner, *Geometric Numerical Integration*, section I.1.2).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SymplecticEuler {}

impl Integrator for SymplecticEuler {
    fn title(&self) -> &'static str {
        "Symplectic Euler"
    }

    fn about(&self) -> &'static str {
        "v += h f/m, then x += h v. First order; stable for h < 2/ω of the stiffest vibration; energy swings but does not drift."
    }

    fn order(&self) -> u32 {
        1
    }

    fn class(&self) -> Class {
        Class::Explicit
    }

    fn stability_limit(&self) -> Option<f64> {
        Some(2.0)
    }

    fn scheme(&self) -> Scheme<'_> {
        Scheme::Second(self)
    }
}

impl SecondOrder for SymplecticEuler {
    fn step(&self, system: &mut dyn Dynamics, state: &mut State, workspace: &mut Workspace, h: f64) -> StepCounts {
        let [force, before] = parts(&mut workspace.numbers, state.x.len());
        let State { x, v, .. } = state;
        let constrains = system.constrains();
        if constrains {
            before.copy_from_slice(x);
        }
        system.symplectic_euler_update(x, v, force, h);
        if constrains {
            system.constrain(before, x, v);
        }
        StepCounts::ONE
    }
}
