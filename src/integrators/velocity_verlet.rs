//! Velocity Verlet method.

use super::{Class, Dynamics, Integrator, Scheme, SecondOrder, StepCounts, Workspace};
use crate::state::State;
use serde::{Deserialize, Serialize};

/// Velocity Verlet: `x += h v + h²/2 a(x, v)`, then `v += h/2 (a(x, v) + a(x', v + h a))`.
///
/// Second order, also with forces that depend on velocity. Without damping it is symplectic and stable for h < 2/w, w the
/// highest natural angular frequency (Hairer, Lubich and Wanner, *Geometric Numerical Integration*, section I.3). Forces are
/// taken twice a step: nothing but the state is kept, so that a pull that changes between two steps is not missed.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VelocityVerlet {}

impl Integrator for VelocityVerlet {
    fn title(&self) -> &'static str {
        "Velocity Verlet"
    }

    fn about(&self) -> &'static str {
        "x += h v + h²/2 a, then v += h/2 (a + a'). Second order; stable for h < 2/ω of the stiffest vibration; energy does not drift."
    }

    fn order(&self) -> u32 {
        2
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

impl SecondOrder for VelocityVerlet {
    fn step(&self, system: &mut dyn Dynamics, state: &mut State, workspace: &mut Workspace, h: f64) -> StepCounts {
        let [before, predicted, force, end_force] = workspace.vectors(state.x.len());
        let constrains = system.constrains();
        if constrains {
            before.copy_from_slice(&state.x);
        }
        system.force(0.0, &state.x, &state.v, force);
        for (number, inverse_mass) in system.inverse_mass().iter().enumerate() {
            let a = force[number] * inverse_mass;
            state.x[number] += h * (state.v[number] + 0.5 * h * a);
            predicted[number] = state.v[number] + h * a;
        }
        system.force(h, &state.x, predicted, end_force);
        for (number, inverse_mass) in system.inverse_mass().iter().enumerate() {
            state.v[number] += 0.5 * h * (force[number] + end_force[number]) * inverse_mass;
        }
        if constrains {
            system.constrain(before, &mut state.x, &mut state.v);
        }
        StepCounts::ONE
    }
}
