//! Large bodies are stepped by any number of threads to the same bits.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{level, simulation};
use gingerbread::{integrators::IntegratorKind, level::Level, simulation::Simulation};
use rayon::ThreadPoolBuilder;

/// A sheet of 18,496 triangles, row by row.
fn large(body: &str, rest: &str) -> Level {
    level(&format!(
        "(name: \"large\", {rest}, bodies: [(name: \"large\", mass: Density(1), {body} mesh: Rectangle(width: 1, height: 1, columns: 68, rows: 68),
          material: (model: StableNeoHookean, young: 1000, poisson: 0.3, plane: Strain))])"
    ))
}

/// State and books.
fn work(simulation: &Simulation) -> impl PartialEq + std::fmt::Debug {
    let costs = simulation.costs().iter().map(|cost| (cost.name, cost.calls, cost.elements, cost.skipped, cost.idle));
    let state = simulation.state();
    (state.hash(), state.time, state.slow_checks.clone(), simulation.counts(), costs.collect::<Vec<_>>())
}

/// Runs a level on this thread and in pools of one, two, three and eight threads, and compares state and books. Returns the first.
fn compare(level: &Level, steps: u64) -> Simulation {
    let mut alone = simulation(level);
    alone.advance(steps, &mut || true);
    for threads in [1, 2, 3, 8] {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut run = simulation(level);
        pool.install(|| run.advance(steps, &mut || true));
        assert_eq!(work(&run), work(&alone), "{threads} threads");
        assert_eq!((run.fault(), run.guard_substeps()), (alone.fault(), alone.guard_substeps()), "{threads} threads");
    }
    alone
}

fn partitions(simulation: &Simulation) -> Vec<usize> {
    simulation.scene().bodies.iter().map(|body| body.elements.partitions()).collect()
}

#[test]
fn any_number_of_threads_gives_the_same_bits_and_books() {
    let damping = "(effect: Rayleigh(mass: 0.3, stiffness: 0.0001)), (effect: Drag(coefficient: 1e-6))";
    for (body, rest) in [
        ("stretch: (1.1, 1),", "substeps: 700, effects: []".to_owned()),
        (
            "pins: [Top],",
            "substeps: 700, effects: [(effect: Gravity(down: 1, right: 2)), (effect: MouseSpring(stiffness: 10))]"
                .to_owned(),
        ),
        ("velocity: (3, 0), spin: 5,", "substeps: 700, guard: Off, effects: []".to_owned()),
        ("stretch: (1.1, 1),", format!("substeps: 700, effects: [(effect: Gravity(down: 1)), {damping}]")),
    ] {
        assert_eq!(partitions(&compare(&large(body, &rest), 150)), [4], "{rest}");
    }
}

#[test]
fn every_integrator_shares_a_large_body() {
    let level = large("stretch: (1.1, 1),", "substeps: 700, effects: [(effect: Gravity(down: 1))]");
    for integrator in IntegratorKind::all() {
        let run = compare(&Level { integrator, ..level.clone() }, 4);
        assert_eq!((partitions(&run), run.state().steps), (vec![4], 4), "{:?}", run.fault());
    }
}

#[test]
fn a_floor_stops_a_shared_body_where_it_would() {
    let floor = "(effect: Walls(obstacles: [Plane(point: (0, -0.002), normal: (0, 1), eps: 0.001)]))";
    let rest = format!("substeps: 700, effects: [(effect: Gravity(down: 20)), {floor}]");
    let run = compare(&large("stretch: (1.02, 1), velocity: (0, -0.1),", &rest), 800);
    assert!(!run.state().anchors.is_empty(), "{:?}", run.counts());
}

/// Too long a step: it is taken again in shorter ones, from just the same steps.
#[test]
fn the_guard_divides_the_same_steps_of_a_shared_body() {
    let run = compare(&large("stretch: (1.1, 1),", "substeps: 60, effects: [(effect: Gravity(down: 1))]"), 400);
    assert!(run.counts().retaken > 0 && run.counts().guarded > 0, "{:?}", run.counts());
    let rest = "substeps: 60, guard: Off, effects: [(effect: Gravity(down: 1))]";
    assert!(compare(&large("stretch: (1.1, 1),", rest), 2400).fault().is_some(), "without the guard it explodes");
}

/// One of two sheets rests where nothing acts on it, and soon sleeps.
#[test]
fn a_body_beside_one_that_sleeps_is_shared_as_well() {
    let sheet = |name: &str, body: &str| {
        format!(
            "(name: \"{name}\", mass: Density(1), {body} mesh: Rectangle(width: 1, height: 1, columns: 68, rows: 68),
              material: (model: StableNeoHookean, young: 10, poisson: 0.3, plane: Strain)),"
        )
    };
    let (still, moving) = (sheet("still", "place: (offset: (2, 0)),"), sheet("moving", "stretch: (1.1, 1),"));
    let run = compare(&level(&format!("(name: \"two\", substeps: 20, bodies: [{still}{moving}], effects: [])")), 800);
    assert_eq!((partitions(&run), run.sleeping().collect::<Vec<_>>()), (vec![4, 4], vec![true, false]));
}

/// A wheel whose hub has forces from all triangles, and two plates that are one body and touch nowhere.
#[test]
fn forces_are_summed_over_any_interface() {
    let spokes = 30_000;
    let rim = (0..spokes).map(|i| (f64::from(i) * std::f64::consts::TAU / f64::from(spokes)).sin_cos());
    let points: Vec<_> = [(0.0, 0.0)].into_iter().chain(rim.map(|(sin, cos)| (5000.0 * cos, 5000.0 * sin))).collect();
    let triangles: Vec<_> = (0..spokes).map(|i| (0, i + 1, (i + 1) % spokes + 1)).collect();
    let body = |points: &[(f64, f64)], triangles: &[(u32, u32, u32)]| {
        level(&format!(
            "(name: \"points\", substeps: 2000, guard: Off, bodies: [(name: \"points\", mass: Density(1), stretch: (1.001, 1),
              velocity: (1, 0), mesh: Points(points: {points:?}, triangles: {triangles:?}),
              material: (model: Corotated, young: 1000, poisson: 0.3))])"
        ))
    };
    assert!(partitions(&compare(&body(&points, &triangles), 50))[0] > 1);
    let side = 64;
    let points =
        (0..2).flat_map(|plate| (0..65 * 65).map(move |i| (f64::from(i % 65 + 100 * plate), f64::from(i / 65))));
    let quad = |i: u32| (i / (side * side) * 65 * 65) + i % (side * side) / side * 65 + i % side;
    let triangles = (0..2 * side * side).map(quad).flat_map(|a| [(a, a + 1, a + 65), (a + 1, a + 66, a + 65)]);
    let (points, triangles): (Vec<_>, Vec<_>) = (points.collect(), triangles.collect());
    assert!(partitions(&compare(&body(&points, &triangles), 50))[0] > 1);
}
