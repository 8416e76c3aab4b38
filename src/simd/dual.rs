//! Automatic differentiation of the first order.

use super::Real;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A function of two variables at a point: its value and its first derivatives. It takes half of the work of a [`Jet`](super::Jet).
#[derive(Clone, Copy, Debug)]
pub struct Dual<R> {
    /// The value.
    pub value: R,
    /// The derivatives by the first and by the second variable.
    pub first: [R; 2],
}

impl<R: Real> Dual<R> {
    /// A constant.
    #[inline(always)]
    pub fn constant(value: R) -> Self {
        Self { value, first: [value.of(0.0); 2] }
    }

    /// The first or the second variable itself, by its number.
    #[inline(always)]
    pub fn variable(value: R, number: usize) -> Self {
        let mut dual = Self::constant(value);
        dual.first[number] = value.of(1.0);
        dual
    }

    /// A function of this, of whose value and derivative here are known.
    #[inline(always)]
    fn through(self, [value, slope]: [R; 2]) -> Self {
        let [a, b] = self.first;
        Self { value, first: [slope * a, slope * b] }
    }
}

impl<R: Real> Neg for Dual<R> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        let [a, b] = self.first;
        Self { value: -self.value, first: [-a, -b] }
    }
}

impl<R: Real> Add for Dual<R> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let ([a, b], [c, d]) = (self.first, other.first);
        Self { value: self.value + other.value, first: [a + c, b + d] }
    }
}

impl<R: Real> Sub for Dual<R> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        let ([a, b], [c, d]) = (self.first, other.first);
        Self { value: self.value - other.value, first: [a - c, b - d] }
    }
}

impl<R: Real> Mul for Dual<R> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let (x, y, [a, b], [c, d]) = (self.value, other.value, self.first, other.first);
        Self { value: x * y, first: [a * y + x * c, b * y + x * d] }
    }
}

impl<R: Real> Div for Dual<R> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let inverse = other.value.of(1.0) / other.value;
        self * other.through([inverse, -(inverse * inverse)])
    }
}

impl<R: Real> Add<f64> for Dual<R> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: f64) -> Self {
        Self { value: self.value + other, ..self }
    }
}

impl<R: Real> Sub<f64> for Dual<R> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: f64) -> Self {
        Self { value: self.value - other, ..self }
    }
}

impl<R: Real> Mul<f64> for Dual<R> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: f64) -> Self {
        let [a, b] = self.first;
        Self { value: self.value * other, first: [a * other, b * other] }
    }
}

impl<R: Real> Real for Dual<R> {
    #[inline(always)]
    fn of(self, constant: f64) -> Self {
        Self::constant(self.value.of(constant))
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.through([root, root.of(0.5) / root])
    }

    #[inline(always)]
    fn if_less(self, than: Self, then: Self, otherwise: Self) -> Self {
        let of = |then: R, otherwise: R| self.value.if_less(than.value, then, otherwise);
        let ([a, b], [c, d]) = (then.first, otherwise.first);
        Self { value: of(then.value, otherwise.value), first: [of(a, c), of(b, d)] }
    }

    #[inline(always)]
    fn all_less(self, than: Self) -> bool {
        self.value.all_less(than.value)
    }

    #[inline(always)]
    fn logarithm(self) -> Self {
        self.through([self.value.logarithm(), self.value.of(1.0) / self.value])
    }

    #[inline(always)]
    fn logarithm_of_normal(self) -> Self {
        self.through([self.value.logarithm_of_normal(), self.value.of(1.0) / self.value])
    }

    #[inline(always)]
    fn exponential(self) -> Self {
        let value = self.value.exponential();
        self.through([value; 2])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::Jet;

    /// `x y + sqrt(x) ln y + exp(-y)/x - x`, with the case `x < y`.
    fn formula<R: Real>(x: R, y: R) -> R {
        let sum = x * y + x.sqrt() * y.logarithm() + (-y).exponential() / x - x;
        x.if_less(y, sum, sum * y.power(1.5))
    }

    #[test]
    fn derivatives_are_those_of_jets() {
        for (x, y) in [(0.7, 1.3), (1.9, 0.4)] {
            let dual = formula(Dual::variable(x, 0), Dual::variable(y, 1));
            let jet = formula(Jet::variable(x, 0), Jet::variable(y, 1));
            assert!((dual.value - jet.value).abs() < 1e-15 * (1.0 + jet.value.abs()));
            for axis in 0..2 {
                assert!((dual.first[axis] - jet.first[axis]).abs() < 1e-14 * (1.0 + jet.first[axis].abs()));
            }
        }
    }
}
