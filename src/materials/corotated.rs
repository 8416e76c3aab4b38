//! Corotated linear model.

use super::{Lame, Material, Moduli, Parts, PlaneStress, VolumeMeasure, outer};
use crate::simd::{Mat2, Real};
use nalgebra::{Matrix2, Matrix4};
use std::f64::consts::SQRT_2;

/// Corotated linear elasticity: Hooke's law in the frame that turns with the triangle.
///
/// With F = R S, R the nearest rotation:
///
/// `psi = mu |F - R|² + lambda/2 tr(RᵀF - I)²`,
/// `P = 2 mu (F - R) + lambda tr(RᵀF - I) R`
///
/// (Sifakis and Barbic, *FEM Simulation of 3D Deformable Solids*, SIGGRAPH 2012 course, section 3.4).
/// R is a rotation, det R = +1, also when the triangle is inverted, so a mirrored triangle is pushed back to its rest
/// shape rather than to its mirror image.
#[derive(Clone, Copy, Debug)]
pub struct Corotated {
    lame: Lame,
}

impl Corotated {
    /// The model with these parameters.
    pub const fn new(lame: Lame) -> Self {
        Self { lame }
    }
}

/// tr(RᵀF) that could be round-off of zero.
const UNDECIDED: f64 = 1e-12;

/// The rotation R that maximises tr(RᵀF), in closed form.
///
/// With a = F11 + F22 and b = F21 - F12, `R = [[a, -b], [b, a]] / sqrt(a² + b²)`: the conformal part of F, normalised.
/// Where a = b = 0 (F is a reflection times a scale, or zero) every rotation is equally near. There, and as far around as round-off
/// reaches (`tr(RᵀF) <= 1e-12`), the identity is taken: all triangles of a body that is mirrored then agree on where to go, and
/// as they go there it stays the nearest.
/// Also returns sqrt(a² + b²) = tr(RᵀF).
#[inline(always)]
pub fn nearest_rotation<R: Real>(f: Mat2<R>) -> (Mat2<R>, R) {
    let ([a, b], square) = conformal(f);
    let length = square.sqrt();
    let (zero, one, least) = (a.of(0.0), a.of(1.0), a.of(UNDECIDED));
    let (c, s) = (least.if_less(length, a, one), least.if_less(length, b, zero));
    let inverse = one / least.if_less(length, length, one);
    let (c, s) = (c * inverse, s * inverse);
    (Mat2::new(c, -s, s, c), length)
}

/// a, b and a² + b² of [`nearest_rotation`].
#[inline(always)]
fn conformal<R: Real>(f: Mat2<R>) -> ([R; 2], R) {
    let (a, b) = (f.m11 + f.m22, f.m21 - f.m12);
    ([a, b], a * a + b * b)
}

/// `linear F + (constant + inverse / t) t R`, with `t = tr(RᵀF)`: what depends on R without a division for R itself, as `t R` is
/// `[[a, -b], [b, a]]`.
#[inline(always)]
pub(super) fn with_rotation<R: Real>(f: Mat2<R>, [linear, constant, inverse]: [f64; 3]) -> Mat2<R> {
    let ([a, b], square) = conformal(f);
    let trace = square.sqrt();
    // As 1/t = t/t² the quotient does not wait for the root.
    let factor = a.of(inverse) / square * trace + constant;
    let (mut c, mut s) = (factor * a, factor * b);
    let least = a.of(UNDECIDED);
    // Seldom, and more work.
    if !least.all_less(trace) {
        c = least.if_less(trace, c, a.of(inverse));
        s = least.if_less(trace, s, a.of(0.0));
    }
    Mat2::new(f.m11 * linear + c, f.m12 * linear - s, f.m21 * linear + s, f.m22 * linear + c)
}

/// `factor` dR/dF (4 x 4), as in [`Material::stiffness`]: dR = T (T : dF) / tr(S), with T = R turned by 90 degrees.
pub(super) fn turn(f: &Matrix2<f64>, factor: f64) -> Matrix4<f64> {
    let (r, trace) = nearest_rotation(Mat2::from(f));
    let turned = Matrix2::new(-r.m21, -r.m11, r.m11, -r.m21);
    outer(&turned, &turned) * if trace > UNDECIDED { factor / trace } else { 0.0 }
}

impl Material for Corotated {
    const TITLE: &'static str = "Corotated";
    const LETTER: &'static str = "C";
    const FORMULA: &'static str = "ψ = μ |F − R|² + λ/2 (R:F − 2)²";
    const CONTINUATION: &'static str = "R:F = 0: every rotation is equally near, and R = I is taken";
    const PLANE_STRESS: PlaneStress = PlaneStress::Exact;
    const VOLUME: Option<VolumeMeasure> = Some(VolumeMeasure::Trace);

    type Sheet = Self;

    fn sheet(&self) -> Self {
        *self
    }

    #[inline(always)]
    fn psi<R: Real>(&self, f: Mat2<R>) -> R {
        let (r, trace) = nearest_rotation(f);
        let volume = trace - 2.0;
        (f - r).norm_squared() * self.lame.mu + volume * volume * (0.5 * self.lame.lambda)
    }

    #[inline(always)]
    fn piola<R: Real>(&self, f: Mat2<R>) -> Mat2<R> {
        let Lame { mu, lambda } = self.lame;
        // 2 mu, but for round-off: just what is left at rest, where there is to be no stress.
        let sum = lambda + mu;
        with_rotation(f, [2.0 * (sum - lambda), lambda, -2.0 * sum])
    }

    /// U = lambda/2 (m - 2)².
    #[inline(always)]
    fn volumetric<R: Real>(&self, measure: R) -> [R; 3] {
        let (lambda, growth) = (self.lame.lambda, measure - 2.0);
        [growth * growth * (0.5 * lambda), growth * lambda, growth.of(lambda)]
    }

    /// dP = 2 mu dF + lambda (R : dF) R + (lambda tr(S - I) - 2 mu) dR. dR : F vanishes because S is symmetric.
    fn stiffness(&self, f: &Matrix2<f64>) -> Matrix4<f64> {
        let Lame { mu, lambda } = self.lame;
        let (r, trace) = nearest_rotation(Mat2::from(f));
        let r = Matrix2::from(r);
        Matrix4::identity() * (2.0 * mu) + outer(&r, &r) * lambda + turn(f, lambda * (trace - 2.0) - 2.0 * mu)
    }

    /// psi = mu (I - 2 sqrt(2) p + 2) + lambda/2 (sqrt(2) p - 2)².
    #[inline(always)]
    fn moduli<R: Real>(&self, parts: &Parts<R>) -> Moduli<R> {
        let Lame { mu, lambda } = self.lame;
        let two_mu = parts.p.of(2.0 * mu);
        let turn = ((parts.p * SQRT_2 - 2.0) * lambda - 2.0 * mu) * SQRT_2;
        let twist = two_mu + parts.if_decided(turn / parts.p);
        Moduli { twist, flip: two_mu, sizes: [two_mu + 2.0 * lambda, parts.p.of(0.0), two_mu] }
    }

    fn is_continued(&self, f: &Matrix2<f64>) -> bool {
        nearest_rotation(Mat2::from(f)).1 <= UNDECIDED
    }

    #[inline(always)]
    fn thickness_stress<R: Real>(&self, f: Mat2<R>) -> R {
        (nearest_rotation(f).1 - 2.0) * self.lame.lambda
    }

    /// 2 mu (w - 1) + lambda (s + w - 2) = 0.
    fn free_width(&self, stretch: f64) -> Option<f64> {
        let Lame { mu, lambda } = self.lame;
        let width = 1.0 - lambda / (2.0 * mu + lambda) * (stretch - 1.0);
        (width > 0.0).then_some(width)
    }
}
