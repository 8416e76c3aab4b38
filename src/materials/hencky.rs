//! Hencky model (logarithmic strain).

use super::{
    COFACTOR, Lame, Material, Moduli, Parts, PlaneStress, VolumeMeasure,
    continuation::{FLAT, SQUARED_LOGARITHM, squared_logarithm},
    outer,
};
use crate::simd::{Mat2, Real, polynomial};
use nalgebra::{Matrix2, Matrix4, Vector4};
use std::f64::consts::FRAC_1_SQRT_2;

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
/// This is used to the last bit where both stretches and J are at least 0.1. Below, ln² is replaced by a function that is
/// finite for every number, with s2 negative where the triangle is inverted:
///
/// `psi = mu (l(s1) + l(s2)) + lambda/2 l(J)`, `l(x) = ln² x` for x >= 0.1, otherwise with the second derivative
/// `l'' = 2 + (l''(0.1) - 2) (x/0.1)⁶` for 0 < x < 0.1 and `l'' = 2`, that of rest, for x <= 0
///
/// (extrapolation in principal stretches past a threshold: Stomakhin, Howes, Schroeder and Teran, *Energetically consistent
/// invertible elasticity*, Symposium on Computer Animation 2012, whose quadratic polynomial has the constant second derivative
/// l''(0.1) = 661). Energy, stress and stiffness have no jump at the threshold. l is convex below it. While lambda >= 0, a
/// triangle that is flat or inverted is pushed back, the harder the farther. A compression to a tenth is far beyond the strains
/// at which Hooke's law between logarithmic strain and stress describes a material. At s1 = -s2 every rotation is equally near:
/// there the stress jumps, as that of every energy that pushes the smaller signed stretch alone, and its part along the rotation is
/// taken as zero.
///
/// Pulled beyond e = 2.72 times its length, a strip gives way: its force goes as ln(s)/s.
#[derive(Clone, Copy, Debug)]
pub struct Hencky {
    lame: Lame,
}

impl Hencky {
    /// The model with these parameters.
    pub const fn new(lame: Lame) -> Self {
        Self { lame }
    }

    /// mu + lambda \[Pa\].
    #[inline(always)]
    const fn bulk(&self) -> f64 {
        self.lame.mu + self.lame.lambda
    }
}

/// The energy with both ranges of l, for every F: with `s1 = (p + q)/sqrt 2` and `s2 = (p - q)/sqrt 2` of [`Parts`].
struct Continued<R> {
    parts: Parts<R>,
    /// l and its first two derivatives at s1, s2 and J.
    stretches: [[R; 3]; 2],
    area: [R; 3],
}

/// Below this q/p the modulus (dpsi/dq)/q is its limit, the second derivative; it is off by the square of that.
const ROUND: f64 = 1e-5;

impl<R: Real> Continued<R> {
    #[inline(always)]
    fn of(parts: Parts<R>) -> Self {
        let Parts { f, p, q, .. } = parts;
        // A closure would not be compiled for the vector unit.
        let stretches = [squared_logarithm((p + q) * FRAC_1_SQRT_2), squared_logarithm((p - q) * FRAC_1_SQRT_2)];
        Self { parts, stretches, area: squared_logarithm(f.determinant()) }
    }

    #[inline(always)]
    fn psi(&self, Lame { mu, lambda }: Lame) -> R {
        let [[first, ..], [second, ..]] = self.stretches;
        (first + second) * mu + self.area[0] * (0.5 * lambda)
    }

    /// Derivatives of the part with mu, by p and by q.
    #[inline(always)]
    fn by_parts(&self, mu: f64) -> [R; 2] {
        let [[_, first, _], [_, second, _]] = self.stretches;
        let factor = mu * FRAC_1_SQRT_2;
        [self.parts.if_decided((first + second) * factor), (first - second) * factor]
    }

    #[inline(always)]
    fn piola(&self, Lame { mu, lambda }: Lame) -> Mat2<R> {
        let Parts { f, turned: [c, s], mirrored: [d, t], .. } = self.parts;
        let [by_p, by_q] = self.by_parts(mu);
        let shear = Mat2::new(c * by_p + d * by_q, t * by_q - s * by_p, s * by_p + t * by_q, c * by_p - d * by_q);
        shear + f.cofactor() * (self.area[1] * (0.5 * lambda))
    }

    #[inline(always)]
    fn moduli(&self, Lame { mu, lambda }: Lame) -> Moduli<R> {
        let Parts { p, q, .. } = self.parts;
        let ([_, by_j, by_jj], [[.., first], [.., second]]) = (self.area, self.stretches);
        let zero = p.of(0.0);
        let area = self.parts.moduli([zero, by_j * (0.5 * lambda)], [zero, by_jj * (0.5 * lambda)]);
        let [by_p, by_q] = self.by_parts(mu);
        let (mean, apart) = ((first + second) * (0.5 * mu), (first - second) * (0.5 * mu));
        let [pp, pq, qq] = area.sizes;
        Moduli {
            twist: area.twist + self.parts.if_decided(by_p / p),
            flip: area.flip + (p * ROUND).if_less(q, by_q / q, mean),
            sizes: [pp + mean, pq + apart, qq + mean],
        }
    }
}

/// Negative where a stretch or J is below [`FLAT`]. Otherwise s1² is above FLAT², and `J² + FLAT⁴ - FLAT² tr FᵀF` is
/// (s1² - FLAT²)(s2² - FLAT²).
#[inline(always)]
fn slack<R: Real>(f: Mat2<R>, j: R) -> R {
    const SQUARE: f64 = FLAT * FLAT;
    let thin = j * j - f.norm_squared() * SQUARE + SQUARE * SQUARE;
    j.if_less(j.of(FLAT), j - FLAT, thin)
}

/// The continued value where the slack is negative.
#[inline(always)]
fn either<R: Real>(slack: R, below: R, exact: R) -> R {
    slack.if_less(slack.of(0.0), below, exact)
}

/// Below this y, that is for s1 < 3 s2, h is 1 + y N/D with two polynomials.
const NEAR: f64 = 0.25;

/// N and D by powers of y: of all with as many coefficients as these the ones that make the least relative error in h for y from 0 to
/// [`NEAR`], 1.4e-17 as rounded, found by Remez's algorithm. One polynomial would need 13 coefficients for that, the Taylor series
/// twice as many.
const SERIES: [[f64; 5]; 2] = [
    [
        4.852_458_419_866_562,
        -8.741_106_926_276_68,
        4.774_055_581_561_059_5,
        -0.762_675_582_622_440_7,
        0.004_999_947_688_734_648,
    ],
    [14.557_375_259_599_421, -34.957_745_934_552_08, 29.057_939_192_322_28, -9.593_357_524_790_756, 1.0],
];

/// h of a y below [`NEAR`], and (h - 1)/y, both as a numerator over the same denominator: [D + y N, N, D]. As h is a quotient of what D
/// was rounded to and of nearly that, it errs by hardly more than the sum and the quotient are rounded.
#[inline(always)]
fn series<R: Real>(y: R) -> [R; 3] {
    let (n, d) = (polynomial(y, &SERIES[0]), polynomial(y, &SERIES[1]));
    [y * n + d, n, d]
}

/// What the stretches of a gradient are to the model.
struct Stretches<R> {
    /// F + G = [[s, -t], [t, s]].
    even: [R; 2],
    /// F - G = [[d, e], [e, -d]].
    odd: [R; 2],
    j: R,
    /// ln(J)/2, numerator and denominator: a few last places off, as the stress may be.
    half_log: [R; 2],
    /// p².
    sum: R,
    y: R,
    /// Numerator and denominator.
    h: [R; 2],
    /// (h - 1)/y.
    growth: R,
    /// [`slack`], unless it is positive in every lane.
    slack: Option<R>,
}

impl<R: Real> Stretches<R> {
    #[inline(always)]
    fn of(f: Mat2<R>) -> Self {
        let (s, t, d, e) = (f.m11 + f.m22, f.m21 - f.m12, f.m11 - f.m22, f.m12 + f.m21);
        let j = f.determinant();
        let sum = s * s + t * t;
        // With half = (J - 1)/(J + 1) ln J is 2 atanh(half), which has the same series. One quotient serves for y and half.
        let (odds, less, more) = (d * d + e * e, j - 1.0, j + 1.0);
        let inverse = j.of(1.0) / (sum * more);
        let (y, half) = (odds * more * inverse, less * sum * inverse);
        let square = half * half;
        let ([top, rise, bottom], [log, _, below]) = (series(y), series(square));
        let (mut h, mut half_log, mut growth) = ([top, bottom], [log * half, below], rise / bottom);
        let (limit, one) = (y.of(NEAR), y.of(1.0));
        let mut slack_of = None;
        // Seldom, and twice the work. Elsewhere J > 1/3 and s1 < 3 s2, so that s2 > 1/3.
        if !(y.all_less(limit) && square.all_less(limit)) {
            let root = (odds / sum).sqrt();
            // (1 + x)/(1 - x) = (1 + x)²/(1 - y), without the difference.
            let ratio = (root + 1.0) * (root + 1.0) * sum / (j * 4.0);
            let far = ratio.logarithm() / (root * 2.0);
            growth = y.if_less(limit, growth, (far - 1.0) / y);
            h = [y.if_less(limit, top, far), y.if_less(limit, bottom, one)];
            let log = square.if_less(limit, half_log[0], j.logarithm() * 0.5);
            half_log = [log, square.if_less(limit, half_log[1], one)];
            let slack = slack(f, j);
            slack_of = (!j.of(0.0).all_less(slack)).then_some(slack);
        }
        Self { even: [s, t], odd: [d, e], j, half_log, sum, y, h, growth, slack: slack_of }
    }

    #[inline(always)]
    fn h(&self) -> R {
        self.h[0] / self.h[1]
    }

    /// dh/dy: as the derivative of sqrt(y) h is 1/(2 sqrt(y) (1 - y)), it is half of 1/(1 - y) - (h - 1)/y, and 1 - y = 4 J/p².
    #[inline(always)]
    fn slope(&self) -> R {
        (self.sum / (self.j * 4.0) - self.growth) * 0.5
    }
}

impl Material for Hencky {
    const TITLE: &'static str = "Hencky";
    const LETTER: &'static str = "H";
    const FORMULA: &'static str = "ψ = μ (ln² s₁ + ln² s₂) + λ/2 ln² J,  J = s₁ s₂;  s₂, J ≥ 0.1";
    const CONTINUATION: &'static str =
        "s₂ < 0.1 or J < 0.1: each ln² goes on with a second derivative that falls to that of rest at 0";
    const PLANE_STRESS: PlaneStress = PlaneStress::Exact;
    const VOLUME: Option<VolumeMeasure> = Some(VolumeMeasure::Determinant);

    type Sheet = Self;

    fn sheet(&self) -> Self {
        *self
    }

    #[inline(always)]
    fn psi<R: Real>(&self, f: Mat2<R>) -> R {
        let stretches = Stretches::of(f);
        let (log, h) = (stretches.j.logarithm(), stretches.h());
        let exact = log * log * (0.5 * self.bulk()) + stretches.y * h * h * (2.0 * self.lame.mu);
        let Some(slack) = stretches.slack else { return exact };
        either(slack, Continued::of(Parts::of(f)).psi(self.lame), exact)
    }

    /// As G is half the difference of F + G and F - G, P is `(a - y b)(F + G) + (b - a)(F - G)` with
    /// `a = (mu + lambda) ln(J)/(2 J)` and `b = mu h/J`.
    #[inline(always)]
    fn piola<R: Real>(&self, f: Mat2<R>) -> Mat2<R> {
        let Stretches { even: [s, t], odd: [d, e], j, half_log, y, h, slack, .. } = Stretches::of(f);
        // One quotient for both.
        let inverse = j.of(1.0) / (half_log[1] * (h[1] * j));
        let a = half_log[0] * h[1] * self.bulk() * inverse;
        let b = h[0] * half_log[1] * self.lame.mu * inverse;
        let (even, odd) = (a - y * b, b - a);
        let (s, t, d, e) = (s * even, t * even, d * odd, e * odd);
        let exact = Mat2::new(s + d, e - t, t + e, s - d);
        let Some(slack) = slack else { return exact };
        let below = Continued::of(Parts::of(f)).piola(self.lame);
        Mat2::new(
            either(slack, below.m11, exact.m11),
            either(slack, below.m12, exact.m12),
            either(slack, below.m21, exact.m21),
            either(slack, below.m22, exact.m22),
        )
    }

    /// U = lambda/2 l(J), l = ln² J from 0.1 on.
    #[inline(always)]
    fn volumetric<R: Real>(&self, measure: R) -> [R; 3] {
        let [energy, slope, bend] = squared_logarithm(measure);
        let half = 0.5 * self.lame.lambda;
        [energy * half, slope * half, bend * half]
    }

    /// `J dP = d(J P) - P (G : dF)`. With `dy = 2 (K : dF)/p²` and `(1 - y)(F + G) = K + 2 G` that is
    ///
    /// `(mu + lambda) (1 - ln J)/J (G : dF) G + ((mu + lambda) ln J - mu h (1 + y)) dG + mu h (1 - y) dF`,
    /// plus `mu (2 h'/p² - h/(2 J)) (K : dF) K - mu h/J ((K : dF) G + (G : dF) K)`.
    fn stiffness(&self, f: &Matrix2<f64>) -> Matrix4<f64> {
        if self.is_continued(f) {
            let parts = Parts::of(Mat2::from(f));
            let moduli = Continued::of(parts).moduli(self.lame);
            let columns = [0, 1, 2, 3].map(|entry| {
                let mut df = Matrix2::zeros();
                df[entry] = 1.0;
                Vector4::from_column_slice(Matrix2::from(moduli.change(&parts, Mat2::from(&df))).as_slice())
            });
            return Matrix4::from_columns(&columns);
        }
        let mu = self.lame.mu;
        let stretches = Stretches::of(Mat2::from(f));
        let Stretches { even: [s, t], odd: [d, e], j, sum, y, .. } = stretches;
        let (log, h) = (stretches.j.logarithm(), stretches.h());
        let g = Matrix2::from(Mat2::from(f).cofactor());
        let k = Matrix2::new(d - y * s, e + y * t, e - y * t, -d - y * s);
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
        let (log, h, y) = (stretches.j.logarithm(), stretches.h(), stretches.y);
        let inverse = y.of(1.0) / stretches.j;
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
        let exact = Moduli { twist, flip, sizes };
        let Some(slack) = stretches.slack else { return exact };
        let below = Continued::of(*parts).moduli(self.lame);
        let [pp, pq, qq] = exact.sizes;
        let [below_pp, below_pq, below_qq] = below.sizes;
        Moduli {
            twist: either(slack, below.twist, twist),
            flip: either(slack, below.flip, flip),
            sizes: [either(slack, below_pp, pp), either(slack, below_pq, pq), either(slack, below_qq, qq)],
        }
    }

    fn is_continued(&self, f: &Matrix2<f64>) -> bool {
        slack(Mat2::from(f), f.determinant()) < 0.0
    }

    /// lambda/2 l'(J) J, which is lambda ln J from 0.1 on.
    #[inline(always)]
    fn thickness_stress<R: Real>(&self, f: Mat2<R>) -> R {
        let (j, lambda) = (f.determinant(), self.lame.lambda);
        let (flat, exact) = (j.of(FLAT), j.logarithm() * lambda);
        if flat.all_less(j) {
            return exact;
        }
        let [_, slope, _] = SQUARED_LOGARITHM.derivatives(j);
        j.if_less(flat, slope * j * (0.5 * lambda), exact)
    }

    /// (2 mu + lambda) ln w + lambda ln s = 0. Where one of the logarithms is continued it is mu l'(w) + lambda/2 l'(s w) s = 0,
    /// by Newton's method on the logarithm of the width, no step of which is longer than 1.
    fn free_width(&self, stretch: f64) -> Option<f64> {
        let Lame { mu, lambda } = self.lame;
        let mut width = libm::pow(stretch, -lambda / (2.0 * mu + lambda));
        if !self.is_continued(&Matrix2::new(stretch, 0.0, 0.0, width)) {
            return (width > 0.0).then_some(width);
        }
        for _ in 0..100 {
            let ([_, own, own_bend], [_, by_j, by_jj]) = (squared_logarithm(width), squared_logarithm(stretch * width));
            let stress = mu * own + 0.5 * lambda * by_j * stretch;
            let slope = mu * own_bend + 0.5 * lambda * by_jj * stretch * stretch;
            let change = -stress / (slope * width + stress).max(1e-3 * slope.abs() * width);
            width *= libm::exp(change.clamp(-1.0, 1.0));
            if change.abs() < 1e-14 {
                return Some(width);
            }
        }
        None
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
    fn the_logarithm_of_stretches_matches_libm_to_two_ulps() {
        let numbers = 1_u64 << 42;
        let all = (0..200_000).map(|turn| numbers / 200_000 * turn);
        let ends = (1..1000).flat_map(|n| [n, numbers - n]).chain((0..42).map(|power| 1 << power));
        for x in all.chain(ends).filter(|n| *n > 0).map(|n| n as f64 / numbers as f64) {
            let h = Stretches::of(Mat2::new(1.0 + x, 0.0, 0.0, 1.0 - x)).h();
            let expected = libm::atanh(x) / x;
            assert!(apart(h, expected) <= 2, "{x:e}: {h:e} is not {expected:e}");
        }
    }

    #[test]
    fn the_stress_is_that_of_the_formula_but_for_a_few_last_places() {
        let law = Hencky::new(Lame { mu: 1.0, lambda: 1.5 });
        let stretches = || (-60..=60).map(|power| libm::exp2(f64::from(power) * 0.07));
        let turns = || (0..7).map(f64::from);
        for (one, other) in stretches().flat_map(|one| stretches().map(move |other| (one, other))) {
            for (before, after) in turns().flat_map(|before| turns().map(move |after| (before, after))) {
                let turn =
                    |angle: f64| Matrix2::new(libm::cos(angle), -libm::sin(angle), libm::sin(angle), libm::cos(angle));
                let f = turn(after) * Matrix2::new(one, 0.0, 0.0, other) * turn(before);
                if law.is_continued(&f) {
                    continue;
                }
                let volume = law.lame.lambda * libm::log(one * other);
                let principal = [one, other].map(|s| (2.0 * law.lame.mu * libm::log(s) + volume) / s);
                let expected = turn(after) * Matrix2::new(principal[0], 0.0, 0.0, principal[1]) * turn(before);
                // What the entries of F are rounded to moves it as well.
                let size = law.stiffness(&f).norm() * f.norm() + expected.norm();
                assert!(
                    (law.stress(&f) - expected).norm() <= 8.0 * f64::EPSILON * size,
                    "{f}: {} is not {expected}",
                    law.stress(&f)
                );
            }
        }
    }
}
