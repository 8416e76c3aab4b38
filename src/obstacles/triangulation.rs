//! Surfaces of obstacles in space, to be drawn.

use super::Rigid;
use parry3d::math::{Pose, Vector};
use std::collections::BTreeMap;

/// Triangles of a surface in space, counter-clockwise seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Triangulation {
    /// Corners \[m\].
    pub points: Vec<[f64; 3]>,
    /// Triangles, by the numbers of their corners.
    pub triangles: Vec<[u32; 3]>,
    /// Middle of a piece of a surface without end \[m\]: the piece may be drawn larger about it.
    pub endless_about: Option<[f64; 3]>,
}

impl Triangulation {
    /// Triangles of a shape at a place.
    pub(super) fn new((points, triangles): (Vec<Vector>, Vec<[u32; 3]>), pose: Pose) -> Self {
        let points = points.into_iter().map(|point| (pose * point).into()).collect();
        Self { points, triangles, endless_about: None }
    }

    /// Unit normal of its first triangle, which is that of all of a plane; `None` if it has no area.
    pub fn normal(&self) -> Option<[f64; 3]> {
        let [a, b, c] = self.triangles.first()?.map(|corner| Vector::from(self.points[corner as usize]));
        (b - a).cross(c - a).try_normalize().map(Into::into)
    }

    /// The same surface in smaller triangles: each side of each is halved until none is longer than a length \[m\]. Small triangles can be sorted by
    /// depth among others.
    #[must_use]
    pub(super) fn refined(mut self, longest: f64) -> Self {
        /// Most halvings of a side.
        const MOST: usize = 4;
        for _ in 0..MOST {
            let length = |a: u32, b: u32| {
                let [a, b] = [a, b].map(|corner| self.points[corner as usize]);
                (0..3).map(|axis| (b[axis] - a[axis]) * (b[axis] - a[axis])).sum::<f64>().sqrt()
            };
            let all = self.triangles.iter().map(|[a, b, c]| length(*a, *b).max(length(*b, *c)).max(length(*c, *a)));
            if all.fold(0.0, f64::max) <= longest {
                break;
            }
            let mut halves = BTreeMap::new();
            let mut triangles = Vec::with_capacity(4 * self.triangles.len());
            for [a, b, c] in std::mem::take(&mut self.triangles) {
                let [ab, bc, ca] = [[a, b], [b, c], [c, a]].map(|[from, to]| {
                    *halves.entry([from.min(to), from.max(to)]).or_insert_with(|| {
                        let [from, to] = [from, to].map(|corner| self.points[corner as usize]);
                        self.points.push([0, 1, 2].map(|axis| 0.5 * (from[axis] + to[axis])));
                        self.points.len() as u32 - 1
                    })
                });
                triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
            }
            self.triangles = triangles;
        }
        self
    }

    /// A corner, farther from the middle by a factor if the surface has no end.
    pub fn drawn(&self, corner: usize, factor: f64) -> Option<[f64; 3]> {
        let point = *self.points.get(corner)?;
        let Some(about) = self.endless_about else { return Some(point) };
        Some([0, 1, 2].map(|axis| about[axis] + factor * (point[axis] - about[axis])))
    }

    /// The same surface after a rigid motion.
    #[must_use]
    pub fn moved(mut self, to: &Rigid<3>) -> Self {
        self.points.iter_mut().chain(&mut self.endless_about).for_each(|point| *point = to.point(*point));
        self
    }
}
