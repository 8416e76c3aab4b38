//! The eigenvalues of stiffnesses: known from the deformation gradient, and changed without a numerical decomposition.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a failing test should panic")]

use gingerbread::{
    materials::{Lame, Material, Model, Parts, Visitor, with_eigenvalues},
    simd::Mat2,
};
use nalgebra::{Matrix2, Matrix4, SymmetricEigen, Vector4};

/// Gradients of all kinds: at rest, turned, sheared, flat, at a point, mirrored, and a regular sample of the rest.
fn gradients() -> Vec<Matrix2<f64>> {
    let mut all = vec![
        Matrix2::identity(),
        Matrix2::new(0.0, -1.0, 1.0, 0.0),
        Matrix2::new(2.0, 0.0, 0.0, 2.0),
        Matrix2::new(1.0, 0.0, 0.0, 0.0),
        Matrix2::zeros(),
        Matrix2::new(-1.0, 0.0, 0.0, 1.0),
        Matrix2::new(0.6, 0.8, 0.8, -0.6),
    ];
    let entries = [-1.3, -0.4, 0.7, 1.1];
    for a in entries {
        for b in entries {
            for c in entries {
                all.extend(entries.map(|d| Matrix2::new(a, b, c, d)));
            }
        }
    }
    all
}

struct Stiffness<'a>(&'a Matrix2<f64>);

impl Visitor for Stiffness<'_> {
    type Output = Matrix4<f64>;
    fn visit<M: Material>(self, material: &M) -> Matrix4<f64> {
        material.stiffness(self.0)
    }
}

/// Whether a model may have no energy at a gradient: only one with a barrier, and only where a triangle is flat or
/// inverted.
fn is_undefined(model: Model, f: &Matrix2<f64>) -> bool {
    struct Barrier;
    impl Visitor for Barrier {
        type Output = bool;
        fn visit<M: Material>(self, _: &M) -> bool {
            M::BARRIER
        }
    }
    model.visit(Lame { mu: 1.0, lambda: 1.0 }, Barrier) && f.determinant() < 1e-12
}

/// What `change` makes of a symmetric matrix, by a numerical decomposition.
fn decomposed(stiffness: &Matrix4<f64>, change: fn(f64) -> f64) -> Matrix4<f64> {
    let SymmetricEigen { eigenvectors, eigenvalues } = stiffness.symmetric_eigen();
    eigenvectors * Matrix4::from_diagonal(&eigenvalues.map(change)) * eigenvectors.transpose()
}

#[test]
fn stiffness_eigenvectors_follow_from_the_gradient() {
    let lames = [Lame { mu: 1.0, lambda: 1.5 }, Lame { mu: 1.0, lambda: 0.0 }, Lame { mu: 1.0, lambda: 50.0 }];
    let changes: [fn(f64) -> f64; 3] = [|e| e, |e| e.max(0.0), f64::abs];
    let mut negative = 0;
    for model in Model::ALL {
        for (lame, f) in lames.into_iter().flat_map(|lame| gradients().into_iter().map(move |f| (lame, f))) {
            let stiffness = model.visit(lame, Stiffness(&f));
            if !stiffness.iter().all(|entry| entry.is_finite()) {
                // A logarithm of stretches has no value there.
                assert!(
                    is_undefined(*model, &f),
                    "{} at {f}: a model without barrier is defined everywhere",
                    model.title()
                );
                continue;
            }
            negative += usize::from(stiffness.symmetric_eigenvalues().min() < -0.1);
            for change in changes {
                let difference = with_eigenvalues(&stiffness, &f, change) - decomposed(&stiffness, change);
                assert!(difference.norm() <= 1e-12 * stiffness.norm(), "{model:?} {lame:?} at {f}: {difference}");
            }
        }
    }
    assert!(negative > 500, "the sample must have something to change, had {negative}");
}

/// What becomes of an eigenvalue.
type Change = fn(f64) -> f64;

/// The stiffness that five moduli stand for, with its negative eigenvalues multiplied by a factor.
struct FromModuli<'a>(&'a Matrix2<f64>, f64);

impl Visitor for FromModuli<'_> {
    type Output = Matrix4<f64>;
    fn visit<M: Material>(self, material: &M) -> Matrix4<f64> {
        let parts = Parts::of(Mat2::from(self.0));
        let moduli = material.moduli(&parts).with_negative_times(self.1);
        let ([c, s], [d, t]) = (parts.turned, parts.mirrored);
        let (size, twist) = (Vector4::new(c, s, -s, c), Vector4::new(-s, c, -c, -s));
        let (mirrored, flip) = (Vector4::new(d, t, t, -d), Vector4::new(-t, d, d, t));
        let whole = size * parts.p + mirrored * parts.q;
        assert!((whole - Vector4::from_column_slice(self.0.as_slice())).norm() < 1e-14, "{}", self.0);
        let [pp, pq, qq] = moduli.sizes;
        let across = size * mirrored.transpose();
        twist * twist.transpose() * moduli.twist
            + flip * flip.transpose() * moduli.flip
            + size * size.transpose() * pp
            + mirrored * mirrored.transpose() * qq
            + (across + across.transpose()) * pq
    }
}

/// They also give its positive part and its absolute value.
#[test]
fn five_moduli_reproduce_every_stiffness() {
    let lames = [Lame { mu: 1.0, lambda: 1.5 }, Lame { mu: 1.0, lambda: 0.0 }, Lame { mu: 1.0, lambda: 50.0 }];
    let near = [1e-3, 1e-6, 1e-9].map(|shear| Matrix2::new(1.0, shear, 0.0, 1.0));
    let changes: [(f64, Change); 3] = [(1.0, |e| e), (0.0, |e| e.max(0.0)), (-1.0, f64::abs)];
    for model in Model::ALL {
        for (lame, f) in lames.into_iter().flat_map(|lame| gradients().into_iter().chain(near).map(move |f| (lame, f)))
        {
            let stiffness = model.visit(lame, Stiffness(&f));
            if !stiffness.iter().all(|entry| entry.is_finite()) {
                assert!(
                    is_undefined(*model, &f),
                    "{} at {f}: a model without barrier is defined everywhere",
                    model.title()
                );
                assert!(!model.visit(lame, FromModuli(&f, 1.0)).iter().all(|entry| entry.is_finite()));
                continue;
            }
            for (factor, change) in changes {
                let difference = model.visit(lame, FromModuli(&f, factor)) - decomposed(&stiffness, change);
                assert!(difference.norm() <= 1e-12 * stiffness.norm(), "{model:?} {lame:?} at {f}: {difference}");
            }
        }
    }
}
