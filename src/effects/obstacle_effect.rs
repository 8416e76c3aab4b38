//! Contact with obstacles, as an effect: by the potential of a skin, or by a filter.

use super::{Bounds, Effect, Motion};
use crate::{
    contact::{AnyContact, ContactTerm as _, FacePoints, ObstacleContact, ObstacleTerm, PlacedObstacle},
    elements::Elements,
};

/// Contact with some obstacles, all in the plane or all in space.
pub(super) struct ObstacleEffect {
    name: &'static str,
    contact: Contact,
    /// Whether it acts as a filter instead of a potential.
    is_filter: bool,
}

enum Contact {
    Plane(ObstacleContact),
    Space(ObstacleContact<3, 2, 4>),
}

impl ObstacleEffect {
    /// Contact of a name with some obstacles in the plane.
    pub fn new(name: &'static str, elements: &Elements, obstacles: Vec<PlacedObstacle>) -> Self {
        let contact = ObstacleContact::new(elements.contact.clone(), &elements.surface, obstacles);
        Self { name, contact: Contact::Plane(contact), is_filter: elements.contact.filter.is_some() }
    }

    /// Contact of a name with some obstacles in space. Triangles of membranes touch those at rest between their corners too; nets touch them with their particles
    /// alone, as in the courses that they are from.
    pub fn in_space(name: &'static str, elements: &Elements, obstacles: Vec<PlacedObstacle<3>>) -> Self {
        let contact = ObstacleContact::new(elements.contact.clone(), &elements.surface, obstacles);
        let is_filter = elements.contact.filter.is_some();
        let corners = || elements.membranes.iter().flat_map(|membrane| membrane.corners()).copied();
        let faces = || FacePoints::new(&elements.surface, corners(), &elements.rest);
        let contact = if is_filter { contact } else { contact.with_faces(faces()) };
        Self { name, contact: Contact::Space(contact), is_filter }
    }

    fn term(&self) -> &dyn ObstacleTerm {
        match &self.contact {
            Contact::Plane(contact) => contact,
            Contact::Space(contact) => contact,
        }
    }
}

impl Effect for ObstacleEffect {
    fn name(&self) -> &'static str {
        self.name
    }

    fn dimension(&self) -> Option<usize> {
        Some(match &self.contact {
            Contact::Plane(_) => 2,
            Contact::Space(_) => 3,
        })
    }

    fn elements(&self, motion: Motion<'_>) -> usize {
        self.term().count() * motion.vertices()
    }

    fn set_number(&mut self, number: usize) {
        match &mut self.contact {
            Contact::Plane(contact) => contact.set_number(number),
            Contact::Space(contact) => contact.set_number(number),
        }
    }

    fn contact(&self) -> Option<AnyContact<'_>> {
        let contact = match &self.contact {
            Contact::Plane(contact) => AnyContact::Plane(contact),
            Contact::Space(contact) => AnyContact::Space(contact),
        };
        (!self.is_filter).then_some(contact)
    }

    fn obstacle_contact(&self) -> Option<&dyn ObstacleTerm> {
        Some(self.term())
    }

    /// In space each step looks at the obstacles.
    fn is_clear(&self, swept_bounds: Bounds) -> bool {
        matches!(&self.contact, Contact::Plane(contact) if contact.is_clear(swept_bounds))
    }

    fn is_steady(&self) -> bool {
        !match &self.contact {
            Contact::Plane(contact) => contact.moves(),
            Contact::Space(contact) => contact.moves(),
        }
    }
}
