use super::Model;
use crate::quantity::{OutOfRange, Poisson, Young};
use serde::{Deserialize, Serialize};

/// What the third dimension does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Plane {
    /// The sheet is held at its thickness: F33 = 1. `lambda = E nu / ((1 + nu)(1 - 2 nu))`.
    #[default]
    Strain,
    /// The faces of the sheet are free: no stress through the thickness. `lambda = E nu / ((1 + nu)(1 - nu))`.
    Stress,
}

/// Lame's parameters [Pa].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lame {
    /// Shear modulus mu = E / (2 (1 + nu)) [Pa].
    pub mu: f64,
    /// First parameter lambda of the plane [Pa].
    pub lambda: f64,
}

/// A constitutive model with Young's modulus and Poisson's ratio, always a valid pair.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Raw", into = "Raw")]
pub struct MaterialParameters {
    model: Model,
    young: Young,
    poisson: Poisson,
    plane: Plane,
}

/// Young's modulus, Poisson's ratio or their combination is not allowed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BadMaterial {
    /// A value is outside its own range.
    #[error(transparent)]
    OutOfRange(#[from] OutOfRange),
    /// In plane strain the area cannot stay the same: lambda would be infinite.
    #[error("Poisson's ratio must be in (-1, 0.5) for plane strain and in (-1, 0.5] for plane stress, got {0}")]
    Poisson(f64),
}

impl MaterialParameters {
    /// Checked parameters.
    ///
    /// # Errors
    /// [`BadMaterial::Poisson`] for nu = 0.5 in plane strain.
    pub fn new(model: Model, young: Young, poisson: Poisson, plane: Plane) -> Result<Self, BadMaterial> {
        if plane == Plane::Strain && poisson.get() >= 0.5 {
            return Err(BadMaterial::Poisson(poisson.get()));
        }
        Ok(Self { model, young, poisson, plane })
    }

    /// The same stuff under another model.
    #[must_use]
    pub const fn with_model(self, model: Model) -> Self {
        Self { model, ..self }
    }

    /// Constitutive model.
    pub const fn model(&self) -> Model {
        self.model
    }

    /// Young's modulus E [Pa].
    pub const fn young(&self) -> Young {
        self.young
    }

    /// Poisson's ratio nu.
    pub const fn poisson(&self) -> Poisson {
        self.poisson
    }

    /// Plane strain or plane stress.
    pub const fn plane(&self) -> Plane {
        self.plane
    }

    /// Lame's parameters of the plane [Pa].
    pub fn lame(&self) -> Lame {
        let (young, nu) = (self.young.get(), self.poisson.get());
        let lambda = match self.plane {
            Plane::Strain => young * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)),
            Plane::Stress => young * nu / ((1.0 + nu) * (1.0 - nu)),
        };
        Lame { mu: young / (2.0 * (1.0 + nu)), lambda }
    }
}

#[derive(Serialize, Deserialize)]
#[serde(rename = "MaterialParameters", deny_unknown_fields)]
struct Raw {
    model: Model,
    young: Young,
    poisson: f64,
    #[serde(default)]
    plane: Plane,
}

impl TryFrom<Raw> for MaterialParameters {
    type Error = BadMaterial;
    fn try_from(raw: Raw) -> Result<Self, BadMaterial> {
        let poisson = Poisson::new(raw.poisson).map_err(|_| BadMaterial::Poisson(raw.poisson))?;
        Self::new(raw.model, raw.young, poisson, raw.plane)
    }
}

impl From<MaterialParameters> for Raw {
    fn from(of: MaterialParameters) -> Self {
        Self { model: of.model, young: of.young, poisson: of.poisson.get(), plane: of.plane }
    }
}
