//! Effect: contact by a potential.

use super::{DuplicatePolicy, Effect, EffectParameters, Motion};
use crate::{
    contact::{ContactTerm, Skin, SurfaceContact},
    elements::Elements,
    quantity::{Dissipation, ImpactSpeed, Quantity, SkinModulus, SkinThickness},
};
use serde::{Deserialize, Serialize};

/// Contact of bodies with each other, with themselves, and with walls and the domain boundary, by a smooth potential of a thin skin,
/// with the same forces for every integrator; see [`crate::contact`]. Without it bodies do not touch each other, and a velocity
/// filter at walls acts at the end of each step.
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
        "Bodies touch walls, each other and themselves. They have a thin elastic skin, which pushes back with the pressure −dφ/dg (1 − c dg/dt) at a gap g, for every integrator alike; friction is an elastic spring that slides at μ p."
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.modulus, &mut self.thickness, &mut self.speed, &mut self.dissipation]
    }

    fn duplicate_policy(&self) -> DuplicatePolicy {
        DuplicatePolicy::Ambiguous("a contact has one potential")
    }

    fn build(&self, elements: &Elements) -> Result<Box<dyn Effect>, String> {
        let skin = Skin {
            modulus: self.modulus.get(),
            thickness: self.thickness.get(),
            speed: self.speed.get(),
            dissipation: self.dissipation.get(),
        };
        // Its friction is not known before all effects are built once.
        let surface = elements.skin.map(|skin| SurfaceContact::new(skin, &elements.skinned, &elements.rest));
        Ok(Box::new(ContactEffect { skin, surface }))
    }
}

struct ContactEffect {
    skin: Skin,
    surface: Option<SurfaceContact>,
}

impl Effect for ContactEffect {
    fn name(&self) -> &'static str {
        "Contact potential"
    }

    fn elements(&self, motion: Motion<'_>) -> usize {
        motion.candidates.map_or(0, |candidates| candidates.pairs().len())
    }

    fn dimension(&self) -> Option<usize> {
        Some(2)
    }

    fn set_number(&mut self, number: usize) {
        self.surface.iter_mut().for_each(|surface| surface.set_number(number));
    }

    fn contact(&self) -> Option<&dyn ContactTerm> {
        self.surface_contact().map(|surface| surface as &dyn ContactTerm)
    }

    fn surface_contact(&self) -> Option<&SurfaceContact> {
        self.surface.as_ref().filter(|surface| !surface.is_empty())
    }

    fn skin(&self) -> Option<Skin> {
        Some(self.skin)
    }
}
