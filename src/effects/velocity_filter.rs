//! Effect: contact by a velocity filter instead of a potential.

use super::{DuplicatePolicy, Effect, EffectParameters, Motion};
use crate::{
    contact::{ContactProperties, Filter},
    elements::Elements,
    quantity::Quantity,
};
use serde::{Deserialize, Serialize};

/// Contact with walls and the domain boundary by a filter after each step, as in the first version of this program: a vertex
/// within the contact margin of an obstacle loses its velocity towards it, and one inside is put on the surface; see
/// [`crate::contact::ObstacleTerm::filter`].
///
/// It is simple and has no limit of its own on the step. It has no energy, so that no scheme keeps its order through an impact,
/// bodies do not touch each other, and what moves farther than an obstacle is thick in one step passes through it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VelocityFilter {}

impl EffectParameters for VelocityFilter {
    fn title(&self) -> &'static str {
        "Velocity filter"
    }

    fn about(&self) -> &'static str {
        "Contact with obstacles without a potential: after each step v := v − min(0, v·n) n for a vertex within ε of an obstacle, and a vertex inside is put on the surface. Bodies do not touch each other."
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        Vec::new()
    }

    fn duplicate_policy(&self) -> DuplicatePolicy {
        DuplicatePolicy::Odd("one is enough")
    }

    fn build(&self, _: &Elements) -> Result<Box<dyn Effect>, String> {
        Ok(Box::new(VelocityFilterEffect))
    }
}

struct VelocityFilterEffect;

impl Effect for VelocityFilterEffect {
    fn name(&self) -> &'static str {
        "Velocity filter"
    }

    fn elements(&self, _: Motion<'_>) -> usize {
        0
    }

    fn set_properties(&self, properties: &mut ContactProperties) {
        properties.filter = Some(Filter::Velocity);
    }
}
