//! The part of an energy density that resists changes of volume.

use super::{Moduli, Parts, nearest_rotation};
use crate::simd::{Mat2, Real};
use std::f64::consts::SQRT_2;

/// The measure m(F) of which the part U(m) of an energy density, all that has the factor lambda, is a function:
/// see [`Material::volumetric`](super::Material::volumetric).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VolumeMeasure {
    /// `tr S = R : F`, with F = R S and R the nearest rotation.
    Trace,
    /// `tr FᵀF`.
    Square,
    /// `J = det F`.
    Determinant,
}

impl VolumeMeasure {
    /// m.
    #[inline(always)]
    pub fn of<R: Real>(self, f: Mat2<R>) -> R {
        match self {
            Self::Trace => nearest_rotation(f).1,
            Self::Square => f.norm_squared(),
            Self::Determinant => f.determinant(),
        }
    }

    /// dm/dF.
    #[inline(always)]
    pub fn gradient<R: Real>(self, f: Mat2<R>) -> Mat2<R> {
        match self {
            Self::Trace => nearest_rotation(f).0,
            Self::Square => f * 2.0,
            Self::Determinant => f.cofactor(),
        }
    }

    /// dm/dF33, where F33 = 1 and in space `m = tr S`, `tr FᵀF` or `det F`.
    #[inline(always)]
    pub fn by_thickness<R: Real>(self, f: Mat2<R>) -> R {
        match self {
            Self::Trace => f.m11.of(1.0),
            Self::Square => f.m11.of(2.0),
            Self::Determinant => f.determinant(),
        }
    }

    /// dm/dp and dm/dq.
    #[inline(always)]
    fn slopes<R: Real>(self, parts: &Parts<R>) -> [R; 2] {
        match self {
            Self::Trace => [parts.if_decided(parts.p.of(SQRT_2)), parts.p.of(0.0)],
            Self::Square => [parts.p * 2.0, parts.q * 2.0],
            Self::Determinant => [parts.p, -parts.q],
        }
    }

    /// The second derivative of m times one factor, plus the square of the first times another.
    #[inline(always)]
    pub fn moduli<R: Real>(self, parts: &Parts<R>, [second, square]: [R; 2]) -> Moduli<R> {
        let [by_p, by_q] = self.slopes(parts);
        let zero = parts.p.of(0.0);
        let [twist, flip, pp, qq] = match self {
            Self::Trace => [parts.if_decided(second * SQRT_2 / parts.p), zero, zero, zero],
            Self::Square => [second * 2.0; 4],
            Self::Determinant => [second, -second, second, -second],
        };
        Moduli { twist, flip, sizes: [pp + by_p * by_p * square, by_p * by_q * square, qq + by_q * by_q * square] }
    }
}
