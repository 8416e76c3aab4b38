//! Motion: uniform translation.

use super::{Motion, Rigid, Similarity};
use crate::quantity::{Quantity, Time, Velocity, VelocityX, VelocityY};
use serde::{Deserialize, Serialize};

/// Straight on at a constant velocity: `d = velocity t`, for a while if it is told.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Slide {
    /// How fast it goes [m/s].
    pub velocity: (VelocityX, VelocityY),
    /// How fast it goes along z, in space [m/s].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub velocity_z: Option<Velocity>,
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
        let velocity = (VelocityX::literal(0.1), VelocityY::literal(0.0));
        Self { velocity, velocity_z: None, from: begin(), until: None }
    }
}

impl Motion for Slide {
    fn at(&self, time: f64) -> Rigid<3> {
        let along_z = self.velocity_z.map_or(0.0, Velocity::get);
        let velocity = [self.velocity.0.get(), self.velocity.1.get(), along_z];
        let (from, until) = (self.from.get(), self.until.map_or(f64::INFINITY, Time::get));
        let gone = (time.min(until) - from).max(0.0);
        let moves = time >= from && time < until;
        let shift = velocity.map(|along| gone * along);
        Rigid { shift, velocity: if moves { velocity } else { [0.0; 3] }, ..Rigid::STILL }
    }

    fn is_in_space(&self) -> bool {
        self.velocity_z.is_some()
    }

    fn arrange(&mut self, by: &Similarity) -> Option<()> {
        let ((x, y), z) = (self.velocity, self.velocity_z.map_or(0.0, Velocity::get));
        let [x, y, z] = by.displacement([x.get(), y.get(), z]);
        self.velocity = (VelocityX::new(x).ok()?, VelocityY::new(y).ok()?);
        if let Some(velocity) = &mut self.velocity_z {
            *velocity = Velocity::new(z).ok()?;
        }
        Some(())
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        let z = self.velocity_z.as_mut().map(|z| z as &mut dyn Quantity);
        [&mut self.velocity.0 as &mut dyn Quantity, &mut self.velocity.1].into_iter().chain(z).collect()
    }
}
