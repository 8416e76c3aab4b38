//! Topology of a mesh: neighbours, boundary loops and its errors.

use super::MeshError;

/// Mark of a half-edge without a twin.
pub(super) const BOUNDARY: u32 = u32::MAX;

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
pub(super) fn ends(triangles: &[[u32; 3]], half: usize) -> [u32; 2] {
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
