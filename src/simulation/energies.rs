//! Energies of a running scene. The elastic energy, which costs most, is computed once for each shape and shared by all
//! callers.

use super::{Restart, Simulation};
use crate::{
    effects::{Grab, Motion},
    report::Energies,
    scene::Scene,
};
use pulp::Arch;

/// Cached elastic energies.
#[derive(Default)]
pub(super) struct Elastic {
    /// Of each body and then each net \[J\].
    each: Vec<f64>,
    /// Shape number that they belong to.
    shape: Option<u64>,
    /// Number of evaluations for stepping, where drawing had not computed them.
    evaluations: u64,
}

impl Simulation {
    /// Least det F of all triangles (infinite if there are none), and how many have det F <= 0.
    pub fn inversion(&self) -> (f64, usize) {
        let ratios = self.scene.bodies.iter().flat_map(|body| body.elements.volume_ratios(&self.state.x));
        ratios.fold((f64::INFINITY, 0), |(least, count), j| (least.min(j), count + usize::from(j <= 0.0)))
    }

    /// Linear momentum [kg m/s], and angular momentum about the origin of the world [kg m²/s]; in the plane along the third axis alone.
    pub fn momenta(&self) -> [[f64; 3]; 2] {
        let Scene { mass, coupled_mass, dimension, .. } = &self.scene;
        let (x, v) = (&self.state.x, &self.state.v);
        let (mut momentum, mut angular) = ([0.0; 3], coupled_mass.angular_momentum(*dimension, x, v));
        let points = x.chunks_exact(*dimension).zip(v.chunks_exact(*dimension));
        for ((x, v), mass) in points.zip(mass.chunks_exact(*dimension)) {
            let all = |of: &[f64]| [0, 1, 2].map(|axis| of.get(axis).copied().unwrap_or(0.0));
            let ([x, y, z], [vx, vy, vz]) = (all(x), all(v));
            for (sum, part) in momentum.iter_mut().zip([vx, vy, vz]) {
                *sum += mass[0] * part;
            }
            for (sum, part) in angular.iter_mut().zip([y * vz - z * vy, z * vx - x * vz, x * vy - y * vx]) {
                *sum += mass[0] * part;
            }
        }
        [momentum, angular]
    }

    /// Energies now \[J\].
    pub fn energies(&self) -> Energies {
        self.energies_with(self.grab)
    }

    /// Energies now, with another pull \[J\].
    pub(super) fn energies_with(&self, grab: Option<Grab>) -> Energies {
        if let (Some(toy), &[a, b]) = (&self.scene.toy, self.state.x.as_slice()) {
            let [kinetic, potential] = toy.kind().energies([a, b]);
            return Energies { kinetic, potential, ..Energies::default() };
        }
        let motion = self.scene.motion(&self.state, grab);
        if self.elastic.borrow().shape != Some(self.shape) {
            self.set_elastic_energies(elastic_energies(&self.scene, motion));
            self.elastic.borrow_mut().evaluations += 1;
        }
        let elastic = self.elastic.borrow().each.iter().sum();
        energies(&self.scene, motion, self.kinetic_energy(), elastic)
    }

    /// Energies at another moment in the same scene, which is no toy \[J\].
    pub fn energies_at(&self, moment: &Restart) -> Energies {
        let motion = self.scene.motion(&moment.state, moment.grab());
        energies(
            &self.scene,
            motion,
            kinetic_energy(&self.scene, &moment.state.v),
            elastic_energies(&self.scene, motion).sum(),
        )
    }

    /// Kinetic energy \[J\].
    pub(super) fn kinetic_energy(&self) -> f64 {
        kinetic_energy(&self.scene, &self.state.v)
    }

    /// Elastic energy of a body, or after the bodies of a net, if it is cached for the present shape \[J\].
    pub fn known_energy(&self, number: usize) -> Option<f64> {
        let elastic = self.elastic.borrow();
        elastic.each.get(number).copied().filter(|_| elastic.shape == Some(self.shape))
    }

    /// Stores the elastic energies of the present shape \[J\]: of each body and then each net.
    pub(crate) fn set_elastic_energies(&self, energies: impl Iterator<Item = f64>) {
        let mut elastic = self.elastic.borrow_mut();
        elastic.each.clear();
        elastic.each.extend(energies);
        elastic.shape = Some(self.shape);
    }

    /// Shape number; changes with shapes and materials.
    pub const fn shape(&self) -> u64 {
        self.shape
    }

    /// Number of evaluations of the elastic energy for stepping so far; without those that drawing had done.
    pub fn energy_evaluations(&self) -> u64 {
        self.elastic.borrow().evaluations
    }
}

/// Energy of each body and then each net \[J\].
fn elastic_energies(scene: &Scene, motion: Motion<'_>) -> impl Iterator<Item = f64> {
    scene.effects[..scene.element_count()].iter().map(move |effect| effect.energy(motion))
}

/// All energies, with those of the other effects \[J\].
fn energies(scene: &Scene, motion: Motion<'_>, kinetic: f64, elastic: f64) -> Energies {
    let mut energies = Energies { kinetic, elastic, ..Energies::default() };
    for effect in &scene.effects[scene.element_count()..] {
        let kind = if effect.contact().is_some() { &mut energies.contact } else { &mut energies.potential };
        *kind += effect.energy(motion);
    }
    energies
}

/// Kinetic energy at some velocities \[J\].
fn kinetic_energy(scene: &Scene, v: &[f64]) -> f64 {
    // 32 independent sums avoid a chain of dependent additions; their number is the same on every processor, so
    // that the bits are too.
    const SUMS: usize = 32;
    let (speeds, v_rest) = v.as_chunks::<SUMS>();
    let (mass, mass_rest) = scene.mass.as_chunks::<SUMS>();
    let sums = Arch::new().dispatch(|| {
        let mut sums = [0.0; SUMS];
        for (v, mass) in speeds.iter().zip(mass) {
            for ((sum, v), mass) in sums.iter_mut().zip(v).zip(mass) {
                *sum += mass * v * v;
            }
        }
        sums
    });
    let rest = v_rest.iter().zip(mass_rest).map(|(v, mass)| mass * v * v);
    let lumped = 0.5 * sums.into_iter().chain(rest).sum::<f64>();
    lumped + scene.coupled_energy(v)
}
