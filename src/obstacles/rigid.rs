//! Rigid motion of an obstacle, and a step in its frame of reference.

/// A rigid placement and its velocity: a point `p` of the shape is at `R p + t`, and a material point at x has the
/// velocity `u + w x x`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rigid {
    /// Cosine and sine of R.
    pub turn: [f64; 2],
    /// t \[m\].
    pub shift: [f64; 2],
    /// u: the velocity of the material point at the origin of the world [m/s].
    pub velocity: [f64; 2],
    /// w [rad/s].
    pub spin: f64,
}

impl Rigid {
    /// The identity, at rest.
    pub const STILL: Self = Self { turn: [1.0, 0.0], shift: [0.0; 2], velocity: [0.0; 2], spin: 0.0 };

    /// Applies R to a direction.
    fn turned(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [c, s] = self.turn;
        [c * x - s * y, s * x + c * y]
    }

    /// Applies R⁻¹ to a direction.
    fn turned_back(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [c, s] = self.turn;
        [c * x + s * y, c * y - s * x]
    }

    /// Maps a point of the shape to the world.
    pub fn point(&self, point: [f64; 2]) -> [f64; 2] {
        let [x, y] = self.turned(point);
        [x + self.shift[0], y + self.shift[1]]
    }

    /// Maps a point of the world to the shape.
    pub fn back(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        self.turned_back([x - self.shift[0], y - self.shift[1]])
    }

    /// Velocity of the material point at a point of the world [m/s].
    pub fn velocity_at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.velocity[0] - self.spin * y, self.velocity[1] + self.spin * x]
    }

    /// Composes this motion with an earlier one.
    #[must_use]
    pub fn of(&self, moved: &Self) -> Self {
        let ([c, s], [tx, ty]) = (self.turn, self.shift);
        let [a, b] = moved.turn;
        let [ux, uy] = self.turned(moved.velocity);
        Self {
            turn: [c * a - s * b, s * a + c * b],
            shift: self.point(moved.shift),
            velocity: [self.velocity[0] + ux + moved.spin * ty, self.velocity[1] + uy - moved.spin * tx],
            spin: self.spin + moved.spin,
        }
    }

    /// Maps a direction of the shape to the world.
    pub(crate) fn normal(&self, normal: [f64; 2]) -> [f64; 2] {
        self.turned(normal)
    }
}

/// Motion of an obstacle from the start of a step to its end.
///
/// Points at the start of the step are mapped to its end as if attached to the obstacle. The straight segment from there to the end
/// point is the displacement relative to the obstacle, so that nothing tunnels at any speed of either.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SweptMotion {
    start: Rigid,
    end: Rigid,
    is_still: bool,
}

impl SweptMotion {
    /// An obstacle at rest.
    pub const STILL: Self = Self { start: Rigid::STILL, end: Rigid::STILL, is_still: true };

    /// Motion between two placements.
    pub const fn new(start: Rigid, end: Rigid) -> Self {
        Self { start, end, is_still: false }
    }

    /// Maps a point at the start of the step to the end, attached to the obstacle.
    pub fn place(&self, point: [f64; 2]) -> [f64; 2] {
        if self.is_still { point } else { self.end.point(self.start.back(point)) }
    }

    /// Maps a point of the world at the end of the step to the shape.
    pub fn to_shape(&self, point: [f64; 2]) -> [f64; 2] {
        if self.is_still { point } else { self.end.back(point) }
    }

    /// Maps a direction of the shape to the world at the end of the step.
    pub fn direction(&self, vector: [f64; 2]) -> [f64; 2] {
        if self.is_still { vector } else { self.end.normal(vector) }
    }

    /// Velocity of the obstacle at a point at the end of the step [m/s].
    pub fn velocity_at(&self, point: [f64; 2]) -> [f64; 2] {
        if self.is_still { [0.0; 2] } else { self.end.velocity_at(point) }
    }

    /// Placement at the end of the step; `None` for an obstacle at rest.
    pub fn end(&self) -> Option<Rigid> {
        (!self.is_still).then_some(self.end)
    }
}
