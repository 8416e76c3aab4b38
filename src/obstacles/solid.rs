//! Bounded obstacles as shapes of parry2d.

use super::{Contact, Corner, Obstacle, advance};
use parry2d::{
    bounding_volume::{Aabb, BoundingVolume},
    math::{Pose, Vector},
    partitioning::{Bvh, BvhBuildStrategy},
    query::{PointQuery, Ray, RayCast},
    shape::{Segment, Shape},
};

/// A bounded shape in world coordinates.
pub struct Solid<S> {
    shape: S,
    pose: Pose,
    near: Aabb,
    /// eps, at least a fraction of the size above round-off \[m\].
    eps: f64,
    /// Segments; the surface is all points at `radius` from them.
    rim: Vec<Segment>,
    radius: f64,
    corners: Vec<Corner>,
    /// Bounding volume hierarchy of the segments, enlarged by eps.
    around: Bvh,
}

/// Least eps as a fraction of the size.
const LEAST: f64 = 1e-4;
/// Contact offset as a fraction of eps.
const OFFSET: f64 = 1e-3;

impl<S: Shape> Solid<S> {
    /// The shape at a point, with its contact margin \[m\].
    pub fn new(shape: S, [x, y]: [f64; 2], eps: f64) -> Self {
        let pose = Pose::from_translation(Vector::new(x, y));
        let bounds = shape.compute_aabb(&pose);
        let eps = eps.max(LEAST * bounds.half_extents().length());
        let near = bounds.loosened(eps);
        Self { shape, pose, near, eps, rim: Vec::new(), radius: 0.0, corners: Vec::new(), around: Bvh::new() }
    }

    /// Sets the surface, all points at a radius from one of the segments, and the centres of its corners.
    pub fn with_rim(mut self, rim: &[[[f64; 2]; 2]], radius: f64, corners: &[[f64; 2]]) -> Self {
        let point = |[x, y]: [f64; 2]| Vector::new(x, y);
        self.rim = rim.iter().map(|ends| Segment::new(point(ends[0]), point(ends[1]))).collect();
        self.radius = radius;
        let around = self.rim.iter().map(|side| side.local_aabb().loosened(radius + self.eps));
        self.around = Bvh::from_leaves(BvhBuildStrategy::Binned, &around.collect::<Vec<_>>());
        let corner = |&middle: &[f64; 2]| Corner { middle, radius, margin: self.eps, offset: OFFSET * self.eps };
        self.corners = corners.iter().map(corner).collect();
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
        self.near.intersects(&Aabb::new(Vector::new(least[0], least[1]), Vector::new(greatest[0], greatest[1])))
    }

    /// A box that is not near the surface is clear if one corner is outside.
    fn may_touch(&self, least: [f64; 2], greatest: [f64; 2]) -> bool {
        let [least, greatest] = [least, greatest].map(Vector::from);
        let bounds = Aabb::new(least, greatest);
        self.near.intersects(&bounds)
            && (self.around.intersect_aabb(&bounds).next().is_some() || self.nearest(least).1 < self.eps)
    }

    fn margin(&self) -> f64 {
        self.eps
    }

    fn offset(&self) -> f64 {
        OFFSET * self.eps
    }

    fn cast(&self, [x, y]: [f64; 2], [dx, dy]: [f64; 2]) -> Option<(f64, [f64; 2])> {
        let (from, direction) = (Vector::new(x, y), Vector::new(dx, dy));
        // Geometry has no result for a displacement that is not finite; the guard detects such steps.
        if !(from + direction).is_finite() {
            return None;
        }
        let path =
            Aabb::new(from.min(from + direction), from.max(from + direction)).loosened(self.radius + self.offset());
        if !self.near.intersects(&path) {
            return None;
        }
        let sides = self.rim.iter().filter(|side| side.local_aabb().intersects(&path));
        let touches = sides.filter_map(|side| advance::point(side, self.radius, self.offset(), from, direction));
        let first = touches.min_by(|(a, _), (b, _)| a.total_cmp(b))?;
        let normal = snapped(first.1);
        Some((first.0, [normal.x, normal.y]))
    }

    /// The first intersection of a ray from inside, the second from outside.
    fn depenetration_distance(&self, [x, y]: [f64; 2], [dx, dy]: [f64; 2]) -> Option<f64> {
        let (point, direction) = (Vector::new(x, y), Vector::new(dx, dy));
        let size = self.near.half_extents().length();
        let far = size + (point - self.near.center()).length();
        let next = |from: f64| {
            let ray = Ray::new(point + direction * from, direction);
            RayCast::cast_ray(&self.shape, &self.pose, &ray, far, false).map(|length| from + length)
        };
        let first = next(0.0)?;
        let is_inside = self.nearest(point).1 < 0.0;
        Some(if is_inside { first } else { next(first + 1e-6 * size).unwrap_or(first) })
    }

    /// Normals of its sides, at most 16 of them; eight directions for a round shape.
    fn each_direction(&self, act: &mut dyn FnMut([f64; 2])) {
        const MOST: usize = 16;
        for side in self.rim.iter().step_by(self.rim.len().div_ceil(MOST).max(1)) {
            let across = -(side.b - side.a).perp();
            match across.try_normalize() {
                Some(across) => act([across.x, across.y]),
                None => (0..8).for_each(|eighth| {
                    let angle = std::f64::consts::FRAC_PI_4 * f64::from(eighth);
                    act([libm::cos(angle), libm::sin(angle)]);
                }),
            }
        }
    }

    fn is_solid(&self) -> bool {
        true
    }

    fn corners(&self) -> &[Corner] {
        &self.corners
    }
}
