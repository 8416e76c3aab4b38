//! Promises about studies and the error of a running scene.

mod adaptive;
mod budget;
#[path = "../common/mod.rs"]
mod common;
mod dial;
mod difference;
mod drift_and_meshes;
#[path = "../common/program.rs"]
mod program;
mod study;
mod twin;
