//! Counts of a Newton solve.

/// Counts of solves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NewtonCounts {
    /// Newton iterations.
    pub iterations: u64,
    /// Halvings of Newton steps.
    pub cuts: u64,
    /// Factorisations of the matrix, failed ones included.
    pub factorisations: u64,
    /// Factorisations that had to be repeated with another matrix, as it was not positive definite.
    pub indefinite: u64,
    /// Solves that stopped before they reached their tolerance.
    pub unconverged: u64,
    /// Iterations of conjugate gradients.
    pub linear_iterations: u64,
    /// Linear systems solved with an earlier factor.
    pub reused: u64,
    /// Solves that changed from slow iterations to factorisation.
    pub abandoned: u64,
}

impl NewtonCounts {
    /// Nothing to solve.
    pub const NONE: Self = Self {
        iterations: 0,
        cuts: 0,
        factorisations: 0,
        indefinite: 0,
        unconverged: 0,
        linear_iterations: 0,
        reused: 0,
        abandoned: 0,
    };

    /// Adds the counts of another solve.
    pub fn add(&mut self, other: &Self) {
        self.iterations += other.iterations;
        self.cuts += other.cuts;
        self.factorisations += other.factorisations;
        self.indefinite += other.indefinite;
        self.unconverged += other.unconverged;
        self.linear_iterations += other.linear_iterations;
        self.reused += other.reused;
        self.abandoned += other.abandoned;
    }
}
