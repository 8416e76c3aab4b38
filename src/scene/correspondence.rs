//! Material points of one scene in another of the same level, with other meshes.

use super::Scene;
use crate::meshes::Locator;
use std::{borrow::Cow, ops::Range, sync::Arc};

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
            if Arc::ptr_eq(&a_body.mesh, &b_body.mesh) {
                places.extend(b_body.vertices.clone().map(Place::Vertex));
                continue;
            }
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
            if Arc::ptr_eq(&a_membrane.mesh, &b_membrane.mesh) {
                places.extend(b_membrane.vertices.clone().map(Place::Vertex));
                continue;
            }
            let locator = Locator::new(b_membrane.mesh.points(), b_membrane.mesh.triangles());
            let triangles = (b_membrane.mesh.triangles(), b_membrane.vertices.start);
            places.extend(a_membrane.mesh.points().iter().map(|point| inside(&locator, triangles, *point)));
        }
        Some(Self { dimension: a.dimension, places: Some(places) })
    }

    /// Positions in `b` of the material points at the vertices of `a` \[m\], or their velocities; `x` holds those of all vertices of
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
