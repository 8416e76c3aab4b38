//! Implicit midpoint rule.

use super::{Class, Dynamics, Integrator, MeanForces, Scheme, SecondOrder, StepCounts, Workspace, implicit};
use crate::state::State;
use serde::{Deserialize, Serialize};

/// The implicit midpoint rule: `v' = v + h a((x + x')/2, (v + v')/2)`, `x' = x + h (v + v')/2`.
///
/// Second order, A-stable and symplectic: an undamped linear oscillation keeps its amplitude exactly at every step length, so
/// vibrations that a long step cannot follow are not damped either, and strongly nonlinear ones may still blow up
/// (Hairer, Lubich and Wanner, *Geometric Numerical Integration*, sections II.1.4 and VI.4).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ImplicitMidpoint {}

impl Integrator for ImplicitMidpoint {
    fn title(&self) -> &'static str {
        "Implicit midpoint"
    }

    fn about(&self) -> &'static str {
        "v' = v + h a at the midpoint, x' = x + h (v + v')/2. Second order; stable for every h; vibrations neither grow nor fade."
    }

    fn order(&self) -> u32 {
        2
    }

    fn class(&self) -> Class {
        Class::Implicit
    }

    fn mean_forces(&self) -> MeanForces {
        MeanForces::Contact
    }

    fn scheme(&self) -> Scheme<'_> {
        Scheme::Second(self)
    }
}

impl SecondOrder for ImplicitMidpoint {
    fn step(&self, system: &mut dyn Dynamics, state: &mut State, workspace: &mut Workspace, h: f64) -> StepCounts {
        implicit::midpoint_step(system, state, workspace, (h, implicit::RELATIVE))
    }
}
