//! Implicit Euler method.

use super::{
    Class, Dynamics, Integrator, Scheme, SecondOrder, StepCounts, Workspace,
    implicit::{self, Affine},
};
use crate::state::State;
use serde::{Deserialize, Serialize};

/// Implicit (backward) Euler: `v' = v + h a(x', v')`, `x' = x + h v'`.
///
/// First order, L-stable: no step is too long. An undamped oscillation of angular frequency w decays by `1/sqrt(1 + h² w²)`
/// in every step (Hairer and Wanner, *Solving Ordinary Differential Equations II*, section IV.3).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ImplicitEuler {}

impl Integrator for ImplicitEuler {
    fn title(&self) -> &'static str {
        "Implicit Euler"
    }

    fn about(&self) -> &'static str {
        "v' = v + h a(x', v'), x' = x + h v'. First order; stable for every h; vibrations fade by 1/√(1 + h²ω²) a step."
    }

    fn order(&self) -> u32 {
        1
    }

    fn class(&self) -> Class {
        Class::Implicit
    }

    fn scheme(&self) -> Scheme<'_> {
        Scheme::Second(self)
    }
}

impl SecondOrder for ImplicitEuler {
    fn step(&self, system: &mut dyn Dynamics, state: &mut State, workspace: &mut Workspace, h: f64) -> StepCounts {
        implicit::step(system, state, workspace, (Affine::euler(h), h), |state, number| {
            [state.x[number] + h * state.v[number], state.v[number]]
        })
        .0
    }
}
