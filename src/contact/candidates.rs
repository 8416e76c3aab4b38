//! Pairs of an edge and a vertex that are near each other, kept while the vertices move little.

use super::{
    SurfaceVertices,
    touch::{length, vector},
};

/// An edge and a vertex, by their places in the lists of [`SurfaceVertices`].
pub type Pair = [u32; 2];

/// Pairs of an edge and a vertex that are near each other, in their order.
///
/// A coarse list of all pairs within some edge lengths comes from a grid, a fine one from the coarse list. Both stay while no
/// vertex has moved farther than half of the spare distance, less the mean displacement of its part and, where several parts are
/// there, of all parts. Contact looks at the distance of each pair itself, so that nothing depends on the age of the lists.
#[derive(Clone, Debug, Default)]
pub struct Candidates {
    /// Distance within which the lists have all pairs \[m\].
    near: f64,
    coarse: List,
    fine: List,
    /// Pairs that may touch however far apart they are.
    deep: Vec<Pair>,
    /// Cells of the grid, with the edges in them.
    cells: Vec<(u64, u32)>,
    /// Edges that are too long for the grid.
    long: Vec<u32>,
}

/// Pairs within a distance at some positions.
#[derive(Clone, Debug, Default)]
struct List {
    pairs: Vec<Pair>,
    /// Positions of the surface vertices then \[m\]; empty if there were none.
    at: Vec<[f64; 2]>,
    /// Their mean displacements since then, by part \[m\].
    shifts: Vec<[f64; 2]>,
}

/// Distance by which a vertex may move before the fine list is made anew, as a fraction of that within which it has all pairs.
const SPARE: f64 = 0.2;

impl Candidates {
    /// Makes the list contain all pairs within a distance \[m\] at positions x \[m\].
    pub fn update(&mut self, surface: &SurfaceVertices, x: &[f64], near: f64) {
        let enough = near <= self.near;
        if enough && self.fine.holds(surface, x, SPARE * self.near) {
            return;
        }
        self.near = near;
        // Each vertex may move by the spare distance with the fine list, and by an edge length with the coarse one.
        let (within, edge) = ((1.0 + 2.0 * SPARE) * near, surface.greatest_edge());
        if !(enough && self.coarse.holds(surface, x, edge)) {
            let mut pairs = std::mem::take(&mut self.coarse.pairs);
            self.find(surface, x, within + 2.0 * edge, &mut pairs);
            self.coarse.pairs = pairs;
            self.coarse.mark(surface, x);
        }
        let Self { coarse, fine: list, .. } = self;
        list.pairs.clear();
        list.pairs.extend(coarse.pairs.iter().filter(|pair| squared_distance(surface, x, **pair) < within * within));
        list.mark(surface, x);
    }

    /// Sets the pairs that may touch however far apart they are.
    pub fn set_deep(&mut self, pairs: impl Iterator<Item = Pair>) {
        self.deep.clear();
        self.deep.extend(pairs);
        self.deep.sort_unstable();
        self.deep.dedup();
    }

    /// The pairs that are near each other.
    pub fn pairs(&self) -> &[Pair] {
        &self.fine.pairs
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.fine.pairs.is_empty() && self.deep.is_empty()
    }

    /// The pairs that are near each other as `is_near` tells, and those that may touch anyway, in their order.
    pub fn each(&self, is_near: impl Fn(Pair) -> bool, mut act: impl FnMut(Pair)) {
        let mut deep = self.deep.iter().copied().peekable();
        for pair in self.fine.pairs.iter().copied() {
            while let Some(earlier) = deep.next_if(|deep| *deep < pair) {
                act(earlier);
            }
            if deep.next_if_eq(&pair).is_some() || is_near(pair) {
                act(pair);
            }
        }
        deep.for_each(act);
    }

    /// Writes all pairs within a distance \[m\] at positions x \[m\] of a vertex and an edge that does not end in it.
    pub fn find(&mut self, surface: &SurfaceVertices, x: &[f64], distance: f64, pairs: &mut Vec<Pair>) {
        /// Most cells of an edge along an axis.
        const MOST: i64 = 16;
        pairs.clear();
        let Self { cells, long, .. } = self;
        let cell = distance + surface.greatest_edge();
        let place = |coordinate: f64| libm::floor(coordinate / cell) as i64;
        let key = |column: i64, row: i64| ((column as u64) << 32) ^ (row as u64 & 0xffff_ffff);
        cells.clear();
        long.clear();
        for (number, edge) in surface.edges().iter().enumerate() {
            let [a, b] = edge.ends.map(|vertex| vector(x, vertex));
            let [left, right] = [a[0].min(b[0]) - distance, a[0].max(b[0]) + distance].map(place);
            let [bottom, top] = [a[1].min(b[1]) - distance, a[1].max(b[1]) + distance].map(place);
            // A number that is not finite is in no cell, and the step is refused.
            if right.saturating_sub(left) > MOST || top.saturating_sub(bottom) > MOST {
                long.push(number as u32);
                continue;
            }
            for column in left..=right {
                cells.extend((bottom..=top).map(|row| (key(column, row), number as u32)));
            }
        }
        cells.sort_unstable();
        for (number, vertex) in surface.iter().enumerate() {
            let [px, py] = vector(x, vertex.vertex);
            let own = key(place(px), place(py));
            let from = cells.partition_point(|(cell, _)| *cell < own);
            let here = cells[from..].iter().take_while(|(cell, _)| *cell == own).map(|(_, edge)| *edge);
            for edge in here.chain(long.iter().copied()) {
                let found = [edge, number as u32];
                let apart = !surface.edges()[edge as usize].ends.contains(&vertex.vertex);
                if apart && squared_distance(surface, x, found) < distance * distance {
                    pairs.push(found);
                }
            }
        }
        pairs.sort_unstable();
    }
}

impl List {
    /// Remembers the positions that the list is of.
    fn mark(&mut self, surface: &SurfaceVertices, x: &[f64]) {
        self.at.clear();
        self.at.extend(surface.iter().map(|vertex| vector(x, vertex.vertex)));
    }

    /// Whether no vertex has moved by more than a distance \[m\].
    fn holds(&mut self, surface: &SurfaceVertices, x: &[f64], distance: f64) -> bool {
        if self.at.len() != surface.len() {
            return false;
        }
        let Self { at, shifts, .. } = self;
        let moved = |(vertex, [ax, ay]): (&super::SurfaceVertex, &[f64; 2])| {
            let [px, py] = vector(x, vertex.vertex);
            [px - ax, py - ay]
        };
        let all = || surface.iter().zip(&*at).map(moved);
        shifts.clear();
        shifts.extend((0..surface.parts()).map(|part| mean(all, surface.vertices_of(part))));
        let shift = mean(|| shifts.iter().copied(), 0..shifts.len());
        let mut displacements = all();
        (0..surface.parts()).all(|part| {
            let [sx, sy] = shifts[part];
            let apart = length([sx - shift[0], sy - shift[1]]);
            let left = distance - apart;
            let squares = displacements.by_ref().take(surface.vertices_of(part).len());
            let farthest = squares.map(|[dx, dy]| (dx - sx) * (dx - sx) + (dy - sy) * (dy - sy)).fold(0.0, greater);
            // NaN fails the comparison.
            left >= 0.0 && farthest <= left * left
        })
    }
}

/// The greater of two numbers; NaN if one of them is that.
pub(super) const fn greater(one: f64, other: f64) -> f64 {
    if one.is_nan() || other <= one { one } else { other }
}

/// Mean of some vectors.
fn mean<I: Iterator<Item = [f64; 2]>>(all: impl Fn() -> I, part: std::ops::Range<usize>) -> [f64; 2] {
    let count = part.len().max(1) as f64;
    let [x, y] = all().skip(part.start).take(part.len()).fold([0.0; 2], |sum, one| [sum[0] + one[0], sum[1] + one[1]]);
    [x / count, y / count]
}

/// Square of the distance of a vertex from an edge \[m²\].
pub(super) fn squared_distance(surface: &SurfaceVertices, x: &[f64], [edge, vertex]: Pair) -> f64 {
    let [a, b] = surface.edges()[edge as usize].ends.map(|end| vector(x, end));
    let point = vector(x, surface.at(vertex).vertex);
    let ([ex, ey], [px, py]) = ([b[0] - a[0], b[1] - a[1]], [point[0] - a[0], point[1] - a[1]]);
    let square = ex * ex + ey * ey;
    let t = if square > 0.0 { ((px * ex + py * ey) / square).clamp(0.0, 1.0) } else { 0.0 };
    let (dx, dy) = (px - t * ex, py - t * ey);
    dx * dx + dy * dy
}
