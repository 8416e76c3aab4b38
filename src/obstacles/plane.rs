//! Obstacle: a half-plane.

use super::{Contact, Obstacle, ObstacleParameters, Similarity};
use crate::quantity::{Coordinate, Point, Quantity, Reach};
use parry2d::{math::Vector, shape::HalfSpace};
use serde::{Deserialize, Serialize};

/// A straight wall without end: everything on the side its normal points to is free.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plane {
    /// A point of the wall \[m\].
    pub point: Point,
    /// Direction into the free side; any length but zero.
    pub normal: Point,
    /// How near a vertex feels it \[m\].
    pub eps: Reach,
}

impl Default for Plane {
    fn default() -> Self {
        let (zero, one) = (Coordinate::literal(0.0), Coordinate::literal(1.0));
        Self { point: Point(zero, zero), normal: Point(zero, one), eps: Reach::literal(0.01) }
    }
}

/// A plane ready for stepping.
#[derive(Clone, Debug)]
pub struct HalfPlane {
    shape: HalfSpace,
    origin: Vector,
    eps: f64,
}

impl HalfPlane {
    /// The half-plane beyond a point, with a unit normal into the free side, and its contact margin \[m\].
    pub fn new([x, y]: [f64; 2], [nx, ny]: [f64; 2], eps: f64) -> Self {
        Self { shape: HalfSpace::new(Vector::new(nx, ny)), origin: Vector::new(x, y), eps }
    }
}

impl Plane {
    /// The unit normal; `None` if the normal is zero.
    fn unit_normal(&self) -> Option<Vector> {
        let [x, y] = self.normal.get();
        Vector::new(x, y).try_normalize()
    }
}

impl ObstacleParameters for Plane {
    fn build(&self) -> Result<Box<dyn Obstacle>, String> {
        let Some(normal) = self.unit_normal() else {
            return Err(format!("a plane's normal must have a direction, got {:?}", self.normal.get()));
        };
        Ok(Box::new(HalfPlane::new(self.point.get(), normal.into(), self.eps.get())))
    }

    fn place(&self) -> [f64; 3] {
        let [x, y] = self.point.get();
        [x, y, 0.0]
    }

    fn arrange(&mut self, by: &Similarity) -> Option<()> {
        (self.point, self.normal) = (by.of_point(self.point)?, by.of_direction(self.normal)?);
        Some(())
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.eps]
    }

    fn outline(&self) -> Vec<[f64; 2]> {
        Vec::new()
    }

    fn plane(&self) -> Option<&Plane> {
        Some(self)
    }
}

impl Obstacle for HalfPlane {
    fn distance(&self, point: [f64; 2], reach: f64) -> Option<Contact> {
        let normal = self.shape.normal;
        let distance = (Vector::new(point[0], point[1]) - self.origin).dot(normal);
        (distance < reach).then_some(Contact { distance, normal: [normal.x, normal.y] })
    }

    /// Tests the corner that is farthest against the normal.
    fn is_near(&self, least: [f64; 2], greatest: [f64; 2]) -> bool {
        let normal = self.shape.normal;
        let x = if normal.x > 0.0 { least[0] } else { greatest[0] };
        let y = if normal.y > 0.0 { least[1] } else { greatest[1] };
        self.contact([x, y]).is_some()
    }

    fn margin(&self) -> f64 {
        self.eps
    }
}

/// The part of a rectangle in front of all planes, less eps: a convex polygon, counter-clockwise.
///
/// Each plane cuts the polygon that the earlier ones left (Sutherland and Hodgman, 1974).
pub fn free_region<'a>(planes: impl Iterator<Item = &'a Plane>, least: [f64; 2], greatest: [f64; 2]) -> Vec<[f64; 2]> {
    let mut polygon = vec![least, [greatest[0], least[1]], greatest, [least[0], greatest[1]]];
    for plane in planes {
        let Some(normal) = plane.unit_normal() else { continue };
        let [x, y] = plane.point.get();
        let height = |p: [f64; 2]| (p[0] - x) * normal.x + (p[1] - y) * normal.y - plane.eps.get();
        let mut kept = Vec::with_capacity(polygon.len() + 1);
        for (i, &to) in polygon.iter().enumerate() {
            let from = polygon[(i + polygon.len() - 1) % polygon.len()];
            let (before, after) = (height(from), height(to));
            if (before < 0.0) != (after < 0.0) {
                let t = before / (before - after);
                kept.push([from[0] + t * (to[0] - from[0]), from[1] + t * (to[1] - from[1])]);
            }
            if after >= 0.0 {
                kept.push(to);
            }
        }
        polygon = kept;
    }
    polygon
}
