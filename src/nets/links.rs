//! Net given by particles and springs in the level.

use super::{Link, Net, NetError, NetSource, Role};
use crate::quantity::{Coordinate, Point, RestLength, Spring};

/// A net written out in the level itself: points `(x, y)` \[m\], and springs `(i, j, k, rest)` between particles `i` and
/// `j`, counted from 0, of stiffness `k` [N/m] and length `rest` \[m\] without a force.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Links {
    /// Where the particles start \[m\].
    pub points: Vec<Point>,
    /// Two particles, stiffness and rest length each.
    pub springs: Vec<(u32, u32, Spring, RestLength)>,
}

impl Default for Links {
    /// A triangle of three springs.
    fn default() -> Self {
        let at = |x, y| Point(Coordinate::literal(x), Coordinate::literal(y));
        let spring = |i, j, rest| (i, j, Spring::literal(100.0), RestLength::literal(rest));
        Self {
            points: vec![at(0.4, 0.4), at(0.6, 0.4), at(0.5, 0.6)],
            springs: vec![spring(0, 1, 0.2), spring(1, 2, 0.22), spring(2, 0, 0.22)],
        }
    }
}

impl NetSource for Links {
    fn build(&self) -> Result<Net, NetError> {
        let link = |&(i, j, stiffness, rest): &(u32, u32, Spring, RestLength)| Link {
            ends: [i, j],
            stiffness: stiffness.get(),
            rest: rest.get(),
            role: Role::Structural,
        };
        Net::new(self.points.iter().map(|point| point.get()).collect(), self.springs.iter().map(link).collect())
    }
}
