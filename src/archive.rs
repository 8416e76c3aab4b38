//! States of a run over time for `NumPy`: one archive (`.npz`) of arrays. The format of each array is that of `numpy.lib.format`, version 1.0, and the
//! archive is a ZIP file without compression, as `numpy.savez` writes it.

use crate::{report::Energies, scene::Scene, state::State};
use rawzip::{CompressionMethod, ZipArchiveWriter};
use std::io::Write as _;

/// Vertices, triangles and springs of a scene as its level lists them.
pub struct Listed {
    /// Place of each vertex of the scene.
    pub vertices: Vec<usize>,
    /// Place of each triangle of the scene, and its corners by their places.
    pub triangles: Vec<(usize, [usize; 3])>,
    /// Ends of all springs, by their places.
    pub springs: Vec<[usize; 2]>,
}

impl Listed {
    /// Those of a scene.
    ///
    /// # Errors
    /// If it is a toy.
    pub fn new(scene: &Scene) -> Result<Self, String> {
        if scene.toy.is_some() {
            return Err("a toy has no vertices".to_owned());
        }
        let count = scene.start.x.len() / scene.dimension;
        let vertices: Vec<_> = (0..count).map(|vertex| scene.listed_vertex(vertex).unwrap_or(vertex)).collect();
        let place = |vertex: u32| vertices[vertex as usize];
        let membranes = scene.membranes.iter().flat_map(|membrane| membrane.elements.corners());
        let corners = scene.triangles.iter().chain(membranes).enumerate();
        let triangles = corners
            .map(|(number, corners)| (scene.listed_triangle(number).unwrap_or(number), corners.map(place)))
            .collect();
        let links = scene.nets.iter().flat_map(|net| net.springs.links());
        let springs = links.map(|link| link.ends.map(place)).collect();
        Ok(Self { vertices, triangles, springs })
    }

    /// Corners of the triangles, in the order of the level.
    pub fn corners(&self) -> Vec<[usize; 3]> {
        let mut corners = vec![[0; 3]; self.triangles.len()];
        self.triangles.iter().for_each(|(place, own)| corners[*place] = *own);
        corners
    }
}

/// States that are kept until all are there.
pub struct States {
    listed: Listed,
    dimension: usize,
    times: Vec<f64>,
    /// Positions \[m\] and velocities [m/s] of all states, as the level lists the vertices.
    motion: [Vec<f64>; 2],
    /// Kinetic, elastic, contact and potential energy \[J\] of all states.
    energies: Vec<f64>,
}

impl States {
    /// No states yet.
    ///
    /// # Errors
    /// If the scene is a toy.
    pub fn new(scene: &Scene) -> Result<Self, String> {
        let (listed, dimension) = (Listed::new(scene)?, scene.dimension);
        Ok(Self { listed, dimension, times: Vec::new(), motion: [Vec::new(), Vec::new()], energies: Vec::new() })
    }

    /// Keeps a state of the scene with its energies.
    pub fn record(&mut self, scene: &Scene, state: &State, energies: &Energies) {
        self.times.push(state.time);
        for (all, own) in self.motion.iter_mut().zip([&state.x, &state.v]) {
            all.extend_from_slice(&scene.listed(own));
        }
        self.energies.extend([energies.kinetic, energies.elastic, energies.contact, energies.potential]);
    }

    /// The bytes of the archive.
    ///
    /// # Errors
    /// If it is too large.
    pub fn bytes(&self) -> Result<Vec<u8>, String> {
        let (count, vertices) = (self.times.len(), self.listed.vertices.len());
        let [positions, velocities] = &self.motion;
        let whole = |numbers: &mut dyn Iterator<Item = usize>| -> Vec<u8> {
            numbers.flat_map(|number| (number as u64).to_le_bytes()).collect()
        };
        let real = |numbers: &[f64]| -> Vec<u8> { numbers.iter().flat_map(|number| number.to_le_bytes()).collect() };
        let corners = self.listed.corners();
        let springs = &self.listed.springs;
        let moving = [count, vertices, self.dimension];
        let arrays = [
            ("time", array("<f8", &[count], &real(&self.times))),
            ("positions", array("<f8", &moving, &real(positions))),
            ("velocities", array("<f8", &moving, &real(velocities))),
            ("energies", array("<f8", &[count, 4], &real(&self.energies))),
            ("triangles", array("<u8", &[corners.len(), 3], &whole(&mut corners.iter().flatten().copied()))),
            ("springs", array("<u8", &[springs.len(), 2], &whole(&mut springs.iter().flatten().copied()))),
        ];
        packed(&arrays).map_err(|error| error.to_string())
    }
}

/// An archive of arrays with their names.
fn packed(arrays: &[(&str, Vec<u8>)]) -> Result<Vec<u8>, rawzip::Error> {
    let mut archive = ZipArchiveWriter::new(Vec::new());
    for (name, bytes) in arrays {
        let file = archive.new_file(format!("{name}.npy")).compression_method(CompressionMethod::STORE);
        let (mut entry, config) = file.start()?;
        let mut data = config.wrap(&mut entry);
        data.write_all(bytes)?;
        let (_, descriptor) = data.finish()?;
        entry.finish(descriptor)?;
    }
    archive.finish()
}

/// An array of a type (little-endian) and a shape, in the order of C.
fn array(kind: &str, shape: &[usize], bytes: &[u8]) -> Vec<u8> {
    /// Bytes before the text of the head: the magic string, the version and the length.
    const BEFORE: usize = 10;
    /// What the length of all of it before the numbers is a multiple of.
    const ALIGNED: usize = 64;
    let shape: Vec<_> = shape.iter().map(|count| format!("{count},")).collect();
    let text = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({}), }}", shape.join(" "));
    // A line break ends the head.
    let length = (BEFORE + text.len() + 1).next_multiple_of(ALIGNED) - BEFORE;
    let mut all = b"\x93NUMPY\x01\x00".to_vec();
    // The head of a few counts is far shorter than 2^16 bytes.
    all.extend((length as u16).to_le_bytes());
    all.extend(format!("{text:<width$}\n", width = length - 1).into_bytes());
    all.extend(bytes);
    all
}
