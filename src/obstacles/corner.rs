//! Convex corners of obstacles.

use super::Rigid;

/// A convex corner of an obstacle, round or sharp: it can touch an edge of a body between two vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner<const D: usize = 2> {
    /// Centre of its rounding \[m\].
    pub middle: [f64; D],
    /// Radius of its rounding \[m\].
    pub radius: f64,
    /// Contact margin \[m\].
    pub margin: f64,
}

impl<const D: usize> Corner<D> {
    /// The corner of an obstacle that is placed like this; `None` for one at rest.
    #[must_use]
    pub fn placed(self, at: Option<Rigid<D>>) -> Self {
        Self { middle: at.map_or(self.middle, |at| at.point(self.middle)), ..self }
    }
}
