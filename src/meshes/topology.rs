//! Topology of a mesh: neighbours, boundary loops and its errors, and fans.
//!
//! A fan is a pair of triangles that share an edge. Forces are assembled fan by fan. The four vertices of a fan are each
//! read once and receive one force; two separate triangles have six corners. Nearly every triangle of a mesh is paired.
//! The others form fans of one triangle.

use super::{MeshError, mesh::squared_distance};

/// Mark of a half-edge without a twin.
const BOUNDARY: u32 = u32::MAX;

/// Boundary edges `(from, to)` of counter-clockwise triangles of a mesh, with the body on their left.
pub fn boundary_edges(triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let edges = twins(triangles, 0).map(|twins| Topology { triangles, twins }.boundary_edges().collect());
    edges.unwrap_or_default()
}

/// Neighbours of counter-clockwise triangles. Half-edge `3 t + c` of triangle `t` runs from its corner `c` to the next.
pub(super) struct Topology<'a> {
    triangles: &'a [[u32; 3]],
    /// Opposite half-edge of each half-edge, or [`BOUNDARY`].
    twins: Vec<u32>,
}

impl<'a> Topology<'a> {
    /// Matches the edges of the triangles, whose vertex numbers are below `vertices`. Errors count vertices from `base`.
    ///
    /// # Errors
    /// [`MeshError::CrowdedEdge`], [`MeshError::Overlap`] or [`MeshError::BowTie`].
    pub(super) fn new(vertices: usize, triangles: &'a [[u32; 3]], base: usize) -> Result<Self, MeshError> {
        let twins = twins(triangles, base)?;
        let topology = Self { triangles, twins };
        match topology.bow_tie(vertices) {
            Some(vertex) => Err(MeshError::BowTie { vertex: vertex + base }),
            None => Ok(topology),
        }
    }

    /// The triangles.
    pub(super) const fn triangles(&self) -> &[[u32; 3]] {
        self.triangles
    }

    /// Opposite half-edge of each half-edge, or [`BOUNDARY`].
    pub(super) fn twins(&self) -> &[u32] {
        &self.twins
    }

    /// Boundary edges `(from, to)` with the body on their left, in the order of the triangles.
    pub(super) fn boundary_edges(&self) -> impl Iterator<Item = [u32; 2]> {
        (0..self.twins.len()).filter(|&half| self.twins[half] == BOUNDARY).map(|half| ends(self.triangles, half))
    }

    /// Boundary as closed loops with the body on their left: outer loops run counter-clockwise, holes clockwise.
    pub(super) fn boundary_loops(&self) -> Vec<Vec<u32>> {
        let mut next: Vec<[u32; 2]> = self.boundary_edges().collect();
        next.sort_unstable();
        let place = |vertex: u32| next.partition_point(|edge| edge[0] < vertex);
        let mut seen = vec![false; next.len()];
        let mut loops = Vec::new();
        for start in 0..next.len() {
            let mut one = Vec::new();
            let mut edge = start;
            while edge < next.len() && !seen[edge] {
                seen[edge] = true;
                one.push(next[edge][0]);
                edge = place(next[edge][1]);
            }
            if !one.is_empty() {
                loops.push(one);
            }
        }
        loops
    }

    /// Number of pieces that are connected by edges.
    pub(super) fn pieces(&self) -> usize {
        let mut seen = vec![false; self.triangles.len()];
        let mut pieces = 0;
        let mut todo = Vec::new();
        for start in 0..seen.len() {
            if seen[start] {
                continue;
            }
            pieces += 1;
            seen[start] = true;
            todo.push(start);
            while let Some(triangle) = todo.pop() {
                for &twin in &self.twins[3 * triangle..3 * triangle + 3] {
                    if twin != BOUNDARY && !std::mem::replace(&mut seen[twin as usize / 3], true) {
                        todo.push(twin as usize / 3);
                    }
                }
            }
        }
        pieces
    }

    /// First vertex whose triangles do not form one row around it.
    fn bow_tie(&self, vertices: usize) -> Option<usize> {
        let mut degree = vec![0_u32; vertices];
        let mut start = vec![BOUNDARY; vertices];
        for half in 0..self.twins.len() {
            let vertex = ends(self.triangles, half)[0] as usize;
            degree[vertex] += 1;
            // Counter-clockwise turns from the boundary reach all triangles. An inner vertex can start anywhere.
            if start[vertex] == BOUNDARY || self.twins[half] == BOUNDARY {
                start[vertex] = half as u32;
            }
        }
        (0..vertices).find(|&vertex| start[vertex] != BOUNDARY && self.around(start[vertex]) != degree[vertex])
    }

    /// Number of triangles reached by turning counter-clockwise around the start of a half-edge.
    fn around(&self, start: u32) -> u32 {
        let mut half = start;
        let mut count = 0;
        loop {
            count += 1;
            // Twin of the half-edge that enters the same vertex in this triangle.
            half = self.twins[(half / 3 * 3 + (half + 2) % 3) as usize];
            if half == BOUNDARY || half == start {
                return count;
            }
        }
    }
}

/// Ends of a half-edge.
fn ends(triangles: &[[u32; 3]], half: usize) -> [u32; 2] {
    let corners = triangles[half / 3];
    [corners[half % 3], corners[(half + 1) % 3]]
}

/// Opposite half-edges, found by sorting all edges by their ends.
fn twins(triangles: &[[u32; 3]], base: usize) -> Result<Vec<u32>, MeshError> {
    let mut edges: Vec<(u32, u32, u32)> = (0..3 * triangles.len())
        .map(|half| {
            let [from, to] = ends(triangles, half);
            (from.min(to), from.max(to), half as u32)
        })
        .collect();
    edges.sort_unstable();
    let mut twins = vec![BOUNDARY; edges.len()];
    for group in edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let (from, to) = (group[0].0 as usize + base, group[0].1 as usize + base);
        match *group {
            [_] => {}
            [(.., a), (.., b)] if ends(triangles, a as usize)[0] == ends(triangles, b as usize)[0] => {
                return Err(MeshError::Overlap { from, to });
            }
            [(.., a), (.., b)] => {
                twins[a as usize] = b;
                twins[b as usize] = a;
            }
            _ => return Err(MeshError::CrowdedEdge { from, to, count: group.len() }),
        }
    }
    Ok(twins)
}

/// Triangles of a fan, counter-clockwise; [`Fan::NONE`] in place of a missing second one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fan(pub [u32; 2]);

impl Fan {
    /// Placeholder for a missing second triangle.
    pub const NONE: u32 = u32::MAX;

    /// Triangles of the fan.
    pub fn triangles(self) -> impl Iterator<Item = u32> {
        self.0.into_iter().filter(|triangle| *triangle != Self::NONE)
    }

    /// Vertices of the fan: the middle vertex, then the others counter-clockwise. Without a second triangle the
    /// fourth repeats the second.
    pub fn corners(self, triangles: &[[u32; 3]]) -> [u32; 4] {
        let [first, second] = self.0;
        let [a, b, c] = triangles[first as usize];
        let Some(&second) = triangles.get(second as usize) else { return [a, b, c, b] };
        // The shared edge, reversed in the second triangle.
        let shared = |[end, middle, _]: &[u32; 3]| (0..3).any(|i| second[i] == *middle && second[(i + 1) % 3] == *end);
        let [end, middle, from] = [[a, b, c], [b, c, a]].into_iter().find(shared).unwrap_or([c, a, b]);
        let to = second.into_iter().find(|corner| *corner != end && *corner != middle).unwrap_or(from);
        [middle, from, end, to]
    }
}

/// Matching of triangles, each across its longest free edge. Triangles with one unpaired neighbour come first.
/// Source: R. M. Karp and M. Sipser, *Maximum matchings in sparse random graphs*, Proc. 22nd IEEE Symposium on
/// Foundations of Computer Science, 1981. Fans are in the order of their first triangles.
pub(super) fn fans(points: &[[f64; 2]], topology: &Topology<'_>) -> Vec<Fan> {
    let (triangles, twins) = (topology.triangles(), topology.twins());
    let length = |half: usize| {
        let [a, b] = ends(triangles, half).map(|vertex| points[vertex as usize]);
        squared_distance(a, b)
    };
    let mut partners = vec![Fan::NONE; triangles.len()];
    let free = |triangle: usize, partners: &[u32]| {
        let is_free = |half: &usize| twins[*half] != BOUNDARY && partners[twins[*half] as usize / 3] == Fan::NONE;
        let mut halves = [None; 3];
        halves.iter_mut().zip((3 * triangle..3 * triangle + 3).filter(is_free)).for_each(|(to, half)| *to = Some(half));
        halves.into_iter().flatten()
    };
    let mut lonely: Vec<_> = (0..triangles.len()).filter(|triangle| free(*triangle, &partners).count() == 1).collect();
    let mut others = 0..triangles.len();
    while let Some(triangle) = lonely.pop().or_else(|| others.next()) {
        if partners[triangle] != Fan::NONE {
            continue;
        }
        // Of edges of equal length the first is taken.
        let longest = |one: usize, other: usize| if length(other) > length(one) { other } else { one };
        let Some(half) = free(triangle, &partners).reduce(longest) else { continue };
        let partner = twins[half] as usize / 3;
        (partners[triangle], partners[partner]) = (partner as u32, triangle as u32);
        for neighbour in [triangle, partner].into_iter().flat_map(|triangle| free(triangle, &partners)) {
            let neighbour = twins[neighbour] as usize / 3;
            if free(neighbour, &partners).count() == 1 {
                lonely.push(neighbour);
            }
        }
    }
    let all = partners.into_iter().enumerate().map(|(triangle, partner)| [triangle as u32, partner]);
    all.filter(|[triangle, partner]| triangle < partner).map(Fan).collect()
}
