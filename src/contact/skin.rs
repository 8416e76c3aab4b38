//! Skin of the bodies and nets of a scene.

use super::Potential;
use crate::elements::{Membranes, NetSprings, Triangles};
use std::ops::Range;

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
    /// Number of its part in the list of [`SurfaceVertices`].
    pub part: u32,
}

/// An edge of the boundary of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceEdge {
    /// Its ends, by their numbers in the scene, with the body on the left.
    pub ends: [u32; 2],
    /// Number of its part in the list of [`SurfaceVertices`].
    pub part: u32,
    /// The edges before and after it around the boundary.
    pub neighbours: [u32; 2],
    /// Length at rest \[m\].
    pub length: f64,
    /// Length of the boundary at rest up to its first end, and of the whole loop \[m\].
    pub arc: [f64; 2],
}

/// A body or net with a skin, and what the skin is relative to.
#[derive(Clone, Debug, PartialEq)]
struct Part {
    /// Number of the body, or after all bodies of the net.
    number: usize,
    /// Its vertices in the list.
    vertices: Range<usize>,
    /// Whether it has edges. The particles of nets touch without the springs between them.
    is_body: bool,
    /// Young's modulus of the plane \[Pa\]; for nets that of a sheet with the stiffness of the structural springs.
    young: f64,
    /// Mean length of the boundary edges; for nets of the springs \[m\].
    edge: f64,
    /// Mass per area [kg/m²].
    density: f64,
}

/// All vertices of a scene that have a skin, ascending, and the edges between those of bodies.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SurfaceVertices {
    vertices: Vec<SurfaceVertex>,
    /// These and the vertices within bodies.
    all: Vec<SurfaceVertex>,
    edges: Vec<SurfaceEdge>,
    /// Each vertex with an edge that leaves it, ascending.
    leaving: Vec<[u32; 2]>,
    parts: Vec<Part>,
    /// Number of bodies and nets that were added.
    count: usize,
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
            number: self.count,
            vertices: 0..0,
            is_body: true,
            young: 4.0 * lame.mu * (lame.lambda + lame.mu) / (lame.lambda + 2.0 * lame.mu),
            edge: areas.iter().sum::<f64>() / boundary.len().max(1) as f64,
            density: total / body.rest_areas().sum::<f64>(),
        };
        if self.add(part, first, &areas) {
            self.add_edges(boundary, &length);
        }
    }

    /// Adds the edges of the last part. Where several loops meet in a vertex, any edge that leaves it follows one that
    /// arrives.
    fn add_edges(&mut self, boundary: &[[u32; 2]], length: &dyn Fn([u32; 2]) -> f64) {
        let (first, part) = (self.edges.len(), self.parts.len() as u32 - 1);
        let mut leaving: Vec<_> = boundary.iter().zip(0..).map(|([a, _], edge)| [*a, edge]).collect();
        leaving.sort_unstable();
        self.leaving.extend(leaving.iter().map(|[vertex, edge]| [*vertex, first as u32 + edge]));
        let mut taken = vec![false; boundary.len()];
        let mut follow = |vertex: u32| {
            let from = leaving.partition_point(|[other, _]| *other < vertex);
            let next = leaving[from..].iter().take_while(|[other, _]| *other == vertex);
            let next = next.map(|[_, edge]| *edge as usize).find(|edge| !taken[*edge])?;
            taken[next] = true;
            Some(next)
        };
        let mut neighbours = vec![[0; 2]; boundary.len()];
        for (edge, [_, b]) in boundary.iter().enumerate() {
            // Every vertex of a boundary has as many edges that arrive as edges that leave.
            let next = follow(*b).unwrap_or(edge);
            (neighbours[edge][1], neighbours[next][0]) = ((first + next) as u32, (first + edge) as u32);
        }
        self.edges.extend(boundary.iter().zip(neighbours).map(|(ends, neighbours)| SurfaceEdge {
            ends: *ends,
            part,
            neighbours,
            length: length(*ends),
            arc: [f64::NAN; 2],
        }));
        for start in first..self.edges.len() {
            if self.edges[start].arc[0].is_nan() {
                self.measure_loop(start);
            }
        }
    }

    /// Sets the lengths along the loop of an edge.
    fn measure_loop(&mut self, start: usize) {
        let (mut along, mut edge) = (0.0, start);
        while self.edges[edge].arc[0].is_nan() {
            let SurfaceEdge { arc, length, neighbours, .. } = &mut self.edges[edge];
            arc[0] = along;
            along += *length;
            edge = neighbours[1] as usize;
        }
        edge = start;
        while self.edges[edge].arc[1].is_nan() {
            self.edges[edge].arc[1] = along;
            edge = self.edges[edge].neighbours[1] as usize;
        }
    }

    /// Adds the vertices of a membrane, whose skin is one of a solid with its stiffness and mass per area, as thick as its triangles
    /// are long: contact then vibrates about as fast as the triangles in their plane.
    pub fn add_membrane(&mut self, membrane: &Membranes, mass: &[f64]) {
        let total = membrane.rest_areas().sum::<f64>();
        let volumes = membrane.lumped_mass(1.0);
        let thickness = volumes.iter().sum::<f64>() / total;
        let edge = (2.0 * total / membrane.corners().len().max(1) as f64).sqrt();
        let lame = membrane.material().lame();
        let vertices = membrane.vertices();
        let all: f64 = mass[3 * vertices.start..3 * vertices.end].iter().step_by(3).sum();
        let part = Part {
            number: self.count,
            vertices: 0..0,
            is_body: false,
            young: 4.0 * lame.mu * (lame.lambda + lame.mu) / (lame.lambda + 2.0 * lame.mu) * thickness / edge,
            edge,
            density: all / total / edge,
        };
        let areas: Vec<_> = volumes.iter().map(|volume| volume / thickness).collect();
        self.add(part, vertices.start, &areas);
    }

    /// Adds the particles of a net.
    pub fn add_net(&mut self, net: &NetSprings, mass: &[f64]) {
        let links = net.links();
        let mean = |of: &dyn Fn(usize) -> f64| (0..links.len()).map(of).sum::<f64>() / links.len().max(1) as f64;
        let edge = mean(&|link| links[link].rest);
        let vertices = net.vertices();
        let dimension = net.dimension();
        let masses = &mass[dimension * vertices.start..dimension * vertices.end];
        let particle = masses.iter().step_by(dimension).sum::<f64>() / vertices.len() as f64;
        // In space the skin has a thickness too: an area instead of a length, and a solid's modulus instead of a sheet's.
        let length = if dimension == 3 { edge } else { 1.0 };
        let part = Part {
            number: self.count,
            vertices: 0..0,
            is_body: false,
            young: mean(&|link| links[link].stiffness) / length,
            edge,
            density: particle / (edge * edge) / length,
        };
        self.add(part, vertices.start, &vec![edge * length; vertices.len()]);
    }

    /// Adds the vertices from `first` on that have an area, if all quantities of the part are positive; returns whether
    /// they are.
    fn add(&mut self, mut part: Part, first: usize, areas: &[f64]) -> bool {
        self.count += 1;
        if !(part.edge > 0.0 && part.density.is_finite()) {
            return false;
        }
        let (number, before) = (self.parts.len() as u32, self.vertices.len());
        let vertex = |(vertex, area): (usize, &f64)| SurfaceVertex {
            vertex: (first + vertex) as u32,
            area: *area,
            part: number,
        };
        self.vertices.extend(areas.iter().enumerate().filter(|(_, area)| **area > 0.0).map(vertex));
        let areas = areas.iter().map(|area| if *area > 0.0 { *area } else { part.edge });
        self.all.extend(areas.enumerate().map(|(number, area)| vertex((number, &area))));
        part.vertices = before..self.vertices.len();
        self.parts.push(part);
        true
    }

    /// The edges of all boundaries.
    pub fn edges(&self) -> &[SurfaceEdge] {
        &self.edges
    }

    /// The edges that leave a vertex: one, or one for each loop that passes through it.
    pub fn leaving(&self, vertex: u32) -> impl Iterator<Item = u32> {
        let from = self.leaving.partition_point(|[other, _]| *other < vertex);
        self.leaving[from..].iter().take_while(move |[other, _]| *other == vertex).map(|[_, edge]| *edge)
    }

    /// A vertex, by its number in the scene.
    pub fn numbered(&self, vertex: u32) -> Option<&SurfaceVertex> {
        self.all.binary_search_by_key(&vertex, |own| own.vertex).ok().map(|place| &self.all[place])
    }

    /// Whether a point is inside a part, whose vertices are at these places: a ray to the right crosses the boundary an odd
    /// number of times.
    pub fn is_inside(&self, part: u32, at: impl Fn(u32) -> [f64; 2], [px, py]: [f64; 2]) -> bool {
        let crossed = self.edges.iter().filter(|edge| edge.part == part).filter(|edge| {
            let [[ax, ay], [bx, by]] = edge.ends.map(&at);
            let side = (bx - ax) * (py - ay) - (by - ay) * (px - ax);
            ay <= py && by > py && side > 0.0 || by <= py && ay > py && side < 0.0
        });
        crossed.count() % 2 == 1
    }

    /// Number of parts.
    pub const fn parts(&self) -> usize {
        self.parts.len()
    }

    /// The vertices of a part, by their places in the list.
    pub fn vertices_of(&self, part: usize) -> Range<usize> {
        self.parts[part].vertices.clone()
    }

    /// Whether a part is a body.
    pub fn is_body(&self, part: u32) -> bool {
        self.parts[part as usize].is_body
    }

    /// Number of the body or net of a part: bodies first.
    pub fn owner(&self, part: u32) -> usize {
        self.parts[part as usize].number
    }

    /// Mean length of the boundary edges of all parts, the greatest \[m\].
    pub fn greatest_edge(&self) -> f64 {
        self.parts.iter().map(|part| part.edge).fold(0.0, f64::max)
    }

    /// The vertices.
    pub fn iter(&self) -> impl Iterator<Item = &SurfaceVertex> + Clone {
        self.vertices.iter()
    }

    /// The vertices, by their places in the list.
    pub fn listed(&self) -> &[SurfaceVertex] {
        &self.vertices
    }

    /// The vertices and those within bodies, which touch obstacles where a body is crushed.
    pub fn all(&self) -> &[SurfaceVertex] {
        &self.all
    }

    /// A vertex, by its place in the list.
    pub fn at(&self, place: u32) -> &SurfaceVertex {
        &self.vertices[place as usize]
    }

    /// Place in the list of a vertex with a skin, by its number in the scene.
    pub fn place_of(&self, vertex: u32) -> Option<u32> {
        self.vertices.binary_search_by_key(&vertex, |own| own.vertex).ok().map(|place| place as u32)
    }

    /// Number of vertices.
    pub const fn len(&self) -> usize {
        self.vertices.len()
    }

    /// Whether there are none.
    pub const fn is_empty(&self) -> bool {
        self.vertices.is_empty()
    }

    /// Potential between two parts: their skins one behind the other, so that the softer one counts most.
    pub fn potential_between(&self, skin: Skin, parts: [usize; 2]) -> Potential {
        let [a, b] = parts.map(|part| self.potential(skin, part));
        Potential { modulus: 2.0 / (1.0 / a.modulus + 1.0 / b.modulus), thickness: 0.5 * (a.thickness + b.thickness) }
    }

    /// Potential of the skin of a part: its modulus is the greater of a multiple of Young's modulus and of `6 rho v²` for the
    /// fastest impact v, at which the skin is not compressed beyond its thickness.
    pub fn potential(&self, skin: Skin, part: usize) -> Potential {
        let part = &self.parts[part];
        let modulus = (skin.modulus * part.young).max(6.0 * part.density * skin.speed * skin.speed);
        Potential { modulus, thickness: skin.thickness * part.edge }
    }

    /// Speed at which the initial penetration of a part decreases: a tenth of the wave speed [m/s].
    pub fn depenetration_speed(&self, part: u32) -> f64 {
        let part = &self.parts[part as usize];
        0.1 * (part.young / part.density).sqrt()
    }

    /// Mean length of the boundary edges of a part \[m\].
    pub fn mean_edge(&self, part: u32) -> f64 {
        self.parts[part as usize].edge
    }

    /// The parts that are bodies, with the numbers of their edges.
    pub fn bodies(&self) -> impl Iterator<Item = (u32, Range<u32>)> {
        let own = |part: u32| {
            let at = |part: u32| self.edges.partition_point(|edge| edge.part < part) as u32;
            (part, at(part)..at(part + 1))
        };
        (0..self.parts.len() as u32).filter(|part| self.is_body(*part)).map(own)
    }
}
