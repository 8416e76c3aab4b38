//! Elements: triangles, elements of six nodes, membranes and springs, which store elastic energy. An element is an effect like any other to a step.
//!
//! ```
//! use gingerbread::{
//!     elements::{ElasticElements as _, Triangles},
//!     materials::MaterialParameters,
//!     meshes::Mesh,
//! };
//!
//! let mesh = Mesh::new(vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], vec![[0, 1, 2]])?;
//! let rest = mesh.points().as_flattened();
//! let triangle = Triangles::new(rest, 0..3, &mesh, MaterialParameters::default().into());
//! assert_eq!(triangle.elastic_energy(rest), 0.0);
//! // Inside out.
//! assert_eq!(triangle.inverted(&[0.0, 0.0, 0.0, 1.0, 1.0, 0.0]), [1, 1]);
//! # Ok::<(), gingerbread::meshes::MeshError>(())
//! ```

mod accumulator;
mod blocks;
mod coupled_mass;
mod diagnostics;
mod discrete_gradient;
pub(crate) mod frame;
mod gather;
mod hinges;
mod kind;
mod material;
mod membrane;
mod partitions;
mod point_law;
mod six_nodes;
mod space_springs;
mod spring;
mod tangent;
mod triangle;

pub use accumulator::{Accumulator, Adding, EulerUpdate, Scatter, UniformForce};
pub(crate) use blocks::{EnergyLaw, StressLaw};
pub use coupled_mass::{CoupledMass, MassSolver};
pub use diagnostics::{Diagnostics, Field, PointStress};
pub(crate) use gather::{STAGE_ELEMENTS, reserve_scratch};
pub use hinges::Hinges;
pub use kind::ElementKind;
pub use material::{BodyMaterial, OwnMaterial};
pub use membrane::Membranes;
pub(crate) use partitions::is_unpartitioned;
pub use six_nodes::SixNodes;
pub use space_springs::SpaceSprings;
pub(crate) use spring::direction;
pub use spring::{NetSprings, Springs};
pub(crate) use tangent::Isotropic;
pub use triangle::Triangles;

use crate::{
    contact::{ContactModel, SurfaceVertices},
    effects::Effect,
    meshes::{Numbering, Pin, pinned},
    obstacles::Surfaces,
};
use std::{ops::Range, sync::Arc};

/// All elements of one body or net: an effect whose energy is elastic.
pub trait ElasticElements: Effect {
    /// Scene numbers of their vertices.
    fn vertices(&self) -> Range<usize>;

    /// Energy scale of a strain of one in all elements \[J\]: for shear alone, and for any strain. Energies are small or
    /// large by this measure.
    fn energy_scales(&self) -> [f64; 2];

    /// How many elements are inverted at these positions \[m\], and how many can be.
    fn inverted(&self, _x: &[f64]) -> [usize; 2] {
        [0; 2]
    }
}

/// All elements of a scene, for effects that act on them.
#[derive(Clone, Debug, Default)]
pub struct Elements {
    /// The triangles of each body.
    pub triangles: Vec<Arc<Triangles>>,
    /// The springs of each net.
    pub springs: Vec<NetSprings>,
    /// The numbers of those springs in the list of each net.
    pub spring_numbers: Vec<Numbering>,
    /// Triangles between the particles of each net; a net may have none.
    pub faces: Vec<Arc<Vec<[u32; 3]>>>,
    /// The triangles of each membrane.
    pub membranes: Vec<Arc<Membranes>>,
    /// Names of the bodies, of the nets after them, and of the membranes after these.
    pub names: Vec<String>,
    /// The flat shapes of those parts, by which vertices are named.
    pub shapes: Vec<FlatShape>,
    /// Positions at rest, flat \[m\].
    pub rest: Arc<Vec<f64>>,
    /// Positions at the start, flat \[m\].
    pub start: Arc<Vec<f64>>,
    /// Boundaries of bodies and particles of nets.
    pub surface: Arc<SurfaceVertices>,
    /// How they touch.
    pub contact: ContactModel,
    /// Surfaces of obstacles that files hold.
    pub surfaces: Surfaces,
}

/// Flat shape of a body, net or membrane at rest.
#[derive(Clone, Debug)]
pub struct FlatShape {
    /// Its first vertex in the scene.
    pub first: u32,
    /// Positions of its vertices in its own plane, flat \[m\].
    pub points: Vec<f64>,
    /// Their numbers in the level.
    pub numbering: Numbering,
}

impl FlatShape {
    /// Scene numbers of the vertices that some rules name, ascending.
    ///
    /// # Errors
    /// A sentence, if there is no such vertex.
    pub fn pinned(&self, pins: &[Pin]) -> Result<Vec<u32>, String> {
        let own = pinned(pins, &self.points, &self.numbering)?;
        Ok(own.into_iter().map(|vertex| vertex + self.first).collect())
    }
}

impl Elements {
    /// Number of coordinates of a vertex.
    pub fn dimension(&self) -> usize {
        let in_space = self.springs.iter().any(|springs| springs.dimension() == 3);
        if in_space || !self.membranes.is_empty() { 3 } else { 2 }
    }

    /// Triangles of the membranes and of the nets in space, by the numbers of their corners in the scene.
    pub fn cloth_faces(&self) -> impl Iterator<Item = [u32; 3]> {
        let nets = self.springs.iter().zip(&self.faces).filter(|(springs, _)| springs.dimension() == 3);
        let sheets = nets.map(|(_, faces)| faces.as_slice());
        sheets.chain(self.membranes.iter().map(|membrane| membrane.corners())).flatten().copied()
    }

    /// Scene numbers of the vertices that some rules name, in the parts of a name or in all.
    ///
    /// # Errors
    /// A sentence, if there is no such part or vertex.
    pub fn pinned(&self, of: Option<&str>, pins: &[Pin]) -> Result<Vec<u32>, String> {
        let shapes: Vec<_> = match of {
            Some(name) => self.named(name)?.iter().filter_map(|number| self.shapes.get(*number)).collect(),
            None => self.shapes.iter().collect(),
        };
        let mut vertices = Vec::new();
        for shape in shapes {
            vertices.extend(shape.pinned(pins)?);
        }
        Ok(vertices)
    }

    /// Numbers of the bodies and nets of a name, for the effect that names them; bodies come first.
    ///
    /// # Errors
    /// A sentence with the names that there are, if there is none.
    pub fn named(&self, name: &str) -> Result<Vec<usize>, String> {
        let found: Vec<_> = (0..self.names.len()).filter(|number| self.names[*number] == name).collect();
        if !found.is_empty() {
            return Ok(found);
        }
        let names: Vec<_> = self.names.iter().map(|name| format!("{name:?}")).collect();
        Err(format!("no body or net is called {name:?}; there are: {}", names.join(", ")))
    }
}
