//! St. Venant-Kirchhoff model.

use super::{Lame, Material, Moduli, Parts, PlaneStress, VolumeMeasure, outer};
use crate::simd::{Mat2, Real};
use nalgebra::{Matrix2, Matrix4};

/// St. Venant-Kirchhoff: Hooke's law between the Green strain E and the second Piola-Kirchhoff stress.
///
/// With `E = (FᵀF - I)/2`:
///
/// `psi = mu E:E + lambda/2 tr(E)²`, `P = F (2 mu E + lambda tr(E) I)`
///
/// (Sifakis and Barbic, *FEM Simulation of 3D Deformable Solids*, SIGGRAPH 2012 course, section 3.3).
/// E does not see reflections: a mirrored triangle is at rest for this model. Under compression the force has a maximum
/// at a stretch of 1/sqrt(3) = 58 %; beyond it the material gives way.
#[derive(Clone, Copy, Debug)]
pub struct StVenantKirchhoff {
    lame: Lame,
}

impl StVenantKirchhoff {
    /// The model with these parameters.
    pub const fn new(lame: Lame) -> Self {
        Self { lame }
    }

    /// Green strain and second Piola-Kirchhoff stress, both symmetric (2 x 2).
    #[inline(always)]
    fn strain_and_stress<R: Real>(&self, f: Mat2<R>) -> (Mat2<R>, Mat2<R>) {
        let e11 = (f.m11 * f.m11 + f.m21 * f.m21 - 1.0) * 0.5;
        let e12 = (f.m11 * f.m12 + f.m21 * f.m22) * 0.5;
        let e22 = (f.m12 * f.m12 + f.m22 * f.m22 - 1.0) * 0.5;
        let (two_mu, pressure) = (2.0 * self.lame.mu, (e11 + e22) * self.lame.lambda);
        let shear = e12 * two_mu;
        let stress = Mat2::new(e11 * two_mu + pressure, shear, shear, e22 * two_mu + pressure);
        (Mat2::new(e11, e12, e12, e22), stress)
    }
}

impl Material for StVenantKirchhoff {
    const TITLE: &'static str = "St. Venant-Kirchhoff";
    const LETTER: &'static str = "V";
    const FORMULA: &'static str = "ψ = μ E:E + λ/2 tr(E)²,  E = (F^T F − I)/2";
    const PLANE_STRESS: PlaneStress = PlaneStress::Exact;
    const VOLUME: Option<VolumeMeasure> = Some(VolumeMeasure::Square);

    type Sheet = Self;

    fn sheet(&self) -> Self {
        *self
    }

    #[inline(always)]
    fn psi<R: Real>(&self, f: Mat2<R>) -> R {
        let (strain, stress) = self.strain_and_stress(f);
        strain.dot(stress) * 0.5
    }

    #[inline(always)]
    fn piola<R: Real>(&self, f: Mat2<R>) -> Mat2<R> {
        f.times(self.strain_and_stress(f).1)
    }

    /// U = lambda/8 (m - 2)², as tr(E) is (m - 2)/2.
    #[inline(always)]
    fn volumetric<R: Real>(&self, measure: R) -> [R; 3] {
        let (lambda, growth) = (self.lame.lambda, measure - 2.0);
        [growth * growth * (0.125 * lambda), growth * (0.25 * lambda), growth.of(0.25 * lambda)]
    }

    /// dP = dF S + mu (F dFᵀ F + F Fᵀ dF) + lambda (F : dF) F.
    fn stiffness(&self, f: &Matrix2<f64>) -> Matrix4<f64> {
        let s = Matrix2::from(self.strain_and_stress(Mat2::from(f)).1);
        let mut stiffness = outer(f, f) * self.lame.lambda;
        let left = f * f.transpose();
        for column in 0..4 {
            let mut df = Matrix2::zeros();
            df.as_mut_slice()[column] = 1.0;
            let dp = df * s + (f * df.transpose() * f + left * df) * self.lame.mu;
            for row in 0..4 {
                stiffness[(row, column)] += dp.as_slice()[row];
            }
        }
        stiffness
    }

    /// psi = mu (I² - 2 J² - 2 I + 2)/4 + lambda (I - 2)²/8.
    #[inline(always)]
    fn moduli<R: Real>(&self, parts: &Parts<R>) -> Moduli<R> {
        let Lame { mu, lambda } = self.lame;
        let square = parts.f.norm_squared();
        let by_i = (square - 1.0) * (0.5 * mu) + (square - 2.0) * (0.25 * lambda);
        let by_j = parts.f.determinant() * -mu;
        parts.moduli([by_i, by_j], [square.of(0.5 * mu + 0.25 * lambda), square.of(-mu)])
    }

    #[inline(always)]
    fn thickness_stress<R: Real>(&self, f: Mat2<R>) -> R {
        self.strain_and_stress(f).0.trace() * self.lame.lambda
    }

    /// (2 mu + lambda)(w² - 1) + lambda (s² - 1) = 0.
    fn free_width(&self, stretch: f64) -> Option<f64> {
        let Lame { mu, lambda } = self.lame;
        let square = 1.0 - lambda / (2.0 * mu + lambda) * (stretch * stretch - 1.0);
        (square > 0.0).then(|| square.sqrt())
    }

    /// Beside the missing width: along the strip P11 grows as s (s² - 1), which has its extremum at s = 1/sqrt(3).
    fn strip_warning(&self, stretch: f64) -> Option<String> {
        if stretch < (1.0_f64 / 3.0).sqrt() {
            return Some(format!(
                "{} gives way below 58 % of its height: pressing further needs less force.",
                Self::TITLE
            ));
        }
        self.free_width(stretch).is_none().then(|| {
            format!(
                "{} has no solution here: with free sides at {stretch:.2} x, Poisson's ratio must stay below 1/s² (plane \
                 strain) or 1/(s² − 1) (plane stress) for any positive width.",
                Self::TITLE
            )
        })
    }
}
