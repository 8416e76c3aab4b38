//! Heun's method.

use super::{Class, FirstOrder, Integrator, Ode, Scheme, StepCounts, Workspace};
use crate::state::State;
use serde::{Deserialize, Serialize};

/// Heun's method, the explicit trapezoid: `X* = X + h f(X)`, then `X += h/2 (f(X) + f(X*))`.
///
/// Second order. An undamped oscillation of angular frequency w grows by `sqrt(1 + h⁴ w⁴/4)` in every step: never stable, but
/// for small h very slowly so (Hairer, Nørsett and Wanner, *Solving Ordinary Differential Equations I*, section II.1).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Heun {}

impl Integrator for Heun {
    fn title(&self) -> &'static str {
        "Explicit trapezoid (Heun)"
    }

    fn about(&self) -> &'static str {
        "X* = X + h f(X), then X += h/2 (f(X) + f(X*)). Second order; vibrations grow by √(1 + h⁴ω⁴/4) a step."
    }

    fn order(&self) -> u32 {
        2
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

impl FirstOrder for Heun {
    fn step(&self, system: &mut dyn Ode, state: &mut State, workspace: &mut Workspace, h: f64) -> StepCounts {
        let [x, next, rate, end_rate] = workspace.vectors(state.x.len() + state.v.len());
        state.copy_to(x);
        system.rate(0.0, x, rate);
        for ((next, x), rate) in next.iter_mut().zip(&*x).zip(&*rate) {
            *next = x + h * rate;
        }
        system.rate(h, next, end_rate);
        for (((next, x), rate), end_rate) in next.iter_mut().zip(&*x).zip(&*rate).zip(&*end_rate) {
            *next = x + 0.5 * h * (rate + end_rate);
        }
        system.constrain(x, next);
        state.copy_from(next);
        StepCounts::ONE
    }
}
