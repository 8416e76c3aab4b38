//! Compressible neo-Hookean model.

use super::{
    COFACTOR, Lame, Material, Moduli, NeoHookeanSheet, Parts, PlaneStress, VolumeMeasure,
    continuation::{Continuation, FLAT, squared_logarithm},
    outer,
};
use crate::simd::{Mat2, Real};
use nalgebra::{Matrix2, Matrix4};
use std::f64::consts::LN_10;

/// Compressible neo-Hookean rubber, with a finite energy for flat and inverted triangles.
///
/// With `J = det F` and `G = det(F) F⁻ᵀ`:
///
/// `psi = mu/2 (tr FᵀF - 2) + U(J)`, `U = -mu ln J + lambda/2 ln² J`, `P = mu F + U'(J) G`
///
/// (Bonet and Wood, *Nonlinear Continuum Mechanics for Finite Element Analysis*, 2nd edition, section 6.4.3, in two
/// dimensions). This is used to the last bit down to `J = J0 = 0.1`, a compression far beyond what the model describes. From there
/// on U is continued with the second derivative
///
/// `U'' = k + (U''(J0) - k) (J/J0)⁶` for 0 < J < J0, `U'' = k` for J <= 0, `k = U''(1) = lambda + mu`
///
/// (extrapolation past a threshold as in Stomakhin, Howes, Schroeder and Teran, *Energetically consistent invertible
/// elasticity*, Symposium on Computer Animation 2012, whose second derivative stays U''(J0) = (3.3 lambda + mu)/J0²). Energy,
/// stress and stiffness have no jump and are finite for every F. While lambda >= 0, U is convex and -U' grows as J falls, so that a
/// flat or inverted triangle is pushed back. For -1 <= J <= 0 the force -U' is between 27.8 lambda + 11.5 mu and
/// 28.8 lambda + 12.5 mu.
#[derive(Clone, Copy, Debug)]
pub struct NeoHookean {
    lame: Lame,
}

impl NeoHookean {
    /// The model with these parameters.
    pub const fn new(lame: Lame) -> Self {
        Self { lame }
    }

    /// U below [`FLAT`].
    #[inline(always)]
    fn continuation(&self) -> Continuation {
        let Lame { mu, lambda } = self.lame;
        let (log, inverse) = (-LN_10, 1.0 / FLAT);
        let pull = lambda * log - mu;
        let there = [log * (0.5 * lambda * log - mu), pull * inverse, (lambda - pull) * inverse * inverse];
        Continuation { threshold: FLAT, there, floor: lambda + mu }
    }

    /// U' and U''.
    #[inline(always)]
    fn area<R: Real>(&self, j: R) -> [R; 2] {
        let Lame { mu, lambda } = self.lame;
        let [log, inverse] = log(j);
        let pull = log * lambda - mu;
        let (slope, bend) = (pull * inverse, inverse * inverse * lambda + pull * -(inverse * inverse));
        let flat = j.of(FLAT);
        if flat.all_less(j) {
            return [slope, bend];
        }
        let [_, by_j, by_jj] = self.continuation().derivatives(j);
        [j.if_less(flat, by_j, slope), j.if_less(flat, by_jj, bend)]
    }
}

/// ln J and 1/J. The quotient does not wait for the logarithm. Where J is no number or infinite |F|² is so too, and tells.
#[inline(always)]
fn log<R: Real>(j: R) -> [R; 2] {
    [j.logarithm_of_normal(), j.of(1.0) / j]
}

impl Material for NeoHookean {
    const TITLE: &'static str = "Neo-Hookean";
    const LETTER: &'static str = "N";
    const FORMULA: &'static str = "ψ = μ/2 (|F|² − 2) − μ ln J + λ/2 ln² J,  J = det F ≥ 0.1";
    const BARRIER: bool = true;
    const CONTINUATION: &'static str =
        "J < 0.1: the energy goes on with a stiffness that falls to the one at rest at J = 0";
    const PLANE_STRESS: PlaneStress = PlaneStress::Solved;
    const VOLUME: Option<VolumeMeasure> = Some(VolumeMeasure::Determinant);

    type Sheet = NeoHookeanSheet;

    fn sheet(&self) -> NeoHookeanSheet {
        NeoHookeanSheet::new(self.lame)
    }

    #[inline(always)]
    fn psi<R: Real>(&self, f: Mat2<R>) -> R {
        let Lame { mu, lambda } = self.lame;
        let (j, shear) = (f.determinant(), (f.norm_squared() - 2.0) * (0.5 * mu));
        let [log, _] = log(j);
        let exact = shear - log * mu + log * log * (0.5 * lambda);
        let flat = j.of(FLAT);
        // Seldom, and more work.
        if flat.all_less(j) { exact } else { j.if_less(flat, shear + self.continuation().derivatives(j)[0], exact) }
    }

    #[inline(always)]
    fn piola<R: Real>(&self, f: Mat2<R>) -> Mat2<R> {
        f * self.lame.mu + f.cofactor() * self.area(f.determinant())[0]
    }

    /// U = lambda/2 ln² J, continued below J0 like the energy.
    #[inline(always)]
    fn volumetric<R: Real>(&self, measure: R) -> [R; 3] {
        let [energy, slope, bend] = squared_logarithm(measure);
        let half = 0.5 * self.lame.lambda;
        [energy * half, slope * half, bend * half]
    }

    /// dP = mu dF + U'' (G : dF) G + U' dG.
    fn stiffness(&self, f: &Matrix2<f64>) -> Matrix4<f64> {
        let [slope, bend] = self.area(f.determinant());
        let g = Matrix2::from(Mat2::from(f).cofactor());
        Matrix4::identity() * self.lame.mu + outer(&g, &g) * bend + COFACTOR * slope
    }

    #[inline(always)]
    fn moduli<R: Real>(&self, parts: &Parts<R>) -> Moduli<R> {
        let j = parts.f.determinant();
        let [slope, bend] = self.area(j);
        parts.moduli([j.of(0.5 * self.lame.mu), slope], [j.of(0.0), bend])
    }

    fn is_continued(&self, f: &Matrix2<f64>) -> bool {
        f.determinant() < FLAT
    }

    /// mu F33 + U' J, which is lambda ln J from J0 on.
    #[inline(always)]
    fn thickness_stress<R: Real>(&self, f: Mat2<R>) -> R {
        let Lame { mu, lambda } = self.lame;
        let (j, flat) = (f.determinant(), f.m11.of(FLAT));
        let pull = log(j)[0] * lambda - mu;
        let pull = if flat.all_less(j) { pull } else { j.if_less(flat, self.area(j)[0] * j, pull) };
        pull + mu
    }

    /// mu w² + U' s w = 0, which is mu (w² - 1) + lambda ln(s w) = 0 from J0 on, by Newton's method on u = ln w from u = 0, no
    /// step of which is longer than 1.
    fn free_width(&self, stretch: f64) -> Option<f64> {
        let mu = self.lame.mu;
        let mut u = 0.0;
        for _ in 0..100 {
            let width = libm::exp(u);
            let j = stretch * width;
            let [slope, bend] = self.area(j);
            let residual = mu * width * width + slope * j;
            let stiffness = mu * width * width + bend * j * j;
            // Below J0 the residual may fall with u, but not that divided by w.
            let change = residual / (stiffness + residual).max(1e-3 * stiffness.abs());
            u -= change.clamp(-1.0, 1.0);
            if change.abs() < 1e-14 {
                return Some(libm::exp(u));
            }
        }
        // With a negative Poisson's ratio there need not be any.
        None
    }
}
