//! Effect: contact by a potential.

use super::{DuplicatePolicy, Effect, EffectParameters, Motion};
use crate::{
    contact::{AnyContact, ClothContact, ContactProperties, Skin, SurfaceContact, SurfaceTerm},
    elements::Elements,
    quantity::{Dissipation, ImpactSpeed, Quantity, SkinModulus, SkinThickness},
};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Contact of bodies, or of cloth in space, with each other, with themselves, and with walls and the domain boundary, by a smooth potential of a thin skin,
/// with the same forces for every integrator; see [`crate::contact`]. Without it they touch walls and the domain boundary alone, by
/// a skin with the same default values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Contact {
    /// Modulus of the skin relative to Young's modulus.
    pub modulus: SkinModulus,
    /// Thickness of the skin relative to the mean length of the boundary edges, or of the edges of cloth.
    pub thickness: SkinThickness,
    /// Fastest impact that the skin stops [m/s].
    pub speed: ImpactSpeed,
    /// c [s/m].
    pub dissipation: Dissipation,
    /// Pairs of names of bodies and nets that do not touch each other; a body that is paired with itself does not touch itself.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub apart: Vec<(String, String)>,
}

impl Default for Contact {
    fn default() -> Self {
        Self {
            modulus: SkinModulus::literal(3.0),
            thickness: SkinThickness::literal(0.3),
            speed: ImpactSpeed::literal(2.0),
            dissipation: Dissipation::literal(0.0),
            apart: Vec::new(),
        }
    }
}

impl EffectParameters for Contact {
    fn title(&self) -> &'static str {
        "Contact potential"
    }

    fn about(&self) -> &'static str {
        "Bodies and cloth touch walls, each other and themselves. They have a thin elastic skin, which pushes back with the pressure −dφ/dg (1 − c dg/dt) at a gap g, for every integrator alike; friction is an elastic spring that slides at μ p."
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.modulus, &mut self.thickness, &mut self.speed, &mut self.dissipation]
    }

    fn duplicate_policy(&self) -> DuplicatePolicy {
        DuplicatePolicy::Ambiguous("a contact has one potential")
    }

    fn build(&self, elements: &Elements) -> Result<Box<dyn Effect>, String> {
        let surface = elements.contact.filter.is_none().then(|| surfaces(elements)).flatten();
        let mut apart = Vec::new();
        for (one, other) in &self.apart {
            let others = elements.named(other)?;
            apart
                .extend(elements.named(one)?.into_iter().flat_map(|one| others.iter().map(move |other| [one, *other])));
        }
        Ok(Box::new(ContactEffect { skin: self.skin(), apart, dimension: elements.dimension(), surface }))
    }
}

/// Contact of the surfaces of bodies or of cloth, if there are any.
fn surfaces(elements: &Elements) -> Option<Box<dyn SurfaceTerm>> {
    let Elements { contact: model, surface, rest, .. } = elements;
    if elements.dimension() == 3 {
        let contact = ClothContact::new(model, surface, elements.cloth_faces(), rest);
        return (!contact.is_empty()).then(|| Box::new(contact) as Box<dyn SurfaceTerm>);
    }
    let contact = SurfaceContact::new(model, surface, rest);
    (!contact.is_empty()).then(|| Box::new(contact) as Box<dyn SurfaceTerm>)
}

impl Contact {
    /// The skin without what other effects set.
    pub fn skin(&self) -> Skin {
        Skin {
            modulus: self.modulus.get(),
            thickness: self.thickness.get(),
            speed: self.speed.get(),
            dissipation: self.dissipation.get(),
        }
    }
}

struct ContactEffect {
    skin: Skin,
    /// Bodies and nets that do not touch each other, by their numbers.
    apart: Vec<[usize; 2]>,
    /// Number of coordinates of a vertex.
    dimension: usize,
    surface: Option<Box<dyn SurfaceTerm>>,
}

impl Effect for ContactEffect {
    fn name(&self) -> &'static str {
        "Contact potential"
    }

    fn elements(&self, motion: Motion<'_>) -> usize {
        motion.candidates.map_or(0, |candidates| candidates.pairs().len())
    }

    fn dimension(&self) -> Option<usize> {
        Some(self.dimension)
    }

    fn set_number(&mut self, number: usize) {
        self.surface.iter_mut().for_each(|surface| surface.set_number(number));
    }

    fn contact(&self) -> Option<AnyContact<'_>> {
        self.surface_contact().map(SurfaceTerm::contact)
    }

    fn surface_contact(&self) -> Option<&dyn SurfaceTerm> {
        self.surface.as_deref()
    }

    fn setting_aside(&self, bodies: &[[usize; 2]]) -> Option<Arc<dyn Effect>> {
        let surface = Some(self.surface.as_ref()?.setting_aside(bodies)?);
        Some(Arc::new(Self { skin: self.skin, apart: self.apart.clone(), dimension: self.dimension, surface }))
    }

    fn set_properties(&self, properties: &mut ContactProperties) {
        properties.skin = Some(self.skin);
        properties.apart.clone_from(&self.apart);
    }
}
