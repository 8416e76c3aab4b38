use super::is_default;
use crate::quantity::{Coordinate, Point, Time};
use serde::{Deserialize, Serialize};

/// A moment of a running scene: enough to continue bit for bit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SavedState {
    /// Steps taken since the start.
    #[serde(deserialize_with = "step_count")]
    pub steps: u64,
    /// Simulated time [s].
    pub time: Time,
    /// Positions of all bodies' vertices and then all nets' particles, one after another [m]; of a toy, its state.
    pub positions: Vec<Point>,
    /// Velocities of the same [m/s]; a toy has none.
    pub velocities: Vec<Point>,
    /// What the integrator remembers between steps.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub memory: Vec<Coordinate>,
    /// How calm each body and then each net has been; the greatest number if it sleeps.
    #[serde(default, skip_serializing_if = "is_default")]
    pub calm: Vec<u32>,
}

/// A number of steps that a double still counts exactly.
fn step_count<'de, D: serde::Deserializer<'de>>(from: D) -> Result<u64, D::Error> {
    const MOST: u64 = 1 << 53;
    let count = u64::deserialize(from)?;
    if count <= MOST {
        Ok(count)
    } else {
        Err(serde::de::Error::custom(format!("steps must be at least 0 and at most {MOST}, got {count}")))
    }
}
