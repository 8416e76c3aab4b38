//! Difference of two runs of one level. They may differ in scheme, step, model and mesh.

use crate::{
    meshes::Locator,
    scene::{Body, Owner, Scene, nearest_vertex},
    simulation::Simulation,
};
use std::{borrow::Cow, ops::Range};

/// Where the vertices of one scene are in another of the same level: the same vertices, or points inside other triangles.
pub struct Correspondence {
    /// For each vertex, in order; nothing if both have the same vertices.
    places: Option<Vec<Place>>,
}

/// A material point of a scene.
enum Place {
    Vertex(usize),
    /// In a triangle, by corners and weights.
    Inside([usize; 3], [f64; 3]),
}

impl Correspondence {
    /// Seeks the vertices of `a` in the rest shape of `b`; `None` if the two do not show the same bodies, nets or toy.
    pub fn new(a: &Scene, b: &Scene) -> Option<Self> {
        let counts = |scene: &Scene| (scene.bodies.len(), scene.nets.len(), scene.toy.is_some());
        if counts(a) != counts(b) {
            return None;
        }
        if a.rest == b.rest {
            return Some(Self { places: None });
        }
        let mut places = Vec::with_capacity(a.rest.len() / 2);
        for (a_body, b_body) in a.bodies.iter().zip(&b.bodies) {
            let locator = Locator::new(points(b, &b_body.vertices), b_body.mesh.triangles());
            places.extend(points(a, &a_body.vertices).iter().map(|point| inside(&locator, b_body, *point)));
        }
        for (a_net, b_net) in a.nets.iter().zip(&b.nets) {
            if a_net.vertices.len() != b_net.vertices.len() {
                return None;
            }
            places.extend(b_net.vertices.clone().map(Place::Vertex));
        }
        Some(Self { places: Some(places) })
    }

    /// The positions in `b`, given all of its own, of what the vertices of `a` are made of.
    pub fn seen<'x>(&self, x: &'x [f64]) -> Cow<'x, [f64]> {
        let Some(places) = &self.places else { return Cow::Borrowed(x) };
        let position = |place: &Place| match place {
            Place::Vertex(vertex) => [x[2 * vertex], x[2 * vertex + 1]],
            Place::Inside(corners, weights) => [0, 1].map(|axis| {
                corners.iter().zip(weights).map(|(corner, weight)| weight * x[2 * corner + axis]).sum::<f64>()
            }),
        };
        Cow::Owned(places.iter().flat_map(position).collect())
    }
}

fn points<'a>(scene: &'a Scene, vertices: &Range<usize>) -> &'a [[f64; 2]] {
    scene.rest[2 * vertices.start..2 * vertices.end].as_chunks().0
}

fn inside(locator: &Locator, body: &Body, point: [f64; 2]) -> Place {
    let first = body.vertices.start;
    match locator.locate_nearest(point) {
        Some((triangle, weights)) => {
            Place::Inside(body.mesh.triangles()[triangle].map(|corner| first + corner as usize), weights)
        }
        None => Place::Vertex(first),
    }
}

/// The vertex of `to` that is nearest, at rest and in the same body or net, to a vertex of `from`.
pub fn counterpart(from: &Scene, to: &Scene, vertex: usize) -> Option<usize> {
    if from.rest == to.rest {
        return Some(vertex);
    }
    let vertices = match from.owner_of(vertex)?.0 {
        Owner::Body(number) => to.bodies.get(number)?.vertices.clone(),
        Owner::Net(number) => to.nets.get(number)?.vertices.clone(),
    };
    let point = [from.rest[2 * vertex], from.rest[2 * vertex + 1]];
    Some(vertices.start + nearest_vertex(&to.rest[2 * vertices.start..2 * vertices.end], point)?)
}

/// How far two runs are apart at one time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Apart {
    /// `sqrt(mean |x_B - x_A|²)` over the vertices of A [m]; B is looked at where the same material points are.
    pub metres: f64,
    /// The same over the farthest that A has been from its start so far, `sqrt(mean |x_A - x_start|²)` at its largest. Not over
    /// what it is on average: a scene that has just begun to move would be far off for no reason.
    pub relative: f64,
}

/// Measures two runs at one moment after another.
pub struct Difference {
    correspondence: Option<Correspondence>,
    /// Where the first of the two starts [m].
    start: Vec<f64>,
    /// The farthest that it was from there [m].
    farthest: f64,
}

impl Difference {
    /// Gets ready to compare two runs. It holds as long as neither gets other vertices.
    pub fn new(a: &Simulation, b: &Simulation) -> Self {
        let (scene, other) = (a.scene(), b.scene());
        let start = positions(scene, &scene.start.x).into_owned();
        Self { correspondence: Correspondence::new(scene, other), start, farthest: 0.0 }
    }

    /// How far they are apart, both being at one time; `None` if they do not show the same things.
    pub fn measure(&mut self, a: &Simulation, b: &Simulation) -> Option<Apart> {
        let correspondence = self.correspondence.as_ref()?;
        let (a, b) = (positions(a.scene(), &a.state().x), positions(b.scene(), &b.state().x));
        self.farthest = self.farthest.max(rms(&a, &self.start));
        let metres = rms(&a, &correspondence.seen(&b));
        Some(Apart { metres, relative: if metres == 0.0 { 0.0 } else { metres / self.farthest } })
    }
}

/// Root mean square distance of points [m].
fn rms(a: &[f64], b: &[f64]) -> f64 {
    let sum: f64 = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum();
    (2.0 * sum / a.len().max(1) as f64).sqrt()
}

/// Positions [m]; a toy's state is translated into the place where it is seen.
fn positions<'a>(scene: &Scene, x: &'a [f64]) -> Cow<'a, [f64]> {
    match (&scene.toy, x) {
        (Some(toy), &[a, b]) => Cow::Owned(toy.kind().place([a, b]).to_vec()),
        _ => Cow::Borrowed(x),
    }
}
