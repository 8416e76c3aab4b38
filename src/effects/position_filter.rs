//! Effect: contact by a filter of positions instead of a potential.

use super::{DuplicatePolicy, Effect, EffectParameters, Motion};
use crate::{
    contact::{ContactProperties, Filter},
    elements::Elements,
    quantity::Quantity,
};
use serde::{Deserialize, Serialize};

/// Contact with walls by a correction of positions after each step, as in the cloth of Princeton's course COS 426: a vertex within the contact
/// margin of an obstacle is put at `mu p + (1 - mu) n`, where n is the nearest point at the margin, p the position before the step, moved along with the
/// obstacle, and mu the coefficient of [`super::Friction`]; see [`crate::contact::ObstacleTerm::filter`].
///
/// It has no limit on the step. It has no energy and does not follow Coulomb's law, bodies do not touch each other, and what moves farther than an obstacle
/// is thick in one step passes through it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PositionFilter {}

impl EffectParameters for PositionFilter {
    fn title(&self) -> &'static str {
        "Position filter"
    }

    fn about(&self) -> &'static str {
        "Contact with obstacles without a potential: after each step a vertex within ε of an obstacle is put at μ p + (1 − μ) n, between its last place and the nearest point at the margin. Bodies do not touch each other."
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        Vec::new()
    }

    fn duplicate_policy(&self) -> DuplicatePolicy {
        DuplicatePolicy::Odd("one is enough")
    }

    fn build(&self, _: &Elements) -> Result<Box<dyn Effect>, String> {
        Ok(Box::new(PositionFilterEffect))
    }
}

struct PositionFilterEffect;

impl Effect for PositionFilterEffect {
    fn name(&self) -> &'static str {
        "Position filter"
    }

    fn elements(&self, _: Motion<'_>) -> usize {
        0
    }

    fn set_properties(&self, properties: &mut ContactProperties) {
        properties.filter = Some(Filter::Position);
    }
}
