//! Bounded obstacles as shapes of parry2d.

use super::{Contact, Corner, Obstacle};
use parry2d::{
    bounding_volume::{Aabb, BoundingVolume},
    math::{Pose, Vector},
    query::PointQuery,
    shape::Shape,
};

/// A bounded shape in world coordinates.
pub struct Solid<S> {
    shape: S,
    pose: Pose,
    near: Aabb,
    /// eps, at least a fraction of the size above round-off \[m\].
    eps: f64,
    corners: Vec<Corner>,
    is_convex: bool,
}

/// Least eps as a fraction of the size.
const LEAST: f64 = 1e-4;

impl<S: Shape> Solid<S> {
    /// The shape at a point, with its contact margin \[m\].
    pub fn new(shape: S, [x, y]: [f64; 2], eps: f64) -> Self {
        let pose = Pose::from_translation(Vector::new(x, y));
        let bounds = shape.compute_aabb(&pose);
        let eps = eps.max(LEAST * bounds.half_extents().length());
        let near = bounds.loosened(eps);
        Self { shape, pose, near, eps, corners: Vec::new(), is_convex: true }
    }

    /// Sets the radius and the centres of its convex corners, and whether all of its corners are convex.
    pub fn with_corners(mut self, radius: f64, corners: &[[f64; 2]], is_convex: bool) -> Self {
        self.corners = corners.iter().map(|&middle| Corner { middle, radius, margin: self.eps }).collect();
        self.is_convex = is_convex;
        self
    }
}

impl<S: Shape> Solid<S> {
    /// Vector to or from the nearest point of the surface, outwards, and the distance \[m\]; negative inside.
    fn nearest(&self, point: Vector) -> (Vector, f64) {
        let projection = PointQuery::project_point(&self.shape, &self.pose, point, false);
        let away = if projection.is_inside { projection.point - point } else { point - projection.point };
        (away, if projection.is_inside { -away.length() } else { away.length() })
    }

    /// Gradient direction of the distance by central differences, for points so near to the surface that the difference
    /// vector is round-off.
    fn slope(&self, point: Vector) -> Option<Vector> {
        let step = 1e-5 * self.near.half_extents().length();
        let along = |axis: Vector| self.nearest(point + axis * step).1 - self.nearest(point - axis * step).1;
        Vector::new(along(Vector::X), along(Vector::Y)).try_normalize()
    }
}

/// Sets components within round-off of zero to zero, so that a contact along one axis leaves the other coordinate
/// unchanged.
fn snapped(normal: Vector) -> Vector {
    const ROUND_OFF: f64 = 1e-9;
    let kept = |value: f64| if value.abs() < ROUND_OFF { 0.0 } else { value };
    Vector::new(kept(normal.x), kept(normal.y))
}

impl<S: Shape> Obstacle for Solid<S> {
    fn distance(&self, point: [f64; 2], reach: f64) -> Option<Contact> {
        let point = Vector::new(point[0], point[1]);
        if !self.near.loosened((reach - self.eps).max(0.0)).contains_local_point(point) {
            return None;
        }
        let size = self.near.half_extents().length();
        let (mut away, mut distance) = self.nearest(point);
        if away == Vector::ZERO && self.nearest(point + Vector::Y * (1e-6 * size)).1 < -1e-5 * size {
            // At the centre of a ball every direction is equally short; a point beside it has one.
            (away, distance) = self.nearest(point + Vector::Y * (1e-6 * size));
        }
        if distance >= reach {
            return None;
        }
        let near = distance.abs() < 1e-7 * size;
        let normal = snapped(if near { self.slope(point) } else { away.try_normalize() }?);
        Some(Contact { distance, normal: [normal.x, normal.y] })
    }

    fn is_near(&self, least: [f64; 2], greatest: [f64; 2]) -> bool {
        let bounds = Aabb::new(Vector::new(least[0], least[1]), Vector::new(greatest[0], greatest[1]));
        // A box in a hollow of a polygon is far from its surface.
        self.near.intersects(&bounds) && self.nearest(bounds.center()).1 < bounds.half_extents().length() + self.eps
    }

    fn margin(&self) -> f64 {
        self.eps
    }

    fn is_solid(&self) -> bool {
        true
    }

    fn is_convex(&self) -> bool {
        self.is_convex
    }

    fn corners(&self) -> &[Corner] {
        &self.corners
    }
}
