//! Automatic differentiation: numbers with their derivatives.

use super::Real;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A function of two variables at a point: its value and its derivatives up to the second order (Griewank and Walther,
/// *Evaluating Derivatives*, 2nd edition, chapter 13). A formula over [`Real`] that is evaluated with jets is
/// differentiated exactly.
#[derive(Clone, Copy, Debug)]
pub struct Jet<R> {
    /// The value.
    pub value: R,
    /// The derivatives by the first and by the second variable.
    pub first: [R; 2],
    /// The second derivatives: by the first variable twice, by both, by the second twice.
    pub second: [R; 3],
}

impl<R: Real> Jet<R> {
    /// A constant.
    #[inline(always)]
    pub fn constant(value: R) -> Self {
        let zero = value.of(0.0);
        Self { value, first: [zero; 2], second: [zero; 3] }
    }

    /// The first or the second variable itself, by its number.
    #[inline(always)]
    pub fn variable(value: R, number: usize) -> Self {
        let mut jet = Self::constant(value);
        jet.first[number] = value.of(1.0);
        jet
    }

    /// A function of this, of whose value and first two derivatives here are known.
    #[inline(always)]
    fn through(self, [value, slope, bend]: [R; 3]) -> Self {
        let ([a, b], [aa, ab, bb]) = (self.first, self.second);
        Self {
            value,
            first: [slope * a, slope * b],
            second: [slope * aa + bend * a * a, slope * ab + bend * a * b, slope * bb + bend * b * b],
        }
    }
}

impl<R: Real> Neg for Jet<R> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self * -1.0
    }
}

impl<R: Real> Add for Jet<R> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let ([a, b], [aa, ab, bb]) = (self.first, self.second);
        let ([c, d], [cc, cd, dd]) = (other.first, other.second);
        Self { value: self.value + other.value, first: [a + c, b + d], second: [aa + cc, ab + cd, bb + dd] }
    }
}

impl<R: Real> Sub for Jet<R> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl<R: Real> Mul for Jet<R> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let (x, y) = (self.value, other.value);
        let ([a, b], [aa, ab, bb]) = (self.first, self.second);
        let ([c, d], [cc, cd, dd]) = (other.first, other.second);
        Self {
            value: x * y,
            first: [a * y + x * c, b * y + x * d],
            second: [aa * y + a * c * 2.0 + x * cc, ab * y + a * d + b * c + x * cd, bb * y + b * d * 2.0 + x * dd],
        }
    }
}

impl<R: Real> Div for Jet<R> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let inverse = other.value.of(1.0) / other.value;
        let square = inverse * inverse;
        self * other.through([inverse, -square, square * inverse * 2.0])
    }
}

impl<R: Real> Add<f64> for Jet<R> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: f64) -> Self {
        Self { value: self.value + other, ..self }
    }
}

impl<R: Real> Sub<f64> for Jet<R> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: f64) -> Self {
        Self { value: self.value - other, ..self }
    }
}

impl<R: Real> Mul<f64> for Jet<R> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: f64) -> Self {
        let ([a, b], [aa, ab, bb]) = (self.first, self.second);
        let (first, second) = ([a * other, b * other], [aa * other, ab * other, bb * other]);
        Self { value: self.value * other, first, second }
    }
}

impl<R: Real> Real for Jet<R> {
    #[inline(always)]
    fn of(self, constant: f64) -> Self {
        Self::constant(self.value.of(constant))
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        let slope = root.of(0.5) / root;
        self.through([root, slope, -(slope / self.value) * 0.5])
    }

    #[inline(always)]
    fn if_less(self, than: Self, then: Self, otherwise: Self) -> Self {
        let of = |then: R, otherwise: R| self.value.if_less(than.value, then, otherwise);
        let ([a, b], [aa, ab, bb]) = (then.first, then.second);
        let ([c, d], [cc, cd, dd]) = (otherwise.first, otherwise.second);
        Self {
            value: of(then.value, otherwise.value),
            first: [of(a, c), of(b, d)],
            second: [of(aa, cc), of(ab, cd), of(bb, dd)],
        }
    }

    #[inline(always)]
    fn all_less(self, than: Self) -> bool {
        self.value.all_less(than.value)
    }

    #[inline(always)]
    fn logarithm(self) -> Self {
        let inverse = self.value.of(1.0) / self.value;
        self.through([self.value.logarithm(), inverse, -(inverse * inverse)])
    }

    #[inline(always)]
    fn logarithm_of_normal(self) -> Self {
        let inverse = self.value.of(1.0) / self.value;
        self.through([self.value.logarithm_of_normal(), inverse, -(inverse * inverse)])
    }

    #[inline(always)]
    fn exponential(self) -> Self {
        let value = self.value.exponential();
        self.through([value; 3])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `x y + sqrt(x) ln y + exp(-y)/x - x`, with the case `x < y`.
    fn formula<R: Real>(x: R, y: R) -> R {
        let sum = x * y + x.sqrt() * y.logarithm() + (-y).exponential() / x - x;
        x.if_less(y, sum, sum * y.power(1.5))
    }

    #[test]
    fn derivatives_match_differences() {
        let h = 1e-4;
        for (x, y) in [(0.7, 1.3), (1.9, 0.4)] {
            let jet = formula(Jet::variable(x, 0), Jet::variable(y, 1));
            let at = |a: f64, b: f64| formula(x + a * h, y + b * h);
            let near =
                |found: f64, expected: f64| assert!((found - expected).abs() < 1e-6, "{found} is not {expected}");
            near(jet.value, at(0.0, 0.0));
            near(jet.first[0], (at(1.0, 0.0) - at(-1.0, 0.0)) / (2.0 * h));
            near(jet.first[1], (at(0.0, 1.0) - at(0.0, -1.0)) / (2.0 * h));
            near(jet.second[0], (at(1.0, 0.0) - 2.0 * at(0.0, 0.0) + at(-1.0, 0.0)) / (h * h));
            near(jet.second[2], (at(0.0, 1.0) - 2.0 * at(0.0, 0.0) + at(0.0, -1.0)) / (h * h));
            let corners = at(1.0, 1.0) - at(1.0, -1.0) - at(-1.0, 1.0) + at(-1.0, -1.0);
            near(jet.second[1], corners / (4.0 * h * h));
        }
    }
}
