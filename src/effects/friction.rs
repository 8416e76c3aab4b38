//! Effect: Coulomb friction coefficient of contacts.

use super::{DuplicatePolicy, Effect, EffectParameters, Group, Motion};
use crate::{
    contact::{ContactProperties, FrictionRule, FrictionTable, Surface},
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
    /// Surfaces with a coefficient of their own.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub surfaces: Vec<SurfaceFriction>,
}

/// Friction of a body or net with a coefficient of its own. A coefficient for two surfaces comes first; then the least of those for
/// one of them counts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SurfaceFriction {
    /// Name of the body or net.
    pub of: String,
    /// What it touches: the name of a body or net, or `"obstacles"`. Without it: everything.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub on: Option<String>,
    /// mu.
    pub coefficient: FrictionCoefficient,
}

/// Name of all obstacles together.
const OBSTACLES: &str = "obstacles";

impl Default for Friction {
    fn default() -> Self {
        Self { coefficient: FrictionCoefficient::literal(0.4), surfaces: Vec::new() }
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
        self.groups().into_iter().flat_map(|group| group.numbers).collect()
    }

    fn groups(&mut self) -> Vec<Group<'_>> {
        let own = Group { title: None, solid: None, numbers: vec![&mut self.coefficient] };
        let surfaces = self.surfaces.iter_mut().map(|SurfaceFriction { of, on, coefficient }| {
            let title = on.as_ref().map_or_else(|| of.clone(), |on| format!("{of} on {on}"));
            Group { title: Some(title), solid: None, numbers: vec![coefficient] }
        });
        std::iter::once(own).chain(surfaces).collect()
    }

    fn duplicate_policy(&self) -> DuplicatePolicy {
        DuplicatePolicy::Ambiguous("a contact has one coefficient")
    }

    fn build(&self, elements: &Elements) -> Result<Box<dyn Effect>, String> {
        let named = |name: &str| {
            let parts = elements.named(name).map_err(|why| format!("{why}, and {OBSTACLES:?} for all obstacles"))?;
            Ok::<Vec<_>, String>(parts.into_iter().map(Surface::Owner).collect())
        };
        let rule = |listed: &SurfaceFriction| {
            let others = match listed.on.as_deref() {
                None => None,
                Some(OBSTACLES) => Some(vec![Surface::Obstacles]),
                Some(name) => Some(named(name)?),
            };
            Ok::<_, String>(FrictionRule {
                surfaces: named(&listed.of)?,
                others,
                coefficient: listed.coefficient.get(),
            })
        };
        let rules = self.surfaces.iter().map(rule).collect::<Result<_, _>>()?;
        Ok(Box::new(FrictionEffect(FrictionTable { coefficient: self.coefficient.get(), rules })))
    }
}

/// mu.
struct FrictionEffect(FrictionTable);

impl Effect for FrictionEffect {
    fn name(&self) -> &'static str {
        "Friction"
    }

    fn elements(&self, _: Motion<'_>) -> usize {
        0
    }

    fn set_properties(&self, properties: &mut ContactProperties) {
        properties.friction = Some(self.0.clone());
    }
}
