//! Mean forces of a step, whose work is the change of energy: discrete gradients of the energies of triangles and springs.
//!
//! Newton's method takes the stiffness at the midpoint for their derivative, from which it differs by the change within half a step. The
//! symmetric part of the true derivative saves iterations in gentle motion, but fails more often where triangles turn over.

use super::{
    Adding, Springs, Triangles,
    blocks::{EnergyLaw, StressLaw},
    six_nodes::ElementLaw,
    spring::{add_pair, between},
    tangent::Isotropic,
};
use crate::{
    effects::Motion,
    simd::{Mat2, Real},
};

/// The mean stress of a step over a time \[s\].
///
/// With F in the middle of the step, `H = (F' - F)/2` half of its change, `C = FᵀF` and its change `D = 2 (Fᵀ H + Hᵀ F)`,
///
/// `P = P(F) + b F D`, `b = 2 (psi(F + H) - psi(F - H) - 2 P(F) : H) / (D : D)`.
///
/// `F D : 2 H` is half of `D : D`, so that `P : 2 H` is the change of psi. The correction is of second order in the step. `F⁻¹ P` stays
/// symmetric, so that the angular momentum stays (Gonzalez, *Exact energy and momentum conserving algorithms for general models in
/// nonlinear elasticity*, Computer Methods in Applied Mechanics and Engineering 190, 2000, section 4).
#[derive(Clone, Copy)]
pub struct Mean<L>(pub L, pub f64);

impl<L: EnergyLaw> Mean<L> {
    /// Square of D : D below which round-off of the energy may exceed the correction, which fades.
    const ROUND_OFF: f64 = 1e-20;

    /// D, and b.
    #[inline(always)]
    fn correction<R: Real>(&self, f: Mat2<R>, half: Mat2<R>, stress: Mat2<R>) -> (Mat2<R>, R) {
        let product = f.transpose().times(half) * 2.0;
        let change = product + product.transpose();
        let missing = self.0.energy(f + half) - self.0.energy(f - half) - stress.dot(half) * 2.0;
        let square = change.norm_squared();
        (change, missing * square * 2.0 / (square * square + Self::ROUND_OFF))
    }
}

impl<L: EnergyLaw> StressLaw for Mean<L> {
    const RATE: bool = true;

    #[inline(always)]
    fn stress<R: Real>(&self, f: Mat2<R>, rate: Mat2<R>) -> Mat2<R> {
        let (stress, half) = (self.0.stress(f, rate), rate * (0.5 * self.1));
        let (change, factor) = self.correction(f, half, stress);
        stress + f.times(change) * factor
    }
}

impl Triangles {
    /// Energy of a density at these positions \[J\].
    pub(crate) fn energy_by(&self, x: &[f64], law: impl EnergyLaw + Isotropic) -> f64 {
        match self.six_nodes() {
            Some(six) => six.energy(x, ElementLaw::at_points(&law)),
            None => self.gradients(x).map(|(f, area)| area * law.energy(Mat2::from(&f))).sum(),
        }
    }

    /// Adds the forces of an energy density, or their means over a step.
    pub(crate) fn add_force_of(
        &self,
        motion: Motion<'_>,
        scratch: &mut [f64],
        force: &mut [f64],
        law: impl EnergyLaw + Isotropic,
    ) {
        if let Some(six) = self.six_nodes() {
            return six.add_force(motion, force, ElementLaw::at_points(&law));
        }
        let Motion { x, v, elastic_span, .. } = motion;
        if elastic_span == 0.0 {
            self.assemble(law, &mut Adding { x, v, force }, scratch);
        } else {
            self.assemble(Mean(law, elastic_span), &mut Adding { x, v, force }, scratch);
        }
    }
}

impl<const D: usize> Springs<D> {
    /// Adds the mean forces of a step: with the vectors d and d' at its ends, `k (1 - 2 r / (|d| + |d'|)) (d + d')/2`
    /// (Simo, Tarnow and Wong, *Exact energy-momentum conserving algorithms and symplectic schemes for nonlinear dynamics*,
    /// Computer Methods in Applied Mechanics and Engineering 100, 1992).
    pub(super) fn add_mean_force(&self, motion: Motion<'_>, force: &mut [f64]) {
        for link in self.links() {
            let middle = between::<D>(motion.x, link);
            let half = between::<D>(motion.v, link) * (0.5 * motion.elastic_span);
            let lengths = (middle - half).norm() + (middle + half).norm();
            if lengths > 0.0 {
                add_pair(force, link, middle * (link.stiffness * (1.0 - 2.0 * link.rest / lengths)));
            }
        }
    }
}
