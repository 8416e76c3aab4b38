//! Dense kernels of the multifrontal factorisation. Every number goes through the same operations in the same order,
//! for any SIMD width.

use crate::simd::LANES;
use pulp::Simd;

/// Columns of a register tile.
const COLUMNS: usize = 4;

/// Columns of a cache block.
const BLOCK: usize = 64;

/// Columns of a front: a slice and its stride.
pub struct Columns<'a> {
    pub values: &'a mut [f64],
    pub stride: usize,
}

/// Eliminates the `width` columns of a panel, whose rows below start at `top`, and subtracts their products from the
/// `depth` columns of its update matrix: `A = L Lᵀ`, with the reciprocal of the diagonal of L stored in its place.
/// Returns whether all pivots were positive.
#[inline(always)]
pub fn eliminate<S: Simd>(
    set: S,
    panel: &mut Columns<'_>,
    update: &mut Columns<'_>,
    (width, top, depth): (usize, usize, usize),
) -> bool {
    let stride = panel.stride;
    let height = top + depth.next_multiple_of(LANES);
    for begin in (0..width).step_by(BLOCK) {
        let end = (begin + BLOCK).min(width);
        for first in (begin..width).step_by(COLUMNS) {
            let (done, rest) = panel.values.split_at_mut(first * stride);
            let done = &done[begin * stride..end.min(first) * stride];
            let start = first / LANES * LANES;
            let to = &mut rest[..(width - first).min(COLUMNS) * stride];
            let rows = (first, start, height);
            let is_positive = match width - first {
                1 => columns::<S, 1>(set, to, stride, done, (rows, first < end)),
                2 => columns::<S, 2>(set, to, stride, done, (rows, first < end)),
                3 => columns::<S, 3>(set, to, stride, done, (rows, first < end)),
                _ => columns::<S, COLUMNS>(set, to, stride, done, (rows, first < end)),
            };
            if !is_positive {
                return false;
            }
        }
        let done = &panel.values[begin * stride..end * stride];
        for first in (0..depth).step_by(COLUMNS) {
            let start = first / LANES * LANES;
            let to = &mut update.values[first * update.stride..];
            let rows = (top + first, start, top + start, height);
            match depth - first {
                1 => subtract::<S, 1>(set, to, update.stride, (done, stride), rows),
                2 => subtract::<S, 2>(set, to, update.stride, (done, stride), rows),
                3 => subtract::<S, 3>(set, to, update.stride, (done, stride), rows),
                _ => subtract::<S, COLUMNS>(set, to, update.stride, (done, stride), rows),
            }
        }
    }
    true
}

/// Subtracts the products of the columns `done` from C columns of the same panel and then, if `is_own`, eliminates these
/// among themselves. Returns whether all pivots were positive.
#[inline(always)]
fn columns<S: Simd, const C: usize>(
    set: S,
    to: &mut [f64],
    stride: usize,
    done: &[f64],
    ((first, start, height), is_own): ((usize, usize, usize), bool),
) -> bool {
    subtract::<S, C>(set, to, stride, (done, stride), (first, start, start, height));
    !is_own || pivot::<S, C>(set, to, stride, (first, start, height))
}

/// Subtracts `a bᵀ` from C columns for each column of a panel: a are its rows from `from` to `height`, which go to rows
/// from `to` on, and b those from `across` on.
#[inline(always)]
fn subtract<S: Simd, const C: usize>(
    set: S,
    target: &mut [f64],
    target_stride: usize,
    (panel, stride): (&[f64], usize),
    (across, to, from, height): (usize, usize, usize, usize),
) {
    let lanes = S::F64_LANES;
    let mut done = 0;
    while done < height - from {
        let rows = (across, to + done, from + done);
        match (height - from - done) / lanes {
            0 => return,
            1 => tile::<S, 1, C>(set, target, target_stride, (panel, stride), rows),
            2 => tile::<S, 2, C>(set, target, target_stride, (panel, stride), rows),
            _ => tile::<S, 3, C>(set, target, target_stride, (panel, stride), rows),
        }
        done += 3 * lanes;
    }
}

/// The same for R registers of rows.
#[inline(always)]
fn tile<S: Simd, const R: usize, const C: usize>(
    set: S,
    target: &mut [f64],
    target_stride: usize,
    (panel, stride): (&[f64], usize),
    (across, to, from): (usize, usize, usize),
) {
    let height = R * S::F64_LANES;
    let mut sums = [[set.splat_f64s(0.0); R]; C];
    for (column, sums) in sums.iter_mut().enumerate() {
        let begin = column * target_stride + to;
        sums.copy_from_slice(S::as_simd_f64s(&target[begin..begin + height]).0);
    }
    for column in panel.chunks_exact(stride) {
        let a = S::as_simd_f64s(&column[from..from + height]).0;
        let Some(b) = column[across..].first_chunk::<C>() else { return };
        for (sums, b) in sums.iter_mut().zip(b) {
            let b = set.splat_f64s(*b);
            for (sum, a) in sums.iter_mut().zip(a) {
                *sum = set.sub_f64s(*sum, set.mul_f64s(*a, b));
            }
        }
    }
    for (column, sums) in sums.iter().enumerate() {
        let begin = column * target_stride + to;
        S::as_mut_simd_f64s(&mut target[begin..begin + height]).0.copy_from_slice(sums);
    }
}

/// Eliminates C columns, of which the first has its diagonal in row `first`, among themselves.
#[allow(clippy::needless_range_loop, reason = "columns and rows of the block are told by their numbers")]
#[inline(always)]
fn pivot<S: Simd, const C: usize>(
    set: S,
    columns: &mut [f64],
    stride: usize,
    (first, start, height): (usize, usize, usize),
) -> bool {
    let mut block = [[0.0; C]; C];
    for (column, block) in block.iter_mut().enumerate() {
        block.copy_from_slice(&columns[column * stride + first..column * stride + first + C]);
    }
    for column in 0..C {
        let pivot = block[column][column];
        // NaN fails the comparison.
        if !(pivot > 0.0 && pivot.is_finite()) {
            return false;
        }
        let inverse = 1.0 / pivot.sqrt();
        block[column][column] = inverse;
        for row in column + 1..C {
            block[column][row] *= inverse;
        }
        for other in column + 1..C {
            let across = block[column][other];
            for row in other..C {
                block[other][row] -= block[column][row] * across;
            }
        }
    }
    for at in (start..height).step_by(S::F64_LANES) {
        let mut values = [set.splat_f64s(0.0); C];
        for (column, value) in values.iter_mut().enumerate() {
            let begin = column * stride + at;
            *value = S::as_simd_f64s(&columns[begin..begin + S::F64_LANES]).0[0];
        }
        for column in 0..C {
            values[column] = set.mul_f64s(values[column], set.splat_f64s(block[column][column]));
            for other in column + 1..C {
                let product = set.mul_f64s(values[column], set.splat_f64s(block[column][other]));
                values[other] = set.sub_f64s(values[other], product);
            }
        }
        for (column, value) in values.iter().enumerate() {
            let begin = column * stride + at;
            S::as_mut_simd_f64s(&mut columns[begin..begin + S::F64_LANES]).0[0] = *value;
        }
    }
    for (column, block) in block.iter().enumerate() {
        columns[column * stride + first + column] = block[column];
    }
    true
}

/// `sums += L y` over columns of L.
#[inline(always)]
pub fn add_products(sums: &mut [f64], columns: &[f64], stride: usize, top: usize, y: &[f64]) {
    for (pair, y) in columns.chunks(2 * stride).zip(y.chunks(2)) {
        let one = &pair[top.min(pair.len())..];
        match (y, pair.get(stride + top..)) {
            (&[y0, y1], Some(two)) => {
                for ((sum, one), two) in sums.iter_mut().zip(one).zip(two) {
                    *sum = *sum + one * y0 + two * y1;
                }
            }
            // The last of an odd number of columns.
            _ => sums.iter_mut().zip(one).for_each(|(sum, one)| *sum += one * y[0]),
        }
    }
}

/// Dot product in eight partial sums, with the same bits on every processor.
#[inline(always)]
pub fn dot(one: &[f64], other: &[f64]) -> f64 {
    let mut sums = [0.0; LANES];
    let ((one, one_rest), (other, other_rest)) = (one.as_chunks::<LANES>(), other.as_chunks::<LANES>());
    for (one, other) in one.iter().zip(other) {
        for ((sum, one), other) in sums.iter_mut().zip(one).zip(other) {
            *sum += one * other;
        }
    }
    let rest: f64 = one_rest.iter().zip(other_rest).map(|(one, other)| one * other).sum();
    let [a, b, c, d, e, f, g, h] = sums;
    ((a + b) + (c + d)) + ((e + f) + (g + h)) + rest
}

#[cfg(test)]
mod tests {
    use super::{Columns, eliminate};
    use crate::{random::irregular, simd::LANES};
    use pulp::{Arch, Scalar, Simd, WithSimd};

    /// A panel and its update, of a matrix of this many rows whose first `width` columns are eliminated.
    struct Front {
        panel: Vec<f64>,
        update: Vec<f64>,
        width: usize,
        depth: usize,
    }

    impl Front {
        fn new(matrix: &[Vec<f64>], width: usize) -> Self {
            let depth = matrix.len() - width;
            let mut front = Self { panel: Vec::new(), update: Vec::new(), width, depth };
            for (column, values) in matrix.iter().enumerate() {
                let (own, below) = values.split_at(width);
                if column < width {
                    front.panel.extend_from_slice(own);
                    front.panel.resize(front.panel.len().next_multiple_of(LANES), 0.0);
                    front.panel.extend_from_slice(below);
                    front.panel.resize(front.panel.len().next_multiple_of(LANES), 0.0);
                } else {
                    front.update.extend_from_slice(below);
                    front.update.resize(front.update.len().next_multiple_of(LANES), 0.0);
                }
            }
            front
        }

        /// The entry in a row and a column, and what is left of the matrix there.
        fn entry(&self, row: usize, column: usize) -> f64 {
            let top = self.width.next_multiple_of(LANES);
            let height = self.depth.next_multiple_of(LANES);
            let at = |row: usize| if row < self.width { row } else { top + row - self.width };
            if column < self.width {
                self.panel[column * (top + height) + at(row)]
            } else {
                self.update[(column - self.width) * height + row - self.width]
            }
        }
    }

    impl WithSimd for &mut Front {
        type Output = bool;
        #[inline(always)]
        fn with_simd<S: Simd>(self, set: S) -> bool {
            let top = self.width.next_multiple_of(LANES);
            let height = self.depth.next_multiple_of(LANES);
            let mut panel = Columns { values: &mut self.panel, stride: top + height };
            let mut update = Columns { values: &mut self.update, stride: height };
            eliminate(set, &mut panel, &mut update, (self.width, top, self.depth))
        }
    }

    fn matrix(count: usize) -> Vec<Vec<f64>> {
        let entry = |row: usize, column: usize| {
            let (more, less) = (row.max(column) as u64, row.min(column) as u64);
            if row == column { 2.0 * count as f64 } else { irregular(1000 * more + less) }
        };
        (0..count).map(|column| (0..count).map(|row| entry(row, column)).collect()).collect()
    }

    /// The same elimination, one number after another.
    fn plain(mut matrix: Vec<Vec<f64>>, width: usize) -> Vec<Vec<f64>> {
        let count = matrix.len();
        for pivot in 0..width {
            let inverse = 1.0 / matrix[pivot][pivot].sqrt();
            matrix[pivot][pivot] = inverse;
            matrix[pivot][pivot + 1..].iter_mut().for_each(|lower| *lower *= inverse);
            for column in pivot + 1..count {
                for row in column..count {
                    matrix[column][row] -= matrix[pivot][row] * matrix[pivot][column];
                }
            }
        }
        matrix
    }

    #[test]
    fn panels_in_lanes_have_the_bits_of_one_number_after_another() {
        for (width, depth) in
            [(2, 0), (1, 0), (3, 6), (9, 3), (75, 15), (2, 2), (4, 6), (6, 10), (10, 30), (66, 2), (70, 50), (150, 74)]
        {
            let matrix = matrix(width + depth);
            let expected = plain(matrix.clone(), width);
            let [mut one, mut wide] = [(); 2].map(|()| Front::new(&matrix, width));
            assert!((&mut one).with_simd(Scalar) && Arch::new().dispatch(&mut wide));
            for (column, expected) in expected.iter().enumerate() {
                for (row, expected) in expected.iter().enumerate().skip(column) {
                    for found in [one.entry(row, column), wide.entry(row, column)] {
                        assert_eq!(found.to_bits(), expected.to_bits(), "{width} + {depth}: ({row}, {column})");
                    }
                }
            }
        }
    }

    #[test]
    fn a_pivot_that_is_not_positive_is_found_wherever_it_is() {
        for pivot in 0..70 {
            for value in [-1.0, 0.0, f64::NAN, f64::INFINITY] {
                let mut matrix = matrix(78);
                matrix[pivot][pivot] = value;
                assert!(!Arch::new().dispatch(&mut Front::new(&matrix, 70)), "{value} at {pivot}");
            }
        }
    }
}
