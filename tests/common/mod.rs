//! What several test files share: random numbers that are the same on every run, and small scenes.
#![allow(dead_code, clippy::unwrap_used, reason = "each test file uses its own part, and a failing test should panic")]

pub mod physics;
pub mod studies;
pub mod systems;

use gingerbread::{
    files,
    level::{Level, RunMode},
    levels::built_in,
    materials::{MaterialParameters, Model, Plane},
    meshes::NoFiles,
    quantity::{Poisson, Young},
    sandbox::Sandbox,
    scene::Scene,
    simulation::Simulation,
    snapshot::{Field, Snapshot},
};
use nalgebra::Matrix2;

/// A fixed stream of irregular numbers (`SplitMix64`).
pub struct Random(pub u64);

impl Random {
    /// Uniform in [low, high).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        low + (high - low) * ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A matrix with entries in [-2, 2) and a determinant in the range.
    pub fn gradient(&mut self, least: f64, greatest: f64) -> Matrix2<f64> {
        loop {
            let f = Matrix2::from_fn(|_, _| self.between(-2.0, 2.0));
            if (least..=greatest).contains(&f.determinant()) {
                return f;
            }
        }
    }
}

/// A rotation by an angle [rad].
pub fn rotation(angle: f64) -> Matrix2<f64> {
    Matrix2::new(angle.cos(), -angle.sin(), angle.sin(), angle.cos())
}

/// A level from its text.
pub fn level(text: &str) -> Level {
    files::parse(text, "test.ron").unwrap()
}

/// A simulation of a level in its own mode.
pub fn simulation(level: &Level) -> Simulation {
    let scene = Scene::build(level, level.mode, &NoFiles, None).unwrap();
    let state = scene.first_state(level.state.as_ref()).unwrap();
    Simulation::new(scene, state)
}

/// A sandbox with a built-in level.
pub fn opened(name: &str) -> Sandbox {
    let level = files::parse(built_in(name).unwrap(), name).unwrap();
    Sandbox::new(level, Box::new(NoFiles)).unwrap()
}

/// What a window would draw of it, without colours.
pub fn seen(sandbox: &Sandbox) -> Snapshot {
    let mut snapshot = Snapshot::default();
    sandbox.snapshot(Field::None, &mut snapshot);
    snapshot
}

/// A soft corotated material.
pub fn material(young: f64) -> MaterialParameters {
    let (young, poisson) = (Young::new(young).unwrap(), Poisson::new(0.2).unwrap());
    MaterialParameters::new(Model::Corotated, young, poisson, Plane::Strain).unwrap()
}

/// A scene of one small square sheet of 2 x 4 x 4 triangles, with more fields of the body and the level.
pub fn sheet(model: &str, body: &str, rest: &str) -> Level {
    level(&format!(
        "(name: \"sheet\", bodies: [(name: \"sheet\",
            mesh: Rectangle(width: 0.4, height: 0.4, columns: 4, rows: 4, diagonals: Alternating, corner: (0.3, 0.3)),
            material: (model: {model}, young: 100, poisson: 0.3, plane: Strain), mass: Density(1), {body})], {rest})"
    ))
}

/// A small sheet that is let go from a smooth stretch.
pub fn released(rest: &str) -> Level {
    released_of(1000, rest)
}

/// The same, of a stuff of this Young's modulus.
pub fn released_of(young: u32, rest: &str) -> Level {
    level(&format!(
        "(name: \"released\", substeps: 20, bodies: [(name: \"sheet\", stretch: (1.1, 0.95), mass: Density(1),
            mesh: Rectangle(width: 0.4, height: 0.3, columns: 4, rows: 3, diagonals: Alternating, corner: (0.3, 0.3)),
            material: (model: NeoHookean, young: {young}, poisson: 0.3, plane: Stress))], {rest})"
    ))
}

/// Names of all registered constitutive models.
pub fn models() -> impl Iterator<Item = &'static str> {
    gingerbread::materials::Model::ALL.iter().map(|model| model.name())
}

/// Both modes.
pub const MODES: [RunMode; 2] = [RunMode::Simulate, RunMode::Collide];
