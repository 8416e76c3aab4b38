//! What a step costs, in nanoseconds per triangle: `cargo bench`. The figures criterion prints are times per triangle and
//! step, so that meshes of different sizes can be compared.
#![allow(missing_docs, clippy::unwrap_used, reason = "a benchmark is not a library")]

use criterion::{Criterion, criterion_group, criterion_main};
use gingerbread::{
    files, levels,
    materials::Model,
    meshes::NoFiles,
    sandbox::Sandbox,
    scene::Scene,
    simulation::Simulation,
    snapshot::{Field, Snapshot},
};
use std::time::{Duration, Instant};

/// A unit square of n x n quads, density 1, E = 1e3, nu = 0.3 in plane strain, stretched 1.2 in x.
fn sheet(n: u32, model: Model) -> Simulation {
    // The step follows the size of the triangles, so that every mesh is stable.
    let text = format!(
        "(name: \"sheet\", substeps: {}, bodies: [(name: \"sheet\", mass: Density(1), stretch: (1.2, 1),
          mesh: Rectangle(width: 1, height: 1, columns: {n}, rows: {n}, diagonals: Grid),
          material: (model: {}, young: 1000, poisson: 0.3, plane: Strain))])",
        10 * n,
        model.name()
    );
    let level = files::parse(&text, "sheet.ron").unwrap();
    let scene = Scene::build(&level, level.mode, &NoFiles, None).unwrap();
    let state = scene.start.clone();
    Simulation::new(scene, state)
}

/// Time of `steps` steps divided by the number of triangles.
fn per_triangle(simulation: &mut Simulation, steps: u64) -> Duration {
    let triangles = simulation.scene().triangles.len() as u32;
    laps(simulation, steps, 2000) / triangles
}

/// Time of `steps` steps. Starts over after each `lap`, so that what is measured is always the same motion.
fn laps(simulation: &mut Simulation, steps: u64, lap: u64) -> Duration {
    let start = simulation.scene().start.clone();
    let mut time = Duration::ZERO;
    for taken in (0..steps).step_by(lap as usize) {
        simulation.set_state(start.clone());
        let count = lap.min(steps - taken);
        let begin = Instant::now();
        assert_eq!(simulation.advance(count, &mut || true), count);
        time += begin.elapsed();
    }
    time
}

fn steps(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("step, per triangle");
    for n in [22, 71, 224] {
        for &model in Model::ALL {
            let mut simulation = sheet(n, model);
            let name = format!("{} triangles, {}", 2 * n * n, model.name());
            group.bench_function(name, |bencher| bencher.iter_custom(|count| per_triangle(&mut simulation, count)));
        }
    }
    group.finish();
}

/// What a frame of the window asks of the simulation: 100 steps, and a snapshot of 2,000 triangles.
fn frame(criterion: &mut Criterion) {
    let level = files::parse(levels::built_in(levels::FIRST).unwrap(), levels::FIRST).unwrap();
    let mut group = criterion.benchmark_group("frame of the gingerbread man");
    for &model in Model::ALL {
        let mut level = level.clone();
        level.bodies[0].material = level.bodies[0].material.with_model(model);
        let mut sandbox = Sandbox::new(level, Box::new(NoFiles)).unwrap();
        sandbox.apply(gingerbread::command::Command::SetRunning(true)).unwrap();
        group.bench_function(format!("100 steps, {}", model.name()), |bencher| {
            bencher.iter(|| sandbox.advance(100, &mut || true));
        });
        if model == Model::ALL[0] {
            let mut snapshot = Snapshot::default();
            group.bench_function("snapshot with von Mises stress", |bencher| {
                bencher.iter(|| sandbox.snapshot(Field::VonMises, &mut snapshot));
            });
        }
    }
    group.finish();
}

/// A step of implicit Euler of 1/60 s for 2,000 triangles: the first second after letting go of a stretched man, over and over.
fn implicit(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("implicit Euler, 1/60 s");
    for &model in Model::ALL {
        let text = format!(
            "(name: \"man\", substeps: 1, integrator: ImplicitEuler(), bodies: [(name: \"man\", mesh: Gingerbread(resolution: 2000),
              material: (model: {}, young: 1000, poisson: 0.3, plane: Stress), mass: Total(25), stretch: (1.15, 0.95))])",
            model.name()
        );
        let level = files::parse(&text, "man.ron").unwrap();
        let scene = Scene::build(&level, level.mode, &NoFiles, None).unwrap();
        let state = scene.start.clone();
        let mut simulation = Simulation::new(scene, state);
        group.bench_function(model.name(), |bencher| {
            bencher.iter_custom(|steps| laps(&mut simulation, steps, 60));
        });
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20).measurement_time(Duration::from_secs(2)).warm_up_time(Duration::from_millis(500));
    targets = steps, frame, implicit
}
criterion_main!(benches);
