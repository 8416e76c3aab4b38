//! Materials by their energy alone.

use super::{Material, Moduli, Parts, PlaneStress, moduli::stiffness_of};
use crate::simd::{Jet, Mat2, Real};
use nalgebra::{Matrix2, Matrix4};
use std::f64::consts::FRAC_1_SQRT_2;

/// The energy density of an isotropic material as a function of its principal stretches. [`Principal`] makes a
/// [`Material`] of it: stress and stiffness follow by differentiation.
///
/// ```
/// use gingerbread::{
///     materials::{Lame, Material as _, Principal, PrincipalEnergy},
///     simd::Real,
/// };
/// use nalgebra::Matrix2;
///
/// /// Hencky: Hooke's law in logarithmic strain.
/// #[derive(Clone, Copy, Debug)]
/// struct Logarithmic(Lame);
///
/// impl PrincipalEnergy for Logarithmic {
///     const TITLE: &'static str = "Logarithmic";
///     const BARRIER: bool = true;
///
///     fn psi<R: Real>(&self, stretches: [R; 3]) -> R {
///         let [a, b, c] = stretches.map(Real::logarithm);
///         (a * a + b * b + c * c) * self.0.mu + (a + b + c) * (a + b + c) * (0.5 * self.0.lambda)
///     }
/// }
///
/// let material = Principal(Logarithmic(Lame { mu: 2.0, lambda: 3.0 }));
/// let stress = material.stress(&Matrix2::new(1.01, 0.0, 0.0, 1.0));
/// assert!((stress.m11 - 0.07).abs() < 2e-3, "near rest it is Hooke's law, (2 mu + lambda) e");
/// ```
pub trait PrincipalEnergy: Copy + Send + Sync + 'static {
    /// Name as it is said, such as `Ogden`.
    const TITLE: &'static str;
    /// The letter on its button, if it is listed.
    const LETTER: &'static str = "";
    /// The energy density in plain characters, for tooltips.
    const FORMULA: &'static str = "";
    /// See [`Material::PLANE_STRESS`]; [`PlaneStress::Solved`] is not possible.
    const PLANE_STRESS: PlaneStress = PlaneStress::Approximate;
    /// Whether the energy tends to infinity as a triangle becomes flat.
    const BARRIER: bool = false;

    /// Energy density [J/m³] of the principal stretches s1 >= s2 in the plane and s3 through the thickness, which is 1.
    /// It must be zero at rest and must not change when s1 and s2 are exchanged. An inverted triangle has a negative s2,
    /// of which the logarithm and powers are NaN: time then stops with a fault.
    fn psi<R: Real>(&self, stretches: [R; 3]) -> R;
}

/// The material of an energy density.
///
/// With `s1 = (p + q)/sqrt 2` and `s2 = (p - q)/sqrt 2` of [`Parts`], the stress is
/// `P = (dpsi/dp) U + (dpsi/dq) M`.
#[derive(Clone, Copy, Debug)]
pub struct Principal<E>(pub E);

/// Below this q/p the modulus (dpsi/dq)/q is its limit, the second derivative; it is off by the square of that.
const ROUND: f64 = 1e-5;

/// The principal stretches s1 >= s2 in the plane.
#[inline(always)]
fn stretches<R: Real>(f: Mat2<R>) -> [R; 2] {
    let size = |x: R, y: R| (x * x + y * y).sqrt() * 0.5;
    let (even, odd) = (size(f.m11 + f.m22, f.m21 - f.m12), size(f.m11 - f.m22, f.m21 + f.m12));
    [even + odd, even - odd]
}

impl<E: PrincipalEnergy> Principal<E> {
    /// The derivatives of psi by p and q.
    #[inline(always)]
    fn by_parts<R: Real>(&self, f: Mat2<R>) -> ([R; 2], [R; 3]) {
        let [first, second] = stretches(f);
        let (first, second) = (Jet::variable(first, 0), Jet::variable(second, 1));
        let Jet { first: [a, b], second: [aa, ab, bb], .. } = self.0.psi([first, second, first.of(1.0)]);
        let (mean, apart) = ((aa + bb) * 0.5, (aa - bb) * 0.5);
        ([(a + b) * FRAC_1_SQRT_2, (a - b) * FRAC_1_SQRT_2], [mean + ab, apart, mean - ab])
    }

    /// P22 of the diagonal gradient with these stretches, and its derivative by the second.
    fn across(&self, stretch: f64, width: f64) -> [f64; 2] {
        let second = Jet::variable(width, 0);
        let jet = self.0.psi([second.of(stretch), second, second.of(1.0)]);
        [jet.first[0], jet.second[0]]
    }
}

impl<E: PrincipalEnergy> Material for Principal<E> {
    const TITLE: &'static str = E::TITLE;
    const LETTER: &'static str = E::LETTER;
    const FORMULA: &'static str = E::FORMULA;
    const BARRIER: bool = E::BARRIER;
    const PLANE_STRESS: PlaneStress = E::PLANE_STRESS;

    type Sheet = Self;

    fn sheet(&self) -> Self {
        *self
    }

    #[inline(always)]
    fn psi<R: Real>(&self, f: Mat2<R>) -> R {
        let [first, second] = stretches(f);
        self.0.psi([first, second, first.of(1.0)])
    }

    #[inline(always)]
    fn piola<R: Real>(&self, f: Mat2<R>) -> Mat2<R> {
        let parts = Parts::of(f);
        let (([by_p, by_q], _), [c, s], [d, t]) = (self.by_parts(f), parts.turned, parts.mirrored);
        let by_p = parts.if_decided(by_p);
        Mat2::new(c * by_p + d * by_q, t * by_q - s * by_p, s * by_p + t * by_q, c * by_p - d * by_q)
    }

    fn stiffness(&self, f: &Matrix2<f64>) -> Matrix4<f64> {
        stiffness_of(self, f)
    }

    #[inline(always)]
    fn moduli<R: Real>(&self, parts: &Parts<R>) -> Moduli<R> {
        let ([by_p, by_q], sizes) = self.by_parts(parts.f);
        let flip = parts.q.if_less(parts.p * ROUND, sizes[2], by_q / parts.q);
        Moduli { twist: parts.if_decided(by_p / parts.p), flip, sizes }
    }

    /// The derivative by s3.
    #[inline(always)]
    fn thickness_stress<R: Real>(&self, f: Mat2<R>) -> R {
        let [first, second] = stretches(f);
        let third = Jet::variable(first.of(1.0), 0);
        self.0.psi([Jet::constant(first), Jet::constant(second), third]).first[0]
    }

    fn free_width(&self, stretch: f64) -> Option<f64> {
        free_width(|width| self.across(stretch, width))
    }
}

/// The width at which the stress across is zero, from that stress and its derivative by the width: by Newton's method on the logarithm of the
/// width, no step of which is longer than 1.
pub(super) fn free_width(across: impl Fn(f64) -> [f64; 2]) -> Option<f64> {
    let mut width = 1.0;
    for _ in 0..100 {
        let [stress, slope] = across(width);
        let change = -stress / (slope * width + stress).max(1e-3 * slope.abs() * width);
        width *= libm::exp(change.clamp(-1.0, 1.0));
        if change.abs() < 1e-14 {
            return Some(width);
        }
    }
    None
}
