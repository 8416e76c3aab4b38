use super::{Bounds, Effect, EffectParameters, Motion, Shape};
use crate::{
    elements::Elements,
    obstacles::{Exit, Start, exit_of},
    quantity::{Coordinate, Point, Quantity},
};
use serde::{Deserialize, Serialize};

/// The four edges of the world: a vertex that gets beyond one is put back on it and loses its velocity outwards.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Boundary {
    /// Corner with the least coordinates [m].
    pub least: Point,
    /// Corner with the greatest coordinates [m].
    pub greatest: Point,
}

impl Default for Boundary {
    fn default() -> Self {
        let (zero, one) = (Coordinate::literal(0.0), Coordinate::literal(1.0));
        Self { least: Point(zero, zero), greatest: Point(one, one) }
    }
}

impl EffectParameters for Boundary {
    fn title(&self) -> &'static str {
        "Edges of the world"
    }

    fn about(&self) -> &'static str {
        "A vertex that gets beyond an edge is put back on it; its velocity outwards is removed. What begins beyond one comes in slowly."
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        Vec::new()
    }

    fn shapes(&self, _: f64) -> Vec<Shape> {
        vec![Shape::Edges(self.least.get(), self.greatest.get())]
    }

    fn build(&self, _: &Elements) -> Result<Box<dyn Effect>, String> {
        let (least, greatest) = (self.least.get(), self.greatest.get());
        if least[0] < greatest[0] && least[1] < greatest[1] {
            Ok(Box::new(Edges { least, greatest }))
        } else {
            Err(format!("the world's least corner {least:?} must lie below and left of its greatest {greatest:?}"))
        }
    }
}

struct Edges {
    least: [f64; 2],
    greatest: [f64; 2],
}

impl Effect for Edges {
    fn name(&self) -> &'static str {
        "Edges of the world"
    }

    fn elements(&self, motion: Motion<'_>) -> usize {
        motion.x.len() / 2
    }

    fn is_clear(&self, [least, greatest]: Bounds) -> bool {
        (0..2).all(|axis| least[axis] > self.least[axis] && greatest[axis] < self.greatest[axis])
    }

    fn constrains(&self) -> bool {
        true
    }

    fn count_inside(&self, x: &[f64], _: f64, exits: &[Exit]) -> usize {
        let is_inside = |(vertex, point): &(usize, &[f64; 2])| {
            let shallow = exit_of(exits, *vertex).map_or(0.0, |exit| exit.shallow);
            let beyond = |axis: usize| (self.least[axis] - point[axis]).max(point[axis] - self.greatest[axis]);
            beyond(0).max(beyond(1)) > shallow
        };
        x.as_chunks().0.iter().enumerate().filter(is_inside).count()
    }

    fn constrain(&self, start: &Start<'_>, x: &mut [f64], v: &mut [f64]) -> usize {
        let ([left, bottom], [right, top]) = (self.least, self.greatest);
        let beyond = |p: &[f64]| p[0] <= left || p[0] >= right || p[1] <= bottom || p[1] >= top;
        if !x.chunks_exact(2).any(beyond) {
            return 0;
        }
        let mut touched = 0;
        for (vertex, (x, v)) in x.chunks_exact_mut(2).zip(v.chunks_exact_mut(2)).enumerate() {
            for axis in (0..2).filter(|axis| start.inverse_mass[2 * vertex + axis] != 0.0) {
                touched += usize::from(self.put_back(start, (vertex, axis), x, v));
            }
        }
        touched
    }
}

impl Edges {
    /// Puts one vertex back on the edges across one axis.
    #[inline]
    fn put_back(&self, start: &Start<'_>, (vertex, axis): (usize, usize), x: &mut [f64], v: &mut [f64]) -> bool {
        let (edge, inwards) = if x[axis] < self.least[axis] || (x[axis] == self.least[axis] && v[axis] < 0.0) {
            (self.least[axis], 1.0)
        } else if x[axis] > self.greatest[axis] || (x[axis] == self.greatest[axis] && v[axis] > 0.0) {
            (self.greatest[axis], -1.0)
        } else {
            return false;
        };
        let mut normal = [0.0; 2];
        normal[axis] = inwards;
        if !start.faces(vertex, normal) {
            return false;
        }
        let from = &start.x[2 * vertex..][..2];
        let beyond = inwards * (from[axis] - edge);
        let rise = start.rise(vertex, beyond, inwards * start.v[2 * vertex + axis], 0.0);
        let target = rise.map_or(edge, |rise| from[axis] + inwards * rise.length);
        if inwards * (x[axis] - target) > 0.0 {
            return false;
        }
        let mut after = [v[0], v[1]];
        let before = [start.v[2 * vertex], start.v[2 * vertex + 1]];
        let kept = match rise {
            Some(rise) => start.lift(vertex, normal, rise.speed, &mut after),
            None => start.surface.answer(normal, before, &mut after),
        };
        let changed = after != [v[0], v[1]] || x[axis] != target;
        v.copy_from_slice(&after);
        x[axis] = target;
        if let Some(kept) = kept.filter(|kept| *kept < 1.0) {
            x[1 - axis] = from[1 - axis] + kept * (x[1 - axis] - from[1 - axis]);
        }
        changed
    }
}
