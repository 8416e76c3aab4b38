//! Stiffness with its eigenvalues projected to be positive.

use nalgebra::{Matrix2, Matrix4, Vector4};

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
