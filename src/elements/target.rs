//! What becomes of the forces that elements sum up at their vertices. The elements are swept over in the same way for all of
//! it: forces may be added to others, or move the vertices at once, while everything is still near the processor.

use wide::f64x2;

/// Positions and velocities that forces are computed from, and what is done with the forces. Vertices are numbered as in the
/// scene.
pub trait Target {
    /// Positions [m], and velocities [m/s] if a stress depends on them; flat.
    fn motion(&self) -> [&[f64]; 2];

    /// Takes the forces on some vertices [N]. Each vertex comes once, after everything that depends on where it is.
    fn take(&mut self, forces: impl Iterator<Item = (usize, f64x2)>);

    /// The same for vertices whose numbers follow each other from `first` on.
    fn take_run(&mut self, first: usize, forces: impl ExactSizeIterator<Item = f64x2>);
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
    fn take(&mut self, forces: impl Iterator<Item = (usize, f64x2)>) {
        let so_far: &mut [[f64; 2]] = self.force.as_chunks_mut().0;
        for (vertex, force) in forces {
            let at = &mut so_far[vertex];
            *at = (f64x2::new(*at) + force).to_array();
        }
    }

    #[inline(always)]
    fn take_run(&mut self, first: usize, forces: impl ExactSizeIterator<Item = f64x2>) {
        let so_far: &mut [[f64; 2]] = self.force.as_chunks_mut().0;
        for (at, force) in so_far[first..first + forces.len()].iter_mut().zip(forces) {
            *at = (f64x2::new(*at) + force).to_array();
        }
    }
}

/// Moves each vertex by a step of symplectic Euler: `v += h (f + m g)/m`, then `x += h v`, for vertices that nothing else acts on.
pub struct Kicking<'a> {
    /// Positions, flat [m].
    pub x: &'a mut [f64],
    /// Velocities, flat [m/s].
    pub v: &'a mut [f64],
    /// Masses, flat [kg].
    pub mass: &'a [f64],
    /// 1/mass, flat [1/kg]; zero where nothing moves.
    pub inverse_mass: &'a [f64],
    /// An acceleration g that every vertex is given beside its force [m/s²].
    pub field: [f64; 2],
    /// Length of the step h [s].
    pub step: f64,
    /// Twice the energy of motion of all that was moved [J].
    pub twice_kinetic: f64,
}

impl Target for Kicking<'_> {
    #[inline(always)]
    fn motion(&self) -> [&[f64]; 2] {
        [self.x, &[]]
    }

    #[inline(always)]
    fn take(&mut self, forces: impl Iterator<Item = (usize, f64x2)>) {
        let ([x, v], [mass, inverse_mass], kick) = self.parts();
        let mut squares = f64x2::ZERO;
        for (vertex, force) in forces {
            squares += kick.of([&mut x[vertex], &mut v[vertex]], [mass[vertex], inverse_mass[vertex]], force);
        }
        self.book(squares);
    }

    #[inline(always)]
    fn take_run(&mut self, first: usize, forces: impl ExactSizeIterator<Item = f64x2>) {
        let run = first..first + forces.len();
        let ([x, v], [mass, inverse_mass], kick) = self.parts();
        let moving = x[run.clone()].iter_mut().zip(&mut v[run.clone()]);
        let masses = mass[run.clone()].iter().zip(&inverse_mass[run]);
        let mut squares = f64x2::ZERO;
        for ((force, (x, v)), (mass, inverse_mass)) in forces.zip(moving).zip(masses) {
            squares += kick.of([x, v], [*mass, *inverse_mass], force);
        }
        self.book(squares);
    }
}

/// Positions and velocities by vertices.
type Moving<'a> = [&'a mut [[f64; 2]]; 2];

/// Masses and their reciprocals by vertices.
type Masses<'a> = [&'a [[f64; 2]]; 2];

/// What is the same for every vertex.
#[derive(Clone, Copy)]
pub(super) struct Kick {
    field: f64x2,
    step: f64x2,
}

impl Kick {
    /// For an acceleration that every vertex is given [m/s²], and steps of a length [s].
    #[inline(always)]
    pub fn new(field: [f64; 2], step: f64) -> Self {
        Self { field: f64x2::new(field), step: f64x2::splat(step) }
    }

    /// Moves one vertex; its mass times the squares of its velocity.
    #[inline(always)]
    pub fn of(self, [x, v]: [&mut [f64; 2]; 2], masses: [[f64; 2]; 2], force: f64x2) -> f64x2 {
        let [mass, inverse_mass] = masses.map(f64x2::new);
        let now = f64x2::new(*v) + self.step * (force + mass * self.field) * inverse_mass;
        // Both numbers are written at once, as they are read next: together what was written apart is not at hand.
        *v = now.to_array();
        *x = (f64x2::new(*x) + self.step * now).to_array();
        mass * now * now
    }
}

impl Kicking<'_> {
    /// Positions and velocities, masses and their reciprocals, all by vertices, and what is the same for all.
    #[inline(always)]
    fn parts(&mut self) -> (Moving<'_>, Masses<'_>, Kick) {
        let moving = [&mut *self.x, &mut *self.v].map(|values| values.as_chunks_mut().0);
        let masses = [self.mass, self.inverse_mass].map(|values| values.as_chunks().0);
        (moving, masses, Kick::new(self.field, self.step))
    }

    #[inline(always)]
    fn book(&mut self, squares: f64x2) {
        let [along_x, along_y] = squares.to_array();
        self.twice_kinetic += along_x + along_y;
    }
}
