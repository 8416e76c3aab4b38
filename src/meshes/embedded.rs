//! Points that move with a mesh: their location in it, and the lines and discs of icing made of them.
//!
//! Triangles are sorted once into square cells, so that a look-up tests only a few.

use super::mesh;

/// Tolerance in barycentric weight for points on a shared edge.
const TOLERANCE: f64 = 1e-9;

/// Point locator for the shape the mesh had at its construction.
pub struct Locator {
    corners: Vec<[[f64; 2]; 3]>,
    low: [f64; 2],
    cell: f64,
    columns: usize,
    rows: usize,
    /// `entries[starts[c]..starts[c + 1]]` are the triangles whose box meets cell `c`.
    starts: Vec<u32>,
    entries: Vec<u32>,
}

impl Locator {
    /// Builds the locator. `points` \[m\] are in the shape to search, not necessarily at rest.
    pub fn new(points: &[[f64; 2]], triangles: &[[u32; 3]]) -> Self {
        let mut corners: Vec<_> =
            triangles.iter().map(|corners| corners.map(|vertex| points[vertex as usize])).collect();
        let [low, high] = mesh::bounds(points);
        let (width, height) = (high[0] - low[0], high[1] - low[1]);
        // About one triangle per cell. A long thin body has at most 2000 cells along a side.
        let count = triangles.len().max(1) as f64;
        let mut cell = (width * height / count).sqrt().max(width.max(height) / 2000.0).max(f64::MIN_POSITIVE);
        loop {
            let (columns, rows) = ((width / cell) as usize + 1, (height / cell) as usize + 1);
            let mut locator = Self { corners, low, cell, columns, rows, starts: Vec::new(), entries: Vec::new() };
            // Long triangles lie in many cells. Cells are then enlarged, so that memory stays proportional to the mesh.
            if columns * rows == 1 || locator.entry_count() <= 32 * triangles.len() {
                locator.fill();
                return locator;
            }
            (corners, cell) = (locator.corners, 2.0 * cell);
        }
    }

    /// Triangle that contains a point \[m\], and the weights of its corners. On shared edges the lowest number is taken.
    pub fn locate(&self, point: [f64; 2]) -> Option<(usize, [f64; 3])> {
        let [column, row] = [0, 1].map(|axis| ((point[axis] - self.low[axis]) / self.cell + TOLERANCE).floor());
        if !(column >= 0.0 && row >= 0.0 && column < self.columns as f64 && row < self.rows as f64) {
            return None;
        }
        let cell = row as usize * self.columns + column as usize;
        self.entries[self.starts[cell] as usize..self.starts[cell + 1] as usize].iter().find_map(|&triangle| {
            let weights = barycentric(self.corners[triangle as usize], point);
            weights.iter().all(|&weight| weight >= -TOLERANCE).then_some((triangle as usize, weights))
        })
    }

    /// As [`Locator::locate`]. Outside the mesh it is the nearest triangle, with weights that still reproduce the
    /// point.
    /// `None` only for a mesh without triangles or a point that is not finite.
    pub fn locate_nearest(&self, point: [f64; 2]) -> Option<(usize, [f64; 3])> {
        self.locate(point).or_else(|| {
            let mut best = (f64::INFINITY, None);
            for (triangle, corners) in self.corners.iter().enumerate() {
                let distance = squared_distance_to(*corners, point);
                if distance < best.0 {
                    best = (distance, Some(triangle));
                }
            }
            best.1.map(|triangle| (triangle, barycentric(self.corners[triangle], point)))
        })
    }

    /// Embeds a point \[m\] in the body.
    pub fn embed(&self, point: [f64; 2]) -> Embedded {
        let (triangle, weights) = self.locate_nearest(point).unwrap_or((0, [1.0, 0.0, 0.0]));
        Embedded { triangle: triangle as u32, weights }
    }

    /// Total number of pairs of triangle and cell.
    fn entry_count(&self) -> usize {
        self.corners
            .iter()
            .map(|corners| self.span(corners))
            .map(|[left, right, bottom, top]| (right - left + 1) * (top - bottom + 1))
            .sum()
    }

    /// Fills all cells in two passes, counting and placing, without a list per cell.
    fn fill(&mut self) {
        let mut starts = vec![0_u32; self.columns * self.rows + 1];
        for corners in &self.corners {
            self.cells(corners).for_each(|cell| starts[cell + 1] += 1);
        }
        for cell in 1..starts.len() {
            starts[cell] += starts[cell - 1];
        }
        let mut next = starts.clone();
        let mut entries = vec![0; starts.last().map_or(0, |&end| end as usize)];
        for (triangle, corners) in self.corners.iter().enumerate() {
            for cell in self.cells(corners) {
                entries[next[cell] as usize] = triangle as u32;
                next[cell] += 1;
            }
        }
        (self.starts, self.entries) = (starts, entries);
    }

    /// Cells that a triangle's bounding box meets.
    fn cells(&self, corners: &[[f64; 2]; 3]) -> impl Iterator<Item = usize> + use<> {
        let columns = self.columns;
        let [left, right, bottom, top] = self.span(corners);
        (bottom..=top).flat_map(move |row| (left..=right).map(move |column| row * columns + column))
    }

    /// First and last column and row that a triangle's bounding box meets, with a margin for rounding.
    fn span(&self, corners: &[[f64; 2]; 3]) -> [usize; 4] {
        const MARGIN: f64 = 1e-6;
        let [low, high] = mesh::bounds(corners);
        let index = |value: f64, axis: usize, margin: f64, count: usize| {
            (((value - self.low[axis]) / self.cell + margin).max(0.0) as usize).min(count - 1)
        };
        let (columns, rows) = (self.columns, self.rows);
        [
            index(low[0], 0, -MARGIN, columns),
            index(high[0], 0, MARGIN, columns),
            index(low[1], 1, -MARGIN, rows),
            index(high[1], 1, MARGIN, rows),
        ]
    }
}

/// Barycentric weights of a point. Outside the triangle some are negative.
fn barycentric([a, b, c]: [[f64; 2]; 3], point: [f64; 2]) -> [f64; 3] {
    let whole = mesh::area([a, b, c]);
    let (second, third) = (mesh::area([a, point, c]) / whole, mesh::area([a, b, point]) / whole);
    [1.0 - second - third, second, third]
}

/// Squared distance from a point outside a triangle to its sides \[m²\].
fn squared_distance_to([a, b, c]: [[f64; 2]; 3], point: [f64; 2]) -> f64 {
    [[a, b], [b, c], [c, a]]
        .map(|[from, to]| mesh::squared_distance_to_side(from, to, point))
        .into_iter()
        .fold(f64::INFINITY, f64::min)
}

/// Point embedded in the body: a triangle and the weights of its three vertices, which sum to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Embedded {
    /// The triangle.
    pub triangle: u32,
    /// Weight of each corner.
    pub weights: [f64; 3],
}

impl Embedded {
    /// The same point in the four triangles that each is divided into, by [`Mesh::refined`](super::Mesh::refined).
    pub(super) fn refine(&mut self) {
        let corner = self.weights.iter().position(|weight| *weight >= 0.5);
        self.triangle = 4 * self.triangle + corner.unwrap_or(3) as u32;
        let [a, b, c] = self.weights;
        self.weights = match corner {
            Some(corner) => [0, 1, 2].map(|other| 2.0 * self.weights[other] - f64::from(u8::from(other == corner))),
            // The corners of the inner triangle are the middles ab, bc and ca.
            None => [1.0 - 2.0 * c, 1.0 - 2.0 * a, 1.0 - 2.0 * b],
        };
    }

    /// Present position of the point \[m\], for vertex positions `x` with two numbers per vertex.
    pub fn position(&self, triangles: &[[u32; 3]], x: &[f64]) -> [f64; 2] {
        let mut point = [0.0; 2];
        for (&vertex, weight) in triangles[self.triangle as usize].iter().zip(self.weights) {
            let start = 2 * vertex as usize;
            point[0] += weight * x[start];
            point[1] += weight * x[start + 1];
        }
        point
    }
}

/// Colour role of a stroke. The window's theme assigns the colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IcingColor {
    /// Royal icing.
    White,
    /// First candy.
    Red,
    /// Second candy.
    Green,
}

/// Line or area of icing, sampled finely so that it stays smooth when the body bends.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    /// Points in drawing order, none repeated.
    pub points: Vec<Embedded>,
    /// Whether the last point joins the first.
    pub closed: bool,
    /// Whether the inside is filled, for closed strokes.
    pub filled: bool,
    /// Line width \[m\].
    pub width: f64,
    /// Colour role.
    pub color: IcingColor,
}

impl Stroke {
    /// Line of the given width \[m\] through points of the body at rest \[m\].
    pub fn line(locator: &Locator, points: &[[f64; 2]], closed: bool, width: f64, color: IcingColor) -> Self {
        let points = points.iter().map(|&point| locator.embed(point)).collect();
        Self { points, closed, filled: false, width, color }
    }

    /// Filled area inside points of the body at rest \[m\].
    pub fn area(locator: &Locator, points: &[[f64; 2]], color: IcingColor) -> Self {
        Self { filled: true, ..Self::line(locator, points, true, 0.0, color) }
    }

    /// Present positions of the points \[m\], for vertex positions `x` with two numbers per vertex.
    pub fn positions(&self, triangles: &[[u32; 3]], x: &[f64]) -> impl Iterator<Item = [f64; 2]> {
        self.points.iter().map(move |point| point.position(triangles, x))
    }
}
