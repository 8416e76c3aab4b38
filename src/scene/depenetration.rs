//! Speeds of depenetration for each body and net.

use super::{Scene, extent};
use crate::{nets::Link, obstacles::Depenetration};
use std::ops::Range;

/// The share of the speed of waves, and of the size of a triangle: it strains by no more than that.
const STRAIN: f64 = 0.1;

/// What else moves in there fades while it comes this share of its size.
const DECAY: f64 = 0.05;

/// No faster than its own size in this time, for people to see what happens [s].
const WHILE: f64 = 1.0;

impl Scene {
    /// Each body's, and then each net's: a tenth of the speed of its waves, but no faster than its size in a second; and from a tenth
    /// of its triangles or springs at once. What stores no energy leaves at once.
    ///
    /// Shear waves of a body of mass m and area A have the speed `sqrt(mu A / m)`; a spring of stiffness k and length l passes
    /// on what happens to particles of mass m at about `l sqrt(k / m)`, and the fastest one of a net counts.
    pub(super) fn depenetrations(&self) -> Vec<Depenetration> {
        let bodies = self.bodies.iter().map(|body| {
            let area: f64 = body.elements.rest_areas().sum();
            let mass: f64 = self.mass[numbers(&body.vertices)].iter().step_by(2).sum();
            let waves = (body.elements.lame().mu * area / mass).sqrt();
            (&body.vertices, waves, (2.0 * area / body.elements.corners().len() as f64).sqrt())
        });
        let nets = self.nets.iter().map(|net| {
            let links = net.springs.links();
            let speed = |link: &Link| link.rest * (link.stiffness / self.mass[2 * link.ends[0] as usize]).sqrt();
            let length = links.iter().map(|link| link.rest).sum::<f64>() / links.len().max(1) as f64;
            (&net.vertices, links.iter().map(speed).fold(0.0, f64::max), length)
        });
        let depenetration = |(vertices, waves, length): (&Range<usize>, f64, f64)| {
            let size = self.size(vertices);
            let speed = f64::min(STRAIN * waves, size / WHILE);
            let speed = if speed > 0.0 { speed } else { f64::INFINITY };
            Depenetration { end: vertices.end, speed, shallow: STRAIN * length, decay: DECAY * size / speed }
        };
        bodies.chain(nets).map(depenetration).collect()
    }

    /// The diagonal of the box around some vertices at rest [m].
    pub fn size(&self, vertices: &Range<usize>) -> f64 {
        let own = &self.rest[numbers(vertices)];
        let [(left, right), (bottom, top)] = [0, 1].map(|axis| extent(own, axis));
        let (width, height) = (right - left, top - bottom);
        (width * width + height * height).sqrt()
    }
}

/// Their places in flat vectors.
fn numbers(vertices: &Range<usize>) -> Range<usize> {
    2 * vertices.start..2 * vertices.end
}
