//! 2 x 2 matrices of SIMD vectors.

use super::Real;
use nalgebra::Matrix2;
use std::ops::{Add, Mul, Sub};

/// A 2 x 2 matrix of numbers or lanes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mat2<R> {
    /// First row, first column.
    pub m11: R,
    /// First row, second column.
    pub m12: R,
    /// Second row, first column.
    pub m21: R,
    /// Second row, second column.
    pub m22: R,
}

impl<R: Real> Mat2<R> {
    /// Row by row.
    #[inline(always)]
    pub const fn new(m11: R, m12: R, m21: R, m22: R) -> Self {
        Self { m11, m12, m21, m22 }
    }

    /// Identity, with as many lanes as `like`.
    #[inline(always)]
    #[must_use]
    pub fn identity(like: R) -> Self {
        let (one, zero) = (like.of(1.0), like.of(0.0));
        Self::new(one, zero, zero, one)
    }

    /// The transpose.
    #[inline(always)]
    #[must_use]
    pub fn transpose(self) -> Self {
        Self::new(self.m11, self.m21, self.m12, self.m22)
    }

    /// The matrix product `self other`.
    #[inline(always)]
    #[must_use]
    pub fn times(self, other: Self) -> Self {
        Self::new(
            self.m11 * other.m11 + self.m12 * other.m21,
            self.m11 * other.m12 + self.m12 * other.m22,
            self.m21 * other.m11 + self.m22 * other.m21,
            self.m21 * other.m12 + self.m22 * other.m22,
        )
    }

    /// The determinant.
    #[inline(always)]
    pub fn determinant(self) -> R {
        self.m11 * self.m22 - self.m12 * self.m21
    }

    /// The sum of the diagonal.
    #[inline(always)]
    pub fn trace(self) -> R {
        self.m11 + self.m22
    }

    /// The cofactor matrix, which is the derivative of the determinant: det(F) F⁻ᵀ.
    #[inline(always)]
    #[must_use]
    pub fn cofactor(self) -> Self {
        Self::new(self.m22, -self.m21, -self.m12, self.m11)
    }

    /// The sum of the products of entries, `self : other`.
    #[inline(always)]
    pub fn dot(self, other: Self) -> R {
        self.m11 * other.m11 + self.m21 * other.m21 + self.m12 * other.m12 + self.m22 * other.m22
    }

    /// The sum of the squares of the entries, `tr FᵀF`.
    #[inline(always)]
    pub fn norm_squared(self) -> R {
        self.dot(self)
    }
}

impl<R: Real> Add for Mat2<R> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::new(self.m11 + other.m11, self.m12 + other.m12, self.m21 + other.m21, self.m22 + other.m22)
    }
}

impl<R: Real> Sub for Mat2<R> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self::new(self.m11 - other.m11, self.m12 - other.m12, self.m21 - other.m21, self.m22 - other.m22)
    }
}

/// Product of every entry with a factor, a constant or one value per lane.
impl<R: Real + Mul<K, Output = R>, K: Copy> Mul<K> for Mat2<R> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: K) -> Self {
        Self::new(self.m11 * factor, self.m12 * factor, self.m21 * factor, self.m22 * factor)
    }
}

impl From<&Matrix2<f64>> for Mat2<f64> {
    #[inline(always)]
    fn from(of: &Matrix2<f64>) -> Self {
        Self::new(of.m11, of.m12, of.m21, of.m22)
    }
}

impl From<Mat2<f64>> for Matrix2<f64> {
    #[inline(always)]
    fn from(of: Mat2<f64>) -> Self {
        Self::new(of.m11, of.m12, of.m21, of.m22)
    }
}
