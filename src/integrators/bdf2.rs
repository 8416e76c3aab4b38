//! Second-order backward differentiation formula (BDF2).

use super::{
    Class, Dynamics, Integrator, Scheme, SecondOrder, StepCounts, Workspace,
    implicit::{self, Affine},
    memory,
};
use crate::state::State;
use serde::{Deserialize, Serialize};

/// The second backward differentiation formula: `v' = (4 v - v_previous)/3 + 2h/3 a(x', v')`, likewise
/// `x' = (4 x - x_previous)/3 + 2h/3 v'`.
///
/// Second order, L-stable: no step is too long, and fast vibrations die out, slow ones far less than under implicit Euler
/// (Hairer and Wanner, *Solving Ordinary Differential Equations II*, section V.1). The formula is for a constant step: the
/// first step, and the one after a change of h or of the state from outside, or after a truncated step, is one of implicit Euler, whose error of one
/// step is of second order as well.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bdf2 {}

impl Integrator for Bdf2 {
    fn title(&self) -> &'static str {
        "BDF2"
    }

    fn about(&self) -> &'static str {
        "v' = (4v − v_old)/3 + 2h/3 a(x', v'), and so x'. Second order; stable for every h; fast vibrations die out."
    }

    fn order(&self) -> u32 {
        2
    }

    fn class(&self) -> Class {
        Class::Implicit
    }

    /// It continues from two steps, and the one before would have been another motion.
    fn allows_projection(&self) -> bool {
        false
    }

    fn scheme(&self) -> Scheme<'_> {
        Scheme::Second(self)
    }
}

/// Tag of this kind's memory: positions, then velocities, one step before.
const TAG: f64 = 2.0;

impl SecondOrder for Bdf2 {
    fn step(&self, system: &mut dyn Dynamics, state: &mut State, workspace: &mut Workspace, h: f64) -> StepCounts {
        let count = state.x.len();
        let goes_on = memory::is_current(state, TAG, h, 2 * count);
        let share = if goes_on { 2.0 / 3.0 * h } else { h };
        let affine = Affine::euler(share);
        let Workspace { past, .. } = workspace;
        past.clear();
        past.extend(state.x.iter().chain(&state.v));
        let (counts, changed) = implicit::step(system, state, workspace, (affine, h), |state, number| {
            let (mut x, mut v) = (state.x[number], state.v[number]);
            if goes_on {
                let past = memory::read(state);
                x = (4.0 * x - past[number]) / 3.0;
                v = (4.0 * v - past[count + number]) / 3.0;
            }
            [x + share * v, v]
        });
        if changed {
            // There is no smooth past.
            state.memory.clear();
            return counts;
        }
        memory::open(state, TAG, h, 2 * count).copy_from_slice(&workspace.past);
        memory::close(state);
        counts
    }
}
