//! Stable neo-Hookean model.

use super::{COFACTOR, Lame, Material, Moduli, Parts, VolumeMeasure, outer};
use crate::simd::{Mat2, Real};
use nalgebra::{Matrix2, Matrix4};

/// Stable neo-Hookean flesh: defined for every F, also flat and inverted, and pushed back from there.
///
/// With `J = det F`, `I = tr FᵀF` and `l = lambda + 2 mu/3`:
///
/// `psi = 3 mu/4 (I - 2 - ln((I + 1)/3)) + l/2 (J - 1)² - mu (J - 1)`,
/// `P = mu (3/2) I/(I + 1) F + (l (J - 1) - mu) G`, `G = det(F) F⁻ᵀ`
///
/// (Smith, de Goes and Kim, *Stable Neo-Hookean Flesh Simulation*, ACM Transactions on Graphics 37(2), 2018, equation 14:
/// `m/2 (I - 2) + l/2 (J - a)² - m/2 ln(I + 1)`). Rest without stress asks for a = 1 + 2 m/(3 l), and Hooke's law at small
/// strains for m = 3 mu/2 and l as above; that gives a = 1 + mu/l, and the energy at rest is taken away. This is the plane
/// strain of `m/2 (I - 3 - ln(I/3)) + l/2 (J - a)² + const` in three dimensions, with the same m, l and a.
///
/// Where l < 0, in plane stress below nu = -1/2, large areas gain energy without bound: the model is of no use there.
#[derive(Clone, Copy, Debug)]
pub struct StableNeoHookean {
    lame: Lame,
}

impl StableNeoHookean {
    /// The model with these parameters.
    pub const fn new(lame: Lame) -> Self {
        Self { lame }
    }

    /// l \[Pa\].
    #[inline(always)]
    const fn bulk(&self) -> f64 {
        self.lame.lambda + self.lame.mu * (2.0 / 3.0)
    }

    /// The factors of F and of G in P \[Pa\]. The first is mu at rest to the last bit, the second -mu.
    #[inline(always)]
    fn factors<R: Real>(&self, f: Mat2<R>) -> (R, R) {
        let square = f.norm_squared();
        let shear = ((square - 2.0) / (square + 1.0) * 0.5 + 1.0) * self.lame.mu;
        (shear, (f.determinant() - 1.0) * self.bulk() - self.lame.mu)
    }
}

impl Material for StableNeoHookean {
    const TITLE: &'static str = "Stable neo-Hookean";
    const LETTER: &'static str = "S";
    const FORMULA: &'static str = "ψ = 3μ/4 (I − 2 − ln((I + 1)/3)) + (λ/2 + μ/3)(J − 1)² − μ (J − 1),  I = |F|²";

    const VOLUME: Option<VolumeMeasure> = Some(VolumeMeasure::Determinant);

    type Sheet = Self;

    fn sheet(&self) -> Self {
        *self
    }

    #[inline(always)]
    fn psi<R: Real>(&self, f: Mat2<R>) -> R {
        let above = f.norm_squared() - 2.0;
        let growth = f.determinant() - 1.0;
        let log = (above * (1.0 / 3.0) + 1.0).logarithm_of_normal();
        (above - log) * (0.75 * self.lame.mu) + growth * (growth * (0.5 * self.bulk()) - self.lame.mu)
    }

    #[inline(always)]
    fn piola<R: Real>(&self, f: Mat2<R>) -> Mat2<R> {
        let (shear, volume) = self.factors(f);
        f * shear + f.cofactor() * volume
    }

    /// U = lambda/2 (J - 1)².
    #[inline(always)]
    fn volumetric<R: Real>(&self, measure: R) -> [R; 3] {
        let (lambda, growth) = (self.lame.lambda, measure - 1.0);
        [growth * growth * (0.5 * lambda), growth * lambda, growth.of(lambda)]
    }

    /// dP = a dF + b dG + 3 mu/(I + 1)² (F : dF) F + l (G : dF) G, with P = a F + b G.
    fn stiffness(&self, f: &Matrix2<f64>) -> Matrix4<f64> {
        let (shear, volume) = self.factors(Mat2::from(f));
        let g = Matrix2::from(Mat2::from(f).cofactor());
        let more = f.norm_squared() + 1.0;
        Matrix4::identity() * shear
            + COFACTOR * volume
            + outer(f, f) * (3.0 * self.lame.mu / (more * more))
            + outer(&g, &g) * self.bulk()
    }

    #[inline(always)]
    fn moduli<R: Real>(&self, parts: &Parts<R>) -> Moduli<R> {
        let (shear, volume) = self.factors(parts.f);
        let more = parts.f.norm_squared() + 1.0;
        let second = more.of(0.75 * self.lame.mu) / (more * more);
        parts.moduli([shear * 0.5, volume], [second, more.of(self.bulk())])
    }

    /// P33 of the model in three dimensions: the factor of F33 = 1, plus J times that of G.
    #[inline(always)]
    fn thickness_stress<R: Real>(&self, f: Mat2<R>) -> R {
        let (shear, volume) = self.factors(f);
        shear + volume * f.determinant()
    }

    /// a w + b s = 0, by Newton's method from w = 1. While l > 0 there is one root: the left side is -(l + mu) s at w = 0
    /// and grows with w.
    fn free_width(&self, stretch: f64) -> Option<f64> {
        let mut width = 1.0;
        for _ in 0..60 {
            let f = Matrix2::new(stretch, 0.0, 0.0, width);
            let change = self.stress(&f).m22 / self.stiffness(&f).m44;
            width -= change;
            if change.abs() < 1e-14 * width.abs() {
                return (width > 0.0).then_some(width);
            }
        }
        None
    }
}
