//! Facts about implicit steps: the stiffness, the factorisation, Newton's method, and steps far beyond stability.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{Random, models, named, sheet};
use gingerbread::{
    effects::{Grab, Motion},
    level::Level,
    meshes::NoFiles,
    scene::Scene,
    simulation::Simulation,
    solvers::{BlockMatrix, Equations, Factor, Newton, SparseMatrix, Tangent, Weights},
    stability::critical_step,
    state::State,
};
use nalgebra::Matrix2;

const DAMPED: &str = "effects: [(effect: Gravity(down: 3)), (effect: Rayleigh(mass: 0.5, stiffness: 0.01)), (effect: MouseSpring(stiffness: 5)), (effect: Compression(strength: 2))]";

fn built(level: &Level, step: Option<f64>) -> Simulation {
    let mut scene = Scene::build(level, level.mode, &NoFiles, None).unwrap();
    scene.step = step.unwrap_or(scene.step);
    let state = scene.start.clone();
    Simulation::new(scene, state)
}

fn shaken(scene: &Scene, size: f64, speed: f64) -> State {
    let mut random = Random(3);
    let mut state = scene.start.clone();
    for ((x, v), _) in state.x.iter_mut().zip(&mut state.v).zip(&scene.inverse_mass).filter(|(_, w)| **w > 0.0) {
        *x += random.between(-size, size);
        *v = random.between(-speed, speed);
    }
    state
}

fn assembled(scene: &Scene, motion: Motion<'_>, weights: Weights) -> BlockMatrix<2> {
    let mut pattern = Vec::new();
    scene.effects.iter().for_each(|effect| effect.sparsity_pattern(&mut |a, b| pattern.push([a, b])));
    let mut matrix = BlockMatrix::new(scene.rest.len() / 2, &pattern);
    for _ in 0..2 {
        matrix.clear();
        scene.effects.iter().for_each(|effect| effect.add_stiffness(motion, weights, &mut matrix));
        assert!(matrix.is_full(), "every couple has its block");
    }
    matrix
}

fn force(scene: &Scene, state: &State, grab: Option<Grab>) -> Vec<f64> {
    let mut force = vec![0.0; state.x.len()];
    for effect in &scene.effects {
        effect.force(scene.motion(state, grab), &mut vec![0.0; effect.scratch()], &mut force);
    }
    force
}

fn times(matrix: &BlockMatrix<2>, vector: &[f64]) -> Vec<f64> {
    let mut product = vec![0.0; vector.len()];
    matrix.add_product(vector, &mut product);
    product
}

fn greatest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |a, b| a.max(b.abs()))
}

/// It is symmetric.
/// One component at a time, at order-one stiffness, with the best of several epsilons.
#[test]
fn the_stiffness_matrix_matches_force_differences() {
    let grab = Some(Grab { vertex: 7, target: [0.1, 0.9, 0.0] });
    for model in models() {
        // Of damping's own dependence on x only the symmetric half is in the matrix, so it is at rest for that part.
        for (speed, weights) in [(0.0, [1.0, 0.0]), (0.7, [0.0, 1.0])] {
            let scene = built(&sheet(model, "", DAMPED), None);
            let scene = scene.scene();
            let state = shaken(scene, 0.01, speed);
            let weights = Weights { position: weights[0], velocity: weights[1], tangent: Tangent::Exact };
            let matrix = assembled(scene, scene.motion(&state, grab), weights);
            let mut random = Random(11);
            let count = state.x.len();
            let [d, e]: [Vec<f64>; 2] = [(); 2].map(|()| (0..count).map(|_| random.between(-1.0, 1.0)).collect());
            let product = times(&matrix, &d);
            let other: f64 = times(&matrix, &e).iter().zip(&d).map(|(a, b)| a * b).sum();
            let one: f64 = product.iter().zip(&e).map(|(a, b)| a * b).sum();
            assert!((one - other).abs() < 1e-10 * (1.0 + one.abs()), "{model}: not symmetric");
            let best = [1e-4, 1e-5, 1e-6].map(|epsilon| {
                let ends = [epsilon, -epsilon].map(|epsilon| {
                    let mut end = state.clone();
                    for ((x, v), d) in end.x.iter_mut().zip(&mut end.v).zip(&d) {
                        *x += epsilon * weights.position * d;
                        *v += epsilon * weights.velocity * d;
                    }
                    force(scene, &end, grab)
                });
                let differences = ends[1].iter().zip(&ends[0]).map(|(a, b)| (a - b) / (2.0 * epsilon));
                greatest(differences.zip(&product).map(|(a, b)| a - b)) / greatest(product.iter().copied())
            });
            assert!(best.into_iter().fold(1.0, f64::min) < 1e-7, "{model} {weights:?}: {best:?}");
        }
        let scene = built(&sheet(model, "", DAMPED), None);
        let state = shaken(scene.scene(), 0.01, 0.0);
        let motion = scene.scene().motion(&state, None);
        let matrix =
            assembled(scene.scene(), motion, Weights { position: 1.0, velocity: 0.0, tangent: Tangent::Exact });
        let mut product = vec![0.0; state.x.len()];
        for effect in &scene.scene().effects {
            effect.stiffness_times(motion, &state.x, &mut vec![0.0; effect.scratch()], &mut product);
        }
        let scale = greatest(product.iter().copied());
        assert!(greatest(times(&matrix, &state.x).iter().zip(&product).map(|(a, b)| a - b)) < 1e-12 * scale.max(1.0));
    }
}

#[test]
fn the_factor_inverts_the_matrix_and_keeps_fixed_values() {
    let simulation = built(&sheet("NeoHookean", "pins: [Top, Vertex(7)]", DAMPED), None);
    let scene = simulation.scene();
    let state = shaken(scene, 0.01, 0.0);
    let mut matrix =
        assembled(scene, scene.motion(&state, None), Weights { position: 1.0, velocity: 0.3, tangent: Tangent::Exact });
    for (vertex, mass) in scene.mass.chunks_exact(2).enumerate() {
        matrix.diagonal(vertex, &Matrix2::from_diagonal_element(mass[0]));
    }
    let mut factor = Factor::new(&matrix).unwrap();
    assert!(factor.factorise(&matrix, &scene.inverse_mass, 0.0));
    let mut random = Random(4);
    let free = |values: Vec<f64>| -> Vec<f64> {
        values.into_iter().zip(&scene.inverse_mass).map(|(value, w)| if *w > 0.0 { value } else { 0.0 }).collect()
    };
    let solution = free((0..state.x.len()).map(|_| random.between(-1.0, 1.0)).collect());
    let mut b = free(times(&matrix, &solution));
    factor.solve(&mut b);
    assert!(greatest(b.iter().zip(&solution).map(|(a, b)| a - b)) < 1e-11);
    // An indefinite matrix is told from a definite one, and the same factor serves again.
    matrix.diagonal(6, &Matrix2::from_diagonal_element(-1e6));
    assert!(!factor.factorise(&matrix, &scene.inverse_mass, 0.0));
    assert!(factor.factorise(&matrix, &scene.inverse_mass, 1e9));
}

/// A chain of points with a quartic spring between neighbours: `g_i = z_i - b_i + (z_i - z_(i-1))³ - (z_(i+1) - z_i)³`.
struct Chain(Vec<f64>, Vec<f64>);

impl Equations for Chain {
    fn residual(&mut self, z: &[f64], g: &mut [f64]) {
        for ((g, z), b) in g.iter_mut().zip(z).zip(&self.0) {
            *g = z - b;
        }
        for number in 0..z.len() - 2 {
            let cube = (z[number + 2] - z[number]).powi(3);
            g[number + 2] += cube;
            g[number] -= cube;
        }
    }

    fn derivative(&mut self, z: &[f64], _: Tangent, matrix: &mut dyn SparseMatrix) {
        let Some(matrix) = matrix.blocks::<2>() else { return };
        for vertex in 0..z.len() / 2 {
            matrix.diagonal(vertex, &Matrix2::identity());
        }
        for vertex in 1..z.len() / 2 {
            let slope = |axis: usize| 3.0 * (z[2 * vertex + axis] - z[2 * vertex - 2 + axis]).powi(2);
            let block = Matrix2::new(slope(0), 0.0, 0.0, slope(1));
            matrix.diagonal(vertex, &block);
            matrix.diagonal(vertex - 1, &block);
            matrix.off_diagonal(&-block);
        }
    }

    fn block_size(&self) -> usize {
        2
    }

    fn sparsity_pattern(&self, add: &mut dyn FnMut(u32, u32)) {
        (1..self.0.len() as u32 / 2).for_each(|vertex| add(vertex - 1, vertex));
    }

    fn inverse_weight(&self) -> &[f64] {
        &self.1
    }

    fn other_start(&self, z: &mut [f64]) {
        z.fill(100.0);
    }

    fn tolerance(&self, _: &[f64]) -> f64 {
        1e-13
    }
}

#[test]
fn newton_converges_quadratically_at_the_end() {
    let mut random = Random(8);
    let b = (0..20).map(|_| random.between(-3.0, 3.0)).collect();
    let (mut newton, mut z) = (Newton::default(), vec![0.0; 20]);
    let counts = newton.solve(&mut Chain(b, vec![1.0; 20]), &mut z);
    assert_eq!(counts.unconverged, 0);
    let sizes = newton.sizes();
    let last: Vec<f64> = sizes.iter().copied().filter(|size| (1e-13..1e-1).contains(size)).collect();
    assert!(last.len() >= 3, "{sizes:?}");
    for pair in last.windows(2) {
        assert!(pair[1] < 10.0 * pair[0] * pair[0], "{sizes:?}");
    }
}

fn under(level: Level, integrator: &str) -> Level {
    Level { integrator: named(integrator), ..level }
}

#[test]
fn a_hundred_times_the_stability_limit_gains_no_energy() {
    for model in models() {
        for integrator in ["ImplicitEuler", "Bdf2"] {
            let level = under(sheet(model, "stretch: (1.2, 1)", ""), integrator);
            let limit = critical_step(built(&level, None).scene(), &built(&level, None).scene().start, None).unwrap();
            let mut simulation = built(&level, Some(100.0 * limit));
            let mut energy = simulation.energies().total();
            for step in 0..100 {
                assert_eq!(simulation.advance(1, &mut || true), 1, "{model} {integrator} {:?}", simulation.fault());
                let now = simulation.energies().total();
                assert!(
                    now <= energy * (1.0 + 1e-9) + 1e-12,
                    "{model} {integrator}, step {step}: {now} J after {energy} J"
                );
                energy = now;
            }
            assert_eq!(simulation.counts().unconverged, 0, "{model} {integrator}");
        }
    }
}

#[test]
fn newton_serves_damping_pulls_and_walls_at_one_step_a_frame() {
    for model in models() {
        for integrator in ["ImplicitEuler", "ImplicitMidpoint", "EnergyMomentum", "Bdf2"] {
            let effects = format!(
                "substeps: 1, {}",
                DAMPED.replace(']', ", (effect: Boundary(least: (0, 0.2), greatest: (1, 1)))]")
            );
            let mut simulation = built(&under(sheet(model, "", &effects), integrator), None);
            simulation.set_grab(Some(Grab { vertex: 24, target: [0.9, 0.9, 0.0] }));
            assert_eq!(simulation.advance(120, &mut || true), 120);
            simulation.set_grab(None);
            assert_eq!(simulation.advance(120, &mut || true), 120);
            let counts = simulation.counts();
            assert_eq!(counts.unconverged, 0, "{model} {integrator}: {counts:?}");
            // The matrix of the energy-momentum method is not the derivative.
            let most = if integrator == "EnergyMomentum" { 16 } else { 8 };
            assert!(counts.newton_iterations < most * 240, "{model} {integrator}: {counts:?}");
        }
    }
}

#[test]
fn a_newton_step_is_limited_by_the_first_inversion() {
    let mut random = Random(11);
    for model in models() {
        let simulation = built(&sheet(model, "", ""), None);
        let (scene, x) = (simulation.scene(), &simulation.state().x);
        for _ in 0..20 {
            let d: Vec<_> = x.iter().map(|_| random.between(-1.0, 1.0)).collect();
            let longest = scene.effects[0].longest_step(x, &d);
            if model != "NeoHookean" {
                assert_eq!(longest, f64::INFINITY, "{model} has no barrier");
                continue;
            }
            let least = |times: f64| {
                let moved: Vec<_> = x.iter().zip(&d).map(|(x, d)| x + times * longest * d).collect();
                let ratios = scene.bodies[0].elements.volume_ratios(&moved);
                ratios.fold(f64::INFINITY, f64::min)
            };
            assert!((least(1.0) - 1e-6).abs() < 1e-12, "{model}: J = {}", least(1.0));
            assert!((0..100).all(|part| least(f64::from(part) / 100.0) > 1e-6), "{model}");
        }
    }
}

#[test]
fn a_barrier_energy_prevents_inversion_in_implicit_steps() {
    for model in ["NeoHookean"] {
        for integrator in ["ImplicitEuler", "Bdf2"] {
            for seed in 1..9 {
                let level = under(
                    sheet(model, "", "substeps: 1, guard: Off, effects: [(effect: MouseSpring(stiffness: 1e5))]"),
                    integrator,
                );
                let mut simulation = built(&level, None);
                // A corner is pulled through the whole sheet, and every vertex flies somewhere else, far beyond its neighbours.
                let mut random = Random(seed);
                let mut state = simulation.state().clone();
                state.v.iter_mut().for_each(|v| *v = random.between(-200.0, 200.0));
                simulation.set_state(state);
                simulation.set_grab(Some(Grab { vertex: 0, target: [0.9, 0.8, 0.0] }));
                for step in 0..40 {
                    assert_eq!(
                        simulation.advance(1, &mut || true),
                        1,
                        "{model} {integrator}: {:?}",
                        simulation.fault()
                    );
                    let (least, inverted) = simulation.inversion();
                    assert_eq!(inverted, 0, "{model} {integrator} seed {seed} step {step}: J = {least}");
                }
            }
        }
    }
}
