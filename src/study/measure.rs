//! Quantities that are compared between meshes.

use crate::scene::{Body, Scene};

/// Quantity that is compared between meshes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Measure {
    /// Greatest displacement of any vertex from its rest position along x or y \[m\]: the tip deflection of a bar.
    #[default]
    TipDeflection,
    /// Elastic energy of all elements \[J\].
    ElasticEnergy,
    /// Greatest von Mises stress of all triangles of bodies \[Pa\].
    GreatestStress,
}

impl Measure {
    /// All quantities.
    pub const ALL: [Self; 3] = [Self::TipDeflection, Self::ElasticEnergy, Self::GreatestStress];

    /// Name in plain words.
    pub const fn title(self) -> &'static str {
        match self {
            Self::TipDeflection => "tip deflection",
            Self::ElasticEnergy => "elastic energy",
            Self::GreatestStress => "greatest stress",
        }
    }

    /// Unit.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::TipDeflection => "m",
            Self::ElasticEnergy => "J",
            Self::GreatestStress => "Pa",
        }
    }

    /// Value at given positions of a scene.
    pub fn of(self, scene: &Scene, x: &[f64]) -> f64 {
        match self {
            Self::TipDeflection => x.iter().zip(&scene.rest).map(|(x, rest)| (x - rest).abs()).fold(0.0, f64::max),
            Self::ElasticEnergy => scene.bodies.iter().map(|body| body.elements.elastic_energy(x)).sum(),
            Self::GreatestStress => {
                let of_body = |body: &Body| {
                    let all =
                        (0..body.elements.corners().len()).map(|triangle| body.elements.point_stress(x, triangle));
                    all.map(|point| point.von_mises).fold(0.0, f64::max)
                };
                scene.bodies.iter().map(of_body).fold(0.0, f64::max)
            }
        }
    }
}
