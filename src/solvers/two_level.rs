//! Two-level preconditioner: Gauss-Seidel sweeps and an exact coarse solve with groups of vertices.

use super::{
    BlockMatrix, Factor,
    block_matrix::{Block, times},
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

/// Weight of the neighbours in the smoothed prolongation (Vaněk, Mandel and Brezina, *Algebraic multigrid by smoothed
/// aggregation for second and fourth order elliptic problems*, Computing 56, 1996): it leaves least of a vector that
/// alternates from vertex to vertex.
const SMOOTHING: f64 = 2.0 / 3.0;

/// Marks a vertex without a group.
const NONE: u32 = u32::MAX;

/// A coarse system with a vertex for each group of coupled vertices.
///
/// It depends on the sparsity pattern alone and is built once for a topology. The prolongation gives values of groups
/// to their vertices and, with weights, to the neighbours of these: each vertex takes two thirds from its neighbours,
/// so that constants are preserved and there is no jump between groups.
#[derive(Clone, Debug)]
pub struct Coarsening {
    groups: usize,
    /// Start of the weights of each vertex.
    starts: Vec<u32>,
    /// Groups and their weights.
    shares: Vec<(u32, f64)>,
}

impl Coarsening {
    /// Builds the groups of a matrix.
    pub fn new<const D: usize>(matrix: &BlockMatrix<D>) -> Self {
        let around = Neighbours::new(matrix);
        let (group_of, groups) = groups(&around);
        let mut coarsening = Self { groups, starts: vec![0], shares: Vec::new() };
        for (vertex, own) in group_of.iter().enumerate() {
            let others = around.of(vertex);
            let mut add = |group: u32, share: f64| {
                let begin = coarsening.starts[vertex] as usize;
                match coarsening.shares[begin..].iter_mut().find(|(other, _)| *other == group) {
                    Some((_, sum)) => *sum += share,
                    None => coarsening.shares.push((group, share)),
                }
            };
            add(*own, if others.is_empty() { 1.0 } else { 1.0 - SMOOTHING });
            for other in others {
                add(group_of[*other as usize], SMOOTHING / others.len() as f64);
            }
            coarsening.starts.push(coarsening.shares.len() as u32);
        }
        coarsening
    }

    /// Groups of a vertex with their weights.
    #[inline]
    fn of(&self, vertex: usize) -> &[(u32, f64)] {
        &self.shares[self.starts[vertex] as usize..self.starts[vertex + 1] as usize]
    }

    /// A zero matrix for the groups.
    pub fn matrix<const D: usize>(&self, fine: &BlockMatrix<D>) -> BlockMatrix<D> {
        let mut listed = Vec::new();
        for vertex in 0..fine.vertices() {
            let shares = self.of(vertex);
            for (number, (a, _)) in shares.iter().enumerate() {
                listed.extend(shares[number + 1..].iter().map(|(b, _)| [*a, *b]));
            }
        }
        for [row, column] in fine.pattern() {
            for (a, _) in self.of(*row as usize) {
                listed.extend(self.of(*column as usize).iter().filter(|(b, _)| a != b).map(|(b, _)| [*a, *b]));
            }
        }
        BlockMatrix::new(self.groups, &listed)
    }

    /// Galerkin product: sets `coarse`, made by [`Self::matrix`], to `Pᵀ A P`. Numbers with 1/weight zero are left out.
    pub fn project<const D: usize>(&self, fine: &BlockMatrix<D>, inverse_weight: &[f64], coarse: &mut BlockMatrix<D>) {
        coarse.clear();
        for (vertex, block) in fine.diagonals().iter().enumerate() {
            let shares = self.of(vertex);
            let mut block = *block;
            for axis in (0..D).filter(|axis| inverse_weight[D * vertex + axis] == 0.0) {
                block[(axis, axis)] = 0.0;
            }
            for (number, (a, share)) in shares.iter().enumerate() {
                coarse.diagonal(*a as usize, &(block * (share * share)));
                shares[number + 1..].iter().for_each(|(_, other)| coarse.off_diagonal(&(block * (share * other))));
            }
        }
        for ([row, column], block) in fine.pattern().iter().zip(fine.blocks()) {
            let both: Block<D> = block + block.transpose();
            for (a, share) in self.of(*row as usize) {
                for (b, other) in self.of(*column as usize) {
                    if a == b {
                        coarse.diagonal(*a as usize, &(both * (share * other)));
                    } else {
                        coarse.off_diagonal(&(block * (share * other)));
                    }
                }
            }
        }
    }

    /// Restriction, `coarse = Pᵀ fine`.
    pub fn gather<const D: usize>(&self, fine: &[[f64; D]], coarse: &mut [f64]) {
        coarse.fill(0.0);
        let coarse = coarse.as_chunks_mut::<D>().0;
        for (vertex, fine) in fine.iter().enumerate() {
            for (group, share) in self.of(vertex) {
                coarse[*group as usize].iter_mut().zip(fine).for_each(|(into, fine)| *into += share * fine);
            }
        }
    }

    /// Prolongation, `fine += P coarse`.
    pub fn spread<const D: usize>(&self, coarse: &[f64], fine: &mut [[f64; D]]) {
        let coarse = coarse.as_chunks::<D>().0;
        for (vertex, fine) in fine.iter_mut().enumerate() {
            for (group, share) in self.of(vertex) {
                fine.iter_mut().zip(coarse[*group as usize]).for_each(|(into, coarse)| *into += share * coarse);
            }
        }
    }
}

/// Adjacency of vertices.
struct Neighbours {
    starts: Vec<u32>,
    all: Vec<u32>,
}

impl Neighbours {
    fn new<const D: usize>(matrix: &BlockMatrix<D>) -> Self {
        let mut starts = vec![0; matrix.vertices() + 1];
        for vertex in matrix.pattern().as_flattened() {
            starts[*vertex as usize + 1] += 1;
        }
        for vertex in 0..matrix.vertices() {
            starts[vertex + 1] += starts[vertex];
        }
        let mut next = starts.clone();
        let mut all = vec![0; 2 * matrix.pattern().len()];
        for [a, b] in matrix.pattern() {
            for (of, other) in [(*a, *b), (*b, *a)] {
                all[next[of as usize] as usize] = other;
                next[of as usize] += 1;
            }
        }
        Self { starts, all }
    }

    fn of(&self, vertex: usize) -> &[u32] {
        &self.all[self.starts[vertex] as usize..self.starts[vertex + 1] as usize]
    }
}

/// The group of each vertex, and the number of groups: first every vertex with all its neighbours, where none of these
/// has a group; the others join a neighbouring group.
fn groups(around: &Neighbours) -> (Vec<u32>, usize) {
    let count = around.starts.len() - 1;
    let mut group_of = vec![NONE; count];
    let mut groups = 0;
    for vertex in 0..count {
        let others = around.of(vertex);
        if group_of[vertex] == NONE && others.iter().all(|other| group_of[*other as usize] == NONE) {
            group_of[vertex] = groups;
            for other in others {
                group_of[*other as usize] = groups;
            }
            groups += 1;
        }
    }
    let first = group_of.clone();
    for (vertex, group) in group_of.iter_mut().enumerate().filter(|(_, group)| **group == NONE) {
        // A neighbour has a group, otherwise the vertex would be one.
        let next = around.of(vertex).iter().map(|other| first[*other as usize]).find(|group| *group != NONE);
        *group = next.unwrap_or(0);
    }
    (group_of, groups as usize)
}
