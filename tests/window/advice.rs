//! Remedies: each is offered for its own cause, and pressing its button improves the figure that it promises.

use crate::harness::*;
use eframe::egui::Key;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use gingerbread::effects::EffectKind;
use gingerbread::files;
use gingerbread::integrators::IntegratorKind;
use gingerbread::level::{Level, Substeps, Toggle};
use gingerbread::materials::Model;
use gingerbread::quantity::Factor;
use gingerbread::stability::critical_step;

/// The text, on a button or beside one, that contains some words.
fn offered(window: &Window, words: &str) -> Option<String> {
    let found = window.query_all_by_label_contains(words).next()?;
    let node = found.accesskit_node();
    node.label().or_else(|| node.value())
}

fn take(window: &mut Window, words: &str) {
    let label = offered(window, words).unwrap_or_else(|| panic!("{words} is not offered"));
    click(window, &label);
}

fn substeps(window: &Window) -> u32 {
    window.state().snapshot().level.substeps.get()
}

/// The longest stable step at the start of the level that is shown [s].
fn limit(window: &Window) -> f64 {
    let simulation = window.state().sandbox().simulation();
    critical_step(simulation.scene(), &simulation.scene().start, None).unwrap()
}

/// Runs until something is so, for at most so many frames; returns whether it is.
fn until(window: &mut Window, frames: usize, so: impl Fn(&Window) -> bool) -> bool {
    for _ in 0..frames {
        if so(window) {
            window.run_steps(12);
            return true;
        }
        window.run_steps(1);
    }
    false
}

fn is_inverted(window: &Window) -> bool {
    window.state().snapshot().inverted > 0
}

fn has_fault(window: &Window) -> bool {
    window.state().snapshot().fault.is_some()
}

/// The house with steps far above the stability limit.
fn too_long(guard: Toggle) -> Level {
    let mut level = level("gingerbread_house");
    (level.substeps, level.guard) = (Substeps::new(2).unwrap(), guard);
    level
}

/// A block that starts pressed to a fraction of its height.
fn pressed(model: &str) -> Level {
    let text = format!(
        "(name: \"pressed\", substeps: 100, bodies: [(name: \"block\", mesh: Rectangle(width: 0.3, height: 0.3, columns: 8, rows: 8, corner: (0.35, 0.3)),
          mass: Density(100), stretch: (1, 0.2), material: (model: {model}, young: 10000, poisson: 0.3))])"
    );
    files::parse(&text, "pressed.ron").unwrap()
}

#[test]
fn shorter_steps_mend_a_step_above_the_limit() {
    let mut window = open_level(too_long(Toggle::Off), 1280.0, 800.0);
    press(&mut window, Key::T);
    assert!(until(&mut window, 60, |window| is_inverted(window) || has_fault(window)), "it must go wrong");
    assert!(offered(&window, "Longer steps").is_none() && offered(&window, "stable neo-Hookean").is_none());
    take(&mut window, "Shorter steps (2 × ");
    assert!(substeps(&window) > 2);
    let step = window.state().snapshot().level.substeps.step();
    assert!(step <= limit(&window), "a step of {step} s is above the limit of {} s", limit(&window));
    assert!(!until(&mut window, 60, |window| is_inverted(window) || has_fault(window)));
}

#[test]
fn the_guard_mends_a_step_above_the_limit_too() {
    let mut window = open_level(too_long(Toggle::Off), 1280.0, 800.0);
    press(&mut window, Key::T);
    assert!(until(&mut window, 60, |window| is_inverted(window) || has_fault(window)));
    take(&mut window, "Switch the guard on");
    assert_eq!((window.state().snapshot().level.guard, substeps(&window)), (Toggle::On, 2));
    assert!(!until(&mut window, 30, |window| window.state().snapshot().exploded.is_some() || has_fault(window)));
}

#[test]
fn a_weak_model_is_mended_by_another_one_or_by_compression() {
    for (words, mended) in
        [("Use stable neo-Hookean", Model::StableNeoHookean), ("compression guard", Model::StVenantKirchhoff)]
    {
        let mut window = open_level(pressed("StVenantKirchhoff"), 1280.0, 800.0);
        press(&mut window, Key::M);
        assert!(until(&mut window, 60, is_inverted), "St. Venant-Kirchhoff gives way");
        let most = window.state().snapshot().inverted;
        assert!(window.state().snapshot().level.substeps.step() < 0.2 * limit(&window), "the step is not the cause");
        assert!(offered(&window, "does not resist inversion").is_some());
        assert!(offered(&window, "Shorter steps").is_none() && offered(&window, "Longer steps").is_none());
        take(&mut window, words);
        let now = window.state().snapshot();
        assert_eq!((now.bodies[0].material.model().unwrap(), substeps(&window)), (mended, 100));
        let compression = now.level.effects.iter().any(|listed| matches!(listed.effect, EffectKind::Compression(_)));
        assert_eq!(compression, mended == Model::StVenantKirchhoff);
        let mut worst = 0;
        for _ in 0..60 {
            window.run_steps(1);
            worst = worst.max(window.state().snapshot().inverted);
        }
        assert!(worst < most, "{words}: {worst} triangles are inside out, and were {most} before");
    }
}

#[test]
fn a_scheme_that_is_stable_at_no_step_is_replaced() {
    let mut level = level("gingerbread_house");
    level.guard = Toggle::Off;
    level.integrator = IntegratorKind::all().into_iter().find(|kind| kind.name() == "ForwardEuler").unwrap();
    for listed in &mut level.effects {
        if listed.effect.kind().is_damping() {
            listed.switch = gingerbread::level::Switch::Off;
        }
    }
    let mut window = open_level(level, 1280.0, 800.0);
    press(&mut window, Key::T);
    assert!(until(&mut window, 600, |window| is_inverted(window) || has_fault(window)));
    assert!(offered(&window, "Shorter steps").is_none(), "no step is short enough");
    take(&mut window, "Use symplectic Euler");
    assert_eq!(window.state().snapshot().level.integrator.name(), "SymplecticEuler");
    assert!(!until(&mut window, 60, |window| is_inverted(window) || has_fault(window)));
}

#[test]
fn the_caution_of_a_stretch_test_ends_with_the_model_it_offers() {
    let mut level = level("stretch_test");
    // Below 1/sqrt(3) the stress of St. Venant-Kirchhoff falls again.
    level.test.as_mut().unwrap().compressed = Factor::new(0.5).unwrap();
    let mut window = open_level(level, 1280.0, 800.0);
    press(&mut window, Key::V);
    press(&mut window, Key::ArrowDown);
    let strip_warning = |window: &Window| window.state().snapshot().bodies[0].strip_warning.clone();
    assert!(strip_warning(&window).is_some(), "St. Venant-Kirchhoff has no answer here");
    take(&mut window, "Use neo-Hookean");
    press(&mut window, Key::ArrowDown);
    assert_eq!(strip_warning(&window), None);
}

#[test]
fn what_begins_inverted_is_not_sent_back_to_that_start() {
    let mut level = level("gingerbread");
    level.bodies[0].start =
        gingerbread::level::StartShape::Mirrored { seed: 1, noise: gingerbread::quantity::Noise::new(0.001).unwrap() };
    let window = open_level(level, 1280.0, 800.0);
    assert!(is_inverted(&window) && offered(&window, "Untangle").is_some());
    let status = window.get_all_by_label("Start over").count();
    assert_eq!(status, 1, "only the button in the strip, which promises nothing");
}

#[test]
fn an_exploded_body_is_told_and_put_back() {
    let mut wild = level("gingerbread");
    wild.guard = Toggle::Off;
    let mut window = open_level(wild, 1280.0, 800.0);
    type_number(&mut window, "Substeps", "2");
    press(&mut window, Key::M);
    let to = pull(&mut window, 100, eframe::egui::vec2(300.0, -200.0));
    assert!(until(&mut window, 60, |window| window.state().snapshot().exploded.is_some()));
    button(&window, to, false);
    window.run_steps(90);
    let now = window.state().snapshot();
    assert!(
        now.asleep == 0 && window.query_by_label("everything sleeps").is_none(),
        "what has exploded is not at rest"
    );
    assert!(window.query_by_label_contains("has exploded: the step of").is_some());
    take(&mut window, "Shorter steps (2 × ");
    assert_eq!(window.state().snapshot().exploded, None);
}
