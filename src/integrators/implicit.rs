//! What every implicit scheme shares: in each of them positions and velocities at the time where forces are taken are
//! affine in the unknown accelerations z, `x = x^ + ax z` and `v = v^ + av z`, and z solves `M z = f(x, v)`.

use super::{
    Dynamics, StepCounts, Work, parts,
    system::{settle, touched},
};
use crate::{
    solvers::{BlockMatrix, Equations, NewtonCounts, Tangent, Weights},
    state::State,
};
use nalgebra::Matrix2;

/// How far a solved position may be from the exact one, as a share of the longest way of any coordinate in the step.
/// Errors of the scheme itself are hundreds of times larger at any step worth taking.
const RELATIVE: f64 = 1e-8;
/// The same as a share of the largest coordinate: what round-off leaves of the forces.
const ROUND_OFF: f64 = 1e-13;

/// A way to a wall that is a smaller share of the whole is none: what rests there is held where it is.
const SHORTEST: f64 = 1e-3;

/// How often a step is solved again, at most, with more numbers held by walls.
const PASSES: usize = 8;

/// Factors of z in positions and velocities [s², s], and where the step ends: at `end` times the way to the stage.
#[derive(Clone, Copy)]
pub(super) struct Affine {
    pub ax: f64,
    pub av: f64,
    pub end: f64,
}

/// Solves `M z = f(x^ + ax z, v^ + av z)`, where `free` gives x^ and v^ for each number, and makes the end of the step of
/// length h the state. What is pinned stays.
///
/// Walls are part of the equations: where constraints change the end of the step, those numbers are held at what the
/// constraints say and the rest is solved again, so that a body that meets a wall is pressed flat by its own elasticity
/// and not by moving vertices through their neighbours. If the scheme does not end at its stage, such a step is one of
/// implicit Euler. [`touched`] afterwards tells the numbers that were held.
pub(super) fn step(
    system: &mut dyn Dynamics,
    state: &mut State,
    work: &mut Work,
    (mut affine, h): (Affine, f64),
    free: impl Fn(&State, usize) -> [f64; 2],
) -> StepCounts {
    let Work { numbers, spare, newton, .. } = work;
    let [free_x, free_v, x, v, z, inverse, end_x, end_v] = parts(numbers, state.x.len());
    inverse.copy_from_slice(system.inverse_mass());
    for number in 0..state.x.len() {
        let pinned = inverse[number] == 0.0;
        [free_x[number], free_v[number]] = if pinned { [state.x[number], 0.0] } else { free(state, number) };
    }
    z.fill(0.0);
    let mut counts = NewtonCounts::NONE;
    // First only what faces a wall is stopped by it: of a body that would be far beyond the wall, its front. Where that
    // stops, the rest need not get there.
    let mut faces = true;
    for pass in 1..=PASSES {
        let origin = &state.x;
        let mut stage = Stage { system: &mut *system, origin, free_x, free_v, inverse, x, v, affine };
        counts.add(&newton.solve(&mut stage, z));
        stage.evaluate(z);
        for number in 0..origin.len() {
            let held = inverse[number] == 0.0 && system.inverse_mass()[number] != 0.0;
            if !held {
                end_x[number] = along(origin[number], x[number], affine.end);
                end_v[number] = along(state.v[number], v[number], affine.end);
            }
        }
        let mut more = false;
        while !more {
            faces &= pass < PASSES;
            settle(system, [origin, &state.v], (end_x, end_v), spare, faces);
            for number in 0..origin.len() {
                if inverse[number] != 0.0 && touched(end_x, end_v, spare, number) && end_x[number].is_finite() {
                    inverse[number] = 0.0;
                    more = true;
                }
            }
            if !faces {
                break;
            }
            faces = more;
        }
        if !more {
            break;
        }
        if affine.end != 1.0 {
            // An impact is not smooth; a scheme that damps nothing would turn it into noise.
            affine = Affine { ax: h * h, av: h, end: 1.0 };
            for number in (0..origin.len()).filter(|number| system.inverse_mass()[*number] != 0.0) {
                free_v[number] = state.v[number];
                free_x[number] = origin[number] + h * state.v[number];
                z[number] *= 0.5;
            }
        }
        let share = first_touch(origin, end_x, &spare[origin.len()..]);
        for number in (0..origin.len()).filter(|number| system.inverse_mass()[*number] != 0.0) {
            if inverse[number] == 0.0 {
                z[number] = (end_x[number] - free_x[number]) / affine.ax;
            } else if let Some(share) = share {
                let reached = along(origin[number], spare[origin.len() + number], share);
                z[number] = (reached - free_x[number]) / affine.ax;
            }
        }
    }
    for (number, inverse) in inverse.iter().enumerate() {
        if *inverse == 0.0 && system.inverse_mass()[number] != 0.0 {
            // Equal to nothing, so that the number counts as touched.
            spare[number] = f64::NAN;
        }
    }
    state.x.copy_from_slice(end_x);
    state.v.copy_from_slice(end_v);
    StepCounts { newton: counts, ..StepCounts::ONE }
}

/// The share of the ways from `origin` to `free` after which the first of them ends at a wall, if any gets some way: where the
/// others are then is a start for Newton's method from which nothing has to find its way back through what is held.
fn first_touch(origin: &[f64], end: &[f64], free: &[f64]) -> Option<f64> {
    let shares = origin.iter().zip(end).zip(free).filter(|((_, end), free)| end != free);
    let shares = shares.map(|((origin, end), free)| (end - origin) / (free - origin));
    shares.filter(|share| *share > SHORTEST && *share < 1.0).min_by(f64::total_cmp)
}

/// From `origin`, so many times the way to `stage`.
fn along(origin: f64, stage: f64, times: f64) -> f64 {
    if times == 1.0 { stage } else { origin + times * (stage - origin) }
}

/// The equations of one stage, `M z - f(x^ + ax z, v^ + av z) = 0`.
pub(super) struct Stage<'s, 'a> {
    pub system: &'s mut dyn Dynamics,
    /// Where the step began.
    pub origin: &'s [f64],
    pub free_x: &'s [f64],
    pub free_v: &'s [f64],
    /// 1/mass, zero also where a wall holds.
    pub inverse: &'s [f64],
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
        for (((g, z), mass), inverse) in g.iter_mut().zip(z).zip(self.system.mass()).zip(self.inverse) {
            *g = if *inverse == 0.0 { 0.0 } else { mass * z - *g };
        }
    }

    fn derivative(&mut self, z: &[f64], tangent: Tangent, matrix: &mut BlockMatrix) {
        self.evaluate(z);
        let weights = Weights { position: self.affine.ax, velocity: self.affine.av, tangent };
        self.system.add_stiffness(self.x, self.v, weights, matrix);
        for (vertex, mass) in self.system.mass().chunks_exact(2).enumerate() {
            matrix.diagonal(vertex, &Matrix2::new(mass[0], 0.0, 0.0, mass[1]));
        }
    }

    fn couples(&self, add: &mut dyn FnMut(u32, u32)) {
        self.system.couples(add);
    }

    fn longest_step(&mut self, z: &[f64], step: &[f64]) -> f64 {
        self.evaluate(z);
        // What z would make of velocities is not needed here.
        let displacement = &mut *self.v;
        displacement.iter_mut().zip(step).for_each(|(displacement, step)| *displacement = self.affine.ax * step);
        self.system.longest_step(self.x, displacement)
    }

    fn inverse_weight(&self) -> &[f64] {
        self.inverse
    }

    /// Staying where the step began, which has a force if any place has.
    fn other_start(&self, z: &mut [f64]) {
        for (((z, origin), free), inverse) in z.iter_mut().zip(self.origin).zip(self.free_x).zip(self.inverse) {
            if *inverse != 0.0 {
                *z = (origin - free) / self.affine.ax;
            }
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
