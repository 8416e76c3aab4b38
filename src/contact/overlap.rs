//! Bodies that overlap, and short ways out of each other.

use super::{SurfaceContact, touch::vector};
use crate::{effects::Bounds, obstacles::segments_cross};
use std::f64::consts::TAU;

/// Two bodies that should touch and overlap, or are nearer to each other than the thickness of their skin.
#[derive(Clone, Debug, PartialEq)]
pub struct Overlap {
    /// Numbers of the bodies, ascending.
    pub bodies: [usize; 2],
    /// Displacements of the second body after which a strip a little wider than the skin is thick separates it from the first, the
    /// shortest first \[m\].
    pub ways: Vec<[f64; 2]>,
    /// Greatest distance of a vertex inside the other body from its boundary, as a multiple of the thickness of the skin; infinite if
    /// edges cross and no vertex is inside, and 0 if they do not overlap.
    pub inside: f64,
    /// Speed at which they are moved apart: a tenth of the lower wave speed [m/s].
    pub speed: f64,
}

/// Number of directions that are tried.
const DIRECTIONS: usize = 64;

/// Width of the strip that is to separate two bodies, as a multiple of the thickness of the skin: enough for round-off.
const WIDE: f64 = 1.001;

impl SurfaceContact {
    /// The bodies that overlap or are within their skin at positions x \[m\], also those that are set aside.
    pub(super) fn overlapping(&self, x: &[f64]) -> Vec<Overlap> {
        let boxes: Vec<Bounds> = (0..self.surface().parts()).map(|part| Bounds::of(&self.points(x, part))).collect();
        let mut found = Vec::new();
        for other in 0..boxes.len() {
            for one in 0..other {
                let is_body = |part: usize| self.surface().is_body(part as u32);
                let can_meet = is_body(one) && is_body(other) && !self.between(one as u32, other as u32).is_apart;
                let thickness = self.between(one as u32, other as u32).potential.thickness;
                if can_meet && boxes[one].grown(thickness).meets(boxes[other]) {
                    found.extend(self.overlap(x, [one, other]));
                }
            }
        }
        found
    }

    /// Whether and how two bodies overlap.
    fn overlap(&self, x: &[f64], parts: [usize; 2]) -> Option<Overlap> {
        let [one, other] = parts;
        let between = self.between(one as u32, other as u32);
        let thickness = between.potential.thickness;
        let [[nearest, deepest], [other_nearest, other_deepest]] =
            [[one, other], [other, one]].map(|parts| self.distances(x, parts));
        let deepest = deepest.max(other_deepest);
        let inside = if deepest == 0.0 && self.crosses(x, parts) { f64::INFINITY } else { deepest / thickness };
        if inside == 0.0 && nearest.min(other_nearest) >= thickness {
            return None;
        }
        let points = parts.map(|part| self.points(x, part));
        let way = |number: usize| {
            let angle = TAU * number as f64 / DIRECTIONS as f64;
            let normal = [libm::cos(angle), libm::sin(angle)];
            let extent = |points: &[f64]| {
                let heights = points.as_chunks().0.iter().map(|[x, y]| normal[0] * x + normal[1] * y);
                heights
                    .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], height| [low.min(height), high.max(height)])
            };
            let depth = (extent(&points[0])[1] - extent(&points[1])[0] + WIDE * thickness).max(0.0);
            (depth, normal.map(|along| depth * along))
        };
        let mut ways: Vec<_> = (0..DIRECTIONS).map(way).collect();
        ways.sort_by(|(one, _), (other, _)| one.total_cmp(other));
        let speeds = parts.map(|part| self.surface().depenetration_speed(part as u32));
        Some(Overlap {
            bodies: parts.map(|part| self.surface().owner(part as u32)),
            ways: ways.into_iter().map(|(_, way)| way).collect(),
            inside,
            speed: speeds[0].min(speeds[1]),
        })
    }

    /// Positions of the vertices of a part \[m\], flat.
    fn points(&self, x: &[f64], part: usize) -> Vec<f64> {
        let vertices = self.surface().vertices_of(part);
        vertices.flat_map(|place| vector(x, self.surface().at(place as u32).vertex)).collect()
    }

    /// Least distance from the boundary of the first part of a vertex of the second, and the greatest of one inside it \[m\], 0 if none is.
    fn distances(&self, x: &[f64], [part, other]: [usize; 2]) -> [f64; 2] {
        let edges: Vec<u32> = (0..)
            .zip(self.surface().edges())
            .filter(|(_, edge)| edge.part == part as u32)
            .map(|(number, _)| number)
            .collect();
        let Some(first) = edges.first() else { return [f64::INFINITY, 0.0] };
        let (mut nearest, mut deepest) = (f64::INFINITY, 0.0_f64);
        for place in self.surface().vertices_of(other).map(|place| place as u32) {
            let distances = edges.iter().map(|edge| self.distance(x, [*edge, place]));
            let distance = distances.fold(f64::INFINITY, f64::min);
            nearest = nearest.min(distance);
            if self.is_inside(x, [*first, place]) {
                deepest = deepest.max(distance);
            }
        }
        [nearest, deepest]
    }

    /// Whether edges of two parts cross each other.
    fn crosses(&self, x: &[f64], parts: [usize; 2]) -> bool {
        let [one, other] = parts.map(|part| {
            let own = self.surface().edges().iter().filter(move |edge| edge.part == part as u32);
            own.map(|edge| edge.ends.map(|end| vector(x, end)))
        });
        one.into_iter().any(|edge| other.clone().any(|other| segments_cross(edge, other)))
    }
}
