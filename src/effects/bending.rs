//! Effect: resistance of membranes to bending.

use super::{DuplicatePolicy, Effect, EffectParameters, Motion, ZERO};
use crate::{
    elements::{Elements, Hinges},
    quantity::{BendingFactor, Quantity},
    solvers::{Block, SparseMatrix, Weights},
};
use serde::{Deserialize, Serialize};

/// Bending of membranes about the edges of their triangles, as a plate of their material and thickness bends: see [`Hinges`]. The rigidity
/// is `D = s E h³/(12 (1 - nu²))`. Cloth of fibres that slide bends more easily than a solid plate: its factor s is below 1.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bending {
    /// s.
    #[serde(default = "whole")]
    pub factor: BendingFactor,
}

const fn whole() -> BendingFactor {
    BendingFactor::literal(1.0)
}

impl Default for Bending {
    fn default() -> Self {
        Self { factor: whole() }
    }
}

impl EffectParameters for Bending {
    fn title(&self) -> &'static str {
        "Bending"
    }

    fn about(&self) -> &'static str {
        "W = D/2 A ((1 − ν) K:K + ν (tr K)²) with D = s E h³/(12 (1 − ν²)): membranes bend like thin plates."
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.factor]
    }

    fn duplicate_policy(&self) -> DuplicatePolicy {
        DuplicatePolicy::Odd("their stiffness adds up")
    }

    fn build(&self, elements: &Elements) -> Result<Box<dyn Effect>, String> {
        if elements.membranes.is_empty() {
            return Err("it acts on membranes, and the level has none".to_owned());
        }
        let factor = self.factor.get();
        let membranes =
            elements.membranes.iter().map(|membrane| Hinges::new(membrane, &elements.rest, factor)).collect();
        Ok(Box::new(Plates { membranes, factor }))
    }
}

struct Plates {
    membranes: Vec<Hinges>,
    factor: f64,
}

impl Effect for Plates {
    fn name(&self) -> &'static str {
        "Bending"
    }

    fn dimension(&self) -> Option<usize> {
        Some(3)
    }

    fn elements(&self, _: Motion<'_>) -> usize {
        self.membranes.iter().map(Hinges::count).sum()
    }

    fn scratch(&self) -> usize {
        self.membranes.iter().map(|membrane| 2 * membrane.count()).max().unwrap_or(0)
    }

    fn idle(&self, _: Motion<'_>) -> Option<&'static str> {
        (self.factor == 0.0).then_some(ZERO)
    }

    fn energy(&self, motion: Motion<'_>) -> f64 {
        self.membranes.iter().map(|membrane| membrane.energy(motion.x)).sum()
    }

    fn force(&self, motion: Motion<'_>, scratch: &mut [f64], force: &mut [f64]) {
        for membrane in &self.membranes {
            membrane.add_force(motion.x, &mut scratch[..2 * membrane.count()], force);
        }
    }

    fn stiffness_times(&self, motion: Motion<'_>, d: &[f64], scratch: &mut [f64], product: &mut [f64]) {
        for membrane in &self.membranes {
            membrane.add_stiffness_times(motion.x, d, &mut scratch[..2 * membrane.count()], product);
        }
    }

    fn sparsity_pattern(&self, add: &mut dyn FnMut(u32, u32)) {
        self.membranes.iter().for_each(|membrane| membrane.each_pair(add));
    }

    fn add_stiffness(&self, motion: Motion<'_>, weights: Weights, matrix: &mut dyn SparseMatrix) {
        let Some(matrix) = matrix.blocks::<3>() else { return };
        for membrane in &self.membranes {
            membrane.each_block(motion.x, |[a, b], entries| {
                let block = Block::<3>::from_fn(|row, column| weights.position * entries[row][column]);
                if a == b { matrix.diagonal(a as usize, &block) } else { matrix.off_diagonal(&block) }
            });
        }
    }
}
