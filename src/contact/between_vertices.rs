//! Contact of surfaces with obstacles between two vertices.

use super::{Met, Path, Touch};
use crate::{
    effects::Motion,
    obstacles::SweptMotion,
    solvers::{SparseMatrix, Weights},
};

/// What touches obstacles between the vertices of a surface: in the plane edges, at convex corners; in space triangles of membranes, at some of
/// their points.
pub trait BetweenVertices<const D: usize, const T: usize, const N: usize> {
    /// Calls `act` for each touch.
    fn each_between(&self, motion: Motion<'_>, act: &mut dyn FnMut(&Touch<D, T, N>));

    /// Calls `act` for each touch that only a state has which no step led to.
    fn each_between_inside(&self, _motion: Motion<'_>, _act: &mut dyn FnMut(&Touch<D, T, N>)) {}

    /// Calls `add` for each two vertices that these touches may connect.
    fn between_pattern(&self, add: &mut dyn FnMut(u32, u32));

    /// Adds the weighted stiffness and damping of these touches, in the order of [`Self::between_pattern`].
    fn add_between_stiffness(&self, motion: Motion<'_>, weights: Weights, matrix: &mut dyn SparseMatrix);

    /// Calls `act` with what may meet an obstacle on a path: an edge and the number of a corner, or a triangle and the number of its point. With
    /// `is_short`, only what touches at the start can.
    fn each_candidate_between(
        &self,
        path: &Path<'_>,
        obstacle: (usize, &SweptMotion<D>, bool),
        act: &mut dyn FnMut(u32, u32),
    );

    /// How such a candidate comes too near to the obstacle, if it does.
    fn find_between(
        &self,
        path: &Path<'_>,
        obstacle: (usize, &SweptMotion<D>),
        candidate: (u32, u32),
    ) -> Option<Met<D>>;

    /// The obstacle of a contact by the number of its surface, and what touches there: zero for a vertex, and from one on the corners of the obstacle, or the
    /// points of a triangle.
    fn split_surface(&self, surface: u32) -> Option<(usize, u32)>;

    /// The number of the surface of a contact by these; `None` if there is no such.
    fn join_surface(&self, obstacle: usize, part: u32) -> Option<u32>;

    /// Share of the skin of the vertices of a part that touches an obstacle between them.
    fn share_between(&self, _obstacle: usize, _part: u32) -> f64 {
        0.0
    }

    /// Area of the skin of a vertex and of what touches between it and its neighbours \[m²\].
    fn area_around(&self, vertex: u32, part: u32, own: f64) -> f64;
}
