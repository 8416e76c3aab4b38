//! Geometry of a contact.

use super::{ContactName, ContactParameters, Curvature, Members, Place, Touch};

/// Geometry of a contact, as in [`Touch`].
pub(super) struct Stencil<const D: usize = 2, const T: usize = 1, const N: usize = 3> {
    pub weights: [f64; N],
    pub normal: [f64; D],
    pub slips: [[[f64; D]; T]; N],
    pub distance: f64,
    pub curvature: Curvature,
    pub place: Place<D>,
    /// Distance at which what the point belongs to begins \[m\].
    pub radius: f64,
    /// Share of the area: negative for a term that others count twice.
    pub share: f64,
    /// Derivatives of the share by the positions [1/m].
    pub share_gradient: Option<[[f64; D]; N]>,
}

impl<const D: usize, const T: usize, const N: usize> Stencil<D, T, N> {
    /// A contact with this geometry, without velocities and memory.
    pub fn touch(
        self,
        name: ContactName,
        (vertices, members): ([u32; N], Members),
        area: f64,
        parameters: ContactParameters,
    ) -> Touch<D, T, N> {
        let Self { weights, normal, slips, distance, curvature, place, radius, share, share_gradient } = self;
        Touch {
            name,
            vertices,
            members,
            weights,
            normal,
            slips,
            area: share * area,
            area_gradient: share_gradient.map(|all| all.map(|one| one.map(|slope| area * slope))),
            parameters,
            gap: distance - radius,
            distance,
            approach: 0.0,
            sliding: [0.0; T],
            span: 0.0,
            obstacle_velocity: [0.0; D],
            curvature,
            place,
            memory: None,
            kept: None,
            keeps_anchor: share * area > 0.0,
        }
    }
}
