//! Force accumulators: assembled forces are added to a vector, or update the vertices at once.

use super::euler_update::{EulerCoefficients, Masses, Moving};
use pulp::Simd;
use std::ops::Range;
use wide::f64x2;

/// Receives the forces on vertices, separately for each of N stresses.
pub trait Scatter<const N: usize = 1> {
    /// Receives the forces on some vertices [N]. Each vertex comes once.
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

    /// Positions [m], and velocities [m/s] if a stress depends on them; flat.
    fn motion(&self) -> [&[f64]; 2];

    /// A view of a range of vertices.
    fn view(&mut self, vertices: Range<usize>) -> Self::View<'_>;

    /// Splits the vertices at a number.
    fn split(self, vertex: usize) -> (Self, Self);

    /// Sum over the vertices, as defined by the accumulator.
    fn sum(&self) -> f64 {
        0.0
    }
}

/// Adds forces to a vector.
pub struct Adding<'a> {
    /// Positions, flat [m].
    pub x: &'a [f64],
    /// Velocities, flat [m/s]; empty if no stress depends on them.
    pub v: &'a [f64],
    /// Forces so far [N].
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

/// Uniform forces beside the elements, added to their forces in this order.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct UniformForce {
    /// An acceleration g that every vertex is given, by the force `m g` [m/s²].
    pub field: [f64; 2],
    /// alpha of the force `-alpha m v` [1/s].
    pub mass_damping: f64,
    /// beta of the forces of a viscous stress in all triangles [s].
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
/// force. Where forces come separately, the second ones are those of the viscous stress.
pub struct EulerUpdate<'a> {
    /// Positions, flat [m].
    pub x: &'a mut [f64],
    /// Velocities, flat [m/s].
    pub v: &'a mut [f64],
    /// Masses, flat [kg].
    pub mass: &'a [f64],
    /// 1/mass, flat [1/kg]; zero for constrained coordinates.
    pub inverse_mass: &'a [f64],
    /// Uniform force beside the elements.
    pub uniform_force: UniformForce,
    /// Length of the step h [s].
    pub step: f64,
    /// Twice the kinetic energy of all updated vertices [J].
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

    /// Twice the kinetic energy of the updated vertices [J].
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
