//! Preconditioned conjugate gradients.

use super::{BlockMatrix, Factor, NewtonCounts, Tangent, dense::dot, two_level::TwoLevel};
use pulp::Arch;

/// Tolerance of a linear solve.
#[derive(Clone, Copy)]
pub struct SolveTolerance {
    /// Fraction of the error that may remain, in the energy norm.
    pub share: f64,
    /// Error of any vertex that is accepted in any case.
    pub error: f64,
}

/// Result of a linear solve.
pub enum SolveOutcome {
    /// Solved; the fraction of the error that remains.
    Solved(f64),
    /// The matrix is not positive definite.
    Indefinite,
    /// Slower than a factorisation.
    Slow,
}

/// Conjugate gradients for large systems (Hestenes and Stiefel, *Methods of conjugate gradients for solving linear
/// systems*, Journal of Research of the National Bureau of Standards 49, 1952), preconditioned by [`TwoLevel`].
///
/// For a sheet of 100,000 triangles and a step of 1/60 s, an iteration takes a twentieth of the time of a factorisation
/// and solve; four iterations leave a hundredth of the error and nineteen 1e-8 of it, nearly independent of size. The
/// factor of an earlier matrix is a better preconditioner, with two and nine iterations, but a solve with it takes a
/// quarter of that time, because all its entries are read from memory; and a step must not depend on what was solved
/// before it. Near incompressibility neither works, nor does any other method that treats single vertices: there the
/// matrix is factorised.
///
/// No step allocates: all buffers are made with the sparsity pattern.
#[derive(Clone, Debug)]
pub struct Iterative<const D: usize> {
    levels: TwoLevel<D>,
    /// Time of an iteration and of a rebuild of the coarse matrix, as fractions of a factorisation and solve of the
    /// whole matrix.
    iteration: f64,
    refreshment: f64,
    /// Derivative for which the coarse matrix was built, and the number of iterations it took then for a factor 1/e of
    /// the error.
    made: Option<(Tangent, Option<f64>)>,
    /// Whether iterations were too slow.
    is_off: bool,
    r: Vec<f64>,
    z: Vec<f64>,
    direction: Vec<f64>,
    product: Vec<f64>,
}

impl<const D: usize> Iterative<D> {
    /// Makes a solver for a matrix, if it is faster than factorisation by the estimated times.
    pub fn by_size(matrix: &BlockMatrix<D>, factor: &Factor<D>) -> Option<Self> {
        let [iteration, refreshment] = times(matrix, None);
        let worth = factor.time() > GAIN * (refreshment + USUAL * iteration);
        if worth { Self::new(matrix, factor) } else { None }
    }

    /// Makes a solver for any matrix. `None` if it does not fit in memory.
    pub fn new(matrix: &BlockMatrix<D>, factor: &Factor<D>) -> Option<Self> {
        let levels = TwoLevel::new(matrix)?;
        let [iteration, refreshment] = times(matrix, Some(&levels)).map(|time| time / factor.time());
        let [r, z, direction, product] = [(); 4].map(|()| vec![0.0; D * matrix.vertices()]);
        Some(Self { levels, iteration, refreshment, made: None, is_off: false, r, z, direction, product })
    }

    /// Resets the coarse matrix: a step must not depend on those before.
    pub fn begin(&mut self) {
        (self.made, self.is_off) = (None, false);
    }

    /// Solves `A x = -g`. Rows and columns of numbers with 1/weight zero become those of the identity.
    pub fn solve(
        &mut self,
        (matrix, tangent, inverse_weight): (&mut BlockMatrix<D>, Tangent, &[f64]),
        (g, x): (&[f64], &mut [f64]),
        tolerance: SolveTolerance,
        counts: &mut NewtonCounts,
    ) -> SolveOutcome {
        if self.is_off {
            return SolveOutcome::Slow;
        }
        matrix.fix(inverse_weight);
        if !self.levels.take_diagonal(matrix) {
            return SolveOutcome::Indefinite;
        }
        let reused = self.made.filter(|(made, _)| *made == tangent);
        if reused.is_none() && !self.levels.refresh(matrix, inverse_weight) {
            return self.abandon(counts);
        }
        let before = counts.linear_iterations;
        let outcome = self.iterate(matrix, (g, x), tolerance, counts);
        counts.reused += u64::from(reused.is_some());
        self.made = Some((tangent, None));
        match outcome {
            SolveOutcome::Solved(share) if share > 0.0 => {
                let taken = (counts.linear_iterations - before) as f64;
                let rate = taken / -libm::log(share);
                let first = reused.and_then(|(_, first)| first).unwrap_or(rate);
                // A rebuild pays if it costs less than the additional iterations since the first solve.
                let is_old = (1.0 - first / rate) * taken * self.iteration > self.refreshment;
                self.made = if is_old { None } else { Some((tangent, Some(first))) };
            }
            SolveOutcome::Slow => return self.abandon(counts),
            _ => {}
        }
        outcome
    }

    fn abandon(&mut self, counts: &mut NewtonCounts) -> SolveOutcome {
        self.is_off = true;
        counts.abandoned += 1;
        SolveOutcome::Slow
    }

    fn iterate(
        &mut self,
        matrix: &BlockMatrix<D>,
        (g, x): (&[f64], &mut [f64]),
        tolerance: SolveTolerance,
        counts: &mut NewtonCounts,
    ) -> SolveOutcome {
        let Self { levels, r, z, direction, product, .. } = self;
        r.iter_mut().zip(g).for_each(|(r, g)| *r = -g);
        x.fill(0.0);
        levels.solve(matrix, r, z);
        direction.copy_from_slice(z);
        let first = dot(r, z);
        let mut size = first;
        let most = (1.0 / self.iteration).max(LEAST) as usize;
        let mut shares = [1.0; WINDOW];
        for iteration in 0..=most {
            if size == 0.0 {
                return SolveOutcome::Solved(0.0);
            }
            if !(size > 0.0 && size.is_finite()) {
                return SolveOutcome::Indefinite;
            }
            let share = (size / first).sqrt();
            let enough = tolerance.share.max(tolerance.error / greatest(x, D));
            if share <= enough && iteration > 0 {
                return SolveOutcome::Solved(share);
            }
            // Extrapolates the convergence rate of the last few iterations.
            let earlier = std::mem::replace(&mut shares[iteration % WINDOW], share);
            if iteration >= WINDOW {
                let rate = libm::log(earlier / share) / WINDOW as f64;
                let missing = libm::log(share / enough) / rate;
                if rate <= 0.0 || iteration as f64 + missing > most as f64 {
                    return SolveOutcome::Slow;
                }
            }
            product.fill(0.0);
            matrix.add_product(direction, product);
            counts.linear_iterations += 1;
            let curvature = dot(direction, product);
            if !(curvature > 0.0 && curvature.is_finite()) {
                return SolveOutcome::Indefinite;
            }
            let way = size / curvature;
            Arch::new().dispatch(|| {
                for (((x, direction), r), product) in x.iter_mut().zip(&*direction).zip(r.iter_mut()).zip(&*product) {
                    *x += way * direction;
                    *r -= way * product;
                }
            });
            levels.solve(matrix, r, z);
            let next = dot(r, z);
            let back = next / size;
            Arch::new().dispatch(|| direction.iter_mut().zip(&*z).for_each(|(d, z)| *d = z + back * *d));
            size = next;
        }
        SolveOutcome::Slow
    }
}

/// Iterations over which the convergence rate is measured.
const WINDOW: usize = 4;

/// Least number of iterations before the matrix is factorised instead; otherwise as many as cost a factorisation.
const LEAST: f64 = 16.0;

/// Least speed-up for which iterations are chosen, and the usual number of iterations of a solve.
const GAIN: f64 = 1.3;
const USUAL: f64 = 5.0;

/// Estimated time of an iteration and of a rebuild of the coarse matrix \[ns\], in the unit of [`Factor::time`]; without
/// levels, for the groups of a usual mesh.
fn times<const D: usize>(matrix: &BlockMatrix<D>, levels: Option<&TwoLevel<D>>) -> [f64; 2] {
    let entries = levels.map_or(2.2 * matrix.vertices() as f64, |levels| levels.entries() as f64);
    let blocks = matrix.pattern().len() as f64;
    [12.0 * blocks + 8.0 * entries, 10.0 * blocks + 18.0 * entries]
}

/// Greatest Euclidean norm of the vector of any vertex, of `size` numbers, which is invariant under rotation.
pub fn greatest(values: &[f64], size: usize) -> f64 {
    let squares = values.chunks(size).map(|vector| vector.iter().map(|value| value * value).sum());
    squares.fold(0.0, f64::max).sqrt()
}
