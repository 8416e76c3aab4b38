//! Elements: the pieces that store elastic energy. An element is an effect like any other to whoever takes a step.

mod blocks;
mod board;
mod caches;
mod claim;
mod corners;
mod diagnostics;
mod fields;
mod gather;
mod kick;
mod parts;
mod patience;
mod spring;
mod stages;
mod sweep;
mod tangent;
mod target;
mod triangle;
mod walk;

pub(crate) use blocks::Law;
pub(crate) use board::Board;
pub use caches::{Bytes, Caches};
pub use diagnostics::Diagnostics;
pub use fields::Field;
pub(crate) use gather::{STRETCH, make_room};
pub(crate) use parts::{Parts, Walker};
pub use spring::Springs;
pub(crate) use tangent::Isotropic;
pub use target::{Adding, Kicking, Target, UniformForce};
pub use triangle::Triangles;
pub(crate) use walk::{Looks, More, Outcome, Way};

use std::sync::Arc;

/// All elements of a scene, for effects that act on them.
#[derive(Clone, Debug, Default)]
pub struct Elements {
    /// The triangles of each body.
    pub triangles: Vec<Arc<Triangles>>,
    /// The springs of each net.
    pub springs: Vec<Arc<Springs>>,
    /// Edges of the boundaries of all bodies, with the body on their left.
    pub boundary: Arc<Vec<[u32; 2]>>,
}
