//! Newton's method with line search.

use super::{
    SparseMatrix, Tangent,
    conjugate::{SolveOutcome, SolveTolerance, greatest},
    linear_system::{LinearSystem, analyse},
};

/// Equations `g(z) = 0` with a symmetric matrix of derivatives, or one that is taken as symmetric.
pub trait Equations {
    /// Writes g(z); zero for fixed numbers.
    fn residual(&mut self, z: &[f64], g: &mut [f64]);

    /// Number of numbers of a vertex, which is the size of the blocks of the matrix: 1, 2 or 3.
    fn block_size(&self) -> usize;

    /// Adds dg/dz, with the tangent's change of eigenvalues, to a cleared matrix.
    fn derivative(&mut self, z: &[f64], tangent: Tangent, matrix: &mut dyn SparseMatrix);

    /// Whether [`Self::derivative`] is that of g, apart from what makes it unsymmetric. Steps with another matrix can run in circles.
    fn has_derivative(&self) -> bool {
        true
    }

    /// Whether steps are corrected: see [`Self::correct_step`].
    fn is_constrained(&self) -> bool {
        false
    }

    /// Corrects a step from z for constraints that the derivative does not know. `invert` replaces a vector by the inverse of the matrix
    /// times it.
    fn correct_step(&mut self, _z: &[f64], _step: &mut [f64], _invert: &mut dyn FnMut(&mut [f64])) {}

    /// Sparsity pattern of the derivative: its vertex pairs, in the order in which it adds them.
    fn sparsity_pattern(&self, add: &mut dyn FnMut(u32, u32));

    /// Adds vertex pairs to the pattern that the derivative at z needs. Returns whether it has changed since the last call.
    fn pattern_changes(&mut self, _z: &[f64]) -> bool {
        false
    }

    /// Largest allowed multiple of a step from z.
    fn longest_step(&mut self, _z: &[f64], _step: &[f64]) -> f64 {
        f64::INFINITY
    }

    /// 1/weight of each number, zero where z is fixed: residuals are measured by `sum g²/weight`.
    fn inverse_weight(&self) -> &[f64];

    /// Sets z to an alternative start, which is used if its residual is smaller, or if the step from it to z is longer
    /// than [`Self::longest_step`] allows. Fixed numbers must stay.
    fn other_start(&self, z: &mut [f64]);

    /// Tolerance of the vector of any vertex.
    fn tolerance(&self, z: &[f64]) -> f64;

    /// Discretisation error of the solution itself, as far as it is known. Large systems need not be solved to more
    /// than a small fraction of it.
    fn error(&self, _z: &[f64]) -> f64 {
        0.0
    }
}

/// Method for linear systems.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LinearSolver {
    /// The faster method for the size and the pattern of the matrix.
    #[default]
    Chosen,
    /// Factorisation.
    Direct,
    /// Conjugate gradients where they converge.
    Iterative,
}

/// Newton's method with a line search, and its buffers.
///
/// Where the matrix is not positive definite, the eigenvalues of its elements are changed (see [`Tangent`]), and
/// against round-off its diagonal is increased, so that every Newton step is a descent direction. No step is longer
/// than [`Equations::longest_step`] allows. It is halved while g is not finite at its end, or its component along the
/// step has the opposite sign and more than nine tenths of its size at the start. For equations that are the gradient
/// of a potential this bounds the potential without computing it, and it also applies where damping leaves no
/// potential.
///
/// It stops when the remaining steps, extrapolated with the last convergence rate, sum to less than the tolerance
/// (Hairer and Wanner, *Solving Ordinary Differential Equations II*, section IV.8). Where the matrix is not the derivative and steps do not
/// shrink, they are shortened.
///
/// Large systems are solved iteratively ([`LinearSolver`]), each step as exactly as is useful at this distance from the
/// solution (Eisenstat and Walker, *Choosing the forcing terms in an inexact Newton method*, SIAM Journal on Scientific
/// Computing 17, 1996, choice 2), and the whole no further than a thousandth of the error of the equations themselves.
#[derive(Default)]
pub struct Newton {
    system: Option<Box<dyn LinearSystem>>,
    block_size: usize,
    linear_solver: LinearSolver,
    /// Norm of g at the last step, and the forcing term of that step.
    forced: Option<(f64, f64)>,
    /// Fraction of its error that the present step has left.
    left: f64,
    /// Whether the sparsity pattern must be computed again.
    is_stale: bool,
    g: Vec<f64>,
    trial: Vec<f64>,
    trial_g: Vec<f64>,
    step: Vec<f64>,
    sizes: Vec<f64>,
}

impl Newton {
    /// Most iterations of one solve, and of one with another matrix than the derivative: what they do not reach soon they do not reach at all.
    pub const ITERATIONS: usize = 200;
    const INEXACT_ITERATIONS: usize = 50;
    /// Most halvings of one step, to 1e-9 of it.
    const CUTS: u32 = 30;
    /// Greatest fraction of the longest step, and the fraction of a step below which it counts as zero.
    const TO_BOUNDARY: f64 = 0.9;
    const STUCK: f64 = 1e-6;
    /// Greatest opposite slope at the end of a step, as a fraction of the slope at its start.
    const BACK: f64 = 0.9;
    /// Tolerance of large systems as a fraction of the error of the equations.
    const SHARE: f64 = 1e-3;
    /// Greatest forcing term of an iterative step, its value where there is only one step, and the factor of Eisenstat
    /// and Walker.
    const FORCING: f64 = 1e-2;
    const ONLY: f64 = 1e-6;
    const GAMMA: f64 = 0.9;
    /// Tolerance of a linear system as a fraction of that of the equations.
    const INNER: f64 = 0.1;

    /// Makes a solver with this linear solver.
    pub fn new(linear_solver: LinearSolver) -> Self {
        Self { linear_solver, ..Self::default() }
    }

    /// Marks the sparsity pattern as stale. If it is unchanged, the symbolic factorisation is kept.
    pub fn forget(&mut self) {
        self.is_stale = true;
    }

    /// Largest change of any vertex's z in each iteration of the last solve.
    pub fn sizes(&self) -> &[f64] {
        &self.sizes
    }

    /// Solves g(z) = 0 from z, or from the alternative start. If g is not finite at both, z becomes NaN.
    pub fn solve(&mut self, equations: &mut dyn Equations, z: &mut [f64]) -> NewtonCounts {
        let mut counts = NewtonCounts::NONE;
        self.prepare(equations, z.len());
        self.start(equations, z);
        let mut last = f64::INFINITY;
        let mut least = Regularisation::EXACT;
        let mut damping = Damping::default();
        let most = if equations.has_derivative() { Self::ITERATIONS } else { Self::INEXACT_ITERATIONS };
        for _ in 0..most {
            if self.g.iter().all(|g| *g == 0.0) {
                return counts;
            }
            let solve_tolerance = self.solve_tolerance(equations, z);
            let Some(regularisation) = self.find_step(equations, z, least, solve_tolerance, &mut counts) else { break };
            counts.iterations += 1;
            let size = greatest(&self.step, self.block_size);
            let tolerance = if self.left > 0.0 && regularisation == Regularisation::EXACT {
                Self::loose(equations, z)
            } else {
                equations.tolerance(z)
            };
            self.sizes.push(size);
            // A step shortened by a shift does not bound the remaining error.
            if size <= tolerance && !regularisation.shifts() {
                z.iter_mut().zip(&self.step).for_each(|(z, step)| *z += step);
                return counts;
            }
            let most = if equations.has_derivative() { 1.0 } else { damping.after(size) };
            let share = self.search(equations, z, most, &mut counts);
            least = regularisation.after(share);
            let whole = share == 1.0 && !regularisation.shifts();
            let ratio = (size / last).max(self.left);
            if whole && last.is_finite() && ratio < 1.0 && size * ratio / (1.0 - ratio) <= tolerance {
                return counts;
            }
            last = if whole { size } else { f64::INFINITY };
        }
        counts.unconverged += 1;
        counts
    }

    /// One linear solve: z such that `derivative(at) z = -g`; NaN if that fails.
    pub fn linear(&mut self, equations: &mut dyn Equations, at: &[f64], g: &[f64], z: &mut [f64]) -> NewtonCounts {
        let mut counts = NewtonCounts::NONE;
        self.prepare(equations, z.len());
        self.g.copy_from_slice(g);
        let solve_tolerance = SolveTolerance { share: Self::ONLY, error: 0.0 };
        if self.find_step(equations, at, Regularisation::EXACT, solve_tolerance, &mut counts).is_some() {
            z.copy_from_slice(&self.step);
        } else {
            z.fill(f64::NAN);
            counts.unconverged += 1;
        }
        counts
    }

    fn prepare(&mut self, equations: &dyn Equations, count: usize) {
        if self.system.is_none() || std::mem::take(&mut self.is_stale) {
            self.block_size = equations.block_size();
            self.system = analyse(self.system.take(), equations, count, self.linear_solver);
        }
        for buffer in [&mut self.g, &mut self.trial, &mut self.trial_g, &mut self.step] {
            buffer.resize(count, 0.0);
        }
        self.sizes.clear();
        self.sizes.reserve(Self::ITERATIONS);
        self.forced = None;
        if let Some(system) = &mut self.system {
            system.begin();
        }
    }

    /// Tolerance of any vertex where iterations with the true derivative converge. Less smooth equations might stop too
    /// early with it.
    fn loose(equations: &dyn Equations, z: &[f64]) -> f64 {
        equations.tolerance(z).max(Self::SHARE * equations.error(z))
    }

    /// Tolerance of the next linear solve.
    fn solve_tolerance(&mut self, equations: &dyn Equations, z: &[f64]) -> SolveTolerance {
        let norm = weighted(&self.g, equations.inverse_weight()).sqrt();
        let share = self.forced.map_or(Self::FORCING, |(last, share)| {
            let fast = Self::GAMMA * (norm / last) * (norm / last);
            let slow = Self::GAMMA * share * share;
            // Safeguard: the forcing term does not decrease faster than its last value allows.
            let forced = if slow > 0.1 { fast.max(slow) } else { fast };
            forced.min(Self::FORCING)
        });
        self.forced = Some((norm, share));
        SolveTolerance { share, error: Self::INNER * Self::loose(equations, z) }
    }

    /// Chooses one of the two starts.
    fn start(&mut self, equations: &mut dyn Equations, z: &mut [f64]) {
        equations.residual(z, &mut self.g);
        self.trial.copy_from_slice(z);
        equations.other_start(&mut self.trial);
        equations.residual(&self.trial, &mut self.trial_g);
        self.step.iter_mut().zip(&*z).zip(&self.trial).for_each(|((step, z), trial)| *step = z - trial);
        let is_apart = equations.longest_step(&self.trial, &self.step) <= 1.0;
        let weight = equations.inverse_weight();
        let (one, other) = (weighted(&self.g, weight), weighted(&self.trial_g, weight));
        if other < one || !one.is_finite() || is_apart && other.is_finite() {
            z.copy_from_slice(&self.trial);
            std::mem::swap(&mut self.g, &mut self.trial_g);
            if !other.is_finite() {
                z.fill(f64::NAN);
            }
        }
    }

    /// Computes the Newton step with at least this regularisation; returns the one that was used, or `None` if there is
    /// no step.
    fn find_step(
        &mut self,
        equations: &mut dyn Equations,
        z: &[f64],
        least: Regularisation,
        solve_tolerance: SolveTolerance,
        counts: &mut NewtonCounts,
    ) -> Option<Regularisation> {
        if !z.iter().all(|z| z.is_finite()) {
            return None;
        }
        if equations.pattern_changes(z) {
            self.system = analyse(self.system.take(), equations, z.len(), self.linear_solver);
            self.system.as_mut()?.begin();
        }
        let system = self.system.as_mut()?;
        let mut filled = None;
        for regularisation in (least.0..=Regularisation::MOST).map(Regularisation) {
            let tangent = regularisation.tangent();
            if filled.replace(tangent) != Some(tangent) {
                equations.derivative(z, tangent, system.cleared());
            }
            let weight = equations.inverse_weight();
            if !regularisation.shifts() && !equations.is_constrained() {
                let error = Self::INNER * equations.tolerance(z);
                let solve_tolerance = if regularisation == Regularisation::EXACT {
                    solve_tolerance
                } else {
                    SolveTolerance { error, ..solve_tolerance }
                };
                match system.iterate((tangent, weight), (&self.g, &mut self.step), solve_tolerance, counts) {
                    SolveOutcome::Solved(share) => {
                        self.left = share;
                        return self.step.iter().all(|step| step.is_finite()).then_some(regularisation);
                    }
                    SolveOutcome::Indefinite => {
                        counts.indefinite += 1;
                        continue;
                    }
                    SolveOutcome::Slow => {}
                }
            }
            self.left = 0.0;
            counts.factorisations += 1;
            if system.factorise(weight, regularisation.shift()) {
                self.step.iter_mut().zip(&self.g).for_each(|(step, g)| *step = -g);
                system.solve(&mut self.step);
                if equations.is_constrained() {
                    equations.correct_step(z, &mut self.step, &mut |vector| system.solve(vector));
                }
                return self.step.iter().all(|step| step.is_finite()).then_some(regularisation);
            }
            counts.indefinite += 1;
        }
        None
    }

    /// Line search from at most a fraction of the step; returns the fraction that was taken, which may be zero.
    fn search(&mut self, equations: &mut dyn Equations, z: &mut [f64], most: f64, counts: &mut NewtonCounts) -> f64 {
        let along = |g: &[f64], step: &[f64]| g.iter().zip(step).map(|(g, step)| g * step).sum::<f64>();
        let limit = -Self::BACK * along(&self.g, &self.step);
        let limit_to_boundary = Self::TO_BOUNDARY * equations.longest_step(z, &self.step);
        // At a barrier the solution lies beyond it: a step limited to the barrier would never progress.
        let mut share = if limit_to_boundary < Self::STUCK { 1.0 } else { limit_to_boundary }.min(most);
        for _ in 0..Self::CUTS {
            for ((trial, z), step) in self.trial.iter_mut().zip(&*z).zip(&self.step) {
                *trial = z + share * step;
            }
            equations.residual(&self.trial, &mut self.trial_g);
            let slope = along(&self.trial_g, &self.step);
            // NaN fails the comparison.
            if slope <= limit && slope.is_finite() {
                z.copy_from_slice(&self.trial);
                std::mem::swap(&mut self.g, &mut self.trial_g);
                return share;
            }
            counts.cuts += 1;
            share *= 0.5;
        }
        0.0
    }
}

/// Greatest fraction of steps that run in circles.
struct Damping {
    fraction: f64,
    /// Size of the step that the next ones are compared with, and their number.
    size: f64,
    steps: u32,
}

impl Default for Damping {
    fn default() -> Self {
        Self { fraction: 1.0, size: f64::INFINITY, steps: 0 }
    }
}

impl Damping {
    /// Steps within which the size must halve; otherwise the fraction does.
    const STEPS: u32 = 8;

    /// Fraction after a step of a size was found.
    fn after(&mut self, size: f64) -> f64 {
        self.steps += 1;
        if size < 0.5 * self.size {
            (self.size, self.steps) = (size, 0);
        } else if self.steps >= Self::STEPS {
            (self.size, self.steps) = (size, 0);
            self.fraction *= 0.5;
        }
        self.fraction
    }
}

/// Levels of regularisation of a Newton step. The next level is used where the one before gives no step, or one that is
/// too long.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
struct Regularisation(i32);

impl Regularisation {
    /// The true derivative.
    const EXACT: Self = Self(0);
    /// Its positive semidefinite part, then the absolute eigenvalues: where the first gives long steps along directions
    /// without stiffness, the second does not.
    const DEFINITE: Self = Self(1);
    const ABSOLUTE: Self = Self(2);
    /// Greatest level. Beyond [`Self::ABSOLUTE`] the diagonal is increased, against round-off; in the end steps are
    /// short and along the negative gradient.
    const MOST: i32 = 12;
    /// Least shift, as a fraction of the greatest entry of the diagonal over its weight: round-off of that entry.
    const SHIFT: f64 = 1e-14;
    /// Ratio of successive shifts.
    const HEAVIER: f64 = 100.0;

    const fn tangent(self) -> Tangent {
        match self {
            Self::EXACT => Tangent::Exact,
            Self::DEFINITE => Tangent::Definite,
            _ => Tangent::Absolute,
        }
    }

    fn shift(self) -> f64 {
        let more = f64::from(self.0 - Self::ABSOLUTE.0);
        if self.shifts() { Self::SHIFT * libm::pow(Self::HEAVIER, more - 1.0) } else { 0.0 }
    }

    fn shifts(self) -> bool {
        self > Self::ABSOLUTE
    }

    /// Least regularisation of the next step, after this fraction of the step was taken.
    fn after(self, share: f64) -> Self {
        match share {
            1.0 if self.shifts() => Self(self.0 - 1),
            1.0 => Self::EXACT,
            0.0 => Self(self.0.max(Self::DEFINITE.0) + 1),
            0.5.. if !self.shifts() => Self::EXACT,
            _ => Self(self.0.max(Self::ABSOLUTE.0)),
        }
    }
}

/// `sum g²/weight`.
fn weighted(g: &[f64], inverse_weight: &[f64]) -> f64 {
    g.iter().zip(inverse_weight).map(|(g, w)| g * g * w).sum()
}

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
