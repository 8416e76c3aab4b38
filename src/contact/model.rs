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
    /// What takes the place of the potential.
    pub filter: Option<Filter>,
}

/// A rule of the originals for obstacles, which acts after each step in place of a potential.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filter {
    /// Of velocities.
    Velocity,
    /// Of positions.
    Position,
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
    /// How obstacles act instead of by the potential of the skin.
    pub filter: Option<Filter>,
}

impl From<ContactProperties> for ContactModel {
    /// The dissipation of the skin is its own and that which leaves the restitution at its impact speed.
    fn from(properties: ContactProperties) -> Self {
        let ContactProperties { skin, friction, apart, restitution, filter } = properties;
        let mut skin = skin.unwrap_or_else(|| effects::Contact::default().skin());
        skin.dissipation += restitution.map_or(0.0, |restitution| dissipation(restitution, skin.speed));
        let (friction, restitution) = (friction.unwrap_or_default(), restitution.unwrap_or(0.0));
        Self { skin, friction, apart, restitution, filter }
    }
}

impl Default for ContactModel {
    fn default() -> Self {
        ContactProperties::default().into()
    }
}
