//! Facts about obstacles that move: what they push goes with them, nothing gets through them, and they are where time says.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{assert_apart, greatest_gap, level, simulation};
use gingerbread::{
    command::{Command, Mode},
    effects::{EffectKind, Shape},
    files,
    integrators::{Class, IntegratorKind},
    level::Level,
    meshes::NoFiles,
    obstacles::{MotionKind, Surfaces, placed},
    sandbox::Sandbox,
    simulation::Simulation,
};

/// A block of jelly 0.2 m wide with its lower left corner at a point.
fn block(integrator: &str, substeps: u32, [x, y]: [f64; 2], [vx, vy]: [f64; 2], effects: &str) -> Level {
    level(&format!(
        "(name: \"block\", substeps: {substeps}, integrator: {integrator}(), bodies: [(name: \"block\",
            mesh: Rectangle(width: 0.2, height: 0.2, columns: 4, rows: 4, diagonals: Alternating, corner: ({x:?}, {y:?})),
            material: (model: Corotated, young: 100000, poisson: 0.3, plane: Strain), mass: Density(100),
            velocity: ({vx:?}, {vy:?}))], effects: [{effects}])"
    ))
}

/// One particle on a spring without stiffness, at a point.
fn particle(integrator: &str, substeps: u32, [x, y]: [f64; 2], [vx, vy]: [f64; 2], effects: &str) -> Simulation {
    simulation(&level(&format!(
        "(name: \"particle\", substeps: {substeps}, integrator: {integrator}(), nets: [(name: \"particle\",
            net: Links(points: [({x:?}, {y:?}), (0, 9)], springs: [(0, 1, 0, 1)]), mass: 0.1,
            velocity: ({vx:?}, {vy:?}), pins: [Vertex(1)])], effects: [{effects}])"
    )))
}

fn walls(obstacle: &str, motions: &str) -> String {
    format!("(effect: Walls(obstacles: [Moving(obstacle: {obstacle}, motions: [{motions}])]))")
}

/// What pushes to the right from x = 0.
const PISTONS: [&str; 3] = [
    "Plane(point: (0, 0), normal: (1, 0), eps: 0.001)",
    "Cuboid(centre: (-0.1, 0.5), width: 0.2, height: 4, eps: 0.001)",
    "Polygon(points: [(-0.1, -2), (0, -2), (0, 3), (-0.1, 3)], eps: 0.001)",
];

fn mean(simulation: &Simulation, values: &[f64], axis: usize) -> f64 {
    let masses = &simulation.scene().mass;
    let total: f64 = masses.iter().step_by(2).sum();
    values.iter().zip(masses).skip(axis).step_by(2).map(|(value, mass)| value * mass).sum::<f64>() / total
}

#[test]
fn what_a_piston_pushes_ends_with_the_velocity_of_the_piston() {
    for (number, kind) in IntegratorKind::all().into_iter().enumerate() {
        for (piston_number, piston) in PISTONS.into_iter().enumerate() {
            // Many implicit steps of a body are dear: there each scheme has one piston, and each piston a scheme.
            if kind.kind().class() == Class::Implicit && number % PISTONS.len() != piston_number {
                continue;
            }
            // Air brakes a body, so that it stays at the piston.
            let effects = walls(piston, "Slide(velocity: (2, 0))");
            let air = format!("{effects}, (effect: Rayleigh(mass: 20, stiffness: 0.0003))");
            let mut body = simulation(&block(kind.name(), 400, [0.03, 0.4], [0.0, 0.0], &air));
            body.advance(24_000, &mut || true);
            let what = format!("{} {piston}", kind.name());
            assert!(body.fault().is_none() && body.counts().guarded == 0, "{what}: {:?}", body.counts());
            let v = mean(&body, &body.state().v, 0);
            assert!((v - 2.0).abs() < 2e-3, "{what}: {v}");
            let behind = body.state().x.iter().step_by(2).copied().fold(f64::INFINITY, f64::min);
            assert!((0.0..0.02).contains(&(behind - 2.0 * body.state().time)), "{what}");
        }
    }
}

#[test]
fn a_belt_accelerates_with_mu_g_up_to_its_own_speed() {
    let belts = [
        "Plane(point: (0, 0), normal: (0, 1), eps: 0.001)",
        "Cuboid(centre: (0, -0.1), width: 8, height: 0.2, eps: 0.001)",
    ];
    for kind in IntegratorKind::all() {
        for belt in belts {
            let effects = format!(
                "(effect: Gravity(down: 10)), (effect: Friction(coefficient: 0.5)), (effect: Rayleigh(mass: 0, stiffness: 0.001)),
                 (effect: Contact(modulus: 1, dissipation: 10)), {}",
                walls(belt, "Slide(velocity: (1, 0), from: 0.5)")
            );
            let mut lying = simulation(&block(kind.name(), 200, [0.0, 0.003], [0.0, 0.0], &effects));
            lying.advance(60 * 200 / 2, &mut || true);
            lying.advance(6 * 200, &mut || true);
            let v = mean(&lying, &lying.state().v, 0);
            assert!((v - 0.5).abs() < 0.02, "{} {belt}: {v} m/s after 0.1 s", kind.name());
            lying.advance(90 * 200, &mut || true);
            let [v, up] = [0, 1].map(|axis| mean(&lying, &lying.state().v, axis));
            assert!((v - 1.0).abs() < 1e-3 && up.abs() < 1e-3, "{} {belt}: {v}", kind.name());
        }
    }
}

/// What is drawn of a wall at a time.
fn outline(wall: &EffectKind, time: f64) -> Vec<[f64; 2]> {
    let Some(Shape::Solid(outline)) = wall.kind().shapes(time, &Surfaces::default()).into_iter().next() else {
        unreachable!("{wall:?}")
    };
    assert!(outline.len() > 2);
    outline
}

#[test]
fn nothing_passes_through_a_moving_obstacle() {
    let (mut looked, mut touched) = (0, 0);
    let shapes = [
        "Cuboid(centre: (0, 0), width: 0.002, height: 0.9, eps: 0.002)",
        "Ball(centre: (0, 0), radius: 0.012, eps: 0.002)",
        "Polygon(points: [(-0.5, -0.004), (0, 0), (-0.5, 0.004)], eps: 0.002)",
    ];
    for kind in IntegratorKind::all() {
        for shape in shapes {
            for speed in [1.0, 30.0, 1000.0] {
                // Coming from the left, and a blade whose tip is so fast.
                let (slide, turn) =
                    (format!("Slide(velocity: ({speed}, 0))"), format!("Turn(about: (0, -0.5), spin: {speed})"));
                for (motion, at) in [(slide, [0.05, -0.107]), (turn, [-0.3, -0.29])] {
                    // Without its reach it is drawn where it is.
                    let bare =
                        format!("(name: \"\", effects: [{}])", walls(shape, &motion).replace("eps: 0.002", "eps: 0"));
                    let wall = level(&bare).effects.remove(0).effect;
                    let substeps: &[u32] = if kind.kind().class() == Class::Implicit { &[1] } else { &[1, 200] };
                    for &substeps in substeps {
                        let level = block(kind.name(), substeps, at, [0.0, 0.0], &walls(shape, &motion));
                        let mut run = simulation(&level);
                        let what = format!("{} {shape} {motion} {substeps} substeps", kind.name());
                        for _ in 0..12.min(6 * substeps) {
                            run.advance(u64::from(substeps).div_ceil(40), &mut || true);
                            let x = &run.state().x;
                            if run.fault().is_some() || x.iter().any(|x| x.abs() > 1e5) {
                                break;
                            }
                            // The drawn circle has corners, and lies inside the true one.
                            assert_apart(&run, &outline(&wall, run.state().time), &what);
                            looked += 1;
                        }
                        touched += u32::from(!run.state().anchors.is_empty());
                    }
                }
            }
        }
    }
    assert!(looked > 500 && touched > 30, "{looked} looks, {touched} blocks touched the obstacle");
}

#[test]
fn a_wall_at_1000_m_per_s_does_not_pass_a_particle() {
    for kind in IntegratorKind::all() {
        for piston in PISTONS {
            for substeps in [1, 100] {
                let mut run = particle(
                    kind.name(),
                    substeps,
                    [0.3, 0.5],
                    [0.0, 0.0],
                    &walls(piston, "Slide(velocity: (1000, 0))"),
                );
                for _ in 0..20 {
                    run.advance(1, &mut || true);
                    assert!(run.fault().is_none(), "{} {piston}", kind.name());
                    let (x, wall) = (run.state().x[0], 1000.0 * run.state().time);
                    assert!(x >= wall, "{} {piston} {substeps}: {x} behind {wall}", kind.name());
                }
                // It bounces by its skin, or goes with the wall.
                assert!(run.state().v[0] > 999.0, "{} {piston} {substeps}", kind.name());
            }
        }
    }
}

/// Galileo: seen from a moving wall nothing is different from a wall at rest.
#[test]
fn impacts_on_moving_walls_are_galilean_invariant() {
    let shapes = [
        "Plane(point: (0, 0), normal: (1, 0.2), eps: 0.001)",
        "Cuboid(centre: (-0.1, 0.5), width: 0.2, height: 0.9, turn: 7, eps: 0.001)",
        "Polygon(points: [(-0.4, 0.3), (0, 0.52), (-0.4, 0.7)], eps: 0.001)",
        "Ball(centre: (-0.1, 0.47), radius: 0.1, eps: 0.001)",
    ];
    for kind in IntegratorKind::all() {
        // An error control weighs errors by how fast things are, and so does the linear solve what an impact is; what grows at
        // every step makes round-off grow too.
        let weighs = kind.kind().class() == Class::ErrorControlled || kind.name() == "LinearlyImplicitEuler";
        if weighs || kind.kind().stability_limit() == Some(0.0) {
            continue;
        }
        for shape in shapes {
            let coats = "(effect: Restitution(coefficient: 1)), (effect: Friction(coefficient: 0.3))";
            let seen = |[wx, wy]: [f64; 2], motions: &str| {
                let effects = format!("{}, {coats}", walls(shape, motions));
                let mut run = simulation(&block(kind.name(), 200, [0.1213, 0.4], [wx - 4.0, wy + 0.5], &effects));
                let mut touched = false;
                for _ in 0..90 {
                    assert_eq!(run.advance(10, &mut || true), 10);
                    touched |= !run.state().anchors.is_empty();
                }
                assert!(touched, "{} {shape}", kind.name());
                let time = run.state().time;
                let shift = |number: usize| if number.is_multiple_of(2) { wx } else { wy };
                let x = run.state().x.iter().enumerate().map(|(number, x)| x - time * shift(number));
                let v = run.state().v.iter().enumerate().map(|(number, v)| v - shift(number));
                x.chain(v).collect::<Vec<_>>()
            };
            let rests = seen([0.0, 0.0], "");
            let moves = seen([3.0, -2.0], "Slide(velocity: (3, -2))");
            let error = greatest_gap(&rests, &moves);
            // Newton's method stops at a tolerance that is relative to displacements.
            let tolerance = if kind.kind().class() == Class::Implicit { 1e-6 } else { 1e-9 };
            assert!(error < tolerance, "{} {shape}: {error:e}", kind.name());
        }
    }
}

#[test]
fn two_mirrored_pistons_press_a_mirrored_body_evenly() {
    for kind in IntegratorKind::all() {
        let text = "(effect: Walls(obstacles: [
            Moving(obstacle: Cuboid(centre: (0.25, 0.5), width: 0.1, height: 0.15, eps: 0.002), motions: [Swing(way: (0.12, 0), period: 0.2)]),
            Moving(obstacle: Cuboid(centre: (0.75, 0.5), width: 0.1, height: 0.15, eps: 0.002), motions: [Swing(way: (-0.12, 0), period: 0.2)])]))";
        let mut run = simulation(&block(kind.name(), 200, [0.4, 0.4], [0.0, 0.0], text));
        run.advance(600, &mut || true);
        assert!(run.fault().is_none(), "{}", kind.name());
        let x = &run.state().x;
        let points: Vec<_> = x.chunks_exact(2).collect();
        let rest: Vec<_> = run.scene().rest.chunks_exact(2).collect();
        for (point, at) in points.iter().zip(&rest) {
            let other = rest.iter().position(|other| (other[0] + at[0] - 1.0).abs() + (other[1] - at[1]).abs() < 1e-9);
            let twin = points[other.unwrap()];
            let error = (point[0] + twin[0] - 1.0).abs().max((point[1] - twin[1]).abs());
            assert!(error < 1e-7, "{}: {error:e}", kind.name());
        }
    }
}

/// Both runs have the same bits.
#[test]
fn an_obstacle_without_motions_acts_as_a_fixed_one() {
    let run = |obstacle: &str| {
        let effects = format!("(effect: Gravity(down: 9.8)), (effect: Walls(obstacles: [{obstacle}]))");
        let mut run = simulation(&block("SymplecticEuler", 100, [0.3, 0.5], [1.0, -2.0], &effects));
        let mut touched = false;
        for _ in 0..200 {
            run.advance(10, &mut || true);
            touched |= !run.state().anchors.is_empty();
        }
        assert!(touched);
        run.state().hash()
    };
    for obstacle in [
        "Ball(centre: (0.4, 0.2), radius: 0.1, eps: 0.01)",
        "Cuboid(centre: (0.4, 0.2), width: 0.3, height: 0.1, turn: 20, eps: 0.01)",
    ] {
        assert_eq!(run(obstacle), run(&format!("Moving(obstacle: {obstacle}, motions: [])")));
    }
}

const STIRRED: &str = "(name: \"stirred\", mode: Collide, substeps: 40, bodies: [(name: \"b\", mesh: Disk(radius: 0.1, rings: 4, centre: (0.5, 0.6)),
    mass: Density(10), material: (model: NeoHookean, young: 500, poisson: 0.3))], effects: [(effect: Gravity(down: 3)),
    (effect: Walls(obstacles: [Moving(obstacle: Cuboid(centre: (0.5, 0.35), width: 0.5, height: 0.03, eps: 0.005),
        motions: [Turn(about: (0.5, 0.35), spin: 3), Swing(way: (0.05, 0.1), period: 0.7, phase: 30)]),
        Plane(point: (0, 0), normal: (0, 1), eps: 0.01)]))])";

/// Both continue with the same bits.
#[test]
fn rewinding_and_saving_find_moving_walls_in_place() {
    let mut sandbox = Sandbox::new(level(STIRRED), Box::new(NoFiles)).unwrap();
    sandbox.apply(Command::SetMode(Mode::Collide)).unwrap();
    sandbox.advance(1000, &mut || true);
    let saved = files::write(&sandbox.saved()).unwrap();
    let mut later = Vec::new();
    let mut touched = false;
    for _ in 0..20 {
        sandbox.advance(40, &mut || true);
        touched |= !sandbox.simulation().state().anchors.is_empty();
        later.push(sandbox.simulation().state().clone());
    }
    let mut resumed = simulation(&files::parse(&saved, "saved.ron").unwrap());
    resumed.advance(800, &mut || true);
    assert_eq!(resumed.state(), &later[19]);
    sandbox.apply(Command::Rewind(10.0 / 60.0)).unwrap();
    assert_eq!(sandbox.simulation().state(), &later[9]);
    sandbox.apply(Command::SetRunning(true)).unwrap();
    sandbox.advance(400, &mut || true);
    assert_eq!(sandbox.simulation().state(), &later[19]);
    assert!(touched);
}

/// With a step far above the stability limit the guard takes shorter ones: they must find the wall where their own time says.
#[test]
fn shorter_steps_find_what_moves_where_it_is_then() {
    let mut run = simulation(&level(&STIRRED.replace("substeps: 40", "substeps: 4")));
    run.advance(240, &mut || true);
    assert!(run.fault().is_none() && run.counts().guarded > 0, "{:?}", run.counts());
    assert!(run.state().is_finite() && run.inversion().1 == 0);
}

#[test]
fn the_guard_accepts_the_work_of_moving_walls() {
    // Hard pushes are no energy from nowhere.
    for kind in IntegratorKind::all()
        .iter()
        .filter(|kind| kind.kind().class() == Class::Explicit && kind.kind().stability_limit() != Some(0.0))
    {
        for speed in [1.0, 10.0, 100.0] {
            let motion = format!("Swing(way: (0.05, 0), period: {:?})", 0.1 * std::f64::consts::PI / speed);
            let skin = format!("(effect: Contact(thickness: 0.01, speed: {speed})), {}", walls(PISTONS[1], &motion));
            let mut run = particle(kind.name(), 1000, [0.02, 0.5], [0.0, 0.0], &skin);
            run.advance(2000, &mut || true);
            assert!(run.fault().is_none() && run.state().v[0] > 0.5 * speed, "{} {speed}", kind.name());
            assert_eq!((run.counts().guarded, run.counts().retaken), (0, 0), "{} {speed}", kind.name());
        }
    }
}

#[test]
fn the_velocity_of_a_motion_is_the_rate_of_its_place() {
    let text = "Turn(about: (0.3, -0.2), spin: 5), Swing(way: (0.3, 0.1), period: 0.9, phase: 20), Turn(about: (1, 1), spin: -2), Slide(velocity: (3, 1), from: 0.1, until: 5), Spline(points: [(0.5, (0, 0)), (0.9, (0.2, 0.1)), (2, (0.1, 0.5)), (5, (0, 0))])";
    let EffectKind::Walls(walls) =
        level(&format!("(name: \"\", bodies: [], effects: [{}])", walls(PISTONS[0], text))).effects.remove(0).effect
    else {
        unreachable!("{text}")
    };
    let motions: Vec<MotionKind> = walls.obstacles[0].kind().motions();
    assert_eq!(motions.len(), 5);
    for time in [0.05, 0.7, 3.3, 7.0] {
        let (now, dt) = (placed(&motions, time), 1e-6);
        for point in [[0.0, 0.0], [1.5, -0.7]] {
            let [before, after] = [-dt, dt].map(|dt| placed(&motions, time + dt).point(point));
            let v = now.velocity_at(now.point(point));
            for axis in 0..2 {
                let rate = (after[axis] - before[axis]) / (2.0 * dt);
                assert!((rate - v[axis]).abs() < 1e-7, "{time} {point:?}: {rate} {}", v[axis]);
            }
            let back = now.back(now.point(point));
            assert!((back[0] - point[0]).abs() + (back[1] - point[1]).abs() < 1e-12);
        }
    }
}
