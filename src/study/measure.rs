//! Quantities that are compared between meshes.

use crate::scene::Scene;

/// Quantity that is compared between meshes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Measure {
    /// Greatest displacement of any vertex from its rest position along x or y [m]: the tip deflection of a bar.
    #[default]
    TipDeflection,
    /// Elastic energy of all elements [J].
    ElasticEnergy,
}

impl Measure {
    /// All quantities.
    pub const ALL: [Self; 2] = [Self::TipDeflection, Self::ElasticEnergy];

    /// Name in plain words.
    pub const fn title(self) -> &'static str {
        match self {
            Self::TipDeflection => "tip deflection",
            Self::ElasticEnergy => "elastic energy",
        }
    }

    /// Unit.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::TipDeflection => "m",
            Self::ElasticEnergy => "J",
        }
    }

    /// Value at given positions of a scene.
    pub fn of(self, scene: &Scene, x: &[f64]) -> f64 {
        match self {
            Self::TipDeflection => x.iter().zip(&scene.rest).map(|(x, rest)| (x - rest).abs()).fold(0.0, f64::max),
            Self::ElasticEnergy => scene.bodies.iter().map(|body| body.elements.elastic_energy(x)).sum(),
        }
    }
}
