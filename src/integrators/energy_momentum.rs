//! Energy-momentum method.

use super::{Class, Dynamics, Integrator, MeanForces, Scheme, SecondOrder, StepCounts, Workspace, implicit};
use crate::state::State;
use serde::{Deserialize, Serialize};

/// The energy-momentum method: the implicit midpoint rule `x' = x + h (v + v')/2`, `v' = v + h f/m` with a discrete gradient as the
/// force, `f . (x' - x) = U(x) - U(x')`.
///
/// Second order. Without damping it keeps the energy at every step length, up to the tolerance of the equations, and both momenta where the
/// forces do: stresses and pressures of contact are corrected along changes of strains and gaps, which no rigid motion has. Gaps between bodies
/// and at curved obstacles are not linear in the positions; there it keeps the energy to second order. What a long step cannot follow is not
/// damped. Forces of effects with a linear or quadratic energy need no correction
/// (Simo and Tarnow, *The discrete energy-momentum method*, Zeitschrift für angewandte Mathematik und Physik 43, 1992; Gonzalez, *Exact
/// energy and momentum conserving algorithms for general models in nonlinear elasticity*, Computer Methods in Applied Mechanics and
/// Engineering 190, 2000).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EnergyMomentum {}

impl Integrator for EnergyMomentum {
    fn title(&self) -> &'static str {
        "Energy-momentum"
    }

    fn about(&self) -> &'static str {
        "The midpoint rule with mean stresses of the step, whose work is the change of energy. Second order; keeps the energy at every h, but for contact of curved surfaces and between bodies."
    }

    fn order(&self) -> u32 {
        2
    }

    fn class(&self) -> Class {
        Class::Implicit
    }

    fn mean_forces(&self) -> MeanForces {
        MeanForces::All
    }

    fn scheme(&self) -> Scheme<'_> {
        Scheme::Second(self)
    }
}

impl SecondOrder for EnergyMomentum {
    fn step(&self, system: &mut dyn Dynamics, state: &mut State, workspace: &mut Workspace, h: f64) -> StepCounts {
        // What equations leave unsolved is energy from nowhere.
        implicit::midpoint_step(system, state, workspace, (h, 0.1 * implicit::RELATIVE))
    }
}
