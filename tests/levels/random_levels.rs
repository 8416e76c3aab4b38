//! Whatever a level says, within what it may say: nothing panics, nothing on the screen is not a number, and nobody leaves the
//! edges of the world. What once failed is kept in `random_levels.regressions`.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::level;
use gingerbread::{
    command::{Command, Mode},
    integrators::{IntegratorKind, Scheme},
    level::{Level, SubstepMode},
    meshes::NoFiles,
    sandbox::Sandbox,
    snapshot::{Field, Snapshot},
};
use proptest::{
    prelude::*,
    test_runner::{FileFailurePersistence, RngSeed},
};

/// A number anywhere between two powers of ten.
fn decades(from: i32, to: i32) -> impl Strategy<Value = f64> {
    (f64::from(from)..f64::from(to)).prop_map(|exponent| 10.0_f64.powf(exponent))
}

fn mesh() -> impl Strategy<Value = String> {
    let diagonals = prop::sample::select(vec!["Grid", "Alternating", "Crossed"]);
    prop_oneof![
        (1..5_u32, 1..5_u32, diagonals).prop_map(|(columns, rows, diagonals)| format!(
            "Rectangle(width: 0.4, height: 0.3, columns: {columns}, rows: {rows}, diagonals: {diagonals}, corner: (0.3, 0.3))"
        )),
        (1..4_u32).prop_map(|rings| format!("Disk(radius: 0.2, centre: (0.5, 0.5), rings: {rings})")),
        Just("Points(points: [(0.2, 0.2), (0.6, 0.2), (0.4, 0.21), (0.5, 0.7)], triangles: [(0, 1, 2), (0, 2, 3), (2, 1, 3)])".to_owned()),
    ]
}

fn body() -> impl Strategy<Value = String> {
    let model = prop::sample::select(gingerbread::materials::Model::ALL.to_vec());
    let shape = (0.3..2.5_f64, 0.3..2.5_f64, -20.0..20.0_f64, -20.0..20.0_f64, -50.0..50.0_f64);
    let pins = prop::sample::select(vec!["", "Top", "Left", "Vertex(0)", "Top, Bottom"]);
    (mesh(), model, decades(-1, 9), -0.9..0.4999_f64, decades(-3, 6), shape, pins).prop_map(
        |(mesh, model, young, poisson, density, (sx, sy, vx, vy, spin), pins)| {
            format!(
                "(name: \"b\", mesh: {mesh}, material: (model: {}, young: {young:e}, poisson: {poisson}), mass: Density({density:e}),
                  stretch: ({sx}, {sy}), velocity: ({vx}, {vy}), spin: {spin}, pins: [{pins}])",
                model.name()
            )
        },
    )
}

/// A blade that swings and turns, slowly or madly.
fn moving() -> impl Strategy<Value = String> {
    (decades(-2, 3), -1e3..1e3_f64, -0.5..0.5_f64).prop_map(|(period, spin, way)| {
        format!(
            "(effect: Walls(obstacles: [Moving(obstacle: Cuboid(centre: (0.5, 0.2), width: 0.4, height: 0.02, eps: 0.01),
               motions: [Turn(about: (0.5, 0.2), spin: {spin}), Swing(way: ({way}, 0.2), period: {period:e})])])),"
        )
    })
}

fn effects() -> impl Strategy<Value = String> {
    let optional = |text: BoxedStrategy<String>| prop_oneof![Just(String::new()), text];
    (
        optional((-20.0..20.0_f64).prop_map(|g| format!("(effect: Gravity(down: {g})),")).boxed()),
        optional(
            (0.0..10.0_f64, 0.0..0.01_f64)
                .prop_map(|(a, b)| format!("(effect: Rayleigh(mass: {a}, stiffness: {b})),"))
                .boxed(),
        ),
        optional(
            prop_oneof![
                Just("(effect: Walls(obstacles: [Ball(centre: (0.5, 0.1), radius: 0.15, eps: 0.01)])),".to_owned()),
                moving(),
            ]
            .boxed(),
        ),
        decades(0, 6).prop_map(|k| format!("(effect: MouseSpring(stiffness: {k:e})),")),
    )
        .prop_map(|(a, b, c, d)| a + &b + &c + &d)
}

/// A level in a box, and what a hand does to it: every frame a vertex, and where it is pulled.
fn scene() -> impl Strategy<Value = (Level, Vec<(usize, [f64; 2])>)> {
    let integrator = prop::sample::select(
        IntegratorKind::all()
            .into_iter()
            .filter(|kind| matches!(kind.kind().scheme(), Scheme::First(_) | Scheme::Second(_)))
            .collect::<Vec<_>>(),
    );
    let drags = prop::collection::vec((0..40_usize, [-2.0..3.0_f64, -2.0..3.0_f64]), 4..10);
    (prop::collection::vec(body(), 1..3), effects(), integrator, 1..60_u32, drags).prop_map(
        |(bodies, effects, integrator, substeps, drags)| {
            let text = format!(
                "(name: \"random\", mode: Collide, substeps: {substeps}, bodies: [{}], effects: [{effects} (effect: Boundary(least: (0, 0), greatest: (1, 1)))])",
                bodies.join(",")
            );
            (Level { integrator, ..level(&text) }, drags)
        },
    )
}

/// Lets the hand pull for some frames, and looks at all there is to see after each.
fn pull(level: Level, drags: Vec<(usize, [f64; 2])>) -> Result<(), TestCaseError> {
    let mut sandbox = Sandbox::new(level, Box::new(NoFiles)).unwrap();
    sandbox.apply(Command::SetMode(Mode::Collide)).unwrap();
    let per_frame = (1.0 / (60.0 * sandbox.step_length())).round() as u64;
    let mut snapshot = Snapshot::default();
    // A body may begin beyond the domain; it comes in slowly, and never goes farther out than its skin gives way.
    let beyond = |x: f64| (x - 1.0).max(-x).max(0.0);
    let begins: Vec<_> = sandbox.simulation().state().x.iter().map(|x| beyond(*x)).collect();
    for (vertex, [x, y]) in drags {
        let _ = sandbox.apply(Command::Grab(vertex, [x, y, 0.0]));
        sandbox.advance(per_frame.min(8), &mut || true);
        sandbox.snapshot(Field::VonMises, &mut snapshot);
        prop_assert!(snapshot.positions.iter().all(|x| x.is_finite()));
        prop_assert!(sandbox.simulation().state().is_finite());
        let pinned = |at: usize| snapshot.pins.contains(&(at as u32 / 2));
        let taken = snapshot.steps > 0;
        for (at, x) in snapshot.positions.iter().enumerate().filter(|(at, _)| taken && !pinned(*at)) {
            let gives_way = if begins[at] > 0.0 { 0.25 } else { 0.0 };
            prop_assert!(beyond(*x) <= begins[at] + gives_way, "vertex {} at {x}", at / 2);
        }
    }
    Ok(())
}

/// 256 levels, or as many as `PROPTEST_CASES` says; every run draws the same ones.
fn config() -> ProptestConfig {
    ProptestConfig {
        rng_seed: RngSeed::Fixed(1),
        failure_persistence: Some(Box::new(FileFailurePersistence::Direct("tests/levels/random_levels.regressions"))),
        ..ProptestConfig::default()
    }
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn random_levels_stay_finite_and_in_the_world((level, drags) in scene()) {
        pull(level, drags)?;
    }

    #[test]
    fn random_multirate_levels_stay_finite_and_in_the_world((level, drags) in scene()) {
        // Bodies that take 100,000 steps a frame take them, but not in a test; with common steps all are in the test above.
        if level.bodies.iter().all(|body| body.material.lame().mu < 1e4) {
            pull(Level { paces: SubstepMode::Own, ..level }, drags)?;
        }
    }
}
