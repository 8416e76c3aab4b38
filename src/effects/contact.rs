//! Effect: contact by a potential.

use super::{DuplicatePolicy, Effect, EffectParameters, Motion};
use crate::{
    contact::Skin,
    elements::Elements,
    quantity::{Dissipation, ImpactSpeed, Quantity, SkinModulus, SkinThickness},
};
use serde::{Deserialize, Serialize};

/// Contact with walls and the domain boundary by a smooth potential of a thin skin, with the same forces for every integrator; see
/// [`crate::contact`]. Without it a velocity filter acts at the end of each step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Contact {
    /// Modulus of the skin relative to Young's modulus.
    pub modulus: SkinModulus,
    /// Thickness of the skin relative to the mean length of the boundary edges.
    pub thickness: SkinThickness,
    /// Fastest impact that the skin stops [m/s].
    pub speed: ImpactSpeed,
    /// c [s/m].
    pub dissipation: Dissipation,
}

impl Default for Contact {
    fn default() -> Self {
        Self {
            modulus: SkinModulus::literal(3.0),
            thickness: SkinThickness::literal(0.3),
            speed: ImpactSpeed::literal(2.0),
            dissipation: Dissipation::literal(0.0),
        }
    }
}

impl EffectParameters for Contact {
    fn title(&self) -> &'static str {
        "Contact potential"
    }

    fn about(&self) -> &'static str {
        "Bodies have a thin elastic skin. It pushes back with the pressure −dφ/dg (1 − c dg/dt) at a gap g, for every integrator alike; friction is an elastic spring that slides at μ p."
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.modulus, &mut self.thickness, &mut self.speed, &mut self.dissipation]
    }

    fn duplicate_policy(&self) -> DuplicatePolicy {
        DuplicatePolicy::Ambiguous("a contact has one potential")
    }

    fn build(&self, _: &Elements) -> Result<Box<dyn Effect>, String> {
        Ok(Box::new(ContactEffect(Skin {
            modulus: self.modulus.get(),
            thickness: self.thickness.get(),
            speed: self.speed.get(),
            dissipation: self.dissipation.get(),
        })))
    }
}

struct ContactEffect(Skin);

impl Effect for ContactEffect {
    fn name(&self) -> &'static str {
        "Contact potential"
    }

    fn elements(&self, _: Motion<'_>) -> usize {
        0
    }

    fn is_surface_effect(&self) -> bool {
        true
    }

    fn skin(&self) -> Option<Skin> {
        Some(self.0)
    }
}
