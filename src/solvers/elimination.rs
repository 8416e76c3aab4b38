//! Elimination order and fill of a sparse factorisation.

use super::{BlockMatrix, supernodes::Supernodes};
use crate::simd::LANES;
use std::ops::Range;

/// Front: vertices that are eliminated together. Their columns of L have the same rows below and form one dense panel.
///
/// All counts are of single numbers, D for each vertex. A panel is stored column by column, first the rows of the
/// vertices themselves, then those below; each is padded to whole SIMD vectors.
#[derive(Clone, Debug)]
pub struct Front {
    /// First of its numbers in elimination order.
    pub first: usize,
    /// Number of columns.
    pub width: usize,
    /// Range of the vertices below in [`Elimination::rows`].
    pub below: Range<usize>,
    /// Number of rows below.
    depth: usize,
    /// Start of its panel in the values.
    pub panel: usize,
    /// Its entries of the matrix, in [`Elimination::entries`].
    pub entries: Range<usize>,
    /// Its child fronts, in [`Elimination::children`].
    pub children: Range<usize>,
    /// Stack of its own update matrix (0 or 1), and the start there.
    pub stack: usize,
    pub update: usize,
    /// Rows of its update in the parent front, in [`Elimination::runs`].
    pub runs: Range<usize>,
}

impl Front {
    /// Makes a front of these places, and those below, without storage.
    const fn new<const D: usize>(places: Range<usize>, below: Range<usize>) -> Self {
        Self {
            first: D * places.start,
            width: D * (places.end - places.start),
            depth: D * (below.end - below.start),
            below,
            panel: 0,
            entries: 0..0,
            children: 0..0,
            stack: 0,
            update: 0,
            runs: 0..0,
        }
    }

    /// Number of rows below.
    pub const fn depth(&self) -> usize {
        self.depth
    }

    /// First row below in the panel.
    pub const fn top(&self) -> usize {
        self.width.next_multiple_of(LANES)
    }

    /// Stride of the update matrix.
    pub const fn update_stride(&self) -> usize {
        spread(self.depth().next_multiple_of(LANES))
    }

    /// Stride of the panel.
    pub const fn stride(&self) -> usize {
        spread(self.top() + self.depth().next_multiple_of(LANES))
    }
}

/// Pads a stride: columns a multiple of 512 bytes apart would map to the same few cache sets.
const fn spread(rows: usize) -> usize {
    if rows.is_multiple_of(64) && rows > 0 { rows + LANES } else { rows }
}

/// Rows that are consecutive in a front and in its parent.
#[derive(Clone, Copy, Debug)]
pub struct RowRun {
    /// The first row in the update.
    pub from: u32,
    /// First row in the parent.
    pub to: u32,
    /// Number of rows.
    pub count: u32,
}

/// Position of a block of the matrix in a panel.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// Index of its first number in the panel.
    pub to: u32,
    /// Twice the number of the block, odd if it has to be transposed.
    pub block: u32,
}

/// Elimination order and structure of L.
#[derive(Clone, Debug)]
pub struct Elimination {
    /// The vertex eliminated at each place.
    pub vertex_at: Vec<u32>,
    /// Fronts, children before parents.
    pub fronts: Vec<Front>,
    pub rows: Vec<u32>,
    pub entries: Vec<Entry>,
    pub children: Vec<u32>,
    pub runs: Vec<RowRun>,
    /// Size of all panels, and of either stack.
    pub size: usize,
    pub stacks: [usize; 2],
}

impl Elimination {
    /// Analyses the pattern of a matrix; `None` if L does not fit in memory.
    pub fn new<const D: usize>(matrix: &BlockMatrix<D>) -> Option<Self> {
        let count = matrix.vertices();
        let supernodes = Supernodes::new(matrix)?;
        let mut own = vec![0; count];
        let (mut rows, mut fronts) = (Vec::new(), Vec::new());
        let mut add = |places: Range<usize>, pattern: &[u32]| {
            own[places.clone()].fill(fronts.len());
            let below = rows.len();
            rows.extend_from_slice(pattern);
            rows[below..].sort_unstable();
            fronts.push(Front::new::<D>(places, below..rows.len()));
        };
        supernodes.iter().for_each(|(places, pattern)| add(places, pattern));
        let mut elimination = Self {
            vertex_at: supernodes.vertex_at,
            fronts,
            rows,
            entries: Vec::new(),
            children: Vec::new(),
            runs: Vec::new(),
            size: 0,
            stacks: [0; 2],
        };
        elimination.order(&own);
        elimination.place(matrix, &supernodes.place_of);
        Some(elimination)
    }

    /// Sorts the fronts in postorder, so that updates can be stacked: each right after the last of its children. `own`
    /// is the front of each place.
    fn order(&mut self, own: &[usize]) {
        let count = self.fronts.len();
        let parent = |front: &Front| self.rows[front.below.clone()].first().map(|row| own[*row as usize]);
        let parents: Vec<_> = self.fronts.iter().map(parent).collect();
        let mut children = vec![Vec::new(); count];
        for (front, parent) in parents.iter().enumerate() {
            if let Some(parent) = parent {
                children[*parent].push(front);
            }
        }
        let mut order = Vec::with_capacity(count);
        let mut level = vec![0; count];
        // Roots in reverse, because the order is reversed at the end.
        let mut waiting: Vec<_> = (0..count).filter(|front| parents[*front].is_none()).collect();
        while let Some(front) = waiting.pop() {
            order.push(front);
            for child in &children[front] {
                level[*child] = level[front] + 1;
                waiting.push(*child);
            }
        }
        order.reverse();
        let mut number_of = vec![0; count];
        for (number, front) in order.iter().enumerate() {
            number_of[*front] = number as u32;
        }
        let mut heights = [0; 2];
        let mut sorted = Vec::with_capacity(count);
        for &old in &order {
            let mut front = self.fronts[old].clone();
            let mut own_children: Vec<_> = children[old].iter().map(|child| number_of[*child]).collect();
            own_children.sort_unstable();
            front.children = self.children.len()..self.children.len() + own_children.len();
            front.stack = level[old] % 2;
            front.update = heights[front.stack];
            heights[front.stack] += front.update_stride() * front.depth();
            self.stacks[front.stack] = self.stacks[front.stack].max(heights[front.stack]);
            if let Some(first) = own_children.first() {
                let first: &Front = &sorted[*first as usize];
                heights[first.stack] = first.update;
            }
            self.children.extend(own_children);
            front.panel = self.size;
            self.size += front.stride() * front.width;
            sorted.push(front);
        }
        self.fronts = sorted;
    }

    /// Computes the positions of entries of the matrix and of rows of updates.
    fn place<const D: usize>(&mut self, matrix: &BlockMatrix<D>, place_of: &[u32]) {
        let mut columns = vec![Vec::new(); matrix.vertices()];
        for (block, [a, b]) in matrix.pattern().iter().enumerate() {
            let (a, b) = (place_of[*a as usize], place_of[*b as usize]);
            columns[a.min(b) as usize].push((a.max(b), 2 * block as u32 + u32::from(a < b)));
        }
        // Row of each place in the present panel.
        let mut row_of = vec![0; matrix.vertices()];
        for number in 0..self.fronts.len() {
            let front = self.fronts[number].clone();
            let places = front.first / D..(front.first + front.width) / D;
            for (row, place) in places.clone().enumerate() {
                row_of[place] = D * row;
            }
            for (row, place) in self.rows[front.below.clone()].iter().enumerate() {
                row_of[*place as usize] = front.top() + D * row;
            }
            let begin = self.entries.len();
            for (column, place) in places.enumerate() {
                let entry = |(row, block): &(u32, u32)| Entry {
                    to: (D * column * front.stride() + row_of[*row as usize]) as u32,
                    block: *block,
                };
                self.entries.extend(columns[place].iter().map(entry));
            }
            self.fronts[number].entries = begin..self.entries.len();
            for child in self.children[front.children].iter().map(|child| *child as usize) {
                let begin = self.runs.len();
                for (row, place) in self.rows[self.fronts[child].below.clone()].iter().enumerate() {
                    let (from, to) = ((D * row) as u32, row_of[*place as usize] as u32);
                    match self.runs[begin..].last_mut() {
                        Some(run) if run.to + run.count == to => run.count += D as u32,
                        _ => self.runs.push(RowRun { from, to, count: D as u32 }),
                    }
                }
                self.fronts[child].runs = begin..self.runs.len();
            }
        }
    }
}
