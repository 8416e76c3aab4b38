//! Motion: uniform translation.

use super::{Motion, Rigid};
use crate::quantity::{Quantity, Time, VelocityX, VelocityY};
use serde::{Deserialize, Serialize};

/// Straight on at a constant velocity: `d = velocity t`, for a while if it is told.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Slide {
    /// How fast it goes [m/s].
    pub velocity: (VelocityX, VelocityY),
    /// When it starts \[s\].
    #[serde(default = "begin", skip_serializing_if = "is_begin")]
    pub from: Time,
    /// When it stops \[s\]; never, if it is not said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub until: Option<Time>,
}

const fn begin() -> Time {
    Time::literal(0.0)
}

fn is_begin(time: &Time) -> bool {
    *time == begin()
}

impl Default for Slide {
    fn default() -> Self {
        Self { velocity: (VelocityX::literal(0.1), VelocityY::literal(0.0)), from: begin(), until: None }
    }
}

impl Motion for Slide {
    fn at(&self, time: f64) -> Rigid {
        let (vx, vy) = (self.velocity.0.get(), self.velocity.1.get());
        let (from, until) = (self.from.get(), self.until.map_or(f64::INFINITY, Time::get));
        let gone = (time.min(until) - from).max(0.0);
        let moves = time >= from && time < until;
        let velocity = if moves { [vx, vy] } else { [0.0; 2] };
        Rigid { shift: [gone * vx, gone * vy], velocity, ..Rigid::STILL }
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.velocity.0, &mut self.velocity.1]
    }
}
