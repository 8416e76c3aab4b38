//! Compressible neo-Hookean model.

use super::{COFACTOR, Lame, Material, Moduli, NeoHookeanSheet, Parts, PlaneStress, outer};
use crate::simd::{Mat2, Real};
use nalgebra::{Matrix2, Matrix4};
use std::f64::consts::LN_10;

/// Compressible neo-Hookean rubber, with a logarithm that resists being squeezed flat.
///
/// With `J = det F` and `G = det(F) F⁻ᵀ`:
///
/// `psi = mu/2 (tr FᵀF - 2) - mu L(J) + lambda/2 L(J)²`, `P = mu F + (lambda L(J) - mu) L'(J) G`
///
/// (Bonet and Wood, *Nonlinear Continuum Mechanics for Finite Element Analysis*, 2nd edition, section 6.4.3, in two
/// dimensions). The model is `L = ln J`. That is used to the last bit down to `J = J0 = 0.1`, which no honest answer goes
/// below. From there on L is the Taylor series of the logarithm to second order, `L = ln J0 + t - t²/2` with `t = J/J0 - 1`:
/// energy, stress and stiffness go on without a jump. Below `J = -J0`, where t = -2, it is the tangent of that: energy and stress
/// have no jump there either, and are finite for every F. While lambda >= 0, a triangle that is flat or inverted is pushed
/// back, the harder the farther, by an energy that in the end grows as J². (Were the series used all the way it would grow as
/// J⁴, the eighth power of a length: from a scrambled start Newton's method then loses its way. Were the tangent used from J0
/// on, a mirror image would be pushed too softly to come home.)
#[derive(Clone, Copy, Debug)]
pub struct NeoHookean {
    lame: Lame,
}

/// J0: where the logarithm is continued by its Taylor series.
const FLAT: f64 = 0.1;

/// The t below which the series is continued by its tangent.
const INVERTED: f64 = -2.0;

/// L and its derivative.
#[inline(always)]
fn log<R: Real>(j: R) -> [R; 2] {
    // The quotient does not wait for the logarithm. Where J is no number or infinite |F|² is so too, and tells.
    let (mut log, mut slope) = (j.logarithm_of_normal(), j.of(1.0) / j);
    let flat = j.of(FLAT);
    // Seldom, and more work.
    if !flat.all_less(j) {
        let t = j * (1.0 / FLAT) - 1.0;
        let u = t.if_less(t.of(INVERTED), t.of(INVERTED), t);
        let falling = -u + 1.0;
        log = j.if_less(flat, u - u * u * 0.5 + falling * (t - u) - LN_10, log);
        slope = j.if_less(flat, falling * (1.0 / FLAT), slope);
    }
    [log, slope]
}

/// L with its first and second derivative.
#[inline(always)]
fn derivatives<R: Real>(j: R) -> [R; 3] {
    let [log, slope] = log(j);
    let (flat, inverted) = (j.of(FLAT), j.of(FLAT * (1.0 + INVERTED)));
    let bend = j.if_less(flat, j.of(-(1.0 / FLAT) * (1.0 / FLAT)), -(slope * slope));
    [log, slope, j.if_less(inverted, j.of(0.0), bend)]
}

impl NeoHookean {
    /// The model with these parameters.
    pub const fn new(lame: Lame) -> Self {
        Self { lame }
    }
}

impl Material for NeoHookean {
    const TITLE: &'static str = "Neo-Hookean";
    const LETTER: &'static str = "N";
    const FORMULA: &'static str = "ψ = μ/2 (|F|² − 2) − μ ln J + λ/2 ln² J,  J = det F ≥ 0.1";
    const BARRIER: bool = true;
    const CONTINUATION: &'static str = "J < 0.1: ln J goes on as its Taylor series, below −0.1 as a straight line";
    const PLANE_STRESS: PlaneStress = PlaneStress::Solved;

    type Sheet = NeoHookeanSheet;

    fn sheet(&self) -> NeoHookeanSheet {
        NeoHookeanSheet::new(self.lame)
    }

    #[inline(always)]
    fn psi<R: Real>(&self, f: Mat2<R>) -> R {
        let Lame { mu, lambda } = self.lame;
        let [log, _] = log(f.determinant());
        (f.norm_squared() - 2.0) * (0.5 * mu) - log * mu + log * log * (0.5 * lambda)
    }

    #[inline(always)]
    fn piola<R: Real>(&self, f: Mat2<R>) -> Mat2<R> {
        let Lame { mu, lambda } = self.lame;
        let j = f.determinant();
        let [log, slope] = log(j);
        f * mu + f.cofactor() * ((log * lambda - mu) * slope)
    }

    /// dP = mu dF + (lambda L'² + (lambda L - mu) L'') (G : dF) G + (lambda L - mu) L' dG.
    fn stiffness(&self, f: &Matrix2<f64>) -> Matrix4<f64> {
        let Lame { mu, lambda } = self.lame;
        let [log, slope, bend] = derivatives(f.determinant());
        let g = Matrix2::from(Mat2::from(f).cofactor());
        let pull = lambda * log - mu;
        Matrix4::identity() * mu + outer(&g, &g) * (lambda * slope * slope + pull * bend) + COFACTOR * (pull * slope)
    }

    #[inline(always)]
    fn moduli<R: Real>(&self, parts: &Parts<R>) -> Moduli<R> {
        let Lame { mu, lambda } = self.lame;
        let j = parts.f.determinant();
        let [log, slope, bend] = derivatives(j);
        let pull = log * lambda - mu;
        let second = slope * slope * lambda + pull * bend;
        parts.moduli([j.of(0.5 * mu), pull * slope], [j.of(0.0), second])
    }

    fn is_continued(&self, f: &Matrix2<f64>) -> bool {
        f.determinant() < FLAT
    }

    /// mu F33 + (lambda L - mu) L' J, which is lambda ln J from J0 on.
    #[inline(always)]
    fn thickness_stress<R: Real>(&self, f: Mat2<R>) -> R {
        let Lame { mu, lambda } = self.lame;
        let j = f.determinant();
        let [log, slope] = log(j);
        let pull = log * lambda - mu;
        j.if_less(j.of(FLAT), pull * slope * j, pull) + mu
    }

    /// mu w² + (lambda L - mu) L' s w = 0, which is mu (w² - 1) + lambda ln(s w) = 0 from J0 on, by Newton's method on
    /// u = ln w from u = 0.
    fn free_width(&self, stretch: f64) -> Option<f64> {
        let Lame { mu, lambda } = self.lame;
        let mut u = 0.0;
        for _ in 0..60 {
            let width = libm::exp(u);
            let j = stretch * width;
            let [log, slope, bend] = derivatives(j);
            let pull = lambda * log - mu;
            let residual = mu * width * width + pull * slope * j;
            let growth = 2.0 * mu * width * width + (lambda * slope * slope + pull * bend) * j * j + pull * slope * j;
            u -= residual / growth;
            if (residual / growth).abs() < 1e-14 {
                return Some(libm::exp(u));
            }
        }
        // With a negative Poisson's ratio there need not be any.
        None
    }
}
