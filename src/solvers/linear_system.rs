//! Linear system of one Newton step, with blocks of a size that Newton's method does not know.

use super::{
    BlockMatrix, Equations, Factor, LinearSolver, NewtonCounts, SparseMatrix, Tangent,
    conjugate::{Iterative, SolveOutcome, SolveTolerance},
};

/// A matrix with its direct solver, and an iterative one where it is faster.
pub trait LinearSystem: Send {
    /// Whether it was made for blocks of this size, this number of numbers and these pairs.
    fn is_for(&self, size: usize, numbers: usize, pattern: &[[u32; 2]]) -> bool;

    /// The matrix, set to zero.
    fn cleared(&mut self) -> &mut dyn SparseMatrix;

    /// Resets the iterative solver: a step must not depend on those before.
    fn begin(&mut self);

    /// Solves `A x = -g` iteratively; too slow where there is no iterative solver.
    fn iterate(
        &mut self,
        made: (Tangent, &[f64]),
        vectors: (&[f64], &mut [f64]),
        tolerance: SolveTolerance,
        counts: &mut NewtonCounts,
    ) -> SolveOutcome;

    /// Factorises the matrix with its diagonal increased by a fraction of the greatest entry over its weight, times the
    /// weight. Returns whether it was positive definite.
    fn factorise(&mut self, inverse_weight: &[f64], share: f64) -> bool;

    /// Solves `A x = b` with the last factor; b is overwritten with x.
    fn solve(&mut self, b: &mut [f64]);
}

/// A system of D x D blocks.
struct BlockSystem<const D: usize> {
    matrix: BlockMatrix<D>,
    factor: Factor<D>,
    iterative: Option<Iterative<D>>,
}

impl<const D: usize> BlockSystem<D> {
    /// Analyses a pattern; `None` if the factor does not fit in memory.
    fn analysed(numbers: usize, pattern: &[[u32; 2]], linear_solver: LinearSolver) -> Option<Box<dyn LinearSystem>> {
        let matrix = BlockMatrix::new(numbers / D, pattern);
        let factor = Factor::new(&matrix)?;
        let iterative = match linear_solver {
            LinearSolver::Chosen => Iterative::by_size(&matrix, &factor),
            LinearSolver::Direct => None,
            LinearSolver::Iterative => Iterative::new(&matrix, &factor),
        };
        Some(Box::new(Self { matrix, factor, iterative }))
    }
}

impl<const D: usize> LinearSystem for BlockSystem<D> {
    fn is_for(&self, size: usize, numbers: usize, pattern: &[[u32; 2]]) -> bool {
        size == D && self.matrix.is_for(numbers / D, pattern)
    }

    fn cleared(&mut self) -> &mut dyn SparseMatrix {
        self.matrix.clear();
        &mut self.matrix
    }

    fn begin(&mut self) {
        if let Some(iterative) = &mut self.iterative {
            iterative.begin();
        }
    }

    fn iterate(
        &mut self,
        (tangent, inverse_weight): (Tangent, &[f64]),
        vectors: (&[f64], &mut [f64]),
        tolerance: SolveTolerance,
        counts: &mut NewtonCounts,
    ) -> SolveOutcome {
        let Some(iterative) = &mut self.iterative else { return SolveOutcome::Slow };
        iterative.solve((&mut self.matrix, tangent, inverse_weight), vectors, tolerance, counts)
    }

    fn factorise(&mut self, inverse_weight: &[f64], share: f64) -> bool {
        let diagonal = self.matrix.diagonals().iter().flat_map(|block| block.diagonal().data.0.into_iter().flatten());
        let heaviest = diagonal.zip(inverse_weight).fold(0.0, |most: f64, (entry, inverse)| most.max(entry * inverse));
        self.factor.factorise(&self.matrix, inverse_weight, share * heaviest)
    }

    fn solve(&mut self, b: &mut [f64]) {
        self.factor.solve(b);
    }
}

/// Builds the system for the sparsity pattern of the equations, or keeps the one before if the pattern is the same;
/// `None` if it does not fit in memory, or there are no blocks of that size.
pub fn analyse(
    before: Option<Box<dyn LinearSystem>>,
    equations: &dyn Equations,
    numbers: usize,
    linear_solver: LinearSolver,
) -> Option<Box<dyn LinearSystem>> {
    let mut pattern = Vec::new();
    equations.sparsity_pattern(&mut |a, b| pattern.push([a, b]));
    let size = equations.block_size();
    if let Some(before) = before.filter(|system| system.is_for(size, numbers, &pattern)) {
        return Some(before);
    }
    match size {
        1 => BlockSystem::<1>::analysed(numbers, &pattern, linear_solver),
        2 => BlockSystem::<2>::analysed(numbers, &pattern, linear_solver),
        3 => BlockSystem::<3>::analysed(numbers, &pattern, linear_solver),
        _ => None,
    }
}
