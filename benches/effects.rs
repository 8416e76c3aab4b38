//! What effects cost, in nanoseconds per triangle and step: `cargo bench --bench effects`. The bare loop beside them computes
//! elastic forces and moves the vertices, and does nothing else: no gravity, no guard, no books. And what paces of their own save
//! where a stiff body is beside a soft one.
#![allow(missing_docs, clippy::unwrap_used, reason = "a benchmark is not a library")]

use criterion::{Criterion, criterion_group, criterion_main};
use gingerbread::{
    files,
    level::{Level, Sleep, SubstepMode, Substeps},
    meshes::NoFiles,
    scene::Scene,
    simulation::Simulation,
};
use std::time::{Duration, Instant};

/// Quads along a side.
const SIDE: u32 = 71;
/// Steps before everything starts over, so that what is measured is always the same motion.
const LAP: u64 = 600;

/// A square sheet of 2 x 71 x 71 triangles that is let go from a stretch, with these effects.
fn sheet(body: &str, rest: &str) -> Simulation {
    let text = format!(
        "(name: \"sheet\", substeps: 710, {rest}, bodies: [(name: \"sheet\", mass: Density(1), {body}
          mesh: Rectangle(width: 1, height: 1, columns: {SIDE}, rows: {SIDE}, diagonals: Grid),
          material: (model: Corotated, young: 1000, poisson: 0.3, plane: Strain))])"
    );
    let level = files::parse(&text, "sheet.ron").unwrap();
    let scene = Scene::build(&level, level.mode, &NoFiles, None).unwrap();
    let state = scene.start.clone();
    Simulation::new(scene, state)
}

fn laps(simulation: &mut Simulation, steps: u64) -> Duration {
    let start = simulation.scene().start.clone();
    let mut time = Duration::ZERO;
    for taken in (0..steps).step_by(LAP as usize) {
        simulation.set_state(start.clone());
        let count = LAP.min(steps - taken);
        let begin = Instant::now();
        assert_eq!(simulation.advance(count, &mut || true), count);
        time += begin.elapsed();
    }
    time
}

/// The elements alone, moved by symplectic Euler.
fn bare(simulation: &Simulation, steps: u64) -> Duration {
    let scene = simulation.scene();
    let (elements, h) = (&scene.bodies[0].elements, scene.step);
    let mut scratch = vec![0.0; gingerbread::effects::Effect::scratch(elements.as_ref())];
    let mut force = vec![0.0; scene.start.x.len()];
    let mut time = Duration::ZERO;
    for taken in (0..steps).step_by(LAP as usize) {
        let (mut x, mut v) = (scene.start.x.clone(), scene.start.v.clone());
        let begin = Instant::now();
        for _ in 0..LAP.min(steps - taken) {
            force.fill(0.0);
            elements.elastic_force(&x, &mut scratch, &mut force);
            for (((x, v), force), inverse_mass) in x.iter_mut().zip(&mut v).zip(&force).zip(&scene.inverse_mass) {
                *v += h * force * inverse_mass;
                *x += h * *v;
            }
        }
        time += begin.elapsed();
        std::hint::black_box((&x, &v));
    }
    time
}

fn effects(criterion: &mut Criterion) {
    const GRAVITY: &str = "(effect: Gravity(down: 1)),";
    const STRETCHED: &str = "stretch: (1.02, 1),";
    const FAR: &str = "(effect: Walls(obstacles: [Plane(point: (0, -9), normal: (0, 1), eps: 0.01), Plane(point: (-9, 0), normal: (1, 0), eps: 0.01),
        Ball(centre: (5, 5), radius: 1, eps: 0.01)])), (effect: Boundary(least: (-8, -8), greatest: (8, 8))),";
    const FLOOR: &str = "(effect: Walls(obstacles: [Plane(point: (0, 0), normal: (0, 1), eps: 0.01)])),";
    let mut group = criterion.benchmark_group("effects, per triangle");
    let triangles = 2 * SIDE * SIDE;
    let alone = sheet(STRETCHED, "effects: []");
    group.bench_function("bare element loop", |bencher| bencher.iter_custom(|steps| bare(&alone, steps) / triangles));
    for (name, effects) in [
        ("gravity only", GRAVITY.to_owned()),
        ("gravity and damping by mass", format!("{GRAVITY} (effect: Rayleigh(mass: 1)),")),
        ("gravity and drag", format!("{GRAVITY} (effect: Drag(coefficient: 0.00001)),")),
        ("gravity and damping", format!("{GRAVITY} (effect: Rayleigh(mass: 1, stiffness: 0.000001)),")),
        ("gravity, walls out of reach", format!("{GRAVITY} {FAR}")),
        ("gravity, walls in contact", format!("{GRAVITY} {FLOOR}")),
    ] {
        let mut run = sheet(STRETCHED, &format!("sleep: Off, effects: [{effects}]"));
        group.bench_function(name, |bencher| bencher.iter_custom(|steps| laps(&mut run, steps) / triangles));
    }
    let mut still = sheet("", "effects: []");
    while !still.is_asleep() {
        still.advance(LAP, &mut || true);
    }
    group.bench_function("asleep", |bencher| {
        bencher.iter_custom(|steps| {
            let begin = Instant::now();
            assert_eq!(still.advance(steps, &mut || true), steps);
            begin.elapsed() / triangles
        });
    });
    group.finish();
}

/// A frame of the pea and the cake, each at its own pace and both at the pea's.
fn paces(criterion: &mut Criterion) {
    let text = gingerbread::levels::built_in("pea_and_cake").unwrap();
    let own = Level { sleep: Sleep::Off, ..files::parse(text, "pea_and_cake").unwrap() };
    let build = |level: &Level| {
        let scene = Scene::build(level, level.mode, &NoFiles, None).unwrap();
        let state = scene.start.clone();
        Simulation::new(scene, state)
    };
    let pea = build(&own).substep_plans().map(|pace| pace.steps).max().unwrap();
    let same = Substeps::new(own.substeps.get() * pea).unwrap();
    let same = Level { paces: SubstepMode::Same, substeps: same, ..own.clone() };
    let mut group = criterion.benchmark_group("pea and cake, a frame");
    for (name, level) in [("own paces", own), ("the pea's pace", same)] {
        let (mut run, substeps) = (build(&level), u64::from(level.substeps.get()));
        group.bench_function(name, |bencher| {
            bencher.iter_custom(|frames| {
                let mut time = Duration::ZERO;
                for frame in 0..frames {
                    if frame % 60 == 0 {
                        run.set_state(run.scene().start.clone());
                    }
                    let begin = Instant::now();
                    assert_eq!(run.advance(substeps, &mut || true), substeps);
                    time += begin.elapsed();
                }
                time
            });
        });
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20).measurement_time(Duration::from_secs(3)).warm_up_time(Duration::from_millis(500));
    targets = effects, paces
}
criterion_main!(benches);
