//! Linearly implicit Euler method: one Newton iteration.

use super::{
    Class, Dynamics, ImplicitEuler, Integrator, Scheme, SecondOrder, StepCounts, Workspace,
    implicit::{Affine, Stage},
    parts,
};
use crate::state::State;
use serde::{Deserialize, Serialize};

/// Linearly implicit (semi-implicit) Euler: implicit Euler with forces linearised where the step begins, one linear solve:
/// `(M + h D + h² K) a = f(x, v) - h K v`, then `v += h a`, `x += h v`, with `K = -df/dx` and `D = -df/dv`.
///
/// First order. For linear forces it is implicit Euler, and L-stable; for others a long step follows the tangent too far and
/// may throw vertices about (Baraff and Witkin, *Large Steps in Cloth Simulation*, SIGGRAPH 1998; Deuflhard, *Recent Progress
/// in Extrapolation Methods*, SIAM Review 27, 1985). Where K makes the matrix indefinite, the masses in it are raised.
/// A step with an impact is one of implicit Euler: where a contact potential leaves more than a tenth of the forces unbalanced,
/// because its linearisation does not hold for the whole step.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LinearlyImplicitEuler {}

impl Integrator for LinearlyImplicitEuler {
    fn title(&self) -> &'static str {
        "Linearly implicit Euler"
    }

    fn about(&self) -> &'static str {
        "(M + hD + h²K) a = f − hKv, then v += h a, x += h v. First order; one linear solve; stable for every h while forces stay near linear."
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

/// Greatest unbalanced force in contact, as a fraction of the forces.
const RESIDUAL: f64 = 0.1;

impl SecondOrder for LinearlyImplicitEuler {
    fn step(&self, system: &mut dyn Dynamics, state: &mut State, workspace: &mut Workspace, h: f64) -> StepCounts {
        let Workspace { numbers, newton, .. } = workspace;
        let [x, v, predicted_v, none, g, force, z, before] = parts(numbers, state.x.len());
        // Linearised at z = 0, where x and v are those of the state.
        predicted_v.copy_from_slice(&state.v);
        none.fill(0.0);
        g.fill(0.0);
        force.fill(0.0);
        system.force(h, &state.x, &state.v, force);
        // Held vertices are where they must be at the end of the step already.
        for ((moving, v), inverse_mass) in before.iter_mut().zip(&state.v).zip(system.inverse_mass()) {
            *moving = if *inverse_mass == 0.0 { 0.0 } else { *v };
        }
        system.stiffness_times(h, &state.x, &state.v, before, g);
        for ((g, force), inverse_mass) in g.iter_mut().zip(&*force).zip(system.inverse_mass()) {
            *g = if *inverse_mass == 0.0 { 0.0 } else { h * *g - force };
        }
        let affine = Affine::euler(h);
        before.copy_from_slice(&state.x);
        let (origin, predicted_x): (&[f64], &[f64]) = (before, before);
        let velocity = &*predicted_v;
        let mut stage =
            Stage { system: &mut *system, origin, velocity, predicted_x, predicted_v, x, v, affine, time: h };
        let newton = newton.linear(&mut stage, none, g, z);
        let touches = system.touches(0.0, before, predicted_v);
        for (number, z) in z.iter().enumerate() {
            state.v[number] += h * z;
            state.x[number] += h * state.v[number];
        }
        if (touches || system.touches(h, &state.x, &state.v)) && is_unbalanced(system, state, h, z, (force, g)) {
            state.x.copy_from_slice(before);
            state.v.copy_from_slice(predicted_v);
            return ImplicitEuler::default().step(system, state, workspace, h);
        }
        system.constrain(before, &mut state.x, &mut state.v);
        StepCounts { newton, ..StepCounts::ONE }
    }
}

/// Whether the forces at the end of a step of length h differ from those of the accelerations z.
fn is_unbalanced(
    system: &mut dyn Dynamics,
    state: &State,
    h: f64,
    z: &[f64],
    (force, missing): (&mut [f64], &mut [f64]),
) -> bool {
    system.force(h, &state.x, &state.v, force);
    for (((missing, force), z), mass) in missing.iter_mut().zip(&*force).zip(z).zip(system.mass()) {
        *missing = mass * z - force;
    }
    system.add_coupled_mass(z, missing);
    let square =
        |of: &[f64]| of.iter().zip(system.inverse_mass()).map(|(one, inverse)| one * one * inverse).sum::<f64>();
    let (missing, all) = (square(missing), square(force));
    missing > RESIDUAL * RESIDUAL * all
}
