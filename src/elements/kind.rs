//! Kinds of elements of a body in the plane.

use serde::{Deserialize, Serialize};

/// How displacements are interpolated in the triangles of a body.
///
/// Elements of six nodes have one at each corner and one in the middle of each side. Where a mesh is used for them, each of its triangles
/// is divided into four, whose vertices are these nodes. The four are drawn, touch others and carry the masses; see
/// [`SixNodes`](super::SixNodes).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum ElementKind {
    /// Linear in each triangle, so that F is constant there.
    #[default]
    Linear,
    /// Each triangle is divided into four, and displacements are linear in each of them. The energy that resists changes of volume is that of the mean
    /// change over the four.
    MeanDilatation,
    /// Quadratic in each triangle, which has six nodes. It is divided into four for all but its elasticity.
    Quadratic,
}

impl ElementKind {
    /// All kinds, in the order of the menu.
    pub const ALL: [Self; 3] = [Self::Linear, Self::MeanDilatation, Self::Quadratic];

    /// Name in the menu.
    pub const fn title(self) -> &'static str {
        match self {
            Self::Linear => "Linear",
            Self::MeanDilatation => "Mean dilatation",
            Self::Quadratic => "Quadratic",
        }
    }

    /// What it is good for, in a few sentences.
    pub const fn about(self) -> &'static str {
        match self {
            Self::Linear => {
                "Linear displacements in each triangle. The cheapest; too stiff in bending, and it locks where Poisson's ratio is near 0.5."
            }
            Self::MeanDilatation => {
                "Each triangle is divided into four, with linear displacements. Only the mean change of volume of the four is resisted as such, so that they do not lock where Poisson's ratio is near 0.5."
            }
            Self::Quadratic => {
                "Each triangle has nodes in the middle of its sides too, and quadratic displacements: exact in bending. Errors shrink faster on finer meshes; under distributed loads as those of the others, but from a smaller one."
            }
        }
    }

    /// Whether each triangle of a mesh is divided into four.
    pub const fn has_six_nodes(self) -> bool {
        !matches!(self, Self::Linear)
    }
}
