//! Scripted actions of a level.

use super::{Side, is_default, saved::step_count};
use crate::{
    quantity::{Angle, Position, Radius, Time, Velocity},
    state::State,
};
use serde::{Deserialize, Serialize};

/// A scripted action: something that is done to a scene while it runs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScriptedAction {
    /// Time of its beginning, rounded to frames of 1/60 s \[s\].
    pub at: Time,
    /// Period of repetition, to the end of the run \[s\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub every: Option<Time>,
    /// The action; also read under the earlier key `act`.
    #[serde(alias = "act")]
    pub action: Action,
}

/// End of a recorded run, with which a replay of its scripted actions is compared.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordedEnd {
    /// Steps from the start to the end.
    #[serde(deserialize_with = "step_count")]
    pub steps: u64,
    /// Hash of the positions and velocities at the end: 16 hexadecimal digits.
    #[serde(deserialize_with = "hash")]
    pub hash: String,
    /// Number of actions that were recorded, the last ones of the list.
    #[serde(default, skip_serializing_if = "is_default")]
    pub actions: usize,
}

impl RecordedEnd {
    /// A state as the end of a run without recorded actions that led to it.
    pub fn new(state: &State) -> Self {
        Self { steps: state.steps, hash: format!("{:016x}", state.hash()), actions: 0 }
    }

    /// Whether a run has led to the same state.
    pub fn is(&self, state: &State) -> bool {
        Self { actions: self.actions, ..Self::new(state) } == *self
    }
}

fn hash<'de, D: serde::Deserializer<'de>>(from: D) -> Result<String, D::Error> {
    let text = String::deserialize(from)?;
    let is_digit = |letter: u8| matches!(letter, b'0'..=b'9' | b'a'..=b'f');
    if text.len() == 16 && text.bytes().all(is_digit) {
        Ok(text)
    } else {
        Err(serde::de::Error::custom("a hash has 16 digits of 0 to 9 and a to f"))
    }
}

/// Kinds of actions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Action {
    /// Takes hold of the vertex nearest to a point \[m\].
    Grab(Position),
    /// Moves the point that the vertex is pulled to, straight and evenly.
    Pull {
        /// Where to \[m\].
        to: Position,
        /// In which time \[s\].
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
        /// By how much \[degrees\], counter-clockwise.
        by: Angle,
        /// In which time \[s\].
        over: Time,
    },
    /// Frees all vertices.
    Free,
    /// Changes the velocities of all vertices within a radius R of a point at once, by `(1 - r²/R²)² (push + burst d/R)` at a distance
    /// r and with the vector d from the point.
    Impulse {
        /// The point \[m\].
        centre: Position,
        /// The radius \[m\].
        radius: Radius,
        /// Velocity of the push along x, y and z [m/s]; in the plane the last one is not used.
        #[serde(default = "no_push")]
        push: (Velocity, Velocity, Velocity),
        /// Velocity away from the point [m/s].
        #[serde(default = "no_burst")]
        burst: Velocity,
    },
}

const fn no_burst() -> Velocity {
    Velocity::literal(0.0)
}

const fn no_push() -> (Velocity, Velocity, Velocity) {
    (no_burst(), no_burst(), no_burst())
}

impl ScriptedAction {
    /// Number of frames that it takes, from the one that it begins at.
    pub fn length(&self) -> u64 {
        match self.action {
            Action::Pull { over, .. } | Action::Turn { over, .. } => frame(over).max(1),
            _ => 1,
        }
    }

    /// The frames at which it begins and that are among these.
    pub fn begins(&self, frames: std::ops::RangeInclusive<u64>) -> impl Iterator<Item = u64> {
        let (first, last) = (frame(self.at), *frames.end());
        let step = self.every.map_or(u64::MAX, |every| frame(every).max(1));
        let from = if *frames.start() <= first {
            Some(first)
        } else {
            (*frames.start() - first).div_ceil(step).checked_mul(step).and_then(|after| after.checked_add(first))
        };
        std::iter::successors(from, move |begin| begin.checked_add(step)).take_while(move |begin| *begin <= last)
    }

    /// The frame at which it begins for the first time, or so many times later.
    pub fn begin(&self, times: u64) -> u64 {
        let step = self.every.map_or(0, |every| frame(every).max(1));
        frame(self.at).saturating_add(times.saturating_mul(step))
    }

    /// How often it has begun by a frame, this one included.
    pub fn count(&self, last: u64) -> u64 {
        let step = self.every.map_or(u64::MAX, |every| frame(every).max(1));
        last.checked_sub(frame(self.at)).map_or(0, |since| since / step + 1)
    }

    /// The first frame from this one on in which it has something to do.
    pub fn next(&self, from: u64) -> Option<u64> {
        let running = self.begins(from.saturating_sub(self.length() - 1)..=from).next();
        if running.is_some() { Some(from) } else { self.begins(from..=u64::MAX).next() }
    }
}

/// A time in frames of 1/60 s.
pub fn frame(time: Time) -> u64 {
    (time.get() * 60.0).round() as u64
}
