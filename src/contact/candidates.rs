//! Pairs of surfaces that are near each other, kept while the vertices move little.

use super::{
    SurfaceVertices,
    touch::{coordinates, length, vector},
};

/// An edge and a vertex, by their places in the lists of [`SurfaceVertices`]; in space those of a
/// [`ClothMesh`](super::ClothMesh).
pub type Pair = [u32; 2];

/// Surfaces with D coordinates, pairs of which may be near each other.
pub trait Surfaces<const D: usize> {
    /// Their vertices.
    fn vertices(&self) -> &SurfaceVertices;

    /// Distance by which a vertex may move before the coarse list of [`Candidates`] is made anew \[m\].
    fn spare(&self) -> f64;

    /// Writes all pairs within a distance \[m\] at positions x \[m\] that have no vertex in common, in their order.
    fn find(&self, grid: &mut Grid, x: &[f64], distance: f64, pairs: &mut Vec<Pair>);

    /// Writes all pairs that may come within a distance \[m\] in a step between two positions \[m\], in their order: at the
    /// start they are within the first of both distances \[m\], and the second one is the distance.
    fn find_swept(&self, grid: &mut Grid, start_and_end: [&[f64]; 2], distances: (f64, f64), pairs: &mut Vec<Pair>);

    /// Whether a pair is within a distance \[m\] at positions x \[m\].
    fn is_within(&self, x: &[f64], pair: Pair, distance: f64) -> bool;
}

/// Scratch for [`Surfaces::find`].
#[derive(Clone, Debug, Default)]
pub struct Grid {
    /// Cells, with the surfaces in them, ascending.
    pub(super) cells: Vec<(u64, u32)>,
    /// Surfaces that are too long for the grid.
    pub(super) long: Vec<u32>,
    /// Boxes around all surfaces in space, by their numbers: least and greatest corner \[m\].
    pub(super) boxes: Vec<[[f64; 3]; 2]>,
    /// Length of a cell in space \[m\].
    pub(super) cell: f64,
}

/// Pairs of surfaces that are near each other, in their order.
///
/// A coarse list of all pairs within some edge lengths comes from a grid, a fine one from the coarse list. Both stay while no
/// vertex has moved farther than half of the spare distance, less a displacement that all have in common. Contact looks at the distance of each pair itself, so that nothing depends on the age of the lists.
#[derive(Clone, Debug, Default)]
pub struct Candidates {
    /// Distance within which the lists have all pairs \[m\].
    near: f64,
    coarse: List,
    fine: List,
    /// Distance that all pairs of the fine list had at its positions \[m\].
    least: f64,
    /// Pairs of the fine list that can touch at all.
    touching: Vec<Pair>,
    /// Pairs that may touch however far apart they are.
    deep: Vec<Pair>,
    grid: Grid,
}

/// Pairs within a distance at some positions.
#[derive(Clone, Debug, Default)]
struct List {
    pairs: Vec<Pair>,
    /// Positions of the surface vertices then, flat \[m\]; empty if there were none.
    at: Vec<f64>,
    /// Bound on the displacements since then, less a common one, at the last positions that were looked at, and scratch for it \[m\].
    moved: f64,
    spreads: Vec<f64>,
}

/// Least distance of pairs that is told from none, as a fraction of that within which the fine list has all pairs.
const LEAST: f64 = 1e-3;

/// Distance by which a vertex may move before the fine list is made anew, as a fraction of that within which it has all pairs.
const SPARE: f64 = 0.2;

impl Candidates {
    /// Makes the list contain all pairs within a distance \[m\] at positions x \[m\]. `can_touch` tells which of them contact may act
    /// between wherever they are.
    pub fn update<const D: usize>(
        &mut self,
        surface: &impl Surfaces<D>,
        x: &[f64],
        near: f64,
        can_touch: impl Fn(Pair) -> bool,
    ) {
        let enough = near <= self.near;
        if enough && self.fine.holds::<D>(surface.vertices(), x, SPARE * self.near) {
            return;
        }
        self.near = near;
        // Each vertex may move by its own spare distance with either list.
        let (within, spare) = ((1.0 + 2.0 * SPARE) * near, surface.spare());
        let Self { coarse, fine, least, touching, grid, .. } = self;
        if !(enough && coarse.holds::<D>(surface.vertices(), x, spare)) {
            surface.find(grid, x, within + 2.0 * spare, &mut coarse.pairs);
            coarse.mark::<D>(surface.vertices(), x);
        }
        fine.pairs.clear();
        fine.pairs.extend(coarse.pairs.iter().filter(|pair| surface.is_within(x, **pair, within)));
        fine.mark::<D>(surface.vertices(), x);
        *least = within;
        for pair in &fine.pairs {
            while *least > LEAST * near && surface.is_within(x, *pair, *least) {
                *least *= 0.5;
            }
        }
        *least = if *least > LEAST * near { *least } else { 0.0 };
        touching.clear();
        touching.extend(fine.pairs.iter().filter(|pair| can_touch(**pair)));
    }

    /// Sets the pairs that may touch however far apart they are.
    pub fn set_deep(&mut self, pairs: impl Iterator<Item = Pair>) {
        self.deep.clear();
        self.deep.extend(pairs);
        self.deep.sort_unstable();
        self.deep.dedup();
    }

    /// Whether all pairs are farther apart than a distance \[m\], as far as the last update tells without looking at each.
    pub fn are_apart(&self, distance: f64) -> bool {
        distance + 2.0 * self.fine.moved < self.least
    }

    /// The pairs that are near each other.
    pub fn pairs(&self) -> &[Pair] {
        &self.fine.pairs
    }

    /// Those of them that can touch.
    pub fn touching(&self) -> &[Pair] {
        &self.touching
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.touching.is_empty() && self.deep.is_empty()
    }

    /// The pairs that can touch and are near each other as `is_near` tells, and those that may touch anyway, in their order.
    pub fn each(&self, is_near: impl Fn(Pair) -> bool, mut act: impl FnMut(Pair)) {
        let mut deep = self.deep.iter().copied().peekable();
        for pair in self.touching.iter().copied() {
            while let Some(earlier) = deep.next_if(|deep| *deep < pair) {
                act(earlier);
            }
            if deep.next_if_eq(&pair).is_some() || is_near(pair) {
                act(pair);
            }
        }
        deep.for_each(act);
    }
}

impl Surfaces<2> for SurfaceVertices {
    fn vertices(&self) -> &SurfaceVertices {
        self
    }

    fn spare(&self) -> f64 {
        self.greatest_edge()
    }

    fn is_within(&self, x: &[f64], pair: Pair, distance: f64) -> bool {
        squared_distance(self, x, pair) < distance * distance
    }

    fn find_swept(&self, grid: &mut Grid, [start, _]: [&[f64]; 2], (first, _): (f64, f64), pairs: &mut Vec<Pair>) {
        self.find(grid, start, first, pairs);
    }

    fn find(&self, grid: &mut Grid, x: &[f64], distance: f64, pairs: &mut Vec<Pair>) {
        /// Most cells of an edge along an axis.
        const MOST: i64 = 16;
        pairs.clear();
        let Grid { cells, long, .. } = grid;
        let cell = distance + self.greatest_edge();
        let place = |coordinate: f64| libm::floor(coordinate / cell) as i64;
        let key = |column: i64, row: i64| ((column as u64) << 32) ^ (row as u64 & 0xffff_ffff);
        cells.clear();
        long.clear();
        for (number, edge) in self.edges().iter().enumerate() {
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
        for (number, vertex) in self.iter().enumerate() {
            let [px, py] = vector(x, vertex.vertex);
            let own = key(place(px), place(py));
            let from = cells.partition_point(|(cell, _)| *cell < own);
            let here = cells[from..].iter().take_while(|(cell, _)| *cell == own).map(|(_, edge)| *edge);
            for edge in here.chain(long.iter().copied()) {
                let found = [edge, number as u32];
                let apart = !self.edges()[edge as usize].ends.contains(&vertex.vertex);
                if apart && squared_distance(self, x, found) < distance * distance {
                    pairs.push(found);
                }
            }
        }
        pairs.sort_unstable();
    }
}

impl List {
    /// Remembers the positions that the list is of.
    fn mark<const D: usize>(&mut self, surface: &SurfaceVertices, x: &[f64]) {
        self.at.clear();
        self.at.extend(surface.iter().flat_map(|vertex| coordinates::<D>(x, vertex.vertex)));
        self.moved = 0.0;
    }

    /// Whether no vertex has moved by more than a distance \[m\], less common displacements.
    fn holds<const D: usize>(&mut self, surface: &SurfaceVertices, x: &[f64], distance: f64) -> bool {
        if self.at.len() != D * surface.len() {
            return false;
        }
        let (at, x) = (self.at.as_chunks::<D>().0, x.as_chunks::<D>().0);
        self.moved = spread(surface, |place, vertex| minus(x[vertex as usize], at[place]), &mut self.spreads);
        // NaN fails the comparison.
        self.moved <= distance
    }
}

/// Displacements of each part deviate from a common one by at most as much as is written to `spreads`, and those of all vertices from another
/// one by at most as much as is returned \[m\]; NaN if one of them is that. The common one of a part is the middle of a box around its displacements: one pass finds
/// it, and the bound is at most the square root of D times the least one.
pub(super) fn spread<const D: usize>(
    surface: &SurfaceVertices,
    displacement: impl Fn(usize, u32) -> [f64; D],
    spreads: &mut Vec<f64>,
) -> f64 {
    spreads.clear();
    let mut middles: Option<Extent<D>> = None;
    let mut farthest = 0.0;
    for part in 0..surface.parts() {
        let places = surface.vertices_of(part);
        let vertices = &surface.listed()[places.clone()];
        let Some(extent) = Extent::of(vertices.len(), |own| displacement(places.start + own, vertices[own].vertex))
        else {
            spreads.push(0.0);
            continue;
        };
        spreads.push(extent.radius());
        farthest = greater(farthest, extent.radius());
        middles = Some(middles.unwrap_or(Extent::at(extent.middle())).with(extent.middle()));
    }
    farthest + middles.map_or(0.0, Extent::radius)
}

/// Least and greatest coordinates of some vectors.
#[derive(Clone, Copy)]
struct Extent<const D: usize> {
    least: [f64; D],
    greatest: [f64; D],
    /// Zero, or NaN if a coordinate is not finite.
    check: [f64; D],
}

impl<const D: usize> Extent<D> {
    const fn at(vector: [f64; D]) -> Self {
        Self { least: vector, greatest: vector, check: [0.0; D] }
    }

    /// Extent of vectors by their numbers.
    #[inline(always)]
    fn of(count: usize, vector: impl Fn(usize) -> [f64; D]) -> Option<Self> {
        if count == 0 {
            return None;
        }
        // Two at once, as each comparison waits for the one before.
        let [mut even, mut odd] = [Self::at(vector(0)); 2];
        for number in 0..count / 2 {
            even = even.with(vector(2 * number));
            odd = odd.with(vector(2 * number + 1));
        }
        even = even.with(vector(count - 1));
        let check = std::array::from_fn(|axis| even.check[axis] + odd.check[axis]);
        Some(Self { check, ..even.with(odd.least).with(odd.greatest) })
    }

    /// The extent with another vector.
    #[inline(always)]
    fn with(self, vector: [f64; D]) -> Self {
        let Self { least, greatest, check } = self;
        Self {
            least: std::array::from_fn(|axis| if vector[axis] < least[axis] { vector[axis] } else { least[axis] }),
            greatest: std::array::from_fn(
                |axis| if vector[axis] > greatest[axis] { vector[axis] } else { greatest[axis] },
            ),
            check: std::array::from_fn(|axis| check[axis] + 0.0 * vector[axis]),
        }
    }

    fn middle(self) -> [f64; D] {
        std::array::from_fn(|axis| 0.5 * (self.least[axis] + self.greatest[axis]))
    }

    /// Greatest distance of a vector from the middle, or more.
    fn radius(self) -> f64 {
        0.5 * length(minus(self.greatest, self.least)) + self.check.iter().sum::<f64>()
    }
}

/// Difference of two vectors.
pub(super) fn minus<const D: usize>(a: [f64; D], b: [f64; D]) -> [f64; D] {
    std::array::from_fn(|axis| a[axis] - b[axis])
}

/// The greater of two numbers; NaN if one of them is that.
pub(super) const fn greater(one: f64, other: f64) -> f64 {
    if one.is_nan() || other <= one { one } else { other }
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
