//! Depenetration parameters of each body and net.

use super::{Scene, range};
use crate::{nets::Link, obstacles::Depenetration};
use std::ops::Range;

/// Depenetration speed as a fraction of the wave speed, and shallow depth as a fraction of the size of a triangle: the
/// strain is no more than that.
const STRAIN: f64 = 0.1;

/// Other motion decays while the body moves by this fraction of its size.
const DECAY: f64 = 0.05;

/// Least time for a displacement by its own size, so that depenetration is visible \[s\].
const WHILE: f64 = 1.0;

impl Scene {
    /// Parameters of each body and then each net: a tenth of the wave speed, but at most its size in a second; in one
    /// step from a depth below a tenth of its triangles or springs. A body without elastic energy leaves in one step.
    ///
    /// Shear waves of a body of mass m and area A have the speed `sqrt(mu A / m)`; a spring of stiffness k and length l
    /// transmits a disturbance to particles of mass m at about `l sqrt(k / m)`, and the fastest spring of a net counts.
    pub(super) fn depenetrations(&self) -> Vec<Depenetration> {
        let bodies = self.bodies.iter().map(|body| {
            let area: f64 = body.elements.rest_areas().sum();
            let mass: f64 = self.mass[self.numbers(&body.vertices)].iter().step_by(self.dimension).sum();
            let waves = (body.elements.material().lame().mu * area / mass).sqrt();
            (&body.vertices, waves, (2.0 * area / body.elements.corners().len() as f64).sqrt())
        });
        let nets = self.nets.iter().map(|net| {
            let links = net.springs.links();
            let speed =
                |link: &Link| link.rest * (link.stiffness / self.mass[self.dimension * link.ends[0] as usize]).sqrt();
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

    /// The diagonal of the box around some vertices at rest \[m\].
    pub fn size(&self, vertices: &Range<usize>) -> f64 {
        let own = &self.rest[self.numbers(vertices)];
        let length = |axis: usize| {
            let (least, greatest) = range(own.iter().skip(axis).step_by(self.dimension));
            greatest - least
        };
        (0..self.dimension).map(length).map(|length| length * length).sum::<f64>().sqrt()
    }
}
