//! Stability limit: the highest natural frequency, by Lanczos iteration on the stiffness.
//!
//! ```
//! use gingerbread::{files, levels, meshes::NoFiles, scene::Scene, stability};
//!
//! let level = files::parse(levels::built_in("jelly_disk").ok_or("there is no such level")?, "jelly_disk.ron")?;
//! let scene = Scene::build(&level, level.mode, &NoFiles, None)?;
//! let state = scene.first_state(level.state.as_ref())?;
//! let limit = stability::critical_step(&scene, &state, None).ok_or("it has stiffness")?;
//! assert!(scene.step < limit, "the level runs in stable steps");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::{
    effects::{Effect, Grab, Motion},
    elements::{CoupledMass, MassSolver, reserve_scratch},
    random::irregular,
    scene::Scene,
    state::State,
};
use std::sync::Arc;

/// Longest stable step of symplectic Euler near a state under a pull \[s\], or `None` if there is no stiffness or it is NaN. The
/// same value holds for both Verlet schemes without damping.
pub fn critical_step(scene: &Scene, state: &State, grab: Option<Grab>) -> Option<f64> {
    let mut probe = StabilityProbe::default();
    let square = probe.converged_eigenvalue(scene, scene.motion(state, grab))?;
    probe.longest_step(scene, scene.motion(state, grab), square)
}

/// Longest stable step of symplectic Euler at rest \[s\], as if no contact were damped: what overlaps at rest would damp it without bound.
pub fn critical_step_at_rest(scene: &Scene) -> Option<f64> {
    let rest = State { x: scene.rest.clone(), v: vec![0.0; scene.rest.len()], ..State::default() };
    let mut probe = StabilityProbe { ignores_contact_damping: true, ..StabilityProbe::default() };
    let square = probe.converged_eigenvalue(scene, scene.motion(&rest, None))?;
    probe.longest_step(scene, scene.motion(&rest, None), square)
}

/// The largest eigenvalue of M⁻¹ K [1/s²], K the stiffness of all effects at the state under a pull; converged.
pub fn largest_eigenvalue(scene: &Scene, state: &State, grab: Option<Grab>) -> Option<f64> {
    StabilityProbe::default().converged_eigenvalue(scene, scene.motion(state, grab))
}

/// Lanczos iterations between two restarts of the converged computation.
const ROUNDS: usize = 16;
/// Maximum number of restarts; a few are enough for meshes of 100,000 triangles.
const RESTARTS: usize = 20;
/// Relative change of the eigenvalue between two restarts at which it is converged.
const CONVERGED: f64 = 1e-4;

/// A running estimate of the longest stable step, refined by every call.
///
/// It is a restarted Lanczos iteration for the largest eigenvalue w² of M⁻¹ K, K the stiffness of all effects (Golub
/// and Van Loan, *Matrix Computations*, section 10.1), on the symmetric `M^(-1/2) K M^(-1/2)`; M are the lumped masses. Where the mass matrix
/// has more, `C = M^(-1/2) M_all M^(-1/2)`, the iteration is on the inverse of C times that, which is symmetric in the inner product with C. The best vector is kept;
/// a state that changes little between two calls hardly changes it, so that a few iterations a frame follow a moving
/// scene. From an irregular start, 16 iterations leave an error of a few per cent. The estimate of w is from below.
#[derive(Clone, Debug, Default)]
pub struct StabilityProbe {
    vector: Vec<f64>,
    basis: Vec<f64>,
    /// C times each vector of the basis; empty if all masses are lumped.
    weighted: Vec<f64>,
    displacement: Vec<f64>,
    product: Vec<f64>,
    scratch: Vec<f64>,
    mass_solver: MassSolver,
    ignores_contact_damping: bool,
}

impl StabilityProbe {
    /// The longest stable step at a state under a pull \[s\] after a number of further iterations, each of one product with the
    /// stiffness; `None` if there is no stiffness or it is NaN.
    pub fn refine(&mut self, scene: &Scene, state: &State, grab: Option<Grab>, rounds: usize) -> Option<f64> {
        let motion = scene.motion(state, grab);
        let square = self.largest_eigenvalue(scene, motion, rounds.max(2))?;
        self.longest_step(scene, motion, square)
    }

    fn converged_eigenvalue(&mut self, scene: &Scene, motion: Motion<'_>) -> Option<f64> {
        let mut last = 0.0;
        for _ in 0..RESTARTS {
            let next = self.largest_eigenvalue(scene, motion, ROUNDS)?;
            if next - last <= CONVERGED * next {
                return Some(next);
            }
            last = next;
        }
        Some(last)
    }

    fn largest_eigenvalue(&mut self, scene: &Scene, motion: Motion<'_>, rounds: usize) -> Option<f64> {
        let count = scene.inverse_mass.len();
        if count == 0 {
            return None;
        }
        if self.vector.len() != count || !norm(&self.vector).is_normal() {
            self.vector = (0..count as u64).map(irregular).collect();
        }
        for (value, inverse_mass) in self.vector.iter_mut().zip(&scene.inverse_mass) {
            *value = if *inverse_mass == 0.0 { 0.0 } else { *value };
        }
        for buffer in [&mut self.displacement, &mut self.product] {
            buffer.resize(count, 0.0);
        }
        reserve_scratch(&mut self.scratch, scene.scratch());
        self.basis.clear();
        self.weighted.clear();
        let vector = std::mem::take(&mut self.vector);
        self.append(scene, &vector);
        self.vector = vector;
        let mut projected = SmallMatrix::new(rounds);
        let mut used = 0;
        for round in 0..rounds {
            self.multiply(scene, motion, round * count);
            used = round + 1;
            // Full reorthogonalisation, twice: round-off would reintroduce the largest eigenvalue.
            for pass in 0..2 {
                let weighted = if self.weighted.is_empty() { &self.basis } else { &self.weighted };
                for (number, before) in self.basis.chunks_exact(count).enumerate() {
                    let share = dot(&self.product, &weighted[number * count..(number + 1) * count]);
                    self.product.iter_mut().zip(before).for_each(|(product, before)| *product -= share * before);
                    if pass == 0 && number + 1 >= round {
                        *projected.at(number, round) = share;
                        *projected.at(round, number) = share;
                    }
                }
            }
            let product = std::mem::take(&mut self.product);
            let left = if round + 1 < rounds { self.append(scene, &product) } else { norm(&product) };
            self.product = product;
            if !left.is_finite() {
                self.vector.clear();
                return None;
            }
            if left <= 1e-10 * projected.at(0, 0).abs() {
                break;
            }
        }
        let (eigenvalue, shares) = projected.largest(used);
        self.vector.fill(0.0);
        for (share, before) in shares.iter().zip(self.basis.chunks_exact(count)) {
            self.vector.iter_mut().zip(before).for_each(|(value, before)| *value += share * before);
        }
        (eigenvalue.is_finite() && eigenvalue > 0.0).then_some(eigenvalue)
    }

    /// Appends a vector to the basis after division by its norm, with C as the inner product. Returns the norm.
    fn append(&mut self, scene: &Scene, vector: &[f64]) -> f64 {
        if scene.coupled_mass.is_empty() {
            let length = norm(vector);
            self.basis.extend(vector.iter().map(|value| value / length));
            return length;
        }
        let begin = self.weighted.len();
        self.weighted.resize(begin + vector.len(), 0.0);
        let weighted = &mut self.weighted[begin..];
        for ((displacement, value), inverse_mass) in self.displacement.iter_mut().zip(vector).zip(&scene.inverse_mass) {
            *displacement = value * inverse_mass.sqrt();
        }
        scene.coupled_mass.add_product(scene.dimension, &self.displacement, weighted);
        for ((weighted, value), inverse_mass) in weighted.iter_mut().zip(vector).zip(&scene.inverse_mass) {
            *weighted = *weighted * inverse_mass.sqrt() + value;
        }
        let length = dot(vector, weighted).sqrt();
        for value in weighted.iter_mut() {
            *value /= length;
        }
        self.basis.extend(vector.iter().map(|value| value / length));
        length
    }

    /// `C⁻¹ M^(-1/2) K M^(-1/2)` times the basis vector that begins here.
    fn multiply(&mut self, scene: &Scene, motion: Motion<'_>, begin: usize) {
        let root = |inverse_mass: &f64| inverse_mass.sqrt();
        let vector = &self.basis[begin..];
        for ((displacement, value), inverse_mass) in self.displacement.iter_mut().zip(vector).zip(&scene.inverse_mass) {
            *displacement = value * root(inverse_mass);
        }
        self.product.fill(0.0);
        // Contact counts with its greatest stiffness, whether it acts now or not.
        for effect in scene.effects.iter().filter(|effect| effect.contact().is_none()) {
            let scratch = &mut self.scratch[..effect.scratch()];
            effect.stiffness_times(motion, &self.displacement, scratch, &mut self.product);
        }
        if !scene.coupled_mass.is_empty() {
            let masses = [scene.mass.as_slice(), &scene.inverse_mass];
            self.mass_solver.fit(scene.dimension, &scene.coupled_mass, masses);
            self.mass_solver.accelerate(masses, &mut self.product);
        }
        for (product, inverse_mass) in self.product.iter_mut().zip(&scene.inverse_mass) {
            *product *= root(inverse_mass);
        }
    }
}

impl StabilityProbe {
    /// The longest stable step for the vibration that was found, of squared angular frequency w², and the scene's damping rate c = alpha + beta w²
    /// for it, taken at the old velocity: the characteristic polynomial `z² - (2 - h c - h² w²) z + (1 - h c)` has both roots
    /// inside the unit circle while `h² w² + 2 h c < 4`. Without damping that is h < 2/w.
    fn longest_step(&mut self, scene: &Scene, motion: Motion<'_>, square: f64) -> Option<f64> {
        let damps = |effect: &&Arc<dyn Effect>| {
            !(effect.damps_by_shape() || self.ignores_contact_damping && effect.contact().is_some())
        };
        let dampings = scene.effects.iter().filter(damps).map(|effect| effect.damping(motion));
        let [alpha, beta] = dampings.fold([0.0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
        // Forces on single vertices, whose rates are by lumped masses, act on less with the whole matrix.
        let lighter = if scene.coupled_mass.is_empty() { 1.0 } else { CoupledMass::LIGHTEST };
        let rate = lighter * alpha + beta * square + self.rate_of_shape(scene, motion);
        let contacts = scene.effects.iter().filter_map(|effect| effect.contact());
        let square = square + lighter * contacts.map(|contact| contact.square_frequency(motion)).fold(0.0, f64::max);
        let step = 4.0 / (rate + (rate * rate + 4.0 * square).sqrt());
        // They may damp another motion faster, as air does across a flat cloth: that alone is stable for h c < 2.
        let others =
            scene.effects.iter().filter(|effect| effect.damps_by_shape()).map(|effect| effect.damping(motion)[0]);
        let step = step.min(2.0 / (lighter * others.fold(0.0, |sum, rate| sum + rate)));
        step.is_finite().then_some(step)
    }

    /// Rate at which effects that damp by shape damp the vibration that was found [1/s]: with the velocity v of its shape,
    /// `(f(0) - f(v)) · v/(v' M v)`.
    fn rate_of_shape(&mut self, scene: &Scene, motion: Motion<'_>) -> f64 {
        let (mut rate, still) = (0.0, vec![0.0; motion.v.len()]);
        for ((v, value), inverse_mass) in self.displacement.iter_mut().zip(&self.vector).zip(&scene.inverse_mass) {
            *v = value * inverse_mass.sqrt();
        }
        for effect in scene.effects.iter().filter(|effect| effect.damps_by_shape()) {
            for (sign, v) in [(1.0, &still), (-1.0, &self.displacement)] {
                self.product.fill(0.0);
                effect.force(Motion { v, ..motion }, &mut self.scratch[..effect.scratch()], &mut self.product);
                rate += sign * dot(&self.product, &self.displacement);
            }
        }
        rate / (dot(&self.vector, &self.vector) + 2.0 * scene.coupled_energy(&self.displacement))
    }
}

/// A small symmetric matrix.
struct SmallMatrix {
    size: usize,
    entries: Vec<f64>,
}

impl SmallMatrix {
    fn new(size: usize) -> Self {
        Self { size, entries: vec![0.0; size * size] }
    }

    fn at(&mut self, row: usize, column: usize) -> &mut f64 {
        &mut self.entries[row * self.size + column]
    }

    /// The largest eigenvalue of the leading submatrix with this number of rows, and its vector, by Jacobi rotations
    /// (Golub and Van Loan, section 8.5).
    fn largest(mut self, count: usize) -> (f64, Vec<f64>) {
        let mut vectors = Self::new(self.size);
        (0..count).for_each(|number| *vectors.at(number, number) = 1.0);
        for _ in 0..12 {
            for (p, q) in (0..count).flat_map(|p| (p + 1..count).map(move |q| (p, q))) {
                let (off, difference) = (*self.at(p, q), *self.at(q, q) - *self.at(p, p));
                if off == 0.0 {
                    continue;
                }
                let tau = difference / (2.0 * off);
                let t = tau.signum() / (tau.abs() + (1.0 + tau * tau).sqrt());
                let c = 1.0 / (1.0 + t * t).sqrt();
                for k in 0..count {
                    rotate(&mut self, [k, p], [k, q], [c, t * c]);
                    rotate(&mut vectors, [k, p], [k, q], [c, t * c]);
                }
                for k in 0..count {
                    rotate(&mut self, [p, k], [q, k], [c, t * c]);
                }
            }
        }
        let best =
            (0..count).max_by(|a, b| self.entries[a * self.size + a].total_cmp(&self.entries[b * self.size + b]));
        let best = best.unwrap_or_default();
        (*self.at(best, best), (0..count).map(|row| *vectors.at(row, best)).collect())
    }
}

fn rotate(of: &mut SmallMatrix, one: [usize; 2], other: [usize; 2], [c, s]: [f64; 2]) {
    let (a, b) = (*of.at(one[0], one[1]), *of.at(other[0], other[1]));
    *of.at(one[0], one[1]) = c * a - s * b;
    *of.at(other[0], other[1]) = s * a + c * b;
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn norm(vector: &[f64]) -> f64 {
    dot(vector, vector).sqrt()
}
