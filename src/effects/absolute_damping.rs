//! Effect: damping along springs by the velocity of each end alone.

use super::{DuplicatePolicy, Effect, EffectParameters, Motion, ZERO};
use crate::{
    elements::{Elements, NetSprings, direction},
    quantity::{DampingTime, Quantity},
    solvers::{Block, BlockMatrix, SparseMatrix, Weights},
};
use nalgebra::SVector;
use serde::{Deserialize, Serialize};

/// A spring of stiffness k slows each of its ends along its direction u by `f = -beta k (v · u) u`, with the velocity of that end alone. It is the
/// damping of the text of Cornell's mass-spring cloth.
///
/// The damper of [`super::Rayleigh`] takes the relative velocity of both ends instead: it leaves a rigid motion alone, which this damps, and
/// takes twice as much of the fastest vibration.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AbsoluteDamping {
    /// beta \[s\].
    pub stiffness: DampingTime,
}

impl Default for AbsoluteDamping {
    fn default() -> Self {
        Self { stiffness: DampingTime::literal(0.0001) }
    }
}

impl EffectParameters for AbsoluteDamping {
    fn title(&self) -> &'static str {
        "Absolute damping"
    }

    fn about(&self) -> &'static str {
        "f = −β k (v·u) u at each end of a spring, with its own velocity: a rigid motion is damped too."
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.stiffness]
    }

    fn is_damping(&self) -> bool {
        true
    }

    fn duplicate_policy(&self) -> DuplicatePolicy {
        DuplicatePolicy::Odd("they add up")
    }

    fn build(&self, elements: &Elements) -> Result<Box<dyn Effect>, String> {
        if elements.springs.is_empty() {
            return Err("it acts on the springs of nets, and the level has no net".to_owned());
        }
        let nets: Vec<NetSprings> = elements.springs.clone();
        Ok(Box::new(Slowed { nets, beta: self.stiffness.get() }))
    }
}

/// The effect, built.
struct Slowed {
    nets: Vec<NetSprings>,
    beta: f64,
}

impl Slowed {
    /// All springs with a direction: the ends, the unit vector between them, and beta k.
    fn each<'a, const D: usize>(&'a self, x: &'a [f64]) -> impl Iterator<Item = ([u32; 2], SVector<f64, D>, f64)> + 'a {
        let links = self.nets.iter().flat_map(NetSprings::links);
        links.filter_map(|link| Some((link.ends, direction(x, link)?.0, self.beta * link.stiffness)))
    }

    fn add_force<const D: usize>(&self, x: &[f64], v: &[f64], force: &mut [f64]) {
        for (ends, unit, factor) in self.each::<D>(x) {
            for end in ends.map(|end| D * end as usize) {
                let along: f64 = (0..D).map(|axis| v[end + axis] * unit[axis]).sum();
                (0..D).for_each(|axis| force[end + axis] -= factor * along * unit[axis]);
            }
        }
    }

    fn add_blocks<const D: usize>(&self, x: &[f64], weight: f64, matrix: &mut BlockMatrix<D>) {
        for (ends, unit, factor) in self.each::<D>(x) {
            let block: Block<D> = unit * unit.transpose() * (weight * factor);
            for end in ends {
                matrix.diagonal(end as usize, &block);
            }
        }
    }
}

impl Effect for Slowed {
    fn name(&self) -> &'static str {
        "Absolute damping"
    }

    fn elements(&self, _: Motion<'_>) -> usize {
        self.nets.iter().map(|net| net.links().len()).sum()
    }

    fn idle(&self, motion: Motion<'_>) -> Option<&'static str> {
        if self.beta == 0.0 { Some(ZERO) } else { motion.stillness() }
    }

    fn force(&self, motion: Motion<'_>, _: &mut [f64], force: &mut [f64]) {
        match motion.dimension {
            2 => self.add_force::<2>(motion.x, motion.v, force),
            _ => self.add_force::<3>(motion.x, motion.v, force),
        }
    }

    /// The derivative by velocities; that by positions is not symmetric.
    fn add_stiffness(&self, motion: Motion<'_>, weights: Weights, matrix: &mut dyn SparseMatrix) {
        if let Some(matrix) = matrix.blocks::<2>() {
            self.add_blocks(motion.x, weights.velocity, matrix);
        } else if let Some(matrix) = matrix.blocks::<3>() {
            self.add_blocks(motion.x, weights.velocity, matrix);
        }
    }

    fn damps_by_shape(&self) -> bool {
        true
    }

    /// In the fastest vibration neighbours move against each other: half of what a damper between them takes.
    fn damping(&self, _: Motion<'_>) -> [f64; 2] {
        [0.0, 0.5 * self.beta]
    }
}
