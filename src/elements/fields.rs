//! Fields for the colour of triangles.

use super::Triangles;

/// Field that triangles are coloured by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Field {
    /// Plain gingerbread.
    #[default]
    None,
    /// Elastic energy density psi [J/m²].
    EnergyDensity,
    /// Von Mises equivalent of the Cauchy stress [Pa].
    VonMises,
    /// J = det F: area over rest area.
    Volume,
}

impl Field {
    /// All of them, in the order of the menu.
    pub const ALL: [Self; 4] = [Self::None, Self::EnergyDensity, Self::VonMises, Self::Volume];

    /// Name in the menu.
    pub const fn title(self) -> &'static str {
        match self {
            Self::None => "Gingerbread",
            Self::EnergyDensity => "Energy density",
            Self::VonMises => "Von Mises stress",
            Self::Volume => "Area ratio J",
        }
    }

    /// Unit symbol.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::None | Self::Volume => "",
            Self::EnergyDensity => "J/m²",
            Self::VonMises => "Pa",
        }
    }
}

impl Triangles {
    /// det F of each triangle.
    pub fn volume_ratios(&self, x: &[f64]) -> impl Iterator<Item = f64> {
        self.gradients(x).map(|(f, _)| f.determinant())
    }
}
