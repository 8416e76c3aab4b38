//! Elements: the pieces that store elastic energy. An element is an effect like any other to whoever takes a step.

mod fields;
mod tangent;
mod triangle;

pub use fields::Field;
pub use triangle::Triangles;
