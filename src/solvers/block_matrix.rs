//! Symmetric sparse matrix of square blocks.

use nalgebra::SMatrix;
use std::any::Any;

/// Factors of the entries of a stiffness matrix that is added to a [`BlockMatrix`]: an implicit step with `x = x^ + ax
/// z, v = v^ + av z` needs `M + ax (-df/dx) + av (-df/dv)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    /// Factor of `-df/dx`, ax \[s²\].
    pub position: f64,
    /// Factor of `-df/dv`, av \[s\].
    pub velocity: f64,
    /// Kind of derivative.
    pub tangent: Tangent,
}

/// Derivative of the forces: the true one, or one with eigenvalues changed element by element, so that every Newton
/// step is a descent direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tangent {
    /// The true one, with which Newton's method converges quadratically.
    Exact,
    /// Negative eigenvalues become zero: the nearest positive semidefinite matrix (Teran et al., *Robust quasistatic
    /// finite elements and flesh simulation*, SCA 2005). Where an eigenvalue is zero, the mass alone bounds the step.
    Definite,
    /// Absolute eigenvalues: along a negative eigenvalue lambda the step is the residual over |lambda| (Chen et al.,
    /// *Stabler Neo-Hookean Simulation: Absolute Eigenvalue Filtering for Projected Newton*, SIGGRAPH 2024).
    Absolute,
}

impl Tangent {
    /// Factor of negative eigenvalues, unless they stay.
    pub const fn negative_factor(self) -> Option<f64> {
        match self {
            Self::Exact => None,
            Self::Definite => Some(0.0),
            Self::Absolute => Some(-1.0),
        }
    }
}

/// A symmetric sparse matrix of square blocks, for callers that see flat vectors alone.
///
/// Code that adds blocks names their size: see [`blocks`](#method.blocks).
pub trait SparseMatrix {
    /// Adds a value to every number of the diagonal.
    fn add_to_diagonal(&mut self, value: &dyn Fn(usize) -> f64);

    /// The matrix with its size of blocks.
    fn as_any(&mut self) -> &mut dyn Any;
}

impl dyn SparseMatrix + '_ {
    /// The matrix as one of D x D blocks; `None` if its blocks have another size.
    pub fn blocks<const D: usize>(&mut self) -> Option<&mut BlockMatrix<D>> {
        self.as_any().downcast_mut()
    }
}

impl<const D: usize> SparseMatrix for BlockMatrix<D> {
    fn add_to_diagonal(&mut self, value: &dyn Fn(usize) -> f64) {
        for (vertex, block) in self.diagonal.iter_mut().enumerate() {
            for axis in 0..D {
                block[(axis, axis)] += value(D * vertex + axis);
            }
        }
    }

    fn as_any(&mut self) -> &mut dyn Any {
        self
    }
}

/// A block.
pub type Block<const D: usize> = SMatrix<f64, D, D>;

/// A symmetric sparse matrix of D x D blocks, one block row a vertex.
///
/// The sparsity pattern is fixed at construction, by a list of vertex pairs; repeated pairs share a block. Assembly
/// follows the same list in the same order: the n-th [`Self::off_diagonal`] after [`Self::clear`] adds to the block of
/// the n-th pair, without a search. Many elements at once are added [by rows](Self::add_by_rows), on several threads. Each block is stored once, with the lower of its two vertices as the column.
#[derive(Clone, Debug, Default)]
pub struct BlockMatrix<const D: usize> {
    pub(super) diagonal: Vec<Block<D>>,
    /// One for each different pair, in the order of `pattern`.
    pub(super) blocks: Vec<Block<D>>,
    /// The different pairs, (row, column) with row > column, sorted by row.
    pub(super) pattern: Vec<[u32; 2]>,
    /// For each pair of the list the number of its block, doubled; odd where the pair has the lower vertex first.
    pub(super) slots: Vec<u32>,
    pub(super) cursor: usize,
}

impl<const D: usize> BlockMatrix<D> {
    /// A zero matrix for a number of vertices and a list of pairs. A pair of a vertex with itself belongs to the
    /// diagonal.
    pub fn new(vertices: usize, listed: &[[u32; 2]]) -> Self {
        let ordered = |[a, b]: [u32; 2]| [a.max(b), a.min(b)];
        let mut pattern: Vec<_> = listed.iter().map(|pair| ordered(*pair)).collect();
        pattern.sort_unstable();
        pattern.dedup();
        let slot = |pair: &[u32; 2]| {
            let block = pattern.partition_point(|other| *other < ordered(*pair)) as u32;
            2 * block + u32::from(pair[0] < pair[1])
        };
        let slots = listed.iter().map(slot).collect();
        let (diagonal, blocks) = (vec![Block::zeros(); vertices], vec![Block::zeros(); pattern.len()]);
        Self { diagonal, blocks, pattern, slots, cursor: 0 }
    }

    /// Whether it was made for this number of vertices and this list.
    pub fn is_for(&self, vertices: usize, listed: &[[u32; 2]]) -> bool {
        let named = self.slots.iter().map(|slot| {
            let [row, column] = self.pattern[(slot >> 1) as usize];
            if slot & 1 == 0 { [row, column] } else { [column, row] }
        });
        self.vertices() == vertices && named.eq(listed.iter().copied())
    }

    /// Sets every entry to zero and returns to the first pair.
    pub fn clear(&mut self) {
        self.diagonal.fill(Block::zeros());
        self.blocks.fill(Block::zeros());
        self.cursor = 0;
    }

    /// Adds to the block of a vertex with itself, which must be symmetric.
    #[inline]
    pub fn diagonal(&mut self, vertex: usize, block: &Block<D>) {
        self.diagonal[vertex] += block;
    }

    /// Adds to the block of the next pair (a, b) of the list: the derivative of a by b, and by symmetry the transpose.
    /// Extra blocks are ignored, which [`Self::is_full`] tells.
    #[inline]
    pub fn off_diagonal(&mut self, block: &Block<D>) {
        if let Some(slot) = self.slots.get(self.cursor) {
            let into = &mut self.blocks[(slot >> 1) as usize];
            if slot & 1 == 0 {
                *into += block;
            } else {
                *into += block.transpose();
            }
        }
        self.cursor += 1;
    }

    /// Replaces rows and columns of numbers with 1/weight zero by those of the identity.
    pub fn fix(&mut self, inverse_weight: &[f64]) {
        if inverse_weight.iter().all(|weight| *weight > 0.0) {
            return;
        }
        let weights = inverse_weight.as_chunks::<D>().0;
        for (block, weight) in self.diagonal.iter_mut().zip(weights) {
            for axis in (0..D).filter(|axis| weight[*axis] == 0.0) {
                block.fill_row(axis, 0.0);
                block.fill_column(axis, 0.0);
                block[(axis, axis)] = 1.0;
            }
        }
        for ([row, column], block) in self.pattern.iter().zip(&mut self.blocks) {
            let [row, column] = [row, column].map(|vertex| weights[*vertex as usize]);
            (0..D).filter(|axis| row[*axis] == 0.0).for_each(|axis| block.fill_row(axis, 0.0));
            (0..D).filter(|axis| column[*axis] == 0.0).for_each(|axis| block.fill_column(axis, 0.0));
        }
    }

    /// Whether as many pairs were added as were listed.
    pub fn is_full(&self) -> bool {
        self.cursor == self.slots.len()
    }

    /// Number of vertices.
    pub fn vertices(&self) -> usize {
        self.diagonal.len()
    }

    /// The diagonal blocks.
    pub fn diagonals(&self) -> &[Block<D>] {
        &self.diagonal
    }

    /// The off-diagonal blocks, each once.
    pub fn blocks(&self) -> &[Block<D>] {
        &self.blocks
    }

    /// Row and column of each off-diagonal block: row > column, in ascending order.
    pub fn pattern(&self) -> &[[u32; 2]] {
        &self.pattern
    }

    /// Adds the product with a flat vector to another one.
    pub fn add_product(&self, vector: &[f64], product: &mut [f64]) {
        let (vector, product) = (vector.as_chunks::<D>().0, product.as_chunks_mut::<D>().0);
        let mut add = |row: usize, block: &Block<D>, column: usize| {
            let of_block = times(block, &vector[column]);
            product[row].iter_mut().zip(of_block).for_each(|(sum, value)| *sum += value);
        };
        for (vertex, block) in self.diagonal.iter().enumerate() {
            add(vertex, block, vertex);
        }
        for ([row, column], block) in self.pattern.iter().zip(&self.blocks) {
            add(*row as usize, block, *column as usize);
            add(*column as usize, &block.transpose(), *row as usize);
        }
    }
}

impl BlockMatrix<2> {
    /// Transforms the matrix to local axes, given by the first axis of each vertex, flat: `Q_aᵀ B_ab Q_b`.
    pub fn turn(&mut self, axes: &[f64]) {
        let turned = |vertex: usize| axes[2 * vertex..2 * vertex + 2] != [1.0, 0.0];
        let q = |vertex: usize| {
            let (c, s) = (axes[2 * vertex], axes[2 * vertex + 1]);
            Block::<2>::new(c, -s, s, c)
        };
        for (vertex, block) in self.diagonal.iter_mut().enumerate().filter(|(vertex, _)| turned(*vertex)) {
            *block = q(vertex).transpose() * *block * q(vertex);
        }
        for ([row, column], block) in self.pattern.iter().zip(&mut self.blocks) {
            let (row, column) = (*row as usize, *column as usize);
            if turned(row) || turned(column) {
                *block = q(row).transpose() * *block * q(column);
            }
        }
    }
}

/// Product of a block and a vector.
#[inline(always)]
pub(super) fn times<const D: usize>(block: &Block<D>, x: &[f64; D]) -> [f64; D] {
    let row = |row: usize| (1..D).fold(block[(row, 0)] * x[0], |sum, column| sum + block[(row, column)] * x[column]);
    std::array::from_fn(row)
}
