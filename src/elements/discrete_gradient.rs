//! Mean forces of a step, whose work is the change of energy: discrete gradients of the energies of triangles and springs.

use super::{
    Adding, Springs, Triangles,
    blocks::{EnergyLaw, StressLaw},
    spring::{add_block, add_pair, between},
    tangent::Isotropic,
};
use crate::{
    effects::Motion,
    materials::Parts,
    simd::{Mat2, Real},
    solvers::{BlockMatrix, Tangent, Weights},
};
use nalgebra::{Matrix4, Vector4};

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

impl<L: EnergyLaw + Isotropic> Mean<L> {
    /// Symmetric part of the derivative of the mean stress by F, where H changes as F does (4 x 4, entries column by column) \[Pa\].
    /// The eigenvalues of dP/dF are changed as the tangent requires; only the exact one has the derivative of the correction:
    /// a change G of F gives
    ///
    /// `b (G D + 2 F (Gᵀ F' + F'ᵀ G)) + (W : G) F D`, `W = 4 (P(F') - dP(H) - P(F) - 2 b F' D) / (D : D)`.
    fn tangent(&self, f: Mat2<f64>, rate: Mat2<f64>, tangent: Tangent) -> Matrix4<f64> {
        let Self(law, span) = self;
        let parts = Parts::of(f);
        let exact = law.moduli(&parts);
        let moduli = tangent.negative_factor().map_or(exact, |factor| exact.with_negative_times(factor));
        let mut columns = [0, 1, 2, 3].map(|entry| vector(moduli.change(&parts, unit(entry))));
        let half = rate * (0.5 * span);
        let stress = law.stress(f, rate);
        let (change, factor) = self.correction(f, half, stress);
        let square = change.norm_squared();
        if tangent == Tangent::Exact && square * square > Self::ROUND_OFF {
            let end = f + half;
            let along = f.times(change);
            let by = law.stress(end, rate) - exact.change(&parts, half) - stress - end.times(change) * (2.0 * factor);
            let (along, by) = (vector(along), vector(by * (4.0 / square)));
            for (entry, column) in columns.iter_mut().enumerate() {
                let moved = unit(entry);
                let product = end.transpose().times(moved);
                let bent = moved.times(change) + f.times(product + product.transpose()) * 2.0;
                *column += vector(bent * factor) + along * by[entry];
            }
        }
        let all = Matrix4::from_columns(&columns);
        (all + all.transpose()) * 0.5
    }
}

/// A matrix with one entry of 1; entries column by column.
fn unit(entry: usize) -> Mat2<f64> {
    let [m11, m21, m12, m22] = [0, 1, 2, 3].map(|other| f64::from(u8::from(entry == other)));
    Mat2::new(m11, m12, m21, m22)
}

/// The entries of a matrix, column by column.
fn vector(of: Mat2<f64>) -> Vector4<f64> {
    Vector4::new(of.m11, of.m21, of.m12, of.m22)
}

impl Triangles {
    /// Adds the forces of an energy density, or their means over a step.
    pub(crate) fn add_force_of(
        &self,
        motion: Motion<'_>,
        scratch: &mut [f64],
        force: &mut [f64],
        law: impl EnergyLaw,
    ) {
        let Motion { x, v, elastic_span, .. } = motion;
        if elastic_span == 0.0 {
            self.assemble(law, &mut Adding { x, v, force }, scratch);
        } else {
            self.assemble(Mean(law, elastic_span), &mut Adding { x, v, force }, scratch);
        }
    }

    /// Adds the blocks of their stiffness, projected as the tangent requires.
    pub(crate) fn add_stiffness_of(
        &self,
        motion: Motion<'_>,
        weights: Weights,
        matrix: &mut BlockMatrix<2>,
        law: impl EnergyLaw + Isotropic,
    ) {
        if motion.elastic_span == 0.0 {
            return self.add_energy_tangent(motion.x, weights, matrix, law);
        }
        let law = Mean(law, motion.elastic_span);
        self.add_tangent(motion.x, weights.position, matrix, |number, f| {
            law.tangent(Mat2::from(f), Mat2::from(&self.gradient_of(motion.v, number)), weights.tangent)
        });
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

    /// Adds the symmetric part of their derivative.
    pub(super) fn add_mean_stiffness(&self, motion: Motion<'_>, weights: Weights, matrix: &mut BlockMatrix<D>) {
        for link in self.links() {
            let middle = between::<D>(motion.x, link);
            let half = between::<D>(motion.v, link) * (0.5 * motion.elastic_span);
            let (start, end) = ((middle - half).norm(), middle + half);
            let (length, lengths) = (end.norm(), start + end.norm());
            let mut block = nalgebra::SMatrix::<f64, D, D>::identity() * link.stiffness;
            if length > 0.0 {
                let across = 1.0 - 2.0 * link.rest / lengths;
                let across = weights.tangent.negative_factor().map_or(across, |factor| across.max(factor * across));
                let along = middle * end.transpose() * (2.0 * link.rest / (lengths * lengths * length));
                block *= across;
                block += (along + along.transpose()) * link.stiffness;
            }
            add_block(matrix, link, &(block * weights.position));
        }
    }
}
