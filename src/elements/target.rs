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
        let [x, v] = [&mut *self.x, &mut *self.v].map(|values| values.as_chunks_mut::<2>().0);
        let [mass, inverse_mass] = [self.mass, self.inverse_mass].map(|values| values.as_chunks::<2>().0);
        let (field, h) = (f64x2::new(self.field), f64x2::splat(self.step));
        let mut squares = f64x2::ZERO;
        for (vertex, force) in forces {
            let [mass, inverse_mass] = [mass[vertex], inverse_mass[vertex]].map(f64x2::new);
            // Both numbers at once, as they are read: what was written apart is not at hand together.
            let now = f64x2::new(v[vertex]) + h * (force + mass * field) * inverse_mass;
            v[vertex] = now.to_array();
            x[vertex] = (f64x2::new(x[vertex]) + h * now).to_array();
            squares += mass * now * now;
        }
        let [along_x, along_y] = squares.to_array();
        self.twice_kinetic += along_x + along_y;
    }
}
