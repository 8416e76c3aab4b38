//! Effect: air drag.

use super::{Effect, EffectParameters, Motion, ZERO};
use crate::{
    elements::{Elements, UniformForce},
    quantity::{DragCoefficient, Quantity},
    solvers::{SparseMatrix, Weights},
};
use serde::{Deserialize, Serialize};

/// Viscous drag: `f = -k v` on every vertex, whatever its mass, as a fluid at rest would slow a small ball.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Drag {
    /// k [N s/m].
    pub coefficient: DragCoefficient,
}

impl Default for Drag {
    fn default() -> Self {
        Self { coefficient: DragCoefficient::literal(0.1) }
    }
}

impl EffectParameters for Drag {
    fn title(&self) -> &'static str {
        "Drag"
    }

    fn about(&self) -> &'static str {
        "f = −k v on every vertex or particle: a heavier one is slowed less."
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.coefficient]
    }

    fn is_damping(&self) -> bool {
        true
    }

    fn build(&self, _: &Elements) -> Result<Box<dyn Effect>, String> {
        Ok(Box::new(Viscous(self.coefficient.get())))
    }
}

/// k [N s/m].
struct Viscous(f64);

impl Effect for Viscous {
    fn name(&self) -> &'static str {
        "Drag"
    }

    fn elements(&self, motion: Motion<'_>) -> usize {
        motion.vertices()
    }

    fn idle(&self, motion: Motion<'_>) -> Option<&'static str> {
        if self.0 == 0.0 { Some(ZERO) } else { motion.stillness() }
    }

    /// The lightest free vertex has the largest damping rate.
    fn damping(&self, motion: Motion<'_>) -> [f64; 2] {
        [self.0 * motion.inverse_mass.iter().copied().fold(0.0, f64::max), 0.0]
    }

    fn uniform_force(&self) -> Option<UniformForce> {
        Some(UniformForce { drag: self.0, ..UniformForce::default() })
    }

    fn force(&self, motion: Motion<'_>, _: &mut [f64], force: &mut [f64]) {
        for (force, v) in force.iter_mut().zip(motion.v) {
            *force -= self.0 * v;
        }
    }

    fn add_stiffness(&self, _: Motion<'_>, weights: Weights, matrix: &mut dyn SparseMatrix) {
        matrix.add_to_diagonal(&|_| weights.velocity * self.0);
    }
}
