//! Obstacles at other places.

use super::ObstacleKind;
use crate::quantity::{Angle, Point, Position, Quantity, SpacePoint};

/// A similarity transform: one point is moved to another, and around it everything is scaled, and turned about an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Similarity {
    /// The point \[m\].
    pub from: [f64; 3],
    /// Where it is moved to \[m\].
    pub to: [f64; 3],
    /// Factor of lengths.
    pub scale: f64,
    /// Angle, counter-clockwise \[degrees\].
    pub turn: f64,
    /// Axis of the turn: 0 for x, 1 for y and 2 for z, which is that of the plane.
    pub axis: usize,
}

impl Similarity {
    /// No change.
    pub const NONE: Self = Self { from: [0.0; 3], to: [0.0; 3], scale: 1.0, turn: 0.0, axis: 2 };

    /// Whether it changes nothing.
    pub fn is_none(&self) -> bool {
        self.from == self.to && self.scale == 1.0 && self.turn == 0.0
    }

    /// Maps a displacement \[m\], or a velocity.
    pub fn displacement(&self, displacement: [f64; 3]) -> [f64; 3] {
        self.direction(displacement).map(|along| self.scale * along)
    }

    /// Turns a direction.
    pub fn direction(&self, direction: [f64; 3]) -> [f64; 3] {
        let (cos, sin) = (libm::cos(self.turn.to_radians()), libm::sin(self.turn.to_radians()));
        let [one, other] = [1, 2].map(|after| (self.axis + after) % 3);
        let (a, b) = (direction[one], direction[other]);
        let mut turned = direction;
        (turned[one], turned[other]) = (cos * a - sin * b, sin * a + cos * b);
        turned
    }

    /// Maps a point \[m\].
    pub fn point(&self, point: [f64; 3]) -> [f64; 3] {
        let Self { from, to, scale, .. } = self;
        let turned = self.direction([0, 1, 2].map(|axis| point[axis] - from[axis]));
        [0, 1, 2].map(|axis| to[axis] + scale * turned[axis])
    }

    /// Maps a point of the plane; `None` if the result is out of range.
    pub fn of_point(&self, point: Point) -> Option<Point> {
        let [x, y] = point.get();
        let [x, y, _] = self.point([x, y, 0.0]);
        Point::new([x, y]).ok()
    }

    /// Turns a direction of the plane; `None` if the result is out of range.
    pub fn of_direction(&self, direction: Point) -> Option<Point> {
        let [x, y] = direction.get();
        let [x, y, _] = self.direction([x, y, 0.0]);
        Point::new([x, y]).ok()
    }

    /// Maps a point in space; `None` if the result is out of range.
    pub fn of_space_point(&self, point: SpacePoint) -> Option<SpacePoint> {
        SpacePoint::new(self.point(point.get())).ok()
    }

    /// Maps a point; `None` if the result is out of range.
    pub fn of_position(&self, position: Position) -> Option<Position> {
        match position {
            Position::Plane(point) => self.of_point(point).map(Position::Plane),
            Position::Space(point) => self.of_space_point(point).map(Position::Space),
        }
    }

    /// Maps a displacement; `None` if the result is out of range.
    pub fn of_displacement(&self, displacement: Position) -> Option<Position> {
        match displacement {
            Position::Plane(along) => {
                let [x, y] = along.get();
                let [x, y, _] = self.displacement([x, y, 0.0]);
                Point::new([x, y]).ok().map(Position::Plane)
            }
            Position::Space(along) => SpacePoint::new(self.displacement(along.get())).ok().map(Position::Space),
        }
    }

    /// Adds the turn to an angle, within half a turn as sliders show it; `None` if the result is out of range.
    pub fn of_angle(&self, angle: Angle) -> Option<Angle> {
        let whole = angle.get() + self.turn;
        Angle::new(if self.turn == 0.0 { whole } else { whole - 360.0 * libm::round(whole / 360.0) }).ok()
    }

    /// Scales lengths; `None` if one leaves its range.
    pub fn scale<const N: usize>(&self, lengths: [&mut dyn Quantity; N]) -> Option<()> {
        lengths.into_iter().try_for_each(|length| length.set(self.scale * length.get())).ok()
    }
}

impl ObstacleKind {
    /// The obstacle after a similarity transform; `None` if a number would leave its range.
    pub fn arranged(&self, by: &Similarity) -> Option<Self> {
        let mut arranged = self.clone();
        arranged.kind_mut().arrange(by)?;
        Some(arranged)
    }
}
