//! Sparse systems of equations with a symmetric matrix of small square blocks, one block row a vertex: direct and
//! iterative solvers, and Newton's method. This module is independent of the meaning of the numbers.

mod block_matrix;
mod cholesky;
mod coarsening;
mod conjugate;
mod counts;
mod dense;
mod elimination;
mod linear_system;
mod newton;
mod supernodes;
mod two_level;

pub use block_matrix::{Block, BlockMatrix, SparseMatrix, Tangent, Weights};
pub use cholesky::Factor;
pub use counts::NewtonCounts;
pub use newton::{Equations, LinearSolver, Newton};
