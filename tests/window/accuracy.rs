//! What the window says about accuracy and its price.

use crate::harness::*;
use eframe::egui::{Key, Modifiers, Role};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use gingerbread::command::Mode;
use gingerbread::files;
use gingerbread::integrators::IntegratorKind;
use gingerbread::level::{Substeps, Toggle};
use gingerbread::stability::critical_step;

/// It warns of a longer one.
#[test]
fn the_gauge_tells_the_longest_stable_step() {
    let mut long = level("gingerbread");
    assert!(open_level(long.clone(), 1280.0, 800.0).query_by_label_contains("Stable up to").is_some());
    long.substeps = Substeps::new(1).unwrap();
    for (guard, words) in [(Toggle::On, "the guard divides it"), (Toggle::Off, "so the run will be unstable")] {
        long.guard = guard;
        let window = open_level(long.clone(), 1280.0, 800.0);
        assert!(window.query_by_label_contains(words).is_some());
    }
    long.integrator = IntegratorKind::all().into_iter().find(|kind| kind.name() == "ImplicitEuler").unwrap();
    let window = open_level(long, 1280.0, 800.0);
    assert!(window.query_by_label_contains("Stable for every step length").is_some());
}

#[test]
fn a_still_window_finds_the_stability_limit_and_rests() {
    let large = "(name: \"large\", bodies: [(name: \"man\", mesh: Gingerbread(resolution: 12000), mass: Total(25),
          material: (model: Corotated, young: 30000, poisson: 0.3))])";
    let large = files::parse(large, "large.ron").unwrap();
    for level in [level("gingerbread"), level("jelly_disk"), level("hanging_net"), large] {
        let name = level.name.clone();
        let mut window = open_level(level, 1280.0, 800.0);
        let frames = (0..2000).take_while(|_| {
            let asks = pause(&window).is_zero();
            window.run_steps(usize::from(asks));
            asks
        });
        assert!(frames.count() < 2000, "{name} does not come to rest");
        let simulation = window.state().sandbox().simulation();
        let limit = critical_step(simulation.scene(), simulation.state(), None).unwrap();
        let node = window.get_by_label_contains("Stable up to");
        let words = node.accesskit_node().value().or(node.accesskit_node().label()).unwrap();
        let (number, unit) = words.trim_start_matches("Stable up to ").split_once(' ').unwrap();
        let second = if unit.starts_with("ms") { 1e3 } else { 1e6 };
        let shown = number.parse::<f64>().unwrap() / second;
        // Three digits are shown.
        assert!((shown - limit).abs() < 6e-3 * limit, "{name}: {words} Not {limit} s.");
    }
}

#[test]
fn choosing_another_scheme_keeps_the_state() {
    let mut window = in_mode("cantilever", Mode::Simulate);
    press(&mut window, Key::Space);
    let before = window.state().snapshot().positions.clone();
    let mut schemes = window.get_all_by_role(Role::ComboBox).filter(|node| {
        node.accesskit_node().value().is_some_and(|value| value.contains("Symplectic"))
            || node.accesskit_node().label().is_some_and(|label| label.contains("Symplectic"))
    });
    schemes.next_back().expect("a menu of schemes").click();
    drop(schemes);
    window.run_steps(3);
    click(&mut window, "Runge-Kutta 4");
    let now = window.state().snapshot();
    assert_eq!((now.level.integrator.name(), &now.positions), ("RungeKutta4", &before));
    press(&mut window, Key::Space);
    window.run_steps(5);
    assert_ne!(window.state().snapshot().positions, before, "time goes on with the new scheme");
}

#[test]
fn the_diagram_waits_for_a_click_and_says_what_it_will_do() {
    let mut window = open("gingerbread_pulled");
    assert!(window.query_by_label("Measure").is_none());
    click(&mut window, "Work-precision diagram");
    assert!(window.query_by_label_contains("each run is a point").is_some());
    assert!(window.query_by_label("Measure").is_some());
    click(&mut window, "Work-precision diagram");
    window.run_steps(30);
    assert!(window.query_by_label("Measure").is_none(), "the same button closes it");
}

/// The dial uses what it finds, tells what that costs, and shows the error beside it.
#[test]
fn a_wanted_error_sets_scheme_and_step_and_is_taken_back() {
    let mut window = in_mode("hanging_net", Mode::Simulate);
    let stepping = |window: &Window| {
        let level = &window.state().sandbox().document().level;
        (level.integrator.clone(), level.substeps)
    };
    let before = stepping(&window);
    click_in_panel(&mut window, "Set the wanted error");
    wait_until_gone(&mut window, "Cancel the search");
    window.run_steps(3);
    assert_ne!(stepping(&window), before);
    let told = |window: &Window, words: &str| window.query_all_by_label_contains(words).next().is_some();
    assert!(told(&window, "1.00 % over 1 s: ") && told(&window, "of it for the last digit"));
    assert!(told(&window, "Error now"), "it is measured from now on");
    press_with(&mut window, Modifiers::COMMAND, Key::Z);
    assert_eq!(stepping(&window), before);
    assert!(told(&window, "which is not used now"));
}

#[test]
fn a_wanted_error_of_what_does_not_move_sets_nothing() {
    let mut window = open("gingerbread");
    let before = window.state().sandbox().document().clone();
    click_in_panel(&mut window, "Set the wanted error");
    wait_until_gone(&mut window, "Cancel the search");
    window.run_steps(3);
    assert!(window.query_all_by_label_contains("Nothing moves here").next().is_some());
    assert_eq!(*window.state().sandbox().document(), before);
}

/// The search ends after another level was opened, which keeps its own scheme.
#[test]
fn what_was_found_for_another_scene_is_not_used() {
    let mut window = open("gingerbread_pulled");
    click_in_panel(&mut window, "Set the wanted error");
    let other = level("cantilever");
    assert!(window.query_by_label("Cancel the search").is_some(), "it searches");
    window.state_mut().open(std::path::Path::new("cantilever"));
    wait_until_gone(&mut window, "Cancel the search");
    window.run_steps(3);
    let now = &window.state().sandbox().document().level;
    assert_eq!((&now.name, &now.integrator, now.substeps), (&other.name, &other.integrator, other.substeps));
}
