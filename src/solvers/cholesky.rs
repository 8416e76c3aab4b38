//! Multifrontal Cholesky factorisation.

use super::{
    BlockMatrix,
    dense::{Columns, add_products, dot, eliminate},
    elimination::{Elimination, Front},
};
use crate::simd::{SPARE, lined};
use nalgebra::Matrix2;
use pulp::{Arch, Simd, WithSimd};

/// Time of a multiplication and subtraction in factorisation, and of a block of L in one factorisation and solve [ns].
const PRODUCT: f64 = 0.05;
const ENTRY: f64 = 9.0;

/// The factorisation `A = L Lᵀ` of a symmetric positive definite [`BlockMatrix`].
///
/// The elimination order (approximate minimum degree) and the structure of L come from faer, once for a topology. The
/// numeric factorisation is multifrontal (Duff and Reid, *The multifrontal solution of indefinite sparse symmetric
/// linear systems*, ACM Transactions on Mathematical Software 9, 1983; Davis, *Direct Methods for Sparse Linear
/// Systems*, section 4.8): columns of L with the same rows form one dense panel, which is processed with SIMD, and its
/// update matrix waits on a stack for the parent front. The bits must be the same on every processor; faer's own
/// kernels use whatever vector and fused operations the machine has.
#[derive(Clone, Debug)]
pub struct Factor {
    elimination: Elimination,
    /// The panels.
    values: Vec<f64>,
    /// Stacks of update matrices.
    stacks: [Vec<f64>; 2],
    solution: Vec<f64>,
    below: Vec<f64>,
}

impl Factor {
    /// Symbolic factorisation. `None` if L does not fit in memory.
    pub fn new(matrix: &BlockMatrix) -> Option<Self> {
        let elimination = Elimination::new(matrix)?;
        let buffer = |size: usize| vec![0.0; size + SPARE];
        let deepest = elimination.fronts.iter().map(Front::update_stride).max().unwrap_or(0);
        Some(Self {
            values: buffer(elimination.size),
            stacks: elimination.stacks.map(buffer),
            solution: vec![0.0; 2 * matrix.vertices()],
            below: buffer(deepest),
            elimination,
        })
    }

    /// Factorises `A + shift W`. Rows and columns of numbers with 1/W zero are taken as those of the identity. Returns
    /// whether the matrix was positive definite; if not, nothing can be solved.
    pub fn factorise(&mut self, matrix: &BlockMatrix, inverse_weight: &[f64], shift: f64) -> bool {
        let all = inverse_weight.iter().all(|weight| *weight > 0.0);
        Arch::new().dispatch(Factorise { of: self, matrix, inverse_weight, shift, all })
    }

    /// Solves `A x = b` with the last factorisation; b is flat and is overwritten with x.
    pub fn solve(&mut self, b: &mut [f64]) {
        Arch::new().dispatch(Solve { of: self, b });
    }

    /// Estimated time of one factorisation and solve [ns], from the pattern alone, so that choices by it are the same
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
        self.elimination.fronts.iter().map(|front| front.width * (front.width + 2 + 2 * front.depth()) / 8).sum()
    }
}

struct Factorise<'a> {
    of: &'a mut Factor,
    matrix: &'a BlockMatrix,
    inverse_weight: &'a [f64],
    shift: f64,
    /// Whether no number is fixed.
    all: bool,
}

impl WithSimd for Factorise<'_> {
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
fn fill(
    panel: &mut [f64],
    elimination: &Elimination,
    front: &Front,
    (matrix, inverse_weight, shift, all): (&BlockMatrix, &[f64], f64, bool),
) {
    let stride = front.stride();
    let mut put = |at: usize, block: &Matrix2<f64>| {
        (panel[at], panel[at + 1]) = (block.m11, block.m21);
        (panel[at + stride], panel[at + stride + 1]) = (block.m12, block.m22);
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
    for column in (0..front.width).step_by(2) {
        let vertex = elimination.vertex_at[front.first / 2 + column / 2] as usize;
        let own = free(inverse_weight, vertex);
        let mut block = masked(&matrix.diagonals()[vertex], own, own);
        for (axis, free) in own.into_iter().enumerate() {
            block[(axis, axis)] += if free { shift / inverse_weight[2 * vertex + axis] } else { 1.0 };
        }
        block.m21 = 0.5 * (block.m12 + block.m21);
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

struct Solve<'a> {
    of: &'a mut Factor,
    b: &'a mut [f64],
}

impl WithSimd for Solve<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { of: Factor { elimination, values, solution, below, .. }, b } = self;
        let values = &*lined(values);
        let below = lined(below);
        for (value, vertex) in solution.as_chunks_mut::<2>().0.iter_mut().zip(&elimination.vertex_at) {
            let at = 2 * *vertex as usize;
            *value = [b[at], b[at + 1]];
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
            for (below, place) in below.chunks_exact(2).zip(&elimination.rows[front.below.clone()]) {
                solution[2 * *place as usize] -= below[0];
                solution[2 * *place as usize + 1] -= below[1];
            }
        }
        for front in elimination.fronts.iter().rev() {
            let (panel, stride) = (&values[front.panel..front.panel + front.width * front.stride()], front.stride());
            let below = &mut below[..front.depth()];
            for (below, place) in below.chunks_exact_mut(2).zip(&elimination.rows[front.below.clone()]) {
                below[0] = solution[2 * *place as usize];
                below[1] = solution[2 * *place as usize + 1];
            }
            let own = &mut solution[front.first..front.first + front.width];
            for (column, values) in panel.chunks_exact(stride).enumerate().rev() {
                let lower = dot(&values[front.top()..front.top() + front.depth()], below);
                let beside = dot(&values[column + 1..front.width], &own[column + 1..]);
                own[column] = (own[column] - lower - beside) * values[column];
            }
        }
        for (value, vertex) in solution.as_chunks::<2>().0.iter().zip(&elimination.vertex_at) {
            let at = 2 * *vertex as usize;
            [b[at], b[at + 1]] = *value;
        }
    }
}

/// Which of a vertex's two numbers are free.
#[inline]
fn free(inverse_weight: &[f64], vertex: usize) -> [bool; 2] {
    [inverse_weight[2 * vertex] > 0.0, inverse_weight[2 * vertex + 1] > 0.0]
}

/// The block with zeros in the rows and columns that are not free.
#[inline]
fn masked(block: &Matrix2<f64>, rows: [bool; 2], columns: [bool; 2]) -> Matrix2<f64> {
    if rows == [true; 2] && columns == [true; 2] {
        return *block;
    }
    Matrix2::from_fn(|row, column| if rows[row] && columns[column] { block[(row, column)] } else { 0.0 })
}
