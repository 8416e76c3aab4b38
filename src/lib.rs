//! Gingerbread: a 2D deformable-body FEM sandbox, as a simulation library with a window on top.
//!
//! A **level file** says what there is and which effects act; a **scene** is built from it once and does not change
//! while time runs; an **integrator** advances the **state**; the window draws a **snapshot** and answers with
//! **commands**.
//!
//! ```text
//! levels/x.ron --serde--> Level --build--> Scene (constant) --+
//!                                                             +--> Simulation::advance --> Counts, Fault
//!                                State (moves) <--------------+         |
//!                                                                       v
//!       Command <-- panels, keys, mouse <-- App::ui <-- Snapshot (a copy, no references back)
//!          +------- applied at the start of App::logic --------> Sandbox::apply
//! ```
//!
//! # The rooms, in reading order
//!
//! Each uses only those before it (`tests/house.rs` keeps that). Where a room has kinds, its `mod.rs` holds the trait
//! and the list, and each kind is one file beside it: a new one is that file, its `mod` line and one entry in
//! `registry!`. Menus, level files and tests walk the same list.
//!
//! | room | what it knows |
//! |---|---|
//! | [`text`] | decoding of text files |
//! | [`quantity`] | physical quantities that cannot hold a bad value, with unit and range |
//! | `registry` | the macro behind every list of kinds |
//! | [`terminal`] | text for a terminal: escaped control characters, no panic where a stream is closed |
//! | [`table`] | tables as CSV |
//! | `random` | pseudo-random numbers with a fixed seed |
//! | [`simd`] | SIMD vectors: formulas for one number or for several at once, with the same bits on every processor |
//! | [`materials`] | constitutive models: energy, stress and stiffness as functions of F |
//! | [`meshes`] | where triangles come from: the gingerbread man, rectangles, disks, outlines, files |
//! | [`nets`] | where particles and springs come from: chains, sheets, lists |
//! | [`obstacles`] | what bodies bump into; the one room that says parry2d |
//! | [`solvers`] | sparse matrices of 2 x 2 blocks, their factorisation, conjugate gradients, Newton's method |
//! | [`effects`] and [`elements`] | everything that acts: gravity, damping, walls, and the triangles and springs themselves |
//! | [`state`] | positions and velocities: what moves |
//! | [`integrators`] | how time passes, without any physics |
//! | [`toys`] | small systems with an exact solution: the circle, the pendulum |
//! | [`level`] | what a file may say |
//! | [`scene`] | a level made ready for stepping |
//! | [`stability`] | how long a step may be |
//! | [`untangle`] | where a body lies over itself, and how it gets out |
//! | [`report`], [`guard`], [`fault`] | what stepping cost, what keeps it stable, and why it stopped |
//! | [`simulation`] | scene and state together: taking steps |
//! | [`rewind`] | the last seconds, to go back to |
//! | [`command`], [`document`], [`sandbox`] | what a person can do, what can be undone, and doing it |
//! | [`snapshot`] | what a frame of the window is drawn from |
//! | [`study`] | what accuracy costs in time: references, work-precision diagrams, mesh studies, drift |
//! | [`levels`], [`files`] | the levels that come along; reading and saving |
//! | [`hard`] | what is hard to hold: the gallery of hard cases, and what decides them |
//! | `headless` | `gingerbread run`, `check`, `study` and `hard` (not in browsers); feature `cli` |
//! | `app` | the window; the one room that says egui; feature `window` |
//!
//! Without both features the crate is the simulation alone.

#![forbid(unsafe_code)]
#![warn(clippy::print_stdout, clippy::print_stderr)]

pub mod text;

pub mod quantity;
mod registry;

pub mod table;
pub mod terminal;

mod random;

pub mod simd;

pub mod materials;
pub mod meshes;
pub mod nets;
pub mod obstacles;

pub mod solvers;

pub mod effects;
pub mod elements;

pub mod state;

pub mod integrators;
pub mod toys;

pub mod level;
pub mod scene;

pub mod stability;
pub mod untangle;

pub mod fault;
pub mod guard;
pub mod report;

pub mod simulation;

pub mod rewind;

pub mod command;
pub mod document;
pub mod sandbox;

pub mod snapshot;

pub mod study;

pub mod files;
pub mod levels;

pub mod hard;

#[cfg(all(feature = "cli", not(target_arch = "wasm32")))]
pub mod headless;

#[cfg(feature = "window")]
pub mod app;
