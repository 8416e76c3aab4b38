//! Effect: coefficient of restitution of contacts.

use super::{DuplicatePolicy, Effect, EffectParameters, Motion};
use crate::{
    elements::Elements,
    obstacles::Surface,
    quantity::{Quantity, RestitutionCoefficient},
};
use serde::{Deserialize, Serialize};

/// Restitution at walls, obstacles and edges of the world (Newton's law of impact): a vertex that hits gets back the share e of
/// its velocity across the surface.
///
/// It acts on vertices. A body bounces by its own elasticity as well, and the more so the more of it is away from the surface.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Restitution {
    /// e.
    pub coefficient: RestitutionCoefficient,
}

impl Default for Restitution {
    fn default() -> Self {
        Self { coefficient: RestitutionCoefficient::literal(0.5) }
    }
}

impl EffectParameters for Restitution {
    fn title(&self) -> &'static str {
        "Restitution"
    }

    fn about(&self) -> &'static str {
        "v'·n = −e v·n where a vertex hits a wall or the domain boundary; a body bounces by its own elasticity as well."
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.coefficient]
    }

    fn duplicate_policy(&self) -> DuplicatePolicy {
        DuplicatePolicy::Ambiguous("a contact has one coefficient")
    }

    fn build(&self, _: &Elements) -> Result<Box<dyn Effect>, String> {
        Ok(Box::new(ContactCoefficient(self.coefficient.get())))
    }
}

/// e.
struct ContactCoefficient(f64);

impl Effect for ContactCoefficient {
    fn name(&self) -> &'static str {
        "Restitution"
    }

    fn elements(&self, _: Motion<'_>) -> usize {
        0
    }

    fn is_surface_effect(&self) -> bool {
        true
    }

    fn set_surface(&self, surface: &mut Surface) {
        surface.restitution = self.0;
    }
}
