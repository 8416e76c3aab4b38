//! Two-level preconditioner: Gauss-Seidel sweeps and an exact coarse solve.

use super::{
    BlockMatrix, Factor,
    block_matrix::{Block, times},
    coarsening::Coarsening,
};

/// Shift of the coarse matrix as a fraction of its diagonal, for groups with few free vertices: far above round-off,
/// far below the least stiffness.
const HEAVIER: f64 = 1e-10;

/// Preconditioner for `A x = r`: one Gauss-Seidel sweep over all vertices, the exact solution for groups of vertices
/// ([`Coarsening`]), and the backward sweep. Sweeps reduce errors that oscillate between neighbours, groups reduce
/// smooth ones; so the number of iterations is nearly independent of size.
#[derive(Clone, Debug)]
pub struct TwoLevel<const D: usize> {
    /// Start of the pairs of each row.
    starts: Vec<u32>,
    coarsening: Coarsening,
    coarse: BlockMatrix<D>,
    factor: Factor<D>,
    /// 1/weight of the coarse numbers.
    weight: Vec<f64>,
    /// Inverses of the diagonal blocks.
    inverse: Vec<Block<D>>,
    left: Vec<f64>,
    small: Vec<f64>,
}

impl<const D: usize> TwoLevel<D> {
    /// Builds the groups. `None` if their factor does not fit in memory.
    pub fn new(matrix: &BlockMatrix<D>) -> Option<Self> {
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
            weight: vec![0.0; D * coarse.vertices()],
            inverse: vec![Block::zeros(); count],
            left: vec![0.0; D * count],
            small: vec![0.0; D * coarse.vertices()],
            coarse,
            factor,
        })
    }

    /// Inverts the diagonal blocks; returns whether they are positive definite.
    pub fn take_diagonal(&mut self, matrix: &BlockMatrix<D>) -> bool {
        for (inverse, block) in self.inverse.iter_mut().zip(matrix.diagonals()) {
            let block = (block + block.transpose()) * 0.5;
            // NaN fails the comparison.
            let is_positive = |minor: f64| minor > 0.0 && minor.is_finite();
            let minor = |size: usize| block.view((0, 0), (size, size)).determinant();
            let Some(found) = block.try_inverse().filter(|_| (1..=D).all(|size| is_positive(minor(size)))) else {
                return false;
            };
            *inverse = found;
        }
        true
    }

    /// Rebuilds the coarse matrix and its factor; returns whether that succeeded.
    pub fn refresh(&mut self, matrix: &BlockMatrix<D>, inverse_weight: &[f64]) -> bool {
        self.coarsening.project(matrix, inverse_weight, &mut self.coarse);
        for (weight, block) in self.weight.as_chunks_mut::<D>().0.iter_mut().zip(self.coarse.diagonals()) {
            *weight = block.diagonal().map(|entry| if entry == 0.0 { 0.0 } else { 1.0 / entry }).into();
        }
        self.factor.factorise(&self.coarse, &self.weight, HEAVIER)
    }

    /// Applies the preconditioner to r.
    pub fn solve(&mut self, matrix: &BlockMatrix<D>, r: &[f64], x: &mut [f64]) {
        let rows = || self.starts.windows(2).map(|ends| ends[0] as usize..ends[1] as usize);
        let (pattern, blocks) = (matrix.pattern(), matrix.blocks());
        let (x, r) = (x.as_chunks_mut::<D>().0, r.as_chunks::<D>().0);
        let left = self.left.as_chunks_mut::<D>().0;
        // Forward sweep from zero: the residual of each vertex then comes from later vertices alone.
        left.fill([0.0; D]);
        for (vertex, row) in rows().enumerate() {
            let (pattern, blocks) = (&pattern[row.clone()], &blocks[row]);
            let own = times(&self.inverse[vertex], &less_products(r[vertex], pattern, blocks, x));
            x[vertex] = own;
            take_products(&own, pattern, blocks, left);
        }
        self.coarsening.gather(left, &mut self.small);
        self.factor.solve(&mut self.small);
        self.coarsening.spread(&self.small, x);
        // Backward sweep.
        for (vertex, row) in rows().enumerate() {
            left[vertex] = less_products(r[vertex], &pattern[row.clone()], &blocks[row], x);
        }
        for (vertex, row) in rows().enumerate().rev() {
            let own = times(&self.inverse[vertex], &left[vertex]);
            x[vertex] = own;
            take_products(&own, &pattern[row.clone()], &blocks[row], left);
        }
    }

    /// Number of blocks of the coarse factor.
    pub fn entries(&self) -> usize {
        self.factor.entries()
    }
}

/// `r - Σ B x` over the blocks of a row.
#[inline(always)]
fn less_products<const D: usize>(
    mut r: [f64; D],
    pattern: &[[u32; 2]],
    blocks: &[Block<D>],
    x: &[[f64; D]],
) -> [f64; D] {
    for ([_, column], block) in pattern.iter().zip(blocks) {
        let product = times(block, &x[*column as usize]);
        r.iter_mut().zip(product).for_each(|(r, product)| *r -= product);
    }
    r
}

/// Subtracts `Bᵀ x` from each column of a row.
#[inline(always)]
fn take_products<const D: usize>(x: &[f64; D], pattern: &[[u32; 2]], blocks: &[Block<D>], from: &mut [[f64; D]]) {
    for ([_, column], block) in pattern.iter().zip(blocks) {
        let product = times(&block.transpose(), x);
        from[*column as usize].iter_mut().zip(product).for_each(|(from, product)| *from -= product);
    }
}
