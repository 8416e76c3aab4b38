//! Mesh of a disk in concentric rings.

use super::{Files, Mesh, MeshError, MeshSource, Whole};
use crate::quantity::{Coordinate, Point, Quantity, Radius, Rings};

/// A disk: ring `k` has `6 k` vertices, so that triangles stay nearly equilateral; `6 rings²` triangles in all.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Disk {
    /// Distance of the edge from the centre \[m\].
    pub radius: Radius,
    /// Number of rings.
    pub rings: Whole<Rings>,
    /// The centre \[m\].
    #[serde(default = "middle")]
    pub centre: Point,
}

/// Centre of the 1 m x 1 m world.
fn middle() -> Point {
    Point(Coordinate::literal(0.5), Coordinate::literal(0.5))
}

impl Default for Disk {
    fn default() -> Self {
        Self { radius: Radius::literal(0.25), rings: Whole::literal(Rings::literal(10.0)), centre: middle() }
    }
}

impl MeshSource for Disk {
    fn build(&self, _: &dyn Files) -> Result<Mesh, MeshError> {
        let rings = self.rings.count();
        let [x, y] = self.centre.get();
        let mut points = vec![[x, y]];
        let mut triangles = Vec::new();
        for ring in 1..=rings {
            let radius = self.radius.get() * f64::from(ring) / f64::from(rings);
            points.extend((0..6 * ring).map(|step| {
                let angle = std::f64::consts::TAU * f64::from(step) / f64::from(6 * ring);
                [x + radius * libm::cos(angle), y + radius * libm::sin(angle)]
            }));
            triangles.extend((0..6).flat_map(|sector| sector_triangles(ring, sector)));
        }
        Mesh::new(points, triangles)
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.radius, &mut self.rings]
    }

    fn onto_outline(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [from_x, from_y] = self.centre.get();
        let out = self.radius.get() / libm::hypot(x - from_x, y - from_y).max(f64::MIN_POSITIVE);
        [from_x + out * (x - from_x), from_y + out * (y - from_y)]
    }
}

/// Vertex number at a step along a ring. Ring 0 is the centre.
const fn vertex(ring: u32, step: u32) -> u32 {
    if ring == 0 { 0 } else { 1 + 3 * ring * (ring - 1) + step % (6 * ring) }
}

/// Triangles between a ring and the next inner one, in one sixth of the disk.
fn sector_triangles(ring: u32, sector: u32) -> impl Iterator<Item = [u32; 3]> {
    let outer = move |step| vertex(ring, sector * ring + step);
    let inner = move |step| vertex(ring - 1, sector * (ring - 1) + step);
    let outward = (0..ring).map(move |step| [outer(step), outer(step + 1), inner(step)]);
    let inward = (0..ring - 1).map(move |step| [inner(step), outer(step + 1), inner(step + 1)]);
    outward.chain(inward)
}
