//! What a step costs, in nanoseconds per triangle: `cargo bench`. The figures criterion prints are times per triangle (or
//! spring) and step, so that meshes of different sizes can be compared. Beside each stands the same step written plainly, one
//! triangle after another: the ratio of the two says more than either on a machine that is busy or slow.
#![allow(missing_docs, clippy::unwrap_used, reason = "a benchmark is not a library")]

mod plain;
mod sheet;

use criterion::{Criterion, criterion_group, criterion_main};
use gingerbread::{
    files,
    level::{Level, Sleep},
    levels,
    materials::Model,
    meshes::NoFiles,
    sandbox::Sandbox,
    scene::Scene,
    simd::{sets, width},
    simulation::Simulation,
    snapshot::{Field, Snapshot},
};
use plain::Plain;
use rayon::ThreadPoolBuilder;
use sheet::{Lap, sheet, simulation, strip};
use std::{sync::Arc, time::Duration};

/// At the start the guard looks at every step.
const LAP: Lap = Lap { lead: 200, end: 2000 };

fn steps(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("step, per triangle");
    for n in [22, 71, 224] {
        for &model in Model::ALL {
            let mut simulation = sheet(n, model);
            let mut plain = Plain::new(simulation.scene());
            let name = format!("{} triangles, {}", 2 * n * n, model.name());
            group.bench_function(&name, |bencher| {
                bencher.iter_custom(|count| LAP.time(&mut simulation, count) / (2 * n * n));
            });
            if simulation.scene().bodies[0].elements.partitions() > 1 {
                let pool = ThreadPoolBuilder::new().num_threads(2).build().unwrap();
                group.bench_function(format!("{name}, two threads"), |bencher| {
                    bencher.iter_custom(|count| pool.install(|| LAP.time(&mut simulation, count)) / (2 * n * n));
                });
                // What two threads can come to on this machine: they share the work, but have nothing to tell each other.
                let mut halves = [n / 2, n - n / 2].map(|rows| sheet::simulation(strip([n, rows], model)));
                group.bench_function(format!("{name}, two halves apart"), |bencher| {
                    bencher.iter_custom(|count| LAP.time_apart(&mut halves, count) / (2 * n * n));
                });
            }
            group.bench_function(format!("{name}, plain"), |bencher| {
                bencher.iter_custom(|count| plain.time(count) / (2 * n * n));
            });
        }
    }
    group.finish();
}

/// In every instruction set of the processor.
fn widths(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("step in lanes, per triangle");
    for model in [Model::StVenantKirchhoff, Model::Corotated, Model::NeoHookean] {
        for set in sets() {
            let (n, mut scene) = (71, strip([71, 71], model));
            let elements = Arc::new(scene.bodies[0].elements.in_set(set));
            scene.bodies[0].elements = Arc::clone(&elements);
            scene.effects[0] = elements;
            let mut simulation = simulation(scene);
            let name = format!("{} triangles, {}, {} at a time", 2 * n * n, model.name(), width(set));
            group.bench_function(name, |bencher| {
                bencher.iter_custom(|count| LAP.time(&mut simulation, count) / (2 * n * n));
            });
        }
    }
    group.finish();
}

/// From 500 triangles to a million.
fn sizes(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("step of so many triangles, per triangle");
    group.sample_size(10);
    for n in [16, 50, 158, 500, 707] {
        let mut simulation = sheet(n, Model::Corotated);
        for threads in [1, 2] {
            let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            group.bench_function(format!("{}, {threads} threads", 2 * n * n), |bencher| {
                bencher.iter_custom(|count| pool.install(|| LAP.time(&mut simulation, count)) / (2 * n * n));
            });
        }
    }
    group.finish();
}

/// All numbers below this one, in no order, but the same on every run.
fn shuffled_numbers(count: usize) -> Vec<u32> {
    // A linear congruential generator, of which the upper half is irregular enough (D. Knuth, MMIX).
    let mut seed = 1_u64;
    let mut order: Vec<_> = (0..count as u32)
        .map(|number| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 32, number)
        })
        .collect();
    order.sort_unstable();
    order.into_iter().map(|(_, number)| number).collect()
}

/// Points and elements listed in no order.
fn in_no_order<const N: usize>(points: &[[f64; 2]], elements: &[[u32; N]]) -> (Vec<[f64; 2]>, Vec<[u32; N]>) {
    let (names, order) = (shuffled_numbers(points.len()), shuffled_numbers(elements.len()));
    let mut mixed = points.to_vec();
    names.iter().zip(points).for_each(|(name, point)| mixed[*name as usize] = *point);
    let renamed = order.iter().map(|number| elements[*number as usize].map(|end| names[end as usize]));
    (mixed, renamed.collect())
}

/// A list as a level writes it.
fn list<T>(items: &[T], write: impl Fn(&T) -> String) -> String {
    items.iter().map(write).collect::<Vec<_>>().join(",")
}

fn built(text: &str) -> Simulation {
    let level = files::parse(text, "bench.ron").unwrap();
    let scene = Scene::build(&level, level.mode, &NoFiles, None).unwrap();
    let state = scene.start.clone();
    Simulation::new(scene, state)
}

/// The sheet of 71 x 71 quads with its vertices and triangles listed in order, and in none.
fn shuffled(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("step of a mesh from a file, per triangle");
    let scene = sheet(71, Model::Corotated);
    let mesh = &scene.scene().bodies[0].mesh;
    let ordered = (mesh.points().to_vec(), mesh.triangles().to_vec());
    let mixed = in_no_order(&ordered.0, &ordered.1);
    for (name, (points, triangles)) in [("in order", ordered), ("in no order", mixed)] {
        let points = list(&points, |[x, y]| format!("({x:?}, {y:?})"));
        let count = triangles.len() as u32;
        let triangles = list(&triangles, |[a, b, c]| format!("({a}, {b}, {c})"));
        let mut simulation = built(&format!(
            "(name: \"sheet\", substeps: 710, bodies: [(name: \"sheet\", mass: Density(1), stretch: (1.2, 1),
              mesh: Points(points: [{points}], triangles: [{triangles}]),
              material: (model: Corotated, young: 1000, poisson: 0.3, plane: Strain))])"
        ));
        group.bench_function(format!("{count} triangles {name}"), |bencher| {
            bencher.iter_custom(|steps| LAP.time(&mut simulation, steps) / count);
        });
    }
    group.finish();
}

/// A sheet of 128 x 128 particles with structural, shear and flexion springs; and springs along the edges of a mesh without rows, its
/// particles and springs listed in order and in none.
fn springs(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("step, per spring");
    let mut bench = |name: &str, mut simulation: Simulation| {
        let count = simulation.scene().nets[0].springs.links().len() as u32;
        group.bench_function(format!("{count} springs, {name}"), |bencher| {
            bencher.iter_custom(|steps| LAP.time(&mut simulation, steps) / count);
        });
    };
    let sheet = "(name: \"net\", substeps: 1000, nets: [(name: \"net\", mass: 0.001, net: Sheet(width: 1, height: 1,
        columns: 127, rows: 127, structural: 100, shear: 50, flexion: 20, corner: (0, 0)))])";
    bench("sheet", built(sheet));
    let man = built(
        "(name: \"man\", bodies: [(name: \"man\", mass: Density(1), mesh: Gingerbread(resolution: 64000),
          material: (model: Corotated, young: 1, poisson: 0.3))])",
    );
    let mesh = &man.scene().bodies[0].mesh;
    let sides = mesh.triangles().iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let mut edges: Vec<_> = sides.map(|[a, b]| [a.min(b), a.max(b)]).collect();
    edges.sort_unstable();
    edges.dedup();
    let mixed = in_no_order(mesh.points(), &edges);
    for (name, (points, edges)) in [("edges of a mesh", (mesh.points().to_vec(), edges)), ("in no order", mixed)] {
        let link = |&[a, b]: &[u32; 2]| {
            let [p, q] = [a, b].map(|end| points[end as usize]);
            // A little too short, so that everything moves.
            let rest = 0.98 * ((p[0] - q[0]).powi(2) + (p[1] - q[1]).powi(2)).sqrt();
            format!("({a}, {b}, 100, {rest:?})")
        };
        let links = list(&edges, link);
        let points = list(&points, |[x, y]| format!("({x:?}, {y:?})"));
        let net = format!("Links(points: [{points}], springs: [{links}])");
        bench(
            name,
            built(&format!("(name: \"net\", substeps: 1000, nets: [(name: \"net\", mass: 0.001, net: {net})])")),
        );
    }
    group.finish();
}

/// What a frame of the window asks of the simulation: 100 steps, and a snapshot of 2,000 triangles.
fn frame(criterion: &mut Criterion) {
    let level = files::parse(levels::built_in(levels::FIRST).unwrap(), levels::FIRST).unwrap();
    let mut group = criterion.benchmark_group("frame of the gingerbread man");
    for &model in Model::ALL {
        // Asleep he would cost nothing.
        let mut level = Level { sleep: Sleep::Off, ..level.clone() };
        level.bodies[0].material = level.bodies[0].material.with_model(model);
        let mut sandbox = Sandbox::new(level, Box::new(NoFiles)).unwrap();
        sandbox.apply(gingerbread::command::Command::SetRunning(true)).unwrap();
        group.bench_function(format!("100 steps, {}", model.name()), |bencher| {
            bencher.iter(|| sandbox.advance(100, &mut || true));
        });
        if model == Model::ALL[0] {
            let mut snapshot = Snapshot::default();
            group.bench_function("one step and its snapshot with von Mises stress", |bencher| {
                bencher.iter(|| {
                    sandbox.advance(1, &mut || true);
                    sandbox.snapshot(Field::VonMises, &mut snapshot);
                });
            });
        }
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20).measurement_time(Duration::from_secs(2)).warm_up_time(Duration::from_millis(500));
    targets = steps, widths, shuffled, sizes, springs, frame
}
criterion_main!(benches);
