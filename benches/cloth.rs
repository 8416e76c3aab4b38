//! What cloth in space costs: `cargo bench --bench cloth`. Springs and triangles are told per element; the same triangles in the
//! plane stand beside membranes, so that the ratio of two rows of one run says what space costs.
#![allow(missing_docs, clippy::unwrap_used, reason = "a benchmark is not a library")]

use criterion::{Criterion, criterion_group, criterion_main};
use gingerbread::{
    effects::Motion, files, levels, materials::Model, meshes::NoFiles, scene::Scene, simulation::Simulation,
};
use std::{
    hint::black_box,
    time::{Duration, Instant},
};

fn built(text: &str) -> Simulation {
    let level = files::parse(text, "bench.ron").unwrap();
    let scene = Scene::build(&level, level.mode, &NoFiles, None).unwrap();
    let state = scene.start.clone();
    Simulation::new(scene, state)
}

/// Time of some evaluations of the forces of the first elements of a scene.
fn forces(simulation: &Simulation, count: u64) -> Duration {
    let (scene, state) = (simulation.scene(), simulation.state());
    let (elements, motion) = (&scene.effects[0], scene.motion(state, None));
    let (mut scratch, mut force) = (vec![0.0; elements.scratch()], vec![0.0; state.x.len()]);
    let start = Instant::now();
    for _ in 0..count {
        elements.force(Motion { ..motion }, &mut scratch, &mut force);
    }
    black_box(force[0]);
    start.elapsed()
}

fn steps(simulation: &mut Simulation, count: u64) -> Duration {
    let start = Instant::now();
    assert_eq!(simulation.advance(count, &mut || true), count, "{:?}", simulation.fault());
    start.elapsed()
}

/// Time of some steps, at most this many at a time from the state of now: what comes later may cost another time, or nothing.
fn steps_from_here(simulation: &mut Simulation, count: u64, most: u64) -> Duration {
    let start = simulation.state().clone();
    let (mut time, mut left) = (Duration::ZERO, count);
    while left > 0 {
        simulation.set_state(start.clone());
        let next = left.min(most);
        time += steps(simulation, next);
        left -= next;
    }
    simulation.set_state(start);
    time
}

/// The cloth of Cornell's course with all its 97,026 springs.
fn springs(criterion: &mut Criterion) {
    let text = levels::built_in("cornell_cloth").unwrap();
    let text = text.replace("columns: 31, rows: 31", "columns: 127, rows: 127").replace("96", "384");
    let text = text.replace("substeps: 67", "substeps: 534").replace("0.0009765625", "0.00006103515625");
    let text = text.replace("Vertex(31)", "Vertex(127)");
    let mut simulation = built(&text);
    simulation.advance(10, &mut || true);
    let count = simulation.scene().nets[0].springs.links().len() as u32;
    let mut group = criterion.benchmark_group("Cornell cloth, per spring");
    group.bench_function("forces", |bencher| bencher.iter_custom(|laps| forces(&simulation, laps) / count));
    group.bench_function("step", |bencher| bencher.iter_custom(|laps| steps(&mut simulation, laps) / count));
    group.finish();
}

/// A unit square of 71 x 71 quads, stretched, in the plane and in space.
fn triangles(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("forces of 10,082 triangles, per triangle");
    for model in [Model::StVenantKirchhoff, Model::Corotated, Model::NeoHookean] {
        let of = |list: &str, more: &str| {
            built(&format!(
                "(name: \"sheet\", {list}: [(name: \"sheet\", mass: Density(1), stretch: (1.2, 1){more},
                  mesh: Rectangle(width: 1, height: 1, columns: 71, rows: 71, diagonals: Grid),
                  material: (model: {}, young: 1000, poisson: 0.3, plane: Strain))])",
                model.name()
            ))
        };
        for (place, simulation) in [("plane", of("bodies", "")), ("space", of("membranes", ", thickness: 1"))] {
            let name = format!("{}, {place}", model.name());
            group.bench_function(name, |bencher| bencher.iter_custom(|laps| forces(&simulation, laps) / 10_082));
        }
    }
    group.finish();
}

/// An implicit step of the 722 triangles of Toronto's course.
fn implicit(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("implicit step");
    for level in ["toronto_cloth", "toronto_sphere"] {
        let mut simulation = built(levels::built_in(level).unwrap());
        simulation.advance(20, &mut || true);
        group.bench_function(level, |bencher| bencher.iter_custom(|laps| steps_from_here(&mut simulation, laps, 40)));
    }
    group.finish();
}

/// The first implicit steps of 5,000 triangles that fall on an edge and fold, with contact of the cloth with itself and without.
fn contact(criterion: &mut Criterion) {
    let text = levels::built_in("cloth_folding").unwrap();
    let text = text.replace("columns: 12, rows: 12", "columns: 50, rows: 50").replace("substeps: 16", "substeps: 4");
    let text = text.replace("VelocityVerlet()", "LinearlyImplicitEuler()");
    let mut group = criterion.benchmark_group("implicit step of 5,000 triangles");
    group.sample_size(10).measurement_time(Duration::from_secs(10));
    for (name, text) in [
        ("with contact", text.clone()),
        ("without", text.replace("(effect: Contact(modulus: 1, thickness: 0.2)),", "")),
    ] {
        let mut simulation = built(&text);
        simulation.advance(4, &mut || true);
        group.bench_function(name, |bencher| bencher.iter_custom(|laps| steps_from_here(&mut simulation, laps, 20)));
    }
    group.finish();
}

criterion_group! {
    name = cloth;
    config = Criterion::default().sample_size(20).warm_up_time(Duration::from_millis(500)).measurement_time(Duration::from_secs(2));
    targets = springs, triangles, implicit, contact
}
criterion_main!(cloth);
