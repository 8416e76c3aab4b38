use super::{
    Class, Dynamics, Integrator, Scheme, SecondOrder, StepCounts, Work, memory, parts,
    system::{settle, touched},
};
use crate::{
    quantity::{Quantity, VerletDamping},
    state::State,
};
use serde::{Deserialize, Serialize};

/// Position (Störmer) Verlet with velocity damping: `x' = x + (1 - D)(x - x_previous) + h² a(x, v)`.
///
/// Second order with D = 0, and then stable for h < 2/w, w the highest natural angular frequency (Hairer, Lubich and
/// Wanner, *Geometric Numerical Integration*, section I.1.4). D takes a share of the velocity in every step, whatever its
/// length, as cloth simulations do (Jakobsen, *Advanced Character Physics*, 2001): with D > 0 a shorter step damps more, and
/// there is nothing that it converges to.
///
/// The velocity of the state is `(x' - x)/h + h a/2`, second order too. The position before is remembered; where the
/// state was changed from outside it is taken to be `x - h v + h² a/2`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PositionVerlet {
    /// D: the share of its velocity that a vertex loses in a step.
    #[serde(default = "none")]
    pub damping: VerletDamping,
}

const fn none() -> VerletDamping {
    VerletDamping::literal(0.0)
}

impl Default for PositionVerlet {
    fn default() -> Self {
        Self { damping: none() }
    }
}

impl Integrator for PositionVerlet {
    fn title(&self) -> &'static str {
        "Position Verlet"
    }

    fn about(&self) -> &'static str {
        "x' = x + (1 − D)(x − x_old) + h² a. Second order for D = 0; stable for h < 2/ω of the stiffest vibration."
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

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.damping]
    }

    fn scheme(&self) -> Scheme<'_> {
        Scheme::Second(self)
    }
}

/// Marks this kind's memory, which is the positions one step before.
const TAG: f64 = 1.0;

impl SecondOrder for PositionVerlet {
    fn step(&self, system: &mut dyn Dynamics, state: &mut State, work: &mut Work, h: f64) -> StepCounts {
        let Work { numbers, spare, .. } = work;
        let count = state.x.len();
        let [before, before_v, force] = parts(numbers, count);
        let goes_on = memory::recall(state, TAG, h, count);
        system.force(&state.x, &state.v, force);
        before.copy_from_slice(&state.x);
        before_v.copy_from_slice(&state.v);
        let keep = 1.0 - self.damping.get();
        memory::open(state, TAG, h, count);
        for (number, inverse_mass) in system.inverse_mass().iter().enumerate() {
            let (x, a) = (before[number], force[number] * inverse_mass);
            let moved = if goes_on { x - memory::read(state)[number] } else { h * (state.v[number] - 0.5 * h * a) };
            // What is pinned stays, even if it was pinned while it moved.
            let way = if *inverse_mass == 0.0 { 0.0 } else { keep * moved + h * h * a };
            state.x[number] = x + way;
            state.v[number] = if *inverse_mass == 0.0 { 0.0 } else { way / h + 0.5 * h * a };
        }
        settle(system, [before, before_v], (&mut state.x, &mut state.v), spare, false);
        for (number, before) in before.iter().enumerate() {
            // Where a wall acted, the way of the next step begins with the velocity that the wall left.
            let past = if touched(&state.x, &state.v, spare, number) {
                let a = force[number] * system.inverse_mass()[number];
                state.x[number] - h * (state.v[number] - 0.5 * h * a)
            } else {
                *before
            };
            memory::own(&mut state.memory)[number] = past;
        }
        memory::close(state);
        StepCounts::ONE
    }
}
