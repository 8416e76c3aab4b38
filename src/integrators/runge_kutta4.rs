//! Classical Runge-Kutta method of order 4.

use super::{Class, FirstOrder, Integrator, Ode, Scheme, StepCounts, Workspace};
use crate::state::State;
use serde::{Deserialize, Serialize};

/// The classical Runge-Kutta method: `k1 = f(X)`, `k2 = f(X + h/2 k1)`, `k3 = f(X + h/2 k2)`, `k4 = f(X + h k3)`, then
/// `X += h/6 (k1 + 2 k2 + 2 k3 + k4)`.
///
/// Fourth order. An undamped oscillation of angular frequency w changes by `sqrt(1 - z⁶/72 + z⁸/576)` in every step,
/// z = h w: it decays for z < 2 sqrt 2 and grows beyond (Hairer, Nørsett and Wanner, *Solving Ordinary Differential
/// Equations I*, section II.1, table 1.2).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RungeKutta4 {}

impl Integrator for RungeKutta4 {
    fn title(&self) -> &'static str {
        "Runge-Kutta 4"
    }

    fn about(&self) -> &'static str {
        "Four rates a step, weighted 1 : 2 : 2 : 1. Fourth order; stable for h < 2.83/ω of the stiffest vibration."
    }

    fn order(&self) -> u32 {
        4
    }

    fn class(&self) -> Class {
        Class::Explicit
    }

    fn stability_limit(&self) -> Option<f64> {
        Some(2.0 * std::f64::consts::SQRT_2)
    }

    fn scheme(&self) -> Scheme<'_> {
        Scheme::First(self)
    }
}

impl FirstOrder for RungeKutta4 {
    fn step(&self, system: &mut dyn Ode, state: &mut State, workspace: &mut Workspace, h: f64) -> StepCounts {
        let [x, next, stage, rate] = workspace.vectors(state.x.len() + state.v.len());
        state.copy_to(x);
        next.copy_from_slice(x);
        stage.copy_from_slice(x);
        // Place of each rate in the step, its weight in the result, and how far along it the next one is taken.
        for (place, weight, along) in [(0.0, 1.0, 0.5), (0.5, 2.0, 0.5), (0.5, 2.0, 1.0), (1.0, 1.0, 0.0)] {
            system.rate(place * h, stage, rate);
            for (((next, stage), x), rate) in next.iter_mut().zip(&mut *stage).zip(&*x).zip(&*rate) {
                *next += h / 6.0 * weight * rate;
                *stage = x + h * along * rate;
            }
        }
        system.constrain(x, next);
        state.copy_from(next);
        StepCounts::ONE
    }
}
