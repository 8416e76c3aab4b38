//! Sparse systems of equations with a symmetric matrix of small square blocks, one block row a vertex: direct and
//! iterative solvers, and Newton's method. This module is independent of the meaning of the numbers.
//!
//! ```
//! use gingerbread::solvers::{Block, BlockMatrix, Factor};
//!
//! // Two vertices in space, each held by a spring of stiffness 2 and tied to the other by one of stiffness 1.
//! let mut matrix = BlockMatrix::<3>::new(2, &[[0, 1]]);
//! let one = Block::identity();
//! matrix.diagonal(0, &(one * 3.0));
//! matrix.diagonal(1, &(one * 3.0));
//! matrix.off_diagonal(&-one);
//! let mut factor = Factor::new(&matrix).ok_or("it fits in memory")?;
//! assert!(factor.factorise(&matrix, &[1.0; 6], 0.0), "it is positive definite");
//! let mut x = [8.0, 0.0, 0.0, 0.0, 0.0, 0.0];
//! factor.solve(&mut x);
//! assert!((x[0] - 3.0).abs() < 1e-12 && (x[3] - 1.0).abs() < 1e-12);
//! # Ok::<(), &str>(())
//! ```

mod block_matrix;
mod block_rows;
mod cholesky;
mod conjugate;
mod constraints;
mod dense;
mod elimination;
mod linear_system;
mod newton;
mod supernodes;
mod two_level;

pub use block_matrix::{Block, BlockMatrix, SparseMatrix, Tangent, Weights};
pub use block_rows::BlockRows;
pub use cholesky::Factor;
pub use constraints::ConstraintRows;
pub use newton::{Equations, LinearSolver, Newton, NewtonCounts};
