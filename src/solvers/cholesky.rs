//! Multifrontal Cholesky factorisation.

use super::{
    BlockMatrix,
    block_matrix::Block,
    dense::{Columns, add_products, dot, eliminate},
    elimination::{Elimination, Front},
};
use crate::simd::{SPARE, lined};
use pulp::{Arch, Simd, WithSimd};

/// Time of a multiplication and subtraction in factorisation, and of a block of L in one factorisation and solve \[ns\].
const PRODUCT: f64 = 0.05;
const ENTRY: f64 = 9.0;

/// The factorisation `A = L Lᵀ` of a symmetric positive definite [`BlockMatrix`].
///
/// The elimination order (approximate minimum degree) and the structure of L are found once for a topology. The
/// numeric factorisation is multifrontal (Duff and Reid, *The multifrontal solution of indefinite sparse symmetric
/// linear systems*, ACM Transactions on Mathematical Software 9, 1983; Davis, *Direct Methods for Sparse Linear
/// Systems*, section 4.8): columns of L with the same rows form one dense panel, which is processed with SIMD, and its
/// update matrix waits on a stack for the parent front. The bits are the same on every processor.
#[derive(Clone, Debug)]
pub struct Factor<const D: usize> {
    elimination: Elimination,
    /// The panels.
    values: Vec<f64>,
    /// Stacks of update matrices.
    stacks: [Vec<f64>; 2],
    solution: Vec<f64>,
    below: Vec<f64>,
}

impl<const D: usize> Factor<D> {
    /// Symbolic factorisation. `None` if L does not fit in memory.
    pub fn new(matrix: &BlockMatrix<D>) -> Option<Self> {
        let elimination = Elimination::new(matrix)?;
        let buffer = |size: usize| vec![0.0; size + SPARE];
        let deepest = elimination.fronts.iter().map(Front::update_stride).max().unwrap_or(0);
        Some(Self {
            values: buffer(elimination.size),
            stacks: elimination.stacks.map(buffer),
            solution: vec![0.0; D * matrix.vertices()],
            below: buffer(deepest),
            elimination,
        })
    }

    /// Factorises `A + shift W`. Rows and columns of numbers with 1/W zero are taken as those of the identity. Returns
    /// whether the matrix was positive definite; if not, nothing can be solved.
    pub fn factorise(&mut self, matrix: &BlockMatrix<D>, inverse_weight: &[f64], shift: f64) -> bool {
        let all = inverse_weight.iter().all(|weight| *weight > 0.0);
        Arch::new().dispatch(Factorise { of: self, matrix, inverse_weight, shift, all })
    }

    /// Solves `A x = b` with the last factorisation; b is flat and is overwritten with x.
    pub fn solve(&mut self, b: &mut [f64]) {
        Arch::new().dispatch(Solve { of: self, b });
    }

    /// Estimated time of one factorisation and solve \[ns\], from the pattern alone, so that choices by it are the same
    /// on every machine; only ratios of such times are meaningful.
    pub fn time(&self) -> f64 {
        let front = |front: &Front| {
            let (first, last) = ((front.width + front.depth()) as f64, front.depth() as f64);
            // Half the sum of squares from last to first.
            (first.powi(3) - last.powi(3)) / 6.0
        };
        let products: f64 = self.elimination.fronts.iter().map(front).sum();
        PRODUCT * products + ENTRY * self.entries() as f64
    }

    /// Number of blocks of L, including the diagonal and explicit zeros.
    pub fn entries(&self) -> usize {
        let of_front = |[width, depth]: [usize; 2]| width * (width + 1) / 2 + width * depth;
        self.elimination.fronts.iter().map(|front| of_front([front.width / D, front.depth() / D])).sum()
    }
}

struct Factorise<'a, const D: usize> {
    of: &'a mut Factor<D>,
    matrix: &'a BlockMatrix<D>,
    inverse_weight: &'a [f64],
    shift: f64,
    /// Whether no number is fixed.
    all: bool,
}

impl<const D: usize> WithSimd for Factorise<'_, D> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, set: S) -> bool {
        let Self { of, matrix, inverse_weight, shift, all } = self;
        let Factor { elimination, values, stacks, .. } = of;
        let values = lined(values);
        let [even, odd] = stacks;
        let mut stacks = [lined(even), lined(odd)];
        for front in &elimination.fronts {
            let (width, top, depth, stride) = (front.width, front.top(), front.depth(), front.stride());
            let panel = &mut values[front.panel..front.panel + width * stride];
            panel.fill(0.0);
            fill(panel, elimination, front, (matrix, inverse_weight, shift, all));
            let [even, odd] = &mut stacks;
            let (own, other) = if front.stack == 0 { (even, odd) } else { (odd, even) };
            let mut panel = Columns { values: panel, stride };
            let values = &mut own[front.update..front.update + depth * front.update_stride()];
            values.fill(0.0);
            let mut update = Columns { values, stride: front.update_stride() };
            for child in &elimination.children[front.children.clone()] {
                let child = &elimination.fronts[*child as usize];
                extend_add(&mut panel, &mut update, top, (elimination, child, &other[child.update..]));
            }
            if !eliminate(set, &mut panel, &mut update, (width, top, depth)) {
                return false;
            }
        }
        true
    }
}

/// Copies a front's entries of the matrix into its panel.
#[inline(always)]
fn fill<const D: usize>(
    panel: &mut [f64],
    elimination: &Elimination,
    front: &Front,
    (matrix, inverse_weight, shift, all): (&BlockMatrix<D>, &[f64], f64, bool),
) {
    let stride = front.stride();
    let mut put = |at: usize, block: &Block<D>| {
        for (column, entries) in block.column_iter().enumerate() {
            let at = at + column * stride;
            panel[at..at + D].iter_mut().zip(&entries).for_each(|(into, entry)| *into = *entry);
        }
    };
    for entry in &elimination.entries[front.entries.clone()] {
        let number = (entry.block >> 1) as usize;
        let mut block = matrix.blocks()[number];
        if !all {
            let [row, column] = matrix.pattern()[number].map(|vertex| free(inverse_weight, vertex as usize));
            block = masked(&block, row, column);
        }
        put(entry.to as usize, &if entry.block & 1 == 0 { block } else { block.transpose() });
    }
    for column in (0..front.width).step_by(D) {
        let vertex = elimination.vertex_at[(front.first + column) / D] as usize;
        let own = free(inverse_weight, vertex);
        let mut block = masked(&matrix.diagonals()[vertex], own, own);
        for (axis, free) in own.into_iter().enumerate() {
            block[(axis, axis)] += if free { shift / inverse_weight[D * vertex + axis] } else { 1.0 };
        }
        for (row, column) in (1..D).flat_map(|row| (0..row).map(move |column| (row, column))) {
            block[(row, column)] = 0.5 * (block[(column, row)] + block[(row, column)]);
        }
        put(column * (stride + 1), &block);
    }
}

/// Extend-add: adds the update matrix of a child front to its parent.
#[inline(always)]
fn extend_add(
    panel: &mut Columns<'_>,
    update: &mut Columns<'_>,
    top: usize,
    (elimination, child, values): (&Elimination, &Front, &[f64]),
) {
    let runs = &elimination.runs[child.runs.clone()];
    let stride = child.update_stride();
    for (number, run) in runs.iter().enumerate() {
        for column in 0..run.count as usize {
            let from = run.from as usize + column;
            let to = run.to as usize + column;
            let source = &values[from * stride..(from + 1) * stride];
            let (target, skip) = if to < top {
                (&mut panel.values[to * panel.stride..(to + 1) * panel.stride], 0)
            } else {
                (&mut update.values[(to - top) * update.stride..(to - top + 1) * update.stride], top)
            };
            for (number, run) in runs[number..].iter().enumerate() {
                // Entries above the diagonal are not used.
                let skipped = if number == 0 { column } else { 0 };
                let (from, to) = (run.from as usize + skipped, run.to as usize + skipped - skip);
                let count = run.count as usize - skipped;
                for (target, source) in target[to..to + count].iter_mut().zip(&source[from..from + count]) {
                    *target += source;
                }
            }
        }
    }
}

struct Solve<'a, const D: usize> {
    of: &'a mut Factor<D>,
    b: &'a mut [f64],
}

impl<const D: usize> WithSimd for Solve<'_, D> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { of: Factor { elimination, values, solution, below, .. }, b } = self;
        let values = &*lined(values);
        let below = lined(below);
        let b = b.as_chunks_mut::<D>().0;
        for (value, vertex) in solution.as_chunks_mut::<D>().0.iter_mut().zip(&elimination.vertex_at) {
            *value = b[*vertex as usize];
        }
        for front in &elimination.fronts {
            let (panel, stride) = (&values[front.panel..front.panel + front.width * front.stride()], front.stride());
            let own = &mut solution[front.first..front.first + front.width];
            for (column, values) in panel.chunks_exact(stride).enumerate() {
                let value = own[column] * values[column];
                own[column] = value;
                for (other, lower) in own[column + 1..].iter_mut().zip(&values[column + 1..front.width]) {
                    *other -= lower * value;
                }
            }
            let below = &mut below[..front.depth()];
            below.fill(0.0);
            add_products(below, panel, stride, front.top(), own);
            let solution = solution.as_chunks_mut::<D>().0;
            for (below, place) in below.as_chunks::<D>().0.iter().zip(&elimination.rows[front.below.clone()]) {
                solution[*place as usize].iter_mut().zip(below).for_each(|(value, below)| *value -= below);
            }
        }
        for front in elimination.fronts.iter().rev() {
            let (panel, stride) = (&values[front.panel..front.panel + front.width * front.stride()], front.stride());
            let below = &mut below[..front.depth()];
            let places = &elimination.rows[front.below.clone()];
            for (below, place) in below.as_chunks_mut::<D>().0.iter_mut().zip(places) {
                *below = solution.as_chunks::<D>().0[*place as usize];
            }
            let own = &mut solution[front.first..front.first + front.width];
            for (column, values) in panel.chunks_exact(stride).enumerate().rev() {
                let lower = dot(&values[front.top()..front.top() + front.depth()], below);
                let beside = dot(&values[column + 1..front.width], &own[column + 1..]);
                own[column] = (own[column] - lower - beside) * values[column];
            }
        }
        for (value, vertex) in solution.as_chunks::<D>().0.iter().zip(&elimination.vertex_at) {
            b[*vertex as usize] = *value;
        }
    }
}

/// Which of a vertex's numbers are free.
#[inline]
fn free<const D: usize>(inverse_weight: &[f64], vertex: usize) -> [bool; D] {
    std::array::from_fn(|axis| inverse_weight[D * vertex + axis] > 0.0)
}

/// The block with zeros in the rows and columns that are not free.
#[inline]
fn masked<const D: usize>(block: &Block<D>, rows: [bool; D], columns: [bool; D]) -> Block<D> {
    if rows == [true; D] && columns == [true; D] {
        return *block;
    }
    Block::from_fn(|row, column| if rows[row] && columns[column] { block[(row, column)] } else { 0.0 })
}
