use super::{Contact, Obstacle};
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
    eps: f64,
}

impl<S: Shape> Solid<S> {
    /// The shape moved to a point, with its reach [m].
    pub fn new(shape: S, [x, y]: [f64; 2], eps: f64) -> Self {
        let pose = Pose::from_translation(Vector::new(x, y));
        let near = shape.compute_aabb(&pose).loosened(eps);
        Self { shape, pose, near, eps }
    }
}

impl<S: Shape> Solid<S> {
    /// The nearest point of the surface, seen from a point, and the distance to it [m]; negative inside.
    fn nearest(&self, point: Vector) -> (Vector, f64) {
        let projection = PointQuery::project_point(&self.shape, &self.pose, point, false);
        let away = if projection.is_inside { projection.point - point } else { point - projection.point };
        (away, if projection.is_inside { -away.length() } else { away.length() })
    }

    /// The direction in which the distance grows, by differences: for points so near to the surface that the way to it is
    /// round-off.
    fn slope(&self, point: Vector) -> Option<Vector> {
        let step = 1e-5 * self.near.half_extents().length();
        let along = |axis: Vector| self.nearest(point + axis * step).1 - self.nearest(point - axis * step).1;
        Vector::new(along(Vector::X), along(Vector::Y)).try_normalize()
    }
}

impl<S: Shape> Obstacle for Solid<S> {
    fn contact(&self, point: [f64; 2]) -> Option<Contact> {
        let point = Vector::new(point[0], point[1]);
        if !self.near.contains_local_point(point) {
            return None;
        }
        let (away, distance) = self.nearest(point);
        if distance >= self.eps {
            return None;
        }
        let near = distance.abs() < 1e-7 * self.near.half_extents().length();
        let normal = if near { self.slope(point) } else { away.try_normalize() }?;
        Some(Contact { distance, normal: [normal.x, normal.y] })
    }

    fn is_near(&self, least: [f64; 2], greatest: [f64; 2]) -> bool {
        self.near.intersects(&Aabb::new(Vector::new(least[0], least[1]), Vector::new(greatest[0], greatest[1])))
    }
}
