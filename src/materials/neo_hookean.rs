use super::{Lame, Material, outer};
use crate::lanes::{Real, Square};
use nalgebra::{Matrix2, Matrix4};

/// Compressible neo-Hookean rubber with a logarithmic barrier against inversion.
///
/// With J = det F:
///
/// `psi = mu/2 (tr FᵀF - 2) - mu ln J + lambda/2 ln² J`, `P = mu (F - F⁻ᵀ) + lambda ln(J) F⁻ᵀ`
///
/// (Bonet and Wood, *Nonlinear Continuum Mechanics for Finite Element Analysis*, 2nd edition, section 6.4.3, in two
/// dimensions). The energy is defined for J > 0 only; at J <= 0 it and the stress are NaN.
#[derive(Clone, Copy, Debug)]
pub struct NeoHookean {
    lame: Lame,
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
    const FORMULA: &'static str = "ψ = μ/2 (tr FᵀF − 2) − μ ln J + λ/2 ln² J,  J = det F";

    #[inline(always)]
    fn psi<R: Real>(&self, f: Square<R>) -> R {
        let Lame { mu, lambda } = self.lame;
        let log = f.determinant().logarithm();
        (f.norm_squared() - 2.0) * (0.5 * mu) - log * mu + log * log * (0.5 * lambda)
    }

    #[inline(always)]
    fn piola<R: Real>(&self, f: Square<R>) -> Square<R> {
        let Lame { mu, lambda } = self.lame;
        let j = f.determinant();
        f * mu + f.cofactor() * ((j.logarithm() * lambda - mu) / j)
    }

    /// dP = mu dF + lambda (G : dF) G + (mu - lambda ln J) G dFᵀ G, with G = F⁻ᵀ.
    fn stiffness(&self, f: &Matrix2<f64>) -> Matrix4<f64> {
        let j = f.determinant();
        let g = Matrix2::from(Square::from(f).cofactor()) / j;
        let turn = self.lame.mu - self.lame.lambda * libm::log(j);
        let mut stiffness = Matrix4::identity() * self.lame.mu + outer(&g, &g) * self.lame.lambda;
        for column in 0..4 {
            let mut df = Matrix2::zeros();
            df.as_mut_slice()[column] = 1.0;
            let dp = g * df.transpose() * g * turn;
            for row in 0..4 {
                stiffness[(row, column)] += dp.as_slice()[row];
            }
        }
        stiffness
    }

    fn thickness_stress(&self, f: &Matrix2<f64>) -> f64 {
        self.lame.lambda * libm::log(f.determinant())
    }

    /// mu (w² - 1) + lambda ln(s w) = 0, by Newton's method on u = ln w from u = 0.
    fn free_width(&self, stretch: f64) -> Option<f64> {
        let Lame { mu, lambda } = self.lame;
        let log_stretch = libm::log(stretch);
        let mut u = 0.0;
        for _ in 0..60 {
            let square = libm::exp(2.0 * u);
            let residual = mu * (square - 1.0) + lambda * (log_stretch + u);
            let change = residual / (2.0 * mu * square + lambda);
            u -= change;
            if change.abs() < 1e-14 {
                return Some(libm::exp(u));
            }
        }
        // With a negative Poisson's ratio there need not be any.
        None
    }
}
