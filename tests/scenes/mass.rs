//! Facts about the consistent mass matrix.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{continues_bit_for_bit, greatest_gap, integrator, level, material, norm, simulation};
use gingerbread::{
    elements::{CoupledMass, Triangles},
    integrators::{Class, IntegratorKind},
    level::{Level, Substeps},
    meshes::{Mesh, NoFiles},
    scene::Scene,
    simulation::Simulation,
    stability::{critical_step, largest_eigenvalue},
    study::Moment,
};
use std::sync::Arc;

/// A rectangle of 2 m x 1 m about the origin: a body of 10 kg/m², or a membrane of the same mass.
fn rectangle(in_space: bool, mass: &str, rest: &str) -> Level {
    let mesh = "mesh: Rectangle(width: 2, height: 1, columns: 4, rows: 2, diagonals: Crossed, corner: (-1, -0.5))";
    let material = "material: (model: NeoHookean, young: 10000, poisson: 0.3)";
    let kind = if in_space {
        format!("membranes: [(name: \"cloth\", thickness: 0.01, mass: {mass}(1000), {mesh}, {material}, {rest})]")
    } else {
        format!("bodies: [(name: \"body\", mass: {mass}(10), {mesh}, {material}, {rest})]")
    };
    level(&format!("(name: \"\", sleep: Off, {kind})"))
}

fn swinging(in_space: bool, mass: &str) -> Level {
    rectangle(in_space, mass, "stretch: (1.1, 0.9), pins: [Left]")
}

/// The matrix integrates products of linear functions exactly: here ρ/2 ∫ |v|² and ρ ∫ x × v over the rectangle. Lumped masses do not.
#[test]
fn energy_and_momentum_of_a_linear_velocity_field_are_exact() {
    let ([w, h], density) = ([2.0_f64, 1.0_f64], 10.0);
    let [ix, iy] = [h * w.powi(3) / 12.0, w * h.powi(3) / 12.0];
    for in_space in [false, true] {
        for mass in ["Consistent", "Density"] {
            let mut run = simulation(&rectangle(in_space, mass, ""));
            let mut state = run.state().clone();
            let (a, b, c, spin) = (0.7, -0.3, 1.9, 0.4);
            let dimension = if in_space { 3 } else { 2 };
            for (x, v) in state.x.chunks_exact(dimension).zip(state.v.chunks_exact_mut(dimension)) {
                v[0] = a * x[0] + b - spin * x[1];
                v[1] = c * x[1] + spin * x[0];
            }
            run.set_state(state);
            let squares = (a * a + spin * spin) * ix + (c * c + spin * spin) * iy + b * b * w * h;
            let (energy, turn) = (0.5 * density * squares, density * spin * (ix + iy));
            let moment = Moment::of(&run, 0.0);
            let errors = [
                moment.kinetic / energy - 1.0,
                moment.angular[2] / turn - 1.0,
                moment.momentum[0] / (density * w * h * b) - 1.0,
            ];
            let exact = |error: f64| error.abs() < 1e-13;
            let wanted = if mass == "Consistent" { [true; 3] } else { [false, false, true] };
            assert_eq!(errors.map(exact), wanted, "{mass}, in space: {in_space}: {errors:?}");
        }
    }
}

/// Motions of a free triangle without translation have a quarter of their lumped mass.
#[test]
fn a_free_triangle_vibrates_twice_as_fast() {
    let mesh = Mesh::new(vec![[0.0, 0.0], [1.0, 0.1], [0.3, 0.8]], vec![[0, 1, 2]]).unwrap();
    let rest = mesh.points().as_flattened().to_vec();
    let triangle = Arc::new(Triangles::new(&rest, 0..3, &mesh, material(5000.0).into()));
    let mut scene = Scene::of_elements(2, rest, &[2.0; 3], vec![triangle]).unwrap();
    let lumped = largest_eigenvalue(&scene, &scene.start, None).unwrap();
    scene.coupled_mass = Arc::new(CoupledMass::new(std::iter::once(([0, 1, 2], 6.0))));
    let ratio = largest_eigenvalue(&scene, &scene.start, None).unwrap() / lumped;
    assert!((ratio - 4.0).abs() < 1e-9, "the square of the frequency is {ratio} times as large");
}

/// Explicit schemes multiply by the inverse, implicit ones have the matrix in their equations; all converge to the same motion, and not to
/// that of lumped masses.
#[test]
fn every_scheme_converges_to_the_same_motion() {
    for in_space in [false, true] {
        let end = |kind: IntegratorKind, mass: &str, substeps: u32| {
            let substeps = Substeps::new(substeps).unwrap();
            let mut run = simulation(&Level { integrator: kind, substeps, ..swinging(in_space, mass) });
            run.advance(6 * u64::from(substeps.get()), &mut || true);
            assert!(run.fault().is_none() && run.counts().guarded == 0, "{:?}", run.fault());
            run.state().x.clone()
        };
        let exact = end(integrator("RungeKutta4()"), "Consistent", 60);
        let start = simulation(&swinging(in_space, "Consistent")).state().x.clone();
        let moved = greatest_gap(&exact, &start);
        let lumped = greatest_gap(&exact, &end(integrator("RungeKutta4()"), "Density", 60)) / moved;
        for kind in IntegratorKind::all() {
            let first = kind.kind().order() == 1;
            let name = kind.name();
            let gap = greatest_gap(&end(kind, "Consistent", if first { 960 } else { 60 }), &exact) / moved;
            assert!(gap < if first { 0.02 } else { 0.01 }, "{name}, in space: {in_space}: {gap}");
            assert!(gap < 0.4 * lumped, "{name}: {gap}, with lumped masses {lumped}");
        }
    }
}

/// The gauge of the longest stable step knows the matrix.
#[test]
fn explicit_steps_are_stable_up_to_the_limit_that_is_told() {
    for in_space in [false, true] {
        let base = swinging(in_space, "Consistent");
        let built = Scene::build(&base, base.mode, &NoFiles, None).unwrap();
        let rest = gingerbread::state::State { x: built.rest.clone(), ..built.start.clone() };
        let limit = critical_step(&built, &rest, None).unwrap();
        let end = |share: f64| {
            let scene = Scene { step: share * limit, guard: false, ..built.clone() };
            let mut state = rest.clone();
            state.x.iter_mut().zip(&built.start.x).for_each(|(x, start)| *x += 1e-6 * (start - *x));
            let mut run = Simulation::new(scene, state);
            let before = run.energies().total();
            run.advance(3000, &mut || true);
            if run.fault().is_some() { f64::INFINITY } else { run.energies().total() / before }
        };
        let [below, above] = [0.98, 1.02].map(end);
        assert!(below < 10.0 && above > 1e3, "in space: {in_space}: {below} and {above} times the energy");
    }
}

#[test]
fn a_saved_run_continues_bit_for_bit_under_every_scheme() {
    for kind in IntegratorKind::all() {
        let substeps = Substeps::new(if kind.kind().class() == Class::Explicit { 30 } else { 2 }).unwrap();
        continues_bit_for_bit(&Level { integrator: kind, substeps, ..swinging(true, "Consistent") });
    }
}

/// Each with steps of its own, two bodies move as each does with the same short steps.
#[test]
fn bodies_with_substeps_of_their_own_keep_the_matrix() {
    let of = |paces: &str, substeps: u32| {
        let body = |name: &str, young: u32, x: u32| {
            format!(
                "(name: \"{name}\", mass: Consistent(10), material: (model: Corotated, young: {young}, poisson: 0.3), stretch: (1.1, 1),
                    mesh: Rectangle(width: 1, height: 1, columns: 2, rows: 2, diagonals: Grid), place: (offset: ({x}, 0)), pins: [Left])"
            )
        };
        let text = format!(
            "(name: \"\", paces: {paces}, substeps: {substeps}, integrator: VelocityVerlet(), bodies: [{}, {}])",
            body("soft", 1000, 0),
            body("stiff", 100_000, 2)
        );
        let mut run = simulation(&level(&text));
        run.advance(12 * u64::from(substeps), &mut || true);
        assert!(run.fault().is_none() && run.counts().guarded == 0, "{:?}", run.fault());
        run
    };
    let own = of("Own", 20);
    let steps: Vec<_> = own.substep_plans().map(|plan| plan.steps).collect();
    assert!(steps[1] > steps[0], "{steps:?}");
    for (body, steps) in steps.into_iter().enumerate() {
        let same = of("Same", 20 * steps);
        let numbers = own.scene().numbers(&own.scene().bodies[body].vertices);
        let gap = greatest_gap(&own.state().x[numbers.clone()], &same.state().x[numbers]);
        assert!(gap < 1e-12, "body {body}: {gap} m");
    }
}

/// A block falls on the floor: energy is lost alone, and it ends at rest there.
#[test]
fn a_body_with_it_falls_on_a_floor_under_every_scheme() {
    for kind in IntegratorKind::all() {
        let explicit = kind.kind().class() == Class::Explicit;
        let text = format!(
            "(name: \"\", substeps: {}, bodies: [(name: \"block\", mass: Consistent(100), place: (offset: (0.4, 0.02)),
                mesh: Rectangle(width: 0.2, height: 0.1, columns: 4, rows: 2, diagonals: Alternating),
                material: (model: NeoHookean, young: 20000, poisson: 0.3))],
            effects: [(effect: Gravity(down: 9.81)), (effect: Rayleigh(mass: 1, stiffness: 0.001)), (effect: Friction(coefficient: 0.3)),
                (effect: Contact(modulus: 1, dissipation: 1)), (effect: Boundary(least: (0, 0), greatest: (1, 1)))])",
            if explicit { 60 } else { 8 }
        );
        let name = kind.name();
        let mut run = simulation(&Level { integrator: kind, ..level(&text) });
        let before = run.energies().total();
        let steps = run.scene().steps_per_frame() * 120;
        run.advance(steps, &mut || true);
        assert!(run.fault().is_none(), "{name}: {:?}", run.fault());
        let energies = run.energies();
        assert!(energies.total() <= before, "{name}: {} J of {before} J", energies.total());
        assert!(norm(&run.state().v) < 0.05, "{name}: {} m/s", norm(&run.state().v));
        let lowest = run.state().x.iter().skip(1).step_by(2).copied().fold(f64::INFINITY, f64::min);
        assert!((0.0..0.02).contains(&lowest), "{name}: {lowest} m");
    }
}

#[test]
fn effects_that_need_lumped_masses_say_so() {
    let rods = "effects: [(effect: MovingPins(of: \"body\", pins: [Right], motions: []))]";
    let with = |mass: &str| {
        let mut level = swinging(false, mass);
        level.effects = self::level(&format!("(name: \"\", bodies: [], {rods})")).effects;
        Scene::build(&level, level.mode, &NoFiles, None)
    };
    assert!(with("Density").is_ok());
    let why = with("Consistent").err().unwrap().to_string();
    assert!(why.contains("Moving pins") && why.contains("Consistent"), "{why}");
}
