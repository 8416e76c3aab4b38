use crate::{
    level::Side,
    quantity::{Angle, Point, Time},
};
use serde::{Deserialize, Serialize};

/// Something that is done to a scene while it runs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Act {
    /// When, rounded to frames of 1/60 s [s].
    pub at: Time,
    /// Again and again after this time, to the end [s].
    #[serde(default)]
    pub every: Option<Time>,
    /// What.
    pub act: Deed,
}

/// What can be done.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Deed {
    /// Takes hold of the vertex nearest to a point [m].
    Grab(Point),
    /// Moves the point that the vertex is pulled to, straight and evenly.
    Pull {
        /// Where to [m].
        to: Point,
        /// In which time [s].
        over: Time,
    },
    /// Lets go.
    Release,
    /// Turns gravity around.
    FlipGravity,
    /// Turns the pinned vertices of a side of the first body about their middle, evenly.
    Turn {
        /// Which side, judged on the rest shape.
        side: Side,
        /// By how much [degrees], counter-clockwise.
        by: Angle,
        /// In which time [s].
        over: Time,
    },
    /// Frees all vertices.
    Free,
}

impl Act {
    /// The frames that it is done at, out of so many.
    pub fn frames(&self, count: u64) -> impl Iterator<Item = u64> {
        let first = frame(self.at);
        let step = self.every.map_or(usize::MAX, |every| frame(every).max(1) as usize);
        (first..count).step_by(step)
    }
}

/// A time in frames of 1/60 s.
pub fn frame(time: Time) -> u64 {
    (time.get() * 60.0).round() as u64
}
