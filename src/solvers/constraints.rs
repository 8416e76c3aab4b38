//! Exact constraints `C(x) = 0` of a system `M a = f + Jᵀλ` at the level of accelerations, with J = dC/dx.
//!
//! ```
//! use gingerbread::solvers::ConstraintRows;
//!
//! // Two particles of 1 kg, whose distance along x stays: a pull at one of them moves both.
//! let mut rows = ConstraintRows::default();
//! rows.push([(0, 1.0), (1, -1.0)], 0.0, [0.0, 0.0]);
//! let mut force = [3.0, 0.0];
//! rows.add_reactions(&[1.0, 1.0], &mut force);
//! assert_eq!(force, [1.5, 1.5]);
//! ```

/// Constraints at one moment, as rows of J.
///
/// With W = M⁻¹ and a dot for derivatives by time, the accelerations of a system keep `C̈ + d Ċ + s C = 0` if the forces get the reactions `Jᵀλ` with
///
/// `(J W Jᵀ) λ = -(J W f + J̇v + d J v + s C)`
///
/// (D. Baraff, *Linear-time dynamics using Lagrange multipliers*, SIGGRAPH 1996; A. Witkin, *Physically Based Modeling: Constrained Dynamics*, SIGGRAPH
/// course notes 1997). The terms with d and s bring back what the discretisation lets drift (J. Baumgarte, *Stabilization of constraints and integrals of motion in
/// dynamical systems*, Computer Methods in Applied Mechanics and Engineering 1, 1972). Reactions do no work while the constraints hold.
#[derive(Clone, Debug, Default)]
pub struct ConstraintRows {
    /// Numbers of all rows and the entries of J there, row by row.
    entries: Vec<(usize, f64)>,
    /// Where each row ends.
    ends: Vec<usize>,
    /// `J̇v + d J v + s C` of each row, and d and s.
    biases: Vec<(f64, [f64; 2])>,
    /// J W Jᵀ or J H⁻¹ Jᵀ, row by row, then its factor.
    matrix: Vec<f64>,
    /// Right-hand side, then the multipliers.
    multipliers: Vec<f64>,
    /// H⁻¹ Jᵀ, one constraint after another.
    columns: Vec<f64>,
}

impl ConstraintRows {
    /// Removes all rows.
    pub fn clear(&mut self) {
        self.entries.clear();
        self.ends.clear();
        self.biases.clear();
    }

    /// Adds a constraint: the entries of its row of J, by the numbers that they belong to, `J̇v + d J v + s C`, and `[d, s]` \[1/s, 1/s²\].
    pub fn push(&mut self, entries: impl IntoIterator<Item = (usize, f64)>, bias: f64, recovery: [f64; 2]) {
        self.entries.extend(entries);
        self.ends.push(self.entries.len());
        self.biases.push((bias, recovery));
    }

    /// Number of constraints.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// Takes into account that a number moves with this acceleration [m/s²], whatever acts on it.
    pub fn accelerate(&mut self, number: usize, acceleration: f64) {
        let Self { entries, ends, biases, .. } = self;
        for (one, (bias, _)) in biases.iter_mut().enumerate() {
            let own = row(entries, ends, one).iter().filter(|(other, _)| *other == number);
            *bias += own.map(|(_, entry)| entry * acceleration).sum::<f64>();
        }
    }

    /// Adds the reactions to the forces \[N\], with 1/mass of each number [1/kg].
    pub fn add_reactions(&mut self, inverse_mass: &[f64], force: &mut [f64]) {
        self.find_multipliers(inverse_mass, force);
        for (one, multiplier) in self.multipliers.iter().enumerate() {
            for (number, entry) in row(&self.entries, &self.ends, one) {
                force[*number] += entry * multiplier;
            }
        }
    }

    /// Power of the reactions to these forces on what may move \[W\]: zero while the constraints hold, apart from what pins that move supply.
    pub fn power(&mut self, inverse_mass: &[f64], force: &[f64], v: &[f64]) -> f64 {
        self.find_multipliers(inverse_mass, force);
        let of = |(one, multiplier): (usize, &f64)| {
            let free = row(&self.entries, &self.ends, one).iter().filter(|(number, _)| inverse_mass[*number] != 0.0);
            multiplier * free.map(|(number, entry)| entry * v[*number]).sum::<f64>()
        };
        self.multipliers.iter().enumerate().map(of).sum()
    }

    /// Finds the multipliers for some forces.
    fn find_multipliers(&mut self, inverse_mass: &[f64], force: &[f64]) {
        let count = self.len();
        let Self { entries, ends, biases, matrix, multipliers, .. } = self;
        let row = |number: usize| row(entries, ends, number);
        matrix.clear();
        matrix.resize(count * count, 0.0);
        multipliers.clear();
        for one in 0..count {
            for other in 0..=one {
                let products = row(one).iter().flat_map(|(number, a)| {
                    let same = row(other).iter().filter(move |(other, _)| other == number);
                    same.map(move |(_, b)| a * b * inverse_mass[*number])
                });
                matrix[count * one + other] = products.sum();
            }
            let along: f64 =
                row(one).iter().map(|(number, entry)| entry * inverse_mass[*number] * force[*number]).sum();
            multipliers.push(-along - biases[one].0);
        }
        solve(matrix, multipliers);
    }

    /// Corrects a step `-H⁻¹ g` of Newton's method for `M z = f + Jᵀλ`, whose matrix H knows nothing of the reactions, so that the
    /// accelerations z + step keep the constraints to first order: `step -= H⁻¹ Jᵀ μ` with
    ///
    /// `J step = -(J z + J̇v + d J v + s C)/(1 + d av + s ax)`.
    ///
    /// Only the derivatives of J and of `J̇v` are left out, which are small in short steps. `weights` are av and ax, the derivatives of v and x by
    /// z, and `invert` replaces a vector by H⁻¹ times that.
    pub fn correct(
        &mut self,
        [by_velocity, by_position]: [f64; 2],
        inverse_mass: &[f64],
        z: &[f64],
        step: &mut [f64],
        invert: &mut dyn FnMut(&mut [f64]),
    ) {
        let (count, size) = (self.len(), step.len());
        let Self { entries, ends, biases, matrix, multipliers, columns } = self;
        let row = |number: usize| {
            row(entries, ends, number).iter().filter(|(number, _)| inverse_mass[*number] != 0.0).copied()
        };
        columns.clear();
        columns.resize(count * size, 0.0);
        matrix.clear();
        multipliers.clear();
        for (one, column) in columns.chunks_exact_mut(size).enumerate() {
            row(one).for_each(|(number, entry)| column[number] += entry);
            invert(column);
        }
        for (one, (bias, [damping, stiffness])) in biases.iter().enumerate() {
            let times = |vector: &[f64]| row(one).map(|(number, entry)| entry * vector[number]).sum::<f64>();
            matrix.extend(columns.chunks_exact(size).map(times));
            let wanted = -(times(z) + bias) / (1.0 + damping * by_velocity + stiffness * by_position);
            multipliers.push(times(step) - wanted);
        }
        self::solve(matrix, multipliers);
        for (multiplier, column) in multipliers.iter().zip(columns.chunks_exact(size)) {
            step.iter_mut().zip(column).for_each(|(step, column)| *step -= multiplier * column);
        }
    }
}

/// Entries of a row.
fn row<'a>(entries: &'a [(usize, f64)], ends: &[usize], number: usize) -> &'a [(usize, f64)] {
    let begin = if number == 0 { 0 } else { ends[number - 1] };
    &entries[begin..ends[number]]
}

/// Pivots below this share of their diagonal belong to constraints that follow from the others, or on numbers that may not move: these
/// get no multiplier.
const REDUNDANT: f64 = 1e-10;

/// Solves a small symmetric system by an `L D Lᵀ` factorisation of the lower triangle of the matrix, row by row.
fn solve(matrix: &mut [f64], vector: &mut [f64]) {
    let count = vector.len();
    for one in 0..count {
        let diagonal = matrix[count * one + one];
        for other in 0..=one {
            let mut entry = matrix[count * one + other];
            for before in 0..other {
                entry -=
                    matrix[count * one + before] * matrix[count * other + before] * matrix[count * before + before];
            }
            let pivot = matrix[count * other + other];
            matrix[count * one + other] = if other == one {
                if entry > REDUNDANT * diagonal { entry } else { 0.0 }
            } else if pivot > 0.0 {
                entry / pivot
            } else {
                0.0
            };
        }
    }
    for one in 0..count {
        let known: f64 = (0..one).map(|before| matrix[count * one + before] * vector[before]).sum();
        vector[one] -= known;
    }
    for one in (0..count).rev() {
        let pivot = matrix[count * one + one];
        let own = if pivot > 0.0 { vector[one] / pivot } else { 0.0 };
        let known: f64 = (one + 1..count).map(|after| matrix[count * after + one] * vector[after]).sum();
        vector[one] = if pivot > 0.0 { own - known } else { 0.0 };
    }
}
