//! What every implicit scheme shares: in each of them positions and velocities at the time where forces are taken are
//! affine in the unknown accelerations z, `x = x^ + ax z` and `v = v^ + av z`, and z solves `M z = f(x, v)`.

use super::{Dynamics, StepCounts, Work, system::settle};
use crate::{
    solvers::{BlockMatrix, Equations, Weights},
    state::State,
};
use nalgebra::Matrix2;

/// How far a solved position may be from the exact one, as a share of the longest way of any coordinate in the step.
/// Errors of the scheme itself are hundreds of times larger at any step worth taking.
const RELATIVE: f64 = 1e-8;
/// The same as a share of the largest coordinate: what round-off leaves of the forces.
const ROUND_OFF: f64 = 1e-13;

/// Factors of z in positions and velocities [s², s].
#[derive(Clone, Copy)]
pub(super) struct Affine {
    pub ax: f64,
    pub av: f64,
}

/// Positions, velocities and accelerations that solve `M z = f(x, v)`.
pub(super) struct Solved<'a> {
    pub x: &'a mut [f64],
    pub v: &'a mut [f64],
    pub z: &'a [f64],
    pub spare: &'a mut Vec<f64>,
    pub counts: StepCounts,
}

impl Solved<'_> {
    /// Makes x and v the state, and applies the constraints.
    pub fn finish(self, system: &mut dyn Dynamics, state: &mut State, h: f64) -> StepCounts {
        state.x.swap_with_slice(self.x);
        state.v.copy_from_slice(self.v);
        settle(system, self.x, (&mut state.x, &mut state.v), self.spare, h);
        self.counts
    }
}

/// Solves `M z = f(x^ + ax z, v^ + av z)`, where `free` gives x^ and v^ for each number. What is pinned stays.
pub(super) fn solve<'a>(
    system: &mut dyn Dynamics,
    state: &State,
    work: &'a mut Work,
    affine: Affine,
    free: impl Fn(usize) -> [f64; 2],
) -> Solved<'a> {
    let Work { numbers, spare, newton } = work;
    let [free_x, free_v, x, v, z] = super::parts(numbers, state.x.len());
    for number in 0..state.x.len() {
        let pinned = system.inverse_mass()[number] == 0.0;
        [free_x[number], free_v[number]] = if pinned { [state.x[number], 0.0] } else { free(number) };
    }
    z.fill(0.0);
    let mut stage = Stage { system, origin: &state.x, free_x, free_v, x, v, affine };
    let newton = newton.solve(&mut stage, z);
    stage.evaluate(z);
    let Stage { x, v, .. } = stage;
    Solved { x, v, z, spare, counts: StepCounts { newton, ..StepCounts::ONE } }
}

/// The equations of one stage, `M z - f(x^ + ax z, v^ + av z) = 0`.
pub(super) struct Stage<'s, 'a> {
    pub system: &'s mut dyn Dynamics,
    /// Where the step began.
    pub origin: &'s [f64],
    pub free_x: &'s [f64],
    pub free_v: &'s [f64],
    pub x: &'a mut [f64],
    pub v: &'a mut [f64],
    pub affine: Affine,
}

impl Stage<'_, '_> {
    fn evaluate(&mut self, z: &[f64]) {
        for ((x, free), z) in self.x.iter_mut().zip(self.free_x).zip(z) {
            *x = free + self.affine.ax * z;
        }
        for ((v, free), z) in self.v.iter_mut().zip(self.free_v).zip(z) {
            *v = free + self.affine.av * z;
        }
    }
}

impl Equations for Stage<'_, '_> {
    fn residual(&mut self, z: &[f64], g: &mut [f64]) {
        self.evaluate(z);
        self.system.force(self.x, self.v, g);
        for (((g, z), mass), inverse) in g.iter_mut().zip(z).zip(self.system.mass()).zip(self.system.inverse_mass()) {
            *g = if *inverse == 0.0 { 0.0 } else { mass * z - *g };
        }
    }

    fn derivative(&mut self, z: &[f64], matrix: &mut BlockMatrix) {
        self.evaluate(z);
        let weights = Weights { position: self.affine.ax, velocity: self.affine.av };
        self.system.add_stiffness(self.x, self.v, weights, matrix);
        for (vertex, mass) in self.system.mass().chunks_exact(2).enumerate() {
            matrix.diagonal(vertex, &Matrix2::new(mass[0], 0.0, 0.0, mass[1]));
        }
    }

    fn couples(&self, add: &mut dyn FnMut(u32, u32)) {
        self.system.couples(add);
    }

    fn inverse_weight(&self) -> &[f64] {
        self.system.inverse_mass()
    }

    /// Staying where the step began, which has a force if any place has.
    fn other_start(&self, z: &mut [f64]) {
        for (((z, origin), free), inverse) in z.iter_mut().zip(self.origin).zip(self.free_x).zip(self.inverse_weight())
        {
            *z = if *inverse == 0.0 { 0.0 } else { (origin - free) / self.affine.ax };
        }
    }

    fn tolerance(&self, z: &[f64]) -> f64 {
        let mut way = 0.0_f64;
        let mut reach = 0.0_f64;
        for ((origin, free), z) in self.origin.iter().zip(self.free_x).zip(z) {
            let x = free + self.affine.ax * z;
            way = way.max((x - origin).abs());
            reach = reach.max(x.abs());
        }
        (RELATIVE * way + ROUND_OFF * reach) / self.affine.ax
    }
}
