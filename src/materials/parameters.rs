//! Material parameters of a level.

use super::{Model, PlaneStress};
use crate::quantity::{OutOfRange, Poisson, Young};
use serde::{Deserialize, Serialize};

/// Condition through the thickness.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Plane {
    /// The sheet is held at its thickness: F33 = 1. `lambda = E nu / ((1 + nu)(1 - 2 nu))`.
    #[default]
    Strain,
    /// The faces of the sheet are free as in Hooke's law: `lambda = E nu / ((1 + nu)(1 - nu))` in the formula of plane strain. At
    /// small strains there is no stress through the thickness; at large ones neo-Hookean, stable neo-Hookean and fixed corotated
    /// models leave some.
    Stress,
    /// The faces of the sheet are free at every strain: the thickness of each triangle solves P33 = 0. The same as
    /// [`Self::Stress`] for models that have no stress through the thickness there ([`Model::plane_stress`]).
    StressExact,
}

impl Plane {
    /// Whether the faces of the sheet are free.
    pub const fn is_stress(self) -> bool {
        matches!(self, Self::Stress | Self::StressExact)
    }
}

/// Lame's parameters \[Pa\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lame {
    /// Shear modulus mu = E / (2 (1 + nu)) \[Pa\].
    pub mu: f64,
    /// First parameter lambda of the plane \[Pa\].
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
    #[error(
        "Poisson's ratio must be greater than -1 and less than 0.5 for plane strain (at most 0.5 for plane stress), got {0}"
    )]
    Poisson(f64),
    /// The thickness that leaves no stress in it is not unique, or there is none.
    #[error(
        "with exact plane stress (StressExact), Poisson's ratio of {} must be at least 0 and at most 0.5, got {poisson}; choose plane stress (Stress)",
        .model.title()
    )]
    Thickness {
        /// The model.
        model: Model,
        /// Poisson's ratio.
        poisson: f64,
    },
    /// The model has no usable answer in this plane.
    #[error(
        "{} has no exact plane stress (StressExact). Choose plane stress (Stress) or another model",
        .0.title()
    )]
    NotExact(Model),
}

impl Default for MaterialParameters {
    /// Soft gingerbread: corotated, E = 1000 Pa, nu = 0.3, plane strain.
    fn default() -> Self {
        let (young, poisson) = (Young::literal(1000.0), Poisson::literal(0.3));
        Self { model: Model::Corotated, young, poisson, plane: Plane::Strain }
    }
}

impl MaterialParameters {
    /// Checked parameters.
    ///
    /// # Errors
    /// [`BadMaterial::Poisson`] for nu = 0.5 in plane strain; for exact plane stress [`BadMaterial::NotExact`] if the model has
    /// none, [`BadMaterial::Thickness`] if it has none with a negative nu.
    pub fn new(model: Model, young: Young, poisson: Poisson, plane: Plane) -> Result<Self, BadMaterial> {
        if plane == Plane::Strain && poisson.get() >= 0.5 {
            return Err(BadMaterial::Poisson(poisson.get()));
        }
        if plane == Plane::StressExact {
            match model.plane_stress() {
                PlaneStress::Approximate => return Err(BadMaterial::NotExact(model)),
                PlaneStress::Solved if poisson.get() < 0.0 => {
                    return Err(BadMaterial::Thickness { model, poisson: poisson.get() });
                }
                PlaneStress::Solved | PlaneStress::Exact => {}
            }
        }
        Ok(Self { model, young, poisson, plane })
    }

    /// The same stuff under another model; in plane stress where that model has no exact plane stress.
    #[must_use]
    pub fn with_model(self, model: Model) -> Self {
        self.try_with_model(model).unwrap_or(Self { model, plane: Plane::Stress, ..self })
    }

    /// The same stuff under another model.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn try_with_model(self, model: Model) -> Result<Self, BadMaterial> {
        Self::new(model, self.young, self.poisson, self.plane)
    }

    /// Constitutive model.
    pub const fn model(&self) -> Model {
        self.model
    }

    /// Young's modulus E \[Pa\].
    pub const fn young(&self) -> Young {
        self.young
    }

    /// Poisson's ratio nu.
    pub const fn poisson(&self) -> Poisson {
        self.poisson
    }

    /// Condition through the thickness.
    pub const fn plane(&self) -> Plane {
        self.plane
    }

    /// Lame's parameters of the plane \[Pa\].
    pub fn lame(&self) -> Lame {
        let (young, nu) = (self.young.get(), self.poisson.get());
        let lambda = match self.plane {
            Plane::Strain => young * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)),
            Plane::Stress | Plane::StressExact => young * nu / ((1.0 + nu) * (1.0 - nu)),
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
