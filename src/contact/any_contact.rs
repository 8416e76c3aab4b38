//! Contact in the plane or in space, by the calls that know no dimension.

use super::{Anchor, ContactTerm, Pair};
use crate::{
    effects::Motion,
    solvers::{SparseMatrix, Weights},
};

/// A term of contact in the plane or in space.
#[derive(Clone, Copy)]
pub enum AnyContact<'a> {
    /// In the plane.
    Plane(&'a dyn ContactTerm),
    /// In space.
    Space(&'a dyn ContactTerm<3, 2, 4>),
}

macro_rules! forwarded {
    ($($(#[doc = $doc:literal])+ fn $name:ident(&self $(, $argument:ident: $kind:ty)*) $(-> $result:ty)?;)+) => {
        impl AnyContact<'_> {
            $($(#[doc = $doc])+
            pub fn $name(&self $(, $argument: $kind)*) $(-> $result)? {
                match self {
                    Self::Plane(contact) => contact.$name($($argument),*),
                    Self::Space(contact) => contact.$name($($argument),*),
                }
            })+
        }
    };
}

forwarded! {
    /// Reason why nothing can touch, if so.
    fn idle(&self, motion: Motion<'_>) -> Option<&'static str>;
    /// Greatest square of the angular frequency of a vertex on its fully compressed skin [1/s²].
    fn square_frequency(&self, motion: Motion<'_>) -> f64;
    /// Whether the surface that it touches may move by itself.
    fn moves(&self) -> bool;
    /// Sparsity pattern, as [`crate::effects::Effect::sparsity_pattern`], where these pairs of surfaces may be near each other.
    fn sparsity_pattern(&self, pairs: &[Pair], add: &mut dyn FnMut(u32, u32));
    /// Adds the weighted stiffness and damping.
    fn add_stiffness(&self, motion: Motion<'_>, weights: Weights, matrix: &mut dyn SparseMatrix);
    /// Whether a skin is compressed.
    fn touches(&self, motion: Motion<'_>) -> bool;
    /// Power of moving obstacles on the bodies \[W\].
    fn power_of_obstacles(&self, motion: Motion<'_>) -> f64;
    /// Power taken from the motion by dissipation and friction \[W\], and energy that the springs of friction store \[J\].
    fn taken_power(&self, motion: Motion<'_>) -> [f64; 2];
    /// Energy \[J\].
    fn energy(&self, motion: Motion<'_>) -> f64;
    /// Adds the forces \[N\].
    fn force(&self, motion: Motion<'_>, force: &mut [f64]);
    /// Calls `act` for each number of the force on a vertex in contact \[N\], by its place among all coordinates.
    fn each_number(&self, motion: Motion<'_>, act: &mut dyn FnMut(usize, f64));
    /// Adds the product of the stiffness with a displacement \[N\].
    fn stiffness_times(&self, motion: Motion<'_>, d: &[f64], product: &mut [f64]);
    /// Rates of damping, as [`crate::effects::Effect::damping`].
    fn damping(&self, motion: Motion<'_>) -> [f64; 2];
    /// Adds the memory of all contacts after a step of length h \[s\]. Returns the energy that the decrease of initial penetration
    /// supplies \[J\].
    fn drag_anchors(&self, motion: Motion<'_>, h: f64, anchors: &mut Vec<Anchor>) -> f64;
    /// Adds the vertices of contacts in which surfaces have crossed: inside an obstacle or another body.
    fn add_inside(&self, motion: Motion<'_>, vertices: &mut Vec<u32>);
    /// Adds the memory of all contacts of a state that was not stepped to.
    fn add_penetrations(&self, motion: Motion<'_>, anchors: &mut Vec<Anchor>);
}
