//! Films of the stage.

use crate::{film, folder::Folder, harness::*};
use eframe::egui::{Key, Modifiers, Role, ViewportCommand};
use egui_kittest::kittest::Queryable as _;
use gif::DecodeOptions;
use gingerbread::level::Substeps;
use std::{fs, path::PathBuf};

/// Ends the recording, waits until the film is drawn, and saves it.
fn saved(window: &mut Window, folder: &Folder, name: &str) -> PathBuf {
    let path = folder.0.join(name);
    press_with(window, Modifiers::SHIFT, Key::V);
    wait_until_gone(window, "Discard film");
    window.run_steps(3);
    type_path(window, &path, "Save");
    path
}

/// Delay of each frame of a GIF, in hundredths of a second.
fn delays(path: &PathBuf) -> Vec<u16> {
    let mut film = DecodeOptions::new().read_info(fs::File::open(path).unwrap()).unwrap();
    std::iter::from_fn(|| film.next_frame_info().unwrap().map(|frame| frame.delay)).collect()
}

/// Runs until the film shows an amount of simulated time. Its frames may wait to be drawn.
fn record_until(window: &mut Window, time: &str) {
    for _ in 0..1_000_000 {
        if window.query_by_label(time).is_some() {
            return;
        }
        window.run_steps(1);
    }
    unreachable!("the film never has {time}");
}

#[test]
fn a_film_has_30_frames_of_a_simulated_second() {
    let folder = Folder::new("film-mp4");
    let mut window = open_level(level("gingerbread_house"), 700.0, 500.0);
    press(&mut window, Key::T);
    let stage = stage(&window).size();
    press_with(&mut window, Modifiers::SHIFT, Key::V);
    record_until(&mut window, "0.40 s");
    let path = saved(&mut window, &folder, "man.mp4");
    let film = film::mp4(&fs::read(&path).unwrap());
    assert_eq!(film.size, [stage.x, stage.y].map(|points| points.round() as usize & !1));
    assert_eq!((film.frames.len(), film.interval), (13, Some(1.0 / 30.0)), "the first frame is that of the start");
    assert!(film.frames.windows(2).all(|pair| pair[0] != pair[1]), "he falls");
    assert!(window.state().notice().unwrap().starts_with("Saved as"));
}

#[test]
fn time_that_stands_is_not_in_the_film() {
    let folder = Folder::new("film-paused");
    let mut window = open_level(level("jelly_disk"), 420.0, 420.0);
    click(&mut window, "Pictures and films");
    click(&mut window, "Record a film (GIF)");
    assert!(window.query_by_label("0.00 s, waits for time to run").is_some());
    press(&mut window, Key::T);
    record_until(&mut window, "0.20 s");
    press(&mut window, Key::Space);
    window.run_steps(60);
    press(&mut window, Key::Backspace);
    press(&mut window, Key::Space);
    record_until(&mut window, "0.40 s");
    let path = saved(&mut window, &folder, "disk.gif");
    assert_eq!(delays(&path), [3, 4, 3, 3, 4, 3, 3, 4, 3, 3, 4, 3, 3], "thirtieths of a second in hundredths");
}

#[test]
fn v_alone_records_nets_and_a_film_can_be_discarded() {
    let mut window = open_level(level("hanging_net"), 420.0, 420.0);
    press(&mut window, Key::V);
    assert!(window.query_by_label("Discard film").is_some());
    click(&mut window, "Discard film");
    assert!(window.query_by_label("Discard film").is_none() && window.state().notice().is_none());
    // With bodies, V alone is a model.
    let mut window = open_level(level("jelly_disk"), 420.0, 420.0);
    press(&mut window, Key::V);
    assert!(window.query_by_label("Discard film").is_none());
    press_with(&mut window, Modifiers::SHIFT, Key::V);
    assert!(widget(&window, Role::Button, "Stop recording").rect().width() > 0.0);
}

#[test]
fn single_steps_are_in_the_film() {
    let folder = Folder::new("film-steps");
    let mut level = level("jelly_disk");
    level.substeps = Substeps::nearest(1.0);
    let mut window = open_level(level, 420.0, 420.0);
    click(&mut window, "Pictures and films");
    click(&mut window, "Record a film (GIF)");
    // A step is 1/60 s, so that every second one ends with a frame.
    for _ in 0..6 {
        click(&mut window, "Single step");
    }
    let path = saved(&mut window, &folder, "steps.gif");
    assert_eq!(delays(&path).len(), 4);
}

#[test]
fn closing_the_window_ends_the_film_and_asks_where_to_save_it() {
    let folder = Folder::new("film-close");
    let path = folder.0.join("last.mp4");
    let mut window = open_level(level("jelly_disk"), 420.0, 420.0);
    press_with(&mut window, Modifiers::SHIFT, Key::V);
    assert!(close(&mut window).contains(&ViewportCommand::CancelClose));
    wait_until_gone(&mut window, "Discard film");
    window.run_steps(3);
    type_path(&mut window, &path, "Save");
    assert_eq!(film::mp4(&fs::read(&path).unwrap()).frames.len(), 1);
    assert!(!close(&mut window).contains(&ViewportCommand::CancelClose), "nothing is lost now");
}
