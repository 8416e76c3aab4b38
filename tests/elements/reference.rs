//! Comparison with numbers made by other programs. The data is not part of this package: point
//! `GINGERBREAD_REFERENCE` at a folder that has it and run `cargo test --test elements reference -- --ignored`.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a failing test should panic")]

use gingerbread::{files, level::RunMode, materials::Model, meshes::NoFiles, scene::Scene, simulation::Simulation};
use std::{fs, path::PathBuf};

/// Rows of numbers of a CSV file, without comments and headings.
fn rows(name: &str) -> Vec<Vec<f64>> {
    let folder = PathBuf::from(std::env::var("GINGERBREAD_REFERENCE").expect("GINGERBREAD_REFERENCE names a folder"));
    let text = fs::read_to_string(folder.join(name)).unwrap();
    let numbers = |line: &str| line.split(',').map(|word| word.trim().parse().ok()).collect::<Option<Vec<f64>>>();
    text.lines().filter(|line| !line.starts_with('#')).filter_map(numbers).collect()
}

/// 600 steps of 0.167 ms from a stretch of 1.2; returns the greatest difference in position [m].
fn greatest_difference(model: Model, poisson: f64, file: &str) -> f64 {
    let reference = rows(file);
    let points: Vec<_> = reference.iter().map(|row| format!("({:?}, {:?})", row[1], row[2])).collect();
    let triangles: Vec<_> =
        rows("cs5643_ref_mesh_tris.csv").iter().map(|row| format!("({}, {}, {})", row[0], row[1], row[2])).collect();
    let level = format!(
        "(name: \"reference\", bodies: [(name: \"man\", mass: Total(25), mesh: Points(points: [{}], triangles: [{}]),
          material: (model: {}, young: 1000, poisson: {poisson}, plane: Stress))])",
        points.join(","),
        triangles.join(","),
        model.name()
    );
    let level = files::parse(&level, "reference.ron").unwrap();
    let mut scene = Scene::build(&level, RunMode::Simulate, &NoFiles, None).unwrap();
    scene.step = 0.000_167;
    let mut state = scene.start.clone();
    state.x = reference.iter().flat_map(|row| [row[3], row[4]]).collect();
    let mut simulation = Simulation::new(scene, state);
    assert_eq!(simulation.advance(600, &mut || true), 600);
    let theirs = reference.iter().flat_map(|row| [row[5], row[6]]);
    simulation.state().x.iter().zip(theirs).map(|(ours, theirs)| (ours - theirs).abs()).fold(0.0, f64::max)
}

#[test]
#[ignore = "needs the reference data"]
fn six_hundred_steps_agree_with_an_independent_program() {
    let models =
        [(Model::Corotated, "corotated"), (Model::StVenantKirchhoff, "stvk"), (Model::NeoHookean, "neohookean")];
    for (model, name) in models {
        for (poisson, suffix) in [(0.0, ""), (0.3, "_nu03")] {
            let difference = greatest_difference(model, poisson, &format!("cs5643_ref_{name}{suffix}.csv"));
            println!("{} nu = {poisson}: {difference:.2e} m", model.name());
            assert!(difference < 1e-10, "{name}{suffix}: {difference:e}");
        }
    }
}
