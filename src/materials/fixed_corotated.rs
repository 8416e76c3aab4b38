//! Fixed corotated model.

use super::{
    COFACTOR, Corotated, FixedCorotatedSheet, Lame, Material, Moduli, Parts, PlaneStress, VolumeMeasure,
    corotated::{turn, with_rotation},
    nearest_rotation, outer,
};
use crate::simd::{Mat2, Real};
use nalgebra::{Matrix2, Matrix4};
use std::f64::consts::SQRT_2;

/// Fixed corotated elasticity: the corotated model with the true change of area.
///
/// With F = R S, R the nearest rotation, J = det F and G = det(F) F⁻ᵀ:
///
/// `psi = mu |F - R|² + lambda/2 (J - 1)²`, `P = 2 mu (F - R) + lambda (J - 1) G`
///
/// (Stomakhin, Howes, Schroeder and Teran, *Energetically consistent invertible elasticity*, Symposium on Computer
/// Animation 2012, section 3.3). `|F - R|²` is the sum of (s - 1)² over the principal stretches s, of which the smaller is
/// negative where the triangle is inverted; it is pushed back to its rest shape.
#[derive(Clone, Copy, Debug)]
pub struct FixedCorotated {
    lame: Lame,
}

impl FixedCorotated {
    /// The model with these parameters.
    pub const fn new(lame: Lame) -> Self {
        Self { lame }
    }
}

impl Material for FixedCorotated {
    const TITLE: &'static str = "Fixed corotated";
    const LETTER: &'static str = "F";
    const FORMULA: &'static str = "ψ = μ |F − R|² + λ/2 (J − 1)²,  J = det F";
    const CONTINUATION: &'static str = Corotated::CONTINUATION;
    const PLANE_STRESS: PlaneStress = PlaneStress::Solved;
    const VOLUME: Option<VolumeMeasure> = Some(VolumeMeasure::Determinant);

    type Sheet = FixedCorotatedSheet;

    fn sheet(&self) -> FixedCorotatedSheet {
        FixedCorotatedSheet::new(self.lame)
    }

    #[inline(always)]
    fn psi<R: Real>(&self, f: Mat2<R>) -> R {
        let (r, _) = nearest_rotation(f);
        let growth = f.determinant() - 1.0;
        (f - r).norm_squared() * self.lame.mu + growth * growth * (0.5 * self.lame.lambda)
    }

    #[inline(always)]
    fn piola<R: Real>(&self, f: Mat2<R>) -> Mat2<R> {
        let two_mu = 2.0 * self.lame.mu;
        with_rotation(f, [two_mu, 0.0, -two_mu]) + f.cofactor() * ((f.determinant() - 1.0) * self.lame.lambda)
    }

    /// U = lambda/2 (J - 1)².
    #[inline(always)]
    fn volumetric<R: Real>(&self, measure: R) -> [R; 3] {
        let (lambda, growth) = (self.lame.lambda, measure - 1.0);
        [growth * growth * (0.5 * lambda), growth * lambda, growth.of(lambda)]
    }

    /// dP = 2 mu (dF - dR) + lambda (G : dF) G + lambda (J - 1) dG.
    fn stiffness(&self, f: &Matrix2<f64>) -> Matrix4<f64> {
        let Lame { mu, lambda } = self.lame;
        let g = Matrix2::from(Mat2::from(f).cofactor());
        Matrix4::identity() * (2.0 * mu)
            + turn(f, -2.0 * mu)
            + outer(&g, &g) * lambda
            + COFACTOR * (lambda * (f.determinant() - 1.0))
    }

    /// |F - R|² = I - 2 sqrt(2) p + 2.
    #[inline(always)]
    fn moduli<R: Real>(&self, parts: &Parts<R>) -> Moduli<R> {
        let Lame { mu, lambda } = self.lame;
        let j = parts.f.determinant();
        let moduli = parts.moduli([j.of(mu), (j - 1.0) * lambda], [j.of(0.0), j.of(lambda)]);
        let turn = parts.if_decided(j.of(-2.0 * SQRT_2 * mu) / parts.p);
        Moduli { twist: moduli.twist + turn, ..moduli }
    }

    fn is_continued(&self, f: &Matrix2<f64>) -> bool {
        Corotated::new(self.lame).is_continued(f)
    }

    #[inline(always)]
    fn thickness_stress<R: Real>(&self, f: Mat2<R>) -> R {
        let j = f.determinant();
        (j - 1.0) * self.lame.lambda * j
    }

    /// 2 mu (w - 1) + lambda (s w - 1) s = 0.
    fn free_width(&self, stretch: f64) -> Option<f64> {
        let Lame { mu, lambda } = self.lame;
        let width = (2.0 * mu + lambda * stretch) / (2.0 * mu + lambda * stretch * stretch);
        (width > 0.0).then_some(width)
    }
}
