use super::{Lame, Material, outer};
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

/// The cofactor matrix dJ/dF = J F⁻ᵀ.
#[inline(always)]
fn cofactor(f: &Matrix2<f64>) -> Matrix2<f64> {
    Matrix2::new(f.m22, -f.m21, -f.m12, f.m11)
}

impl Material for NeoHookean {
    const TITLE: &'static str = "Neo-Hookean";
    const LETTER: &'static str = "N";
    const FORMULA: &'static str = "ψ = μ/2 (tr FᵀF − 2) − μ ln J + λ/2 ln² J,  J = det F";

    #[inline(always)]
    fn energy(&self, f: &Matrix2<f64>) -> f64 {
        let log = libm::log(f.determinant());
        0.5 * self.lame.mu * (f.norm_squared() - 2.0) - self.lame.mu * log + 0.5 * self.lame.lambda * log * log
    }

    #[inline(always)]
    fn stress(&self, f: &Matrix2<f64>) -> Matrix2<f64> {
        let j = f.m11 * f.m22 - f.m12 * f.m21;
        f * self.lame.mu + cofactor(f) * ((self.lame.lambda * libm::log(j) - self.lame.mu) / j)
    }

    /// dP = mu dF + lambda (G : dF) G + (mu - lambda ln J) G dFᵀ G, with G = F⁻ᵀ.
    fn stiffness(&self, f: &Matrix2<f64>) -> Matrix4<f64> {
        let j = f.determinant();
        let g = cofactor(f) / j;
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
