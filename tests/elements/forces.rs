//! Facts about the forces of a mesh, for every registered constitutive model.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{
    Random, assert_balanced, assert_minus_derivative, difference_error, level, models, norm, rotation, sheet, sheets,
    simulation,
};
use gingerbread::{
    effects::{Effect, EffectKind, Motion},
    elements::{ElementKind, Elements, Triangles},
    scene::Scene,
    simulation::Simulation,
};
use nalgebra::{Matrix2, Vector2};

/// Positions moved a little at random.
fn shaken(x: &[f64], by: f64, seed: u64) -> Vec<f64> {
    let mut random = Random(seed);
    x.iter().map(|x| x + random.between(-by, by)).collect()
}

fn elements(simulation: &Simulation) -> &Triangles {
    &simulation.scene().bodies[0].elements
}

fn of(scene: &Scene) -> Elements {
    Elements { triangles: vec![std::sync::Arc::clone(&scene.bodies[0].elements)], ..Elements::default() }
}

fn forces(body: &Triangles, x: &[f64]) -> Vec<f64> {
    let (mut force, mut scratch) = (vec![0.0; x.len()], vec![0.0; body.scratch()]);
    body.elastic_force(x, &mut scratch, &mut force);
    force
}

/// x -> A x + b on flat points.
fn mapped(x: &[f64], a: Matrix2<f64>, b: Vector2<f64>) -> Vec<f64> {
    x.chunks_exact(2).flat_map(|p| <[f64; 2]>::from(a * Vector2::new(p[0], p[1]) + b)).collect()
}

#[test]
fn force_is_minus_the_derivative_of_energy() {
    for (what, level) in sheets("") {
        let simulation = simulation(&level);
        let body = elements(&simulation);
        let x = shaken(&simulation.scene().rest, 0.015, 1);
        let force = forces(body, &x);
        assert_minus_derivative(&x, &force, |x| body.elastic_energy(x), &what);
    }
}

#[test]
fn stiffness_times_a_displacement_is_the_change_of_force() {
    for (what, level) in sheets("") {
        let simulation = simulation(&level);
        let body = elements(&simulation);
        let x = shaken(&simulation.scene().rest, 0.015, 1);
        let d = shaken(&vec![0.0; x.len()], 1.0, 2);
        let mut product = vec![0.0; x.len()];
        let motion = Motion { dimension: 2, x: &x, v: &d, mass: &d, inverse_mass: &d, ..Motion::NONE };
        body.stiffness_times(motion, &d, &mut vec![0.0; body.scratch()], &mut product);
        let best = difference_error(&x, &d, &product, |x| forces(body, x));
        assert!(best < 1e-8, "{what}: {best:e}");
    }
}

#[test]
fn elastic_forces_have_no_sum_and_no_torque() {
    for (what, level) in sheets("") {
        let simulation = simulation(&level);
        let x = shaken(&simulation.scene().rest, 0.015, 3);
        let force = forces(elements(&simulation), &x);
        assert_balanced(&x, &force, &what);
    }
}

/// The patch test: where the whole mesh deforms alike, no vertex inside feels a force.
#[test]
fn an_affine_deformation_leaves_the_inside_without_force() {
    let text =
        "(name: \"\", bodies: [(name: \"man\", mesh: Gingerbread(resolution: 500), mass: Total(1), element: KIND,
        material: (model: MODEL, young: 1, poisson: 0.3))])";
    for (model, kind) in models().flat_map(|model| ElementKind::ALL.map(|kind| (model, kind))) {
        let simulation = simulation(&level(&text.replace("MODEL", model).replace("KIND", &format!("{kind:?}"))));
        let body = &simulation.scene().bodies[0];
        let bent = Matrix2::new(1.3, 0.4, -0.2, 0.8);
        let force = forces(&body.elements, &mapped(&simulation.scene().rest, bent, Vector2::new(0.3, -2.0)));
        let edge: Vec<u32> = body.mesh.boundary_edges().into_iter().flatten().collect();
        let inside = (0..body.vertices.len()).filter(|vertex| !edge.contains(&(*vertex as u32)));
        let greatest = inside.map(|i| force[2 * i].hypot(force[2 * i + 1])).fold(0.0, f64::max);
        assert!(greatest < 1e-12 && norm(&force) > 1e-3, "{model} {kind:?}: {greatest:e}");
    }
}

#[test]
fn the_order_of_a_triangles_corners_does_not_matter() {
    let triangle = |order: &str, model: &str| {
        let text = format!(
            "(name: \"\", bodies: [(name: \"t\", mesh: Points(points: [(0, 0), (1, 0.1), (0.3, 0.8)], triangles: [{order}]),
              mass: Total(1), material: (model: {model}, young: 1, poisson: 0.3))])"
        );
        let simulation = simulation(&level(&text));
        let x = shaken(&simulation.scene().rest, 0.1, 4);
        forces(elements(&simulation), &x)
    };
    for model in models() {
        let first = triangle("(0, 1, 2)", model);
        for order in ["(1, 2, 0)", "(2, 0, 1)"] {
            let gap: Vec<_> = triangle(order, model).iter().zip(&first).map(|(a, b)| a - b).collect();
            assert!(norm(&gap) < 1e-14 * norm(&first), "{model} {order}");
        }
    }
}

#[test]
fn a_turned_scene_moves_as_the_scene_turned() {
    for degrees in [30.0, 90.0, 200.0] {
        let placed = format!("place: (turn: {degrees}), stretch: (1, 1), ");
        for ((what, plain), (_, placed)) in sheets("").zip(sheets(&placed)) {
            let (mut plain, mut turned) = (simulation(&plain), simulation(&placed));
            let q = rotation(f64::to_radians(degrees));
            let mut state = plain.state().clone();
            state.x = mapped(&state.x, Matrix2::new(1.2, 0.1, 0.0, 0.9), Vector2::zeros());
            let mut other = state.clone();
            other.x = mapped(&state.x, q, Vector2::zeros());
            plain.set_state(state);
            turned.set_state(other);
            plain.advance(300, &mut || true);
            turned.advance(300, &mut || true);
            let expected = mapped(&plain.state().x, q, Vector2::zeros());
            let gap: Vec<_> = expected.iter().zip(&turned.state().x).map(|(a, b)| a - b).collect();
            assert!(norm(&gap) < 1e-11, "{what} {degrees}: {:e}", norm(&gap));
        }
    }
}

/// Every effect's force is minus the derivative of its energy, with whatever its defaults are.
#[test]
fn effect_forces_are_minus_the_derivative_of_energy() {
    let simulation = simulation(&sheet("Corotated", "", ""));
    let scene: &Scene = simulation.scene();
    let bodies = of(scene);
    let grab = Some(gingerbread::effects::Grab { vertex: 3, target: [0.9, 0.2, 0.0] });
    let mut acting = 0;
    // Most of these act on cloth, and all have tests of their own; no energy belongs to body forces, edge loads, air, rain, pins, rods and projection.
    let cloth =
        ["BodyForce", "EdgeLoad", "Projection", "Wind", "Vortex", "Rain", "Bending", "MovingPins", "Rods", "Wire"];
    let in_plane = |kind: &EffectKind| !kind.kind().is_damping() && !cloth.contains(&kind.name());
    for kind in EffectKind::all().into_iter().filter(in_plane) {
        let effect = kind.kind().build(&bodies).unwrap();
        let x = shaken(&scene.rest, 0.01, 5);
        let v = vec![0.0; x.len()];
        let energy = |x: &[f64]| {
            effect.energy(Motion {
                dimension: 2,
                x,
                v: &v,
                mass: &scene.mass,
                inverse_mass: &scene.inverse_mass,
                grab,
                ..Motion::NONE
            })
        };
        let mut force = vec![0.0; x.len()];
        let motion = Motion {
            dimension: 2,
            x: &x,
            v: &v,
            mass: &scene.mass,
            inverse_mass: &scene.inverse_mass,
            grab,
            ..Motion::NONE
        };
        effect.force(motion, &mut vec![0.0; effect.scratch()], &mut force);
        for number in 0..x.len() {
            let (mut ahead, mut behind) = (x.clone(), x.clone());
            ahead[number] += 1e-6;
            behind[number] -= 1e-6;
            let slope = (energy(&ahead) - energy(&behind)) / 2e-6;
            assert!((force[number] + slope).abs() < 1e-8, "{} {number}", kind.name());
        }
        acting += u32::from(norm(&force) > 0.0);
    }
    assert!(acting >= 2, "gravity and the mouse spring, at least");
}

fn damping_force(mass: f64, stiffness: f64, x: &[f64], v: &[f64], simulation: &Simulation) -> Vec<f64> {
    let text = format!("(name: \"\", bodies: [], effects: [(effect: Rayleigh(mass: {mass}, stiffness: {stiffness}))])");
    let listed = &level(&text).effects[0];
    let scene = simulation.scene();
    let effect = listed.effect.kind().build(&of(scene)).unwrap();
    let mut force = vec![0.0; x.len()];
    let motion = Motion { dimension: 2, x, v, mass: &scene.mass, inverse_mass: &scene.inverse_mass, ..Motion::NONE };
    effect.force(motion, &mut vec![0.0; effect.scratch()], &mut force);
    force
}

/// The body is under stress.
#[test]
fn stiffness_damping_does_not_damp_a_rigid_motion() {
    for kind in ElementKind::ALL {
        let simulation = simulation(&sheet("NeoHookean", &format!("element: {kind:?}"), ""));
        let x = mapped(&simulation.scene().rest, Matrix2::new(1.4, 0.2, 0.0, 0.7), Vector2::zeros());
        let spinning: Vec<_> = x.chunks_exact(2).flat_map(|p| [2.0 - 5.0 * p[1], 1.0 + 5.0 * p[0]]).collect();
        let force = damping_force(0.0, 0.01, &x, &spinning, &simulation);
        assert!(norm(&force) < 1e-13, "{:e}", norm(&force));
        let shaking = shaken(&vec![0.0; x.len()], 1.0, 6);
        let force = damping_force(0.0, 0.01, &x, &shaking, &simulation);
        let power: f64 = force.iter().zip(&shaking).map(|(f, v)| f * v).sum();
        assert!(power < -1e-3, "damping must take power, takes {power}");
    }
}

#[test]
fn at_rest_damping_is_rayleighs() {
    for kind in ElementKind::ALL {
        let simulation = simulation(&sheet("StVenantKirchhoff", &format!("element: {kind:?}"), ""));
        let scene = simulation.scene();
        let v = shaken(&vec![0.0; scene.rest.len()], 1.0, 7);
        let force = damping_force(3.0, 0.02, &scene.rest, &v, &simulation);
        let mut expected = vec![0.0; v.len()];
        let motion = Motion {
            dimension: 2,
            x: &scene.rest,
            v: &v,
            mass: &scene.mass,
            inverse_mass: &scene.inverse_mass,
            ..Motion::NONE
        };
        let body = elements(&simulation);
        body.stiffness_times(motion, &v, &mut vec![0.0; body.scratch()], &mut expected);
        for ((expected, mass), v) in expected.iter_mut().zip(&scene.mass).zip(&v) {
            *expected = -0.02 * *expected - 3.0 * mass * v;
        }
        let gap: Vec<_> = force.iter().zip(&expected).map(|(a, b)| a - b).collect();
        assert!(norm(&gap) < 1e-13 * norm(&expected), "{kind:?}");
    }
}
