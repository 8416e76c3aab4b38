//! Bounded obstacles as shapes of parry, in the plane and in space.

use super::{Contact, Corner, Obstacle};

/// A closed surface in world coordinates.
pub trait ClosedSurface<const D: usize>: Send + Sync {
    /// The nearest point of the surface \[m\], and whether the point is inside.
    fn project(&self, point: [f64; D]) -> ([f64; D], bool);

    /// Least and greatest corner of a box around it \[m\].
    fn bounds(&self) -> [[f64; D]; 2];
}

/// A shape of parry2d at a place.
pub struct PlaneShape<S>(S, parry2d::math::Pose);

/// A shape of parry3d at a place.
pub struct SpaceShape<S>(S, parry3d::math::Pose);

impl<S: parry2d::shape::Shape> ClosedSurface<2> for PlaneShape<S> {
    fn project(&self, [x, y]: [f64; 2]) -> ([f64; 2], bool) {
        let found =
            parry2d::query::PointQuery::project_point(&self.0, &self.1, parry2d::math::Vector::new(x, y), false);
        (found.point.into(), found.is_inside)
    }

    fn bounds(&self) -> [[f64; 2]; 2] {
        let bounds = self.0.compute_aabb(&self.1);
        [bounds.mins.into(), bounds.maxs.into()]
    }
}

impl<S: parry3d::shape::Shape> ClosedSurface<3> for SpaceShape<S> {
    fn project(&self, [x, y, z]: [f64; 3]) -> ([f64; 3], bool) {
        let point = parry3d::math::Vector::new(x, y, z);
        let found = parry3d::query::PointQuery::project_point(&self.0, &self.1, point, false);
        (found.point.into(), found.is_inside)
    }

    fn bounds(&self) -> [[f64; 3]; 2] {
        let bounds = self.0.compute_aabb(&self.1);
        [bounds.mins.into(), bounds.maxs.into()]
    }
}

/// A bounded shape in world coordinates.
pub struct Solid<const D: usize, S> {
    surface: S,
    /// Box around what is nearer than eps \[m\].
    near: [[f64; D]; 2],
    /// eps, at least a fraction of the size above round-off \[m\].
    eps: f64,
    /// Half of the diagonal of that box \[m\].
    size: f64,
    corners: Vec<Corner<D>>,
    is_convex: bool,
    /// Radius of a sphere \[m\]; `None` for what may have sharp edges.
    radius: Option<f64>,
}

/// Least eps as a fraction of the size.
const LEAST: f64 = 1e-4;

impl<S: parry2d::shape::Shape> Solid<2, PlaneShape<S>> {
    /// A shape of the plane at a point, with its contact margin \[m\].
    pub fn in_plane(shape: S, [x, y]: [f64; 2], eps: f64) -> Self {
        let pose = parry2d::math::Pose::from_translation(parry2d::math::Vector::new(x, y));
        Self::new(PlaneShape(shape, pose), eps)
    }
}

impl<S: parry3d::shape::Shape> Solid<3, SpaceShape<S>> {
    /// A shape in space at a place, with its contact margin \[m\].
    pub fn in_space(shape: S, pose: parry3d::math::Pose, eps: f64) -> Self {
        Self::new(SpaceShape(shape, pose), eps)
    }
}

impl<const D: usize, S: ClosedSurface<D>> Solid<D, S> {
    fn new(surface: S, eps: f64) -> Self {
        let bounds = surface.bounds();
        let eps = eps.max(LEAST * half_diagonal(bounds));
        let near = loosened(bounds, eps);
        Self { surface, near, eps, size: half_diagonal(near), corners: Vec::new(), is_convex: true, radius: None }
    }

    /// Tells that it is a sphere of a radius \[m\].
    pub const fn with_radius(mut self, radius: f64) -> Self {
        self.radius = Some(radius);
        self
    }

    /// Sets the radius and the centres of its convex corners, and whether all of its corners are convex.
    pub fn with_corners(mut self, radius: f64, corners: &[[f64; D]], is_convex: bool) -> Self {
        self.corners = corners.iter().map(|&middle| Corner { middle, radius, margin: self.eps }).collect();
        self.is_convex = is_convex;
        self
    }

    /// Vector to or from the nearest point of the surface, outwards, and the distance \[m\]; negative inside.
    fn nearest(&self, point: [f64; D]) -> ([f64; D], f64) {
        let (nearest, is_inside) = self.surface.project(point);
        let sign = if is_inside { -1.0 } else { 1.0 };
        let away = std::array::from_fn(|axis| sign * (point[axis] - nearest[axis]));
        (away, sign * length(away))
    }

    /// Gradient direction of the distance by central differences, for points so near to the surface that the difference
    /// vector is round-off.
    fn slope(&self, point: [f64; D]) -> Option<[f64; D]> {
        let step = 1e-5 * self.size;
        normalised(std::array::from_fn(|axis| {
            self.nearest(moved(point, axis, step)).1 - self.nearest(moved(point, axis, -step)).1
        }))
    }
}

/// A point moved along an axis \[m\].
fn moved<const D: usize>(mut point: [f64; D], axis: usize, by: f64) -> [f64; D] {
    point[axis] += by;
    point
}

/// Length of a vector.
fn length<const D: usize>(vector: [f64; D]) -> f64 {
    (1..D).fold(vector[0] * vector[0], |sum, axis| sum + vector[axis] * vector[axis]).sqrt()
}

/// A vector of length one; `None` for zero.
fn normalised<const D: usize>(vector: [f64; D]) -> Option<[f64; D]> {
    let scale = 1.0 / length(vector);
    (scale.is_finite() && scale > 0.0).then(|| vector.map(|along| along * scale))
}

/// Half of the diagonal of a box \[m\].
fn half_diagonal<const D: usize>([least, greatest]: [[f64; D]; 2]) -> f64 {
    length(std::array::from_fn::<_, D, _>(|axis| (greatest[axis] - least[axis]) * 0.5))
}

/// A box with all its sides moved outwards \[m\].
fn loosened<const D: usize>([least, greatest]: [[f64; D]; 2], by: f64) -> [[f64; D]; 2] {
    [least.map(|along| along - by), greatest.map(|along| along + by)]
}

/// Sets components within round-off of zero to zero, so that a contact along one axis leaves the other coordinates unchanged.
fn snapped<const D: usize>(normal: [f64; D]) -> [f64; D] {
    const ROUND_OFF: f64 = 1e-9;
    normal.map(|value| if value.abs() < ROUND_OFF { 0.0 } else { value })
}

impl<const D: usize, S: ClosedSurface<D>> Obstacle<D> for Solid<D, S> {
    fn distance(&self, point: [f64; D], reach: f64) -> Option<Contact<D>> {
        let [least, greatest] = loosened(self.near, (reach - self.eps).max(0.0));
        if (0..D).any(|axis| point[axis] < least[axis] || point[axis] > greatest[axis]) {
            return None;
        }
        let (mut away, mut distance) = self.nearest(point);
        if away == [0.0; D] {
            // At the centre of a ball every direction is equally short; a point beside it has one.
            let beside = self.nearest(moved(point, 1, 1e-6 * self.size));
            if beside.1 < -1e-5 * self.size {
                (away, distance) = beside;
            }
        }
        if distance >= reach {
            return None;
        }
        let near = distance.abs() < 1e-7 * self.size;
        let normal = snapped(if near { self.slope(point) } else { normalised(away) }?);
        Some(Contact { distance, normal })
    }

    fn is_near(&self, least: [f64; D], greatest: [f64; D]) -> bool {
        let [near, far] = self.near;
        let meets = (0..D).all(|axis| near[axis] <= greatest[axis] && far[axis] >= least[axis]);
        // A box in a hollow of a polygon is far from its surface.
        let middle = || std::array::from_fn(|axis| (least[axis] + greatest[axis]) * 0.5);
        meets && self.nearest(middle()).1 < half_diagonal([least, greatest]) + self.eps
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

    /// A plane through points at the distance r from a sphere of radius R is farther than R from its centre while their circle has a radius below
    /// `sqrt((R + r)² - R²)`; equilateral triangles have such a circle with sides sqrt(3) times as long. Of two points at the distance r from both faces of a right-angled edge,
    /// the segment between them passes the edge at a distance while it is shorter than `2 sqrt(2) r`.
    fn spacing(&self, reach: f64) -> f64 {
        match self.radius {
            Some(radius) => (3.0 * reach * (2.0 * radius + reach)).sqrt(),
            None => 2.0 * std::f64::consts::SQRT_2 * reach,
        }
    }

    fn corners(&self) -> &[Corner<D>] {
        &self.corners
    }
}
