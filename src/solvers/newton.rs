//! Newton's method with line search.

use super::{
    BlockMatrix, Factor, NewtonCounts, Tangent,
    conjugate::{Iterative, SolveOutcome, SolveTolerance, greatest},
};

/// Equations `g(z) = 0` whose matrix of derivatives is symmetric, or taken to be.
pub trait Equations {
    /// Writes g(z); whatever is fixed has none.
    fn residual(&mut self, z: &[f64], g: &mut [f64]);

    /// Adds dg/dz, or the part of it that is asked for, to a cleared matrix.
    fn derivative(&mut self, z: &[f64], tangent: Tangent, matrix: &mut BlockMatrix);

    /// Names the couples of vertices that the derivative has, in the order in which it adds them.
    fn sparsity_pattern(&self, add: &mut dyn FnMut(u32, u32));

    /// How many times a step from z may be gone, at most.
    fn longest_step(&mut self, _z: &[f64], _step: &[f64]) -> f64 {
        f64::INFINITY
    }

    /// 1/weight of each number, zero where z must stay: residuals are measured by `sum g²/weight`.
    fn inverse_weight(&self) -> &[f64];

    /// Changes z to another start, which is taken if its residual is smaller, or the way from it to z is longer than
    /// [`Self::longest_step`] allows. What is fixed must stay.
    fn other_start(&self, z: &mut [f64]);

    /// How far the vector of any vertex may be from the solution.
    fn tolerance(&self, z: &[f64]) -> f64;

    /// How far the solution itself is from what it stands for, as far as that is known. Large systems need not be solved to more
    /// than a small share of it.
    fn error(&self, _z: &[f64]) -> f64 {
        0.0
    }
}

/// How linear systems are solved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LinearSolver {
    /// The cheaper way for the size and the pattern of the matrix.
    #[default]
    Chosen,
    /// By factorising the matrix.
    Direct,
    /// By iterations where they get there.
    Iterative,
}

/// Newton's method with a line search, and everything it keeps between solves.
///
/// Where the matrix is not positive definite the eigenvalues of its elements are changed (see [`Tangent`]), and for round-off
/// its diagonal is made heavier, so that every Newton step leads downhill. No step goes farther than
/// [`Equations::longest_step`] allows, and it is halved while g is not a number at its end, or points back along the step by
/// more than nine tenths of what it pointed forth at the start: along a valley that means having climbed the other side. For
/// equations that are the gradient of a potential this bounds it without ever computing it, and it also serves where damping
/// leaves none.
///
/// It stops when the steps, shrinking as they did last, cannot add up to more than the tolerance any more
/// (Hairer and Wanner, *Solving Ordinary Differential Equations II*, section IV.8).
///
/// Large systems are solved by iterations ([`LinearSolver`]), each step as far as is of use so far from the solution (Eisenstat and Walker,
/// *Choosing the forcing terms in an inexact Newton method*, SIAM Journal on Scientific Computing 17, 1996, choice 2), and all of
/// it no further than a thousandth of what the equations are off by themselves.
#[derive(Default)]
pub struct Newton {
    system: Option<System>,
    linear_solver: LinearSolver,
    /// The norm of g at the last step, and the share of its error that step was allowed to leave, while there was one.
    forced: Option<(f64, f64)>,
    /// The share of its error that the step at hand has left.
    left: f64,
    /// Whether the couples have to be listed again.
    is_stale: bool,
    g: Vec<f64>,
    trial: Vec<f64>,
    trial_g: Vec<f64>,
    step: Vec<f64>,
    sizes: Vec<f64>,
}

impl Newton {
    /// Most iterations of one solve.
    pub const ITERATIONS: usize = 200;
    /// Most halvings of one step: below 1e-9 of it nothing is gained.
    const CUTS: u32 = 30;
    /// Share of the longest step that is taken at most, and the share of a step below which it does not count.
    const TO_BOUNDARY: f64 = 0.9;
    const STUCK: f64 = 1e-6;
    /// Share of the slope at the start up to which a step may point back.
    const BACK: f64 = 0.9;
    /// Share of the error of the equations themselves to which large systems are solved.
    const SHARE: f64 = 1e-3;
    /// Share of its error that a step by iterations may leave, at most, and at least where it is the only one. Eisenstat and
    /// Walker's factor.
    const FORCING: f64 = 1e-2;
    const ONLY: f64 = 1e-6;
    const GAMMA: f64 = 0.9;
    /// Share of the tolerance that is enough for a linear system.
    const INNER: f64 = 0.1;

    /// Solves linear systems in this way.
    pub fn new(linear_solver: LinearSolver) -> Self {
        Self { linear_solver, ..Self::default() }
    }

    /// Asks anew which vertices are coupled before the next step. Where they are the same, what was worked out for them serves on.
    pub fn forget(&mut self) {
        self.is_stale = true;
    }

    /// Largest change of any vertex's z in each iteration of the last solve.
    pub fn sizes(&self) -> &[f64] {
        &self.sizes
    }

    /// Solves g(z) = 0 from z, or from the other start. What is not a number at both leaves z not a number.
    pub fn solve(&mut self, equations: &mut dyn Equations, z: &mut [f64]) -> NewtonCounts {
        let mut counts = NewtonCounts::NONE;
        self.prepare(equations, z.len());
        self.start(equations, z);
        let mut last = f64::INFINITY;
        let mut least = Regularisation::EXACT;
        for _ in 0..Self::ITERATIONS {
            if self.g.iter().all(|g| *g == 0.0) {
                return counts;
            }
            let solve_tolerance = self.solve_tolerance(equations, z);
            let Some(regularisation) = self.find_step(equations, z, least, solve_tolerance, &mut counts) else { break };
            counts.iterations += 1;
            let size = greatest(&self.step);
            let tolerance = if self.left > 0.0 && regularisation == Regularisation::EXACT {
                Self::loose(equations, z)
            } else {
                equations.tolerance(z)
            };
            self.sizes.push(size);
            // A step made short by a shift says nothing about the way left.
            if size <= tolerance && !regularisation.shifts() {
                z.iter_mut().zip(&self.step).for_each(|(z, step)| *z += step);
                return counts;
            }
            let share = self.search(equations, z, &mut counts);
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

    /// One linear solve: z such that `derivative(at) z = -g`. Where nothing comes of it z is not a number.
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
            self.system = analyse(self.system.take(), equations, count / 2, self.linear_solver);
        }
        for buffer in [&mut self.g, &mut self.trial, &mut self.trial_g, &mut self.step] {
            buffer.resize(count, 0.0);
        }
        self.sizes.clear();
        self.sizes.reserve(Self::ITERATIONS);
        self.forced = None;
        if let Some(iterative) = self.system.as_mut().and_then(|system| system.iterative.as_mut()) {
            iterative.begin();
        }
    }

    /// How far any vertex may be from the solution where iterations find it with the true derivative. What is less smooth might
    /// stop too early at that.
    fn loose(equations: &dyn Equations, z: &[f64]) -> f64 {
        equations.tolerance(z).max(Self::SHARE * equations.error(z))
    }

    /// How exact the next step has to be.
    fn solve_tolerance(&mut self, equations: &dyn Equations, z: &[f64]) -> SolveTolerance {
        let norm = weighted(&self.g, equations.inverse_weight()).sqrt();
        let share = self.forced.map_or(Self::FORCING, |(last, share)| {
            let fast = Self::GAMMA * (norm / last) * (norm / last);
            let slow = Self::GAMMA * share * share;
            // Not all of a sudden more exact than the last one promises.
            let forced = if slow > 0.1 { fast.max(slow) } else { fast };
            forced.min(Self::FORCING)
        });
        self.forced = Some((norm, share));
        SolveTolerance { share, error: Self::INNER * Self::loose(equations, z) }
    }

    /// Chooses between the two starts.
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

    /// Writes the Newton step, found with at least so much caution; returns with how much, or `None` if there is no step.
    fn find_step(
        &mut self,
        equations: &mut dyn Equations,
        z: &[f64],
        least: Regularisation,
        solve_tolerance: SolveTolerance,
        counts: &mut NewtonCounts,
    ) -> Option<Regularisation> {
        let System { matrix, factor, iterative } = self.system.as_mut()?;
        if !z.iter().all(|z| z.is_finite()) {
            return None;
        }
        let mut filled = None;
        for regularisation in (least.0..=Regularisation::MOST).map(Regularisation) {
            let tangent = regularisation.tangent();
            if filled.replace(tangent) != Some(tangent) {
                matrix.clear();
                equations.derivative(z, tangent, matrix);
            }
            let weight = equations.inverse_weight();
            if let Some(iterative) = iterative.as_mut().filter(|_| !regularisation.shifts()) {
                let error = Self::INNER * equations.tolerance(z);
                let solve_tolerance = if regularisation == Regularisation::EXACT {
                    solve_tolerance
                } else {
                    SolveTolerance { error, ..solve_tolerance }
                };
                match iterative.solve((matrix, tangent, weight), (&self.g, &mut self.step), solve_tolerance, counts) {
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
            if factor.factorise(matrix, weight, regularisation.shift() * heaviest(matrix, weight)) {
                self.step.iter_mut().zip(&self.g).for_each(|(step, g)| *step = -g);
                factor.solve(&mut self.step);
                return self.step.iter().all(|step| step.is_finite()).then_some(regularisation);
            }
            counts.indefinite += 1;
        }
        None
    }

    /// Takes as much of the step as is good; returns how much of it that was, which may be nothing.
    fn search(&mut self, equations: &mut dyn Equations, z: &mut [f64], counts: &mut NewtonCounts) -> f64 {
        let along = |g: &[f64], step: &[f64]| g.iter().zip(step).map(|(g, step)| g * step).sum::<f64>();
        let limit = -Self::BACK * along(&self.g, &self.step);
        let limit_to_boundary = Self::TO_BOUNDARY * equations.longest_step(z, &self.step);
        // Next to a barrier that still leads on the solution lies beyond it: to stay would be to stand still for ever.
        let mut share = if limit_to_boundary < Self::STUCK { 1.0 } else { limit_to_boundary.min(1.0) };
        for _ in 0..Self::CUTS {
            for ((trial, z), step) in self.trial.iter_mut().zip(&*z).zip(&self.step) {
                *trial = z + share * step;
            }
            equations.residual(&self.trial, &mut self.trial_g);
            let slope = along(&self.trial_g, &self.step);
            // Nothing that is not a number is below the limit.
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

/// How a step is found, from bold to careful. Each next way is taken where the one before finds no step, or one that leads
/// too far.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
struct Regularisation(i32);

impl Regularisation {
    /// With the true derivative.
    const EXACT: Self = Self(0);
    /// With its definite part, then with the absolute values of its eigenvalues: where the first leads far away along
    /// directions that have no stiffness, the second does not.
    const DEFINITE: Self = Self(1);
    const ABSOLUTE: Self = Self(2);
    /// Beyond, with an ever heavier diagonal, for round-off: in the end steps are short and straight down the slope.
    const MOST: i32 = 12;
    /// The lightest shift, as a share of the greatest entry of the diagonal over its weight: round-off of that entry.
    const SHIFT: f64 = 1e-14;
    /// Each next one is so many times the last.
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

    /// The least caution of the next step, after this one led as far as `share` of it.
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

/// The matrix, its factor, and iterations in its place where they are worth while.
struct System {
    matrix: BlockMatrix,
    factor: Factor,
    iterative: Option<Iterative>,
}

/// What the couples of the equations need: what there was, if it was for the same.
fn analyse(
    before: Option<System>,
    equations: &dyn Equations,
    vertices: usize,
    linear_solver: LinearSolver,
) -> Option<System> {
    let mut pattern = Vec::new();
    equations.sparsity_pattern(&mut |a, b| pattern.push([a, b]));
    if let Some(before) = before.filter(|system| system.matrix.is_for(vertices, &pattern)) {
        return Some(before);
    }
    let matrix = BlockMatrix::new(vertices, &pattern);
    let factor = Factor::new(&matrix)?;
    let iterative = match linear_solver {
        LinearSolver::Chosen => Iterative::by_size(&matrix, &factor),
        LinearSolver::Direct => None,
        LinearSolver::Iterative => Iterative::new(&matrix, &factor),
    };
    Some(System { matrix, factor, iterative })
}

/// The greatest entry of the diagonal over its weight.
fn heaviest(matrix: &BlockMatrix, inverse_weight: &[f64]) -> f64 {
    let diagonals = matrix.diagonals().iter().flat_map(|block| [block.m11, block.m22]);
    diagonals.zip(inverse_weight).fold(0.0, |greatest, (entry, inverse)| greatest.max(entry * inverse))
}

/// `sum g²/weight`.
fn weighted(g: &[f64], inverse_weight: &[f64]) -> f64 {
    g.iter().zip(inverse_weight).map(|(g, w)| g * g * w).sum()
}
