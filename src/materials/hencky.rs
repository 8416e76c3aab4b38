use super::{COFACTOR, Lame, Material, Moduli, Parts, outer};
use crate::lanes::{Real, Square};
use nalgebra::{Matrix2, Matrix4};

/// Hencky: Hooke's law between logarithmic strain and Kirchhoff stress.
///
/// With the principal stretches s1 >= s2 and J = s1 s2:
///
/// `psi = mu (ln² s1 + ln² s2) + lambda/2 ln² J = (mu + lambda)/2 ln² J + mu/2 ln²(s1/s2)`
///
/// (Hencky, *Zeitschrift für technische Physik* 9, 1928; Xiao and Chen, *Acta Mechanica* 157, 2002). No principal
/// directions are needed. With G = det(F) F⁻ᵀ, s1 + s2 = p and s1 - s2 = q have the squares
///
/// `p² = tr FᵀF + 2 J = (F11 + F22)² + (F21 - F12)²`, `q² = tr FᵀF - 2 J = (F11 - F22)² + (F21 + F12)²`,
///
/// so that `ln(s1/s2) = 2 atanh(q/p)`. Of y = q²/p² the function `h = atanh(sqrt y)/sqrt y = 1 + y/3 + y²/5 + ...` is smooth,
/// also where s1 = s2, and with `d(p²) = 2 (F + G) : dF`, `d(q²) = 2 (F - G) : dF`, `1 - y = 4 J/p²`:
///
/// `psi = (mu + lambda)/2 ln² J + 2 mu y h²`, `P = ((mu + lambda) ln(J) G + mu h K)/J`, `K = F - G - y (F + G)`.
///
/// The energy is defined for J > 0 only; at J <= 0 it and the stress are NaN. Pulled beyond e = 2.72 times its length, a strip
/// gives way: its force goes as ln(s)/s.
#[derive(Clone, Copy, Debug)]
pub struct Hencky {
    lame: Lame,
}

impl Hencky {
    /// The model with these parameters.
    pub const fn new(lame: Lame) -> Self {
        Self { lame }
    }

    /// mu + lambda [Pa].
    #[inline(always)]
    const fn bulk(&self) -> f64 {
        self.lame.mu + self.lame.lambda
    }
}

/// Below this y, h is summed up as a series: the logarithm would lose digits.
const NEAR: f64 = 0.01;

/// Number of terms of the series: the next one is below 1e-17.
const TERMS: u32 = 8;

/// What the stretches of a gradient are to the model.
struct Stretches<R> {
    j: R,
    /// p².
    sum: R,
    y: R,
    h: R,
    k: Square<R>,
}

impl<R: Real> Stretches<R> {
    #[inline(always)]
    fn of(f: Square<R>) -> Self {
        let g = f.cofactor();
        let j = f.determinant();
        let (plus, minus) = (f + g, f - g);
        // Both have two entries in common: |F + G|² = 2 p², |F - G|² = 2 q².
        let sum = plus.m11 * plus.m11 + plus.m21 * plus.m21;
        let y = (minus.m11 * minus.m11 + minus.m21 * minus.m21) / sum;
        let series = (0..TERMS).rev().fold(y.of(0.0), |tail, k| tail * y + 1.0 / f64::from(2 * k + 1));
        let root = y.sqrt();
        // (1 + x)/(1 - x) = (1 + x)²/(1 - y), without the difference.
        let ratio = (root + 1.0) * (root + 1.0) * sum / (j * 4.0);
        let h = y.if_less(y.of(NEAR), series, ratio.logarithm() / (root * 2.0));
        Self { j, sum, y, h, k: minus - plus * y }
    }
}

impl Stretches<f64> {
    /// dh/dy.
    fn slope(&self) -> f64 {
        if self.y < NEAR {
            (1..TERMS).rev().fold(0.0, |tail, k| tail * self.y + f64::from(k) / f64::from(2 * k + 1))
        } else {
            (self.sum / (4.0 * self.j) - self.h) / (2.0 * self.y)
        }
    }
}

impl Material for Hencky {
    const TITLE: &'static str = "Hencky";
    const LETTER: &'static str = "H";
    const FORMULA: &'static str = "ψ = μ (ln² s₁ + ln² s₂) + λ/2 ln² J,  J = s₁ s₂";
    const BARRIER: bool = true;

    #[inline(always)]
    fn psi<R: Real>(&self, f: Square<R>) -> R {
        let Stretches { j, y, h, .. } = Stretches::of(f);
        let log = j.logarithm();
        log * log * (0.5 * self.bulk()) + y * h * h * (2.0 * self.lame.mu)
    }

    #[inline(always)]
    fn piola<R: Real>(&self, f: Square<R>) -> Square<R> {
        let Stretches { j, h, k, .. } = Stretches::of(f);
        let inverse = j.of(1.0) / j;
        f.cofactor() * (j.logarithm() * inverse * self.bulk()) + k * (h * inverse * self.lame.mu)
    }

    /// `J dP = d(J P) - P (G : dF)`. With `dy = 2 (K : dF)/p²` and `(1 - y)(F + G) = K + 2 G` that is
    ///
    /// `(mu + lambda) (1 - ln J)/J (G : dF) G + ((mu + lambda) ln J - mu h (1 + y)) dG + mu h (1 - y) dF`,
    /// plus `mu (2 h'/p² - h/(2 J)) (K : dF) K - mu h/J ((K : dF) G + (G : dF) K)`.
    fn stiffness(&self, f: &Matrix2<f64>) -> Matrix4<f64> {
        let mu = self.lame.mu;
        let stretches = Stretches::of(Square::from(f));
        let Stretches { j, sum, y, h, k } = stretches;
        let (g, k) = (Matrix2::from(Square::from(f).cofactor()), Matrix2::from(k));
        let log = libm::log(j);
        let times_j = outer(&g, &g) * (self.bulk() * (1.0 - log) / j)
            + COFACTOR * (self.bulk() * log - mu * h * (1.0 + y))
            + Matrix4::identity() * (mu * h * 4.0 * j / sum)
            + outer(&k, &k) * (mu * (2.0 * stretches.slope() / sum - h / (2.0 * j)))
            - (outer(&g, &k) + outer(&k, &g)) * (mu * h / j);
        times_j / j
    }

    /// With u = y h² = atanh²(sqrt y) of y = q²/p², u' = h/(1 - y) and u'' = (h' + u')/(1 - y); 1 - y = 2 J/p².
    #[inline(always)]
    fn moduli<R: Real>(&self, parts: &Parts<R>) -> Moduli<R> {
        let two_mu = 2.0 * self.lame.mu;
        let Stretches { j, y, h, .. } = Stretches::of(parts.f);
        let (square, inverse) = (parts.p * parts.p, j.of(1.0) / j);
        let rest = square * inverse * 0.5;
        let series = (1..TERMS).rev().fold(y.of(0.0), |tail, k| tail * y + f64::from(k) / f64::from(2 * k + 1));
        let slope = y.if_less(y.of(NEAR), series, (rest - h) / (y * 2.0));
        let first = h * rest;
        let second = (slope + first) * rest;
        // By p² and q², both times p², as dy = (dq² - y dp²)/p².
        let (by_q, log) = (first * two_mu, j.logarithm());
        let (volume, bend) = (log * inverse * self.bulk(), (-log + 1.0) * inverse * inverse * self.bulk());
        let scale = y.of(1.0) / square;
        let (twist, flip) = (volume - by_q * y * scale * 2.0, by_q * scale * 2.0 - volume);
        let (bent, q_square) = (second * two_mu, parts.q * parts.q);
        let pp = (bent * y * y + by_q * y * 2.0) * scale * 4.0;
        let pq = -(bent * y + by_q) * scale * scale * 4.0;
        let qq = bent * scale * scale * 4.0;
        let sizes = [twist + square * bend + pp, parts.p * parts.q * (pq - bend), flip + q_square * (bend + qq)];
        Moduli { twist, flip, sizes }
    }

    #[inline(always)]
    fn thickness_stress<R: Real>(&self, f: Square<R>) -> R {
        f.determinant().logarithm() * self.lame.lambda
    }

    /// (2 mu + lambda) ln w + lambda ln s = 0.
    fn free_width(&self, stretch: f64) -> Option<f64> {
        let Lame { mu, lambda } = self.lame;
        let width = libm::pow(stretch, -lambda / (2.0 * mu + lambda));
        (width > 0.0).then_some(width)
    }
}
