//! How fast bodies and nets leave what they begin inside of.

use super::{Scene, extent};
use crate::obstacles::Exit;
use std::ops::Range;

/// The share of the speed of waves: it strains by no more than that.
const STRAIN: f64 = 0.1;

/// No faster than its own size in this time, for people to see what happens [s].
const WHILE: f64 = 1.0;

impl Scene {
    /// Each body's, and then each net's: a tenth of the speed of its waves, but no faster than its size in a second. What
    /// stores no energy leaves at once.
    ///
    /// Shear waves of a body of mass m and area A have the speed `sqrt(mu A / m)`; a spring of stiffness k and length l passes
    /// on what happens to particles of mass m at about `l sqrt(k / m)`, and the fastest one of a net counts.
    pub(super) fn exits(&self) -> Vec<Exit> {
        let bodies = self.bodies.iter().map(|body| {
            let area: f64 = body.elements.rest_areas().sum();
            let mass: f64 = self.mass[numbers(&body.vertices)].iter().step_by(2).sum();
            (&body.vertices, (body.elements.lame().mu * area / mass).sqrt())
        });
        let nets = self.nets.iter().map(|net| {
            let links = net.springs.links().iter();
            let speeds = links.map(|link| link.rest * (link.stiffness / self.mass[2 * link.ends[0] as usize]).sqrt());
            (&net.vertices, speeds.fold(0.0, f64::max))
        });
        let exit = |(vertices, waves): (&Range<usize>, f64)| {
            let speed = f64::min(STRAIN * waves, self.size(vertices) / WHILE);
            Exit { end: vertices.end, speed: if speed > 0.0 { speed } else { f64::INFINITY } }
        };
        bodies.chain(nets).map(exit).collect()
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
