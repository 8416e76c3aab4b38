//! Force accumulators: assembled forces are added to a vector, or update the vertices at once by symplectic Euler,
//! `v += h f/m`, then `x += h v`.

use crate::simd::{Lanes, Wide};
use pulp::{
    Simd,
    bytemuck::{cast_mut as flat_mut, cast_ref as flat},
};
use std::ops::{Add, Mul, Range, Sub};
use wide::f64x2;

/// Receives the forces on vertices, separately for each of N stresses.
pub trait Scatter<const N: usize = 1> {
    /// Receives the forces on some vertices \[N\]. Each vertex comes once.
    fn take(&mut self, forces: impl Iterator<Item = (usize, [f64x2; N])>);

    /// The same for consecutive vertices from `first` on: in groups of four, and a rest.
    fn take_run<S: Simd>(
        &mut self,
        set: S,
        first: usize,
        fours: impl ExactSizeIterator<Item = [[f64x2; N]; 4]>,
        rest: impl ExactSizeIterator<Item = [f64x2; N]>,
    );
}

/// The vertices of a scene, a body or a partition: positions and velocities that forces are computed from, and a
/// receiver of forces. Vertices are counted from its first.
pub trait Accumulator<const N: usize = 1>: Scatter<N> + Send + Sized {
    /// A view of some of the vertices.
    type View<'a>: Accumulator<N>
    where
        Self: 'a;

    /// Positions \[m\], and velocities [m/s] if a stress depends on them; flat.
    fn motion(&self) -> [&[f64]; 2];

    /// A view of a range of vertices.
    fn view(&mut self, vertices: Range<usize>) -> Self::View<'_>;

    /// Splits the vertices at a number.
    fn split(self, vertex: usize) -> (Self, Self);

    /// Twice the kinetic energy of the vertices \[J\] after an update, or zero.
    fn sum(&self) -> f64 {
        0.0
    }
}

/// Adds forces to a vector.
pub struct Adding<'a> {
    /// Positions, flat \[m\].
    pub x: &'a [f64],
    /// Velocities, flat [m/s]; empty if no stress depends on them.
    pub v: &'a [f64],
    /// Forces so far \[N\].
    pub force: &'a mut [f64],
}

impl Accumulator for Adding<'_> {
    type View<'a>
        = Adding<'a>
    where
        Self: 'a;

    #[inline(always)]
    fn motion(&self) -> [&[f64]; 2] {
        [self.x, self.v]
    }

    fn view(&mut self, vertices: Range<usize>) -> Adding<'_> {
        let range = 2 * vertices.start..2 * vertices.end;
        Adding {
            x: &self.x[range.clone()],
            v: self.v.get(range.clone()).unwrap_or_default(),
            force: &mut self.force[range],
        }
    }

    fn split(self, vertex: usize) -> (Self, Self) {
        let ((x, other_x), (force, other_force)) = (self.x.split_at(2 * vertex), self.force.split_at_mut(2 * vertex));
        let (v, other_v) = self.v.split_at_checked(2 * vertex).unwrap_or_default();
        (Self { x, v, force }, Self { x: other_x, v: other_v, force: other_force })
    }
}

impl Scatter for Adding<'_> {
    #[inline(always)]
    fn take(&mut self, forces: impl Iterator<Item = (usize, [f64x2; 1])>) {
        let so_far: &mut [[f64; 2]] = self.force.as_chunks_mut().0;
        for (vertex, [force]) in forces {
            let at = &mut so_far[vertex];
            *at = (f64x2::new(*at) + force).to_array();
        }
    }

    #[inline(always)]
    fn take_run<S: Simd>(
        &mut self,
        _: S,
        first: usize,
        fours: impl ExactSizeIterator<Item = [[f64x2; 1]; 4]>,
        rest: impl ExactSizeIterator<Item = [f64x2; 1]>,
    ) {
        let so_far: &mut [[f64; 2]] = &mut self.force.as_chunks_mut().0[first..first + 4 * fours.len() + rest.len()];
        let (of_fours, of_rest) = so_far.as_chunks_mut::<4>();
        let add = |at: &mut [f64; 2], force: f64x2| *at = (f64x2::new(*at) + force).to_array();
        for (at, forces) in of_fours.iter_mut().zip(fours) {
            at.iter_mut().zip(forces).for_each(|(at, [force])| add(at, force));
        }
        of_rest.iter_mut().zip(rest).for_each(|(at, [force])| add(at, force));
    }
}

/// Gravity, damping and drag with one coefficient for all vertices, added to the forces of the elements in this order.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct UniformForce {
    /// g of the gravity `m g` [m/s²].
    pub field: [f64; 2],
    /// alpha of the force `-alpha m v` [1/s].
    pub mass_damping: f64,
    /// beta of the forces of a viscous stress in all triangles \[s\].
    pub stiffness_damping: f64,
    /// k of the force `-k v` [N s/m].
    pub drag: f64,
}

impl UniformForce {
    /// The sum, if no term of `other` comes before a term of `self` in that order.
    pub fn and(self, other: Self) -> Option<Self> {
        let acts =
            |of: Self| [of.field != [0.0; 2], of.mass_damping != 0.0, of.stiffness_damping != 0.0, of.drag != 0.0];
        let end = acts(self).iter().rposition(|acts| *acts).map_or(0, |last| last + 1);
        let begin = acts(other).iter().position(|acts| *acts).unwrap_or(end);
        (end <= begin).then(|| Self {
            field: [0, 1].map(|axis| self.field[axis] + other.field[axis]),
            mass_damping: self.mass_damping + other.mass_damping,
            stiffness_damping: self.stiffness_damping + other.stiffness_damping,
            drag: self.drag + other.drag,
        })
    }
}

/// Updates each vertex by symplectic Euler, `v += h f/m`, then `x += h v`, with the forces of elements and the uniform
/// force. For N = 2 the second forces are those of the viscous stress.
pub struct EulerUpdate<'a> {
    /// Positions, flat \[m\].
    pub x: &'a mut [f64],
    /// Velocities, flat [m/s].
    pub v: &'a mut [f64],
    /// Masses, flat \[kg\].
    pub mass: &'a [f64],
    /// 1/mass, flat [1/kg]; zero for constrained coordinates.
    pub inverse_mass: &'a [f64],
    /// Uniform force beside the elements.
    pub uniform_force: UniformForce,
    /// Length of the step h \[s\].
    pub step: f64,
    /// Twice the kinetic energy of all updated vertices \[J\].
    pub twice_kinetic: f64,
}

impl<const N: usize> Accumulator<N> for EulerUpdate<'_> {
    type View<'a>
        = EulerUpdate<'a>
    where
        Self: 'a;

    #[inline(always)]
    fn motion(&self) -> [&[f64]; 2] {
        [self.x, self.v]
    }

    fn view(&mut self, vertices: Range<usize>) -> EulerUpdate<'_> {
        let range = 2 * vertices.start..2 * vertices.end;
        EulerUpdate {
            x: &mut self.x[range.clone()],
            v: &mut self.v[range.clone()],
            mass: &self.mass[range.clone()],
            inverse_mass: &self.inverse_mass[range],
            twice_kinetic: 0.0,
            ..*self
        }
    }

    fn split(self, vertex: usize) -> (Self, Self) {
        let at = 2 * vertex;
        let ((x, other_x), (v, other_v)) = (self.x.split_at_mut(at), self.v.split_at_mut(at));
        let (mass, other_mass) = self.mass.split_at(at);
        let (inverse_mass, other_inverse) = self.inverse_mass.split_at(at);
        let Self { uniform_force, step, .. } = self;
        let other = Self {
            x: other_x,
            v: other_v,
            mass: other_mass,
            inverse_mass: other_inverse,
            uniform_force,
            step,
            twice_kinetic: 0.0,
        };
        (Self { x, v, mass, inverse_mass, uniform_force, step, twice_kinetic: self.twice_kinetic }, other)
    }

    /// Twice the kinetic energy of the updated vertices \[J\].
    fn sum(&self) -> f64 {
        self.twice_kinetic
    }
}

impl<const N: usize> Scatter<N> for EulerUpdate<'_> {
    #[inline(always)]
    fn take(&mut self, forces: impl Iterator<Item = (usize, [f64x2; N])>) {
        let ([x, v], [mass, inverse_mass], euler_update) = self.views();
        let mut squares = f64x2::ZERO;
        for (vertex, forces) in forces {
            squares += euler_update.of([&mut x[vertex], &mut v[vertex]], [mass[vertex], inverse_mass[vertex]], forces);
        }
        self.add_squares(squares);
    }

    #[inline(always)]
    fn take_run<S: Simd>(
        &mut self,
        set: S,
        first: usize,
        fours: impl ExactSizeIterator<Item = [[f64x2; N]; 4]>,
        rest: impl ExactSizeIterator<Item = [f64x2; N]>,
    ) {
        let (moving, masses, euler_update) = self.views();
        let squares = euler_update.update_run(set, first, moving, masses, fours, rest);
        self.add_squares(squares);
    }
}

impl EulerUpdate<'_> {
    /// Positions and velocities, masses and their reciprocals, all by vertices, and the coefficients.
    #[inline(always)]
    fn views(&mut self) -> (Moving<'_>, Masses<'_>, EulerCoefficients) {
        let moving = [&mut *self.x, &mut *self.v].map(|values| values.as_chunks_mut().0);
        let masses = [self.mass, self.inverse_mass].map(|values| values.as_chunks().0);
        (moving, masses, EulerCoefficients::new(self.uniform_force, self.step))
    }

    #[inline(always)]
    fn add_squares(&mut self, squares: f64x2) {
        let [along_x, along_y] = squares.to_array();
        self.twice_kinetic += along_x + along_y;
    }
}

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
    /// Coefficients for a uniform force and a step length \[s\].
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
