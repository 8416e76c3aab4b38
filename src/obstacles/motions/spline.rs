//! Motion: a smooth path through points at given times.

use super::{Motion, Rigid, Similarity};
use crate::quantity::{Coordinate, Point, Position, Quantity, Time};
use serde::{Deserialize, Serialize};

/// A displacement that is interpolated between points at increasing times by cubic polynomials. At an inner point the velocity is the difference of its two neighbours over
/// that of their times, so that it is continuous. At the first and the last point it is zero, and before and after them the displacement is constant. With two points
/// this is the smooth ramp `p0 + (p1 - p0) (3 s² - 2 s³)`. (Cubic Hermite interpolation with Catmull and Rom's tangents, *A class of local interpolating
/// splines*, Computer Aided Geometric Design, 1974.)
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Spline {
    /// Times \[s\], and displacements from the start \[m\].
    pub points: Vec<(Time, Position)>,
}

/// Least time between two points \[s\].
const SHORTEST: f64 = 1e-6;

impl Default for Spline {
    fn default() -> Self {
        let at =
            |time, x, y| (Time::literal(time), Position::Plane(Point(Coordinate::literal(x), Coordinate::literal(y))));
        Self { points: vec![at(0.0, 0.0, 0.0), at(1.0, 0.2, 0.0), at(2.0, 0.2, 0.1)] }
    }
}

impl Spline {
    /// Velocity at a point of the list [m/s].
    fn velocity(&self, point: usize) -> [f64; 3] {
        let (Some(before), Some(after)) = (point.checked_sub(1).map(|at| self.points[at]), self.points.get(point + 1))
        else {
            return [0.0; 3];
        };
        let (from, to, span) = (before.1.get(), after.1.get(), after.0.get() - before.0.get());
        std::array::from_fn(|axis| (to[axis] - from[axis]) / span)
    }

    /// What is wrong with it, if anything.
    pub(super) fn fault(&self) -> Option<String> {
        if self.points.is_empty() {
            return Some("a spline needs at least one point".to_owned());
        }
        let dimension = self.points[0].1.dimension();
        if self.points.iter().any(|(_, point)| point.dimension() != dimension) {
            return Some("the points of a spline must all have two coordinates, or all three".to_owned());
        }
        let is_early = |pair: &[(Time, Position)]| pair[1].0.get() - pair[0].0.get() < SHORTEST;
        let early = self.points.windows(2).position(is_early)?;
        let [one, other] = [early, early + 1].map(|point| self.points[point].0.get());
        Some(format!(
            "the times of a spline must increase by at least {SHORTEST:e} s, but after {one} s comes {other} s"
        ))
    }
}

impl Motion for Spline {
    fn at(&self, time: f64) -> Rigid<3> {
        let next = self.points.partition_point(|(at, _)| at.get() <= time);
        let still =
            |at: Option<&(Time, Position)>| Rigid { shift: at.map_or([0.0; 3], |at| at.1.get()), ..Rigid::STILL };
        let (Some(last), Some(to)) = (next.checked_sub(1), self.points.get(next)) else {
            return still(if next == 0 { self.points.first() } else { self.points.last() });
        };
        let from = &self.points[last];
        let span = to.0.get() - from.0.get();
        let s = (time - from.0.get()) / span;
        let (p, q, u, v) = (from.1.get(), to.1.get(), self.velocity(last), self.velocity(next));
        // h00 + h01 = 1, so that their derivatives are opposite.
        let (h01, h10, h11) = (s * s * (3.0 - 2.0 * s), s * (1.0 - s) * (1.0 - s), s * s * (s - 1.0));
        let (d01, d10, d11) = (6.0 * s * (1.0 - s), (1.0 - s) * (1.0 - 3.0 * s), s * (3.0 * s - 2.0));
        let shift = |axis: usize| p[axis] + h01 * (q[axis] - p[axis]) + span * (h10 * u[axis] + h11 * v[axis]);
        let velocity = |axis: usize| d01 * (q[axis] - p[axis]) / span + d10 * u[axis] + d11 * v[axis];
        Rigid { shift: std::array::from_fn(shift), velocity: std::array::from_fn(velocity), ..Rigid::STILL }
    }

    fn is_in_space(&self) -> bool {
        self.points.iter().any(|(_, point)| point.dimension() == 3)
    }

    fn arrange(&mut self, by: &Similarity) -> Option<()> {
        for (_, displacement) in &mut self.points {
            *displacement = by.of_displacement(*displacement)?;
        }
        Some(())
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        Vec::new()
    }
}
