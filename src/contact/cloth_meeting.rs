//! Vertices and triangles, and edges, of cloth in space that meet in a step.

use super::{
    ClothContact, ClothMesh, Pair,
    candidates::minus,
    cloth_mesh::ClothPair,
    space_points::{Feature, Point, along, cross, direction, nearest_of_segments, nearest_of_triangle},
    touch::dot,
    truncation::{MeetingPairs, Nearest},
};

impl MeetingPairs<3, 4> for ClothContact {
    type All = ClothMesh;

    fn surfaces(&self) -> &ClothMesh {
        self.mesh()
    }

    fn near(&self) -> f64 {
        self.reach()
    }

    fn parts(&self, pair: Pair) -> [u32; 2] {
        self.parts_of(pair)
    }

    fn are_apart(&self, parts: [u32; 2]) -> bool {
        self.between(parts).is_apart
    }

    fn can_touch(&self, pair: Pair) -> bool {
        let is_apart = self.are_apart(self.parts(pair));
        let is_connected = || match self.mesh().members(pair) {
            ClothPair::Vertex(triangle, place) => {
                let vertex = self.mesh().surface().at(place).vertex;
                self.mesh().triangles()[triangle as usize].corners.contains(&vertex)
            }
            ClothPair::Edges(..) => false,
        };
        !is_apart && !is_connected() && !self.is_excluded(pair)
    }

    fn thickness(&self, pair: Pair) -> f64 {
        self.between(self.parts_of(pair)).potential.thickness
    }

    fn vertices(&self, pair: Pair) -> [usize; 4] {
        let all = match self.mesh().members(pair) {
            ClothPair::Vertex(triangle, place) => {
                let [a, b, c] = self.mesh().triangles()[triangle as usize].corners;
                [self.mesh().surface().at(place).vertex, a, b, c]
            }
            ClothPair::Edges(one, other) => {
                let [[a, b], [c, d]] = [one, other].map(|edge| self.mesh().edges()[edge as usize].ends);
                [a, b, c, d]
            }
        };
        all.map(|vertex| vertex as usize)
    }

    fn first(&self, pair: Pair) -> usize {
        match self.mesh().members(pair) {
            ClothPair::Vertex(..) => 1,
            ClothPair::Edges(..) => 2,
        }
    }

    fn nearest(&self, pair: Pair, points: [Point; 4]) -> Nearest<3, 4> {
        match self.mesh().members(pair) {
            ClothPair::Vertex(..) => nearest_vertex(points),
            ClothPair::Edges(..) => nearest_edges(points),
        }
    }

    /// Surfaces that have a point in common at the start have crossed before, and pass freely.
    fn meeting(&self, start: &[f64], x: &[f64], pair: Pair) -> Option<f64> {
        let has_crossed = || self.nearest(pair, self.points(start, pair)).distance == 0.0;
        if self.is_far(start, x, pair) || has_crossed() { None } else { self.advanced(start, x, pair) }
    }
}

/// Nearest points of a vertex and a triangle.
fn nearest_vertex([p, a, b, c]: [Point; 4]) -> Nearest<3, 4> {
    let (feature, [la, lb, lc]) = nearest_of_triangle(p, [a, b, c]);
    let weights = [1.0, -la, -lb, -lc];
    if feature == Feature::Face {
        // Exact at any distance.
        let (normal, _) = direction(cross(minus(b, a), minus(c, a)));
        let height = dot(normal, minus(p, a));
        let normal = if height < 0.0 { normal.map(|n| -n) } else { normal };
        return Nearest { normal, weights, distance: height.abs() };
    }
    let point = std::array::from_fn(|axis| la * a[axis] + lb * b[axis] + lc * c[axis]);
    let (normal, distance) = direction(minus(p, point));
    Nearest { normal, weights, distance }
}

/// Nearest points of two edges.
fn nearest_edges([a, b, c, d]: [Point; 4]) -> Nearest<3, 4> {
    /// Square of the sine between edges that are taken for parallel.
    const PARALLEL: f64 = 1e-12;
    let [s, t] = nearest_of_segments([a, b], [c, d]);
    let weights = [1.0 - s, s, t - 1.0, -t];
    let between = minus(along([a, b], s), along([c, d], t));
    let (u, w) = (minus(b, a), minus(d, c));
    let across = cross(u, w);
    let are_within = [s, t].iter().all(|share| *share > 0.0 && *share < 1.0);
    if are_within && dot(across, across) > PARALLEL * dot(u, u) * dot(w, w) {
        // Exact at any distance.
        let (normal, _) = direction(across);
        let height = dot(normal, minus(a, c));
        let normal = if height < 0.0 { normal.map(|n| -n) } else { normal };
        return Nearest { normal, weights, distance: height.abs() };
    }
    let (normal, distance) = direction(between);
    Nearest { normal, weights, distance }
}
