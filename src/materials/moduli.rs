//! Stiffness of isotropic materials in five numbers, and its projection to other eigenvalues.

use super::Material;
use crate::simd::{Mat2, Real};
use nalgebra::{Matrix2, Matrix4, Vector4};

/// Every F is a turn times a size plus a mirror image times a size, both parts orthogonal to each other:
/// `F = p U + q M`, where U and M have length 1 as vectors of four entries.
///
/// p is (s1 + s2)/sqrt(2) and q is (s1 - s2)/sqrt(2), with s1 and s2 the principal stretches: `tr FᵀF = p² + q²`,
/// `det F = (p² - q²)/2`.
#[derive(Clone, Copy, Debug)]
pub struct Parts<R> {
    /// F itself.
    pub f: Mat2<R>,
    /// Size of the turned part.
    pub p: R,
    /// Size of the mirrored part.
    pub q: R,
    /// The first column of U; the second is this turned by 90 degrees.
    pub turned: [R; 2],
    /// The first column of M; the second is this turned by -90 degrees.
    pub mirrored: [R; 2],
}

/// A turned part that is not larger could be round-off of zero.
const UNDECIDED: f64 = 1e-12;

impl<R: Real> Parts<R> {
    /// Takes F apart.
    #[inline(always)]
    pub fn of(f: Mat2<R>) -> Self {
        let (p, turned) = part(f.m11 + f.m22, f.m21 - f.m12, UNDECIDED);
        let (q, mirrored) = part(f.m11 - f.m22, f.m21 + f.m12, 0.0);
        Self { f, p, q, turned, mirrored }
    }

    /// `then` where the turn is decided, zero where every turn is equally near.
    #[inline(always)]
    pub fn if_decided(&self, then: R) -> R {
        let zero = then.of(0.0);
        then.of(UNDECIDED).if_less(self.p * std::f64::consts::SQRT_2, then, zero)
    }

    /// The moduli of an energy density that depends on `I = tr FᵀF` and `J = det F`, from its derivatives by I and J, and its second ones
    /// by I and by J.
    #[inline(always)]
    pub fn moduli(&self, [by_i, by_j]: [R; 2], [by_ii, by_jj]: [R; 2]) -> Moduli<R> {
        let (twice, four) = (by_i * 2.0, by_ii * 4.0);
        let (twist, flip) = (twice + by_j, twice - by_j);
        let sizes = [
            twist + self.p * self.p * (four + by_jj),
            self.p * self.q * (four - by_jj),
            flip + self.q * self.q * (four + by_jj),
        ];
        Moduli { twist, flip, sizes }
    }
}

/// Length of (x, y) over sqrt(2), and its direction, of length sqrt(1/2); where it is not above `least` it is the first axis.
#[inline(always)]
fn part<R: Real>(x: R, y: R, least: f64) -> (R, [R; 2]) {
    const HALF: f64 = std::f64::consts::FRAC_1_SQRT_2;
    let length = (x * x + y * y).sqrt();
    let (zero, one, least) = (x.of(0.0), x.of(1.0), x.of(least));
    let scale = one / least.if_less(length, length, one) * HALF;
    let direction = [least.if_less(length, x * scale, x.of(HALF)), least.if_less(length, y * scale, zero)];
    (length * HALF, direction)
}

/// dP/dF of an isotropic energy density psi(p, q) \[Pa\]. Its eigenvectors are known from F alone (Smith, de Goes and Kim, *Analytic
/// Eigensystems for Isotropic Distortion Energies*, ACM Transactions on Graphics 38, 2019): to turn either part and keep its
/// size is one, and the two sizes are coupled with each other alone.
#[derive(Clone, Copy, Debug)]
pub struct Moduli<R> {
    /// Turning the turned part: (dpsi/dp)/p.
    pub twist: R,
    /// Turning the mirrored part: (dpsi/dq)/q.
    pub flip: R,
    /// The second derivatives of psi by p p, p q and q q.
    pub sizes: [R; 3],
}

impl<R: Real> Moduli<R> {
    /// All of them times a factor.
    #[inline(always)]
    #[must_use]
    pub fn times(self, factor: R) -> Self {
        let [a, b, c] = self.sizes;
        Self { twist: self.twist * factor, flip: self.flip * factor, sizes: [a * factor, b * factor, c * factor] }
    }

    /// The sum of both.
    #[inline(always)]
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        let ([a, b, c], [d, e, f]) = (self.sizes, other.sizes);
        Self { twist: self.twist + other.twist, flip: self.flip + other.flip, sizes: [a + d, b + e, c + f] }
    }

    /// The change of the stress with a change of F, `dP = (dP/dF) : dF`, from what F consists of.
    #[inline(always)]
    #[must_use]
    pub fn change(&self, parts: &Parts<R>, df: Mat2<R>) -> Mat2<R> {
        let ([c, s], [d, t]) = (parts.turned, parts.mirrored);
        let (twice, turn) = (df.m11 + df.m22, df.m21 - df.m12);
        let (spread, shear) = (df.m11 - df.m22, df.m21 + df.m12);
        let (along_u, along_m) = (c * twice + s * turn, d * spread + t * shear);
        let (around_u, around_m) = ((c * turn - s * twice) * self.twist, (d * shear - t * spread) * self.flip);
        let [pp, pq, qq] = self.sizes;
        let (by_u, by_m) = (along_u * pp + along_m * pq, along_u * pq + along_m * qq);
        // Both parts of dP, by their first columns.
        let (turned, mirrored) =
            ([c * by_u - s * around_u, s * by_u + c * around_u], [d * by_m - t * around_m, t * by_m + d * around_m]);
        Mat2::new(turned[0] + mirrored[0], mirrored[1] - turned[1], turned[1] + mirrored[1], turned[0] - mirrored[0])
    }

    /// The same with negative eigenvalues multiplied by `factor`.
    #[inline(always)]
    #[must_use]
    pub fn with_negative_times(self, factor: f64) -> Self {
        let zero = self.twist.of(0.0);
        let [a, b, c] = self.sizes;
        let (middle, half) = ((a + c) * 0.5, (a - c) * 0.5);
        let radius = (half * half + b * b).sqrt();
        let (least, greatest) = (changed(middle - radius, factor), changed(middle + radius, factor));
        let slope = zero.if_less(radius, (greatest - least) / zero.if_less(radius, radius * 2.0, zero.of(1.0)), zero);
        let centre = (least + greatest) * 0.5;
        let sizes = [centre + slope * half, slope * b, centre - slope * half];
        Self { twist: changed(self.twist, factor), flip: changed(self.flip, factor), sizes }
    }
}

/// An eigenvalue, times a factor if it is negative.
#[inline(always)]
fn changed<R: Real>(eigenvalue: R, factor: f64) -> R {
    eigenvalue.if_less(eigenvalue.of(0.0), eigenvalue * factor, eigenvalue)
}

/// dP/dF (4 x 4) of a material from its moduli, as in [`Material::stiffness`].
pub(super) fn stiffness_of(material: &impl Material, f: &Matrix2<f64>) -> Matrix4<f64> {
    let parts = Parts::of(Mat2::from(f));
    let moduli = material.moduli(&parts);
    let mut stiffness = Matrix4::zeros();
    for (number, mut column) in stiffness.column_iter_mut().enumerate() {
        let mut df = Matrix2::zeros();
        df[number] = 1.0;
        column.copy_from_slice(Matrix2::from(moduli.change(&parts, Mat2::from(&df))).as_slice());
    }
    stiffness
}

/// The stiffness C of an isotropic material at F with its eigenvalues changed (4 x 4, as in
/// [`Material::stiffness`](super::Material::stiffness)). With `|e| e.max(0.0)` that is the positive semidefinite matrix
/// nearest to C.
///
/// The eigenvectors are known from F alone (Smith, de Goes and Kim, *Analytic Eigensystems for Isotropic Distortion
/// Energies*, ACM Transactions on Graphics 38, 2019). In two dimensions they take no singular value decomposition: every F
/// is a turn times a size plus a mirror image times a size, `F = [[a, -b], [b, a]] + [[c, d], [d, -c]]`, and an isotropic
/// energy is a function of `p = |(a, b)|` and `q = |(c, d)|`, half the sum and half the difference of the singular values.
/// So to turn either part and keep its size is an eigenvector (the twist and the flip), and the two sizes are coupled with
/// each other alone, by a 2 x 2 matrix.
pub fn with_eigenvalues(
    stiffness: &Matrix4<f64>,
    f: &Matrix2<f64>,
    change: impl Fn(f64) -> f64 + Copy,
) -> Matrix4<f64> {
    let [cp, sp] = direction(f.m11 + f.m22, f.m21 - f.m12);
    let [cq, sq] = direction(f.m11 - f.m22, f.m21 + f.m12);
    let size = Vector4::new(cp, sp, -sp, cp);
    let twist = Vector4::new(-sp, cp, -cp, -sp);
    let mirrored = Vector4::new(cq, sq, sq, -cq);
    let flip = Vector4::new(-sq, cq, cq, sq);
    let entry = |a: &Vector4<f64>, b: &Vector4<f64>| a.dot(&(stiffness * b));
    // What couples the sizes, [[a, b], [b, c]], with eigenvalues at this distance from their middle.
    let (a, b, c) = (entry(&size, &size), entry(&size, &mirrored), entry(&mirrored, &mirrored));
    let (middle, radius) = (0.5 * (a + c), (0.25 * (a - c) * (a - c) + b * b).sqrt());
    let [least, greatest] = [middle - radius, middle + radius].map(change);
    let slope = if radius > 0.0 { (greatest - least) / (2.0 * radius) } else { 0.0 };
    let changed = |entry: f64| 0.5 * (least + greatest) + slope * (entry - middle);
    let square = |vector: Vector4<f64>| vector * vector.transpose();
    square(twist) * change(entry(&twist, &twist))
        + square(flip) * change(entry(&flip, &flip))
        + square(size) * changed(a)
        + square(mirrored) * changed(c)
        + (size * mirrored.transpose() + mirrored * size.transpose()) * (slope * b)
}

/// The direction of (x, y), of length sqrt(1/2): four such entries make a matrix of length 1. Of zero it is any.
fn direction(x: f64, y: f64) -> [f64; 2] {
    let length = (2.0 * (x * x + y * y)).sqrt();
    if length > 0.0 { [x / length, y / length] } else { [0.5_f64.sqrt(), 0.0] }
}
