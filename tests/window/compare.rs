//! Two panes of one scene: pulled by one hand, computed in two ways.

use crate::harness::*;
use eframe::egui::{Event, Key, Modifiers, Pos2, Rect, Role, vec2};
use egui_kittest::kittest::Queryable as _;
use gingerbread::app::compare::{Comparison, Pane};
use gingerbread::command::Mode;
use gingerbread::materials::Model;
use gingerbread::snapshot::Snapshot;
use gingerbread::study::Apart;
use gingerbread::{files, levels};

fn panes(window: &Window) -> &Comparison {
    window.state().comparison().expect("two panes")
}

fn seen(window: &Window) -> [&Snapshot; 2] {
    [window.state().snapshot(), panes(window).snapshot()]
}

fn stage_of(window: &Window, pane: Pane) -> Rect {
    window.get_by_label(if pane == Pane::A { "Stage A" } else { "Stage B" }).rect()
}

fn in_pane(window: &Window, pane: Pane, point: [f64; 2]) -> Pos2 {
    window.state().on_screen(stage_of(window, pane), point)
}

/// A window with two panes, running.
fn compared(name: &str) -> Window {
    let mut window = open(name);
    press(&mut window, Key::B);
    press(&mut window, Key::M);
    window
}

/// Pulls a vertex in a pane, and holds it there.
fn pull(window: &mut Window, pane: Pane, number: usize) -> Pos2 {
    let snapshot = seen(window)[pane as usize];
    let point = [snapshot.positions[2 * number], snapshot.positions[2 * number + 1]];
    let from = in_pane(window, pane, point);
    window.hover_at(from);
    window.run_steps(1);
    button(window, from, true);
    window.run_steps(1);
    let to = from + vec2(40.0, -30.0);
    window.event(Event::PointerMoved(to));
    window.run_steps(2);
    to
}

#[test]
fn a_drag_in_either_pane_pulls_both_to_the_same_point() {
    for pane in Pane::BOTH {
        let mut window = compared("gingerbread");
        let to = pull(&mut window, pane, 100);
        let [a, b] = seen(&window).map(|seen| seen.pull.expect("an arrow in both"));
        assert_eq!((a.vertex, a.target), (b.vertex, b.target), "in {pane:?}");
        let [x, y, _] = a.target;
        assert!(in_pane(&window, pane, [x, y]).distance(to) < 0.5);
        draw(&window);
        button(&window, to, false);
        window.run_steps(2);
        assert!(seen(&window).iter().all(|seen| seen.pull.is_none()));
    }
}

#[test]
fn only_different_settings_give_a_difference() {
    let mut window = compared("gingerbread");
    pull(&mut window, Pane::B, 100);
    window.run_steps(30);
    let last = *panes(&window).record().last().unwrap();
    assert!(last.positions == Some(Apart::default()) && last.energy == 0.0 && last.time > 0.4, "{last:?}");
    type_number(&mut window, "Substeps", "40");
    window.run_steps(20);
    let [a, b] = seen(&window);
    assert_eq!([a.level.substeps.get(), b.level.substeps.get()], [100, 40], "the chosen pane's step alone");
    assert!((a.time - b.time).abs() < 1e-9 && a.time > 0.6, "{} {}", a.time, b.time);
    let last = *panes(&window).record().last().unwrap();
    assert!(last.positions.unwrap().metres > 0.0 && last.energy != 0.0, "{last:?}");
    assert!(window.query_by_label("Difference B − A").is_some());
}

#[test]
fn a_model_is_for_the_chosen_pane_and_both_start_over() {
    let mut window = compared("gingerbread");
    window.run_steps(10);
    press(&mut window, Key::Space);
    press(&mut window, Key::N);
    let models = |window: &Window| seen(window).map(|seen| seen.bodies[0].material.model().unwrap());
    assert_eq!(models(&window), [Model::Corotated, Model::NeoHookean]);
    assert_eq!(seen(&window).map(|seen| seen.time), [0.0, 0.0]);
    click(&mut window, "Edit pane A");
    click(&mut window, "St. Venant-Kirchhoff");
    assert_eq!(models(&window), [Model::StVenantKirchhoff, Model::NeoHookean]);
    press_with(&mut window, Modifiers::COMMAND, Key::Z);
    press_with(&mut window, Modifiers::COMMAND, Key::Z);
    assert_eq!(models(&window), [Model::Corotated; 2]);
    assert!(seen(&window)[0].time > 0.1 && seen(&window)[0].time == seen(&window)[1].time, "back to where both were");
}

#[test]
fn heads_say_how_each_pane_is_computed_and_choose_it() {
    let mut window = compared("gingerbread");
    assert_eq!(panes(&window).chosen(), Pane::B);
    let head = window.get_by_label_contains("A · ").rect();
    click_at(&mut window, head.left_center() + vec2(15.0, 0.0));
    assert_eq!(panes(&window).chosen(), Pane::A);
    type_number(&mut window, "Number of triangles", "500");
    window.run_steps(3);
    let [a, b] = seen(&window);
    assert!(a.triangles.len() < 800 && b.triangles.len() > 1500, "{} {}", a.triangles.len(), b.triangles.len());
    let words = format!("{} triangles", a.triangles.len());
    assert!(window.query_by_label_contains(&words).is_some());
    pull(&mut window, Pane::B, 100);
    window.run_steps(20);
    let [a, b] = seen(&window);
    assert!(a.pull.is_some() && b.pull.is_some_and(|pull| pull.vertex == 100));
    assert!(a.time == b.time && panes(&window).record().last().unwrap().positions.unwrap().metres > 0.0);
}

#[test]
fn pins_damping_and_effects_are_for_both() {
    let mut window = open("gingerbread");
    click(&mut window, "Compare");
    let at = in_pane(&window, Pane::B, vertex(&window, 100));
    click_at(&mut window, at);
    assert!(seen(&window).iter().all(|seen| seen.pins.contains(&100)));
    press(&mut window, Key::D);
    assert!(seen(&window).iter().all(|seen| seen.damping));
    slide(&mut window, "Poisson's ratio", 0.2);
    assert!(seen(&window).iter().all(|seen| seen.level.bodies[0].material.poisson().get() == 0.2));
    press(&mut window, Key::R);
    assert!(seen(&window).iter().all(|seen| seen.pins.is_empty()));
}

#[test]
fn closing_keeps_a_and_keep_b_keeps_b() {
    for (label, substeps) in [("Compare", 100), ("Keep A", 100), ("Keep B", 40)] {
        let mut window = compared("gingerbread");
        type_number(&mut window, "Substeps", "40");
        pull(&mut window, if substeps == 40 { Pane::A } else { Pane::B }, 100);
        window.run_steps(10);
        press(&mut window, Key::Space);
        let kept = seen(&window)[usize::from(substeps == 40)].clone();
        click(&mut window, label);
        assert!(window.state().comparison().is_none(), "{label}");
        let now = window.state().snapshot();
        assert_eq!((&now.positions, now.level.substeps.get()), (&kept.positions, substeps), "{label}");
        assert!(stage(&window).width() > 600.0);
        assert_eq!(now.pull, None, "{label}: a hand in the pane that is gone lets go");
        press(&mut window, Key::Space);
        window.run_steps(5);
        assert!(window.state().snapshot().time > kept.time, "{label}: it goes on");
    }
}

#[test]
fn a_level_opens_in_both_and_undo_brings_both_back() {
    let mut window = compared("gingerbread");
    type_number(&mut window, "Substeps", "40");
    let before = seen(&window).map(|seen| seen.level.clone());
    choose(&mut window, "Hammock");
    click(&mut window, "Discard");
    let [a, b] = seen(&window);
    assert!(a.level == b.level && a.level.name == "Hammock" && a.mode == Mode::Edit);
    press_with(&mut window, Modifiers::COMMAND, Key::Z);
    assert_eq!(seen(&window).map(|seen| seen.level.clone()), before);
}

#[test]
fn a_fault_in_b_is_told_with_its_pane_and_mended_there() {
    let mut wild = level("gingerbread_pulled");
    wild.guard = gingerbread::level::Toggle::Off;
    let mut window = open_level(wild, 1280.0, 800.0);
    press(&mut window, Key::B);
    let substeps = seen(&window)[0].level.substeps;
    type_number(&mut window, "Substeps", "2");
    click(&mut window, "Edit pane A");
    press(&mut window, Key::T);
    for _ in 0..300 {
        if seen(&window)[1].fault.is_some() {
            break;
        }
        window.run_steps(1);
    }
    window.run_steps(2);
    assert!(seen(&window)[0].fault.is_none() && !seen(&window)[0].running);
    assert!(window.query_by_label("Time stopped in B").is_some());
    click(&mut window, "Edit pane A");
    assert!(window.query_by_label("Time stopped in B").is_some(), "whichever pane the panels are about");
    click(&mut window, "Edit B");
    window.get_by_label_contains("Shorter steps (2 × ").click();
    window.run_steps(3);
    let [a, b] = seen(&window);
    assert!(a.level.substeps == substeps && b.level.substeps.get() > 2 && b.fault.is_none());
}

#[test]
fn a_paused_comparison_sleeps() {
    let mut window = open("gingerbread");
    press(&mut window, Key::B);
    window.run_steps(60);
    assert!(window.try_run().is_ok(), "nothing moves, so nothing asks to be drawn again");
}

/// Every widget has a name.
#[test]
fn every_level_can_be_compared_in_every_size() {
    for (file, text) in levels::BUILT_IN {
        let level = files::parse(text, file).unwrap();
        let mut window = open_level(level, 1280.0, 800.0);
        press(&mut window, Key::B);
        window.get_by_label("Single step").click();
        for size in [vec2(1280.0, 800.0), vec2(600.0, 600.0), vec2(420.0, 800.0)] {
            window.set_size(size);
            window.run_steps(3);
            window.check_accessibility();
            draw(&window);
            let [a, b] = Pane::BOTH.map(|pane| stage_of(&window, pane));
            assert!(a.intersect(b).area() <= 0.0 && a.area() > 20_000.0, "{file} {size:?}: {a:?} {b:?}");
            assert_eq!(a.size(), b.size(), "{file} {size:?}");
        }
        assert_eq!(seen(&window).map(|seen| seen.steps), [1, 1], "{file}");
    }
}

#[test]
fn a_scheme_is_for_the_chosen_pane() {
    let mut window = open("circle");
    press(&mut window, Key::B);
    window.get_all_by_role(Role::ComboBox).next_back().expect("a menu of schemes").click();
    window.run_steps(3);
    click(&mut window, "Runge-Kutta 4");
    press(&mut window, Key::Space);
    window.run_steps(60);
    let [a, b] = seen(&window);
    assert_ne!(a.level.integrator, b.level.integrator);
    assert!(a.time == b.time && a.toy != b.toy);
}
