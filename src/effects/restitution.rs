//! Effect: coefficient of restitution of contacts.

use super::{DuplicatePolicy, Effect, EffectParameters, Motion};
use crate::{
    contact::ContactProperties,
    elements::Elements,
    quantity::{Quantity, RestitutionCoefficient},
};
use serde::{Deserialize, Serialize};

/// Restitution of a contact: a rigid mass that hits a skin at its impact speed ([`super::Contact`]) leaves it at e times that
/// speed. It sets the dissipation of the skin ([`crate::contact::dissipation`]).
///
/// A body also bounces by its own elasticity, more so if less of its mass is in contact.
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
        "v'·n = −e v·n for a rigid mass at the impact speed of the skin; a body bounces by its own elasticity as well."
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.coefficient]
    }

    fn duplicate_policy(&self) -> DuplicatePolicy {
        DuplicatePolicy::Ambiguous("a contact has one coefficient")
    }

    fn build(&self, _: &Elements) -> Result<Box<dyn Effect>, String> {
        Ok(Box::new(RestitutionEffect(self.coefficient.get())))
    }
}

/// e.
struct RestitutionEffect(f64);

impl Effect for RestitutionEffect {
    fn name(&self) -> &'static str {
        "Restitution"
    }

    fn elements(&self, _: Motion<'_>) -> usize {
        0
    }

    fn set_properties(&self, properties: &mut ContactProperties) {
        properties.restitution = Some(self.0);
    }
}
