//! Facts about what is fast, thin, rough or springy: nothing gets through anything, at any speed, under any scheme.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{Random, assert_apart, level, simulation};
use gingerbread::{
    files,
    integrators::{Class, IntegratorKind, MeanForces},
    level::Level,
    simulation::Simulation,
};

/// A block of jelly, 0.2 m wide, of so many cells a side, among obstacles.
fn block(integrator: &str, substeps: u32, cells: u32, [x, y]: [f64; 2], [vx, vy]: [f64; 2], effects: &str) -> Level {
    level(&format!(
        "(name: \"block\", substeps: {substeps}, integrator: {integrator}(), bodies: [(name: \"block\",
            mesh: Rectangle(width: 0.2, height: 0.2, columns: {cells}, rows: {cells}, diagonals: Alternating, corner: ({x}, {y})),
            material: (model: Corotated, young: 100000, poisson: 0.3, plane: Strain), mass: Density(100),
            velocity: ({vx}, {vy}))], effects: [{effects}])"
    ))
}

/// What a block falls on from above, and the outline of it.
fn targets() -> Vec<(&'static str, Vec<[f64; 2]>)> {
    let round = |r: f64| {
        (0..48).map(|i| f64::from(i) * std::f64::consts::TAU / 48.0).map(|t| [r * t.cos(), r * t.sin()]).collect()
    };
    vec![
        ("Plane(point: (0, 0), normal: (0, 1), eps: 0.002)", vec![[-9.0, -1e-9], [9.0, -1e-9], [0.0, -9.0]]),
        (
            "Cuboid(centre: (0, -0.0005), width: 4, height: 0.001, eps: 0.002)",
            vec![[-2.0, -0.001], [2.0, -0.001], [2.0, 0.0], [-2.0, 0.0]],
        ),
        ("Ball(centre: (0, 0), radius: 0.01, eps: 0.002)", round(0.009_99)),
        (
            "Polygon(points: [(-0.004, -1), (0.004, -1), (0.001, 0)], eps: 0.002)",
            vec![[-0.004, -1.0], [0.004, -1.0], [0.001, 0.0]],
        ),
    ]
}

/// The tests of one scheme: with the step of a film for implicit ones, and both such a step and a fine one for the others.
fn substeps(kind: &IntegratorKind) -> &'static [u32] {
    if kind.kind().class() == Class::Implicit { &[1] } else { &[1, 200] }
}

#[test]
fn nothing_gets_through_anything_at_any_speed_under_any_scheme() {
    let (mut random, mut touched) = (Random(5), 0);
    for kind in IntegratorKind::all() {
        for (target, outline) in targets() {
            for cells in [1, 5] {
                for speed in [1.0, 10.0, 100.0, 1000.0] {
                    for &substeps in substeps(&kind) {
                        let walls = format!("(effect: Gravity(down: 9.8)), (effect: Walls(obstacles: [{target}]))");
                        let at = [random.between(-0.19, -0.01), random.between(0.03, 0.4)];
                        let level = block(kind.name(), substeps, cells, at, [0.1 * speed, -speed], &walls);
                        let mut simulation = simulation(&level);
                        let what = format!("{} {target} {cells} cells {speed} m/s {substeps} substeps", kind.name());
                        for _ in 0..24.min(6 * substeps) {
                            simulation.advance(u64::from(substeps).div_ceil(40), &mut || true);
                            // A scheme may blow up by itself; how near things are is then no more than round-off.
                            let exploded = simulation.state().x.iter().any(|x| x.abs() > 1e5);
                            if exploded || simulation.fault().is_some() {
                                break;
                            }
                            assert_apart(&simulation, &outline, &what);
                        }
                        touched += u32::from(!simulation.state().anchors.is_empty());
                    }
                }
            }
        }
    }
    assert!(touched > 50, "only {touched} blocks touched anything");
}

/// One particle on a spring without stiffness, at a height above the floor of the world or a plane at y = 0.
fn particle(integrator: &str, substeps: u32, height: f64, velocity: [f64; 2], effects: &str) -> Simulation {
    let [vx, vy] = velocity;
    simulation(&level(&format!(
        "(name: \"particle\", substeps: {substeps}, integrator: {integrator}(), nets: [(name: \"particle\",
            net: Links(points: [(0, {height}), (0, 9)], springs: [(0, 1, 0, 1)]), mass: 0.1,
            velocity: ({vx}, {vy}), pins: [Vertex(1)])], effects: [{effects}])"
    )))
}

const FLOORS: [&str; 3] = [
    "(effect: Boundary(least: (-99, 0), greatest: (99, 99)))",
    "(effect: Walls(obstacles: [Plane(point: (0, 0), normal: (0, 1), eps: 0)]))",
    "(effect: Walls(obstacles: [Cuboid(centre: (0, -0.1), width: 4, height: 0.2, eps: 0)]))",
];

/// With short steps no triangle is inverted and no energy is gained.
#[test]
fn implicit_steps_keep_a_fast_body_above_a_thin_wall() {
    for kind in IntegratorKind::all().iter().filter(|kind| kind.kind().class() == Class::Implicit) {
        let is_midpoint = kind.kind().mean_forces() == MeanForces::Contact;
        for (cells, substeps) in [(1, 1), (12, 1), (1, 40), (8, 40)] {
            let wall =
                "(effect: Walls(obstacles: [Cuboid(centre: (0, -0.0005), width: 4, height: 0.001, eps: 0.001)]))";
            let mut level = block(kind.name(), substeps, cells, [-0.1, 1.0], [0.0, -100.0], wall);
            // Sound is faster in it than it falls, so that it can stop by its own strength.
            level.bodies[0].material = files::parse(STIFF, "stiff.ron").unwrap().bodies[0].material;
            let mut simulation = simulation(&level);
            let start = simulation.energies().total();
            for _ in 0..30 {
                simulation.advance(u64::from(substeps.div_ceil(10)), &mut || true);
                if let Some(fault) = simulation.fault() {
                    // Whole frames are too long for a scheme that damps nothing, and it says so.
                    assert!(
                        kind.kind().mean_forces() != MeanForces::None && substeps == 1,
                        "{} {cells}: {fault:?}",
                        kind.name()
                    );
                    break;
                }
                assert!(simulation.state().x.iter().skip(1).step_by(2).all(|y| *y > 0.0), "{} {cells}", kind.name());
                let total = simulation.energies().total();
                // Of an energy-momentum step the tolerance of its equations is left. The midpoint rule has no bound on the energy of triangles that are crushed within a step.
                let excess = if kind.kind().mean_forces() == MeanForces::All { 1e-8 } else { 1e-9 };
                assert!(
                    total <= start * (1.0 + excess) || substeps == 1 || is_midpoint,
                    "{} {cells}: {total} J after {start} J",
                    kind.name()
                );
            }
            assert!(simulation.inversion().1 == 0 || substeps == 1, "{} {cells}", kind.name());
        }
    }
}

const STIFF: &str = "(name: \"\", bodies: [(name: \"\", mesh: Rectangle(width: 1, height: 1, columns: 1, rows: 1),
    material: (model: Corotated, young: 10000000, poisson: 0.3, plane: Strain), mass: Density(1))])";

#[test]
fn nothing_leaves_the_domain_by_more_than_eps() {
    let mut random = Random(6);
    for kind in IntegratorKind::all() {
        for speed in [1.0, 30.0, 1000.0] {
            let obstacles =
                "Ball(centre: (0.5, 0), radius: 0.1, eps: 0.01), Plane(point: (0, 0.1), normal: (1, 3), eps: 0.01)";
            let effects = format!(
                "(effect: Gravity(down: 9.8)), (effect: Walls(obstacles: [{obstacles}])), (effect: Boundary(least: (0, 0), greatest: (1, 1)))"
            );
            let direction = random.between(0.0, std::f64::consts::TAU);
            let velocity = [speed * direction.cos(), speed * direction.sin()];
            let mut simulation = simulation(&block(kind.name(), 100, 3, [0.4, 0.5], velocity, &effects));
            for _ in 0..100 {
                simulation.advance(3, &mut || true);
                let least = simulation.state().x.iter().copied().fold(f64::INFINITY, f64::min);
                let greatest = simulation.state().x.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                assert!(least >= -0.01 && greatest <= 1.01, "{} {speed}: {least} to {greatest}", kind.name());
            }
        }
    }
}

/// A particle that hits a floor at the impact speed of the skin leaves it at e times that speed, and friction alone changes its
/// velocity along the floor.
#[test]
fn restitution_is_that_at_the_impact_speed() {
    for kind in IntegratorKind::all() {
        for floor in FLOORS {
            for e in [0.1, 0.5, 1.0] {
                let effects = format!("{floor}, (effect: Contact(speed: 3)), (effect: Restitution(coefficient: {e}))");
                let mut simulation = particle(kind.name(), 400, 0.5, [2.0, -3.0], &effects);
                simulation.advance(12_000, &mut || true);
                let v = &simulation.state().v;
                assert!((v[0] - 2.0).abs() < 1e-9, "{} {floor} {e}: {v:?}", kind.name());
                assert!((v[1] - 3.0 * e).abs() < 0.02, "{} {floor} {e}: {v:?}", kind.name());
            }
        }
    }
}

#[test]
fn what_is_dropped_comes_to_rest_and_no_contact_gains_energy() {
    for kind in IntegratorKind::all() {
        // One linear solve does not see the wall: that scheme needs a shorter step.
        let short = kind.kind().class() != Class::Implicit || kind.name() == "LinearlyImplicitEuler";
        let substeps = if short { 100 } else { 4 };
        for target in targets().into_iter().map(|(target, _)| target) {
            let effects = format!(
                "(effect: Gravity(down: 10)), (effect: Rayleigh(mass: 2, stiffness: 0.0003)), (effect: Restitution(coefficient: 0.3)), (effect: Friction(coefficient: 0.5)),
                 (effect: Walls(obstacles: [Plane(point: (0, -0.3), normal: (0, 1), eps: 0.01), {target}]))"
            );
            let mut simulation = simulation(&block(kind.name(), substeps, 4, [-0.13, 0.05], [0.0, 0.0], &effects));
            let mut before = simulation.energies().total();
            let first = before;
            for _ in 0..400 {
                simulation.advance(u64::from(substeps), &mut || true);
                let now = simulation.energies().total();
                let tolerance = if short { 1e-4 } else { 1e-2 };
                assert!(now <= before + tolerance * first.abs(), "{} {target}: {before} J, then {now} J", kind.name());
                before = now;
            }
            // By the way, not the velocity: that of a scheme of second order is of the middle of a step.
            let at = simulation.state().x.clone();
            simulation.advance(u64::from(6 * substeps), &mut || true);
            let ways = simulation.state().x.iter().zip(&at).map(|(x, at)| (x - at).abs());
            let fastest = ways.fold(0.0, f64::max) / 0.1;
            assert!(fastest < 1e-3, "{} {target}: still {fastest} m/s", kind.name());
        }
    }
}

#[test]
fn friction_and_restitution_with_nothing_to_touch_say_so() {
    let with = |effects: &str| {
        let level = block("SymplecticEuler", 100, 1, [0.0, 0.0], [0.0, 0.0], effects);
        simulation(&level).scene().messages.join("\n")
    };
    assert!(with("(effect: Friction(coefficient: 0.4))").contains("Friction needs walls or a domain boundary"));
    assert!(with("(effect: Restitution(coefficient: 0.4))").contains("Restitution needs walls or a domain boundary"));
    assert!(
        !with("(effect: Friction(coefficient: 0.4)), (effect: Boundary(least: (0, 0), greatest: (1, 1)))")
            .contains("needs")
    );
}
