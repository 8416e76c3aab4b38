//! Symplectic Euler update of vertices with complete forces: `v += h f/m`, then `x += h v`.

use super::UniformForce;
use crate::simd::{Lanes, Wide};
use pulp::{
    Simd,
    bytemuck::{cast_mut as flat_mut, cast_ref as flat},
};
use std::ops::{Add, Mul, Sub};
use wide::f64x2;

/// Positions and velocities of vertices.
pub type Moving<'a> = [&'a mut [[f64; 2]]; 2];

/// Masses of vertices and their reciprocals.
pub type Masses<'a> = [&'a [[f64; 2]]; 2];

/// Coefficients of the update, equal for all vertices: one vector, or copies for several vertices.
#[derive(Clone, Copy)]
pub struct EulerCoefficients<T = f64x2> {
    field: T,
    mass_damping: T,
    drag: T,
    /// Whether mass damping or drag is nonzero.
    slows: bool,
    step: T,
}

impl<T: Copy + Add<Output = T> + Sub<Output = T> + Mul<Output = T>> EulerCoefficients<T> {
    /// Position and velocity after the step, and mass times velocity squared, componentwise; `forces` gives those of
    /// each of N stresses.
    #[inline(always)]
    fn after<const N: usize>(
        self,
        [x, v]: [T; 2],
        [mass, inverse_mass]: [T; 2],
        forces: impl Fn(usize) -> T,
    ) -> [T; 3] {
        let mut force = forces(0) + mass * self.field;
        if N > 1 || self.slows {
            force = force - self.mass_damping * mass * v;
            for stress in 1..N {
                force = force + forces(stress);
            }
            force = force - self.drag * v;
        }
        let now = v + self.step * force * inverse_mass;
        [x + self.step * now, now, mass * now * now]
    }
}

impl EulerCoefficients {
    /// Coefficients for a uniform force and a step length [s].
    #[inline(always)]
    pub fn new(uniform_force: UniformForce, step: f64) -> Self {
        let UniformForce { field, mass_damping, drag, .. } = uniform_force;
        Self {
            field: f64x2::new(field),
            mass_damping: f64x2::splat(mass_damping),
            drag: f64x2::splat(drag),
            slows: mass_damping != 0.0 || drag != 0.0,
            step: f64x2::splat(step),
        }
    }

    /// Updates one vertex; returns its mass times velocity squared, componentwise.
    #[inline(always)]
    pub fn of<const N: usize>(self, [x, v]: [&mut [f64; 2]; 2], masses: [[f64; 2]; 2], forces: [f64x2; N]) -> f64x2 {
        let [mass, inverse_mass] = masses.map(f64x2::new);
        let before = [f64x2::new(*x), f64x2::new(*v)];
        let [place, velocity, squares] = self.after::<N>(before, [mass, inverse_mass], |stress| forces[stress]);
        // Both numbers are written in one store, because the next load reads both: two stores would prevent store
        // forwarding.
        (*x, *v) = (place.to_array(), velocity.to_array());
        squares
    }

    /// Updates consecutive vertices from `first` on, in groups of four and a rest; returns the sum of mass times
    /// velocity squared.
    #[inline(always)]
    pub fn update_run<S: Simd, const N: usize>(
        self,
        set: S,
        first: usize,
        [x, v]: Moving<'_>,
        [mass, inverse_mass]: Masses<'_>,
        fours: impl ExactSizeIterator<Item = [[f64x2; N]; 4]>,
        rest: impl ExactSizeIterator<Item = [f64x2; N]>,
    ) -> f64x2 {
        let run = first..first + 4 * fours.len() + rest.len();
        let (x, x_rest) = x[run.clone()].as_chunks_mut();
        let (v, v_rest) = v[run.clone()].as_chunks_mut();
        let (mass, mass_rest) = mass[run.clone()].as_chunks();
        let (inverse_mass, inverse_mass_rest) = inverse_mass[run].as_chunks();
        let mut sums = Lanes::default();
        let moving = x.iter_mut().zip(v);
        let masses = mass.iter().zip(inverse_mass);
        for (((x, v), (mass, inverse_mass)), forces) in moving.zip(masses).zip(fours) {
            self.update_four(set, [x, v], [mass, inverse_mass], forces, &mut sums);
        }
        let [ax, ay, bx, by, cx, cy, dx, dy] = sums;
        let mut squares = f64x2::new([ax, ay]) + f64x2::new([bx, by]) + (f64x2::new([cx, cy]) + f64x2::new([dx, dy]));
        let moving = x_rest.iter_mut().zip(v_rest);
        let masses = mass_rest.iter().zip(inverse_mass_rest);
        for (((x, v), (mass, inverse_mass)), forces) in moving.zip(masses).zip(rest) {
            squares += self.of([x, v], [*mass, *inverse_mass], forces);
        }
        squares
    }

    /// Updates four vertices in SIMD lanes and adds to separate sums.
    #[inline(always)]
    fn update_four<S: Simd, const N: usize>(
        self,
        set: S,
        [x, v]: [&mut [[f64; 2]; 4]; 2],
        masses: [&[[f64; 2]; 4]; 2],
        [a, b, c, d]: [[f64x2; N]; 4],
        sums: &mut Lanes,
    ) {
        for part in 0..Wide::<S>::PARTS {
            let wide = |numbers: &Lanes| Wide::load(set, numbers, part);
            let each = |vector: f64x2| wide(&side_by_side([vector; 4]));
            let euler_update = EulerCoefficients {
                field: each(self.field),
                mass_damping: each(self.mass_damping),
                drag: each(self.drag),
                slows: self.slows,
                step: each(self.step),
            };
            let masses = [wide(flat(masses[0])), wide(flat(masses[1]))];
            let forces = |stress: usize| wide(&side_by_side([a[stress], b[stress], c[stress], d[stress]]));
            let [place, velocity, squares] = euler_update.after::<N>([wide(flat(x)), wide(flat(v))], masses, forces);
            place.store(flat_mut(x), part);
            velocity.store(flat_mut(v), part);
            (wide(sums) + squares).store(sums, part);
        }
    }
}

/// The numbers of four vectors.
#[inline(always)]
fn side_by_side([a, b, c, d]: [f64x2; 4]) -> Lanes {
    let ([ax, ay], [bx, by], [cx, cy], [dx, dy]) = (a.to_array(), b.to_array(), c.to_array(), d.to_array());
    [ax, ay, bx, by, cx, cy, dx, dy]
}
