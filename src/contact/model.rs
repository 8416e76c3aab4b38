//! How surfaces touch: properties that effects set, and the model that follows from them.

use super::{FrictionTable, Skin, potential::dissipation};
use crate::effects;

/// Properties of contacts that effects set.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ContactProperties {
    /// Skin of all bodies.
    pub skin: Option<Skin>,
    /// mu.
    pub friction: Option<FrictionTable>,
    /// Bodies and nets that do not touch each other, by their numbers: bodies first.
    pub apart: Vec<[usize; 2]>,
    /// e.
    pub restitution: Option<f64>,
    /// Whether a velocity filter takes the place of the potential.
    pub is_filter: bool,
}

/// How surfaces touch.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactModel {
    /// Skin of all bodies.
    pub skin: Skin,
    /// mu.
    pub friction: FrictionTable,
    /// Bodies and nets that do not touch each other, by their numbers: bodies first.
    pub apart: Vec<[usize; 2]>,
    /// e of the velocity filter; that of the skin is in its dissipation.
    pub restitution: f64,
    /// Whether obstacles act by a velocity filter instead of the potential of the skin.
    pub is_filter: bool,
}

impl From<ContactProperties> for ContactModel {
    /// The dissipation of the skin is its own and that which leaves the restitution at its impact speed.
    fn from(properties: ContactProperties) -> Self {
        let ContactProperties { skin, friction, apart, restitution, is_filter } = properties;
        let mut skin = skin.unwrap_or_else(|| effects::Contact::default().skin());
        skin.dissipation += restitution.map_or(0.0, |restitution| dissipation(restitution, skin.speed));
        let (friction, restitution) = (friction.unwrap_or_default(), restitution.unwrap_or(0.0));
        Self { skin, friction, apart, restitution, is_filter }
    }
}

impl Default for ContactModel {
    fn default() -> Self {
        ContactProperties::default().into()
    }
}
