//! Facts about elements and materials: forces, stiffness, and how they are computed.

mod bending;
#[path = "../common/mod.rs"]
mod common;
mod compression;
mod discrete_gradient;
mod eigenvalues;
mod fans;
mod forces;
mod invariance;
mod inversion_recovery;
mod materials;
mod membrane;
mod numbering;
mod partitions;
mod reference;
mod simd;
mod six_nodes;
mod springs;
