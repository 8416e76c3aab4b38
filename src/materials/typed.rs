//! Materials whose energy density is typed as a formula.

use super::{Lame, Material, MaterialParameters, Moduli, Parts, moduli::stiffness_of, principal::free_width};
use crate::{
    formula::{Formula, FormulaError, Program},
    simd::{Dual, Jet, Mat2, Real},
};
use nalgebra::{Matrix2, Matrix4};
use serde::{Deserialize, Serialize};

/// An energy density psi(I1, J) [J/m²] typed as a formula of `I1 = tr FᵀF` and `J = det F` in the plane, such as
/// `mu/2*(I1 - 2 - 2*log(J)) + lambda/2*log(J)^2`.
///
/// It depends on F through these two numbers alone, so it is isotropic and does not change when the body turns. The formula knows the moduli `mu`,
/// `lambda`, `E` and `nu` of the material of the body and named parameters of its own. Stress and stiffness follow by exact differentiation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Raw", into = "Raw")]
pub struct TypedEnergy {
    text: String,
    parameters: Vec<(String, f64)>,
    formula: Formula,
}

/// Names that every formula knows, before those of its parameters.
const NAMES: [&str; 6] = ["I1", "J", "mu", "lambda", "E", "nu"];

/// Most parameters of a formula.
const MOST_PARAMETERS: usize = 12;

/// A formula of an energy, or a parameter of it, is not allowed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BadEnergy {
    /// The text is no formula.
    #[error("energy: {0}")]
    Formula(#[from] FormulaError),
    /// A parameter has a name that means something else, or is no name.
    #[error(
        "`{0}` cannot be the name of a parameter: it must begin with a letter, consist of letters, digits and _, and not be I1, J, mu, lambda, E or nu"
    )]
    Name(String),
    /// Two parameters have the same name.
    #[error("there are two parameters `{0}`")]
    Twice(String),
    /// A parameter is not finite.
    #[error("parameter `{0}` must be a finite number, got {1}")]
    Value(String, f64),
    /// There are too many parameters.
    #[error("an energy has at most {MOST_PARAMETERS} parameters, got {0}")]
    Many(usize),
}

impl TypedEnergy {
    /// The energy of the compressible neo-Hookean model.
    pub const NEO_HOOKEAN: &'static str = "mu/2*(I1 - 2 - 2*log(J)) + lambda/2*log(J)^2";

    /// Reads a formula with named parameters.
    ///
    /// # Errors
    /// [`BadEnergy`], if the text is no formula of the known names or a parameter is not allowed.
    pub fn new(text: &str, parameters: Vec<(String, f64)>) -> Result<Self, BadEnergy> {
        if parameters.len() > MOST_PARAMETERS {
            return Err(BadEnergy::Many(parameters.len()));
        }
        for (place, (name, value)) in parameters.iter().enumerate() {
            if parameters[..place].iter().any(|(other, _)| other == name) {
                return Err(BadEnergy::Twice(name.clone()));
            }
            let is_name = name.starts_with(char::is_alphabetic)
                && name.chars().all(|letter| letter.is_alphanumeric() || letter == '_');
            if !is_name || NAMES.contains(&name.as_str()) {
                return Err(BadEnergy::Name(name.clone()));
            }
            if !value.is_finite() {
                return Err(BadEnergy::Value(name.clone(), *value));
            }
        }
        let names: Vec<&str> = NAMES.into_iter().chain(parameters.iter().map(|(name, _)| name.as_str())).collect();
        let formula = Formula::parse(text, &names)?;
        Ok(Self { text: text.to_owned(), parameters, formula })
    }

    /// Its text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Its parameters.
    pub fn parameters(&self) -> &[(String, f64)] {
        &self.parameters
    }

    /// The same formula with another value of a parameter, or with one more.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_parameter(&self, name: &str, value: f64) -> Result<Self, BadEnergy> {
        let mut parameters = self.parameters.clone();
        match parameters.iter_mut().find(|(other, _)| other == name) {
            Some((_, known)) => *known = value,
            None => parameters.push((name.to_owned(), value)),
        }
        Self::new(&self.text, parameters)
    }

    /// The material with the moduli of a level.
    ///
    /// # Errors
    /// A sentence, where the formula has a stress at rest or no positive stiffness there, or is too long.
    pub fn material(&self, parameters: MaterialParameters) -> Result<TypedMaterial, String> {
        let Lame { mu, lambda } = parameters.lame();
        let moduli = [mu, lambda, parameters.young().get(), parameters.poisson().get()];
        let numbers: Vec<f64> = moduli.into_iter().chain(self.parameters.iter().map(|(_, value)| *value)).collect();
        let program = self.formula.program(&numbers).map_err(|why| format!("energy: {why}"))?;
        TypedMaterial::new(&program).map_err(|why| format!("energy `{}`: {why}", self.text))
    }
}

#[derive(Serialize, Deserialize)]
#[serde(rename = "TypedEnergy", deny_unknown_fields)]
struct Raw {
    formula: String,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    parameters: Vec<(String, f64)>,
}

impl TryFrom<Raw> for TypedEnergy {
    type Error = BadEnergy;
    fn try_from(raw: Raw) -> Result<Self, BadEnergy> {
        Self::new(&raw.formula, raw.parameters)
    }
}

impl From<TypedEnergy> for Raw {
    fn from(of: TypedEnergy) -> Self {
        Self { formula: of.text, parameters: of.parameters }
    }
}

/// The material of a typed energy density: `P = 2 psi_I F + psi_J cof F`.
///
/// Through the thickness the formula is read with `I1 + F33² - 1` and `J F33`, so that `P33 = 2 psi_I + J psi_J` in plane strain, as of the
/// neo-Hookean model.
#[derive(Clone, Copy, Debug)]
pub struct TypedMaterial {
    program: Program,
    lame: Lame,
}

impl TypedMaterial {
    /// I1 and J at rest.
    const REST: [f64; 2] = [2.0, 1.0];

    /// Checks the rest state and makes the energy zero there.
    fn new(program: &Program) -> Result<Self, String> {
        /// Largest stress at rest, as a fraction of the shear modulus.
        const ROUND_OFF: f64 = 1e-9;
        let [i, j] = Self::REST;
        let Jet { value, first: [by_i, by_j], second: [ii, ij, jj] } =
            program.compute([Jet::variable(i, 0), Jet::variable(j, 1)]);
        let all = [value, by_i, by_j, ii, ij, jj];
        if !all.iter().all(|number| number.is_finite()) {
            return Err("at rest, where I1 = 2 and J = 1, it or a derivative of it is not finite".to_owned());
        }
        let (mu, pressure) = (2.0 * by_i, 2.0 * by_i + by_j);
        let lambda = 4.0 * (ii + ij) + jj - mu;
        if pressure.abs() > ROUND_OFF * mu.abs().max(by_j.abs()) {
            return Err(format!(
                "at rest there is a stress of {pressure:.3e} Pa: 2 dψ/dI1 + dψ/dJ must be 0 at I1 = 2, J = 1; add {:.3e}*log(J) or the like",
                -pressure
            ));
        }
        if mu <= 0.0 || lambda + mu <= 0.0 {
            return Err(format!(
                "at rest it is not stiff: the shear modulus 2 dψ/dI1 is {mu:.3e} Pa and the bulk modulus of the plane {:.3e} Pa; both must be positive",
                lambda + mu
            ));
        }
        Ok(Self { program: program.plus(-value), lame: Lame { mu, lambda } })
    }

    /// Lame's parameters of Hooke's law to which it linearises at rest \[Pa\].
    pub const fn lame(&self) -> Lame {
        self.lame
    }

    /// The derivatives by I1 and J.
    #[inline(always)]
    fn slopes<R: Real>(&self, f: Mat2<R>) -> [R; 2] {
        self.program.compute([Dual::variable(f.norm_squared(), 0), Dual::variable(f.determinant(), 1)]).first
    }

    /// P22 of the diagonal gradient with these stretches, and its derivative by the second.
    fn across(&self, stretch: f64, width: f64) -> [f64; 2] {
        let (i, j) = (stretch * stretch + width * width, stretch * width);
        let jet = self.program.compute([Jet::variable(i, 0), Jet::variable(j, 1)]);
        let ([by_i, by_j], [ii, ij, jj]) = (jet.first, jet.second);
        let stress = 2.0 * by_i * width + by_j * stretch;
        let bend = 4.0 * width * width * ii + 4.0 * width * stretch * ij + stretch * stretch * jj;
        [stress, 2.0 * by_i + bend]
    }
}

impl Material for TypedMaterial {
    const TITLE: &'static str = "Typed energy";
    const LETTER: &'static str = "";
    const FORMULA: &'static str = "ψ(I₁, J) as typed";

    type Sheet = Self;

    fn sheet(&self) -> Self {
        *self
    }

    #[inline(always)]
    fn psi<R: Real>(&self, f: Mat2<R>) -> R {
        self.program.compute([f.norm_squared(), f.determinant()])
    }

    #[inline(always)]
    fn piola<R: Real>(&self, f: Mat2<R>) -> Mat2<R> {
        let [by_i, by_j] = self.slopes(f);
        f * (by_i * 2.0) + f.cofactor() * by_j
    }

    fn stiffness(&self, f: &Matrix2<f64>) -> Matrix4<f64> {
        stiffness_of(self, f)
    }

    /// With `I1 = p² + q²` and `J = (p² - q²)/2`.
    #[inline(always)]
    fn moduli<R: Real>(&self, parts: &Parts<R>) -> Moduli<R> {
        let (i, j) = (parts.f.norm_squared(), parts.f.determinant());
        let jet = self.program.compute([Jet::variable(i, 0), Jet::variable(j, 1)]);
        let ([by_i, by_j], [ii, ij, jj]) = (jet.first, jet.second);
        let Moduli { twist, flip, sizes: [pp, pq, qq] } = parts.moduli([by_i, by_j], [ii, jj]);
        let mixed = ij * 4.0;
        Moduli { twist, flip, sizes: [pp + parts.p * parts.p * mixed, pq, qq - parts.q * parts.q * mixed] }
    }

    #[inline(always)]
    fn thickness_stress<R: Real>(&self, f: Mat2<R>) -> R {
        let [by_i, by_j] = self.slopes(f);
        by_i * 2.0 + by_j * f.determinant()
    }

    fn free_width(&self, stretch: f64) -> Option<f64> {
        free_width(|width| self.across(stretch, width))
    }
}
