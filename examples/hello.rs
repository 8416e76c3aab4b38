//! A gingerbread man falls for half a second, and his energies are printed: `cargo run --example hello`.

use gingerbread::{
    effects::Gravity,
    level::{BodyLevel, Level, MassLevel},
    materials::MaterialParameters,
    meshes::{Gingerbread, NoFiles},
    quantity::Density,
    scene::Scene,
    simulation::Simulation,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mass = MassLevel::Density(Density::new(100.0)?);
    let man = BodyLevel::new("man", Gingerbread::default(), MaterialParameters::default(), mass);
    let level = Level::new("Fall").with_body(man).with_effect(Gravity::default());
    let scene = Scene::build(&level, level.mode, &NoFiles, None)?;
    let steps_per_frame = u64::from(level.substeps.get());
    let mut simulation = Simulation::open(scene, &level, level.mode)?;
    for _ in 0..30 {
        simulation.advance(steps_per_frame, &mut || true);
        let energies = simulation.energies();
        println!(
            "{:.3} s: {:10.3} J kinetic, {:10.3} J in all",
            simulation.state().time,
            energies.kinetic,
            energies.total()
        );
    }
    Ok(())
}
