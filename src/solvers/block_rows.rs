//! Rows of a block matrix, to which several threads add independently.

use super::{BlockMatrix, block_matrix::Block};
use std::ops::Range;

/// Fewest pairs of vertices for each thread; fewer take less time than a transfer to another core.
const LEAST_PAIRS: usize = 8192;

/// Some rows of a [`BlockMatrix`], and the next pairs of its list. What is added to other rows is ignored: an element whose
/// vertices have rows here and elsewhere is computed for both.
pub struct BlockRows<'a, const D: usize> {
    rows: Range<usize>,
    diagonal: &'a mut [Block<D>],
    /// Number of the first of `blocks` in the matrix.
    first: usize,
    blocks: &'a mut [Block<D>],
    /// Rows and columns of `blocks`.
    pattern: &'a [[u32; 2]],
    slots: &'a [u32],
}

impl<const D: usize> BlockMatrix<D> {
    /// Adds elements that take the next `pairs` pairs of the list and have these vertices. `add` is called for ranges of rows, one for
    /// each thread of the pool of this thread, if there are pairs enough. It must add the elements in order. It may leave out elements
    /// that [have no vertex](BlockRows::have_any) in the rows. The bits then do not depend on the number of threads.
    pub fn add_by_rows(&mut self, pairs: usize, vertices: Range<usize>, add: impl Fn(BlockRows<'_, D>) + Sync) {
        let threads = rayon::current_thread_index().map_or(1, |_| rayon::current_num_threads());
        let end = (self.cursor + pairs).min(self.slots.len());
        let rows = BlockRows {
            rows: 0..self.diagonal.len(),
            diagonal: &mut self.diagonal,
            first: 0,
            blocks: &mut self.blocks,
            pattern: &self.pattern,
            slots: &self.slots[self.cursor.min(end)..end],
        };
        let (_, rows) = rows.split(vertices.start);
        let (rows, _) = rows.split(vertices.end);
        self.cursor += pairs;
        rows.share(threads.min(pairs / LEAST_PAIRS).max(1), &add);
    }
}

impl<const D: usize> BlockRows<'_, D> {
    /// Rows before a vertex, and the others.
    fn split(self, vertex: usize) -> (Self, Self) {
        let middle = self.pattern.partition_point(|[row, _]| (*row as usize) < vertex);
        let (diagonal, other_diagonal) = self.diagonal.split_at_mut(vertex - self.rows.start);
        let (blocks, other_blocks) = self.blocks.split_at_mut(middle);
        let (pattern, other_pattern) = self.pattern.split_at(middle);
        let (slots, first) = (self.slots, self.first);
        let (rows, other_rows) = (self.rows.start..vertex, vertex..self.rows.end);
        let other = BlockRows {
            rows: other_rows,
            diagonal: other_diagonal,
            first: first + middle,
            blocks: other_blocks,
            pattern: other_pattern,
            slots,
        };
        (BlockRows { rows, diagonal, first, blocks, pattern, slots }, other)
    }

    /// Calls `add` for equal parts of the rows, in parallel.
    fn share(self, parts: usize, add: &(impl Fn(BlockRows<'_, D>) + Sync)) {
        if parts == 1 {
            return add(self);
        }
        let middle = self.rows.start + self.rows.len() * (parts / 2) / parts;
        let (one, other) = self.split(middle);
        rayon::join(|| one.share(parts / 2, add), || other.share(parts - parts / 2, add));
    }

    /// Whether any of these vertices has a row here.
    #[inline]
    pub fn have_any(&self, vertices: &[u32]) -> bool {
        vertices.iter().any(|vertex| self.rows.contains(&(*vertex as usize)))
    }

    /// Adds to the block of a vertex with itself, which must be symmetric.
    #[inline]
    pub fn diagonal(&mut self, vertex: u32, block: &Block<D>) {
        if let Some(into) = self.own(vertex) {
            *into += block;
        }
    }

    /// Adds to the block of a pair (a, b), by its number among these pairs: the derivative of a by b, and by symmetry the transpose.
    #[inline]
    pub fn off_diagonal(&mut self, pair: usize, block: &Block<D>) {
        if let Some((into, turned)) = self.beside(pair) {
            if turned {
                *into += block.transpose();
            } else {
                *into += block;
            }
        }
    }

    /// Block of a vertex with itself.
    #[inline(always)]
    fn own(&mut self, vertex: u32) -> Option<&mut Block<D>> {
        self.diagonal.get_mut((vertex as usize).wrapping_sub(self.rows.start))
    }

    /// Block of a pair, and whether it is stored transposed.
    #[inline(always)]
    fn beside(&mut self, pair: usize) -> Option<(&mut Block<D>, bool)> {
        let slot = *self.slots.get(pair)?;
        let into = self.blocks.get_mut(((slot >> 1) as usize).wrapping_sub(self.first))?;
        Some((into, slot & 1 == 1))
    }
}

impl BlockRows<'_, 2> {
    /// Adds the six blocks of a triangle, each column by column: those of its corners with themselves, then those of the pairs
    /// (first, second), (first, third) and (second, third), whose numbers begin with three times that of the triangle.
    #[inline(always)]
    pub fn triangle(&mut self, number: usize, corners: [u32; 3], blocks: &[[f64; 4]; 6]) {
        let add = |into: &mut Block<2>, block: [f64; 4]| {
            let into: &mut [[f64; 2]; 2] = into.as_mut();
            into.as_flattened_mut().iter_mut().zip(block).for_each(|(into, entry)| *into += entry);
        };
        let (own, beside) = blocks.split_at(3);
        for (corner, block) in corners.into_iter().zip(own) {
            if let Some(into) = self.own(corner) {
                add(into, *block);
            }
        }
        for (pair, &[m11, m21, m12, m22]) in (3 * number..).zip(beside) {
            if let Some((into, turned)) = self.beside(pair) {
                add(into, if turned { [m11, m12, m21, m22] } else { [m11, m21, m12, m22] });
            }
        }
    }
}
