//! Promises about level files and meshes: what ships, what is saved, and what is refused.

#[path = "../common/mod.rs"]
mod common;
mod continuing;
mod faults;
mod hostile;
mod levels;
mod meshes;
mod random_levels;
mod refinement;
