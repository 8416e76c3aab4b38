//! Saved state of a running level.

use super::is_default;
use crate::quantity::{Coordinate, Position, Reach, Time};
use serde::{Deserialize, Serialize};

/// A moment of a running scene: enough to continue bit for bit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SavedState {
    /// Steps taken since the start.
    #[serde(deserialize_with = "step_count")]
    pub steps: u64,
    /// Simulated time \[s\].
    pub time: Time,
    /// Positions of all bodies' vertices and then all nets' particles, one after another \[m\]; of a toy, its state.
    pub positions: Vec<Position>,
    /// Velocities of the same [m/s]; a toy has none.
    pub velocities: Vec<Position>,
    /// What the integrator remembers between steps.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub memory: Vec<Coordinate>,
    /// Contacts: number of the effect, of the obstacle in it, and of the vertex; anchor of friction on the obstacle \[m\]; rest of the initial penetration \[m\].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub anchors: Vec<((u32, u32, u32), Position, Reach)>,
    /// How calm each body, net and membrane, and then each region of bodies, has been; the greatest number if it sleeps.
    #[serde(default, skip_serializing_if = "is_default")]
    pub calm: Vec<u32>,
    /// While regions of bodies sleep, where each vertex was when a region beside it fell asleep \[m\].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub calm_positions: Vec<Position>,
    /// The vertex that a scripted action pulls, by its place in the positions, and the point that it is pulled to \[m\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pulled: Option<(u32, Position)>,
    /// What the guard knew, if the run was guarded.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub guard: Option<SavedGuard>,
    /// Up to two earlier states, the latest first, that a step which the guard refuses is taken again from. They have none themselves.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub checkpoints: Vec<SavedState>,
    /// A mark that earlier versions wrote to checkpoints: read, and of no effect.
    #[serde(default, skip_serializing)]
    pub batched: serde::de::IgnoredAny,
}

impl SavedState {
    /// Positions and velocities at a time, without anything that a run remembers of earlier steps.
    pub const fn new((steps, time): (u64, Time), positions: Vec<Position>, velocities: Vec<Position>) -> Self {
        Self {
            steps,
            time,
            positions,
            velocities,
            memory: Vec::new(),
            anchors: Vec::new(),
            calm: Vec::new(),
            calm_positions: Vec::new(),
            pulled: None,
            guard: None,
            checkpoints: Vec::new(),
            batched: serde::de::IgnoredAny,
        }
    }
}

/// What the guard against unstable steps knew when a level was saved.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SavedGuard {
    /// Hash of the positions and velocities that this belongs to. If they were edited it is dropped, and the account begins anew.
    pub state: u64,
    /// Energy supplied so far \[J\].
    #[serde(deserialize_with = "finite")]
    pub supplied: f64,
    /// Least energy at a check, with what was supplied since \[J\].
    #[serde(default, skip_serializing_if = "Option::is_none", deserialize_with = "optional_finite")]
    pub least: Option<f64>,
    /// Energy at the start, with what changes from outside have added \[J\].
    #[serde(default, deserialize_with = "finite")]
    pub start: f64,
    /// Greatest energy that could be mechanical since the last change from outside \[J\], also in attempts at steps.
    #[serde(default, deserialize_with = "finite")]
    pub reference: f64,
    /// Greatest energy that could be mechanical or in contact since then \[J\].
    #[serde(default, skip_serializing_if = "Option::is_none", deserialize_with = "optional_finite")]
    pub available: Option<f64>,
    /// Kinetic energy up to which the other energies are not computed \[J\].
    #[serde(deserialize_with = "finite")]
    pub threshold: f64,
    /// Mechanical and total energy after the last step \[J\], where every step is looked at.
    #[serde(default, skip_serializing_if = "Option::is_none", deserialize_with = "both_finite")]
    pub last: Option<(f64, f64)>,
    /// Every step is taken in 2^level shorter ones.
    #[serde(deserialize_with = "level")]
    pub level: u32,
    /// Steps without trouble since the level was last raised.
    pub quiet: u32,
    /// After how many of them longer steps are tried again.
    pub retry: u32,
    /// Steps in a row whose equations were left unsolved while triangles were inverted.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub unsolved: u32,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes references")]
const fn is_zero(count: &u32) -> bool {
    *count == 0
}

fn finite<'de, D: serde::Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    let number = f64::deserialize(from)?;
    if number.is_finite() { Ok(number) } else { Err(serde::de::Error::custom("an energy must be finite")) }
}

fn optional_finite<'de, D: serde::Deserializer<'de>>(from: D) -> Result<Option<f64>, D::Error> {
    finite(from).map(Some)
}

fn both_finite<'de, D: serde::Deserializer<'de>>(from: D) -> Result<Option<(f64, f64)>, D::Error> {
    let both = Option::<(f64, f64)>::deserialize(from)?;
    if both.is_none_or(|(one, other)| one.is_finite() && other.is_finite()) {
        Ok(both)
    } else {
        Err(serde::de::Error::custom("energies must be finite"))
    }
}

/// How finely the guard may divide a step.
fn level<'de, D: serde::Deserializer<'de>>(from: D) -> Result<u32, D::Error> {
    let level = u32::deserialize(from)?;
    if level <= SavedGuard::MOST_LEVEL {
        Ok(level)
    } else {
        Err(serde::de::Error::custom(format!("level must be at most {}, got {level}", SavedGuard::MOST_LEVEL)))
    }
}

impl SavedGuard {
    /// A step is taken in up to 2^6 = 64 shorter ones.
    pub const MOST_LEVEL: u32 = 6;
}

/// A number of steps that a double still counts exactly.
pub(super) fn step_count<'de, D: serde::Deserializer<'de>>(from: D) -> Result<u64, D::Error> {
    const MOST: u64 = 1 << 53;
    let count = u64::deserialize(from)?;
    if count <= MOST {
        Ok(count)
    } else {
        Err(serde::de::Error::custom(format!("steps must be at least 0 and at most {MOST}, got {count}")))
    }
}
