//! A run that was stopped, saved and opened again, rewound or undone continues with the same bits as one that never stopped.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{coarse, greatest_gap, reopened, running, seen, sheet, simulation};
use gingerbread::{
    command::Command,
    effects::EffectKind,
    files,
    integrators::{Class, IntegratorKind, Scheme},
    level::{EffectLevel, Level, SubstepMode, Substeps, Toggle},
    levels::BUILT_IN,
    materials::MaterialParameters,
    quantity::Young,
    simulation::Simulation,
};

/// Steps per run.
const STEPS: u64 = 33;

/// Lengths of the pieces of a run, made from a seed; their sum is [`STEPS`].
fn pieces(seed: u64) -> Vec<u64> {
    let (mut random, mut left, mut pieces) = (seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1, STEPS, Vec::new());
    while left > 0 {
        random ^= random << 13;
        random ^= random >> 7;
        random ^= random << 17;
        let piece = (1 + random % 21).min(left);
        pieces.push(piece);
        left -= piece;
    }
    pieces
}

/// Where two runs differ.
fn difference(one: &Simulation, other: &Simulation) -> String {
    let (a, b) = (one.state(), other.state());
    let gap = greatest_gap(&a.x, &b.x);
    format!(
        "positions by up to {gap} m, memory {}, calm {:?} and {:?}",
        a.memory == b.memory,
        a.slow_checks,
        b.slow_checks
    )
}

/// Runs a level in one piece and in several with a save between them. Returns how often the guard took steps again.
fn compare(level: &Level, seed: u64) -> u64 {
    let about = format!("{}, {}, guard {:?}, seed {seed}", level.name, level.integrator.name(), level.guard);
    let mut straight = simulation(level);
    straight.advance(STEPS, &mut || true);
    let mut run = simulation(level);
    for piece in pieces(seed) {
        run.advance(piece, &mut || true);
        if run.fault().is_some() {
            break;
        }
        run = reopened(&run, level);
    }
    // The stability limit in a fault is that of a checkpoint, which is saved with the guard alone.
    let known = |run: &Simulation| {
        run.fault().map(|fault| (fault.step, fault.time, fault.culprit.clone(), std::mem::discriminant(&fault.cause)))
    };
    assert_eq!(known(&run), known(&straight), "{about}");
    assert!(level.guard == Toggle::Off || run.fault() == straight.fault(), "{about}");
    assert!(run.state() == straight.state(), "{about}: {}", difference(&run, &straight));
    straight.counts().retaken
}

/// The steps are too long for most explicit schemes, so that the guard is busy.
#[test]
fn saved_runs_continue_bit_equal_with_every_integrator() {
    let (mut retaken, mut seed) = (0, 0_u64);
    for (file, text) in BUILT_IN {
        let (fine, coarse) = (files::parse(text, file).unwrap(), coarse(text, file));
        let is_large = simulation(&fine).scene().triangles.len() > 5000;
        for integrator in IntegratorKind::all() {
            if fine.toy.is_some() && !matches!(integrator.kind().scheme(), Scheme::First(_)) {
                continue;
            }
            let projects = |listed: &EffectLevel| matches!(listed.effect, EffectKind::Projection(_));
            if fine.effects.iter().any(projects) && !integrator.kind().allows_projection() {
                continue;
            }
            // What implicit schemes remember does not depend on the mesh, and their steps are dear, as are all of large meshes.
            let level = if is_large || integrator.kind().class() == Class::Implicit { &coarse } else { &fine };
            seed += 1;
            let guard = Toggle::from(!seed.is_multiple_of(4));
            let substeps = Substeps::new([2, 8, 30][seed as usize % 3]).unwrap();
            let paces = if seed.is_multiple_of(5) { SubstepMode::Own } else { level.paces };
            let level = Level { integrator: integrator.clone(), guard, substeps, paces, ..level.clone() };
            retaken += compare(&level, seed);
        }
    }
    assert!(retaken > 50, "the guard took only {retaken} steps again");
}

/// A stretched sheet with a step above the stability limit, without end in shorter ones.
fn unstable() -> Level {
    let mut level = sheet("NeoHookean", "stretch: (1.4, 0.9)", "substeps: 7");
    let soft = level.bodies[0].material;
    let young = Young::new(5000.0).unwrap();
    level.bodies[0].material = MaterialParameters::new(soft.model(), young, soft.poisson(), soft.plane()).unwrap();
    level
}

#[test]
fn saving_while_the_guard_is_busy_changes_no_bit() {
    let level = unstable();
    let mut straight = simulation(&level);
    straight.advance(600, &mut || true);
    assert!(straight.counts().retaken > 20 && straight.fault().is_none(), "{:?}", straight.counts());
    let mut run = simulation(&level);
    for _ in 0..120 {
        run.advance(5, &mut || true);
        run = reopened(&run, &level);
    }
    assert!(run.state() == straight.state(), "{}", difference(&run, &straight));
}

/// A sheet to which every kind of scripted action is done within half a second.
fn scripted(integrator: IntegratorKind, guard: Toggle) -> Level {
    let text = "(name: \"scripted\", substeps: 8, bodies: [(name: \"sheet\",
            mesh: Rectangle(width: 0.4, height: 0.4, columns: 5, rows: 5), mass: Total(1), pins: [Left, Right],
            material: (model: NeoHookean, young: 200, poisson: 0.3))],
        effects: [(effect: Gravity(down: 3)), (effect: Rayleigh(mass: 0.5)), (effect: MouseSpring(stiffness: 20))],
        actions: [
            (at: 0, action: Grab(0.2, 0.2)), (at: 0.02, action: Pull(to: (0.3, 0.5), over: 0.2)), (at: 0.05, every: 0.1, action: FlipGravity),
            (at: 0.08, every: 0.15, action: Impulse(centre: (0.2, 0.2), radius: 0.2, push: (0.1, 0, 0), burst: 0.1)),
            (at: 0.1, action: Turn(side: Left, by: 40, over: 0.15)), (at: 0.3, action: Release), (at: 0.35, action: Grab(0.4, 0)),
            (at: 0.4, action: Free), (at: 0.42, action: Pull(to: (0.5, 0), over: 0.05)),
        ])";
    Level { integrator, guard, ..crate::common::level(text) }
}

/// Saving, rewinding and undoing change no bit.
#[test]
fn scripted_actions_continue_bit_equal() {
    const STEPS: u64 = 240;
    let mut unstable = Vec::new();
    for (number, integrator) in (0_u64..).zip(IntegratorKind::all()) {
        for guard in [Toggle::Off, Toggle::On] {
            let level = scripted(integrator.clone(), guard);
            let about = format!("{}, guard {guard:?}", integrator.name());
            let mut straight = simulation(&level);
            straight.advance(STEPS, &mut || true);
            if straight.fault().is_some() {
                unstable.push(about);
                continue;
            }
            assert!(straight.scripted_pull().is_some(), "{about}");
            let mut run = simulation(&level);
            for piece in pieces(7 * number + 1).into_iter().chain(pieces(number)).chain(pieces(number + 50)) {
                let left = STEPS - run.state().steps;
                run.advance(piece.min(left), &mut || true);
                run = reopened(&run, &level);
            }
            run.advance(STEPS - run.state().steps, &mut || true);
            assert!(run.state() == straight.state(), "{about}: {}", difference(&run, &straight));

            let mut sandbox = running(level);
            sandbox.advance(STEPS, &mut || true);
            assert!(*sandbox.simulation().state() == *straight.state(), "{about}, in the window");
            for frames in [2.0, 9.0, 28.0] {
                sandbox.apply(Command::Rewind(frames / 60.0)).unwrap();
                sandbox.apply(Command::SetRunning(true)).unwrap();
                sandbox.advance(STEPS - sandbox.simulation().state().steps, &mut || true);
                let gap = difference(sandbox.simulation(), &straight);
                assert!(*sandbox.simulation().state() == *straight.state(), "{about}, {frames} frames back: {gap}");
            }
            sandbox.apply(Command::Reset).unwrap();
            sandbox.advance(50, &mut || true);
            sandbox.apply(Command::Undo).unwrap();
            assert!(*sandbox.simulation().state() == *straight.state(), "{about}, undone");
            assert_eq!(sandbox.simulation().scripted_pull(), straight.scripted_pull(), "{about}, undone");
        }
    }
    assert!(unstable.len() <= 3, "forward Euler and Heun alone may fail here: {unstable:?}");
}

#[test]
fn hard_cases_run_as_levels_and_continue_bit_equal() {
    let mut with_actions = 0;
    for (file, text) in gingerbread::levels::HARD {
        let mut level = files::parse(text, file).unwrap();
        with_actions += u32::from(!level.actions.is_empty());
        // Coarse steps and an early end: what is compared is bits.
        level.substeps = Substeps::new(2).unwrap();
        let steps = if level.actions.is_empty() { 20 } else { 100 };
        let mut straight = simulation(&level);
        straight.advance(steps, &mut || true);
        let mut run = simulation(&level);
        for piece in [steps / 3, steps / 5, steps] {
            run.advance(piece.min(steps - run.state().steps), &mut || true);
            if run.fault().is_none() {
                run = reopened(&run, &level);
            }
        }
        assert!(run.state() == straight.state(), "{file}: {}", difference(&run, &straight));
    }
    assert_eq!(with_actions, 7);
}

/// A large body steps in batches, in which checkpoints are far apart.
#[test]
fn saving_after_a_batch_of_steps_changes_no_bit() {
    let mut scene_level = sheet("Corotated", "stretch: (1.2, 1)", "");
    scene_level.substeps = Substeps::new(60).unwrap();
    let mut straight = simulation(&scene_level);
    straight.advance(2000, &mut || true);
    for split in [33, 410, 1999] {
        let mut run = simulation(&scene_level);
        run.advance(split, &mut || true);
        let mut run = reopened(&run, &scene_level);
        run.advance(2000 - split, &mut || true);
        assert!(run.state() == straight.state(), "{split}: {}", difference(&run, &straight));
    }
}

#[test]
fn a_rewound_run_repeats_its_bits() {
    let mut sandbox = running(unstable());
    sandbox.advance(40 * 7, &mut || true);
    let there = sandbox.simulation().state().clone();
    for frames in [1, 3, 11, 24] {
        sandbox.apply(Command::Rewind(f64::from(frames) / 60.0)).unwrap();
        let left = there.steps - sandbox.simulation().state().steps;
        assert_eq!(left, 7 * u64::from(frames as u32));
        sandbox.apply(Command::SetRunning(true)).unwrap();
        sandbox.advance(left, &mut || true);
        assert!(*sandbox.simulation().state() == there, "{frames} frames");
    }
}

#[test]
fn an_undone_restart_repeats_its_bits() {
    let mut sandbox = running(unstable());
    sandbox.advance(123, &mut || true);
    let mut straight = sandbox.fork();
    straight.advance(200, &mut || true);
    sandbox.apply(Command::SetModel(gingerbread::materials::Model::Corotated)).unwrap();
    sandbox.advance(50, &mut || true);
    sandbox.apply(Command::Undo).unwrap();
    sandbox.apply(Command::SetRunning(true)).unwrap();
    sandbox.advance(200, &mut || true);
    let (run, straight) = (sandbox.simulation(), straight.simulation());
    assert!(run.state() == straight.state(), "{}", difference(run, straight));
    assert!(!seen(&sandbox).can_undo);
}

/// What was noted of a run must not act on a state that somebody edited.
#[test]
fn an_edited_saved_state_drops_what_the_guard_knew() {
    let level = unstable();
    let mut run = simulation(&level);
    run.advance(123, &mut || true);
    let mut saved = run.saved().unwrap();
    assert!(saved.guard.is_some() && !saved.checkpoints.is_empty());
    saved.positions.iter_mut().for_each(|point| {
        *point = gingerbread::quantity::Position::new(&[2.0 * point.get()[0], point.get()[1]]).unwrap();
    });
    let edited = simulation(&Level { state: Some(saved.clone()), ..level.clone() });
    let bare = gingerbread::level::SavedState { guard: None, checkpoints: Vec::new(), ..saved };
    let bare = simulation(&Level { state: Some(bare), ..level });
    assert_eq!(edited.restart(), bare.restart());
}
