//! The gallery of hard cases in the window.

use crate::harness::*;
use eframe::egui::Key;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use gingerbread::{
    command::Mode,
    hard::Case,
    integrators::{Class, IntegratorKind},
    level::StartShape,
    materials::{Model, TypedEnergy},
};

fn open_gallery(window: &mut Window) {
    click(window, "Level");
    click(window, "Hard cases…");
}

/// A button of a case, which may be farther down the list than the window shows.
fn ask(window: &mut Window, label: &str) {
    window.get_by_label(label).click_accesskit();
    window.run_steps(3);
}

/// The gallery says which runs are not stable, and why, and which are far from their reference.
#[test]
fn a_case_runs_with_every_material_beside_the_scene() {
    let mut window = in_mode("chain", Mode::Simulate);
    let time = window.state().snapshot().time;
    open_gallery(&mut window);
    assert!(window.query_by_label("Stretched to twice its height: not run yet").is_some());
    ask(&mut window, "Run Stretched to twice its height");
    wait_until_gone(&mut window, "Cancel");
    draw(&window);
    assert!(window.query_by_label_contains("5 of 6 stable, ").is_some());
    assert!(window.query_by_label_contains("Known not to be stable with St. Venant-Kirchhoff. Its energy").is_some());
    assert!(
        window
            .query_by_label_contains("Stretched to twice its height: known not to be stable, for a stated reason")
            .is_some()
    );
    let told = window.get_by_label_contains("Corotated, Implicit Euler: ").accesskit_node().label().unwrap_or_default();
    assert!(told.contains("strain ") && told.contains(" % off in "), "{told}");
    let all = format!("5 of {} stable (5 more than 10 % off), 1 known not to be", 6 * Case::names().count());
    assert!(window.query_by_label_contains(&all).is_some());
    assert!(window.state().snapshot().time > time, "time goes on");
}

/// Chooses an integrator of the gallery. The list may still be open from the choice before.
fn choose(window: &mut Window, title: &str) {
    if window.query_all_by_label(title).next().is_none() {
        window.get_by_label("Integrators of hard cases").click_accesskit();
        window.run_steps(3);
    }
    window.get_all_by_label(title).last().unwrap().click_accesskit();
    window.run_steps(3);
}

/// Materials and integrator are chosen.
#[test]
fn results_stay_known_when_the_choice_changes() {
    let mut window = open("circle");
    open_gallery(&mut window);
    click(&mut window, "Neo-Hookean");
    ask(&mut window, "Run Young's modulus 1 GPa");
    wait_until_gone(&mut window, "Cancel");
    assert!(window.query_by_label_contains("strain < 0.0001 %; ").is_some(), "the number that decided");
    let all = format!("1 of {} stable", Case::names().count());
    assert!(window.query_by_label_contains(&all).is_some());
    choose(&mut window, "Symplectic Euler");
    assert!(window.query_by_label_contains("strain < 0.0001 %; ").is_none(), "that was another integrator");
    ask(&mut window, "Run Young's modulus 1 GPa");
    wait_until_gone(&mut window, "Cancel");
    choose(&mut window, "All integrators");
    assert!(window.query_by_label_contains("2 of 2 stable, ").is_some());
    // The undamped twin is another run.
    click(&mut window, "Undamped");
    assert!(window.query_by_label_contains("2 of 2 stable, ").is_none());
}

/// The typed energy of the chosen body is a material of the gallery.
#[test]
fn cases_run_with_the_typed_energy_of_the_scene() {
    let mut own = level("gingerbread");
    own.bodies[0].energy = Some(TypedEnergy::new("mu/2*(I1 - 2 - 2*log(J)) + lambda*(J - 1)^2/2", Vec::new()).unwrap());
    let mut window = open_level(own, 1280.0, 800.0);
    open_gallery(&mut window);
    click(&mut window, "Typed energy of the cases");
    ask(&mut window, "Run Stretched to twice its height");
    wait_until_gone(&mut window, "Cancel");
    draw(&window);
    let stable =
        |window: &Window| window.query_by_label_contains(&format!("1 of {} stable", Case::names().count())).is_some();
    assert!(stable(&window));
    window.get_all_by_label("Neo-Hookean").last().unwrap().click();
    window.run_steps(3);
    assert!(!stable(&window), "that was another material");
    click(&mut window, "Typed energy of the cases");
    ask(&mut window, "Open Stretched to twice its height");
    let opened = &window.state().snapshot().level.bodies[0];
    assert!(opened.energy.as_ref().is_some_and(|energy| energy.text().contains("lambda*(J - 1)^2/2")));
}

#[test]
fn all_cases_can_be_cancelled_and_one_watched() {
    let mut window = open("gingerbread");
    open_gallery(&mut window);
    click(&mut window, "Run all");
    assert!(window.query_by_label("Run all").is_none());
    click(&mut window, "Cancel");
    window.run_steps(5);
    assert!(window.query_by_label("Run all").is_some());
    window.get_all_by_label("Fixed corotated").last().unwrap().click();
    window.run_steps(3);
    ask(&mut window, "Open Mirror image");
    let level = &window.state().snapshot().level;
    assert!(matches!(level.bodies[0].start, StartShape::Mirrored { .. }));
    assert_eq!(level.bodies[0].material.model(), Model::FixedCorotated);
    assert!(matches!(level.integrator, IntegratorKind::ImplicitEuler(_)) && level.substeps.get() == 1);
    window.run_steps(10);
    assert!(window.state().snapshot().time > 0.0, "it runs at once");
    assert!(window.query_by_label("Run all").is_none(), "the gallery makes way");
    open_gallery(&mut window);
    choose(&mut window, "Symplectic Euler");
    ask(&mut window, "Open Stretched to twice its height");
    let level = &window.state().snapshot().level;
    assert!(level.integrator.kind().class() == Class::Explicit && level.substeps.get() > 1);
    press(&mut window, Key::Space);
}

/// Every widget has a name.
#[test]
fn the_gallery_fits_into_a_small_window() {
    for (width, height) in [(1280.0, 800.0), (420.0, 480.0)] {
        let mut window = open_level(level("circle"), width, height);
        open_gallery(&mut window);
        ask(&mut window, "Run Dragged by a thousand windows");
        wait_until_gone(&mut window, "Cancel");
        window.check_accessibility();
        draw(&window);
        for label in ["Hard cases as CSV", "Run all", "Open Wedged into a corner"] {
            let rect = window.get_by_label(label).rect();
            assert!(rect.left() >= 0.0 && rect.right() < width && rect.top() >= 0.0, "{label} at {rect:?}");
        }
    }
}
