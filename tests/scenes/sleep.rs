//! What has come to rest sleeps: it costs nothing, moves nothing, and wakes when something happens to it.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{greatest_gap, level, reopened, simulation};
use gingerbread::{
    command::{Command, Mode},
    effects::Grab,
    integrators::IntegratorKind,
    level::{EffectLevel, Level, Sleep, Toggle},
    meshes::NoFiles,
    quantity::Density,
    sandbox::Sandbox,
    simulation::Simulation,
};

/// Effects: gravity, a floor that does not slip, and strong damping.
fn settling(size: f64) -> String {
    format!(
        "substeps: 20, effects: [(effect: Gravity(down: {})), (effect: Rayleigh(mass: 8, stiffness: 0.002)), (effect: MouseSpring(stiffness: 30)),
          (effect: Walls(obstacles: [Plane(point: (0, 0), normal: (0, 1), eps: {})])), (effect: Friction(coefficient: 0.5)), (effect: Contact(speed: {}))]",
        4.0 * size,
        0.01 * size,
        2.0 * size
    )
}

/// A block above the floor, of this size and density; motion is the same at every size.
fn block(name: &str, left: f64, size: f64, density: f64) -> String {
    format!(
        "(name: \"{name}\", mass: Density({density}), material: (model: NeoHookean, young: {}, poisson: 0.3, plane: Stress),
          mesh: Rectangle(width: {w}, height: {w}, columns: 3, rows: 3, diagonals: Alternating, corner: ({}, {})))",
        300.0 * size * size * density,
        left * size,
        0.02 * size,
        w = 0.25 * size
    )
}

fn falling() -> Level {
    level(&format!("(name: \"block\", bodies: [{}], {})", block("a", 0.25, 1.0, 1.0), settling(1.0)))
}

fn hanging() -> Level {
    let block = block("a", 0.25, 1.0, 1.0).replace("mass:", "pins: [Top], mass:");
    let above = settling(1.0).replace("point: (0, 0)", "point: (0, -1)");
    level(&format!("(name: \"block\", bodies: [{block}], {above})"))
}

/// Runs until everything sleeps; returns the number of steps.
fn until_asleep(run: &mut Simulation) -> u64 {
    while !run.is_asleep() && run.state().time < 60.0 {
        run.advance(10, &mut || true);
    }
    assert!(run.is_asleep(), "still awake after {} s", run.state().time);
    run.state().steps
}

#[test]
fn a_body_at_rest_sleeps_and_costs_nothing() {
    let mut run = simulation(&falling());
    until_asleep(&mut run);
    let (before, counts, costs) = (run.state().clone(), run.counts(), run.costs().to_vec());
    assert_eq!(run.advance(100_000, &mut || true), 100_000);
    let after = run.counts();
    assert_eq!(after.force_evaluations, counts.force_evaluations, "no force is evaluated");
    assert_eq!((after.steps - counts.steps, after.slept - counts.slept), (100_000, 100_000));
    for (now, then) in run.costs().iter().zip(&costs) {
        assert_eq!((now.calls, now.elements), (then.calls, then.elements), "{}: no wall is asked", now.name);
        assert_eq!((now.skipped - then.skipped, now.idle), (100_000, Some("everything sleeps")), "{}", now.name);
    }
    assert_eq!(run.state().x, before.x);
    assert!(run.state().v.iter().all(|v| *v == 0.0) && run.state().time > before.time + 80.0);
}

/// The difference is below a thousandth of the size.
#[test]
fn a_sleeping_run_stays_near_an_awake_one() {
    let (mut sleepy, mut awake) = (simulation(&falling()), simulation(&Level { sleep: Sleep::Off, ..falling() }));
    let steps = until_asleep(&mut sleepy) + 12_000;
    sleepy.advance(12_000, &mut || true);
    awake.advance(steps, &mut || true);
    assert!(!awake.is_asleep() && awake.counts().slept == 0, "sleep can be switched off");
    let apart = greatest_gap(&sleepy.state().x, &awake.state().x);
    assert!(apart < 0.25e-3, "{apart} m apart after ten seconds");
}

#[test]
fn a_pull_wakes_without_a_jump_and_letting_go_wakes_nobody() {
    let mut run = simulation(&falling());
    until_asleep(&mut run);
    let asleep = run.state().x.clone();
    run.set_grab(None);
    assert!(run.is_asleep());
    run.set_grab(Some(Grab { vertex: 15, target: [0.6, 0.5, 0.0] }));
    assert!(!run.is_asleep() && run.state().x == asleep, "positions keep every bit on waking");
    let mut awake = simulation(&Level { sleep: Sleep::Off, ..falling() });
    awake.set_state(run.state().clone());
    awake.set_grab(run.grab());
    for run in [&mut run, &mut awake] {
        run.advance(50, &mut || true);
    }
    assert!(run.state().x == awake.state().x && run.state().x != asleep, "and go on as if it had never slept");
    run.advance(2400, &mut || true);
    assert!(!run.is_asleep(), "what is held in the hand does not sleep");
    run.set_grab(None);
    until_asleep(&mut run);
}

/// Lengths, masses and stiffness scaled by powers of two scale every bit of the motion: so must the moment of falling asleep.
#[test]
fn the_criterion_of_rest_is_scale_invariant() {
    let moments = [(1.0, 1.0), (1024.0, 1.0), (1.0 / 1024.0, 1.0), (1.0, 4096.0), (1.0 / 1024.0, 1.0 / 4096.0)].map(
        |(size, density)| {
            // Drag of the mouse spring apart, nothing in the scene has a scale of its own.
            let text = format!("(name: \"\", bodies: [{}], {})", block("a", 0.25, size, density), settling(size));
            until_asleep(&mut simulation(&level(&text)))
        },
    );
    assert!(moments.iter().all(|moment| *moment == moments[0]), "{moments:?}");
}

#[test]
fn what_hangs_swings_or_falls_however_slowly_stays_awake() {
    let body = "(name: \"b\", mass: Density(1), material: (model: Corotated, young: 1000, poisson: 0.3),
        mesh: Rectangle(width: 0.2, height: 0.2, columns: 2, rows: 2, diagonals: Grid, corner: (0.4, 0.4)))";
    for gravity in [1e-3, 1e-5, 1e-8] {
        let text =
            format!("(name: \"\", substeps: 10, bodies: [{body}], effects: [(effect: Gravity(down: {gravity}))])");
        let mut run = simulation(&level(&text));
        run.advance(1800, &mut || true);
        assert!(!run.is_asleep(), "under {gravity} m/s² it begins to fall");
    }
    // A pendulum with hardly any swing is slow at its turning points, and slow to fall from nearly upright.
    for (x, y) in [(0.55, 0.1), (0.5002, 0.9)] {
        let text = format!("(name: \"\", nets: [(name: \"\", net: Chain(from: (0.5, 0.5), to: ({x}, {y}), springs: 1, stiffness: 1e4, rest: 0.4), mass: 1,
            pins: [Vertex(0)])], effects: [(effect: Gravity(down: 9.8))])");
        let mut run = simulation(&level(&text));
        run.advance(12_000, &mut || true);
        assert_eq!(run.counts().slept, 0, "{x} {y}");
    }
    let adrift =
        format!("(name: \"\", substeps: 10, bodies: [{}])", body.replace("mass:", "velocity: (0.001, 0), mass:"));
    let mut run = simulation(&level(&adrift));
    run.advance(1800, &mut || true);
    assert!(!run.is_asleep());
}

#[test]
fn each_body_and_net_sleeps_by_itself() {
    let net = "nets: [(name: \"n\", net: Chain(from: (0.9, 0.9), to: (0.9, 0.7), springs: 1, stiffness: 50, rest: 0.1), mass: 0.1, pins: [Vertex(0)])]";
    let text = format!(
        "(name: \"\", bodies: [{}, {}], {net}, {})",
        block("a", 0.0, 1.0, 1.0),
        block("b", 0.5, 1.0, 1.0),
        settling(1.0)
    );
    let mut run = simulation(&level(&text));
    until_asleep(&mut run);
    let (before, calls) = (run.state().clone(), run.costs().iter().map(|cost| cost.calls).collect::<Vec<_>>());
    // The second block is pulled: it alone wakes.
    run.set_grab(Some(Grab { vertex: 20, target: [0.7, 0.6, 0.0] }));
    assert_eq!(run.sleeping().collect::<Vec<_>>(), [true, false, true]);
    run.advance(300, &mut || true);
    let called: Vec<_> = run.costs().iter().zip(&calls).map(|(cost, before)| cost.calls - before).collect();
    assert_eq!(called[..3], [0, 300, 0], "its elements alone are computed");
    assert_eq!(run.costs()[0].idle, Some("asleep"));
    assert_eq!((&run.state().x[..32], &run.state().x[64..]), (&before.x[..32], &before.x[64..]), "the others stay");
    assert_ne!(run.state().x[32..64], before.x[32..64]);
}

/// A swinging block and one that hangs still: the equations of the first are those it has alone.
#[test]
fn a_sleeper_does_not_affect_implicit_steps_of_others() {
    let pinned = |name, left| block(name, left, 1.0, 1.0).replace("mass:", "pins: [Top], mass:");
    let (still, swinging) =
        (pinned("still", 0.6), block("swinging", 0.1, 1.0, 1.0).replace("mass:", "pins: [Vertex(12)], mass:"));
    let rest = settling(1.0).replace("mass: 8", "mass: 0.01").replace("stiffness: 0.002", "stiffness: 0.001");
    let run = |bodies: &str, still: bool| {
        let text = format!("(name: \"\", integrator: ImplicitEuler(), bodies: [{bodies}], {rest})");
        let mut run = simulation(&level(&text.replace("substeps: 20", "substeps: 2")));
        while still && !run.sleeping().any(|asleep| asleep) {
            run.advance(1, &mut || true);
        }
        run
    };
    let mut both = run(&format!("{swinging}, {still}"), true);
    let mut alone = run(&swinging, false);
    let (steps, sleeper) = (both.state().steps, both.state().x[32..].to_vec());
    alone.advance(steps, &mut || true);
    assert_eq!(both.sleeping().collect::<Vec<_>>(), [false, true]);
    // With the derivative of what is awake, and of nothing else, Newton's method takes as few iterations as alone.
    let iterations = [&mut both, &mut alone].map(|run| {
        let before = run.counts().newton_iterations;
        run.advance(60, &mut || true);
        run.counts().newton_iterations - before
    });
    assert!(iterations[0] == iterations[1] && iterations[0] <= 5 * 60, "{iterations:?}");
    let apart = greatest_gap(&both.state().x[..32], &alone.state().x);
    assert!(apart < 1e-7, "{apart:e} m");
    assert_eq!(both.state().x[32..], sleeper, "the sleeper stays");
}

/// Hanging, not lying: schemes that kick twice a step never quite stop at a floor, which stops them once.
#[test]
fn whatever_the_scheme_what_hangs_still_sleeps() {
    for integrator in IntegratorKind::all() {
        let mut run = simulation(&Level { integrator, ..hanging() });
        until_asleep(&mut run);
        let (x, evaluations) = (run.state().x.clone(), run.counts().force_evaluations);
        run.advance(100, &mut || true);
        assert_eq!((run.state().x == x, run.counts().force_evaluations), (true, evaluations));
    }
}

#[test]
fn a_run_saved_before_or_during_sleep_goes_on_bit_for_bit() {
    let mut whole = simulation(&falling());
    let asleep = until_asleep(&mut whole);
    whole.advance(500, &mut || true);
    for moment in [asleep - 200, asleep - 130, asleep - 17, asleep, asleep + 99] {
        let mut first = simulation(&falling());
        first.advance(moment, &mut || true);
        let mut second = reopened(&first, &falling());
        second.advance(whole.state().steps - moment, &mut || true);
        assert_eq!(second.state(), whole.state(), "saved after {moment} steps of {asleep}");
    }
}

fn resting() -> Sandbox {
    let mut sandbox = Sandbox::new(falling(), Box::new(NoFiles)).unwrap();
    sandbox.apply(Command::SetMode(Mode::Collide)).unwrap();
    for _ in 0..3600 {
        if !sandbox.is_busy() {
            break;
        }
        sandbox.advance(20, &mut || true);
    }
    assert!(sandbox.is_live() && !sandbox.is_busy());
    sandbox
}

#[test]
fn time_can_be_turned_back_to_before_sleep() {
    let mut sandbox = resting();
    let asleep = sandbox.simulation().state().clone();
    sandbox.apply(Command::Rewind(1.0)).unwrap();
    sandbox.apply(Command::SetRunning(true)).unwrap();
    assert!(sandbox.is_busy() && sandbox.simulation().state().time < asleep.time);
    let steps = asleep.steps - sandbox.simulation().state().steps;
    sandbox.advance(steps, &mut || true);
    assert_eq!(sandbox.simulation().state(), &asleep, "it falls asleep again as it did");
}

#[test]
fn every_change_of_what_acts_wakes_and_moves_nothing() {
    let first: EffectLevel = falling().effects.remove(0);
    let off = EffectLevel { switch: gingerbread::level::Switch::Off, ..first };
    let changes = [
        Command::SetEffect(0, off),
        Command::SetDamping(false),
        Command::AddEffect(gingerbread::effects::EffectKind::all().remove(2)),
        Command::SetMass(0, gingerbread::level::MassLevel::Density(Density::new(2.0).unwrap())),
        Command::SetSubsteps(gingerbread::level::Substeps::new(40).unwrap()),
        Command::TogglePin(3),
        Command::SetGuard(Toggle::Off),
        Command::SetSleep(Sleep::Off),
        Command::SetSubstepMode(gingerbread::level::SubstepMode::Own),
        Command::Grab(3, [0.5, 0.5, 0.0]),
    ];
    for change in changes {
        let mut sandbox = resting();
        let x = sandbox.simulation().state().x.clone();
        sandbox.apply(change.clone()).unwrap();
        assert!(sandbox.is_busy(), "{change:?}");
        assert_eq!(sandbox.simulation().state().x, x, "{change:?}");
    }
}
