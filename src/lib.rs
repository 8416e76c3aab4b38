//! Gingerbread: a 2D deformable-body FEM sandbox.
#![allow(missing_docs)]

pub mod quantity;
pub(crate) mod registry;

pub mod materials;
pub mod meshes;
pub mod obstacles;

pub mod effects;
pub mod elements;

pub mod state;

pub mod integrators;

pub mod level;

pub mod scene;

pub mod stability;

pub mod fault;
pub mod report;

pub mod simulation;

pub mod command;
pub mod document;
pub mod sandbox;
pub mod snapshot;

pub mod files;
pub mod levels;

#[cfg(not(target_arch = "wasm32"))]
pub mod headless;
