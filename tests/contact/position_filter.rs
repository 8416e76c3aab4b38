//! Facts about contact by a filter of positions.
#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "a failing test should panic")]

use crate::common::{level, named, reopened, simulation};
use gingerbread::{
    integrators::IntegratorKind,
    level::{Level, Sleep},
    scene::Scene,
    simulation::Simulation,
};

/// Two particles without a force between them that fly over a plane, in the plane or in space.
fn flying(is_in_space: bool, obstacles: &str, effects: &str) -> Level {
    let (space, velocity) = if is_in_space { (", space: (velocity: (2, -3, 0))", "(0, 0)") } else { ("", "(2, -3)") };
    level(&format!(
        "(name: \"\", nets: [(name: \"two\", net: Links(points: [(0, 0.02), (1, 0.5)], springs: [(0, 1, 0, 1)]), mass: 0.1, velocity: {velocity}{space})],
        effects: [(effect: PositionFilter()), (effect: Walls(obstacles: [{obstacles}])), {effects}])"
    ))
}

fn stepped(level: &Level, step: f64) -> Simulation {
    let mut simulation = simulation(level);
    let scene = Scene { step, sleep: Sleep::Off, guard: false, ..simulation.scene().clone() };
    simulation.replace_scene(scene);
    simulation
}

fn floor(is_in_space: bool) -> &'static str {
    if is_in_space {
        "HalfSpace(point: (0, 0, 0), normal: (0, 1, 0), eps: 0.01)"
    } else {
        "Plane(point: (0, 0), normal: (0, 1), eps: 0.01)"
    }
}

/// What comes to within the margin is put between its last place and the nearest point at the margin; if it was within
/// already, at the margin. Its velocity is that of the displacement.
#[test]
fn positions_are_blended_by_friction() {
    for is_in_space in [false, true] {
        for mu in [0.0, 0.25, 1.0] {
            let mut run = stepped(
                &flying(is_in_space, floor(is_in_space), &format!("(effect: Friction(coefficient: {mu}))")),
                0.01,
            );
            run.advance(1, &mut || true);
            let dimension = run.scene().dimension;
            // From (0, 0.02) by (0.02, -0.03) to (0.02, -0.01).
            let expected = [0.02 * (1.0 - mu), 0.02 * mu + 0.01 * (1.0 - mu)];
            for axis in 0..2 {
                let (x, v) = (run.state().x[axis], run.state().v[axis]);
                assert!((x - expected[axis]).abs() < 1e-15, "{mu}: {x}");
                assert!((v - (expected[axis] - [0.0, 0.02][axis]) / 0.01).abs() < 1e-12, "{mu}: {v}");
            }
            // The other particle flies on.
            assert!((run.state().x[dimension] - 1.02).abs() < 1e-15);
        }
    }
}

/// What was within the margin before the step is put at the margin, whatever the friction.
#[test]
fn what_is_within_the_margin_comes_out() {
    for is_in_space in [false, true] {
        let level = flying(is_in_space, floor(is_in_space), "(effect: Friction(coefficient: 1))");
        let mut run = stepped(&level, 0.01);
        let mut state = run.state().clone();
        state.x[1] = 0.005;
        run.set_state(state);
        run.advance(1, &mut || true);
        assert!((run.state().x[0] - 0.02).abs() < 1e-15 && (run.state().x[1] - 0.01).abs() < 1e-15);
        assert!((run.state().v[1] - 0.5).abs() < 1e-12, "{}", run.state().v[1]);
    }
}

/// Along with an obstacle that moves, at full friction.
#[test]
fn a_moving_obstacle_carries_what_it_meets() {
    let obstacle = "Moving(obstacle: HalfSpace(point: (0, 0, 0), normal: (0, 1, 0), eps: 0.01), motions: [Slide(velocity: (5, 0), velocity_z: 7)])";
    let mut run = stepped(&flying(true, obstacle, "(effect: Friction(coefficient: 1))"), 0.01);
    run.advance(1, &mut || true);
    let x = &run.state().x[..3];
    assert!((x[0] - 0.05).abs() < 1e-15 && (x[1] - 0.02).abs() < 1e-15 && (x[2] - 0.07).abs() < 1e-15, "{x:?}");
}

/// With every scheme nothing stays within the margin, and a saved run continues bit for bit.
#[test]
fn every_integrator_filters_positions() {
    for kind in IntegratorKind::all() {
        for is_in_space in [false, true] {
            let level = flying(
                is_in_space,
                floor(is_in_space),
                "(effect: Gravity(down: 9.81)), (effect: Friction(coefficient: 0.5))",
            );
            let level = Level { integrator: kind.clone(), ..level };
            let mut run = simulation(&level);
            let frame = run.scene().steps_per_frame();
            for _ in 0..40 {
                run.advance(frame, &mut || true);
                let height = run.state().x[1];
                assert!(height > 0.01 - 1e-12, "{}: {height} m", kind.name());
            }
            assert!(run.fault().is_none(), "{}: {:?}", kind.name(), run.fault());
            assert!(run.state().x[1] < 0.011);
            let mut other = reopened(&run, &level);
            for simulation in [&mut run, &mut other] {
                simulation.advance(frame, &mut || true);
            }
            assert_eq!(run.state().hash(), other.state().hash(), "{}", kind.name());
        }
    }
}

#[test]
fn the_filter_takes_the_place_of_the_potential() {
    let level = flying(true, floor(true), "");
    let run = stepped(&Level { integrator: named("RungeKutta4"), ..level }, 1e-3);
    assert!(run.scene().effects.iter().all(|effect| effect.contact().is_none()));
}
