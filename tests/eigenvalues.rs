//! The eigenvalues of stiffnesses: known from the deformation gradient, and changed without a numerical decomposition.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a failing test should panic")]

use gingerbread::materials::{Lame, Material, Model, Visitor, with_eigenvalues};
use nalgebra::{Matrix2, Matrix4, SymmetricEigen};

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

/// What `change` makes of a symmetric matrix, by a numerical decomposition.
fn decomposed(stiffness: &Matrix4<f64>, change: fn(f64) -> f64) -> Matrix4<f64> {
    let SymmetricEigen { eigenvectors, eigenvalues } = stiffness.symmetric_eigen();
    eigenvectors * Matrix4::from_diagonal(&eigenvalues.map(change)) * eigenvectors.transpose()
}

#[test]
fn the_eigenvectors_of_every_stiffness_are_known_from_the_gradient_alone() {
    let lames = [Lame { mu: 1.0, lambda: 1.5 }, Lame { mu: 1.0, lambda: 0.0 }, Lame { mu: 1.0, lambda: 50.0 }];
    let changes: [fn(f64) -> f64; 3] = [|e| e, |e| e.max(0.0), f64::abs];
    let mut negative = 0;
    for model in Model::ALL {
        for (lame, f) in lames.into_iter().flat_map(|lame| gradients().into_iter().map(move |f| (lame, f))) {
            let stiffness = model.visit(lame, Stiffness(&f));
            if !stiffness.iter().all(|entry| entry.is_finite()) {
                // Hencky's logarithm has no value there.
                assert!(*model == Model::Hencky && f.determinant() <= 0.0, "{model:?} at {f}");
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
