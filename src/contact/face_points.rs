//! Points of the triangles of membranes at which they touch obstacles between their corners.

use super::{ClothMesh, ClothTriangle, SurfaceVertices};
use std::sync::Arc;

/// Most parts that a side is divided into.
const MOST: usize = 6;
/// Most points of a triangle, its corners aside.
const COUNT: usize = (MOST + 1) * (MOST + 2) / 2 - 3;

/// A point of a triangle that touches obstacles as a vertex does.
#[derive(Clone, Copy, Debug)]
pub struct FacePoint {
    /// Its triangle.
    pub triangle: u32,
    /// Its number among the points of triangles that are divided alike.
    pub number: u32,
    /// Barycentric coordinates.
    pub shares: [f64; 3],
    /// Area of the surface that belongs to it at rest \[m²\].
    pub area: f64,
}

/// A point of a divided triangle.
#[derive(Clone, Copy, Debug)]
struct Divided {
    shares: [f64; 3],
    /// Side that it is on, from this corner to the next.
    side: Option<usize>,
    number: u32,
}

/// Points of triangles at which they touch obstacles, so dense that sharp edges, corners and small spheres do not reach through between
/// them.
///
/// The sides of a triangle are divided into m equal parts, which makes m² triangles of equal size. The energy of the skin per area, integrated over each of them by
/// the mean of its corners, gives an inner point the area 2 A/m², a point of a side A/m² from each of its triangles, and a vertex its own
/// area over m². The sum is that of the vertices alone. With m = 1 vertices alone touch.
#[derive(Clone, Debug)]
pub struct FacePoints {
    mesh: ClothMesh,
    /// Share of the skin of the vertices that each triangle has, and shares of the triangles at each of its sides \[m²\]; zero for a side that belongs
    /// to a triangle before it.
    areas: Vec<(f64, [f64; 3])>,
    /// Area of all points at each vertex of the scene, by their shares \[m²\].
    spread: Vec<f64>,
    /// Longest side at rest of each part \[m\].
    longest: Vec<f64>,
    /// The points of a triangle whose sides are divided into 0, 1, 2, ... parts.
    divided: Vec<Vec<Divided>>,
}

impl FacePoints {
    /// Points of triangles with these corners, by their numbers in the scene; `rest` are the positions at rest \[m\].
    pub fn new(surface: &Arc<SurfaceVertices>, corners: impl Iterator<Item = [u32; 3]>, rest: &[f64]) -> Self {
        let mesh = ClothMesh::new(surface, corners, rest);
        let own = |corner: u32| {
            let area = surface.numbered(corner).map_or(0.0, |vertex| vertex.area);
            area / mesh.counts_around(corner)[0]
        };
        let all: Vec<f64> =
            mesh.triangles().iter().map(|triangle| triangle.corners.into_iter().map(own).sum()).collect();
        let of_side = |(triangle, side): (u32, u32)| {
            let is_first = mesh.beside(side).next() == Some(triangle);
            if is_first { mesh.beside(side).map(|other| all[other as usize]).sum() } else { 0.0 }
        };
        let sides = |triangle: u32| mesh.triangles()[triangle as usize].sides.map(|side| of_side((triangle, side)));
        let areas: Vec<_> = (0..).zip(&all).map(|(triangle, area)| (*area, sides(triangle))).collect();
        let (mut spread, mut longest) = (vec![0.0; rest.len() / 3], vec![0.0_f64; surface.parts()]);
        for (triangle, area) in mesh.triangles().iter().zip(&all) {
            triangle.corners.into_iter().for_each(|corner| spread[corner as usize] += area / 3.0);
        }
        for edge in mesh.edges() {
            longest[edge.part as usize] = longest[edge.part as usize].max(edge.length);
        }
        Self { mesh, areas, spread, longest, divided: (0..=MOST).map(divided).collect() }
    }

    /// The triangles.
    pub fn triangles(&self) -> &[ClothTriangle] {
        self.mesh.triangles()
    }

    /// Area of the skin that may belong to a vertex of the scene, by the shares of the points around it \[m²\].
    pub fn area_around(&self, vertex: u32) -> f64 {
        self.spread.get(vertex as usize).copied().unwrap_or(0.0)
    }

    /// Number of parts that the sides of a part of the surface are divided into, so that points are within a distance of each other \[m\].
    pub fn divisions(&self, part: u32, spacing: f64) -> usize {
        (self.longest[part as usize] / spacing).ceil().clamp(1.0, MOST as f64) as usize
    }

    /// The points of a triangle whose sides are divided into some number of parts. Those of a side belong to its first triangle.
    pub fn of(&self, triangle: u32, divisions: usize) -> impl Iterator<Item = FacePoint> {
        let (inside, sides) = self.areas[triangle as usize];
        let part = 1.0 / (divisions * divisions) as f64;
        self.divided[divisions].iter().filter_map(move |Divided { shares, side, number }| {
            let area = side.map_or(2.0 * inside, |side| sides[side]);
            (area > 0.0).then_some(FacePoint { triangle, number: *number, shares: *shares, area: part * area })
        })
    }

    /// A name of a point that does not depend on how triangles are numbered: its vertex, and a number.
    pub fn name(&self, point: &FacePoint) -> (u32, u32) {
        let [vertex, ..] = self.mesh.triangles()[point.triangle as usize].corners;
        let rank = self.mesh.around(vertex).take_while(|other| *other != point.triangle).count();
        (vertex, (rank * COUNT) as u32 + point.number)
    }

    /// The triangle of a point with this name, and the number of the point.
    pub fn named(&self, (vertex, number): (u32, u32)) -> Option<(u32, u32)> {
        let (rank, number) = (number as usize / COUNT, number % COUNT as u32);
        self.mesh.around(vertex).nth(rank).map(|triangle| (triangle, number))
    }
}

/// The points of a triangle whose sides are divided into m parts, its corners aside.
fn divided(m: usize) -> Vec<Divided> {
    let all = (0..=m).flat_map(|a| (0..=m - a).map(move |b| [a, b, m - a - b]));
    let inner = all.filter(|parts| parts.iter().all(|part| *part < m));
    let point = |(number, parts): (usize, [usize; 3])| {
        let shares = parts.map(|part| part as f64 / m as f64);
        // A point with no share of a corner is on the side opposite, which begins at the next corner.
        let side = parts.iter().position(|part| *part == 0).map(|corner| (corner + 1) % 3);
        Divided { shares, side, number: number as u32 }
    };
    inner.enumerate().map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The numbers of points that a triangle has, and their mean is its middle.
    #[test]
    fn triangles_are_divided_evenly() {
        for m in 1..=MOST {
            let points = divided(m);
            assert_eq!(points.len(), (m + 1) * (m + 2) / 2 - 3);
            assert!(points.len() <= COUNT);
            assert_eq!(points.iter().filter(|point| point.side.is_some()).count(), 3 * (m - 1));
            for point in &points {
                assert!((point.shares.iter().sum::<f64>() - 1.0).abs() < 1e-15);
                let Some(side) = point.side else { continue };
                assert!(point.shares[(side + 2) % 3] == 0.0 && point.shares[side] > 0.0);
            }
            for corner in 0..3 {
                let sum: f64 = points.iter().map(|point| point.shares[corner]).sum();
                assert!((sum - points.len() as f64 / 3.0).abs() < 1e-12);
            }
        }
    }
}
