//! Gingerbread: an FEM sandbox of deformable bodies in the plane and cloth in space, as a simulation library with a window on top.
//!
//! A **level file** lists bodies, nets, membranes and effects; a **scene** is built from it once and does not change while time runs; an
//! **integrator** advances the **state**; the window draws a **snapshot** and sends **commands**.
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
//! # Modules, in reading order
//!
//! Each module uses only those before it (`tests/house.rs` checks this). Where a module has kinds, its `mod.rs` holds the
//! trait and the list, and each kind is one file beside it: a new kind is that file, its `mod` line and one entry in
//! `registry!`. Menus, level files and tests use the same list.
//!
//! | module | content |
//! |---|---|
//! | [`text`] | decoding of text files |
//! | [`quantity`] | physical quantities with unit and valid range |
//! | [`registry`] | the lists of kinds, and own kinds from outside |
//! | [`clock`] | wall time, and with the feature `processor-time` that of a thread |
//! | [`terminal`] | text for a terminal: escaped control characters, no panic where a stream is closed |
//! | `table` | tables as CSV; feature `csv` |
//! | `random` | pseudo-random numbers with a fixed seed |
//! | [`simd`] | SIMD vectors: formulas for one number or for several at once, with the same bits on every processor |
//! | [`formula`] | formulas typed as text, with exact derivatives |
//! | [`materials`] | constitutive models: energy, stress and stiffness as functions of F |
//! | [`meshes`] | triangle meshes: the gingerbread man, rectangles, disks, outlines, files |
//! | `picture` | pictures as pixels, and as PNG files; feature `window` |
//! | `outlines` | outlines of bodies in SVG drawings and PNG pictures; feature `window` |
//! | [`nets`] | particles and springs: chains, sheets, lists |
//! | [`solvers`] | sparse matrices of small blocks, their factorisation, conjugate gradients, Newton's method |
//! | [`obstacles`] | rigid obstacles and their motions: distances, normals, corners; the only module that uses parry2d |
//! | [`effects`], [`elements`] and [`contact`] | forces: gravity, damping, the triangles, membranes and springs, and contact of bodies with obstacles and each other |
//! | [`state`] | positions and velocities |
//! | [`integrators`] | time integration, independent of physics |
//! | [`toys`] | small systems with an exact solution: the circle, the pendulum |
//! | [`finish`] | how cloth looks: colours, pattern, sheen |
//! | [`level`] | the level format |
//! | [`scene`] | a level built for stepping |
//! | [`stability`] | the longest stable step |
//! | [`inversion_recovery`] | shapes without inverted triangles and folds |
//! | [`impulse`] | sudden changes of velocities: a push or a burst |
//! | [`report`], [`guard`], [`fault`] | step statistics, the energy check of steps, and faults |
//! | [`simulation`], [`probe`] | stepping of a scene and its state; quantities of a running scene as columns of numbers |
//! | [`rewind`] | the states of the last seconds |
//! | `archive` | states over time as arrays for `NumPy`; feature `npz` |
//! | [`command`], [`document`], [`sandbox`] | user actions, undo, and their execution |
//! | [`snapshot`] | the data of a frame of the window |
//! | [`study`] | accuracy and cost: references, work-precision diagrams, mesh studies, drift |
//! | [`levels`], [`files`], `link` | built-in levels; reading and saving; levels in links |
//! | [`hard`] | the gallery of hard cases and their verdicts |
//! | `headless` | `gingerbread run`, `check`, `study`, `hard`, `break` (not in browsers); feature `cli` |
//! | `app` | the window; the only module that uses egui; feature `window` |
//! | `render` | `gingerbread render`: pictures without a window; features `cli` and `window` |
//!
//! Without these features the crate is the simulation alone.

#![forbid(unsafe_code)]
#![warn(clippy::print_stdout, clippy::print_stderr)]

pub mod text;

pub mod quantity;

pub mod registry;

pub mod clock;
#[cfg(feature = "csv")]
pub mod table;
pub mod terminal;

mod random;

pub mod simd;

pub mod formula;

pub mod materials;
pub mod meshes;
#[cfg(feature = "window")]
pub mod picture;

#[cfg(feature = "window")]
pub mod outlines;

pub mod nets;
pub mod solvers;

pub mod obstacles;

pub mod contact;
pub mod effects;
pub mod elements;

pub mod state;

pub mod integrators;
pub mod toys;

pub mod finish;
pub mod level;
pub mod scene;

pub mod impulse;
pub mod inversion_recovery;
pub mod stability;

pub mod fault;
pub mod guard;
pub mod report;

pub mod probe;
pub mod simulation;

pub mod rewind;

#[cfg(feature = "npz")]
pub mod archive;

pub mod command;
pub mod document;
pub mod sandbox;

pub mod snapshot;

pub mod study;

pub mod files;
pub mod levels;
#[cfg(feature = "link")]
pub mod link;

pub mod hard;

#[cfg(all(feature = "cli", not(target_arch = "wasm32")))]
pub mod headless;

#[cfg(feature = "window")]
pub mod app;

#[cfg(all(feature = "cli", feature = "window", not(target_arch = "wasm32")))]
pub mod render;
