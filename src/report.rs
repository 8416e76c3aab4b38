//! What stepping cost: counts that tests pin, and clocks that are only shown.

use std::time::Duration;

/// Counts of the steps taken since the scene was built.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Steps taken.
    pub steps: u64,
    /// Evaluations of all forces together.
    pub force_evaluations: u64,
    /// Vertices whose velocity or position an effect changed.
    pub constrained: u64,
}

/// What one effect cost.
#[derive(Clone, Debug, PartialEq)]
pub struct EffectCost {
    /// Name of the effect.
    pub name: &'static str,
    /// Time spent in it; zero unless the simulation was asked to measure.
    pub time: Duration,
    /// How often it was called.
    pub calls: u64,
    /// Elements (vertices, triangles, ...) touched, summed over the calls.
    pub elements: u64,
}

/// Energies of a scene [J].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energies {
    /// Of motion.
    pub kinetic: f64,
    /// Of deformation.
    pub elastic: f64,
    /// Of everything else that stores: gravity, the mouse spring.
    pub potential: f64,
}

impl Energies {
    /// The sum [J].
    pub fn total(self) -> f64 {
        self.kinetic + self.elastic + self.potential
    }
}
