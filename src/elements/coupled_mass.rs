//! The part of a consistent mass matrix that couples the corners of triangles.

use crate::solvers::{Block, BlockMatrix, Factor, SparseMatrix};
use std::sync::Arc;

/// The part of a consistent mass matrix beside the lumped masses.
///
/// The consistent mass matrix of a linear triangle of mass m, the integral of density times the product of two shape functions, is
/// `m/12 [2 1 1; 1 2 1; 1 1 2]`; lumped, it is m/3 at each corner (Zienkiewicz, Taylor and Zhu, *The Finite Element Method: Its Basis and
/// Fundamentals*, section 16.2). The difference belongs to its edges, so that the matrix of all triangles is
///
/// `M = M_lumped - sum over edges of w (e_a - e_b)(e_a - e_b)ᵀ`,
///
/// with w a twelfth of the mass of the triangles at an edge, and e the unit vectors of its ends. The kinetic energy of a velocity that is
/// linear in space is exact. A quarter of the lumped masses is a lower bound of M, so that frequencies are up to twice as high.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CoupledMass {
    /// Vertices at the ends of each edge, ascending.
    edges: Vec<[u32; 2]>,
    /// w of each edge \[kg\].
    weights: Vec<f64>,
}

impl CoupledMass {
    /// Greatest ratio of the lumped to the consistent mass of any velocity.
    pub const LIGHTEST: f64 = 4.0;

    /// The part of triangles with these corners and masses \[kg\].
    pub fn new(triangles: impl Iterator<Item = ([u32; 3], f64)>) -> Self {
        let mut all: Vec<_> = triangles
            .flat_map(|([a, b, c], mass)| [[a, b], [b, c], [c, a]].map(|[a, b]| ([a.min(b), a.max(b)], mass / 12.0)))
            .collect();
        all.sort_by_key(|(edge, _)| *edge);
        let mut coupled = Self::default();
        for (edge, weight) in all {
            if let Some(sum) = coupled.weights.last_mut().filter(|_| coupled.edges.last() == Some(&edge)) {
                *sum += weight;
            } else {
                coupled.edges.push(edge);
                coupled.weights.push(weight);
            }
        }
        coupled
    }

    /// Adds that of other triangles, whose vertices come after those known so far.
    pub fn append(&mut self, other: &Self) {
        self.edges.extend_from_slice(&other.edges);
        self.weights.extend_from_slice(&other.weights);
    }

    /// Whether all masses are lumped.
    pub const fn is_empty(&self) -> bool {
        self.edges.is_empty()
    }

    /// Edges, each once.
    pub fn edges(&self) -> &[[u32; 2]] {
        &self.edges
    }

    /// The difference of a vector with D numbers a vertex along each edge, with the edge's ends and weight.
    fn along<'a, const D: usize>(
        &'a self,
        z: &'a [[f64; D]],
    ) -> impl Iterator<Item = ([usize; 2], f64, [f64; D])> + 'a {
        self.edges.iter().zip(&self.weights).map(|(ends, weight)| {
            let [a, b] = ends.map(|end| end as usize);
            ([a, b], *weight, std::array::from_fn(|axis| z[a][axis] - z[b][axis]))
        })
    }

    /// Adds `(M - M_lumped) z` to `product`, both flat.
    pub fn add_product(&self, dimension: usize, z: &[f64], product: &mut [f64]) {
        match dimension {
            2 => self.add_product_in::<2>(z, product),
            _ => self.add_product_in::<3>(z, product),
        }
    }

    fn add_product_in<const D: usize>(&self, z: &[f64], product: &mut [f64]) {
        let (z, product) = (z.as_chunks::<D>().0, product.as_chunks_mut::<D>().0);
        for ([a, b], weight, difference) in self.along(z) {
            for (axis, part) in difference.into_iter().enumerate() {
                product[a][axis] -= weight * part;
                product[b][axis] += weight * part;
            }
        }
    }

    /// Adds M - `M_lumped` to a matrix, whose next pairs are [`Self::edges`].
    pub fn add_to(&self, dimension: usize, matrix: &mut dyn SparseMatrix) {
        match dimension {
            2 => self.add_to_blocks::<2>(matrix),
            _ => self.add_to_blocks::<3>(matrix),
        }
    }

    fn add_to_blocks<const D: usize>(&self, matrix: &mut dyn SparseMatrix) {
        let Some(matrix) = matrix.blocks::<D>() else { return };
        for (ends, weight) in self.edges.iter().zip(&self.weights) {
            let block = Block::<D>::from_diagonal_element(*weight);
            for end in ends {
                matrix.diagonal(*end as usize, &-block);
            }
            matrix.off_diagonal(&block);
        }
    }

    /// Kinetic energy beside that of the lumped masses \[J\]; never positive.
    pub fn kinetic_energy(&self, dimension: usize, v: &[f64]) -> f64 {
        let sum = |squares: f64, weight: f64, difference: &[f64]| {
            squares + weight * difference.iter().map(|part| part * part).sum::<f64>()
        };
        let twice = match dimension {
            2 => self.along::<2>(v.as_chunks().0).fold(0.0, |all, (_, weight, part)| sum(all, weight, &part)),
            _ => self.along::<3>(v.as_chunks().0).fold(0.0, |all, (_, weight, part)| sum(all, weight, &part)),
        };
        -0.5 * twice
    }

    /// Angular momentum beside that of the lumped masses [kg m²/s]; in the plane along the third axis alone.
    pub fn angular_momentum(&self, dimension: usize, x: &[f64], v: &[f64]) -> [f64; 3] {
        let across = |of: &[f64], [a, b]: [u32; 2]| {
            [0, 1, 2].map(|axis| {
                let number = |vertex: u32| of[dimension * vertex as usize + axis];
                if axis < dimension { number(a) - number(b) } else { 0.0 }
            })
        };
        let mut sum = [0.0; 3];
        for (ends, weight) in self.edges.iter().zip(&self.weights) {
            let ([x, y, z], [vx, vy, vz]) = (across(x, *ends), across(v, *ends));
            for (sum, part) in sum.iter_mut().zip([y * vz - z * vy, z * vx - x * vz, x * vy - y * vx]) {
                *sum -= weight * part;
            }
        }
        sum
    }
}

/// Solver with the whole mass matrix, whose factors it keeps.
#[derive(Clone, Debug, Default)]
pub struct MassSolver {
    /// Mass matrix of the factors, and 1/mass of each number, zero where nothing may move.
    made_for: Option<(Arc<CoupledMass>, Vec<f64>)>,
    factor: Option<AnyFactor>,
}

#[derive(Clone, Debug)]
enum AnyFactor {
    Plane(Factor<2>),
    Space(Factor<3>),
}

impl MassSolver {
    /// Makes the factors for a mass matrix, unless it has them already.
    pub fn fit(&mut self, dimension: usize, coupled: &Arc<CoupledMass>, [mass, inverse_mass]: [&[f64]; 2]) {
        let is_known = |(known, inverse): &(Arc<CoupledMass>, Vec<f64>)| known == coupled && inverse == inverse_mass;
        if self.made_for.as_ref().is_some_and(is_known) {
            return;
        }
        (self.made_for, self.factor) = (None, None);
        if coupled.is_empty() {
            return;
        }
        self.factor = match dimension {
            2 => factor_of(coupled, [mass, inverse_mass]).map(AnyFactor::Plane),
            _ => factor_of(coupled, [mass, inverse_mass]).map(AnyFactor::Space),
        };
        self.made_for = Some((Arc::clone(coupled), inverse_mass.to_vec()));
    }

    /// Replaces forces f \[N\] by those that give lumped masses the same accelerations, `M_lumped M⁻¹ f`, if not all masses are lumped.
    /// Numbers with 1/mass zero do not accelerate; beside those of [`Self::fit`] they may be all numbers of some triangles that touch.
    pub fn accelerate(&mut self, [mass, inverse_mass]: [&[f64]; 2], force: &mut [f64]) {
        if self.made_for.is_none() {
            return;
        }
        let fixed = || inverse_mass.iter().map(|inverse| *inverse == 0.0);
        force.iter_mut().zip(fixed()).filter(|(_, fixed)| *fixed).for_each(|(force, _)| *force = 0.0);
        match &mut self.factor {
            Some(AnyFactor::Plane(factor)) => factor.solve(force),
            Some(AnyFactor::Space(factor)) => factor.solve(force),
            // Too large for the memory.
            None => force.fill(f64::NAN),
        }
        force.iter_mut().zip(mass).for_each(|(force, mass)| *force *= mass);
    }
}

/// Factors of the whole matrix.
fn factor_of<const D: usize>(coupled: &CoupledMass, [mass, inverse_mass]: [&[f64]; 2]) -> Option<Factor<D>> {
    let mut matrix = BlockMatrix::<D>::new(mass.len() / D, coupled.edges());
    matrix.add_to_diagonal(&|number| mass[number]);
    coupled.add_to(D, &mut matrix);
    let mut factor = Factor::new(&matrix)?;
    factor.factorise(&matrix, inverse_mass, 0.0).then_some(factor)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of two triangles of different mass, in the plane and in space.
    fn square() -> (CoupledMass, Vec<f64>) {
        let triangles = [([0, 1, 2], 3.0), ([2, 3, 0], 1.5)];
        let mut lumped = vec![0.0; 4];
        for (corners, mass) in &triangles {
            for corner in corners {
                lumped[*corner as usize] += mass / 3.0;
            }
        }
        (CoupledMass::new(triangles.into_iter()), lumped)
    }

    fn flat(of: &[f64], dimension: usize) -> Vec<f64> {
        of.iter().flat_map(|mass| std::iter::repeat_n(*mass, dimension)).collect()
    }

    /// The matrix of one triangle of mass m has m/6 on the diagonal and m/12 beside it.
    #[test]
    fn one_triangle_has_the_matrix_of_textbooks() {
        let coupled = CoupledMass::new(std::iter::once(([0, 1, 2], 12.0)));
        for column in 0..3 {
            let mut z = [0.0; 6];
            z[2 * column] = 1.0;
            let mut product: Vec<_> = z.iter().map(|z| 4.0 * z).collect();
            coupled.add_product(2, &z, &mut product);
            for row in 0..3 {
                let wanted = if row == column { 2.0 } else { 1.0 };
                assert_eq!([product[2 * row], product[2 * row + 1]], [wanted, 0.0], "row {row}, column {column}");
            }
        }
    }

    #[test]
    fn accelerations_solve_the_equations_of_the_free_vertices() {
        let (coupled, lumped) = square();
        for dimension in [2, 3] {
            let mass = flat(&lumped, dimension);
            let mut inverse: Vec<_> = mass.iter().map(|mass| 1.0 / mass).collect();
            inverse[..dimension].fill(0.0);
            let force: Vec<_> = (0..4 * dimension as u64).map(crate::random::irregular).collect();
            let (mut same, mut solver) = (force.clone(), MassSolver::default());
            solver.fit(dimension, &Arc::new(coupled.clone()), [&mass, &inverse]);
            solver.accelerate([&mass, &inverse], &mut same);
            let acceleration: Vec<_> = same.iter().zip(&mass).map(|(force, mass)| force / mass).collect();
            assert!(acceleration[..dimension].iter().all(|a| *a == 0.0), "pinned");
            let mut product = same.clone();
            coupled.add_product(dimension, &acceleration, &mut product);
            for (product, force) in product.iter().zip(&force).skip(dimension) {
                assert!((product - force).abs() < 1e-14, "{product} {force}");
            }
        }
    }

    #[test]
    fn lumped_masses_leave_forces_as_they_are() {
        let mut solver = MassSolver::default();
        let mut force = [1.0, f64::NAN];
        solver.fit(2, &Arc::default(), [&[1.0; 2], &[1.0; 2]]);
        solver.accelerate([&[1.0; 2], &[1.0; 2]], &mut force);
        assert!(force[0] == 1.0 && force[1].is_nan());
    }
}
