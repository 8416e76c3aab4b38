//! The stiffness of triangles as 2 x 2 blocks between their corners.

use super::{Triangles, triangle::Rest};
use crate::{
    materials::{Material, Visitor, with_eigenvalues},
    solvers::{BlockMatrix, Tangent, Weights},
};
use nalgebra::{Matrix2, Matrix4};

impl Triangles {
    /// Names the three couples of corners of each triangle.
    pub(crate) fn name_couples(&self, add: &mut dyn FnMut(u32, u32)) {
        for &[a, b, c] in self.corners() {
            add(a, b);
            add(a, c);
            add(b, c);
        }
    }

    /// Adds the elastic stiffness, geometric part included: the second derivative of the energy, or what is positive of it.
    pub(crate) fn add_elastic_tangent(&self, x: &[f64], weights: Weights, matrix: &mut BlockMatrix) {
        self.model().visit(self.lame(), Elastic { of: self, x, weights, matrix });
    }

    /// Adds blocks for every triangle from `stiffness`, the second derivative of an isotropic energy density by F (4 x 4) [Pa], or
    /// what is asked for of it.
    pub(crate) fn add_energy_tangent(
        &self,
        x: &[f64],
        weights: Weights,
        matrix: &mut BlockMatrix,
        stiffness: impl Fn(&Matrix2<f64>) -> Matrix4<f64>,
    ) {
        let weight = weights.position;
        match weights.tangent {
            Tangent::Exact => self.add_tangent(x, weight, matrix, |_, f| stiffness(f)),
            Tangent::Definite => self.add_tangent(x, weight, matrix, |_, f| {
                with_eigenvalues(&stiffness(f), f, |eigenvalue| eigenvalue.max(0.0))
            }),
            Tangent::Absolute => {
                self.add_tangent(x, weight, matrix, |_, f| with_eigenvalues(&stiffness(f), f, f64::abs));
            }
        }
    }

    /// Adds blocks for every triangle from `tangent`, the derivative of its first Piola-Kirchhoff stress by F or dF/dt
    /// (4 x 4, entries column by column, symmetric) [Pa or Pa s], times `weight`.
    #[inline]
    pub(crate) fn add_tangent(
        &self,
        x: &[f64],
        weight: f64,
        matrix: &mut BlockMatrix,
        tangent: impl Fn(usize, &Matrix2<f64>) -> Matrix4<f64>,
    ) {
        for (number, (&triangle, (f, _))) in self.corners().iter().zip(self.gradients(x)).enumerate() {
            let [one, two, across] = self.rest(number).corner_blocks(&tangent(number, &f), weight);
            let turned = across.transpose();
            let (to_one, to_two) = (-one - turned, -across - two);
            // The rows of the first corner are minus the sum of the other two, as nothing depends on where a triangle is.
            let [a, b, c] = triangle.map(|corner| corner as usize);
            matrix.diagonal(a, &(-to_one - to_two));
            matrix.diagonal(b, &one);
            matrix.diagonal(c, &two);
            matrix.couple(&to_one);
            matrix.couple(&to_two);
            matrix.couple(&across);
        }
    }
}

impl Rest {
    /// Blocks of the second corner with itself, of the third with itself, and of the second with the third:
    /// `K_ab[i, k] = weight A sum over J, L of g_a[J] C[iJ, kL] g_b[L]`, with `g_a` the gradient of a corner's shape
    /// function, a row of D0⁻¹ (Bonet and Wood, *Nonlinear Continuum Mechanics for Finite Element Analysis*, section 9.4).
    #[inline]
    fn corner_blocks(&self, tangent: &Matrix4<f64>, weight: f64) -> [Matrix2<f64>; 3] {
        let scale = weight * self.area;
        let gradient = |corner: usize| [self.inverse[(corner, 0)], self.inverse[(corner, 1)]];
        let (g1, g2) = (gradient(0), gradient(1));
        let quarter = |row: usize, column: usize| tangent.fixed_view::<2, 2>(row, column).into_owned();
        let (c00, c01, c11) = (quarter(0, 0), quarter(0, 2), quarter(2, 2));
        let c10 = c01.transpose();
        let block = |a: [f64; 2], b: [f64; 2]| {
            (c00 * (a[0] * b[0]) + c01 * (a[0] * b[1]) + c10 * (a[1] * b[0]) + c11 * (a[1] * b[1])) * scale
        };
        [block(g1, g1), block(g2, g2), block(g1, g2)]
    }
}

struct Elastic<'a> {
    of: &'a Triangles,
    x: &'a [f64],
    weights: Weights,
    matrix: &'a mut BlockMatrix,
}

impl Visitor for Elastic<'_> {
    type Output = ();
    fn visit<M: Material>(self, material: &M) {
        self.of.add_energy_tangent(self.x, self.weights, self.matrix, |f| material.stiffness(f));
    }
}
