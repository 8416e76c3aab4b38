//! Effect: mouse spring.

use super::{DuplicatePolicy, Effect, EffectParameters, Grab, Motion};
use crate::{
    elements::Elements,
    quantity::{Quantity, Spring},
    solvers::{SparseMatrix, Weights},
};
use serde::{Deserialize, Serialize};

/// The spring between the cursor and the vertex it took hold of: `f = k (cursor - vertex)`, energy `k/2 |cursor - vertex|²`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MouseSpring {
    /// k [N/m].
    pub stiffness: Spring,
}

impl Default for MouseSpring {
    fn default() -> Self {
        Self { stiffness: Spring::literal(100.0) }
    }
}

impl EffectParameters for MouseSpring {
    fn title(&self) -> &'static str {
        "Mouse spring"
    }

    fn about(&self) -> &'static str {
        "f = k (cursor − vertex) on the vertex nearest to where the drag began, while the button is down."
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.stiffness]
    }

    fn duplicate_policy(&self) -> DuplicatePolicy {
        DuplicatePolicy::Odd("they pull together, with the sum of both")
    }

    fn build(&self, _: &Elements) -> Result<Box<dyn Effect>, String> {
        Ok(Box::new(PullingSpring(self.stiffness.get())))
    }
}

/// Stiffness k [N/m].
struct PullingSpring(f64);

/// Each number of the vertex, and how far the cursor is from there \[m\].
fn spring_vector(motion: Motion<'_>, grab: Grab) -> impl Iterator<Item = (usize, f64)> {
    let numbers = motion.dimension * grab.vertex..motion.dimension * (grab.vertex + 1);
    numbers.zip(grab.target).map(move |(number, target)| (number, target - motion.x[number]))
}

impl Effect for PullingSpring {
    fn name(&self) -> &'static str {
        "Mouse spring"
    }

    fn elements(&self, motion: Motion<'_>) -> usize {
        usize::from(motion.grab.is_some())
    }

    fn idle(&self, motion: Motion<'_>) -> Option<&'static str> {
        motion.grab.is_none().then_some("nothing is dragged")
    }

    fn energy(&self, motion: Motion<'_>) -> f64 {
        motion.grab.map_or(0.0, |grab| {
            let square: f64 = spring_vector(motion, grab).map(|(_, d)| d * d).sum();
            0.5 * self.0 * square
        })
    }

    fn force(&self, motion: Motion<'_>, _: &mut [f64], force: &mut [f64]) {
        if let Some(grab) = motion.grab {
            spring_vector(motion, grab).for_each(|(number, d)| force[number] += self.0 * d);
        }
    }

    fn stiffness_times(&self, motion: Motion<'_>, d: &[f64], _: &mut [f64], product: &mut [f64]) {
        if let Some(grab) = motion.grab {
            spring_vector(motion, grab).for_each(|(number, _)| product[number] += self.0 * d[number]);
        }
    }

    fn add_stiffness(&self, motion: Motion<'_>, weights: Weights, matrix: &mut dyn SparseMatrix) {
        if let Some(grab) = motion.grab {
            let own = motion.dimension * grab.vertex..motion.dimension * (grab.vertex + 1);
            matrix.add_to_diagonal(&|number| if own.contains(&number) { weights.position * self.0 } else { 0.0 });
        }
    }
}
