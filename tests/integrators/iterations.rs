//! Facts about solving the linear systems of implicit steps by iterations: the same steps as with factors, to a small share of what
//! the scheme is off; the same bits every time; and where iterations do not get there, factors.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{level, models, named, physics::Physics};
use gingerbread::{
    integrators::{IntegratorKind, Workspace},
    meshes::NoFiles,
    scene::Scene,
    solvers::{LinearSolver, NewtonCounts},
    state::State,
};

/// A frame [s].
const STEP: f64 = 1.0 / 60.0;

/// A sheet of n x n quads, with more fields of the body.
fn sheet(n: u32, model: &str, poisson: f64, body: &str) -> Scene {
    scene(
        &format!("Rectangle(width: 1, height: 1, columns: {n}, rows: {n}, diagonals: Alternating)"),
        model,
        poisson,
        body,
    )
}

fn scene(mesh: &str, model: &str, poisson: f64, body: &str) -> Scene {
    let level = level(&format!(
        "(name: \"sheet\", bodies: [(name: \"sheet\", mesh: {mesh}, mass: Density(1), {body}
            material: (model: {model}, young: 1000, poisson: {poisson}, plane: Strain))],
          effects: [(effect: Gravity(down: 9.81)), (effect: Rayleigh(mass: 0.5, stiffness: 0.001))])"
    ));
    Scene::build(&level, level.mode, &NoFiles, None).unwrap()
}

/// One step.
fn stepped(scene: &Scene, integrator: &IntegratorKind, from: &State, work: &mut Workspace) -> (State, NewtonCounts) {
    let mut state = from.clone();
    let mut physics = Physics::new(scene);
    let counts = integrator.kind().step(&mut physics, &mut state, work, STEP);
    (state, counts.newton)
}

/// The longest way of any vertex from one list to another.
fn farthest(one: &[f64], other: &[f64]) -> f64 {
    let ways = one.chunks_exact(2).zip(other.chunks_exact(2));
    ways.map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1])).fold(0.0, f64::max)
}

/// How far steps by iterations end from those with factors, as a share of what the scheme is off in each, at least of the longest
/// way; the greatest of some steps, and what all of them took.
fn compare(scene: &Scene, integrator: &IntegratorKind, steps: usize) -> (f64, NewtonCounts) {
    let [mut direct, mut iterative] = [LinearSolver::Direct, LinearSolver::Iterative].map(Workspace::new);
    let mut state = scene.start.clone();
    let (mut greatest, mut all) = (0.0_f64, NewtonCounts::NONE);
    for _ in 0..steps {
        let (exact, counts) = stepped(scene, integrator, &state, &mut direct);
        assert_eq!((counts.unconverged, counts.linear_iterations), (0, 0));
        let (near, counts) = stepped(scene, integrator, &state, &mut iterative);
        all.add(&counts);
        // What implicit Euler is off.
        let off = 0.5 * STEP * farthest(&exact.v, &state.v);
        greatest = greatest.max(farthest(&exact.x, &near.x) / off);
        state = exact;
    }
    assert_eq!(all.unconverged, 0);
    (greatest, all)
}

/// They differ by less than a thousandth of the error of the scheme.
#[test]
fn iterative_and_direct_steps_agree() {
    let pinned = "pins: [Top, Vertex(100)], stretch: (1.05, 1.02),";
    for model in models() {
        for name in ["ImplicitEuler", "Bdf2", "ImplicitMidpoint", "EnergyMomentum", "LinearlyImplicitEuler"] {
            for body in ["stretch: (1.1, 0.95),", pinned] {
                let scene = sheet(20, model, 0.3, body);
                let (off, counts) = compare(&scene, &named(name), 4);
                assert!(off < 1e-3, "{model} {name} {body}: {off}");
                assert!(counts.linear_iterations > 0, "{model} {name} {body}: {counts:?}");
                assert!(counts.abandoned <= 1, "{model} {name} {body}: {counts:?}");
            }
        }
    }
}

#[test]
fn the_same_step_has_the_same_bits_whatever_was_solved_before() {
    let scene = sheet(20, "NeoHookean", 0.3, "pins: [Left], stretch: (1.1, 0.95),");
    let euler = named("ImplicitEuler");
    let step = |from: &State, work: &mut Workspace| stepped(&scene, &euler, from, work);
    let mut work = Workspace::new(LinearSolver::Iterative);
    let mut states = vec![scene.start.clone()];
    for _ in 0..4 {
        let (next, counts) = step(states.last().unwrap(), &mut work);
        assert!(counts.linear_iterations > 0);
        states.push(next);
    }
    for pair in states.windows(2).rev() {
        work.forget();
        for work in [&mut work, &mut Workspace::new(LinearSolver::Iterative)] {
            assert_eq!(step(&pair[0], work).0, pair[1]);
        }
    }
}

/// One system is sixteen times as large as the other.
#[test]
fn the_iteration_count_hardly_depends_on_the_mesh() {
    let [small, large] = [20, 80].map(|n| {
        let scene = sheet(n, "Corotated", 0.3, "pins: [Left], stretch: (1.1, 0.95),");
        let euler = named("ImplicitEuler");
        stepped(&scene, &euler, &scene.start, &mut Workspace::new(LinearSolver::Iterative)).1
    });
    assert!(large.abandoned == 0 && large.iterations <= small.iterations, "{small:?} {large:?}");
    assert!(2 * large.linear_iterations <= 3 * small.linear_iterations, "{small:?} {large:?}");
}

/// Small systems are factorised, large ones are iterated.
#[test]
fn the_coupling_pattern_chooses_the_linear_solver() {
    for (n, path) in [(32, LinearSolver::Direct), (110, LinearSolver::Iterative)] {
        for model in ["Corotated", "NeoHookean"] {
            let scene = sheet(n, model, 0.3, "stretch: (1.1, 0.95),");
            let euler = named("ImplicitEuler");
            let step = |path| stepped(&scene, &euler, &scene.start, &mut Workspace::new(path));
            let (chosen, counts) = step(LinearSolver::Chosen);
            assert_eq!(counts.linear_iterations > 0, path == LinearSolver::Iterative, "{n}: {counts:?}");
            assert!((chosen, counts) == step(path), "{n} {model}");
        }
    }
}

/// The change is counted.
#[test]
fn slow_iterations_fall_back_to_a_factor() {
    // Near incompressibility triangles resist any change of their areas, which sweeps over single vertices cannot see.
    let strip = "Rectangle(width: 1, height: 0.05, columns: 200, rows: 10, diagonals: Alternating)";
    for model in ["Corotated", "NeoHookean"] {
        let scene = scene(strip, model, 0.4999, "pins: [Left, Right],");
        let (off, counts) = compare(&scene, &named("ImplicitEuler"), 4);
        assert!(off < 1e-3, "{model}: {off}");
        assert!(counts.abandoned > 0 && counts.factorisations >= counts.abandoned, "{model}: {counts:?}");
    }
}

#[test]
fn a_matrix_that_is_not_definite_is_met_and_replaced() {
    for model in ["Corotated", "StVenantKirchhoff"] {
        let scene = sheet(20, model, 0.3, "stretch: (0.6, 0.6),");
        let (_, counts) = compare(&scene, &named("ImplicitEuler"), 2);
        assert!(counts.indefinite > 0, "{model}: {counts:?}");
    }
}
