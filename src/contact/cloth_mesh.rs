//! Triangles of cloth in space, with their edges: which of them are near each other.

use super::{
    Grid, Pair, SurfaceVertices, Surfaces,
    candidates::minus,
    space_points::{Point, along, nearest_of_segments, nearest_of_triangle},
    touch::{coordinates, dot, length},
};
use std::{collections::BTreeSet, sync::Arc};

/// A triangle of cloth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ClothTriangle {
    /// Scene numbers of its corners.
    pub corners: [u32; 3],
    /// Numbers of its edges: each from a corner to the next.
    pub sides: [u32; 3],
    /// Number of its part in the list of [`SurfaceVertices`].
    pub part: u32,
}

/// An edge of cloth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClothEdge {
    /// Scene numbers of its ends, ascending.
    pub ends: [u32; 2],
    /// Number of its part in the list of [`SurfaceVertices`].
    pub part: u32,
    /// A third of the area of its triangles at rest \[m²\].
    pub area: f64,
    /// Length at rest \[m\].
    pub length: f64,
}

/// Triangles of cloth and their edges. A [`Pair`] is a triangle and the place of a vertex, or the number of triangles plus an edge, and
/// an edge of a higher number.
#[derive(Clone, Debug)]
pub struct ClothMesh {
    surface: Arc<SurfaceVertices>,
    triangles: Vec<ClothTriangle>,
    edges: Vec<ClothEdge>,
    /// Triangles around each vertex of the scene, one vertex after the other.
    around: Vec<u32>,
    /// Where those of each vertex begin, and their number.
    around_from: Vec<u32>,
    /// Length of the longest edge at rest \[m\].
    longest_edge: f64,
    /// Number of triangles at each edge.
    beside_counts: Vec<f64>,
    /// Number of triangles and of edges at each vertex of the scene.
    around_counts: Vec<[f64; 2]>,
}

/// Two surfaces that may be near each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ClothPair {
    /// A triangle, and the place of a vertex.
    Vertex(u32, u32),
    /// Two edges.
    Edges(u32, u32),
}

impl ClothMesh {
    /// The mesh of triangles with these corners, by their numbers in the scene; `rest` are the positions at rest \[m\]. Of triangles with
    /// the same corners one counts. Those with a corner twice, and those with a corner that has no skin, do not count.
    pub fn new(surface: &Arc<SurfaceVertices>, corners: impl Iterator<Item = [u32; 3]>, rest: &[f64]) -> Self {
        let part = |corner: u32| surface.place_of(corner).map(|place| surface.at(place).part);
        let mut known = BTreeSet::new();
        let mut is_new = |mut all: [u32; 3]| {
            all.sort_unstable();
            all[0] != all[1] && all[1] != all[2] && known.insert(all)
        };
        let has_skin = |all: &[u32; 3]| all.iter().all(|corner| part(*corner).is_some());
        let corners: Vec<_> = corners.filter(|all| has_skin(all) && is_new(*all)).collect();
        let sides = |[a, b, c]: [u32; 3]| [[a, b], [b, c], [c, a]].map(|[a, b]| [a.min(b), a.max(b)]);
        let mut ends: Vec<_> = corners.iter().flat_map(|corners| sides(*corners)).collect();
        ends.sort_unstable();
        ends.dedup();
        let number = |side: [u32; 2]| ends.partition_point(|other| *other < side) as u32;
        let triangle = |corners: &[u32; 3]| ClothTriangle {
            corners: *corners,
            sides: sides(*corners).map(number),
            part: part(corners[0]).unwrap_or(0),
        };
        let triangles: Vec<_> = corners.iter().map(triangle).collect();
        let edge = |ends: &[u32; 2]| {
            let [a, b] = ends.map(|end| coordinates::<3>(rest, end));
            ClothEdge { ends: *ends, part: part(ends[0]).unwrap_or(0), area: 0.0, length: length(minus(b, a)) }
        };
        let mut edges: Vec<_> = ends.iter().map(edge).collect();
        for triangle in &triangles {
            let [a, b, c] = triangle.corners.map(|corner| coordinates::<3>(rest, corner));
            let area = 0.5 * length(super::space_points::cross(minus(b, a), minus(c, a)));
            triangle.sides.iter().for_each(|side| edges[*side as usize].area += area / 3.0);
        }
        let mut star: Vec<_> = triangles
            .iter()
            .zip(0..)
            .flat_map(|(triangle, number)| triangle.corners.map(|corner| [corner, number]))
            .collect();
        star.sort_unstable();
        let vertices = (rest.len() / 3) as u32;
        let around_from = (0..=vertices).map(|vertex| star.partition_point(|[own, _]| *own < vertex) as u32).collect();
        let around = star.into_iter().map(|[_, number]| number).collect();
        let longest_edge = edges.iter().map(|edge| edge.length).fold(0.0, f64::max);
        let (mut beside_counts, mut around_counts) = (vec![0.0; edges.len()], vec![[0.0; 2]; vertices as usize]);
        for triangle in &triangles {
            triangle.sides.iter().for_each(|side| beside_counts[*side as usize] += 1.0);
            triangle.corners.iter().for_each(|corner| around_counts[*corner as usize][0] += 1.0);
        }
        for end in edges.iter().flat_map(|edge| edge.ends) {
            around_counts[end as usize][1] += 1.0;
        }
        Self {
            surface: Arc::clone(surface),
            triangles,
            edges,
            around,
            around_from,
            longest_edge,
            beside_counts,
            around_counts,
        }
    }

    /// The triangles.
    pub fn triangles(&self) -> &[ClothTriangle] {
        &self.triangles
    }

    /// The edges, in the order of their ends.
    pub fn edges(&self) -> &[ClothEdge] {
        &self.edges
    }

    /// All vertices with a skin, also those of no triangle.
    pub fn surface(&self) -> &SurfaceVertices {
        &self.surface
    }

    /// Triangles with this corner, ascending.
    pub fn around(&self, vertex: u32) -> impl Iterator<Item = u32> + Clone {
        let at = |vertex: u32| self.around_from[vertex as usize] as usize;
        self.around[at(vertex)..at(vertex + 1)].iter().copied()
    }

    /// Triangles with this side, ascending.
    pub fn beside(&self, edge: u32) -> impl Iterator<Item = u32> + Clone {
        let [vertex, _] = self.edges[edge as usize].ends;
        self.around(vertex).filter(move |triangle| self.triangles[*triangle as usize].sides.contains(&edge))
    }

    /// Length of the longest edge at rest \[m\].
    pub(super) const fn longest_edge(&self) -> f64 {
        self.longest_edge
    }

    /// Number of triangles with this side.
    pub(super) fn count_beside(&self, edge: u32) -> f64 {
        self.beside_counts[edge as usize]
    }

    /// Number of triangles and of edges at a vertex.
    pub(super) fn counts_around(&self, vertex: u32) -> [f64; 2] {
        self.around_counts[vertex as usize]
    }

    /// Whether a part has triangles. The particles of a net without triangles touch as points.
    pub fn has_triangles(&self, part: u32) -> bool {
        let first = self.surface.vertices_of(part as usize).map(|place| self.surface.at(place as u32).vertex);
        first.into_iter().any(|vertex| self.around(vertex).next().is_some())
    }

    /// What a pair is.
    pub(super) fn members(&self, [one, other]: Pair) -> ClothPair {
        let count = self.triangles.len() as u32;
        if one < count { ClothPair::Vertex(one, other) } else { ClothPair::Edges(one - count, other) }
    }

    /// Triangles that have a corner in common with one, some of them several times.
    pub(super) fn connected(&self, triangle: u32) -> impl Iterator<Item = u32> {
        self.triangles[triangle as usize].corners.into_iter().flat_map(|corner| self.around(corner))
    }

    /// Surface and vertex of the [`ContactName`](super::ContactName) of two edges: the second edge by its lower end, and by its place among the edges
    /// that begin there.
    pub(super) fn name_of_edges(&self, edge: u32, other: u32) -> [u32; 2] {
        let [end, _] = self.edges[other as usize].ends;
        let at = |end: u32| self.edges.partition_point(|edge| edge.ends[0] < end) as u32;
        let [first, next] = [at(end), at(end + 1)];
        let pair = edge.wrapping_mul(next - first).wrapping_add(other - first);
        [pair.wrapping_add(self.triangles.len() as u32), end]
    }

    /// Positions of the corners of a triangle \[m\].
    pub(super) fn corners(&self, x: &[f64], triangle: u32) -> [Point; 3] {
        self.triangles[triangle as usize].corners.map(|corner| coordinates(x, corner))
    }

    /// Positions of the ends of an edge \[m\].
    pub(super) fn ends(&self, x: &[f64], edge: u32) -> [Point; 2] {
        self.edges[edge as usize].ends.map(|end| coordinates(x, end))
    }

    /// Position of a vertex, by its place in the list \[m\].
    pub(super) fn point(&self, x: &[f64], place: u32) -> Point {
        coordinates(x, self.surface.at(place).vertex)
    }

    /// Vector from the nearest point of the first surface of a pair, a triangle or an edge, to that of the second one \[m\].
    pub(super) fn between(&self, x: &[f64], pair: Pair) -> Point {
        match self.members(pair) {
            ClothPair::Vertex(triangle, place) => {
                let (corners, point) = (self.corners(x, triangle), self.point(x, place));
                let (_, shares) = nearest_of_triangle(point, corners);
                std::array::from_fn(|axis| {
                    let [a, b, c] = corners.map(|corner| corner[axis]);
                    point[axis] - (shares[0] * a + shares[1] * b + shares[2] * c)
                })
            }
            ClothPair::Edges(one, other) => {
                let [one, other] = [one, other].map(|edge| self.ends(x, edge));
                let [s, t] = nearest_of_segments(one, other);
                minus(along(other, t), along(one, s))
            }
        }
    }

    /// Whether the boxes around the surfaces of a pair are within a distance \[m\].
    fn are_boxes_within(&self, x: &[f64], pair: Pair, distance: f64) -> bool {
        match self.members(pair) {
            ClothPair::Vertex(triangle, place) => {
                are_near(bounds(self.corners(x, triangle)), bounds([self.point(x, place)]), distance)
            }
            ClothPair::Edges(one, other) => are_near(bounds(self.ends(x, one)), bounds(self.ends(x, other)), distance),
        }
    }
}

impl Surfaces<3> for ClothMesh {
    fn vertices(&self) -> &SurfaceVertices {
        &self.surface
    }

    fn spare(&self) -> f64 {
        /// As a fraction of the length of the edges: longer lists are slower to go through, shorter ones are made anew sooner.
        const SHARE: f64 = 0.25;
        SHARE * self.surface.greatest_edge()
    }

    fn is_within(&self, x: &[f64], pair: Pair, distance: f64) -> bool {
        if !self.are_boxes_within(x, pair, distance) {
            return false;
        }
        let between = self.between(x, pair);
        dot(between, between) < distance * distance
    }

    fn find(&self, grid: &mut Grid, x: &[f64], distance: f64, pairs: &mut Vec<Pair>) {
        self.find_boxes(grid, &|vertex| bounds([coordinates(x, vertex)]), distance, pairs);
        pairs.retain(|pair| self.is_within(x, *pair, distance));
    }

    /// Those whose boxes around both places, relative to the mean displacement, are within the distance.
    fn find_swept(&self, grid: &mut Grid, [start, x]: [&[f64]; 2], (_, distance): (f64, f64), pairs: &mut Vec<Pair>) {
        let moved = |vertex: u32| minus(coordinates::<3>(x, vertex), coordinates(start, vertex));
        let sum = self.surface.iter().map(|vertex| moved(vertex.vertex));
        let sum = sum.fold([0.0; 3], |sum, moved| std::array::from_fn(|axis| sum[axis] + moved[axis]));
        let mean = sum.map(|sum| sum / self.surface.len() as f64);
        let swept = |vertex: u32| {
            let (from, moved) = (coordinates(start, vertex), minus(moved(vertex), mean));
            bounds([from, std::array::from_fn(|axis| from[axis] + moved[axis])])
        };
        self.find_boxes(grid, &swept, distance, pairs);
    }
}

impl ClothMesh {
    /// Most pairs for each triangle, edge and vertex whose boxes may be near each other.
    const MOST: usize = 2000;

    /// Writes all pairs whose boxes are within a distance \[m\] and that have no vertex in common, in their order. If they are too many, as
    /// where cloth has exploded, there are none, and contact does not act. `around` gives the box of a vertex.
    fn find_boxes(&self, grid: &mut Grid, around: &dyn Fn(u32) -> Box, distance: f64, pairs: &mut Vec<Pair>) {
        pairs.clear();
        let most = Self::MOST * (self.triangles.len() + self.edges.len() + self.surface.len());
        let of_triangle = |triangle: u32| united(self.triangles[triangle as usize].corners.map(around));
        let of_edge = |edge: u32| united(self.edges[edge as usize].ends.map(around));
        grid.fill(self.triangles.len(), distance, of_triangle);
        for (place, vertex) in self.surface.iter().enumerate() {
            let own = around(vertex.vertex);
            grid.each(grown(own, distance), |triangle| {
                let is_apart = !self.triangles[triangle as usize].corners.contains(&vertex.vertex);
                if is_apart && pairs.len() <= most && are_near(own, grid.boxes[triangle as usize], distance) {
                    pairs.push([triangle, place as u32]);
                }
            });
        }
        grid.fill(self.edges.len(), distance, of_edge);
        for edge in 0..self.edges.len() as u32 {
            let (own, [a, b]) = (grid.boxes[edge as usize], self.edges[edge as usize].ends);
            grid.each(grown(own, distance), |lower| {
                let ends = self.edges[lower as usize].ends;
                let is_apart = lower < edge && !ends.contains(&a) && !ends.contains(&b);
                if is_apart && pairs.len() <= most && are_near(own, grid.boxes[lower as usize], distance) {
                    pairs.push([self.triangles.len() as u32 + lower, edge]);
                }
            });
        }
        if pairs.len() > most {
            pairs.clear();
        }
        pairs.sort_unstable();
    }
}

/// The box around some boxes.
fn united<const N: usize>(all: [Box; N]) -> Box {
    let [[least, _], [_, greatest]] = [all.map(|[least, _]| least), all.map(|[_, greatest]| greatest)].map(bounds);
    [least, greatest]
}

/// Longest side of a box \[m\].
fn longest_side([least, greatest]: Box) -> f64 {
    (0..3).map(|axis| greatest[axis] - least[axis]).fold(0.0, f64::max)
}

/// Least and greatest corner of a box \[m\].
type Box = [Point; 2];

/// The box around some points.
fn bounds<const N: usize>(points: [Point; N]) -> Box {
    let (mut least, mut greatest) = (points[0], points[0]);
    for point in &points[1..] {
        for axis in 0..3 {
            least[axis] = least[axis].min(point[axis]);
            greatest[axis] = greatest[axis].max(point[axis]);
        }
    }
    [least, greatest]
}

/// A box that is greater by a distance on all sides.
fn grown([least, greatest]: Box, distance: f64) -> Box {
    [least.map(|least| least - distance), greatest.map(|greatest| greatest + distance)]
}

/// Whether two boxes are within a distance along each axis.
fn are_near([least, greatest]: Box, [other_least, other_greatest]: Box, distance: f64) -> bool {
    (0..3).all(|axis| other_least[axis] <= greatest[axis] + distance && least[axis] <= other_greatest[axis] + distance)
}

impl Grid {
    /// Most cells of a box along an axis.
    const MOST: i64 = 16;

    /// Puts each surface into the cell that the centre of its box is in. The cells are twice as long as the boxes are in the mean, and a
    /// distance \[m\]; longer boxes are in no cell. Where a number is not finite there are none, and the step is refused.
    fn fill(&mut self, count: usize, distance: f64, bounds: impl Fn(u32) -> Box) {
        self.cells.clear();
        self.long.clear();
        self.boxes.clear();
        self.boxes.extend((0..count as u32).map(bounds));
        let sides = self.boxes.iter().map(|own| longest_side(*own));
        self.cell = distance + 2.0 * sides.sum::<f64>() / count.max(1) as f64;
        if !(self.cell > 0.0 && self.cell.is_finite()) {
            return;
        }
        for (number, &[least, greatest]) in (0..).zip(&self.boxes) {
            if longest_side([least, greatest]) > self.cell {
                self.long.push(number);
            } else {
                let centre = [0, 1, 2].map(|axis| self.place(0.5 * (least[axis] + greatest[axis])));
                self.cells.push((key(centre), number));
            }
        }
        self.cells.sort_unstable();
    }

    fn place(&self, coordinate: f64) -> i64 {
        /// Cells farther away count as one.
        const FARTHEST: f64 = (1_u64 << 60) as f64;
        libm::floor(coordinate / self.cell).clamp(-FARTHEST, FARTHEST) as i64
    }

    /// Calls `act` for the surfaces whose boxes may meet a box.
    fn each(&self, own: Box, mut act: impl FnMut(u32)) {
        for number in &self.long {
            act(*number);
        }
        let [least, greatest] = grown(own, 0.5 * self.cell).map(|corner| corner.map(|number| self.place(number)));
        if (0..3).any(|axis| greatest[axis].saturating_sub(least[axis]) > Self::MOST) {
            for (_, number) in &self.cells {
                act(*number);
            }
            return;
        }
        for column in least[0]..=greatest[0] {
            for row in least[1]..=greatest[1] {
                // The keys of a row of cells follow each other, except where their last bits begin again.
                let mut layer = least[2];
                while layer <= greatest[2] {
                    let last = greatest[2].min(layer | LAYER);
                    let [first, last_key] = [layer, last].map(|layer| key([column, row, layer]));
                    let from = self.cells.partition_point(|(cell, _)| *cell < first);
                    for (_, number) in self.cells[from..].iter().take_while(|(cell, _)| *cell <= last_key) {
                        act(*number);
                    }
                    layer = last + 1;
                }
            }
        }
    }
}

/// Bits of the number of a cell along an axis, all set.
const LAYER: i64 = (1 << 21) - 1;

/// Key of a cell. Cells that are far apart may have the same one.
const fn key([column, row, layer]: [i64; 3]) -> u64 {
    ((column & LAYER) << 42 | (row & LAYER) << 21 | layer & LAYER).cast_unsigned()
}
