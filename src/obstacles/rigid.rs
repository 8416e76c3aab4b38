//! Rigid motion of an obstacle, and a step in its frame of reference.

/// A rigid placement and its velocity, in the plane or in space: a point `p` of the shape is at `R p + t`, and a material point at
/// x has the velocity `u + W x`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rigid<const D: usize = 2> {
    /// R, by rows.
    pub turn: [[f64; D]; D],
    /// t \[m\].
    pub shift: [f64; D],
    /// u: the velocity of the material point at the origin of the world [m/s].
    pub velocity: [f64; D],
    /// W: the rate of turning as an antisymmetric matrix, by rows [rad/s].
    pub spin: [[f64; D]; D],
}

/// Sum of products of a row of a matrix with a vector.
fn product<const D: usize>(row: [f64; D], vector: [f64; D]) -> f64 {
    (1..D).fold(row[0] * vector[0], |sum, axis| sum + row[axis] * vector[axis])
}

/// A column of a matrix.
fn column<const D: usize>(matrix: &[[f64; D]; D], number: usize) -> [f64; D] {
    std::array::from_fn(|row| matrix[row][number])
}

/// Product of two matrices.
fn times<const D: usize>(a: &[[f64; D]; D], b: &[[f64; D]; D]) -> [[f64; D]; D] {
    a.map(|row| std::array::from_fn(|axis| product(row, column(b, axis))))
}

impl<const D: usize> Rigid<D> {
    /// The identity, at rest.
    pub const STILL: Self = Self {
        turn: {
            let mut turn = [[0.0; D]; D];
            let mut axis = 0;
            while axis < D {
                turn[axis][axis] = 1.0;
                axis += 1;
            }
            turn
        },
        shift: [0.0; D],
        velocity: [0.0; D],
        spin: [[0.0; D]; D],
    };

    /// Applies R to a direction.
    fn turned(&self, vector: [f64; D]) -> [f64; D] {
        self.turn.map(|row| product(row, vector))
    }

    /// Applies R⁻¹ to a direction.
    fn turned_back(&self, vector: [f64; D]) -> [f64; D] {
        std::array::from_fn(|axis| product(column(&self.turn, axis), vector))
    }

    /// Maps a point of the shape to the world.
    pub fn point(&self, point: [f64; D]) -> [f64; D] {
        let turned = self.turned(point);
        std::array::from_fn(|axis| turned[axis] + self.shift[axis])
    }

    /// Maps a point of the world to the shape.
    pub fn back(&self, point: [f64; D]) -> [f64; D] {
        self.turned_back(std::array::from_fn(|axis| point[axis] - self.shift[axis]))
    }

    /// Velocity of the material point at a point of the world [m/s].
    pub fn velocity_at(&self, point: [f64; D]) -> [f64; D] {
        std::array::from_fn(|axis| self.velocity[axis] + product(self.spin[axis], point))
    }

    /// Composes this motion with an earlier one.
    #[must_use]
    pub fn of(&self, moved: &Self) -> Self {
        let turned = self.turned(moved.velocity);
        let spin = self.turned_spin(&moved.spin);
        let carried = spin.map(|row| product(row, self.shift));
        Self {
            turn: times(&self.turn, &moved.turn),
            shift: self.point(moved.shift),
            velocity: std::array::from_fn(|axis| self.velocity[axis] + turned[axis] - carried[axis]),
            spin: std::array::from_fn(|row| std::array::from_fn(|axis| self.spin[row][axis] + spin[row][axis])),
        }
    }

    /// A rate of turning in the world: `R W R⁻¹`. In the plane that is W.
    fn turned_spin(&self, spin: &[[f64; D]; D]) -> [[f64; D]; D] {
        if D == 2 {
            return *spin;
        }
        let back = std::array::from_fn(|row| column(&self.turn, row));
        times(&times(&self.turn, spin), &back)
    }

    /// Maps a direction of the shape to the world.
    pub(crate) fn normal(&self, normal: [f64; D]) -> [f64; D] {
        self.turned(normal)
    }
}

impl Rigid<3> {
    /// The same motion of the first coordinates alone.
    pub fn within<const D: usize>(&self) -> Rigid<D> {
        let vector = |all: [f64; 3]| std::array::from_fn(|axis| all[axis]);
        let matrix = |all: [[f64; 3]; 3]| std::array::from_fn(|row| vector(all[row]));
        Rigid {
            turn: matrix(self.turn),
            shift: vector(self.shift),
            velocity: vector(self.velocity),
            spin: matrix(self.spin),
        }
    }
}

/// Motion of an obstacle from the start of a step to its end.
///
/// Points at the start of the step are mapped to its end as if attached to the obstacle. The straight segment from there to the end
/// point is the displacement relative to the obstacle, so that nothing tunnels at any speed of either.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SweptMotion<const D: usize = 2> {
    start: Rigid<D>,
    end: Rigid<D>,
    is_still: bool,
}

impl<const D: usize> SweptMotion<D> {
    /// An obstacle at rest.
    pub const STILL: Self = Self { start: Rigid::STILL, end: Rigid::STILL, is_still: true };

    /// Motion between two placements.
    pub const fn new(start: Rigid<D>, end: Rigid<D>) -> Self {
        Self { start, end, is_still: false }
    }

    /// Maps a point at the start of the step to the end, attached to the obstacle.
    pub fn place(&self, point: [f64; D]) -> [f64; D] {
        if self.is_still { point } else { self.end.point(self.start.back(point)) }
    }

    /// Maps a point at the end of the step, attached to the obstacle, to the start.
    pub fn back(&self, point: [f64; D]) -> [f64; D] {
        if self.is_still { point } else { self.start.point(self.end.back(point)) }
    }

    /// Maps a point of the world at the end of the step to the shape.
    pub fn to_shape(&self, point: [f64; D]) -> [f64; D] {
        if self.is_still { point } else { self.end.back(point) }
    }

    /// Maps a direction of the shape to the world at the end of the step.
    pub fn direction(&self, vector: [f64; D]) -> [f64; D] {
        if self.is_still { vector } else { self.end.normal(vector) }
    }

    /// Velocity of the obstacle at a point at the end of the step [m/s].
    pub fn velocity_at(&self, point: [f64; D]) -> [f64; D] {
        if self.is_still { [0.0; D] } else { self.end.velocity_at(point) }
    }

    /// Placement at the end of the step; `None` for an obstacle at rest.
    pub fn end(&self) -> Option<Rigid<D>> {
        (!self.is_still).then_some(self.end)
    }
}
