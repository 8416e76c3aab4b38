//! Forward Euler method.

use super::{Class, FirstOrder, Integrator, Ode, Scheme, StepCounts, Workspace};
use crate::state::State;
use serde::{Deserialize, Serialize};

/// Forward (explicit) Euler: `X += h f(X)`.
///
/// First order. Without damping it is stable for no step at all: an oscillation of angular frequency w grows by
/// `sqrt(1 + h² w²)` in every step. A damped one is stable for h < 2 zeta/w, zeta its damping ratio
/// (Hairer, Nørsett and Wanner, *Solving Ordinary Differential Equations I*, section II.1).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ForwardEuler {}

impl Integrator for ForwardEuler {
    fn title(&self) -> &'static str {
        "Forward Euler"
    }

    fn about(&self) -> &'static str {
        "X += h f(X). First order; every undamped vibration grows by √(1 + h²ω²) a step, however small h is."
    }

    fn order(&self) -> u32 {
        1
    }

    fn class(&self) -> Class {
        Class::Explicit
    }

    fn stability_limit(&self) -> Option<f64> {
        Some(0.0)
    }

    fn scheme(&self) -> Scheme<'_> {
        Scheme::First(self)
    }
}

impl FirstOrder for ForwardEuler {
    fn step(&self, system: &mut dyn Ode, state: &mut State, workspace: &mut Workspace, h: f64) -> StepCounts {
        let [x, next, rate] = workspace.vectors(state.x.len() + state.v.len());
        state.copy_to(x);
        system.rate(0.0, x, rate);
        for ((next, x), rate) in next.iter_mut().zip(&*x).zip(&*rate) {
            *next = x + h * rate;
        }
        system.constrain(x, next);
        state.copy_from(next);
        StepCounts::ONE
    }
}
