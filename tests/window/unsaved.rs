//! Changes that are not saved: nothing replaces them, and nothing closes the window over them, without a question.

use crate::harness::*;
use eframe::egui::{Key, Modifiers, ViewportCommand};
use egui_kittest::kittest::Queryable as _;
use gingerbread::materials::Model;
use std::path::{Path, PathBuf};

/// A file that is gone at the end of a test.
struct Gone(PathBuf);

impl Drop for Gone {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

fn own_file(folder: &Path, name: &str) -> Gone {
    Gone(folder.join(format!("gingerbread-{name}-{}.ron", std::process::id())))
}

fn is_asked(window: &Window) -> bool {
    window.query_by_label("Save the changes?").is_some()
}

/// A window with a change of the model.
fn changed() -> Window {
    let mut window = open("gingerbread");
    press(&mut window, Key::N);
    window
}

fn model(window: &Window) -> Model {
    window.state().snapshot().bodies[0].material.model().unwrap()
}

#[test]
fn closing_asks_only_over_unsaved_changes() {
    let mut window = open("gingerbread");
    press(&mut window, Key::M);
    window.run_steps(20);
    assert!(!close(&mut window).contains(&ViewportCommand::CancelClose), "time that ran is no change");

    let mut window = changed();
    assert!(close(&mut window).contains(&ViewportCommand::CancelClose) && is_asked(&window));
    click(&mut window, "Cancel");
    assert!(!is_asked(&window) && model(&window) == Model::NeoHookean);
    assert!(!asked(&mut window).contains(&ViewportCommand::Close));

    close(&mut window);
    window.get_by_label("Discard").click();
    assert!(asked(&mut window).contains(&ViewportCommand::Close));
    assert!(!close(&mut window).contains(&ViewportCommand::CancelClose), "it is decided");
}

#[test]
fn what_was_undone_or_saved_is_not_asked_about() {
    let file = own_file(&std::env::temp_dir(), "asked");
    let mut window = changed();
    window.state_mut().save(&file.0);
    assert!(!close(&mut window).contains(&ViewportCommand::CancelClose));
    let mut window = changed();
    press_with(&mut window, Modifiers::COMMAND, Key::Z);
    assert!(!close(&mut window).contains(&ViewportCommand::CancelClose));
    window.state_mut().open(&file.0);
    window.run_steps(3);
    assert!(!close(&mut window).contains(&ViewportCommand::CancelClose) && model(&window) == Model::NeoHookean);
}

/// Its name, and what the hands do.
type Way<'a> = (&'a str, &'a dyn Fn(&mut Window));

#[test]
fn each_way_to_open_asks_over_unsaved_changes() {
    let file = own_file(&std::env::temp_dir(), "dropped");
    std::fs::write(&file.0, gingerbread::files::write(&level("hammock")).unwrap()).unwrap();
    let ways: [Way<'_>; 4] = [
        ("picker", &|window| choose(window, "Hammock")),
        ("dialog", &|window| {
            click(window, "Level");
            click(window, "Open…");
        }),
        ("hard case", &|window| {
            click(window, "Level");
            click(window, "Hard cases…");
            window.get_by_label("Open Mirror image").click_accesskit();
            window.run_steps(3);
        }),
        ("drop", &|window| drop_files(window, &[&file.0])),
    ];
    for (name, way) in ways {
        let mut window = changed();
        way(&mut window);
        assert!(is_asked(&window), "{name}");
        click(&mut window, "Cancel");
        assert!(!is_asked(&window) && model(&window) == Model::NeoHookean, "{name}");
        assert_eq!(window.state().snapshot().level.name, level("gingerbread").name, "{name}");
        press(&mut window, Key::Escape);
        way(&mut window);
        click(&mut window, "Discard");
        if name == "dialog" {
            type_path(&mut window, &file.0, "Open");
        }
        assert_ne!(window.state().snapshot().level.name, level("gingerbread").name, "{name}");
        assert!(!window.state().is_unsaved(), "{name}");

        let mut window = open("gingerbread");
        way(&mut window);
        assert!(!is_asked(&window), "{name}: nothing was changed");
    }
}

#[test]
fn the_question_is_answered_by_keys_and_other_keys_wait() {
    let mut window = changed();
    close(&mut window);
    let damping = window.state().snapshot().damping;
    for key in [Key::D, Key::M, Key::C] {
        press(&mut window, key);
    }
    let now = window.state().snapshot();
    assert_eq!(
        (now.damping, mode(&window), model(&window)),
        (damping, gingerbread::command::Mode::Edit, Model::NeoHookean)
    );
    press(&mut window, Key::Escape);
    assert!(!is_asked(&window));
    close(&mut window);
    window.run_steps(2);
    press(&mut window, Key::Enter);
    assert!(!is_asked(&window) && window.query_by_label("Save the level").is_some(), "Enter saves");
    click(&mut window, "Cancel");
    close(&mut window);
    window.run_steps(2);
    window.key_press(Key::Tab);
    window.run_steps(2);
    window.key_press(Key::Enter);
    assert!(asked(&mut window).contains(&ViewportCommand::Close), "Tab and Enter discard");
}

#[test]
fn saving_first_goes_on_with_what_was_wished() {
    let file = own_file(&std::env::temp_dir(), "first");
    let mut window = changed();
    choose(&mut window, "Hammock");
    click(&mut window, "Save");
    type_path(&mut window, &std::env::temp_dir().join("gingerbread-no-such-folder/level.ron"), "Save");
    assert_eq!(model(&window), Model::NeoHookean, "what cannot be saved is not lost");
    assert!(window.state().notice().is_some_and(|notice| notice.contains("no-such-folder")));
    press(&mut window, Key::Escape);

    choose(&mut window, "Hammock");
    click(&mut window, "Save");
    click(&mut window, "Cancel");
    window.run_steps(3);
    assert_eq!(model(&window), Model::NeoHookean, "no file, no other level");

    choose(&mut window, "Hammock");
    click(&mut window, "Save");
    type_path(&mut window, &file.0, "Save");
    assert_eq!(window.state().snapshot().level.name, level("hammock").name);
    let saved = gingerbread::files::read(&file.0).unwrap();
    assert_eq!(saved.bodies[0].material.model(), Model::NeoHookean);
}

#[test]
fn changes_in_either_pane_are_asked_about() {
    let mut window = open("gingerbread");
    press(&mut window, Key::B);
    type_number(&mut window, "Substeps", "40");
    assert!(close(&mut window).contains(&ViewportCommand::CancelClose), "pane B differs from what was opened");
}

#[test]
fn starting_over_loses_nothing_as_undo_brings_it_back() {
    for compared in [false, true] {
        let mut window = open("gingerbread_house");
        if compared {
            press(&mut window, Key::B);
        }
        press(&mut window, Key::T);
        window.run_steps(20);
        press(&mut window, Key::Space);
        let before = window.state().snapshot().clone();
        press(&mut window, Key::R);
        assert!(!is_asked(&window) && moved(&window) == 0.0);
        press_with(&mut window, Modifiers::COMMAND, Key::Z);
        let now = window.state().snapshot();
        assert_eq!((&now.positions, now.time), (&before.positions, before.time), "two panes: {compared}");
        press_with(&mut window, Modifiers::COMMAND, Key::Y);
        assert_eq!(moved(&window), 0.0);
        press(&mut window, Key::R);
        press_with(&mut window, Modifiers::COMMAND, Key::Z);
        assert_eq!(window.state().snapshot().positions, before.positions, "at the start there was nothing to lose");
    }
}

#[test]
fn the_whole_path_of_a_file_is_shown() {
    let here = std::env::current_dir().unwrap();
    let file = own_file(&here, "whole");
    let name = file.0.file_name().unwrap();
    let mut window = open("gingerbread");
    window.state_mut().save(Path::new(name));
    let whole = file.0.display().to_string();
    assert!(window.state().notice().is_some_and(|notice| notice.contains(&whole)), "{:?}", window.state().notice());
    window.state_mut().open(Path::new(name));
    assert_eq!(window.state().notice(), Some(format!("Opened {whole}").as_str()));
    window.state_mut().open(Path::new("gingerbread-is-not-here.ron"));
    let missing = here.join("gingerbread-is-not-here.ron").display().to_string();
    assert!(window.state().notice().is_some_and(|notice| notice.contains(&missing)));
}

/// The rest is told.
#[test]
fn the_first_level_of_several_dropped_files_opens() {
    let folder = std::env::temp_dir();
    let [a, b, c] = ["a", "b", "c"].map(|name| own_file(&folder, &format!("several-{name}")));
    for (file, name) in [(&a, "hammock"), (&b, "chain")] {
        std::fs::write(&file.0, gingerbread::files::write(&level(name)).unwrap()).unwrap();
    }
    let mut window = open("gingerbread");
    drop_files(&mut window, &[&a.0, &b.0]);
    assert_eq!(window.state().snapshot().level.name, level("hammock").name);
    let told = |window: &Window, path: &Path| {
        window.state().notice().is_some_and(|notice| notice.contains(&format!("Not opened: {}", path.display())))
    };
    assert!(told(&window, &b.0), "{:?}", window.state().notice());
    drop_files(&mut window, &[&c.0.with_extension("png"), &b.0]);
    assert_eq!(window.state().snapshot().level.name, level("chain").name, "the picture is no level");
    drop_files(&mut window, &[&c.0, &a.0]);
    assert_eq!(window.state().snapshot().level.name, level("chain").name, "a file that cannot be read opens nothing");
    assert!(
        told(&window, &a.0)
            && window.state().notice().is_some_and(|notice| notice.contains(&c.0.display().to_string()))
    );
}
