//! Exact plane stress: solves P33 = 0 for the thickness stretch.
//!
//! In three dimensions the gradient is `diag(F, t)`. A model for which t depends on `J = det F` alone keeps its energy but for the
//! terms in t and J, which become one function `g(J) = min over t`: static condensation. Stress and stiffness follow from g, g' and g'',
//! and the linear limit is plane stress of Hooke's law. `lambda` below is that of three dimensions; a [`Lame`] of plane stress holds
//! `lambda_ps = 2 mu lambda / (2 mu + lambda)`, from which `a = lambda / (2 mu + lambda) = lambda_ps / (2 mu)` and `b = 1 - a`
//! follow. a is `nu / (1 - nu)`: 0 for nu = 0, 1 for nu = 0.5, where the volume cannot change.

use super::{
    COFACTOR, Corotated, FixedCorotated, Lame, Material, Moduli, NeoHookean, Parts, VolumeMeasure, corotated, outer,
};
use crate::simd::{Mat2, Real};
use nalgebra::{Matrix2, Matrix4};
use std::f64::consts::SQRT_2;

/// From this J on g is exact. Below, it is its Taylor series to second order; below minus this J, the tangent of that. So energy
/// and stress are finite for every F, and a triangle that is flat or inverted is pushed back, with a thickness that stays positive.
const FLAT: f64 = 0.1;

/// g \[Pa\] and its first two derivatives.
#[inline(always)]
fn continued<R: Real>(j: R, exact: [R; 3], [value, slope, bend]: [f64; 3]) -> [R; 3] {
    let (flat, zero) = (j.of(FLAT), j.of(0.0));
    if flat.all_less(j) {
        return exact;
    }
    let (below, least) = (j - FLAT, j.of(-2.0 * FLAT));
    let bent = below.if_less(least, least, below);
    let tangent = bent * bend + slope;
    let line = (bent * (0.5 * bend) + slope) * bent + tangent * (below - bent) + value;
    let curve = below.if_less(least, zero, j.of(bend));
    let [exact_value, exact_slope, exact_bend] = exact;
    [j.if_less(flat, line, exact_value), j.if_less(flat, tangent, exact_slope), j.if_less(flat, curve, exact_bend)]
}

/// A strip's free width, by Newton's method on P22(diag(s, w)) = 0 from w = 1.
fn free_width<M: Material>(material: &M, stretch: f64) -> Option<f64> {
    let mut width = 1.0;
    for _ in 0..60 {
        let f = Matrix2::new(stretch, 0.0, 0.0, width);
        let change = material.stress(&f).m22 / material.stiffness(&f).m44;
        // No more than halved at once: P22 is concave in w.
        width -= change.min(0.5 * width);
        if change.abs() < 1e-14 * width.abs() {
            return (width > 0.0).then_some(width);
        }
    }
    None
}

/// Neo-Hookean rubber with exactly free faces.
///
/// `psi = mu/2 (tr FᵀF + t² - 3) - mu ln(J t) + lambda/2 ln²(J t)` has `P33 = 0` where `T = t²` solves
///
/// `a ln T + b (T - 1) + 2 a ln J = 0`. Then `g = mu/2 (T - 1 - (T + 1) ln(J t))`, `g' = -mu T/J` and
/// `g'' = mu T/J² (1 + 2 a/(a + b T))`, so that `P = mu F + g' G` with `G = det(F) F⁻ᵀ`
///
/// (Bonet and Wood, *Nonlinear Continuum Mechanics for Finite Element Analysis*, 2nd edition, sections 6.4.3 and 6.6.3). For
/// nu = 0.5 T is 1/J², and a strip pulled to twice its length is 0.7071 times as wide.
#[derive(Clone, Copy, Debug)]
pub struct NeoHookeanSheet {
    mu: f64,
    /// a and b.
    shares: [f64; 2],
    /// g and its derivatives at [`FLAT`] \[Pa\].
    flat: [f64; 3],
}

/// Most iterations for T; two or three are taken where triangles are stretched less than ten times.
const ITERATIONS: usize = 24;

/// The square of a relative change of T after which the next one is below round-off: the error shrinks to its fourth power.
const CHANGE: f64 = 1e-9;

impl NeoHookeanSheet {
    /// The model with these parameters, of plane stress.
    pub fn new(Lame { mu, lambda }: Lame) -> Self {
        let a = (lambda / (2.0 * mu)).min(1.0);
        let mut model = Self { mu, shares: [a, 1.0 - a], flat: [0.0; 3] };
        model.flat = model.exact(FLAT);
        model
    }

    /// T of a J from [`FLAT`] on, and ln J.
    ///
    /// The iteration is that of Fritsch, Shafer and Crowley for Lambert's W (*Communications of the ACM* 16, 1973) with `w = b T/a`,
    /// multiplied out so that a may be 0; far from the root it is Newton's.
    #[inline(always)]
    fn thickness_square<R: Real>(&self, j: R) -> [R; 2] {
        let [a, b] = self.shares;
        let log = j.logarithm_of_normal();
        // ln T <= T - 1 makes one a lower bound; the other is exact for a = 0 and a = 1.
        let (linear, mixed) = (log * (-2.0 * a) + 1.0, j.of(1.0) / ((j * j - 1.0) * a + 1.0));
        let mut square = linear.if_less(mixed, mixed, linear);
        let (enough, most, least) = (j.of(CHANGE), j.of(9.0), j.of(-0.9));
        let mut last = j.of(1.0);
        for _ in 0..ITERATIONS {
            let residual = -(square.logarithm_of_normal() * a + (square - 1.0) * b + log * (2.0 * a));
            let slope = square * b + a;
            let newton = residual / slope;
            let q = slope * (slope + residual * (2.0 / 3.0)) * 2.0;
            let fourth = newton * (q - residual * a) / (q - residual * (2.0 * a));
            let change = (residual * residual).if_less(slope * slope, fourth, newton);
            let change = change.if_less(most, change, most);
            let change = least.if_less(change, change, least);
            // A lane that has arrived stays, so that its bits do not depend on the other lanes.
            square = enough.if_less(last, square + square * change, square);
            last = enough.if_less(last, change * change, last);
            if last.all_less(enough) {
                break;
            }
        }
        [square, log]
    }

    #[inline(always)]
    fn exact<R: Real>(&self, j: R) -> [R; 3] {
        let flat = j.of(FLAT);
        let j = flat.if_less(j, j, flat);
        let [a, b] = self.shares;
        let [square, log] = self.thickness_square(j);
        let volume = square.logarithm_of_normal() * 0.5 + log;
        let inverse = j.of(1.0) / j;
        let pull = square * inverse * self.mu;
        let bend = pull * inverse * (j.of(2.0 * a) / (square * b + a) + 1.0);
        [(square - 1.0 - (square + 1.0) * volume) * (0.5 * self.mu), -pull, bend]
    }

    /// g and its derivatives \[Pa\].
    #[inline(always)]
    fn area<R: Real>(&self, j: R) -> [R; 3] {
        continued(j, self.exact(j), self.flat)
    }
}

impl Material for NeoHookeanSheet {
    const TITLE: &'static str = NeoHookean::TITLE;
    const LETTER: &'static str = NeoHookean::LETTER;
    const FORMULA: &'static str = "ψ = μ/2 (|F|² + t² − 3) − μ ln(J t) + λ/2 ln²(J t),  P₃₃ = 0,  J = det F ≥ 0.1";
    const BARRIER: bool = NeoHookean::BARRIER;
    const CONTINUATION: &'static str = CONTINUATION;
    /// A sheet that thins is not stiff against changes of area.
    const VOLUME: Option<VolumeMeasure> = Some(VolumeMeasure::Determinant);

    type Sheet = Self;

    fn sheet(&self) -> Self {
        *self
    }

    #[inline(always)]
    fn psi<R: Real>(&self, f: Mat2<R>) -> R {
        (f.norm_squared() - 2.0) * (0.5 * self.mu) + self.area(f.determinant())[0]
    }

    #[inline(always)]
    fn piola<R: Real>(&self, f: Mat2<R>) -> Mat2<R> {
        f * self.mu + f.cofactor() * self.area(f.determinant())[1]
    }

    fn stiffness(&self, f: &Matrix2<f64>) -> Matrix4<f64> {
        let [_, slope, bend] = self.area(f.determinant());
        let g = Matrix2::from(Mat2::from(f).cofactor());
        Matrix4::identity() * self.mu + COFACTOR * slope + outer(&g, &g) * bend
    }

    #[inline(always)]
    fn moduli<R: Real>(&self, parts: &Parts<R>) -> Moduli<R> {
        let [_, slope, bend] = self.area(parts.f.determinant());
        parts.moduli([slope.of(0.5 * self.mu), slope], [slope.of(0.0), bend])
    }

    fn is_continued(&self, f: &Matrix2<f64>) -> bool {
        f.determinant() < FLAT
    }

    #[inline(always)]
    fn thickness_stress<R: Real>(&self, f: Mat2<R>) -> R {
        f.m11.of(0.0)
    }

    fn free_width(&self, stretch: f64) -> Option<f64> {
        free_width(self, stretch)
    }
}

/// [`Material::CONTINUATION`] of the models here.
const CONTINUATION: &str = "J < 0.1: the energy goes on as its Taylor series, below −0.1 as a straight line";

/// The fixed corotated model with exactly free faces.
///
/// `psi = mu (|F - R|² + (t - 1)²) + lambda/2 (J t - 1)²` has `P33 = 0` where `t = (b + a J)/(b + a J²)`. Then
/// `g = mu a (J - 1)²/D` with `D = b + a J²`, `g' = 2 mu a (J - 1)(b + a J)/D²` and
/// `g'' = 2 mu a ((b - a + 2 a J) D - 4 a J (J - 1)(b + a J))/D³`; `P = 2 mu (F - R) + g' G` with `G = det(F) F⁻ᵀ`
///
/// (for psi see [`FixedCorotated`]).
#[derive(Clone, Copy, Debug)]
pub struct FixedCorotatedSheet {
    lame: Lame,
    /// a and b.
    shares: [f64; 2],
    /// g and its derivatives at [`FLAT`] \[Pa\].
    flat: [f64; 3],
}

impl FixedCorotatedSheet {
    /// The model with these parameters, of plane stress.
    pub fn new(lame: Lame) -> Self {
        let a = (lame.lambda / (2.0 * lame.mu)).min(1.0);
        let mut model = Self { lame, shares: [a, 1.0 - a], flat: [0.0; 3] };
        model.flat = model.exact(FLAT);
        model
    }

    #[inline(always)]
    fn exact<R: Real>(&self, j: R) -> [R; 3] {
        let ([a, b], two) = (self.shares, 2.0 * self.lame.mu * self.shares[0]);
        let (less, top) = (j - 1.0, j * a + b);
        let inverse = j.of(1.0) / (j * j * a + b);
        let square = inverse * inverse;
        let bend = ((j * (2.0 * a) + (b - a)) - j * less * top * inverse * (4.0 * a)) * square;
        [less * less * inverse * (0.5 * two), less * top * square * two, bend * two]
    }

    /// g and its derivatives \[Pa\].
    #[inline(always)]
    fn area<R: Real>(&self, j: R) -> [R; 3] {
        continued(j, self.exact(j), self.flat)
    }
}

impl Material for FixedCorotatedSheet {
    const TITLE: &'static str = FixedCorotated::TITLE;
    const LETTER: &'static str = FixedCorotated::LETTER;
    const FORMULA: &'static str = "ψ = μ (|F − R|² + (t − 1)²) + λ/2 (J t − 1)²,  P₃₃ = 0,  J = det F ≥ 0.1";
    const CONTINUATION: &'static str = CONTINUATION;
    /// A sheet that thins is not stiff against changes of area.
    const VOLUME: Option<VolumeMeasure> = Some(VolumeMeasure::Determinant);

    type Sheet = Self;

    fn sheet(&self) -> Self {
        *self
    }

    #[inline(always)]
    fn psi<R: Real>(&self, f: Mat2<R>) -> R {
        let (r, _) = super::nearest_rotation(f);
        (f - r).norm_squared() * self.lame.mu + self.area(f.determinant())[0]
    }

    #[inline(always)]
    fn piola<R: Real>(&self, f: Mat2<R>) -> Mat2<R> {
        let two_mu = 2.0 * self.lame.mu;
        corotated::with_rotation(f, [two_mu, 0.0, -two_mu]) + f.cofactor() * self.area(f.determinant())[1]
    }

    fn stiffness(&self, f: &Matrix2<f64>) -> Matrix4<f64> {
        let two_mu = 2.0 * self.lame.mu;
        let [_, slope, bend] = self.area(f.determinant());
        let g = Matrix2::from(Mat2::from(f).cofactor());
        Matrix4::identity() * two_mu + corotated::turn(f, -two_mu) + outer(&g, &g) * bend + COFACTOR * slope
    }

    #[inline(always)]
    fn moduli<R: Real>(&self, parts: &Parts<R>) -> Moduli<R> {
        let mu = self.lame.mu;
        let [_, slope, bend] = self.area(parts.f.determinant());
        let moduli = parts.moduli([slope.of(mu), slope], [slope.of(0.0), bend]);
        let turn = parts.if_decided(slope.of(-2.0 * SQRT_2 * mu) / parts.p);
        Moduli { twist: moduli.twist + turn, ..moduli }
    }

    fn is_continued(&self, f: &Matrix2<f64>) -> bool {
        f.determinant() < FLAT || Corotated::new(self.lame).is_continued(f)
    }

    #[inline(always)]
    fn thickness_stress<R: Real>(&self, f: Mat2<R>) -> R {
        f.m11.of(0.0)
    }

    fn free_width(&self, stretch: f64) -> Option<f64> {
        free_width(self, stretch)
    }
}
