//! What an implicit step costs and where the time goes: `cargo bench --bench implicit`. Assembly is told per triangle, all else
//! as it is.
#![allow(missing_docs, clippy::unwrap_used, reason = "a benchmark is not a library")]

#[path = "../tests/common/physics.rs"]
mod physics;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use gingerbread::{
    effects::Effect as _,
    files,
    integrators::{ImplicitEuler, SecondOrder, Workspace},
    materials::Model,
    meshes::NoFiles,
    scene::Scene,
    simulation::Simulation,
    solvers::{BlockMatrix, Factor, LinearSolver, Tangent, Weights},
};
use nalgebra::Matrix2;
use physics::Physics;
use std::time::{Duration, Instant};

/// Quads along a side: 2,048, 10,082 and 100,352 triangles.
const SIDES: [u32; 3] = [32, 71, 224];
/// The step [s].
const STEP: f64 = 1.0 / 60.0;

fn built(text: &str) -> Simulation {
    let level = files::parse(text, "bench.ron").unwrap();
    let scene = Scene::build(&level, level.mode, &NoFiles, None).unwrap();
    let state = scene.start.clone();
    Simulation::new(scene, state)
}

/// A unit square of n x n quads, density 1, E = 1e3, nu = 0.3 in plane strain, stretched 1.2 in x.
fn sheet(n: u32, model: Model) -> Simulation {
    built(&format!(
        "(name: \"sheet\", substeps: 1, integrator: ImplicitEuler(), bodies: [(name: \"sheet\", mass: Density(1), stretch: (1.2, 1),
          mesh: Rectangle(width: 1, height: 1, columns: {n}, rows: {n}, diagonals: Grid),
          material: (model: {}, young: 1000, poisson: 0.3, plane: Strain))])",
        model.name()
    ))
}

/// The matrix of a step from the stretched start.
struct System {
    simulation: Simulation,
    matrix: BlockMatrix<2>,
}

impl System {
    fn new(n: u32, model: Model) -> Self {
        let simulation = sheet(n, model);
        let mut pattern = Vec::new();
        simulation.scene().effects.iter().for_each(|effect| effect.sparsity_pattern(&mut |a, b| pattern.push([a, b])));
        let matrix = BlockMatrix::new(simulation.scene().rest.len() / 2, &pattern);
        let mut system = Self { simulation, matrix };
        system.assemble(Tangent::Definite);
        system
    }

    fn assemble(&mut self, tangent: Tangent) {
        let (scene, state) = (self.simulation.scene(), self.simulation.state());
        self.matrix.clear();
        let weights = Weights { position: STEP * STEP, velocity: STEP, tangent };
        for effect in &scene.effects {
            effect.add_stiffness(scene.motion(state, None), weights, &mut self.matrix);
        }
        for (vertex, mass) in scene.mass.chunks_exact(2).enumerate() {
            self.matrix.diagonal(vertex, &Matrix2::new(mass[0], 0.0, 0.0, mass[1]));
        }
    }
}

fn assembly(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("assembly, per triangle");
    for n in SIDES {
        for &model in Model::ALL {
            for tangent in [Tangent::Exact, Tangent::Definite] {
                let mut system = System::new(n, model);
                let id = BenchmarkId::new(format!("{} {tangent:?}", model.name()), 2 * n * n);
                group.bench_function(id, |bencher| {
                    bencher.iter_custom(|count| {
                        let begin = Instant::now();
                        (0..count).for_each(|_| system.assemble(tangent));
                        begin.elapsed() / (2 * n * n)
                    });
                });
            }
        }
    }
}

/// The stiffness times a displacement, without a matrix: what the longest stable step is found by.
fn product(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("stiffness times a displacement, per triangle");
    for n in SIDES {
        for &model in Model::ALL {
            let simulation = sheet(n, model);
            let (scene, state) = (simulation.scene(), simulation.state());
            let (mut scratch, mut product) = (vec![0.0; scene.scratch()], vec![0.0; state.x.len()]);
            let elements = &scene.bodies[0].elements;
            group.bench_function(BenchmarkId::new(model.name(), 2 * n * n), |bencher| {
                bencher.iter_custom(|count| {
                    let begin = Instant::now();
                    for _ in 0..count {
                        product.fill(0.0);
                        elements.stiffness_times(scene.motion(state, None), &scene.rest, &mut scratch, &mut product);
                    }
                    begin.elapsed() / (2 * n * n)
                });
            });
        }
    }
}

fn factor(criterion: &mut Criterion) {
    for n in SIDES {
        let System { simulation, matrix } = System::new(n, Model::NeoHookean);
        let weight = &simulation.scene().inverse_mass;
        let name = |what: &str| format!("{what}/{}", 2 * n * n);
        criterion.bench_function(&name("analysis"), |bencher| bencher.iter(|| Factor::new(&matrix).unwrap()));
        let mut factor = Factor::new(&matrix).unwrap();
        criterion.bench_function(&name("factor"), |bencher| {
            bencher.iter(|| assert!(factor.factorise(&matrix, weight, 0.0)));
        });
        let mut b = vec![1.0; weight.len()];
        criterion.bench_function(&name("solve"), |bencher| {
            bencher.iter(|| {
                b.fill(1.0);
                factor.solve(&mut b);
            });
        });
    }
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

/// The first step from the stretched start, over and over.
fn step(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("step");
    for n in SIDES {
        for &model in Model::ALL {
            let mut simulation = sheet(n, model);
            // What is settled once for a topology.
            assert_eq!(simulation.advance(1, &mut || true), 1);
            group.bench_function(BenchmarkId::new(model.name(), 2 * n * n), |bencher| {
                bencher.iter_custom(|steps| laps(&mut simulation, steps, 1));
            });
        }
    }
}

/// The same from 500 triangles to 200,000.
fn sizes(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("step of so many triangles");
    group.sample_size(10);
    for n in [16, 50, 158, 316] {
        let mut simulation = sheet(n, Model::Corotated);
        assert_eq!(simulation.advance(1, &mut || true), 1);
        group.bench_function(format!("{}", 2 * n * n), |bencher| {
            bencher.iter_custom(|steps| laps(&mut simulation, steps, 1));
        });
    }
    group.finish();
}

/// The first three steps from the stretched start with linear systems factorised, solved by iterations, and either as the size has
/// it: a few rounds of each in turn, so that whatever else the machine does meets all alike, told by the least time of each.
fn paths(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("three steps");
    for (n, model) in [32, 71, 224, 316].into_iter().flat_map(|n| [(n, Model::Corotated), (n, Model::NeoHookean)]) {
        let simulation = sheet(n, model);
        let scene = simulation.scene();
        let mut physics = Physics::new(scene);
        let mut run = |work: &mut Workspace| {
            let mut state = scene.start.clone();
            let begin = Instant::now();
            let mut step =
                || ImplicitEuler::default().step(&mut physics, &mut state, work, STEP).newton.linear_iterations;
            let linear: u64 = (0..3).map(|_| step()).sum();
            (begin.elapsed(), linear)
        };
        let mut works = [LinearSolver::Direct, LinearSolver::Iterative, LinearSolver::Chosen].map(Workspace::new);
        let mut least = [f64::INFINITY; 3];
        // The first round settles what is settled once for a topology.
        let linear = works.each_mut().map(|work| run(work).1);
        for _ in 0..4 {
            for (least, work) in least.iter_mut().zip(&mut works) {
                *least = least.min(1e3 * run(work).0.as_secs_f64());
            }
        }
        let [direct, iterative, chosen] = least;
        let name = format!("{}/{}", model.name(), 2 * n * n);
        let way = if linear[2] > 0 { "iterations" } else { "factors" };
        let ratio = direct / iterative;
        println!(
            "{name}: factors {direct:.2} ms, iterations {iterative:.2} ms, ratio {ratio:.2}, chosen {way} {chosen:.2} ms"
        );
        group.bench_function(name, |bencher| {
            bencher.iter_custom(|count| (0..count).map(|_| run(&mut works[2]).0).sum());
        });
    }
    group.finish();
}

/// 2,000 triangles: the first second after letting go of a stretched man, over and over.
fn man(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("step of the man");
    for &model in Model::ALL {
        let mut simulation = built(&format!(
            "(name: \"man\", substeps: 1, integrator: ImplicitEuler(), bodies: [(name: \"man\", mesh: Gingerbread(resolution: 2000),
              material: (model: {}, young: 1000, poisson: 0.3, plane: Stress), mass: Total(25), stretch: (1.15, 0.95))])",
            model.name()
        ));
        group.bench_function(model.name(), |bencher| bencher.iter_custom(|steps| laps(&mut simulation, steps, 60)));
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10).measurement_time(Duration::from_secs(1)).warm_up_time(Duration::from_millis(200));
    targets = assembly, product, factor, step, sizes, paths, man
}
criterion_main!(benches);
