//! Effect: Coulomb friction coefficient of contacts.

use super::{DuplicatePolicy, Effect, EffectParameters, Motion};
use crate::{
    elements::Elements,
    obstacles::Surface,
    quantity::{FrictionCoefficient, Quantity},
};
use serde::{Deserialize, Serialize};

/// Coulomb friction at walls, obstacles and edges of the world: the tangential impulse of a contact is at most mu times the
/// normal one. Below that a vertex sticks; above it slides, slowed by mu times the normal force.
///
/// Each contact answers for itself, by the impulse that stops the vertex in this step. With implicit schemes, which solve for
/// the rest of the body with such vertices held, this is exact for bodies that hardly deform within a step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Friction {
    /// mu.
    pub coefficient: FrictionCoefficient,
}

impl Default for Friction {
    fn default() -> Self {
        Self { coefficient: FrictionCoefficient::literal(0.4) }
    }
}

impl EffectParameters for Friction {
    fn title(&self) -> &'static str {
        "Friction"
    }

    fn about(&self) -> &'static str {
        "|f_t| ≤ μ f_n where a vertex touches a wall or the domain boundary: below that it sticks, above it slides."
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.coefficient]
    }

    fn duplicate_policy(&self) -> DuplicatePolicy {
        DuplicatePolicy::Ambiguous("a contact has one coefficient")
    }

    fn build(&self, _: &Elements) -> Result<Box<dyn Effect>, String> {
        Ok(Box::new(FrictionEffect(self.coefficient.get())))
    }
}

/// mu.
struct FrictionEffect(f64);

impl Effect for FrictionEffect {
    fn name(&self) -> &'static str {
        "Friction"
    }

    fn elements(&self, _: Motion<'_>) -> usize {
        0
    }

    fn is_surface_effect(&self) -> bool {
        true
    }

    fn set_surface(&self, surface: &mut Surface) {
        surface.friction = self.0;
    }
}
