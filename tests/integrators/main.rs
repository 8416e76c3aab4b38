//! Facts about time stepping and its solvers.

#[path = "../common/mod.rs"]
mod common;
mod implicit;
mod integrators;
mod iterations;
mod measured_order;
mod orders;
mod solvers;
mod steps;
