use super::{BlockMatrix, Factor};

/// Equations `g(z) = 0` whose matrix of derivatives is symmetric, or taken to be.
pub trait Equations {
    /// Writes g(z).
    fn residual(&mut self, z: &[f64], g: &mut [f64]);

    /// Writes dg/dz to a cleared matrix.
    fn derivative(&mut self, z: &[f64], matrix: &mut BlockMatrix);

    /// Writes the couples of vertices that the derivative has, in the order in which it adds them.
    fn couples(&self, add: &mut dyn FnMut(u32, u32));

    /// 1/weight of each number, zero where z must stay: residuals are measured by `sum g²/weight`.
    fn inverse_weight(&self) -> &[f64];

    /// How large a last change of any number of z may be, to stop there.
    fn tolerance(&self, z: &[f64]) -> f64;
}

/// What solving took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NewtonCounts {
    /// Newton iterations.
    pub iterations: u64,
    /// How often a Newton step was halved.
    pub cuts: u64,
    /// Factorisations of the matrix, failed ones included.
    pub factorisations: u64,
    /// Factorisations that had to be repeated with a heavier diagonal, as the matrix was not positive definite.
    pub shifts: u64,
    /// Solves that stopped before they reached their tolerance.
    pub unconverged: u64,
}

impl NewtonCounts {
    /// Nothing to solve.
    pub const NONE: Self = Self { iterations: 0, cuts: 0, factorisations: 0, shifts: 0, unconverged: 0 };
}

/// Newton's method with a line search, and everything it keeps between solves.
#[derive(Default)]
pub struct Newton {
    matrix: Option<(BlockMatrix, Factor)>,
}

impl Newton {
    /// Forgets which vertices are coupled.
    pub fn forget(&mut self) {
        self.matrix = None;
    }
}
