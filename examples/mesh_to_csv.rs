//! Reads a mesh from a Wavefront OBJ file, lets it hang by its top for a second, and prints its vertices as CSV:
//! `cargo run --example mesh_to_csv [FILE.obj]`. Without a file it writes a small one and reads that.

use gingerbread::{
    effects::{Gravity, Rayleigh},
    files::Disk,
    level::{BodyLevel, Level, MassLevel, Pin},
    materials::MaterialParameters,
    meshes::Obj,
    quantity::Density,
    scene::Scene,
    simulation::Simulation,
};
use std::{env, fs, path::PathBuf};

const SQUARE: &str = "v 0 0\nv 1 0\nv 1 1\nv 0 1\nf 1 2 3\nf 1 3 4\n";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let given = env::args_os().nth(1).map(PathBuf::from);
    let path = given.clone().unwrap_or_else(|| env::temp_dir().join(format!("square_{}.obj", std::process::id())));
    if given.is_none() {
        fs::write(&path, SQUARE)?;
    }
    let mass = MassLevel::Density(Density::new(100.0)?);
    let mesh = Obj { path: path.clone() };
    let body = BodyLevel { pins: vec![Pin::Top], ..BodyLevel::new("body", mesh, MaterialParameters::default(), mass) };
    let level = Level::new("Hanging").with_body(body).with_effect(Gravity::default()).with_effect(Rayleigh::default());
    let scene = Scene::build(&level, level.mode, &Disk, None);
    if given.is_none() {
        fs::remove_file(&path)?;
    }
    let mut simulation = Simulation::open(scene?, &level, level.mode)?;
    simulation.advance(60 * u64::from(level.substeps.get()), &mut || true);
    if let Some(fault) = simulation.fault() {
        return Err(fault.to_string().into());
    }
    println!("vertex,x,y");
    let scene = simulation.scene();
    for (vertex, point) in scene.listed(&simulation.state().x).chunks_exact(2).enumerate() {
        println!("{vertex},{},{}", point[0], point[1]);
    }
    Ok(())
}
