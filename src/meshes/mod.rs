//! Triangle meshes: where bodies get their shape. Each kind is one file; [`MeshKind`] lists them all.
//! Whatever a kind makes passes through [`Mesh::new`], which repairs winding and refuses everything else that is wrong.
//!
//! Kinds that only know their outline share `triangulate`, which fills it with nearly equilateral triangles.

mod count;
mod delaunay;
mod disk;
mod error;
mod fans;
mod flatness;
mod gingerbread;
mod gingerbread_icing;
mod gingerbread_shape;
mod icing;
mod locate;
mod mesh;
mod numbering;
mod obj;
mod ordering;
mod outline;
mod points;
mod polygon;
mod rectangle;
mod topology;
mod triangulate;

pub use count::{CountError, Whole};
pub use disk::Disk;
pub use error::{MOST_TRIANGLES, MeshError};
pub use fans::Fan;
pub use gingerbread::Gingerbread;
pub use icing::{Embedded, IcingColor, Stroke};
pub use locate::Locator;
pub use mesh::Mesh;
pub(crate) use mesh::{NEAR, size};
pub use numbering::Numbering;
pub use obj::Obj;
pub use outline::Outline;
pub use points::Points;
pub(crate) use polygon::merged;
pub use rectangle::{Diagonals, Rectangle};

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
    }
}

/// A recipe for a mesh.
pub trait MeshSource {
    /// Makes the mesh; the same recipe always gives the same bits.
    ///
    /// # Errors
    /// [`MeshError`] says what is wrong with the recipe or the file it names.
    fn build(&self, files: &dyn Files) -> Result<Mesh, MeshError>;

    /// The path of the file it names, if it does.
    fn path_mut(&mut self) -> Option<&mut PathBuf> {
        None
    }

    /// The numbers a panel may change.
    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        Vec::new()
    }
}

/// How a recipe reads the files it names, so that a browser or a test can serve them from memory.
pub trait Files {
    /// The text of a file, by the path written in the level.
    ///
    /// # Errors
    /// A sentence that says why there is none.
    fn read(&self, path: &Path) -> Result<String, String>;
}

/// No files at all.
pub struct NoFiles;

impl Files for NoFiles {
    fn read(&self, _: &Path) -> Result<String, String> {
        Err("files cannot be read here".to_owned())
    }
}
