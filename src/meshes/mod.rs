//! Triangle meshes of bodies. Each kind is one file; [`MeshKind`] lists them all.
//! Every mesh passes through [`Mesh::new`], which repairs winding and refuses all other errors.
//!
//! Kinds that define only an outline share `triangulate`, which fills it with nearly equilateral triangles.
//!
//! ```
//! use gingerbread::meshes::{Disk, Mesh, MeshSource as _, NoFiles};
//!
//! let disk = Disk::default().build(&NoFiles)?;
//! assert!(disk.area() > 0.0 && disk.min_angle() > 0.0);
//! // A triangle must have an area.
//! assert!(Mesh::new(vec![[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]], vec![[0, 1, 2]]).is_err());
//! # Ok::<(), gingerbread::meshes::MeshError>(())
//! ```

mod bisection;
mod count;
mod disk;
mod embedded;
mod error;
mod gingerbread;
mod mesh;
mod msh;
mod numbering;
mod obj;
mod outline;
mod pin;
mod points;
mod polygon;
mod rectangle;
mod refined;
mod surface;
mod topology;
mod triangulate;

pub(crate) use count::natural;
pub use count::{CountError, Whole};
pub use disk::Disk;
pub use embedded::{Embedded, IcingColor, Locator, Stroke};
pub use error::{MOST_TRIANGLES, MeshError};
pub use gingerbread::Gingerbread;
pub use mesh::Mesh;
pub(crate) use mesh::{NEAR, size};
pub use numbering::Numbering;
pub use obj::Obj;
pub use outline::Outline;
pub use pin::{Pin, extent};
pub(crate) use pin::{nearest, on_edge, pinned};
pub use points::Points;
pub(crate) use polygon::merged;
#[cfg(feature = "window")]
pub(crate) use polygon::{contains, signed_area, simplified};
pub use rectangle::{Diagonals, Rectangle};
pub use refined::Refined;
pub use surface::SurfaceMesh;
pub use topology::{Fan, boundary_edges};

use crate::{quantity::Quantity, registry::registry};
use std::path::{Path, PathBuf};

registry! {
    /// Where a body's triangles come from.
    pub enum MeshKind: dyn MeshSource {
        Gingerbread(Gingerbread),
        Rectangle(Rectangle),
        Disk(Disk),
        Outline(Outline),
        Points(Points),
        Obj(Obj),
        Refined(Refined),
    }
}

/// Recipe for a mesh.
pub trait MeshSource {
    /// Builds the mesh. The same recipe always gives the same bits.
    ///
    /// # Errors
    /// [`MeshError`] with the reason, in the recipe or in the file it names.
    fn build(&self, files: &dyn Files) -> Result<Mesh, MeshError>;

    /// Path of the file that the recipe names, if any.
    fn path_mut(&mut self) -> Option<&mut PathBuf> {
        None
    }

    /// Quantities that a panel may change.
    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        Vec::new()
    }

    /// The point of the true outline that is nearest to a point \[m\] beside it; the point itself where the outline is that of the triangles.
    fn onto_outline(&self, point: [f64; 2]) -> [f64; 2] {
        point
    }
}

/// Source of the files that recipes name. A browser or a test can serve them from memory.
pub trait Files {
    /// Text of a file, by the path written in the level.
    ///
    /// # Errors
    /// A sentence with the reason.
    fn read(&self, path: &Path) -> Result<String, String>;
}

/// Source without any file.
pub struct NoFiles;

impl Files for NoFiles {
    fn read(&self, _: &Path) -> Result<String, String> {
        Err("files cannot be read here".to_owned())
    }
}
