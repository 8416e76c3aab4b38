//! Obstacle: a solid polygon.

use super::{Obstacle, ObstacleParameters, Similarity, segments_meet, solid::Solid};
use crate::{
    meshes::{merged, size},
    quantity::{Coordinate, Point, Quantity, Reach},
};
use parry2d::{
    math::Vector,
    shape::{Polyline, PolylineFlags},
};
use serde::{Deserialize, Serialize};

/// Corners nearer than this share of the size are at the same place: walls may be very thin.
const ROUND_OFF: f64 = 1e-12;

/// A solid simple polygon, convex or not.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Polygon {
    /// Corners in order, either way round \[m\]. One at the place of the one before is passed over, and so is the first repeated at the end.
    pub points: Vec<Point>,
    /// How near a vertex feels it \[m\].
    pub eps: Reach,
}

/// Most corners: whether sides cross is found by looking at all pairs.
const MOST_CORNERS: usize = 1000;

impl Default for Polygon {
    fn default() -> Self {
        let point = |x, y| Point(Coordinate::literal(x), Coordinate::literal(y));
        Self { points: vec![point(0.4, 0.1), point(0.6, 0.1), point(0.5, 0.25)], eps: Reach::literal(0.01) }
    }
}

impl Polygon {
    /// The corners as they are given, those at the place of the one before left out, with the number of each.
    fn apart(&self) -> Vec<(usize, [f64; 2])> {
        let given: Vec<_> = self.points.iter().map(|point| point.get()).collect();
        merged(&given, ROUND_OFF * size(&given)).into_iter().map(|number| (number, given[number])).collect()
    }

    /// The corners counter-clockwise.
    fn corners(&self) -> Vec<[f64; 2]> {
        let mut corners: Vec<_> = self.apart().into_iter().map(|(_, corner)| corner).collect();
        if signed_area(&corners) < 0.0 {
            corners.reverse();
        }
        corners
    }
}

impl ObstacleParameters for Polygon {
    fn build(&self) -> Result<Box<dyn Obstacle>, String> {
        if self.points.len() > MOST_CORNERS {
            return Err(format!("a polygon may have {MOST_CORNERS} corners, got {}", self.points.len()));
        }
        let corners = self.corners();
        if corners.len() < 3 {
            return Err(format!("a polygon needs three corners or more, got {}", corners.len()));
        }
        let (numbers, given): (Vec<_>, Vec<_>) = self.apart().into_iter().unzip();
        if let Some((i, j)) = crossing(&given).map(|(i, j)| (numbers[i], numbers[j])) {
            return Err(format!("a polygon's sides must not cross: sides {i} and {j} do"));
        }
        if signed_area(&corners) <= 0.0 {
            return Err("a polygon's corners must enclose an area: these lie in a line".to_owned());
        }
        let count = corners.len() as u32;
        let sides = (0..count).map(|i| [i, (i + 1) % count]).collect();
        let points = corners.iter().map(|[x, y]| Vector::new(*x, *y)).collect();
        let shape = Polyline::with_flags(points, Some(sides), PolylineFlags::ORIENTED);
        let around: Vec<_> = (0..corners.len()).map(|i| [corners[i], corners[(i + 1) % corners.len()]]).collect();
        let turns_left = |i: &usize| {
            let ([a, b], [_, c]) = (around[(i + around.len() - 1) % around.len()], around[*i]);
            signed_area(&[a, b, c]) > 0.0
        };
        let outer: Vec<_> = (0..corners.len()).filter(turns_left).map(|i| corners[i]).collect();
        let is_convex = outer.len() == corners.len();
        Ok(Box::new(Solid::in_plane(shape, [0.0, 0.0], self.eps.get()).with_corners(0.0, &outer, is_convex)))
    }

    /// The mean of the corners.
    fn place(&self) -> [f64; 3] {
        let count = self.points.len().max(1) as f64;
        let mean = |axis: usize| self.points.iter().map(|point| point.get()[axis]).sum::<f64>() / count;
        [mean(0), mean(1), 0.0]
    }

    fn arrange(&mut self, by: &Similarity) -> Option<()> {
        self.points = self.points.iter().map(|point| by.of_point(*point)).collect::<Option<_>>()?;
        Some(())
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.eps]
    }

    fn notes(&self) -> Option<String> {
        let closed = self.points.len() > 1 && self.points.first() == self.points.last();
        let merged = self.points.len() - self.apart().len() - usize::from(closed);
        (merged > 0).then(|| {
            format!("{merged} of the polygon's corners lie at the place of the one before and are merged with it")
        })
    }

    /// Each corner moves out along its bisector so that both sides end up eps further out.
    fn outline(&self) -> Vec<[f64; 2]> {
        let corners = self.corners();
        let count = corners.len();
        let normal = |i: usize| {
            let ([ax, ay], [bx, by]) = (corners[i % count], corners[(i + 1) % count]);
            let length = ((bx - ax) * (bx - ax) + (by - ay) * (by - ay)).sqrt().max(f64::MIN_POSITIVE);
            [(by - ay) / length, (ax - bx) / length]
        };
        let moved = |i: usize| {
            let ([ax, ay], [bx, by]) = (normal(i + count - 1), normal(i));
            let shift = self.eps.get() / (1.0 + ax * bx + ay * by).max(0.1);
            [corners[i][0] + shift * (ax + bx), corners[i][1] + shift * (ay + by)]
        };
        (0..count).map(moved).collect()
    }
}

/// Twice the area, positive when counter-clockwise \[m²\]; seen from a corner, so that it is exact also far from the origin.
fn signed_area(corners: &[[f64; 2]]) -> f64 {
    let Some(&[x, y]) = corners.first() else { return 0.0 };
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).map(|(a, b)| (a[0] - x) * (b[1] - y) - (a[1] - y) * (b[0] - x)).sum()
}

/// The first two sides that cross, counted from 0.
fn crossing(corners: &[[f64; 2]]) -> Option<(usize, usize)> {
    let count = corners.len();
    let pairs = (0..count).flat_map(|i| (i + 2..count).map(move |j| (i, j)));
    pairs
        .filter(|&(i, j)| (j + 1) % count != i)
        .find(|&(i, j)| segments_meet([corners[i], corners[i + 1]], [corners[j], corners[(j + 1) % count]]))
}
