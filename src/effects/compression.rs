//! Effect: barrier against compression and inversion of triangles.

use super::{DuplicatePolicy, Effect, EffectParameters, Motion, ZERO};
use crate::{
    elements::{Elements, EnergyLaw, Isotropic, StressLaw, Triangles},
    materials::{Moduli, Parts},
    quantity::{CompressionStrength, Quantity},
    simd::{Mat2, Real},
    solvers::{SparseMatrix, Weights},
};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Resistance to compression, beside whatever the material itself does: what St. Venant-Kirchhoff lacks.
///
/// `psi = s (2 mu + lambda)/3 (1 - J)³` where `J = det F < 1`, and nothing elsewhere, so
/// `P = -s (2 mu + lambda) (1 - J)² G` with `G = det(F) F⁻ᵀ`: twice continuously differentiable
/// (Kikuuwe, Tabuchi and Yamamoto, *An edge-based computationally efficient formulation of Saint Venant-Kirchhoff tetrahedral
/// finite elements*, ACM Transactions on Graphics 28, 2009, section 4). St. Venant-Kirchhoff pressed to a share t of its width
/// then resists with `dP11/dt = (2 mu + lambda) ((3 t² - 1)/2 + 2 s (1 - t))`, which is positive for all t from
/// `s = (3 - sqrt(6))/2 = 0.276` on: it never gives way, and what is mirrored is pushed back.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Compression {
    /// s.
    pub strength: CompressionStrength,
}

impl Default for Compression {
    fn default() -> Self {
        Self { strength: CompressionStrength::literal(1.0) }
    }
}

impl EffectParameters for Compression {
    fn title(&self) -> &'static str {
        "Compression guard"
    }

    fn about(&self) -> &'static str {
        "ψ = s (2μ + λ)/3 (1 − J)³ where J < 1: compressed triangles push back, and inverted ones are turned back."
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.strength]
    }

    fn duplicate_policy(&self) -> DuplicatePolicy {
        DuplicatePolicy::Odd("their strengths add up")
    }

    fn build(&self, elements: &Elements) -> Result<Box<dyn Effect>, String> {
        if elements.triangles.is_empty() {
            return Err("it acts on triangles, and the level has no body".to_owned());
        }
        Ok(Box::new(Resistance { strength: self.strength.get(), bodies: elements.triangles.clone() }))
    }
}

/// Barrier density of one body with the factor s (2 mu + lambda) \[Pa\].
#[derive(Clone, Copy)]
struct Squeezed(f64);

impl StressLaw for Squeezed {
    const RATE: bool = false;

    #[inline(always)]
    fn stress<R: Real>(&self, f: Mat2<R>, _: Mat2<R>) -> Mat2<R> {
        let j = f.determinant();
        let missing = j.if_less(j.of(1.0), -j + 1.0, j.of(0.0));
        f.cofactor() * (missing * missing * -self.0)
    }
}

impl EnergyLaw for Squeezed {
    #[inline(always)]
    fn energy<R: Real>(&self, f: Mat2<R>) -> R {
        let j = f.determinant();
        let missing = j.if_less(j.of(1.0), -j + 1.0, j.of(0.0));
        missing * missing * missing * (self.0 / 3.0)
    }
}

impl Isotropic for Squeezed {
    #[inline(always)]
    fn moduli<R: Real>(&self, parts: &Parts<R>) -> Moduli<R> {
        let j = parts.f.determinant();
        let zero = j.of(0.0);
        let missing = j.if_less(j.of(1.0), -j + 1.0, zero);
        parts.moduli([zero, missing * missing * -self.0], [zero, missing * (2.0 * self.0)])
    }
}

struct Resistance {
    strength: f64,
    bodies: Vec<Arc<Triangles>>,
}

impl Resistance {
    fn density(&self, body: &Triangles) -> Squeezed {
        Squeezed(self.strength * (2.0 * body.material().lame().mu + body.material().lame().lambda))
    }
}

impl Effect for Resistance {
    fn name(&self) -> &'static str {
        "Compression guard"
    }

    fn elements(&self, _: Motion<'_>) -> usize {
        self.bodies.iter().map(|body| body.corners().len()).sum()
    }

    fn scratch(&self) -> usize {
        self.bodies.iter().map(|body| body.scratch()).max().unwrap_or(0)
    }

    fn idle(&self, _: Motion<'_>) -> Option<&'static str> {
        (self.strength == 0.0).then_some(ZERO)
    }

    fn energy(&self, motion: Motion<'_>) -> f64 {
        self.bodies.iter().map(|body| body.energy_by(motion.x, self.density(body))).sum()
    }

    fn force(&self, motion: Motion<'_>, scratch: &mut [f64], force: &mut [f64]) {
        for body in &self.bodies {
            body.add_force_of(motion, &mut scratch[..body.scratch()], force, self.density(body));
        }
    }

    fn stiffness_times(&self, motion: Motion<'_>, d: &[f64], scratch: &mut [f64], product: &mut [f64]) {
        for body in &self.bodies {
            body.add_energy_change([motion.x, d], &mut scratch[..body.scratch()], product, self.density(body));
        }
    }

    fn sparsity_pattern(&self, add: &mut dyn FnMut(u32, u32)) {
        self.bodies.iter().for_each(|body| body.add_sparsity(add));
    }

    fn add_stiffness(&self, motion: Motion<'_>, weights: Weights, matrix: &mut dyn SparseMatrix) {
        let Some(matrix) = matrix.blocks::<2>() else { return };
        for body in &self.bodies {
            body.add_energy_tangent(motion.x, weights, matrix, self.density(body));
        }
    }
}
