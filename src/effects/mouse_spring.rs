//! Effect: mouse spring.

use super::{DuplicatePolicy, Effect, EffectParameters, Grab, Motion};
use crate::{
    elements::Elements,
    quantity::{Quantity, Spring},
    solvers::{SparseMatrix, Weights},
};
use nalgebra::Matrix2;
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

/// Vector from the vertex to the cursor \[m\].
fn spring_vector(x: &[f64], grab: Grab) -> [f64; 2] {
    let at = 2 * grab.vertex;
    [grab.target[0] - x[at], grab.target[1] - x[at + 1]]
}

impl Effect for PullingSpring {
    fn name(&self) -> &'static str {
        "Mouse spring"
    }

    fn dimension(&self) -> Option<usize> {
        Some(2)
    }

    fn elements(&self, motion: Motion<'_>) -> usize {
        usize::from(motion.grab.is_some())
    }

    fn idle(&self, motion: Motion<'_>) -> Option<&'static str> {
        motion.grab.is_none().then_some("nothing is dragged")
    }

    fn energy(&self, motion: Motion<'_>) -> f64 {
        motion.grab.map_or(0.0, |grab| {
            let [dx, dy] = spring_vector(motion.x, grab);
            0.5 * self.0 * (dx * dx + dy * dy)
        })
    }

    fn force(&self, motion: Motion<'_>, _: &mut [f64], force: &mut [f64]) {
        if let Some(grab) = motion.grab {
            let [dx, dy] = spring_vector(motion.x, grab);
            force[2 * grab.vertex] += self.0 * dx;
            force[2 * grab.vertex + 1] += self.0 * dy;
        }
    }

    fn stiffness_times(&self, motion: Motion<'_>, d: &[f64], _: &mut [f64], product: &mut [f64]) {
        if let Some(grab) = motion.grab {
            let at = 2 * grab.vertex;
            product[at] += self.0 * d[at];
            product[at + 1] += self.0 * d[at + 1];
        }
    }

    fn add_stiffness(&self, motion: Motion<'_>, weights: Weights, matrix: &mut dyn SparseMatrix) {
        if let (Some(grab), Some(matrix)) = (motion.grab, matrix.blocks::<2>()) {
            matrix.diagonal(grab.vertex, &Matrix2::from_diagonal_element(weights.position * self.0));
        }
    }
}
