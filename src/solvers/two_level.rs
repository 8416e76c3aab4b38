//! Two-level preconditioner: Gauss-Seidel sweeps and an exact coarse solve.

use super::{BlockMatrix, Factor, coarsening::Coarsening};
use nalgebra::Matrix2;

/// Shift of the coarse matrix as a fraction of its diagonal, for groups with few free vertices: far above round-off,
/// far below the least stiffness.
const HEAVIER: f64 = 1e-10;

/// Preconditioner for `A x = r`: one Gauss-Seidel sweep over all vertices, the exact solution for groups of vertices
/// ([`Coarsening`]), and the backward sweep. Sweeps reduce errors that oscillate between neighbours, groups reduce
/// smooth ones; so the number of iterations is nearly independent of size.
#[derive(Clone, Debug)]
pub struct TwoLevel {
    /// Start of the pairs of each row.
    starts: Vec<u32>,
    coarsening: Coarsening,
    coarse: BlockMatrix,
    factor: Factor,
    /// 1/weight of the coarse numbers.
    weight: Vec<f64>,
    /// Inverses of the diagonal blocks.
    inverse: Vec<Matrix2<f64>>,
    left: Vec<f64>,
    small: Vec<f64>,
}

impl TwoLevel {
    /// Builds the groups. `None` if their factor does not fit in memory.
    pub fn new(matrix: &BlockMatrix) -> Option<Self> {
        let count = matrix.vertices();
        let coarsening = Coarsening::new(matrix);
        let coarse = coarsening.matrix(matrix);
        let factor = Factor::new(&coarse)?;
        let mut starts = vec![0; count + 1];
        matrix.pattern().iter().for_each(|[row, _]| starts[*row as usize + 1] += 1);
        for row in 0..count {
            starts[row + 1] += starts[row];
        }
        Some(Self {
            starts,
            coarsening,
            weight: vec![0.0; 2 * coarse.vertices()],
            inverse: vec![Matrix2::zeros(); count],
            left: vec![0.0; 2 * count],
            small: vec![0.0; 2 * coarse.vertices()],
            coarse,
            factor,
        })
    }

    /// Inverts the diagonal blocks; returns whether they are positive definite.
    pub fn take_diagonal(&mut self, matrix: &BlockMatrix) -> bool {
        for (inverse, block) in self.inverse.iter_mut().zip(matrix.diagonals()) {
            let off = 0.5 * (block.m12 + block.m21);
            let determinant = block.m11 * block.m22 - off * off;
            // NaN fails the comparison.
            if !(block.m11 > 0.0 && determinant > 0.0 && determinant.is_finite()) {
                return false;
            }
            *inverse = Matrix2::new(block.m22, -off, -off, block.m11) / determinant;
        }
        true
    }

    /// Rebuilds the coarse matrix and its factor; returns whether that succeeded.
    pub fn refresh(&mut self, matrix: &BlockMatrix, inverse_weight: &[f64]) -> bool {
        self.coarsening.project(matrix, inverse_weight, &mut self.coarse);
        for (weight, block) in self.weight.as_chunks_mut::<2>().0.iter_mut().zip(self.coarse.diagonals()) {
            *weight = [block.m11, block.m22].map(|entry| if entry == 0.0 { 0.0 } else { 1.0 / entry });
        }
        self.factor.factorise(&self.coarse, &self.weight, HEAVIER)
    }

    /// Applies the preconditioner to r.
    pub fn solve(&mut self, matrix: &BlockMatrix, r: &[f64], x: &mut [f64]) {
        let rows = || self.starts.windows(2).map(|ends| ends[0] as usize..ends[1] as usize);
        let (pattern, blocks) = (matrix.pattern(), matrix.blocks());
        let (x, r) = (x.as_chunks_mut::<2>().0, r.as_chunks::<2>().0);
        let left = self.left.as_chunks_mut::<2>().0;
        // Forward sweep from zero: the residual of each vertex then comes from later vertices alone.
        left.fill([0.0; 2]);
        for (vertex, row) in rows().enumerate() {
            let (pattern, blocks) = (&pattern[row.clone()], &blocks[row]);
            let own = times(&self.inverse[vertex], less_products(r[vertex], pattern, blocks, x));
            x[vertex] = own;
            take_products(own, pattern, blocks, left);
        }
        self.coarsening.gather(left.as_flattened(), &mut self.small);
        self.factor.solve(&mut self.small);
        self.coarsening.spread(&self.small, x.as_flattened_mut());
        // Backward sweep.
        for (vertex, row) in rows().enumerate() {
            left[vertex] = less_products(r[vertex], &pattern[row.clone()], &blocks[row], x);
        }
        for (vertex, row) in rows().enumerate().rev() {
            let own = times(&self.inverse[vertex], left[vertex]);
            x[vertex] = own;
            take_products(own, &pattern[row.clone()], &blocks[row], left);
        }
    }

    /// Number of blocks of the coarse factor.
    pub fn entries(&self) -> usize {
        self.factor.entries()
    }
}

#[inline(always)]
fn times(block: &Matrix2<f64>, [x, y]: [f64; 2]) -> [f64; 2] {
    [block.m11 * x + block.m12 * y, block.m21 * x + block.m22 * y]
}

/// `r - Σ B x` over the blocks of a row.
#[inline(always)]
fn less_products([mut a, mut b]: [f64; 2], pattern: &[[u32; 2]], blocks: &[Matrix2<f64>], x: &[[f64; 2]]) -> [f64; 2] {
    for ([_, column], block) in pattern.iter().zip(blocks) {
        let product = times(block, x[*column as usize]);
        a -= product[0];
        b -= product[1];
    }
    [a, b]
}

/// Subtracts `Bᵀ x` from each column of a row.
#[inline(always)]
fn take_products([x, y]: [f64; 2], pattern: &[[u32; 2]], blocks: &[Matrix2<f64>], from: &mut [[f64; 2]]) {
    for ([_, column], block) in pattern.iter().zip(blocks) {
        let from = &mut from[*column as usize];
        from[0] -= block.m11 * x + block.m21 * y;
        from[1] -= block.m12 * x + block.m22 * y;
    }
}
