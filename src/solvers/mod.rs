//! Sparse systems of equations with a symmetric matrix of 2 x 2 blocks, one block row a vertex: direct and iterative
//! solvers, and Newton's method. This module is independent of the meaning of the numbers.

mod block_matrix;
mod cholesky;
mod coarsening;
mod conjugate;
mod counts;
mod dense;
mod elimination;
mod newton;
mod two_level;

pub use block_matrix::{BlockMatrix, Tangent, Weights};
pub use cholesky::Factor;
pub use counts::NewtonCounts;
pub use newton::{Equations, LinearSolver, Newton};
