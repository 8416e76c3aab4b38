//! Position Verlet method.

use super::{Class, Dynamics, Integrator, Scheme, SecondOrder, StepCounts, Workspace, memory};
use crate::{
    quantity::{Quantity, VerletDamping},
    state::State,
};
use serde::{Deserialize, Serialize};

/// Position (Störmer) Verlet with velocity damping: `x' = x + d'`, `d' = (1 - D) d + h² a(x, v)`, where d is the displacement of
/// the step before.
///
/// Second order with D = 0, and then stable for h < 2/w, w the highest natural angular frequency (Hairer, Lubich and
/// Wanner, *Geometric Numerical Integration*, section I.1.4). D takes a share of the velocity in every step, whatever its
/// length, as cloth simulations do (Jakobsen, *Advanced Character Physics*, 2001): with D > 0 a shorter step damps more, and
/// there is nothing that it converges to.
///
/// Position Verlet defines the velocity by the central difference `v(t) = (x(t+h) - x(t-h))/(2 h)` (ibid., equation 1.14).
/// For D = 0, `x(t+h) = 2 x(t) - x(t-h) + h² a(x(t))` turns it into
///
/// `v' = d'/h + h a(x')/2`,
///
/// the velocity of velocity Verlet. It has second order. As the forces of a free body at x' have no net moment about the origin,
/// its angular momentum is the sum of `m x' × d'/h = m x × d'/h`, which no step changes. A velocity with the force at x instead,
/// `d'/h + h a(x)/2`, lacks that: the moment of the forces at x about the positions x' is not zero.
///
/// The force at x' is kept for the next step, so a step evaluates the force once, and twice after a contact. It is evaluated at the
/// predicted velocity `d'/h + h a(x)/2`, which differs from v' by O(h²) and matters only to forces that depend on velocity. Kept
/// between steps are `d'` and `h² a(x')`; the displacement itself rather than two positions, because their difference would have the
/// round-off of x.
///
/// - Where the state was changed from outside, or the step length is new, `d = h v - h² a/2`, and the force is evaluated anew.
/// - After a truncation, d is computed so at the end of the step, and the next step evaluates the force anew.
/// - Where only [`Dynamics::load_fingerprint`] changed, such as the pull of the mouse, the force alone is evaluated anew.
///
/// The method is the two-step Störmer-Verlet method, and not the splitting drift, kick, drift that has the same name.
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
        "x' = x + (1 − D)(x − x_old) + h² a, v' = (x' − x)/h + h a'/2. Second order for D = 0; stable for h < 2/ω of the stiffest vibration."
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

/// Tag of this kind's memory: displacements of the last step \[m\], then h² a where it ended \[m\], then the fingerprint of
/// the loads.
const TAG: f64 = 1.0;

/// In place of a fingerprint: the stored force is invalid.
const UNKNOWN: f64 = -1.0;

impl SecondOrder for PositionVerlet {
    fn step(&self, system: &mut dyn Dynamics, state: &mut State, workspace: &mut Workspace, h: f64) -> StepCounts {
        let count = state.x.len();
        let [before, force] = workspace.vectors(count);
        let is_continued = memory::is_current(state, TAG, h, 2 * count + 1);
        let loads = f64::from(system.load_fingerprint());
        memory::open(state, TAG, h, 2 * count + 1);
        if !is_continued || memory::read(state)[2 * count] != loads {
            system.force(0.0, &state.x, &state.v, force);
            let (displacement, increments) = memory::own(&mut state.memory).split_at_mut(count);
            increment(system, force, h, increments);
            if !is_continued {
                for ((displacement, increment), v) in displacement.iter_mut().zip(&*increments).zip(&state.v) {
                    *displacement = h * v - 0.5 * increment;
                }
            }
        }
        before.copy_from_slice(&state.x);
        let keep = 1.0 - self.damping.get();
        let State { x, v, memory, .. } = state;
        let (displacement, increments) = memory::own(memory).split_at_mut(count);
        for (number, inverse_mass) in system.inverse_mass().iter().enumerate() {
            // A pinned vertex stays, even if it was pinned while it moved.
            displacement[number] =
                if *inverse_mass == 0.0 { 0.0 } else { keep * displacement[number] + increments[number] };
            x[number] += displacement[number];
            v[number] = (displacement[number] + 0.5 * increments[number]) / h;
        }
        system.force(h, x, v, force);
        increment(system, force, h, increments);
        for ((v, displacement), increment) in v.iter_mut().zip(&*displacement).zip(&*increments) {
            *v = (displacement + 0.5 * increment) / h;
        }
        // After a truncation the next step begins with another velocity, and at another position than the force was
        // evaluated at.
        let changed = system.constrain(before, x, v);
        if changed {
            for ((displacement, v), increment) in displacement.iter_mut().zip(&*v).zip(&*increments) {
                *displacement = h * v - 0.5 * increment;
            }
        }
        increments[count] = if changed { UNKNOWN } else { loads };
        memory::close(state);
        StepCounts::ONE
    }
}

/// Writes `h² a` \[m\] of these forces, zero for pinned vertices.
fn increment(system: &dyn Dynamics, force: &[f64], h: f64, increments: &mut [f64]) {
    for ((increment, force), inverse_mass) in increments.iter_mut().zip(force).zip(system.inverse_mass()) {
        *increment = h * h * (force * inverse_mass);
    }
}
