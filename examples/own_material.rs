//! A material of one's own, Ogden's with one term, and a man made of it: `cargo run --example own_material`.

use gingerbread::{
    effects::Gravity,
    elements::OwnMaterial,
    level::{BodyLevel, Level, MassLevel, Pin},
    materials::{Lame, MaterialParameters, Principal, PrincipalEnergy},
    meshes::{Gingerbread, NoFiles},
    quantity::Density,
    scene::Scene,
    simd::Real,
    simulation::Simulation,
};

/// Compressible Ogden material with one term (Ogden, *Proceedings of the Royal Society A* 328, 1972):
/// `psi = 2 mu/a² (s1^a + s2^a + s3^a - 3) - 2 mu/a ln J + lambda/2 ln² J`, `J = s1 s2 s3`.
#[derive(Clone, Copy, Debug)]
pub struct Ogden {
    /// mu and lambda [Pa].
    pub lame: Lame,
    /// The exponent a; 2 is neo-Hookean.
    pub exponent: f64,
}

impl PrincipalEnergy for Ogden {
    const TITLE: &'static str = "Ogden";
    const FORMULA: &'static str = "ψ = 2μ/a² (s₁ᵃ + s₂ᵃ + s₃ᵃ − 3) − 2μ/a ln J + λ/2 ln² J";
    const BARRIER: bool = true;

    fn psi<R: Real>(&self, stretches: [R; 3]) -> R {
        let Self { lame: Lame { mu, lambda }, exponent: a } = *self;
        let [first, second, third] = stretches;
        let log = (first * second * third).logarithm();
        let powers = first.power(a) + second.power(a) + third.power(a) - 3.0;
        powers * (2.0 * mu / (a * a)) - log * (2.0 * mu / a) + log * log * (0.5 * lambda)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let ogden = OwnMaterial::new(|lame| Principal(Ogden { lame, exponent: 8.0 }));
    let mass = MassLevel::Density(Density::new(100.0)?);
    let man = BodyLevel::new("man", Gingerbread::default(), MaterialParameters::default(), mass);
    let man = BodyLevel { own_material: Some(ogden), pins: vec![Pin::Top], ..man };
    let level = Level::new("Hanging").with_body(man).with_effect(Gravity::default());
    let scene = Scene::build(&level, level.mode, &NoFiles, None)?;
    let mut simulation = Simulation::open(scene, &level, level.mode)?;
    for _ in 0..10 {
        simulation.advance(6 * u64::from(level.substeps.get()), &mut || true);
        println!("{:.1} s: {:8.3} J elastic", simulation.state().time, simulation.energies().elastic);
    }
    simulation.fault().map_or(Ok(()), |fault| Err(fault.to_string().into()))
}
