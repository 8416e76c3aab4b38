//! Keys: each does what the table says, and nothing while a person types.

use crate::harness::*;
use eframe::egui::{Event, Key, Modifiers};
use egui_kittest::kittest::Queryable as _;
use gingerbread::app::keys::{Binding, TABLE, When};
use gingerbread::command::{Mode, Pose};
use gingerbread::materials::Model;
use gingerbread::snapshot::Snapshot;

fn expect(window: &Window, before: &Snapshot, binding: &Binding) {
    let now = window.state().snapshot();
    let what = format!("{} in {:?}", binding.label, before.mode);
    let models = |model: Model| {
        assert!(now.bodies.iter().all(|body| body.material.model() == Some(model)), "{what}");
        assert!(now.time < before.time || before.time == 0.0, "{what} must start over");
    };
    match (binding.label, before.mode) {
        ("C", _) => models(Model::Corotated),
        ("V", _) if binding.when == When::Bodies => models(Model::StVenantKirchhoff),
        ("N", _) => models(Model::NeoHookean),
        ("S", _) => models(Model::StableNeoHookean),
        ("F", _) => models(Model::FixedCorotated),
        ("H", _) => models(Model::Hencky),
        ("M", Mode::Simulate) | ("T", Mode::Collide) => assert_eq!(now.mode, Mode::Edit, "{what}"),
        ("M", _) => assert_eq!(now.mode, Mode::Simulate, "{what}"),
        ("T", _) => assert_eq!(now.mode, Mode::Collide, "{what}"),
        ("R", Mode::Edit) => assert!(now.pins.is_empty(), "{what}"),
        ("R", _) => assert!(now.time < before.time, "{what}"),
        ("D", _) => assert_ne!(now.damping, before.damping, "{what}"),
        ("W", _) => assert_ne!(now.wind, before.wind, "{what}"),
        ("Space", Mode::Edit) => assert!(now.running && now.mode == before.level.mode.into(), "{what}"),
        ("Space", _) => assert_eq!(now.running, !before.running, "{what}"),
        ("Backspace", _) => assert!(now.time < before.time && !now.running, "{what}"),
        ("Up", _) => assert_eq!(now.pose, Some(Pose::Stretched), "{what}"),
        ("Down", _) => assert_eq!(now.pose, Some(Pose::Compressed), "{what}"),
        ("U", _) => {
            assert!(window.state().notice().is_some_and(|notice| notice.contains("nothing to untangle")), "{what}");
        }
        ("." | ",", _) => assert!(now.steps > before.steps && !now.running, "{what}"),
        ("Page up", _) => assert!(window.query_by_label("Speed of time: 3").is_some(), "{what}"),
        ("Page down", _) => assert!(window.query_by_label("Speed of time: 1/3").is_some(), "{what}"),
        ("+" | "-" | "0" | "Z", _) => {
            let width = |window: &Window| on_screen(window, [1.0, 0.0]).x - on_screen(window, [0.0, 0.0]).x;
            let (own, whole) = (width(window), width(&in_mode("stretch_test", before.mode)));
            let is_right = match binding.label {
                "+" => own > 1.1 * whole,
                "-" => own < 0.9 * whole,
                "0" => own == whole,
                _ => own != whole,
            };
            assert!(is_right, "{what}: {own} for {whole}");
        }
        ("Ctrl+O", _) => assert!(window.query_by_label("Open").is_some(), "{what} asks for a file"),
        ("Ctrl+S", _) => assert!(window.query_by_label("Save").is_some(), "{what} asks where to save it"),
        ("F11", _) => {
            assert!(window.query_by_label("Level").is_none(), "{what} hides the toolbar");
            assert!(window.query_by_label("Show the panels").is_some(), "{what} has a way back");
        }
        ("P", _) => assert!(window.query_by_label_contains("Remove: ").is_none(), "{what}: nothing is under a pointer"),
        ("?", _) => assert!(window.query_by_label("Keys and mouse").is_some(), "{what}"),
        ("B", _) => assert!(window.state().comparison().is_some(), "{what}"),
        ("I", _) => assert!(window.query_by_label("Save").is_some(), "{what} asks where to save the picture"),
        ("V" | "Shift+V", _) => assert!(window.query_by_label("Discard film").is_some(), "{what} records a film"),
        ("Shift+R", _) => {
            assert!(now.records && now.running && window.query_by_label("End recording").is_some(), "{what} records");
        }
        ("Ctrl+Z" | "Ctrl+Y", _) => {}
        (other, _) => panic!("{other} is in the table, but no test says what it does"),
    }
}

#[test]
fn every_key_does_in_every_mode_what_the_table_says() {
    for binding in TABLE {
        let mut pressed = 0;
        for mode in [Mode::Edit, Mode::Simulate, Mode::Collide] {
            for shortcut in binding.shortcuts {
                let level = match binding.when {
                    When::Cloth => "cornell_cloth",
                    When::Nets => "hanging_net",
                    _ => "stretch_test",
                };
                let mut window = in_mode(level, mode);
                let before = window.state().snapshot().clone();
                if !binding.when.applies(&before) {
                    continue;
                }
                press_with(&mut window, shortcut.modifiers, shortcut.logical_key);
                expect(&window, &before, binding);
                pressed += 1;
            }
        }
        assert!(pressed > 0 || binding.shortcuts.is_empty(), "{} is never pressed", binding.label);
    }
}

#[test]
fn a_key_held_down_acts_once() {
    let mut window = open("gingerbread");
    let event =
        |repeat| Event::Key { key: Key::M, physical_key: None, pressed: true, repeat, modifiers: Modifiers::NONE };
    window.event(event(false));
    for _ in 0..5 {
        window.event(event(true));
        window.run_steps(1);
    }
    assert_eq!(mode(&window), Mode::Simulate);
}

#[test]
fn up_and_down_do_nothing_where_there_is_no_stretch_test() {
    let mut window = open("gingerbread");
    let before = window.state().snapshot().positions.clone();
    press(&mut window, Key::ArrowUp);
    press(&mut window, Key::ArrowDown);
    let now = window.state().snapshot();
    assert!(now.positions == before && now.pose.is_none() && window.state().notice().is_none());
}

#[test]
fn changing_the_model_puts_positions_and_velocities_back() {
    for (key, label) in [
        (Key::C, "Corotated"),
        (Key::V, "St. Venant-Kirchhoff"),
        (Key::N, "Neo-Hookean"),
        (Key::S, "Stable neo-Hookean"),
        (Key::F, "Fixed corotated"),
        (Key::H, "Hencky"),
    ] {
        for by_key in [true, false] {
            let mut window = in_mode("gingerbread_house", Mode::Collide);
            window.run_steps(20);
            assert!(moved(&window) > 1e-4, "he falls");
            press(&mut window, Key::Space);
            if by_key {
                press(&mut window, key);
            } else {
                click(&mut window, label);
            }
            assert_eq!(moved(&window), 0.0, "{label}");
            assert_eq!(window.state().snapshot().energies.kinetic, 0.0, "{label}");
        }
    }
}

#[test]
fn the_overlay_lists_every_key_of_the_table() {
    let mut window = open("gingerbread");
    press_with(&mut window, Modifiers::SHIFT, Key::Questionmark);
    for binding in TABLE {
        let name = format!("{}, {}", binding.label, binding.words);
        assert!(window.query_by_label(&name).is_some(), "{name} is not listed");
        assert!(window.query_by_label(binding.words).is_some(), "{} is not written out", binding.words);
    }
    press(&mut window, Key::Escape);
    assert!(window.query_by_label("Keys and mouse").is_none());
}

#[test]
fn the_overlay_toggles_even_if_shift_is_released_first() {
    let mut window = open("gingerbread");
    let question_mark =
        |pressed, modifiers, key| Event::Key { key, physical_key: Some(Key::Slash), pressed, repeat: false, modifiers };
    for shown in [true, false, true, false] {
        for event in [
            question_mark(true, Modifiers::SHIFT, Key::Questionmark),
            question_mark(true, Modifiers::SHIFT, Key::Questionmark),
            question_mark(false, Modifiers::NONE, Key::Slash),
        ] {
            window.event(event);
            window.run_steps(3);
        }
        assert_eq!(window.query_by_label("Keys and mouse").is_some(), shown);
    }
}

#[test]
fn no_key_acts_while_a_number_is_typed() {
    let mut window = in_mode("stretch_test", Mode::Simulate);
    press(&mut window, Key::Space);
    click_number(&mut window, "Young's modulus");
    let before = window.state().snapshot().clone();
    for binding in TABLE.iter().filter(|binding| binding.label != "Up" && binding.label != "Down") {
        for shortcut in binding.shortcuts {
            press_with(&mut window, shortcut.modifiers, shortcut.logical_key);
        }
    }
    let now = window.state().snapshot();
    assert_eq!((now.mode, now.running, now.damping), (before.mode, before.running, before.damping));
    assert_eq!((now.positions.as_slice(), &now.level), (before.positions.as_slice(), &before.level));
    assert!(window.query_by_label("Keys and mouse").is_none());
}

#[test]
fn space_runs_and_pauses_even_when_a_button_has_the_focus() {
    let mut window = open("gingerbread");
    window.get_by_label("Single step").focus();
    window.run_steps(2);
    press(&mut window, Key::Space);
    assert!(window.state().snapshot().running, "Space runs, and the focused button does not answer");
    press(&mut window, Key::Space);
    let steps = window.state().snapshot().steps;
    press(&mut window, Key::Enter);
    assert_eq!(window.state().snapshot().steps, steps + 1, "Enter presses the focused button");
}

#[test]
fn everything_a_key_does_is_a_button_too() {
    let mut window = open("stretch_test");
    for (label, expected) in [("Simulate", Mode::Simulate), ("Collide", Mode::Collide), ("Edit", Mode::Edit)] {
        click(&mut window, label);
        assert_eq!(mode(&window), expected);
    }
    click(&mut window, "Run");
    assert!(window.state().snapshot().running);
    click(&mut window, "Pause");
    let steps = window.state().snapshot().steps;
    assert!(!window.state().snapshot().running && steps > 0);
    click(&mut window, "Single step");
    assert_eq!(window.state().snapshot().steps, steps + 1);
    click(&mut window, "Start over");
    assert_eq!(window.state().snapshot().steps, 0);
    for (label, pose) in [("Compressed", Pose::Compressed), ("Stretched", Pose::Stretched)] {
        click(&mut window, label);
        assert_eq!(window.state().snapshot().pose, Some(pose));
    }
    click(&mut window, "All models side by side");
    assert_eq!(window.state().snapshot().bodies.len(), Model::ALL.len());
    click(&mut window, "Edit");
    click(&mut window, "R: remove all pins");
    assert!(window.state().snapshot().pins.is_empty());
    let damping = window.state().snapshot().damping;
    click(&mut window, "Keys");
    assert!(window.query_by_label("Keys and mouse").is_some());
    click(&mut window, "D, damping on or off");
    assert_ne!(window.state().snapshot().damping, damping);
}

#[test]
fn the_table_has_every_promised_key() {
    let labels: Vec<_> = TABLE.iter().map(|binding| binding.label).collect();
    for key in [
        "C", "V", "N", "S", "F", "H", "M", "T", "R", "D", "Space", "Up", "Down", "Click", "Drag", "Ctrl+Z", "Ctrl+Y",
        "B", "U", "?",
    ] {
        assert!(labels.contains(&key), "{key}");
    }
    assert_eq!(
        TABLE.iter().filter(|binding| binding.label == "R").map(|b| b.when).collect::<Vec<_>>(),
        [When::Edit, When::Moving]
    );
}
