//! Memory of contacts: friction by an elastic-plastic spring to an anchor on the surface, and initial penetration.

use super::{Potential, touch::length};

/// A contact by name: a vertex, and the surface that it touches.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct ContactName {
    /// Number of the effect that the surface belongs to.
    pub effect: u32,
    /// Number of the obstacle in the effect, of the edge of a boundary, or of the triangle of cloth; beyond these that of two edges of cloth.
    pub surface: u32,
    /// The vertex.
    pub vertex: u32,
}

/// State of a contact between steps: the anchor of the spring of friction, and the initial penetration.
///
/// A vertex that is placed in the skin or in an obstacle, not moved there by steps, has no force at first: its initial penetration
/// is added to the gap. It then decreases at a tenth of the wave speed until the surfaces are apart, so that the pressure grows slowly.
///
/// With the tangential displacement u from the anchor, the friction of an area A with pressure p, of which the potential
/// gives q, is `T = -clip(A (k u + c q v), mu A p)`: k is the
/// [tangential stiffness](Potential::tangential_stiffness) and v the sliding velocity, so that sticking is elastic and damped like the pressure, and sliding is Coulomb's law. The anchor does not move within a step, so
/// that forces are smooth there. After the step it is dragged until `k |u| <= mu p`, and lost where the contact ends
/// (a Dahl model; Canudas de Wit et al., *A New Model for Control of Systems with Friction*, IEEE Transactions on Automatic
/// Control 40, 1995). Coulomb's law smoothed by velocity would creep under any load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Anchor {
    /// The contact.
    pub contact: ContactName,
    /// The anchor \[m\]: a point in the frame of the obstacle, a length along the loop of a boundary at rest, zeros beyond, or a point of
    /// the plane of a triangle of cloth at rest. Of two edges, the positions along both.
    pub point: [f64; 3],
    /// Rest of the initial penetration \[m\]; it is added to the gap.
    pub penetration: f64,
}

impl Potential {
    /// Energy of the spring of friction per area [J/m²].
    pub(super) fn friction_energy<const T: usize>(self, u: [f64; T], limit: f64) -> f64 {
        let u = size(self.dragged(u, limit));
        0.5 * self.tangential_stiffness() * u * u
    }

    /// Displacement from the anchor after it was dragged \[m\].
    pub(super) fn dragged<const T: usize>(self, u: [f64; T], limit: f64) -> [f64; T] {
        let most = limit / self.tangential_stiffness();
        limited(u, most)
    }
}

/// Length of a vector of one component or more.
pub(super) fn size<const T: usize>(vector: [f64; T]) -> f64 {
    if let [value] = vector[..] { value.abs() } else { length(vector) }
}

/// A vector of at most this length. A limit that is not a number, as in a state that has exploded, does not matter.
pub(super) fn limited<const T: usize>(vector: [f64; T], limit: f64) -> [f64; T] {
    let size = size(vector);
    // Along one direction the quotient is one or less one.
    if size > limit { vector.map(|value| limit * (value / size)) } else { vector }
}

/// The anchor of a contact, if it has one.
pub(super) fn anchor_of(anchors: &[Anchor], name: ContactName) -> Option<Anchor> {
    anchors.binary_search_by(|anchor| anchor.contact.cmp(&name)).ok().map(|at| anchors[at])
}

/// The anchors of the contacts of an effect.
pub(super) fn anchors_of(anchors: &[Anchor], effect: u32) -> &[Anchor] {
    let place = |effect: u32| anchors.partition_point(|anchor| anchor.contact.effect < effect);
    &anchors[place(effect)..place(effect + 1)]
}

/// Initial penetration of a contact with a boundary \[m\]: its own, or the greatest of its neighbours.
pub(super) fn penetration_of([own, before, after]: [Option<Anchor>; 3]) -> f64 {
    let of = |anchor: Option<Anchor>| anchor.map_or(0.0, |anchor| anchor.penetration);
    own.map_or_else(|| of(before).max(of(after)), |anchor| anchor.penetration)
}
