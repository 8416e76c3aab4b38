//! Recording of pulls and pushes, and their replay.

use crate::{folder::Folder, harness::*};
use eframe::egui::{Key, Modifiers, vec2};
use egui_kittest::kittest::Queryable as _;
use gingerbread::{files, link};

#[test]
fn a_recorded_pull_is_saved_and_replayed_to_the_same_state() {
    let folder = Folder::new("recording");
    let mut window = open("gingerbread_house");
    click(&mut window, "Pictures and films");
    click(&mut window, "Record actions");
    assert!(window.state().snapshot().running);
    window.run_steps(5);
    let to = pull(&mut window, 40, vec2(60.0, -40.0));
    window.run_steps(10);
    let held = window.state().snapshot().pull.expect("the recorded pull acts");
    assert!(held.force > 0.0, "{held:?}");
    button(&window, to, false);
    window.run_steps(10);
    assert!(window.state().snapshot().pull.is_none(), "the release acts");
    click(&mut window, "End recording");
    let now = window.state().snapshot();
    assert!(!now.records && !now.running, "it pauses");
    assert!(window.state().notice().unwrap().contains("Start over and run"), "{:?}", window.state().notice());
    let end = now.level.recorded.clone().expect("the end is part of the level");
    assert_eq!(end.steps, now.steps);
    assert!(window.state().is_unsaved());

    press(&mut window, Key::R);
    press(&mut window, Key::Space);
    for _ in 0..200 {
        window.run_steps(1);
    }
    let now = window.state().snapshot();
    assert!(!now.running && now.steps == end.steps, "the replay stops at its end: {} of {}", now.steps, end.steps);
    assert!(window.state().notice().unwrap().contains("bit for bit"), "{:?}", window.state().notice());

    let path = folder.0.join("recorded.ron");
    let level = now.level.as_ref().clone();
    std::fs::write(&path, files::write(&level).unwrap()).unwrap();
    let mut window = open("chain");
    window.state_mut().open(&path);
    for _ in 0..200 {
        window.run_steps(1);
    }
    assert!(window.state().notice().unwrap().contains("bit for bit"), "opening it replays it");

    let changed = level.actions[1..].to_vec();
    let link = link::fragment(&gingerbread::level::Level { actions: changed, ..level }).unwrap();
    window.state_mut().open(link.as_ref());
    for _ in 0..200 {
        window.run_steps(1);
    }
    assert!(window.state().notice().unwrap().contains("not the recorded one"), "{:?}", window.state().notice());
}

#[test]
fn actions_are_recorded_in_a_single_pane() {
    let mut window = open("gingerbread_house");
    press_with(&mut window, Modifiers::SHIFT, Key::R);
    assert!(window.state().snapshot().records);
    press(&mut window, Key::B);
    assert!(!window.state().snapshot().records, "comparing ends the recording");
    press_with(&mut window, Modifiers::SHIFT, Key::R);
    assert!(window.state().notice().unwrap().contains("single pane"), "{:?}", window.state().notice());
    assert!(window.query_by_label("End recording").is_none());
}
