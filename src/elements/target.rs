//! What becomes of the forces that elements sum up at their vertices. The elements are swept over in the same way for all of
//! it: forces may be added to others, or move the vertices at once, while everything is still near the processor.

use super::kick::{Kick, Masses, Moving};
use pulp::Simd;
use wide::f64x2;

/// Positions and velocities that forces are computed from, and what is done with the forces. Vertices are numbered as in the
/// scene. Each of N stresses has its own forces.
pub trait Target<const N: usize = 1> {
    /// Positions [m], and velocities [m/s] if a stress depends on them; flat.
    fn motion(&self) -> [&[f64]; 2];

    /// Takes the forces on some vertices [N]. Each vertex comes once, after everything that depends on where it is.
    fn take(&mut self, forces: impl Iterator<Item = (usize, [f64x2; N])>);

    /// The same for vertices whose numbers follow each other from `first` on: four at a time, and what is left.
    fn take_run<S: Simd>(
        &mut self,
        set: S,
        first: usize,
        fours: impl ExactSizeIterator<Item = [[f64x2; N]; 4]>,
        rest: impl ExactSizeIterator<Item = [f64x2; N]>,
    );
}

/// Adds the forces to others.
pub struct Adding<'a> {
    /// Positions, flat [m].
    pub x: &'a [f64],
    /// Velocities, flat [m/s].
    pub v: &'a [f64],
    /// Forces so far [N].
    pub force: &'a mut [f64],
}

impl Target for Adding<'_> {
    #[inline(always)]
    fn motion(&self) -> [&[f64]; 2] {
        [self.x, self.v]
    }

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

/// What acts everywhere beside the elements, and is added to their forces in this order.
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
    /// Both, if `other` has nothing that would be added before anything of this.
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

/// Moves each vertex by a step of symplectic Euler, `v += h f/m`, then `x += h v`, with the forces of elements and of what acts
/// everywhere. Where forces are handed out apart, the others are those of the viscous stress.
pub struct Kicking<'a> {
    /// Positions, flat [m].
    pub x: &'a mut [f64],
    /// Velocities, flat [m/s].
    pub v: &'a mut [f64],
    /// Masses, flat [kg].
    pub mass: &'a [f64],
    /// 1/mass, flat [1/kg]; zero where nothing moves.
    pub inverse_mass: &'a [f64],
    /// What acts beside the elements.
    pub uniform_force: UniformForce,
    /// Length of the step h [s].
    pub step: f64,
    /// Twice the energy of motion of all that was moved [J].
    pub twice_kinetic: f64,
}

impl<const N: usize> Target<N> for Kicking<'_> {
    #[inline(always)]
    fn motion(&self) -> [&[f64]; 2] {
        [self.x, self.v]
    }

    #[inline(always)]
    fn take(&mut self, forces: impl Iterator<Item = (usize, [f64x2; N])>) {
        let ([x, v], [mass, inverse_mass], kick) = self.parts();
        let mut squares = f64x2::ZERO;
        for (vertex, forces) in forces {
            squares += kick.of([&mut x[vertex], &mut v[vertex]], [mass[vertex], inverse_mass[vertex]], forces);
        }
        self.book(squares);
    }

    #[inline(always)]
    fn take_run<S: Simd>(
        &mut self,
        set: S,
        first: usize,
        fours: impl ExactSizeIterator<Item = [[f64x2; N]; 4]>,
        rest: impl ExactSizeIterator<Item = [f64x2; N]>,
    ) {
        let (moving, masses, kick) = self.parts();
        let squares = kick.of_run(set, first, moving, masses, fours, rest);
        self.book(squares);
    }
}

impl Kicking<'_> {
    /// Positions and velocities, masses and their reciprocals, all by vertices, and what is the same for all.
    #[inline(always)]
    fn parts(&mut self) -> (Moving<'_>, Masses<'_>, Kick) {
        let moving = [&mut *self.x, &mut *self.v].map(|values| values.as_chunks_mut().0);
        let masses = [self.mass, self.inverse_mass].map(|values| values.as_chunks().0);
        (moving, masses, Kick::new(self.uniform_force, self.step))
    }

    #[inline(always)]
    fn book(&mut self, squares: f64x2) {
        let [along_x, along_y] = squares.to_array();
        self.twice_kinetic += along_x + along_y;
    }
}
