//! Effect: Coulomb friction coefficient of contacts.

use super::{DuplicatePolicy, Effect, EffectParameters, Motion};
use crate::{
    contact::ContactProperties,
    elements::Elements,
    quantity::{FrictionCoefficient, Quantity},
};
use serde::{Deserialize, Serialize};

/// Coulomb friction wherever something touches: the tangential force of a contact is at most mu times the normal one. Below that a
/// contact sticks, by an elastic spring ([`crate::contact::Anchor`]); above it slides, slowed by mu times the normal force.
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
        "|f_t| ≤ μ f_n where something touches: below that it sticks, above it slides."
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

    fn set_properties(&self, properties: &mut ContactProperties) {
        properties.friction = Some(self.0);
    }
}
