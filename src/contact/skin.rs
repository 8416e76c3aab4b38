//! Skin of the bodies and nets of a scene.

use super::Potential;
use crate::elements::{Springs, Triangles};

/// Parameters of the skin, relative to each body or net.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Skin {
    /// Modulus as a multiple of Young's modulus.
    pub modulus: f64,
    /// Thickness as a multiple of the mean length of the boundary edges.
    pub thickness: f64,
    /// Fastest impact that it stops within its thickness [m/s].
    pub speed: f64,
    /// c: dissipation [s/m].
    pub dissipation: f64,
}

/// A vertex with a skin: one on the boundary of a body, or a particle of a net.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceVertex {
    /// Its number in the scene.
    pub vertex: u32,
    /// Area of the surface that belongs to it at rest, at a thickness of the sheet of 1 m \[m²\]: half of its boundary edges.
    pub area: f64,
    /// Speed at which the initial penetration decreases: a tenth of the wave speed [m/s].
    pub depenetration_speed: f64,
    /// Number of its body or net in the list of [`SurfaceVertices`].
    part: u32,
}

/// What the skin of a body or net is relative to.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Part {
    /// Young's modulus of the plane \[Pa\]; for nets that of a sheet with the stiffness of the structural springs.
    young: f64,
    /// Mean length of the boundary edges; for nets of the springs \[m\].
    edge: f64,
    /// Mass per area [kg/m²].
    density: f64,
}

/// All vertices of a scene that have a skin, ascending.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SurfaceVertices {
    vertices: Vec<SurfaceVertex>,
    parts: Vec<Part>,
}

impl SurfaceVertices {
    /// Adds the boundary of a body, whose edges are given by vertex numbers of the scene; `rest` are the rest positions
    /// \[m\], and `mass` the masses \[kg\], flat.
    pub fn add_body(&mut self, body: &Triangles, boundary: &[[u32; 2]], rest: &[f64], mass: &[f64]) {
        let length = |[a, b]: [u32; 2]| {
            let [a, b] = [a, b].map(|vertex| 2 * vertex as usize);
            libm::hypot(rest[b] - rest[a], rest[b + 1] - rest[a + 1])
        };
        let first = body.vertices().start;
        let mut areas = vec![0.0; body.vertices().len()];
        for edge in boundary {
            for vertex in edge {
                areas[*vertex as usize - first] += 0.5 * length(*edge);
            }
        }
        let lame = body.material().lame();
        let total: f64 = mass[2 * first..2 * body.vertices().end].iter().step_by(2).sum();
        let part = Part {
            young: 4.0 * lame.mu * (lame.lambda + lame.mu) / (lame.lambda + 2.0 * lame.mu),
            edge: areas.iter().sum::<f64>() / boundary.len().max(1) as f64,
            density: total / body.rest_areas().sum::<f64>(),
        };
        self.add(part, first, &areas);
    }

    /// Adds the particles of a net.
    pub fn add_net(&mut self, net: &Springs, mass: &[f64]) {
        let links = net.links();
        let mean = |of: &dyn Fn(usize) -> f64| (0..links.len()).map(of).sum::<f64>() / links.len().max(1) as f64;
        let edge = mean(&|link| links[link].rest);
        let vertices = net.vertices();
        let particle =
            mass[2 * vertices.start..2 * vertices.end].iter().step_by(2).sum::<f64>() / vertices.len() as f64;
        let part = Part { young: mean(&|link| links[link].stiffness), edge, density: particle / (edge * edge) };
        self.add(part, vertices.start, &vec![edge; vertices.len()]);
    }

    /// Adds the vertices from `first` on that have an area, if all quantities of the part are positive.
    fn add(&mut self, part: Part, first: usize, areas: &[f64]) {
        if !(part.edge > 0.0 && part.density.is_finite()) {
            return;
        }
        let number = self.parts.len() as u32;
        self.parts.push(part);
        let areas = areas.iter().enumerate().filter(|(_, area)| **area > 0.0);
        self.vertices.extend(areas.map(|(vertex, area)| SurfaceVertex {
            vertex: (first + vertex) as u32,
            area: *area,
            depenetration_speed: 0.1 * (part.young / part.density).sqrt(),
            part: number,
        }));
    }

    /// The vertices.
    pub fn iter(&self) -> impl Iterator<Item = &SurfaceVertex> + Clone {
        self.vertices.iter()
    }

    /// Number of vertices.
    pub const fn len(&self) -> usize {
        self.vertices.len()
    }

    /// Whether there are none.
    pub const fn is_empty(&self) -> bool {
        self.vertices.is_empty()
    }

    /// Potential of the skin of a vertex: its modulus is the greater of a multiple of Young's modulus and of `6 rho v²` for
    /// the fastest impact v, at which the skin is not compressed beyond its thickness.
    pub fn potential(&self, skin: Skin, vertex: &SurfaceVertex) -> Potential {
        let part = self.parts[vertex.part as usize];
        let modulus = (skin.modulus * part.young).max(6.0 * part.density * skin.speed * skin.speed);
        Potential { modulus, thickness: skin.thickness * part.edge }
    }

    /// Distance \[m\] at which a vertex stops in front of an obstacle with the contact margin eps \[m\]: where its skin is used up
    /// but for a small part, so that round-off never makes the gap negative.
    pub fn least_distance(&self, skin: Skin, eps: f64) -> f64 {
        const SHARE: f64 = 0.02;
        let thicknesses = self.parts.iter().map(|part| skin.thickness * part.edge);
        let [least, greatest] = thicknesses.fold([f64::INFINITY, 0.0], |[a, b], d| [d.min(a), d.max(b)]);
        (eps - greatest).max(0.0) + if least.is_finite() { SHARE * least } else { 0.0 }
    }
}
