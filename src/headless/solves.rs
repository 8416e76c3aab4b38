//! What solving the equations of implicit steps took.

use crate::report::Counts;
use serde::Serialize;

/// What solving the equations of implicit steps took; field names are stable.
#[derive(Debug, Serialize)]
pub struct SolveReport {
    /// Iterations of Newton's method.
    pub newton_iterations: u64,
    /// Newton steps cut by the line search.
    pub line_search_cuts: u64,
    /// Sparse factorisations.
    pub factorisations: u64,
    /// Factorisations repeated with another matrix, as it was not positive definite.
    pub indefinite: u64,
    /// Steps whose equations were not solved to tolerance.
    pub unconverged_steps: u64,
    /// Iterations of conjugate gradients for linear systems.
    pub linear_iterations: u64,
    /// Linear systems solved with what had been factorised for an earlier one.
    pub reused_factors: u64,
    /// Solves whose linear systems were factorised after all, as iterations were too slow.
    pub abandoned_iterations: u64,
}

impl From<Counts> for SolveReport {
    fn from(counts: Counts) -> Self {
        Self {
            newton_iterations: counts.newton_iterations,
            line_search_cuts: counts.line_search_cuts,
            factorisations: counts.factorisations,
            indefinite: counts.indefinite,
            unconverged_steps: counts.unconverged,
            linear_iterations: counts.linear_iterations,
            reused_factors: counts.reused_factors,
            abandoned_iterations: counts.abandoned_iterations,
        }
    }
}
