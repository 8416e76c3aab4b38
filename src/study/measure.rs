//! Quantities that are compared between meshes.

use crate::scene::Scene;

/// What is compared between meshes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Measure {
    /// Greatest displacement of any vertex from its rest position along x or y: the tip of a bar.
    #[default]
    TipDeflection,
    /// What all elements store.
    ElasticEnergy,
}

impl Measure {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::TipDeflection, Self::ElasticEnergy];

    /// In words.
    pub const fn title(self) -> &'static str {
        match self {
            Self::TipDeflection => "tip deflection",
            Self::ElasticEnergy => "elastic energy",
        }
    }

    /// Its unit.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::TipDeflection => "m",
            Self::ElasticEnergy => "J",
        }
    }

    /// Its value at positions of a scene.
    pub fn of(self, scene: &Scene, x: &[f64]) -> f64 {
        match self {
            Self::TipDeflection => x.iter().zip(&scene.rest).map(|(x, rest)| (x - rest).abs()).fold(0.0, f64::max),
            Self::ElasticEnergy => scene.bodies.iter().map(|body| body.elements.elastic_energy(x)).sum(),
        }
    }
}
