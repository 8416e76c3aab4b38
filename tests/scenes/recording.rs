//! Recorded actions: they replay bit for bit, and a level that was changed promises nothing.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{Random, built_in, coarse, named, opened, running, simulation};
use gingerbread::{
    command::{Command, Mode},
    impulse::Impulse,
    integrators::IntegratorKind,
    level::{Action, Level, RecordedEnd, ScriptedAction},
    levels, link,
    materials::Model,
    quantity::Time,
    sandbox::Sandbox,
};

/// Records pulls and pushes at irregular times, as a window would send them, and returns the level.
fn recorded(level: Level, seed: u64) -> Level {
    let mut sandbox = running(level);
    sandbox.apply(Command::Record(true)).unwrap();
    let mut numbers = Random(seed);
    let vertices = sandbox.simulation().scene().vertices();
    let mut at = [0.5, 0.5, 0.0];
    for turn in 0..40 {
        let command = match turn % 8 {
            0 => Command::Grab(numbers.between(0.0, vertices as f64) as usize, at),
            6 => Command::Release,
            7 => Command::Impulse(Impulse::push(at, [1.0, 0.5, 0.0], 0.2)),
            _ => {
                at = at.map(|coordinate| coordinate + numbers.between(-0.1, 0.1));
                Command::Pull(at)
            }
        };
        sandbox.apply(command).unwrap();
        let frame = sandbox.simulation().scene().steps_per_frame() as f64;
        sandbox.advance(numbers.between(0.0, 2.5 * frame) as u64, &mut || true);
    }
    let state = sandbox.simulation().state().clone();
    sandbox.apply(Command::Record(false)).unwrap();
    let level = sandbox.document().level.clone();
    assert!(level.recorded.as_ref().unwrap().is(&state) && !level.actions.is_empty());
    level
}

#[test]
fn recorded_actions_replay_bit_for_bit_with_every_scheme() {
    for (number, kind) in IntegratorKind::all().into_iter().enumerate() {
        for name in ["gingerbread_house", "hanging_net", "mit_cloth"] {
            let base = coarse(levels::built_in(name).unwrap(), name);
            let scheme = named(kind.name());
            let level = recorded(Level { integrator: scheme, ..base }, number as u64);
            let sent = link::level(&link::fragment(&level).unwrap()).unwrap().unwrap();
            let mut replay = simulation(&sent);
            let steps = sent.recorded.as_ref().unwrap().steps;
            replay.advance(steps - 1, &mut || true);
            assert_eq!(replay.replayed(), None, "{name} with {}: before the end", kind.name());
            replay.advance(100, &mut || true);
            assert_eq!(replay.replayed(), Some(true), "{name} with {}", kind.name());
        }
    }
}

#[test]
fn a_replay_to_another_state_is_told() {
    let level = recorded(built_in("hanging_net"), 1);
    let end = level.recorded.clone().unwrap();
    let other = RecordedEnd { hash: "0123456789abcdef".to_owned(), ..end.clone() };
    let mut replay = simulation(&Level { recorded: Some(other), ..level.clone() });
    replay.advance(end.steps, &mut || true);
    assert_eq!(replay.replayed(), Some(false));
    let mut shorter = level.clone();
    shorter.actions.remove(1);
    let mut replay = simulation(&shorter);
    replay.advance(end.steps, &mut || true);
    assert_eq!(replay.replayed(), Some(false), "without one of the actions");
}

fn replayed(sandbox: &mut Sandbox) -> Option<bool> {
    let steps = sandbox.document().level.recorded.as_ref().map_or(50, |end| end.steps);
    sandbox.apply(Command::SetRunning(true)).unwrap();
    sandbox.advance(steps - sandbox.simulation().state().steps, &mut || true);
    sandbox.simulation().replayed()
}

#[test]
fn a_hand_in_a_replay_ends_the_comparison_until_the_next_start() {
    let level = recorded(built_in("hanging_net"), 1);
    let mut sandbox = running(level);
    assert_eq!(replayed(&mut sandbox), Some(true));
    sandbox.apply(Command::Reset).unwrap();
    assert_eq!(replayed(&mut sandbox), Some(true), "again");
    sandbox.apply(Command::Reset).unwrap();
    sandbox.advance(10, &mut || true);
    sandbox.apply(Command::Grab(3, [0.0; 3])).unwrap();
    assert_eq!(replayed(&mut sandbox), None, "a pull that was not recorded");
    sandbox.apply(Command::Reset).unwrap();
    assert_eq!(replayed(&mut sandbox), Some(true), "from the start");
    sandbox.apply(Command::Rewind(0.2)).unwrap();
    assert_eq!(replayed(&mut sandbox), Some(true), "the end is reached once more");
}

#[test]
fn a_changed_level_has_no_recorded_end() {
    let level = recorded(built_in("gingerbread_house"), 2);
    let actions = level.actions.len();
    let mut sandbox = running(level);
    sandbox.apply(Command::SetModel(Model::NeoHookean)).unwrap();
    let level = &sandbox.document().level;
    assert!(level.recorded.is_none() && level.actions.len() == actions, "the actions stay");
    assert_eq!(replayed(&mut sandbox), None);
    sandbox.apply(Command::Undo).unwrap();
    sandbox.apply(Command::Reset).unwrap();
    assert_eq!(replayed(&mut sandbox), Some(true), "undo brings it back");
}

#[test]
fn another_command_ends_a_recording_and_is_carried_out() {
    for command in [Command::SetMode(Mode::Simulate), Command::SetDamping(true), Command::Reset, Command::Undo] {
        let mut sandbox = opened("gingerbread_house");
        sandbox.apply(Command::Record(true)).unwrap();
        assert!(sandbox.is_recording() && sandbox.is_live(), "time runs");
        sandbox.advance(100, &mut || true);
        sandbox.apply(Command::SetRunning(false)).unwrap();
        sandbox.apply(Command::StepOnce).unwrap();
        assert!(sandbox.is_recording(), "commands of time do not end it");
        sandbox.apply(command.clone()).unwrap();
        assert!(!sandbox.is_recording(), "{command:?}");
    }
}

#[test]
fn a_second_recording_replaces_the_first_and_keeps_other_actions() {
    let own = vec![ScriptedAction { at: Time::new(0.1).unwrap(), every: None, action: Action::Free }];
    let first = recorded(Level { actions: own.clone(), ..built_in("hanging_net") }, 1);
    assert_eq!(first.actions[..1], own);
    let second = recorded(first, 2);
    assert_eq!(second.actions[..1], own);
    let count = second.recorded.as_ref().unwrap().actions;
    assert_eq!(second.actions.len(), 1 + count);
    let mut sandbox = running(second);
    sandbox.apply(Command::Record(true)).unwrap();
    assert_eq!(sandbox.document().level.actions, own);
}

/// In the same frame of simulated time, so that none of them has been performed yet.
#[test]
fn a_push_just_before_a_release_is_recorded() {
    let mut sandbox = opened("hanging_net");
    sandbox.apply(Command::Record(true)).unwrap();
    sandbox.apply(Command::Grab(3, [0.2, 0.2, 0.0])).unwrap();
    let frames = 3 * sandbox.simulation().scene().steps_per_frame();
    sandbox.advance(frames, &mut || true);
    let push = Impulse::push([0.5, 0.5, 0.0], [1.0, 0.0, 0.0], 1.0);
    for command in [Command::Pull([0.3, 0.2, 0.0]), Command::Impulse(push), Command::Release] {
        sandbox.apply(command).unwrap();
    }
    sandbox.advance(frames, &mut || true);
    sandbox.apply(Command::Record(false)).unwrap();
    let kinds: Vec<_> = sandbox.document().level.actions.iter().map(|scripted| scripted.action.clone()).collect();
    assert!(
        matches!(kinds[..], [Action::Grab(_), Action::Pull { .. }, Action::Impulse { .. }, Action::Release]),
        "{kinds:?}"
    );
    sandbox.apply(Command::Reset).unwrap();
    assert_eq!(replayed(&mut sandbox), Some(true));
}

/// Beyond the end of a recording nothing is held, even if it ended before the release was performed.
#[test]
fn nothing_is_held_after_the_end_of_a_recording() {
    for released in [false, true] {
        let mut sandbox = opened("hanging_net");
        sandbox.apply(Command::Record(true)).unwrap();
        sandbox.apply(Command::Grab(3, [0.2, 0.2, 0.0])).unwrap();
        let frames = 3 * sandbox.simulation().scene().steps_per_frame();
        sandbox.advance(frames + 1, &mut || true);
        assert!(sandbox.simulation().grab().is_some());
        if released {
            sandbox.apply(Command::Release).unwrap();
        }
        sandbox.apply(Command::Record(false)).unwrap();
        sandbox.apply(Command::SetRunning(true)).unwrap();
        sandbox.advance(frames, &mut || true);
        assert!(sandbox.simulation().grab().is_none(), "released: {released}");
    }
}

#[test]
fn a_toy_has_no_actions_to_record() {
    let mut sandbox = opened("circle");
    assert!(sandbox.apply(Command::Record(true)).is_err() && !sandbox.is_recording());
}
