use super::{Effect, EffectParameters, Motion, Shape};
use crate::{
    elements::Elements,
    quantity::{Coordinate, Point, Quantity},
};
use serde::{Deserialize, Serialize};

/// The four edges of the world: a vertex beyond one is put back on it and loses its velocity outwards.
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
        "A vertex beyond an edge is put back on it; its velocity outwards is removed."
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        Vec::new()
    }

    fn shapes(&self) -> Vec<Shape> {
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

    fn constrains(&self) -> bool {
        true
    }

    fn constrain_position(&self, x: &mut [f64], v: &mut [f64], inverse_mass: &[f64]) -> usize {
        let mut touched = 0;
        for ((x, v), inverse_mass) in x.chunks_exact_mut(2).zip(v.chunks_exact_mut(2)).zip(inverse_mass.chunks_exact(2))
        {
            for axis in (0..2).filter(|axis| inverse_mass[*axis] != 0.0) {
                if x[axis] <= self.least[axis] {
                    x[axis] = self.least[axis];
                    v[axis] = v[axis].max(0.0);
                    touched += 1;
                } else if x[axis] >= self.greatest[axis] {
                    x[axis] = self.greatest[axis];
                    v[axis] = v[axis].min(0.0);
                    touched += 1;
                }
            }
        }
        touched
    }
}
