//! Effect: a force typed as formulas.

use super::{Effect, EffectParameters, Motion, ZERO, power_of_force};
use crate::{
    elements::Elements,
    formula::{Formula, FormulaError},
    quantity::{ForceFactor, Quantity},
    solvers::{Block, SparseMatrix, Tangent, Weights},
};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// A force on every vertex in proportion to its mass: `f = m s b(x, v, t)`, with b typed as one formula for each axis.
///
/// The formulas know the position x, y, z \[m\], the velocity vx, vy, vz [m/s] and the time t \[s\]. Implicit schemes use the symmetric part of the exact
/// derivatives. The antisymmetric part, as of a force across the velocity, `x: "w*vy", y: "-w*vx"`, is left out: Newton's method then converges while the
/// step is shorter than 1/w, and the guard divides longer ones.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodyForce {
    /// Name of the body, net or membrane that it acts on; all, if it is not said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub of: Option<String>,
    /// b along x [N/kg].
    #[serde(default)]
    pub x: PointFormula,
    /// b along y [N/kg].
    #[serde(default)]
    pub y: PointFormula,
    /// b along z, in space [N/kg].
    #[serde(default, skip_serializing_if = "PointFormula::is_zero")]
    pub z: PointFormula,
    /// s.
    #[serde(default = "whole")]
    pub factor: ForceFactor,
}

const fn whole() -> ForceFactor {
    ForceFactor::literal(1.0)
}

/// A formula of the position, the velocity and the time of a vertex.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct PointFormula {
    text: String,
    formula: Formula,
}

/// Names of its variables.
const NAMES: [&str; 7] = ["x", "y", "z", "vx", "vy", "vz", "t"];
/// Which of them is the time.
const TIME: usize = 6;

impl PointFormula {
    /// Reads a formula.
    ///
    /// # Errors
    /// [`FormulaError`], if the text is none.
    pub fn new(text: &str) -> Result<Self, FormulaError> {
        Ok(Self { text: text.to_owned(), formula: Formula::parse(text, &NAMES)? })
    }

    /// Its text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Whether it is the number zero.
    fn is_zero(&self) -> bool {
        self.formula.is_zero()
    }
}

impl Default for PointFormula {
    fn default() -> Self {
        Self { text: "0".to_owned(), formula: Formula::zero() }
    }
}

impl TryFrom<String> for PointFormula {
    type Error = FormulaError;

    fn try_from(text: String) -> Result<Self, FormulaError> {
        Self::new(&text)
    }
}

impl From<PointFormula> for String {
    fn from(formula: PointFormula) -> Self {
        formula.text
    }
}

impl Default for BodyForce {
    fn default() -> Self {
        let sway = PointFormula::new("2*sin(3*t)").unwrap_or_default();
        Self { of: None, x: sway, y: PointFormula::default(), z: PointFormula::default(), factor: whole() }
    }
}

impl EffectParameters for BodyForce {
    fn title(&self) -> &'static str {
        "Body force"
    }

    fn about(&self) -> &'static str {
        "f = m s b(x, v, t) on every vertex, with b in N/kg typed as formulas of x, y, z, vx, vy, vz and t, such as -2*x + sin(3*t)."
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.factor]
    }

    fn formulas(&mut self) -> Vec<(&'static str, &mut PointFormula)> {
        vec![("x", &mut self.x), ("y", &mut self.y), ("z", &mut self.z)]
    }

    fn build(&self, elements: &Elements) -> Result<Box<dyn Effect>, String> {
        let formulas = [&self.x, &self.y, &self.z].map(|listed| listed.formula.clone());
        if elements.dimension() == 2 {
            let in_space = [2, 5].into_iter().find(|variable| formulas.iter().any(|formula| formula.uses(*variable)));
            if let Some(variable) = in_space {
                return Err(format!("its formulas have no `{}` in the plane", NAMES[variable]));
            }
            if !self.z.is_zero() {
                return Err("it has no z in the plane".to_owned());
            }
        }
        let range = |number: &usize| {
            let shape = &elements.shapes[*number];
            let first = shape.first as usize;
            first..first + shape.points.len() / 2
        };
        let parts = match &self.of {
            Some(name) => Some(elements.named(name)?.iter().map(range).collect()),
            None => None,
        };
        Ok(Box::new(Field { formulas, parts, factor: self.factor.get() }))
    }
}

/// The built effect.
struct Field {
    formulas: [Formula; 3],
    /// Vertices of the parts that it acts on, if not on all.
    parts: Option<Vec<Range<usize>>>,
    factor: f64,
}

impl Field {
    /// Vertices that it acts on.
    fn vertices(&self, motion: &Motion<'_>) -> impl Iterator<Item = usize> {
        let all = self.parts.is_none().then(|| 0..motion.vertices());
        all.into_iter().chain(self.parts.iter().flatten().cloned()).flatten()
    }

    /// Variables of a vertex, by its place among the numbers of all.
    fn variables(motion: &Motion<'_>, at: usize) -> [f64; 7] {
        let mut variables = [0.0; 7];
        variables[..motion.dimension].copy_from_slice(&motion.x[at..at + motion.dimension]);
        variables[3..3 + motion.dimension].copy_from_slice(&motion.v[at..at + motion.dimension]);
        variables[TIME] = motion.time;
        variables
    }

    /// Derivatives of the force on a kilogram by positions and by velocities, by rows.
    fn derivatives(&self, motion: &Motion<'_>, at: usize) -> [[[f64; 3]; 3]; 2] {
        let variables = Self::variables(motion, at);
        let rows = self.formulas.each_ref().map(|formula| formula.derivatives(&variables).1);
        [0, 3].map(|first| rows.map(|row| std::array::from_fn(|axis| self.factor * row[first + axis])))
    }

    /// Adds `-df/dx` and `-df/dv` of all vertices with their weights, symmetric, and as the tangent says.
    fn add_blocks<const D: usize>(&self, motion: &Motion<'_>, weights: Weights, add: &mut dyn FnMut(usize, &Block<D>)) {
        for vertex in self.vertices(motion) {
            let [by_x, by_v] = self.derivatives(motion, D * vertex);
            let mass = motion.mass[D * vertex];
            // A derivative that is not asked for may be infinite.
            let times = |weight: f64, slope: f64| if weight == 0.0 { 0.0 } else { weight * slope };
            let entry = |row: usize, column: usize| {
                times(weights.position, by_x[row][column]) + times(weights.velocity, by_v[row][column])
            };
            let block = Block::<D>::from_fn(|row, column| -0.5 * mass * (entry(row, column) + entry(column, row)));
            add(vertex, &changed(block, weights.tangent));
        }
    }
}

/// A symmetric block with its eigenvalues as the tangent has them.
fn changed<const D: usize>(block: Block<D>, tangent: Tangent) -> Block<D> {
    let change = match tangent {
        Tangent::Exact => return block,
        Tangent::Definite => |eigenvalue: f64| eigenvalue.max(0.0),
        Tangent::Absolute => f64::abs,
    };
    // Jacobi's method: a rotation in each pair of axes until nothing is left beside the diagonal.
    let (mut values, mut vectors) = (block, Block::<D>::identity());
    for _ in 0..SWEEPS {
        for (one, other) in (0..D).flat_map(|one| (one + 1..D).map(move |other| (one, other))) {
            let beside = values[(one, other)];
            if beside == 0.0 {
                continue;
            }
            let half = (values[(other, other)] - values[(one, one)]) / (2.0 * beside);
            let tangent = half.signum() / (half.abs() + (half * half + 1.0).sqrt());
            let cosine = 1.0 / (tangent * tangent + 1.0).sqrt();
            let mut rotation = Block::<D>::identity();
            (rotation[(one, one)], rotation[(other, other)]) = (cosine, cosine);
            (rotation[(one, other)], rotation[(other, one)]) = (tangent * cosine, -tangent * cosine);
            values = rotation.transpose() * values * rotation;
            vectors *= rotation;
        }
    }
    let mut diagonal = Block::<D>::zeros();
    (0..D).for_each(|axis| diagonal[(axis, axis)] = change(values[(axis, axis)]));
    vectors * diagonal * vectors.transpose()
}

/// Sweeps of Jacobi's method; it converges quadratically.
const SWEEPS: usize = 6;

impl Effect for Field {
    fn name(&self) -> &'static str {
        "BodyForce"
    }

    fn elements(&self, motion: Motion<'_>) -> usize {
        self.vertices(&motion).count()
    }

    fn idle(&self, _: Motion<'_>) -> Option<&'static str> {
        (self.factor == 0.0 || self.formulas.iter().all(Formula::is_zero)).then_some(ZERO)
    }

    fn is_steady(&self) -> bool {
        !self.formulas.iter().any(|formula| formula.uses(TIME))
    }

    fn force(&self, motion: Motion<'_>, _: &mut [f64], force: &mut [f64]) {
        // A formula may be undefined where a vertex is pinned, as at a centre of attraction.
        let is_free = |vertex: &usize| {
            let at = motion.dimension * vertex;
            motion.inverse_mass[at..at + motion.dimension].iter().any(|inverse| *inverse != 0.0)
        };
        for vertex in self.vertices(&motion).filter(is_free) {
            let at = motion.dimension * vertex;
            let variables = Self::variables(&motion, at);
            for (force, formula) in force[at..at + motion.dimension].iter_mut().zip(&self.formulas) {
                *force += self.factor * motion.mass[at] * formula.value(&variables);
            }
        }
    }

    fn supplies(&self) -> bool {
        true
    }

    fn supplied_power(&self, motion: Motion<'_>, forces: &mut Vec<f64>) -> Option<f64> {
        Some(power_of_force(self, motion, forces))
    }

    fn stiffness_times(&self, motion: Motion<'_>, d: &[f64], _: &mut [f64], product: &mut [f64]) {
        let weights = Weights { position: 1.0, velocity: 0.0, tangent: Tangent::Exact };
        match motion.dimension {
            2 => self.add_blocks::<2>(&motion, weights, &mut |vertex, block| multiply(block, vertex, d, product)),
            3 => self.add_blocks::<3>(&motion, weights, &mut |vertex, block| multiply(block, vertex, d, product)),
            _ => {}
        }
    }

    fn add_stiffness(&self, motion: Motion<'_>, weights: Weights, matrix: &mut dyn SparseMatrix) {
        if let Some(matrix) = matrix.blocks::<2>() {
            self.add_blocks::<2>(&motion, weights, &mut |vertex, block| matrix.diagonal(vertex, block));
        } else if let Some(matrix) = matrix.blocks::<3>() {
            self.add_blocks::<3>(&motion, weights, &mut |vertex, block| matrix.diagonal(vertex, block));
        }
    }

    /// Greatest row of the derivatives by velocities: no rate at which it damps or drives any motion is greater.
    fn damping(&self, motion: Motion<'_>) -> [f64; 2] {
        let uses_velocity = (3..TIME).any(|variable| self.formulas.iter().any(|formula| formula.uses(variable)));
        if !uses_velocity {
            return [0.0; 2];
        }
        let rate = |vertex: usize| {
            let [_, by_v] = self.derivatives(&motion, motion.dimension * vertex);
            by_v.iter().map(|row| row.iter().map(|slope| slope.abs()).sum::<f64>()).fold(0.0, f64::max)
        };
        let free = |vertex: &usize| motion.inverse_mass[motion.dimension * vertex] != 0.0;
        [self.vertices(&motion).filter(free).map(rate).fold(0.0, f64::max), 0.0]
    }
}

/// Adds a block times the displacement of a vertex.
fn multiply<const D: usize>(block: &Block<D>, vertex: usize, d: &[f64], product: &mut [f64]) {
    for (row, column) in (0..D).flat_map(|row| (0..D).map(move |column| (row, column))) {
        product[D * vertex + row] += block[(row, column)] * d[D * vertex + column];
    }
}
