//! Systems that integrators step: [`Ode`] (first order) and [`Dynamics`] (second order).

use crate::solvers::{BlockMatrix, Weights};

/// A system of first order, `dX/dt = f(X)`, flat and of any length.
///
/// In a [`State`](crate::state::State) X is the positions followed by the velocities; a system of first order that is
/// not a [`Dynamics`] keeps all of X in the positions and leaves the velocities empty.
pub trait Ode {
    /// Writes f(X) to `rate`.
    fn rate(&mut self, x: &[f64], rate: &mut [f64]);

    /// Puts right what a step from `before` to `after` did that is not allowed. `spare` is scratch.
    fn apply_constraints(&mut self, _before: &[f64], _after: &mut [f64], _spare: &mut Vec<f64>) {}
}

/// A system of second order, `M a = f(x, v)`, with a diagonal mass matrix and constraints on single vertices.
///
/// [`Rates`] makes it an [`Ode`], with X = (x, v).
pub trait Dynamics {
    /// Writes the force [N] at these positions [m] and velocities [m/s]; all flat and of one length.
    fn force(&mut self, x: &[f64], v: &[f64], force: &mut [f64]);

    /// A number that changes with whatever forces depend on beside positions and velocities, such as the pull of the mouse: a force
    /// that was kept is the present one while it stays the same.
    fn load_fingerprint(&self) -> u32 {
        0
    }

    /// Moves everything by `v += h f(x, v)/m`, then `x += h v`. `force` is scratch of the same length. A system may do so while its
    /// forces are still near the processor.
    fn symplectic_euler_update(&mut self, x: &mut [f64], v: &mut [f64], force: &mut [f64], h: f64) {
        self.force(x, v, force);
        symplectic_euler_update(x, v, force, self.inverse_mass(), h);
    }

    /// Mass [kg] for each number.
    fn mass(&self) -> &[f64];

    /// 1/mass [1/kg] for each number; zero where nothing may move.
    fn inverse_mass(&self) -> &[f64];

    /// Adds `-df/dx d` [N] for a displacement `d` [m] to `product`.
    fn stiffness_times(&mut self, x: &[f64], v: &[f64], d: &[f64], product: &mut [f64]);

    /// Names every couple of different vertices (two numbers each) whose forces depend on each other, in the order in
    /// which [`Self::add_stiffness`] adds their blocks.
    fn sparsity_pattern(&self, add: &mut dyn FnMut(u32, u32));

    /// Adds `ax (-df/dx) + av (-df/dv)` to a cleared matrix.
    fn add_stiffness(&mut self, x: &[f64], v: &[f64], weights: Weights, matrix: &mut BlockMatrix);

    /// How many times the displacement `d` [m] from the positions `x` [m] may be gone, at most, for no energy to be left that
    /// has a barrier.
    fn longest_step(&self, _x: &[f64], _d: &[f64]) -> f64 {
        f64::INFINITY
    }

    /// Whether [`Self::constrain`] does anything.
    fn constrains(&self) -> bool {
        true
    }

    /// Whether [`Self::constrain`] also acts along the surfaces it stops things at.
    fn has_friction(&self) -> bool {
        true
    }

    /// Takes from velocities `v` [m/s] what leads into walls that are touched where a step begins, at positions and velocities
    /// `before`, by what faces them. `x` is scratch of the same length: where it is not as before there is more to it. Returns
    /// whether no wall moves, and nothing that faces one is inside it.
    fn project_contact_velocity(&mut self, _before: [&[f64]; 2], _x: &mut [f64], _v: &mut [f64]) -> bool {
        false
    }

    /// Forgets what was booked in this step, as it is solved anew.
    fn discard_records(&mut self) {}

    /// Changes positions and velocities at the end of a step that are not allowed, seen from those at its beginning.
    /// Where only what `faces` a wall counts, bodies may still end beyond one: what would come to lie there is for the
    /// solution of the next try to say, in which what faces the wall is held.
    fn constrain(&mut self, _before: [&[f64]; 2], _x: &mut [f64], _v: &mut [f64], _faces: bool) {}
}

/// `v += h f/m`, then `x += h v`.
pub fn symplectic_euler_update(x: &mut [f64], v: &mut [f64], force: &[f64], inverse_mass: &[f64], h: f64) {
    pulp::Arch::new().dispatch(|| {
        for (((x, v), f), inverse_mass) in x.iter_mut().zip(&mut *v).zip(force).zip(inverse_mass) {
            *v += h * f * inverse_mass;
            *x += h * *v;
        }
    });
}

/// A [`Dynamics`] seen as an [`Ode`]: X = (x, v), dX/dt = (v, f/m).
pub struct Rates<'a>(pub &'a mut dyn Dynamics);

impl Ode for Rates<'_> {
    fn rate(&mut self, state: &[f64], rate: &mut [f64]) {
        let ((x, v), (dx, dv)) = (state.split_at(state.len() / 2), rate.split_at_mut(state.len() / 2));
        self.0.force(x, v, dv);
        for (acceleration, inverse_mass) in dv.iter_mut().zip(self.0.inverse_mass()) {
            *acceleration *= inverse_mass;
        }
        // A pinned vertex has no velocity to move with, whatever else the state says.
        for ((dx, v), inverse_mass) in dx.iter_mut().zip(v).zip(self.0.inverse_mass()) {
            *dx = if *inverse_mass == 0.0 { 0.0 } else { *v };
        }
    }

    fn apply_constraints(&mut self, before: &[f64], after: &mut [f64], spare: &mut Vec<f64>) {
        if !self.0.constrains() {
            return;
        }
        let half = after.len() / 2;
        let (x, v) = after.split_at_mut(half);
        apply_constraints(self.0, before.split_at(half).into(), (x, v), spare, false);
    }
}

/// Applies the constraints to a step that began at positions and velocities `before`. Leaves in `spare` what [`touched`]
/// needs.
pub(super) fn apply_constraints(
    system: &mut dyn Dynamics,
    before: [&[f64]; 2],
    (x, v): (&mut [f64], &mut [f64]),
    spare: &mut Vec<f64>,
    faces: bool,
) {
    spare.clear();
    spare.extend_from_slice(v);
    spare.extend_from_slice(x);
    system.constrain(before, x, v, faces);
}

/// Whether [`apply_constraints`] changed a number of the state.
pub(super) fn touched(x: &[f64], v: &[f64], spare: &[f64], number: usize) -> bool {
    v[number] != spare[number] || x[number] != spare[x.len() + number]
}
