//! Vectors in space, and the plane of a triangle: the thin QR factorisation F = Q G of its deformation gradient.

use crate::simd::{Mat2, Real};
use std::array;

/// Three coordinates.
pub type Vector<R> = [R; 3];

/// Two columns: edge vectors, F, or P.
pub type Columns<R> = [Vector<R>; 2];

/// Length of q2 before it is normalised, as a fraction of the second column of F, that could be round-off of zero.
const FLAT: f64 = 1e-12;

/// F = Q G, and the normal.
pub struct Frame<R> {
    /// Orthonormal columns.
    pub q: Columns<R>,
    /// G, upper triangular.
    pub g: Mat2<R>,
}

impl<R: Real> Frame<R> {
    /// The thin QR factorisation of F.
    #[inline(always)]
    pub fn of([first, second]: Columns<R>) -> Self {
        let zero = first[0].of(0.0);
        let one = first[0].of(1.0);
        let g11 = dot(first, first).sqrt();
        let scale = one / zero.if_less(g11, g11, one);
        let q1 = [zero.if_less(g11, first[0] * scale, one), first[1] * scale, first[2] * scale];
        let g12 = dot(q1, second);
        let across = minus(second, times(q1, g12));
        let g22 = dot(across, across).sqrt();
        let least = (g12 * g12).sqrt() * FLAT;
        let mut q2 = times(across, one / zero.if_less(g22, g22, one));
        // Seldom, and more work.
        if !least.all_less(g22) {
            // The axis z, or x if q1 is near z, without its part along q1.
            let is_steep = q1[2] * q1[2];
            let half = zero.of(0.5);
            let axis = [half.if_less(is_steep, one, zero), zero, half.if_less(is_steep, zero, one)];
            let other = minus(axis, times(q1, dot(axis, q1)));
            let other = times(other, one / dot(other, other).sqrt());
            q2 = array::from_fn(|axis| least.if_less(g22, q2[axis], other[axis]));
        }
        Self { q: [q1, q2], g: Mat2::new(g11, g12, zero, g22) }
    }

    /// n.
    #[inline(always)]
    pub fn normal(&self) -> Vector<R> {
        let [[a, b, c], [d, e, f]] = self.q;
        [b * f - c * e, c * d - a * f, a * e - b * d]
    }

    /// Qᵀ times two columns.
    #[inline(always)]
    pub fn along(&self, [first, second]: Columns<R>) -> Mat2<R> {
        let [q1, q2] = self.q;
        Mat2::new(dot(q1, first), dot(q1, second), dot(q2, first), dot(q2, second))
    }

    /// Q times a matrix.
    #[inline(always)]
    pub fn in_space(&self, of: Mat2<R>) -> Columns<R> {
        let [q1, q2] = self.q;
        [plus(times(q1, of.m11), times(q2, of.m21)), plus(times(q1, of.m12), times(q2, of.m22))]
    }

    /// S = G⁻¹ P(G); zero along what has no length.
    #[inline(always)]
    pub fn second_stress(&self, stress: Mat2<R>) -> [R; 3] {
        let (zero, one) = (self.g.m11.of(0.0), self.g.m11.of(1.0));
        let inverse = |length: R| zero.if_less(length, one / zero.if_less(length, length, one), zero);
        let (first, second) = (inverse(self.g.m11), inverse(self.g.m22));
        let (s12, s22) = (stress.m21 * second, stress.m22 * second);
        [(stress.m11 - self.g.m12 * s12) * first, s12, s22]
    }
}

/// Scalar product.
#[inline(always)]
pub fn dot<R: Real>(a: Vector<R>, b: Vector<R>) -> R {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// A vector times a number.
#[inline(always)]
pub fn times<R: Real>([x, y, z]: Vector<R>, factor: R) -> Vector<R> {
    [x * factor, y * factor, z * factor]
}

/// Sum.
#[inline(always)]
pub fn plus<R: Real>(a: Vector<R>, b: Vector<R>) -> Vector<R> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// Difference.
#[inline(always)]
pub fn minus<R: Real>(a: Vector<R>, b: Vector<R>) -> Vector<R> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Two columns times a matrix with these entries, column by column.
#[inline(always)]
pub fn product<R: Real>([first, second]: Columns<R>, [m11, m21, m12, m22]: [R; 4]) -> Columns<R> {
    [plus(times(first, m11), times(second, m21)), plus(times(first, m12), times(second, m22))]
}

/// Two columns plus a multiple of others.
#[inline(always)]
pub fn moved<R: Real>([first, second]: Columns<R>, by: Columns<R>, factor: f64) -> Columns<R> {
    let factor = first[0].of(factor);
    [plus(first, times(by[0], factor)), plus(second, times(by[1], factor))]
}

/// Vector product.
#[inline(always)]
pub fn cross<R: Real>([a, b, c]: Vector<R>, [x, y, z]: Vector<R>) -> Vector<R> {
    [b * z - c * y, c * x - a * z, a * y - b * x]
}
