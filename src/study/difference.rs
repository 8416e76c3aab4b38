//! Difference of two runs of one level. They may differ in scheme, step, model and mesh.

use crate::{
    scene::{Correspondence, Owner, Scene, nearest_vertex},
    simulation::Simulation,
};
use std::borrow::Cow;

/// Vertex of `to` nearest to a vertex of `from`, at rest and in the same body or net.
pub fn counterpart(from: &Scene, to: &Scene, vertex: usize) -> Option<usize> {
    if from.rest == to.rest {
        return Some(vertex);
    }
    let vertices = match from.owner_of(vertex)?.0 {
        Owner::Body(number) => to.bodies.get(number)?.vertices.clone(),
        Owner::Net(number) => to.nets.get(number)?.vertices.clone(),
        Owner::Membrane(number) => to.membranes.get(number)?.vertices.clone(),
    };
    let point = &from.rest[from.numbers(&(vertex..vertex + 1))];
    Some(vertices.start + nearest_vertex(&to.rest[to.numbers(&vertices)], point)?)
}

/// Difference of two runs at one time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Apart {
    /// `sqrt(mean |x_B - x_A|²)` over the vertices of A \[m\]. `x_B` are the positions of the same material points in B.
    pub metres: f64,
    /// The same difference over the greatest motion of A so far, `sqrt(mean |x_A - x_start|²)`.
    /// The average motion is no measure: a scene that has just begun to move would have a large error without reason.
    pub relative: f64,
}

/// Measures the difference of two runs over time.
pub struct Difference {
    correspondence: Option<Correspondence>,
    /// Start positions of the first run \[m\].
    start: Vec<f64>,
    /// Number of coordinates of a vertex.
    dimension: usize,
    /// Greatest RMS motion of the first run so far \[m\].
    farthest: f64,
}

impl Difference {
    /// Prepares the comparison of two runs. It is valid as long as the vertices of both stay the same.
    pub fn new(a: &Simulation, b: &Simulation) -> Self {
        let (scene, other) = (a.scene(), b.scene());
        let start = positions(scene, &scene.start.x).into_owned();
        Self { correspondence: Correspondence::new(scene, other), start, dimension: scene.dimension, farthest: 0.0 }
    }

    /// Difference of the runs, both at the same time. `None` if the scenes have no [`Correspondence`].
    pub fn measure(&mut self, a: &Simulation, b: &Simulation) -> Option<Apart> {
        let correspondence = self.correspondence.as_ref()?;
        let (a, b) = (positions(a.scene(), &a.state().x), positions(b.scene(), &b.state().x));
        self.farthest = self.farthest.max(rms(&a, &self.start, self.dimension));
        let metres = rms(&a, &correspondence.seen(&b), self.dimension);
        Some(Apart { metres, relative: if metres == 0.0 { 0.0 } else { metres / self.farthest } })
    }
}

/// Root mean square distance of points \[m\].
fn rms(a: &[f64], b: &[f64], dimension: usize) -> f64 {
    let sum: f64 = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum();
    (dimension as f64 * sum / a.len().max(1) as f64).sqrt()
}

/// Positions \[m\]. The state of a toy is translated into the place where it is drawn.
pub(super) fn positions<'a>(scene: &Scene, x: &'a [f64]) -> Cow<'a, [f64]> {
    match (&scene.toy, x) {
        (Some(toy), &[a, b]) => Cow::Owned(toy.kind().place([a, b]).to_vec()),
        _ => Cow::Borrowed(x),
    }
}
