use super::{BlockMatrix, Factor};

/// Equations `g(z) = 0` whose matrix of derivatives is symmetric, or taken to be.
pub trait Equations {
    /// Writes g(z); whatever is fixed has none.
    fn residual(&mut self, z: &[f64], g: &mut [f64]);

    /// Adds dg/dz to a cleared matrix.
    fn derivative(&mut self, z: &[f64], matrix: &mut BlockMatrix);

    /// Names the couples of vertices that the derivative has, in the order in which it adds them.
    fn couples(&self, add: &mut dyn FnMut(u32, u32));

    /// 1/weight of each number, zero where z must stay: residuals are measured by `sum g²/weight`.
    fn inverse_weight(&self) -> &[f64];

    /// Changes z to another start, which is taken if its residual is smaller. What is fixed must stay.
    fn other_start(&self, z: &mut [f64]);

    /// How far the vector of any vertex may be from the solution.
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

    /// Adds what another solve took.
    pub fn add(&mut self, other: &Self) {
        self.iterations += other.iterations;
        self.cuts += other.cuts;
        self.factorisations += other.factorisations;
        self.shifts += other.shifts;
        self.unconverged += other.unconverged;
    }
}

/// Newton's method with a line search, and everything it keeps between solves.
///
/// Where the matrix is not positive definite its diagonal is made heavier, so that every Newton step leads downhill.
/// A step is halved while g is not a number at its end, or points back along the step by more than nine tenths of what
/// it pointed forth at the start: along a valley that means having climbed the other side. For equations that are the
/// gradient of a potential this bounds it without ever computing it, and it also serves where damping leaves none.
///
/// It stops when the steps, shrinking as they did last, cannot add up to more than the tolerance any more
/// (Hairer and Wanner, *Solving Ordinary Differential Equations II*, section IV.8).
#[derive(Default)]
pub struct Newton {
    system: Option<(BlockMatrix, Factor)>,
    g: Vec<f64>,
    trial: Vec<f64>,
    trial_g: Vec<f64>,
    step: Vec<f64>,
    sizes: Vec<f64>,
}

impl Newton {
    /// Most iterations of one solve.
    pub const ITERATIONS: usize = 50;
    /// Most halvings of one step: below 1e-9 of it nothing is gained.
    const CUTS: u32 = 30;
    /// Share of the slope at the start up to which a step may point back.
    const BACK: f64 = 0.9;
    /// First factor of the weights that is added to an indefinite matrix; each next one is ten times the last.
    const SHIFT: f64 = 1.0;
    /// Most factorisations for one step.
    const SHIFTS: u32 = 16;

    /// Forgets which vertices are coupled.
    pub fn forget(&mut self) {
        self.system = None;
    }

    /// Largest change of any vertex's z in each iteration of the last solve.
    pub fn sizes(&self) -> &[f64] {
        &self.sizes
    }

    /// Solves g(z) = 0 from z, or from the other start. What is not a number at both leaves z not a number.
    pub fn solve(&mut self, equations: &mut dyn Equations, z: &mut [f64]) -> NewtonCounts {
        let mut counts = NewtonCounts::NONE;
        self.resize(z.len());
        self.start(equations, z);
        let mut last = f64::INFINITY;
        for _ in 0..Self::ITERATIONS {
            if self.g.iter().all(|g| *g == 0.0) {
                return counts;
            }
            if !self.find_step(equations, z, &mut counts) {
                break;
            }
            counts.iterations += 1;
            let size = greatest(&self.step);
            let tolerance = equations.tolerance(z);
            self.sizes.push(size);
            if size <= tolerance {
                z.iter_mut().zip(&self.step).for_each(|(z, step)| *z += step);
                return counts;
            }
            let Some(whole) = self.search(equations, z, &mut counts) else { break };
            let ratio = size / last;
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
        self.resize(z.len());
        self.g.copy_from_slice(g);
        if self.find_step(equations, at, &mut counts) {
            z.copy_from_slice(&self.step);
        } else {
            z.fill(f64::NAN);
            counts.unconverged += 1;
        }
        counts
    }

    fn resize(&mut self, count: usize) {
        for buffer in [&mut self.g, &mut self.trial, &mut self.trial_g, &mut self.step] {
            buffer.resize(count, 0.0);
        }
        self.sizes.clear();
        self.sizes.reserve(Self::ITERATIONS);
    }

    /// Chooses between the two starts.
    fn start(&mut self, equations: &mut dyn Equations, z: &mut [f64]) {
        equations.residual(z, &mut self.g);
        self.trial.copy_from_slice(z);
        equations.other_start(&mut self.trial);
        equations.residual(&self.trial, &mut self.trial_g);
        let size = |g: &[f64]| g.iter().zip(equations.inverse_weight()).map(|(g, w)| g * g * w).sum::<f64>();
        let (one, other) = (size(&self.g), size(&self.trial_g));
        if other < one || !one.is_finite() {
            z.copy_from_slice(&self.trial);
            std::mem::swap(&mut self.g, &mut self.trial_g);
            if !other.is_finite() {
                z.fill(f64::NAN);
            }
        }
    }

    /// Writes the Newton step; returns whether there is one.
    fn find_step(&mut self, equations: &mut dyn Equations, z: &[f64], counts: &mut NewtonCounts) -> bool {
        if self.system.is_none() {
            self.system = analyse(equations, z.len() / 2);
        }
        let Some((matrix, factor)) = &mut self.system else { return false };
        if !z.iter().all(|z| z.is_finite()) {
            return false;
        }
        matrix.clear();
        equations.derivative(z, matrix);
        let mut shift = 0.0;
        for _ in 0..Self::SHIFTS {
            counts.factorisations += 1;
            if factor.factorise(matrix, equations.inverse_weight(), shift) {
                self.step.iter_mut().zip(&self.g).for_each(|(step, g)| *step = -g);
                factor.solve(&mut self.step);
                return self.step.iter().all(|step| step.is_finite());
            }
            counts.shifts += 1;
            shift = if shift == 0.0 { Self::SHIFT } else { 10.0 * shift };
        }
        false
    }

    /// Takes as much of the step as is good. Returns whether it was the whole, or `None` if nothing was.
    fn search(&mut self, equations: &mut dyn Equations, z: &mut [f64], counts: &mut NewtonCounts) -> Option<bool> {
        let along = |g: &[f64], step: &[f64]| g.iter().zip(step).map(|(g, step)| g * step).sum::<f64>();
        let limit = -Self::BACK * along(&self.g, &self.step);
        let mut share = 1.0;
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
                return Some(share == 1.0);
            }
            counts.cuts += 1;
            share *= 0.5;
        }
        None
    }
}

/// The matrix and its factor, for the couples of the equations.
fn analyse(equations: &dyn Equations, vertices: usize) -> Option<(BlockMatrix, Factor)> {
    let mut couples = Vec::new();
    equations.couples(&mut |a, b| couples.push([a, b]));
    let matrix = BlockMatrix::new(vertices, &couples);
    let factor = Factor::new(&matrix)?;
    Some((matrix, factor))
}

/// The greatest length of the vector of any vertex: no other than after a turn.
fn greatest(values: &[f64]) -> f64 {
    let squares = values.chunks(2).map(|vector| vector.iter().map(|value| value * value).sum());
    squares.fold(0.0, f64::max).sqrt()
}
