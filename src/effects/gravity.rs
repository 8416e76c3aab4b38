//! Effect: gravity.

use super::{Effect, EffectParameters, Motion, ZERO};
use crate::{
    elements::{Elements, UniformForce},
    quantity::{self, Quantity},
};
use serde::{Deserialize, Serialize};

/// Uniform gravity: `f = m g` on every vertex, stored energy `-m g . x`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Gravity {
    /// Acceleration downwards [m/s²].
    pub down: quantity::Gravity,
    /// Acceleration to the right [m/s²].
    #[serde(default = "none", skip_serializing_if = "is_none")]
    pub right: quantity::Gravity,
}

const fn none() -> quantity::Gravity {
    quantity::Gravity::literal(0.0)
}

fn is_none(gravity: &quantity::Gravity) -> bool {
    *gravity == none()
}

impl Default for Gravity {
    fn default() -> Self {
        Self { down: quantity::Gravity::literal(9.8), right: none() }
    }
}

impl EffectParameters for Gravity {
    fn title(&self) -> &'static str {
        "Gravity"
    }

    fn about(&self) -> &'static str {
        "f = m g on every vertex: everything falls equally fast."
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.down]
    }

    fn build(&self, _: &Elements) -> Result<Box<dyn Effect>, String> {
        Ok(Box::new(Field([self.right.get(), -self.down.get()])))
    }
}

/// Acceleration along x and y [m/s²]; none along a third axis.
struct Field([f64; 2]);

impl Effect for Field {
    fn name(&self) -> &'static str {
        "Gravity"
    }

    fn elements(&self, motion: Motion<'_>) -> usize {
        motion.vertices()
    }

    fn idle(&self, _: Motion<'_>) -> Option<&'static str> {
        (self.0 == [0.0; 2]).then_some(ZERO)
    }

    fn energy(&self, motion: Motion<'_>) -> f64 {
        let [gx, gy] = self.0;
        let points = motion.x.chunks_exact(motion.dimension).zip(motion.mass.chunks_exact(motion.dimension));
        points.map(|(x, m)| -m[0] * (gx * x[0] + gy * x[1])).sum()
    }

    fn uniform_force(&self) -> Option<UniformForce> {
        Some(UniformForce { field: self.0, ..UniformForce::default() })
    }

    fn force(&self, motion: Motion<'_>, _: &mut [f64], force: &mut [f64]) {
        for (force, mass) in force.chunks_exact_mut(motion.dimension).zip(motion.mass.chunks_exact(motion.dimension)) {
            force[0] += mass[0] * self.0[0];
            force[1] += mass[1] * self.0[1];
        }
    }
}
