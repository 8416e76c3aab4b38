//! Difference of two runs of one level. They may differ in scheme, step, model and mesh.

use crate::{
    meshes::Locator,
    scene::{Owner, Scene, nearest_vertex},
    simulation::Simulation,
};
use std::{borrow::Cow, ops::Range};

/// Places of the vertices of one scene in another scene of the same level: equal vertices, or points inside triangles.
pub struct Correspondence {
    /// Number of coordinates of a vertex.
    dimension: usize,
    /// One place for each vertex, in order. `None` if both scenes have the same vertices.
    places: Option<Vec<Place>>,
}

/// Material point of a scene.
enum Place {
    Vertex(usize),
    /// In a triangle: its corners and the weights of the corners.
    Inside([usize; 3], [f64; 3]),
}

impl Correspondence {
    /// Locates the vertices of `a` in the rest shape of `b`. `None` if the scenes differ in their bodies, nets or toy.
    pub fn new(a: &Scene, b: &Scene) -> Option<Self> {
        let counts = |scene: &Scene| {
            let parts = [scene.bodies.len(), scene.nets.len(), scene.membranes.len()];
            (scene.dimension, parts, scene.toy.is_some())
        };
        if counts(a) != counts(b) {
            return None;
        }
        if a.rest == b.rest {
            return Some(Self { dimension: a.dimension, places: None });
        }
        let mut places = Vec::with_capacity(a.vertices());
        for (a_body, b_body) in a.bodies.iter().zip(&b.bodies) {
            let locator = Locator::new(points(b, &b_body.vertices), b_body.mesh.triangles());
            let triangles = (b_body.mesh.triangles(), b_body.vertices.start);
            places.extend(points(a, &a_body.vertices).iter().map(|point| inside(&locator, triangles, *point)));
        }
        for (a_net, b_net) in a.nets.iter().zip(&b.nets) {
            if a_net.vertices.len() != b_net.vertices.len() {
                return None;
            }
            places.extend(b_net.vertices.clone().map(Place::Vertex));
        }
        for (a_membrane, b_membrane) in a.membranes.iter().zip(&b.membranes) {
            let locator = Locator::new(b_membrane.mesh.points(), b_membrane.mesh.triangles());
            let triangles = (b_membrane.mesh.triangles(), b_membrane.vertices.start);
            places.extend(a_membrane.mesh.points().iter().map(|point| inside(&locator, triangles, *point)));
        }
        Some(Self { dimension: a.dimension, places: Some(places) })
    }

    /// Positions in `b` of the material points at the vertices of `a` \[m\]. `x` holds the positions of all vertices of
    /// `b`.
    pub fn seen<'x>(&self, x: &'x [f64]) -> Cow<'x, [f64]> {
        let Some(places) = &self.places else { return Cow::Borrowed(x) };
        let coordinate = |place: &Place, axis: usize| match place {
            Place::Vertex(vertex) => x[self.dimension * vertex + axis],
            Place::Inside(corners, weights) => {
                let weighted = |(corner, weight): (&usize, &f64)| weight * x[self.dimension * corner + axis];
                corners.iter().zip(weights).map(weighted).sum()
            }
        };
        let position = |place| (0..self.dimension).map(move |axis| coordinate(place, axis));
        Cow::Owned(places.iter().flat_map(position).collect())
    }
}

fn points<'a>(scene: &'a Scene, vertices: &Range<usize>) -> &'a [[f64; 2]] {
    scene.rest[scene.numbers(vertices)].as_chunks().0
}

fn inside(locator: &Locator, (triangles, first): (&[[u32; 3]], usize), point: [f64; 2]) -> Place {
    match locator.locate_nearest(point) {
        Some((triangle, weights)) => Place::Inside(triangles[triangle].map(|corner| first + corner as usize), weights),
        None => Place::Vertex(first),
    }
}

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
