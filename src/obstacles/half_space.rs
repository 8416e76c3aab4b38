//! Obstacle in space: a half-space, such as the floor.

use super::{Contact, Obstacle, ObstacleParameters, Similarity, Surfaces, Triangulation};
use crate::quantity::{Coordinate, Quantity, Reach, SpacePoint};
use serde::{Deserialize, Serialize};

/// A plane in space without end: everything on the side its normal points to is free.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HalfSpace {
    /// A point of the plane \[m\].
    pub point: SpacePoint,
    /// Direction into the free side; any length but zero.
    pub normal: SpacePoint,
    /// How near a vertex feels it \[m\].
    pub eps: Reach,
}

impl Default for HalfSpace {
    fn default() -> Self {
        let (zero, one) = (Coordinate::literal(0.0), Coordinate::literal(1.0));
        Self { point: SpacePoint(zero, zero, zero), normal: SpacePoint(zero, one, zero), eps: Reach::literal(0.01) }
    }
}

impl HalfSpace {
    /// The unit normal; `None` if the normal is zero.
    fn unit_normal(&self) -> Option<[f64; 3]> {
        let normal = self.normal.get();
        let length = normal.iter().map(|along| along * along).sum::<f64>().sqrt();
        (length > 0.0 && length.is_finite()).then(|| normal.map(|along| along / length))
    }
}

impl ObstacleParameters for HalfSpace {
    fn dimension(&self) -> usize {
        3
    }

    fn build_in_space(&self, _: &Surfaces) -> Result<Box<dyn Obstacle<3>>, String> {
        let Some(normal) = self.unit_normal() else {
            return Err(format!("a plane's normal must have a direction, got {:?}", self.normal.get()));
        };
        Ok(Box::new(Built { point: self.point.get(), normal, eps: self.eps.get() }))
    }

    fn place(&self) -> [f64; 3] {
        self.point.get()
    }

    fn arrange(&mut self, by: &Similarity) -> Option<()> {
        self.point = by.of_space_point(self.point)?;
        Some(())
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.eps]
    }

    /// A square about its point, in cells, so that cloth in front of it is sorted before it.
    fn triangulation(&self, _: &Surfaces) -> Triangulation {
        /// Half of the width \[m\], and cells along it.
        const HALF: f64 = 2.0;
        const CELLS: u32 = 24;
        let Some(normal) = self.unit_normal() else { return Triangulation::default() };
        let [x, y, z] = normal;
        let least = if x.abs() <= y.abs().min(z.abs()) { [1.0, 0.0, 0.0] } else { [0.0, 0.0, 1.0] };
        let cross = |a: [f64; 3], b: [f64; 3]| {
            [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        };
        let across = cross(normal, if y.abs() > 0.9 { [0.0, 0.0, 1.0] } else { least });
        let size = across.iter().map(|along| along * along).sum::<f64>().sqrt();
        let (u, origin) = (across.map(|along| along / size), self.point.get());
        let v = cross(normal, u);
        let along = |cell: u32| HALF * (2.0 * f64::from(cell) / f64::from(CELLS) - 1.0);
        let point = |i: u32, j: u32| [0, 1, 2].map(|axis| origin[axis] + along(i) * u[axis] + along(j) * v[axis]);
        let number = |i: u32, j: u32| i * (CELLS + 1) + j;
        let points = (0..=CELLS).flat_map(|i| (0..=CELLS).map(move |j| point(i, j))).collect();
        let cells = (0..CELLS).flat_map(|i| (0..CELLS).map(move |j| (i, j)));
        let triangles = cells.flat_map(|(i, j)| {
            let [a, b, c, d] = [number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)];
            [[a, b, c], [a, c, d]]
        });
        Triangulation { points, triangles: triangles.collect(), endless_about: Some(origin) }
    }
}

/// A half-space ready for stepping.
struct Built {
    point: [f64; 3],
    normal: [f64; 3],
    eps: f64,
}

impl Obstacle<3> for Built {
    fn distance(&self, point: [f64; 3], reach: f64) -> Option<Contact<3>> {
        let distance = (0..3).map(|axis| (point[axis] - self.point[axis]) * self.normal[axis]).sum::<f64>();
        (distance < reach).then_some(Contact { distance, normal: self.normal })
    }

    /// Tests the corner that is farthest against the normal.
    fn is_near(&self, least: [f64; 3], greatest: [f64; 3]) -> bool {
        let corner = |axis: usize| if self.normal[axis] > 0.0 { least[axis] } else { greatest[axis] };
        self.contact([corner(0), corner(1), corner(2)]).is_some()
    }

    fn margin(&self) -> f64 {
        self.eps
    }
}
