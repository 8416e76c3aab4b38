//! Sparse systems of equations: a symmetric matrix of 2 x 2 blocks, one block row a vertex, and how to solve with it.
//! Nothing here knows what the numbers mean.

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
