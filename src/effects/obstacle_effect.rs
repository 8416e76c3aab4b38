//! Contact with obstacles, as an effect: by the potential of a skin, or by a velocity filter.

use super::{Bounds, Effect, Motion};
use crate::{
    contact::{ContactTerm, ObstacleContact, PlacedObstacle},
    elements::Elements,
};

/// Contact with some obstacles.
pub(super) struct ObstacleEffect {
    name: &'static str,
    contact: ObstacleContact,
    /// Whether it acts as a filter instead of a potential.
    is_filter: bool,
}

impl ObstacleEffect {
    /// Contact of a name with some obstacles.
    pub fn new(name: &'static str, elements: &Elements, obstacles: Vec<PlacedObstacle>) -> Self {
        let contact = ObstacleContact::new(elements.contact.clone(), &elements.surface, obstacles);
        Self { name, contact, is_filter: elements.contact.is_filter }
    }
}

impl Effect for ObstacleEffect {
    fn name(&self) -> &'static str {
        self.name
    }

    fn dimension(&self) -> Option<usize> {
        Some(2)
    }

    fn elements(&self, motion: Motion<'_>) -> usize {
        self.contact.obstacles().len() * motion.x.len() / 2
    }

    fn set_number(&mut self, number: usize) {
        self.contact.set_number(number);
    }

    fn contact(&self) -> Option<&dyn ContactTerm> {
        (!self.is_filter).then_some(&self.contact as &dyn ContactTerm)
    }

    fn obstacle_contact(&self) -> Option<&ObstacleContact> {
        Some(&self.contact)
    }

    fn is_clear(&self, swept_bounds: Bounds) -> bool {
        self.contact.is_clear(swept_bounds)
    }

    fn is_steady(&self) -> bool {
        !self.contact.moves()
    }
}
