//! Interleaved evaluation of one formula for two arguments, instruction by instruction.

use super::{Mat2, Real, Split, logarithm};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Values of two evaluations of one formula: each operation is done for both before the next.
/// The second evaluation fills the latency of the first. It needs a smaller reordering window than two evaluations in
/// sequence.
#[derive(Clone, Copy, Debug)]
pub struct Interleaved<R>(pub R, pub R);

impl<R: Split> Neg for Interleaved<R> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0, -self.1)
    }
}

/// An operator between both values, and between them and a constant.
macro_rules! operator {
    ($Trait:ident, $function:ident) => {
        impl<R: Split> $Trait for Interleaved<R> {
            type Output = Self;
            #[inline(always)]
            fn $function(self, other: Self) -> Self {
                Self($Trait::$function(self.0, other.0), $Trait::$function(self.1, other.1))
            }
        }

        impl<R: Split> $Trait<f64> for Interleaved<R> {
            type Output = Self;
            #[inline(always)]
            fn $function(self, other: f64) -> Self {
                $Trait::$function(self, self.of(other))
            }
        }
    };
}

operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);
operator!(Div, div);

impl<R: Split> Real for Interleaved<R> {
    #[inline(always)]
    fn of(self, constant: f64) -> Self {
        Self(self.0.of(constant), self.1.of(constant))
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.sqrt(), self.1.sqrt())
    }

    #[inline(always)]
    fn if_less(self, than: Self, then: Self, otherwise: Self) -> Self {
        Self(self.0.if_less(than.0, then.0, otherwise.0), self.1.if_less(than.1, then.1, otherwise.1))
    }

    #[inline(always)]
    fn all_less(self, than: Self) -> bool {
        // `&` avoids a branch between the two.
        self.0.all_less(than.0) & self.1.all_less(than.1)
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
        Self(self.0.exponential(), self.1.exponential())
    }
}

impl<R: Split> Split for Interleaved<R> {
    #[inline(always)]
    fn split(self) -> (Self, Self) {
        let ((m, k), (of_other, also)) = (self.0.split(), self.1.split());
        (Self(m, of_other), Self(k, also))
    }
}

impl<R: Split> Mat2<Interleaved<R>> {
    /// Interleaves two matrices.
    #[inline(always)]
    pub const fn interleaved(one: Mat2<R>, other: Mat2<R>) -> Self {
        Self {
            m11: Interleaved(one.m11, other.m11),
            m12: Interleaved(one.m12, other.m12),
            m21: Interleaved(one.m21, other.m21),
            m22: Interleaved(one.m22, other.m22),
        }
    }

    /// Both matrices.
    #[inline(always)]
    pub const fn both(self) -> [Mat2<R>; 2] {
        let Self { m11, m12, m21, m22 } = self;
        [
            Mat2 { m11: m11.0, m12: m12.0, m21: m21.0, m22: m22.0 },
            Mat2 { m11: m11.1, m12: m12.1, m21: m21.1, m22: m22.1 },
        ]
    }
}
