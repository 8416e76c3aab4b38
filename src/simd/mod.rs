//! SIMD vectors. Formulas over [`Real`] are evaluated with `f64` and, unchanged, with [`Wide`].
//! [`Wide`] holds one number in each lane of a vector register of any width.
//!
//! Only operations with a unique IEEE 754 rounding are used (`+ - * /` and the square root, no contraction). Every
//! lane therefore has the bits of `f64`, and a run is equal on every processor.
//!
//! ```
//! use gingerbread::simd::{Jet, Real};
//!
//! /// For one number, for several in the lanes of a register, and for a number with its derivatives.
//! fn square_root_of_twice<R: Real>(x: R) -> R {
//!     (x * 2.0).sqrt()
//! }
//!
//! assert_eq!(square_root_of_twice(8.0), 4.0);
//! let jet = square_root_of_twice(Jet::variable(8.0, 0));
//! assert_eq!((jet.value, jet.first[0]), (4.0, 0.25));
//! ```

mod dual;
mod interleaved;
mod jet;
mod logarithm;
mod mat2;
mod wide;

pub use dual::Dual;
pub use interleaved::Interleaved;
pub use jet::Jet;
pub use mat2::Mat2;
pub use wide::{INDEXED16, Indexed16, LANES, Lanes, Order, Pairs, Quads, SPARE, Wide, lined, sets, vector, width};

use std::ops::{Add, Div, Mul, Neg, Sub};

/// Real number, or one in each of several lanes. Constants are `f64`.
pub trait Real:
    Copy
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
{
    /// Constant with as many lanes as `self`.
    #[must_use]
    fn of(self, constant: f64) -> Self;

    /// Square root; NaN below zero.
    #[must_use]
    fn sqrt(self) -> Self;

    /// `then` where `self < than`, `otherwise` where it is not.
    #[must_use]
    fn if_less(self, than: Self, then: Self, otherwise: Self) -> Self;

    /// Whether `self < than` in every lane, so that the other case need not be computed.
    #[must_use]
    fn all_less(self, than: Self) -> bool;

    /// Natural logarithm, bit for bit that of `libm`: below 1 unit in the last place.
    #[must_use]
    fn logarithm(self) -> Self;

    /// Faster natural logarithm for positive normal numbers, with the same bits; undefined for others.
    #[must_use]
    fn logarithm_of_normal(self) -> Self;

    /// Exponential function, bit for bit that of `libm`. It is computed lane by lane.
    #[must_use]
    fn exponential(self) -> Self;

    /// `self` to a power; NaN for negative numbers.
    #[inline(always)]
    #[must_use]
    fn power(self, exponent: f64) -> Self {
        (self.logarithm() * exponent).exponential()
    }
}

/// Real numbers whose bits can be taken apart.
pub trait Split: Real {
    /// m and k with `self = m 2^k` and m from sqrt(1/2) to sqrt(2), for positive normal numbers; undefined for others.
    fn split(self) -> (Self, Self);
}

/// Polynomial `c0 + c1 x + c2 x² + ...` by a fourth-order Horner scheme.
/// The coefficients of every fourth power form a separate polynomial, so that four independent ones are evaluated.
#[inline(always)]
pub fn polynomial<R: Real, const N: usize>(x: R, coefficients: &[f64; N]) -> R {
    const { assert!(N >= 4) };
    let square = x * x;
    let fourth = square * square;
    let [even, odd, twice_even, twice_odd] = [
        every_fourth(fourth, coefficients),
        every_fourth(fourth, &coefficients[1..]),
        every_fourth(fourth, &coefficients[2..]),
        every_fourth(fourth, &coefficients[3..]),
    ];
    (twice_odd * x + twice_even) * square + (odd * x + even)
}

/// Polynomial `c0 + c4 y + c8 y² + ...` by Horner's rule.
#[inline(always)]
fn every_fourth<R: Real>(y: R, coefficients: &[f64]) -> R {
    let mut number = (coefficients.len() - 1) / 4 * 4;
    let mut sum = y.of(coefficients[number]);
    // `fold` might not be inlined and would then lose the instruction set.
    while number > 0 {
        number -= 4;
        sum = sum * y + coefficients[number];
    }
    sum
}

impl Real for f64 {
    #[inline(always)]
    fn of(self, constant: f64) -> Self {
        constant
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self::sqrt(self)
    }

    #[inline(always)]
    fn if_less(self, than: Self, then: Self, otherwise: Self) -> Self {
        if self < than { then } else { otherwise }
    }

    #[inline(always)]
    fn all_less(self, than: Self) -> bool {
        self < than
    }

    #[inline(always)]
    fn logarithm(self) -> Self {
        logarithm::log(self)
    }

    #[inline(always)]
    fn logarithm_of_normal(self) -> Self {
        logarithm::of_normal(self)
    }

    #[inline(always)]
    fn exponential(self) -> Self {
        libm::exp(self)
    }
}

impl Split for f64 {
    #[inline(always)]
    fn split(self) -> (Self, Self) {
        let [m, k] = logarithm::split(self.to_bits());
        (Self::from_bits(m), Self::from_bits(k) - logarithm::BIAS)
    }
}
