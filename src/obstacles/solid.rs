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

impl<S: Shape> Obstacle for Solid<S> {
    fn contact(&self, point: [f64; 2]) -> Option<Contact> {
        let point = Vector::new(point[0], point[1]);
        if !self.near.contains_local_point(point) {
            return None;
        }
        let projection = PointQuery::project_point(&self.shape, &self.pose, point, false);
        let away = if projection.is_inside { projection.point - point } else { point - projection.point };
        let distance = if projection.is_inside { -away.length() } else { away.length() };
        if distance >= self.eps {
            return None;
        }
        // Exactly on the surface there is no direction to measure: away from the middle is outwards enough for one step.
        let normal = away.try_normalize().or_else(|| (point - self.near.center()).try_normalize())?;
        Some(Contact { distance, normal: [normal.x, normal.y] })
    }
}
