//! Systems that integrators step: [`Ode`] (first order) and [`Dynamics`] (second order).

use crate::solvers::{SparseMatrix, Weights};

/// A system of first order, `dX/dt = f(t, X)`, flat and of any length.
///
/// In a [`State`](crate::state::State) X is the positions followed by the velocities; a system of first order that is
/// not a [`Dynamics`] keeps all of X in the positions and leaves the velocities empty.
pub trait Ode {
    /// Writes f(t, X) to `rate`, at a time since the start of the step \[s\].
    fn rate(&mut self, time: f64, x: &[f64], rate: &mut [f64]);

    /// Ends a step, or an inner step that is followed by another, at a time since the start of the step \[s\]. Schemes with
    /// inner steps call it after each; the caller of a scheme calls it at the end of the step.
    fn end_step(&mut self, _time: f64, _x: &[f64]) {}

    /// Applies constraints that may not wait for the end of the step to an inner step from `before` to `after`, which ends at
    /// a time since the start of the step \[s\]; returns whether anything changed.
    fn truncate(&mut self, _time: f64, _before: &[f64], _after: &mut [f64]) -> bool {
        false
    }

    /// Changes the end of a step from `before` to `after` so that it keeps constraints; returns whether it had to.
    fn constrain(&mut self, _before: &[f64], _after: &mut [f64]) -> bool {
        false
    }
}

/// A system of second order, `M a = f(t, x, v)`, with a diagonal mass matrix and constraints on single vertices.
///
/// [`Rates`] makes it an [`Ode`], with X = (x, v).
pub trait Dynamics {
    /// Writes the force \[N\] at a time since the start of the step \[s\], at these positions \[m\] and velocities [m/s];
    /// all flat and of one length.
    fn force(&mut self, time: f64, x: &[f64], v: &[f64], force: &mut [f64]);

    /// A hash of everything that forces depend on beside positions and velocities, such as the pull of the mouse: a
    /// stored force is valid while it stays the same.
    fn load_fingerprint(&self) -> u32 {
        0
    }

    /// Symplectic Euler update, `v += h f(x, v)/m`, then `x += h v`. `force` is scratch of the same length. A system
    /// may update vertices while their forces are in the cache.
    fn symplectic_euler_update(&mut self, x: &mut [f64], v: &mut [f64], force: &mut [f64], h: f64) {
        self.force(0.0, x, v, force);
        symplectic_euler_update(x, v, force, self.inverse_mass(), h);
    }

    /// Mass \[kg\] for each number.
    fn mass(&self) -> &[f64];

    /// 1/mass [1/kg] for each number; zero where nothing may move.
    fn inverse_mass(&self) -> &[f64];

    /// Adds what the mass matrix has beside [`Self::mass`] times z to `product`, which becomes zero where nothing may move. The forces of
    /// explicit schemes contain it already: with them, the masses alone have the accelerations of the whole matrix.
    fn add_coupled_mass(&self, _z: &[f64], _product: &mut [f64]) {}

    /// Adds the mass matrix to a matrix to which [`Self::add_stiffness`] has added.
    fn add_mass(&self, matrix: &mut dyn SparseMatrix) {
        let mass = self.mass();
        matrix.add_to_diagonal(&|number| mass[number]);
    }

    /// Adds `-df/dx d` \[N\] for a displacement `d` \[m\] to `product`.
    fn stiffness_times(&mut self, time: f64, x: &[f64], v: &[f64], d: &[f64], product: &mut [f64]);

    /// Number of numbers of a vertex, which is the size of the blocks of the stiffness matrix: 1, 2 or 3.
    fn block_size(&self) -> usize;

    /// Sparsity pattern: calls `add` for every pair of different vertices whose forces depend on each other, in the order
    /// in which [`Self::add_stiffness`] adds their blocks.
    fn sparsity_pattern(&self, add: &mut dyn FnMut(u32, u32));

    /// Adds vertex pairs to the sparsity pattern whose forces depend on each other at positions x \[m\] alone. Returns whether
    /// the pattern has changed since the last call.
    fn pattern_changes(&mut self, _x: &[f64]) -> bool {
        false
    }

    /// Adds `ax (-df/dx) + av (-df/dv)` to a cleared matrix.
    fn add_stiffness(&mut self, time: f64, x: &[f64], v: &[f64], weights: Weights, matrix: &mut dyn SparseMatrix);

    /// Whether [`Self::add_stiffness`] adds the derivative of the force; otherwise a matrix that is near to it in short steps.
    fn has_derivative(&self) -> bool {
        true
    }

    /// Whether exact constraints act beside those on single vertices; see [`Self::correct_step`].
    fn is_constrained(&self) -> bool {
        false
    }

    /// Corrects a step of Newton's method from accelerations z, at these positions and velocities and a time since the start of the step \[s\], for
    /// the constraints; see [`ConstraintRows::correct`](crate::solvers::ConstraintRows::correct).
    fn correct_step(
        &mut self,
        _time: f64,
        _motion: [&[f64]; 2],
        _weights: [f64; 2],
        (_z, _step): (&[f64], &mut [f64]),
        _invert: &mut dyn FnMut(&mut [f64]),
    ) {
    }

    /// Largest multiple of the displacement `d` \[m\] from the positions `x` \[m\] that stays within the barriers of all
    /// energies.
    fn longest_step(&mut self, _x: &[f64], _d: &[f64]) -> f64 {
        f64::INFINITY
    }

    /// Whether [`Self::constrain`] does anything.
    fn constrains(&self) -> bool {
        true
    }

    /// Whether a contact potential acts at a time since the start of the step \[s\].
    fn touches(&mut self, _time: f64, _x: &[f64], _v: &[f64]) -> bool {
        false
    }

    /// Ends a step or an inner step; see [`Ode::end_step`].
    fn end_step(&mut self, _time: f64, _x: &[f64], _v: &[f64]) {}

    /// Applies constraints that may not wait for the end of the step; see [`Ode::truncate`].
    fn truncate(&mut self, _time: f64, _before: &[f64], _x: &mut [f64], _v: &mut [f64]) -> bool {
        false
    }

    /// Changes positions and velocities at the end of a step so that it keeps constraints, given the positions at its start;
    /// returns whether it had to.
    fn constrain(&mut self, _before: &[f64], _x: &mut [f64], _v: &mut [f64]) -> bool {
        false
    }
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

/// A [`Dynamics`] as an [`Ode`]: X = (x, v), dX/dt = (v, f/m).
pub struct Rates<'a>(pub &'a mut dyn Dynamics);

impl Ode for Rates<'_> {
    fn rate(&mut self, time: f64, state: &[f64], rate: &mut [f64]) {
        let ((x, v), (dx, dv)) = (state.split_at(state.len() / 2), rate.split_at_mut(state.len() / 2));
        self.0.force(time, x, v, dv);
        for (acceleration, inverse_mass) in dv.iter_mut().zip(self.0.inverse_mass()) {
            *acceleration *= inverse_mass;
        }
        // The velocity of a pinned vertex is zero, whatever the state contains.
        for ((dx, v), inverse_mass) in dx.iter_mut().zip(v).zip(self.0.inverse_mass()) {
            *dx = if *inverse_mass == 0.0 { 0.0 } else { *v };
        }
    }

    fn end_step(&mut self, time: f64, state: &[f64]) {
        let (x, v) = state.split_at(state.len() / 2);
        self.0.end_step(time, x, v);
    }

    fn truncate(&mut self, time: f64, before: &[f64], after: &mut [f64]) -> bool {
        let half = after.len() / 2;
        let (x, v) = after.split_at_mut(half);
        self.0.truncate(time, &before[..half], x, v)
    }

    fn constrain(&mut self, before: &[f64], after: &mut [f64]) -> bool {
        let half = after.len() / 2;
        let (x, v) = after.split_at_mut(half);
        self.0.constrain(&before[..half], x, v)
    }
}
