//! Conjugate gradients.

use super::{BlockMatrix, Factor, NewtonCounts, Tangent, dense::dot, two_level::TwoLevel};
use pulp::Arch;

/// How exact a solution has to be.
#[derive(Clone, Copy)]
pub struct SolveTolerance {
    /// The share of the error that may be left, measured as energy.
    pub share: f64,
    /// An error of any vertex that is small enough in any case.
    pub error: f64,
}

/// What came of solving.
pub enum SolveOutcome {
    /// A solution; so large a share of its error is left.
    Solved(f64),
    /// The matrix is not positive definite.
    Indefinite,
    /// Nothing in the time that a factorisation takes.
    Slow,
}

/// Conjugate gradients for large systems (Hestenes and Stiefel, *Methods of conjugate gradients for solving linear systems*,
/// Journal of Research of the National Bureau of Standards 49, 1952), steered by [`TwoLevel`].
///
/// Of a sheet of 100,000 triangles in a step of 1/60 s an iteration takes a twentieth of the time of factorising the matrix and
/// solving with the factor; four iterations leave a hundredth of the error and nineteen 1e-8 of it, nearly whatever the size. The
/// factor of an earlier matrix steers better, with two and nine iterations, but to solve with it takes a quarter of that time, for
/// all its entries pass through the processor; and a step must not depend on what was solved before it. Near incompressibility
/// neither serves, nor does anything else that looks at one vertex at a time: there the matrix is factorised.
///
/// No step allocates: all that is needed is settled with the couples.
#[derive(Clone, Debug)]
pub struct Iterative {
    levels: TwoLevel,
    /// What an iteration and making the groups' matrix anew take, as shares of factorising the whole matrix and solving with its
    /// factor.
    iteration: f64,
    refreshment: f64,
    /// For which derivative the groups' matrix was made, and how many iterations it took then to leave 1/e of the error.
    made: Option<(Tangent, Option<f64>)>,
    /// Whether it was too slow.
    is_off: bool,
    r: Vec<f64>,
    z: Vec<f64>,
    direction: Vec<f64>,
    product: Vec<f64>,
}

impl Iterative {
    /// For a matrix, if this is worth while; the factor tells what the other way costs.
    pub fn by_size(matrix: &BlockMatrix, factor: &Factor) -> Option<Self> {
        let [iteration, refreshment] = times(matrix, None);
        let worth = factor.time() > GAIN * (refreshment + USUAL * iteration);
        if worth { Self::new(matrix, factor) } else { None }
    }

    /// For any matrix. `None` if there is no memory for it.
    pub fn new(matrix: &BlockMatrix, factor: &Factor) -> Option<Self> {
        let levels = TwoLevel::new(matrix)?;
        let [iteration, refreshment] = times(matrix, Some(&levels)).map(|time| time / factor.time());
        let [r, z, direction, product] = [(); 4].map(|()| vec![0.0; 2 * matrix.vertices()]);
        Some(Self { levels, iteration, refreshment, made: None, is_off: false, r, z, direction, product })
    }

    /// Forgets what was made for other equations: a step must not depend on those before.
    pub fn begin(&mut self) {
        (self.made, self.is_off) = (None, false);
    }

    /// Solves `A x = -g`. Rows and columns of numbers whose 1/weight is zero become those of the identity.
    pub fn solve(
        &mut self,
        (matrix, tangent, inverse_weight): (&mut BlockMatrix, Tangent, &[f64]),
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
                // Worth making anew: that costs less than what it took longer than at first.
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
        matrix: &BlockMatrix,
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
            let enough = tolerance.share.max(tolerance.error / greatest(x));
            if share <= enough && iteration > 0 {
                return SolveOutcome::Solved(share);
            }
            // At the pace of the last few iterations.
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

/// Iterations over which the pace is measured.
const WINDOW: usize = 4;

/// As many iterations as cost as much as a factorisation are taken before the matrix is factorised after all, but not fewer.
const LEAST: f64 = 16.0;

/// How many times faster iterations must be to be chosen, and how many a solve usually takes.
const GAIN: f64 = 1.3;
const USUAL: f64 = 5.0;

/// About how long an iteration and making the groups' matrix anew take [ns], as [`Factor::time`] counts; without levels for the
/// groups of a usual mesh.
fn times(matrix: &BlockMatrix, levels: Option<&TwoLevel>) -> [f64; 2] {
    let entries = levels.map_or(2.2 * matrix.vertices() as f64, |levels| levels.entries() as f64);
    let blocks = matrix.pattern().len() as f64;
    [12.0 * blocks + 8.0 * entries, 10.0 * blocks + 18.0 * entries]
}

/// The greatest length of the vector of any vertex: no other than after a turn.
pub fn greatest(values: &[f64]) -> f64 {
    let squares = values.chunks(2).map(|vector| vector.iter().map(|value| value * value).sum());
    squares.fold(0.0, f64::max).sqrt()
}
