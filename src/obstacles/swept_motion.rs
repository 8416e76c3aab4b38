//! Where a moving obstacle is, how fast, and what a step looks like to who moves along with it.

use super::Corner;
use parry2d::math::Vector;

/// Where something rigid is that was built elsewhere, and how it moves: `p` is now at `R p + t`, and whatever of it is at a
/// point x of the world has the velocity `u + w x x`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rigid {
    /// Cosine and sine of R.
    pub turn: [f64; 2],
    /// t [m].
    pub shift: [f64; 2],
    /// u: the velocity that it has, or would have, at the origin of the world [m/s].
    pub velocity: [f64; 2],
    /// w [rad/s].
    pub spin: f64,
}

impl Rigid {
    /// Where it was built, at rest.
    pub const STILL: Self = Self { turn: [1.0, 0.0], shift: [0.0; 2], velocity: [0.0; 2], spin: 0.0 };

    /// A direction after the turn.
    fn turned(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [c, s] = self.turn;
        [c * x - s * y, s * x + c * y]
    }

    /// A direction before the turn.
    fn turned_back(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [c, s] = self.turn;
        [c * x + s * y, c * y - s * x]
    }

    /// Where a point got.
    pub fn point(&self, point: [f64; 2]) -> [f64; 2] {
        let [x, y] = self.turned(point);
        [x + self.shift[0], y + self.shift[1]]
    }

    /// Where a point came from.
    pub fn back(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        self.turned_back([x - self.shift[0], y - self.shift[1]])
    }

    /// The velocity at a point of the world [m/s].
    pub fn velocity_at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.velocity[0] - self.spin * y, self.velocity[1] + self.spin * x]
    }

    /// This motion of something that already moves.
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

    /// The same direction seen from where it was built, turned out into the world.
    pub(super) fn normal(&self, normal: [f64; 2]) -> [f64; 2] {
        self.turned(normal)
    }

    pub(super) fn direction_back(&self, vector: [f64; 2]) -> [f64; 2] {
        self.turned_back(vector)
    }
}

/// An obstacle's motion from the start of a step to its end.
///
/// Contact is looked at as if the obstacle had been at its place of the end all the time: what was somewhere at the start
/// is put where it would be had it been carried along. What then is straight between start and end stands for the way
/// relative to the obstacle, so that nothing is passed through however fast either moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SweptMotion {
    pub(super) start: Rigid,
    pub(super) end: Rigid,
    still: bool,
}

impl SweptMotion {
    /// What never moves.
    pub const STILL: Self = Self { start: Rigid::STILL, end: Rigid::STILL, still: true };

    /// From one place to another.
    pub const fn new(start: Rigid, end: Rigid) -> Self {
        Self { start, end, still: false }
    }

    /// Whether it never moves.
    pub const fn is_still(&self) -> bool {
        self.still
    }

    /// Where a point of the start would be at the end, carried along.
    pub fn place(&self, point: [f64; 2]) -> [f64; 2] {
        if self.still { point } else { self.end.point(self.start.back(point)) }
    }

    /// Where a point that was carried along was at the start.
    pub fn place_back(&self, point: [f64; 2]) -> [f64; 2] {
        if self.still { point } else { self.start.point(self.end.back(point)) }
    }

    /// Where a point of the world at the end is on what was built.
    pub fn place_built(&self, point: [f64; 2]) -> [f64; 2] {
        if self.still { point } else { self.end.back(point) }
    }

    /// A direction of the start, carried along.
    pub fn direction(&self, vector: [f64; 2]) -> [f64; 2] {
        if self.still { vector } else { self.end.turned(self.start.turned_back(vector)) }
    }

    /// The velocity at the start of what was at a point, relative to the obstacle, carried along [m/s].
    pub fn relative(&self, velocity: [f64; 2], point: [f64; 2]) -> [f64; 2] {
        if self.still {
            return velocity;
        }
        let wall = self.start.velocity_at(point);
        self.direction([velocity[0] - wall[0], velocity[1] - wall[1]])
    }

    /// The obstacle's velocity at the end, at a point [m/s].
    pub fn velocity_at(&self, point: [f64; 2]) -> [f64; 2] {
        if self.still { [0.0; 2] } else { self.end.velocity_at(point) }
    }

    /// One of its corners at the end.
    pub fn corner(&self, corner: &Corner) -> Corner {
        if self.still { *corner } else { Corner { middle: self.end.point(corner.middle), ..*corner } }
    }

    /// A box that holds everything of a box, carried along or not.
    pub fn bounds(&self, bounds: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
        if self.still {
            return bounds;
        }
        let [a, b] = bounded(bounds, |corner| self.place(corner));
        let ([least, greatest], [a, b]) = (bounds.map(Vector::from), [a, b].map(Vector::from));
        [least.min(a).into(), greatest.max(b).into()]
    }

    /// A box around a box, where the obstacle was built.
    pub(super) fn built(&self, bounds: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
        if self.still { bounds } else { bounded(bounds, |corner| self.end.back(corner)) }
    }
}

/// The box around a box that was moved.
fn bounded([[left, bottom], [right, top]]: [[f64; 2]; 2], place: impl Fn([f64; 2]) -> [f64; 2]) -> [[f64; 2]; 2] {
    let corners =
        [[left, bottom], [right, bottom], [right, top], [left, top]].map(|corner| Vector::from(place(corner)));
    let least = corners.into_iter().reduce(Vector::min).unwrap_or_default();
    let greatest = corners.into_iter().reduce(Vector::max).unwrap_or_default();
    [least.into(), greatest.into()]
}
