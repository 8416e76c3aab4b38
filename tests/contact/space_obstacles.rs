//! Facts about obstacles in space: membranes and nets on spheres, planes, boxes and cylinders.
#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "a failing test should panic")]

use crate::common::{level, named, reopened, simulation};
use gingerbread::{
    contact::segment_meets_triangle,
    integrators::IntegratorKind,
    level::{Level, Sleep, Substeps},
    meshes::NoFiles,
    scene::Scene,
    simulation::Simulation,
};

const OBSTACLES: [&str; 4] = [
    "Sphere(centre: (0.21, -0.31, 0.17), radius: 0.3, eps: 0.01)",
    "HalfSpace(point: (0, -0.01, 0), normal: (0, 1, 0), eps: 0.01)",
    "Block(centre: (0.2, -0.11, 0.2), width: 0.3, height: 0.2, depth: 0.25, eps: 0.01)",
    "Cylinder(centre: (0.2, -0.03, 0.2), radius: 0.2, height: 0.04, eps: 0.01)",
];

/// Damping and friction.
const DAMPED: &str = "(effect: Rayleigh(mass: 0.5, stiffness: 0.001)), (effect: Friction(coefficient: 0.5)),";

/// A flat membrane of 0.4 m over an obstacle.
fn over(obstacle: &str, kind: IntegratorKind, effects: &str) -> Level {
    let level = level(&format!(
        "(name: \"\", membranes: [(name: \"cloth\", mesh: Rectangle(width: 0.4, height: 0.4, columns: 6, rows: 6, diagonals: Alternating, corner: (0, 0)),
        material: (model: NeoHookean, young: 20000, poisson: 0.3, plane: Stress), thickness: 0.01, mass: Density(100), space: (turn: (90, 0, 0), offset: (0, 0.03, 0)))],
        effects: [(effect: Gravity(down: 2)), (effect: Walls(obstacles: [{obstacle}])), {effects}])"
    ));
    Level { integrator: kind, ..level }
}

fn stepped(level: &Level, step: f64) -> Simulation {
    let mut simulation = simulation(level);
    let scene = Scene { step, sleep: Sleep::Off, ..simulation.scene().clone() };
    simulation.replace_scene(scene);
    simulation
}

/// The force of contact is the slope of its energy, and the stiffness that of the force.
#[test]
fn forces_on_obstacles_are_slopes_of_an_energy() {
    for obstacle in OBSTACLES {
        let mut simulation = stepped(&over(obstacle, named("VelocityVerlet"), ""), 1e-3);
        while simulation.energies().contact == 0.0 && simulation.state().time < 1.0 {
            simulation.advance(4, &mut || true);
        }
        simulation.advance(if obstacle.starts_with("HalfSpace") { 8 } else { 25 }, &mut || true);
        let (scene, state) = (simulation.scene(), simulation.state().clone());
        let contact = scene.effects.iter().find_map(|effect| effect.contact()).unwrap();
        let still = vec![0.0; state.v.len()];
        let moved = |number: usize, by: f64| {
            let mut x = state.x.clone();
            x[number] += by;
            x
        };
        let at = |x: &[f64], act: &mut dyn FnMut(gingerbread::effects::Motion<'_>)| {
            act(gingerbread::effects::Motion { x, v: &still, anchors: &[], ..scene.motion(&state, None) });
        };
        let energy = |x: &[f64]| {
            let mut energy = 0.0;
            at(x, &mut |motion| energy = contact.energy(motion));
            energy
        };
        let force = |x: &[f64]| {
            let mut force = vec![0.0; x.len()];
            at(x, &mut |motion| contact.force(motion, &mut force));
            force
        };
        let (now, mut touched) = (force(&state.x), 0);
        for (number, now) in now.iter().enumerate() {
            let slope = (energy(&moved(number, 1e-7)) - energy(&moved(number, -1e-7))) / 2e-7;
            touched += usize::from(slope != 0.0);
            assert!((now + slope).abs() < 1e-5 * (1.0 + slope.abs()), "{obstacle}: {now} {slope}");
        }
        assert!(touched > 3, "{obstacle}: {touched}");
    }
}

/// Every scheme lets a membrane fall on every obstacle: no vertex ends inside, and the energy does not grow.
#[test]
fn every_integrator_falls_on_every_obstacle() {
    for kind in IntegratorKind::all() {
        for obstacle in OBSTACLES {
            let step = if kind.name() == "ForwardEuler" { 1e-4 } else { 1e-3 };
            let mut simulation = stepped(&over(obstacle, kind.clone(), DAMPED), step);
            let start = simulation.energies().total();
            let mut touches = false;
            for _ in 0..50 {
                simulation.advance((0.01 / step).round() as u64, &mut || true);
                touches |= !simulation.state().anchors.is_empty();
            }
            let name = kind.name();
            assert!(simulation.fault().is_none(), "{name} {obstacle}: {:?}", simulation.fault());
            assert_eq!(simulation.count_inside(), 0, "{name} {obstacle}");
            assert!(touches, "{name} {obstacle}");
            let gain = simulation.energies().total() - start;
            assert!(gain < 1e-3, "{name} {obstacle}: {gain} J");
        }
    }
}

/// Coulomb's law on a slope that no axis is along: `a = g (sin - mu cos)` beyond the angle of friction, and rest below it.
#[test]
fn friction_on_a_slope_in_space_is_that_of_coulomb() {
    // tan 0.5, and turned by 30 degrees about the vertical.
    let slide = |mu: f64, kind: IntegratorKind| {
        let level = level(&format!(
            "(name: \"\", membranes: [(name: \"sheet\", mesh: Rectangle(width: 0.2, height: 0.2, columns: 2, rows: 2, diagonals: Alternating, corner: (-0.1, -0.1)),
            material: (model: StVenantKirchhoff, young: 20000, poisson: 0.3, plane: Stress), thickness: 0.01, mass: Density(100), space: (turn: (-90, 30, 26.565051177077990)))],
            effects: [(effect: Gravity(down: 9.81)), (effect: Restitution(coefficient: 0.1)), (effect: Friction(coefficient: {mu})), (effect: Rayleigh(mass: 0, stiffness: 0.001)),
            (effect: Walls(obstacles: [HalfSpace(point: (0, -0.0347, 0), normal: (-0.5, 1, 0), eps: 0.01)]))])"
        ));
        let mut simulation = simulation(&Level { integrator: kind, ..level });
        let scene = Scene { step: 5e-4, sleep: Sleep::Off, ..simulation.scene().clone() };
        simulation.replace_scene(scene);
        let middle = |simulation: &Simulation| {
            let x = &simulation.state().x;
            let count = (x.len() / 3) as f64;
            [0, 1, 2].map(|axis| x.iter().skip(axis).step_by(3).sum::<f64>() / count)
        };
        simulation.advance(2000, &mut || true);
        let (from, speed) = (middle(&simulation), simulation.state().v.clone());
        simulation.advance(1000, &mut || true);
        assert!(simulation.fault().is_none(), "{:?}", simulation.fault());
        let to = middle(&simulation);
        let count = (speed.len() / 3) as f64;
        let mean = |axis: usize| speed.iter().skip(axis).step_by(3).sum::<f64>() / count;
        let (c, s) = (2.0 / 5.0_f64.sqrt(), 1.0 / 5.0_f64.sqrt());
        let along = |vector: [f64; 3]| -(c * vector[0] + s * vector[1]);
        (along([0, 1, 2].map(|axis| to[axis] - from[axis])), along([0, 1, 2].map(mean)))
    };
    for scheme in ["VelocityVerlet", "ImplicitMidpoint"] {
        let (gone, speed) = slide(0.3, named(scheme));
        let a = 9.81 * (0.5 - 0.3) * 2.0 / 5.0_f64.sqrt();
        let expected = speed * 0.5 + 0.125 * a;
        assert!((gone - expected).abs() < 0.01 * expected, "{scheme}: {gone} m, {expected} m by Coulomb's law");
        let (gone, _) = slide(0.6, named(scheme));
        assert!(gone.abs() < 1e-4, "{scheme}: {gone} m");
    }
}

/// Saved in contact, with anchors of friction, and continued: every bit is the same.
#[test]
fn what_lies_on_an_obstacle_is_saved() {
    for kind in IntegratorKind::all() {
        for obstacle in [OBSTACLES[0], MOVING] {
            let mut level = over(obstacle, kind.clone(), DAMPED);
            level.substeps = Substeps::new(if kind.name() == "ForwardEuler" { 167 } else { 17 }).unwrap();
            let mut simulation = simulation(&level);
            let frame = simulation.scene().steps_per_frame();
            while simulation.state().anchors.len() < 3 && simulation.state().time < 1.0 {
                simulation.advance(frame, &mut || true);
            }
            assert!(simulation.state().anchors.iter().any(|anchor| anchor.point[2] != 0.0), "{}", kind.name());
            let mut again = reopened(&simulation, &level);
            for run in [&mut simulation, &mut again] {
                run.advance(3 * frame, &mut || true);
            }
            assert_eq!(again.state(), simulation.state(), "{} {obstacle}", kind.name());
        }
    }
}

const MOVING: &str = "Moving(obstacle: Sphere(centre: (0.2, -0.31, 0.2), radius: 0.3, eps: 0.01), motions: [Swing(way: (0.02, 0.01, 0.02), period: 0.5), Turn(about: (0.2, -0.31, 0.2), axis: (1, 1, 0), spin: 3)])";

/// Obstacles of another dimension than the scene, and shapes without a direction, are refused in words.
#[test]
fn obstacles_fit_the_scene() {
    let refused = |text: &str| {
        let level = level(text);
        Scene::build(&level, level.mode, &NoFiles, None).err().unwrap().to_string()
    };
    let plane = |obstacle: &str| {
        let body = "(name: \"body\", mesh: Rectangle(width: 1, height: 1, columns: 1, rows: 1, diagonals: Alternating, corner: (0, 0)), material: (model: NeoHookean, young: 1000, poisson: 0.3, plane: Stress), mass: Density(1))";
        refused(&format!("(name: \"\", bodies: [{body}], effects: [(effect: Walls(obstacles: [{obstacle}]))])"))
    };
    let error = plane(OBSTACLES[0]);
    assert!(error.contains("Walls acts on vertices with 3 coordinates, but those of the scene have 2"), "{error}");
    let error =
        plane("Moving(obstacle: Ball(centre: (0, 0), radius: 1, eps: 0), motions: [Swing(way: (1, 0, 1), period: 1)])");
    assert!(error.contains("its motion Swing is in space, but the scene is in the plane"), "{error}");
    let space = |obstacles: &str| {
        let level = over(obstacles, named("RungeKutta4"), "");
        Scene::build(&level, level.mode, &NoFiles, None).err().unwrap().to_string()
    };
    let error = space("Ball(centre: (0, 0), radius: 1, eps: 0)");
    assert!(error.contains("2 coordinates"), "{error}");
    let error = space(&format!("{}, Ball(centre: (0, 0), radius: 1, eps: 0)", OBSTACLES[0]));
    assert!(error.contains("obstacle 1 (Ball): it is in the plane, but other obstacles are in space"), "{error}");
    let error = space("HalfSpace(point: (0, 0, 0), normal: (0, 0, 0), eps: 0)");
    assert!(error.contains("obstacle 0 (HalfSpace): a plane's normal must have a direction"), "{error}");
    let error = space(
        "Moving(obstacle: Sphere(centre: (0, 0, 0), radius: 1, eps: 0), motions: [Turn(about: (0, 0), axis: (0, 0, 0), spin: 1)])",
    );
    assert!(error.contains("the axis of a turn must have a direction"), "{error}");
}

/// The segments of the edges of a box, or of the rim of an upright cylinder, in short pieces.
fn sharp_edges(obstacle: &str) -> Vec<[[f64; 3]; 2]> {
    const PIECES: usize = 200;
    let at = |t: usize| t as f64 / PIECES as f64;
    if obstacle.starts_with("Block") {
        let (centre, half) = ([0.2, -0.11, 0.2], [0.15, 0.1, 0.125]);
        let corner = |signs: [f64; 3]| [0, 1, 2].map(|axis| centre[axis] + signs[axis] * half[axis]);
        return (0..3)
            .flat_map(|axis| [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]].map(|others| (axis, others)))
            .flat_map(|(axis, [one, other])| {
                (0..PIECES).map(move |piece| {
                    [at(piece), at(piece + 1)].map(|t| {
                        let mut signs = [0.0; 3];
                        (signs[axis], signs[(axis + 1) % 3], signs[(axis + 2) % 3]) = (2.0 * t - 1.0, one, other);
                        corner(signs)
                    })
                })
            })
            .collect();
    }
    let rim = |angle: f64, y: f64| [0.2 + 0.13 * angle.cos(), y, 0.2 + 0.13 * angle.sin()];
    let piece = |piece: usize, y: f64| [at(piece), at(piece + 1)].map(|t| rim(std::f64::consts::TAU * t, y));
    (0..PIECES).flat_map(|number| [-0.05, -0.01].map(|y| piece(number, y))).collect()
}

/// Coarse cloth hangs over a box and over a round table, whose edges are sharp. No edge passes through a triangle, at any moment.
#[test]
fn sharp_edges_do_not_reach_through_cloth() {
    for obstacle in [OBSTACLES[2], ROUND] {
        let edges = sharp_edges(obstacle);
        for scheme in ["VelocityVerlet", "ImplicitEuler", "DormandPrince"] {
            let mut simulation = stepped(&over(obstacle, named(scheme), DAMPED), 1e-3);
            let mut hangs = false;
            for _ in 0..40 {
                simulation.advance(50, &mut || true);
                let x = &simulation.state().x;
                let point = |corner: u32| [0, 1, 2].map(|axis| x[3 * corner as usize + axis]);
                let faces: Vec<_> = simulation.scene().membranes[0].elements.corners().to_vec();
                for corners in faces.into_iter().map(|corners| corners.map(point)) {
                    assert!(
                        edges.iter().all(|edge| !segment_meets_triangle(*edge, corners)),
                        "{scheme} {obstacle}: {} s, {corners:?}",
                        simulation.state().time
                    );
                }
                hangs |= x.iter().skip(1).step_by(3).any(|y| *y < -0.06);
            }
            assert!(simulation.fault().is_none() && hangs, "{scheme} {obstacle}: {:?}", simulation.fault());
        }
    }
}

/// A flat cloth over a table presses as over a plane: the points of its triangles share the area of its vertices.
#[test]
fn points_of_triangles_share_the_area() {
    let energies = ["HalfSpace(point: (0, -0.01, 0), normal: (0, 1, 0), eps: 0.01)", TABLE].map(|obstacle| {
        let mut simulation = stepped(&over(obstacle, named("VelocityVerlet"), ""), 1e-3);
        let scene = simulation.scene().clone();
        let contact = scene.effects.iter().find_map(|effect| effect.contact()).unwrap();
        let mut state = simulation.state().clone();
        state.x.iter_mut().skip(1).step_by(3).for_each(|y| *y = -0.001);
        let energy = contact.energy(gingerbread::effects::Motion { anchors: &[], ..scene.motion(&state, None) });
        simulation.advance(1, &mut || true);
        let mut count = 0;
        contact.force(scene.motion(&state, None), &mut vec![0.0; state.x.len()]);
        if let gingerbread::contact::AnyContact::Space(contact) = contact {
            contact.each(scene.motion(&state, None), &mut |_| count += 1);
        }
        (energy, count)
    });
    let [(plane, vertices), (table, points)] = energies;
    assert_eq!(vertices, 49);
    // Every side is halved.
    assert_eq!(points, 13 * 13);
    assert!(plane > 0.0 && (table - plane).abs() < 1e-12 * plane, "{table} J, {plane} J");
}

/// A coarse sheet falls on a ball much smaller than its triangles, between its vertices. No triangle comes nearer to the centre than the radius.
#[test]
fn a_small_ball_does_not_pass_through_cloth() {
    let (centre, radius) = ([0.235, -0.06, 0.21], 0.03);
    let ball = "Sphere(centre: (0.235, -0.06, 0.21), radius: 0.03, eps: 0.005)";
    for scheme in ["SymplecticEuler", "ImplicitMidpoint"] {
        let mut simulation = stepped(&over(ball, named(scheme), DAMPED), 1e-3);
        let mut touches = false;
        for _ in 0..20 {
            simulation.advance(25, &mut || true);
            let x = &simulation.state().x;
            let point = |corner: u32| [0, 1, 2].map(|axis| x[3 * corner as usize + axis]);
            for corners in simulation.scene().membranes[0].elements.corners() {
                let corners = corners.map(point);
                let nearest = (0..=60).flat_map(|a| (0..=60 - a).map(move |b| [a, b, 60 - a - b])).map(|shares| {
                    let square = |axis: usize| {
                        let at = (0..3).map(|i| f64::from(shares[i]) / 60.0 * corners[i][axis]).sum::<f64>();
                        (at - centre[axis]).powi(2)
                    };
                    (square(0) + square(1) + square(2)).sqrt()
                });
                let nearest = nearest.fold(f64::INFINITY, f64::min);
                assert!(nearest > radius, "{scheme}: {nearest} m at {} s", simulation.state().time);
                touches |= nearest < radius + 0.02;
            }
        }
        assert!(touches && simulation.fault().is_none(), "{scheme}: {:?}", simulation.fault());
    }
}

/// A round table much smaller than the cloth.
const ROUND: &str = "Cylinder(centre: (0.2, -0.03, 0.2), radius: 0.13, height: 0.04, eps: 0.01)";

/// A table greater than the cloth.
const TABLE: &str = "Block(centre: (0.2, -0.11, 0.2), width: 2, height: 0.2, depth: 2, eps: 0.01)";

/// A table that begins to move pulls cloth along with the acceleration mu g, until the cloth is as fast.
#[test]
fn a_moving_table_pulls_cloth_by_friction() {
    let table = format!("Moving(obstacle: {TABLE}, motions: [Slide(velocity: (0.18, 0), velocity_z: 0.24, from: 1)])");
    let level = over(
        &table,
        named("VelocityVerlet"),
        "(effect: Friction(coefficient: 0.3)), (effect: Restitution(coefficient: 0.1))",
    );
    let mut simulation = stepped(&level, 5e-4);
    let velocity = |simulation: &Simulation| {
        let v = &simulation.state().v;
        [0, 1, 2].map(|axis| v.iter().skip(axis).step_by(3).sum::<f64>() / (v.len() / 3) as f64)
    };
    let along = |simulation: &Simulation| {
        let [x, _, z] = velocity(simulation);
        0.6 * x + 0.8 * z
    };
    simulation.advance(2200, &mut || true);
    let first = along(&simulation);
    simulation.advance(400, &mut || true);
    let gained = (along(&simulation) - first) / 0.2;
    assert!((gained - 0.3 * 2.0).abs() < 0.006, "{gained} m/s²");
    simulation.advance(2400, &mut || true);
    let [x, _, z] = velocity(&simulation);
    assert!((x - 0.18).abs() < 1e-3 && (z - 0.24).abs() < 1e-3, "{x} {z}");
    assert!(simulation.fault().is_none(), "{:?}", simulation.fault());
}
