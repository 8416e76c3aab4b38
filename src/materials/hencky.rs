use super::{COFACTOR, Lame, Material, Moduli, Parts, outer};
use crate::lanes::{Real, Square, polynomial};
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

/// Below this y, that is for s1 < 3 s2, h is a polynomial.
const NEAR: f64 = 0.25;

/// `(h - 1)/y` by powers of y: of all polynomials of this degree the one that makes the least relative error in h for y from 0 to
/// [`NEAR`], 1.2e-17 as rounded, found by Remez's algorithm. Cut off there, the Taylor series would need twice as many terms.
const SERIES: [f64; 13] = [
    0.333_333_333_333_339_9,
    0.199_999_999_997_951_1,
    0.142_857_143_080_352_97,
    0.111_111_098_885_917_39,
    0.090_909_484_860_039_12,
    0.076_914_947_481_244_86,
    0.066_779_443_886_069_54,
    0.057_743_959_658_354_084,
    0.059_824_057_209_393_405,
    0.014_564_741_016_676_8,
    0.144_927_915_596_679_14,
    -0.152_894_474_046_388_67,
    0.224_776_098_325_018_9,
];

/// [`SERIES`] for dh/dy, where it errs by up to 3e-14: that is for the stiffness alone.
const SLOPES: [f64; SERIES.len()] = {
    let mut slopes = SERIES;
    let mut k = 0;
    while k < SERIES.len() {
        slopes[k] *= (k + 1) as f64;
        k += 1;
    }
    slopes
};

/// h - 1 of a y below [`NEAR`].
#[inline(always)]
fn rest<R: Real>(y: R) -> R {
    polynomial(y, &SERIES) * y
}

/// What the stretches of a gradient are to the model.
struct Stretches<R> {
    j: R,
    /// 1/J.
    inverse: R,
    /// ln J.
    log: R,
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
        // ln J = 2 atanh(half), with the same series.
        let half = (j - 1.0) / (j + 1.0);
        let (square, limit) = (half * half, y.of(NEAR));
        let (mut h, mut log) = (rest(y) + 1.0, (rest(square) * half + half) * 2.0);
        // Seldom, and twice the work.
        if !(y.all_less(limit) && square.all_less(limit)) {
            let root = y.sqrt();
            // (1 + x)/(1 - x) = (1 + x)²/(1 - y), without the difference.
            let ratio = (root + 1.0) * (root + 1.0) * sum / (j * 4.0);
            h = y.if_less(limit, h, ratio.logarithm() / (root * 2.0));
            log = square.if_less(limit, log, j.logarithm());
        }
        Self { j, inverse: j.of(1.0) / j, log, sum, y, h, k: minus - plus * y }
    }

    /// dh/dy.
    #[inline(always)]
    fn slope(&self) -> R {
        let far = (self.sum * self.inverse * 0.25 - self.h) / (self.y * 2.0);
        self.y.if_less(self.y.of(NEAR), polynomial(self.y, &SLOPES), far)
    }
}

impl Material for Hencky {
    const TITLE: &'static str = "Hencky";
    const LETTER: &'static str = "H";
    const FORMULA: &'static str = "ψ = μ (ln² s₁ + ln² s₂) + λ/2 ln² J,  J = s₁ s₂";
    const BARRIER: bool = true;

    #[inline(always)]
    fn psi<R: Real>(&self, f: Square<R>) -> R {
        let Stretches { log, y, h, .. } = Stretches::of(f);
        log * log * (0.5 * self.bulk()) + y * h * h * (2.0 * self.lame.mu)
    }

    #[inline(always)]
    fn piola<R: Real>(&self, f: Square<R>) -> Square<R> {
        let Stretches { inverse, log, h, k, .. } = Stretches::of(f);
        f.cofactor() * (log * inverse * self.bulk()) + k * (h * inverse * self.lame.mu)
    }

    /// `J dP = d(J P) - P (G : dF)`. With `dy = 2 (K : dF)/p²` and `(1 - y)(F + G) = K + 2 G` that is
    ///
    /// `(mu + lambda) (1 - ln J)/J (G : dF) G + ((mu + lambda) ln J - mu h (1 + y)) dG + mu h (1 - y) dF`,
    /// plus `mu (2 h'/p² - h/(2 J)) (K : dF) K - mu h/J ((K : dF) G + (G : dF) K)`.
    fn stiffness(&self, f: &Matrix2<f64>) -> Matrix4<f64> {
        let mu = self.lame.mu;
        let stretches = Stretches::of(Square::from(f));
        let Stretches { j, log, sum, y, h, k, .. } = stretches;
        let (g, k) = (Matrix2::from(Square::from(f).cofactor()), Matrix2::from(k));
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
        let stretches = Stretches::of(parts.f);
        let Stretches { inverse, log, y, h, .. } = stretches;
        let square = parts.p * parts.p;
        let rest = square * inverse * 0.5;
        let slope = stretches.slope();
        let first = h * rest;
        let second = (slope + first) * rest;
        // By p² and q², both times p², as dy = (dq² - y dp²)/p².
        let by_q = first * two_mu;
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

#[cfg(test)]
mod tests {
    use super::*;

    fn apart(found: f64, expected: f64) -> u64 {
        found.to_bits().abs_diff(expected.to_bits())
    }

    /// Below 1 - 5e-13 the stretches 1 + x and 1 - x are exact.
    #[test]
    fn the_logarithm_of_the_ratio_of_stretches_is_that_of_libm_but_for_two_last_places() {
        let numbers = 1_u64 << 42;
        let all = (0..200_000).map(|turn| numbers / 200_000 * turn);
        let ends = (1..1000).flat_map(|n| [n, numbers - n]).chain((0..42).map(|power| 1 << power));
        for x in all.chain(ends).filter(|n| *n > 0).map(|n| n as f64 / numbers as f64) {
            let h = Stretches::of(Square::new(1.0 + x, 0.0, 0.0, 1.0 - x)).h;
            let expected = libm::atanh(x) / x;
            assert!(apart(h, expected) <= 2, "{x:e}: {h:e} is not {expected:e}");
        }
    }

    #[test]
    fn the_logarithm_of_j_is_that_of_libm_but_for_three_last_places() {
        let wide = (-1000..1000).map(|power| libm::exp2(f64::from(power) * 0.999));
        let round_one = (1..200_000).map(|turn| f64::from(turn) / 50_000.0);
        let next_to_one = (1..53).flat_map(|power| [1.0, -1.0].map(|sign| 1.0 + sign * libm::exp2(-f64::from(power))));
        for j in wide.chain(round_one).chain(next_to_one) {
            let log = Stretches::of(Square::new(j, 0.0, 0.0, 1.0)).log;
            let expected = libm::log(j);
            assert!(apart(log, expected) <= 3, "{j:e}: {log:e} is not {expected:e}");
        }
    }
}
