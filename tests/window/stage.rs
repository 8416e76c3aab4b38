//! The stage: pins, pulling, and room for both in small windows.

use crate::harness::*;
use eframe::egui::{Event, Key, epaint::Primitive, text_selection::LabelSelectionState, vec2};
use egui_kittest::kittest::Queryable as _;
use gingerbread::command::Mode;

#[test]
fn a_click_pins_the_nearest_vertex_and_another_frees_it() {
    let mut window = open("gingerbread");
    let before = window.state().snapshot().pins.len();
    let at = on_screen(&window, vertex(&window, 100)) + vec2(1.0, -1.0);
    click_at(&mut window, at);
    assert!(window.state().snapshot().pins.contains(&100), "{:?}", window.state().snapshot().pins);
    click_at(&mut window, at);
    assert_eq!(window.state().snapshot().pins.len(), before);
}

#[test]
fn a_drag_pulls_the_picked_vertex_until_release() {
    for (key, mode) in [(Key::M, Mode::Simulate), (Key::T, Mode::Collide)] {
        let mut window = open("gingerbread");
        press(&mut window, key);
        assert_eq!(window.state().snapshot().mode, mode);
        press(&mut window, Key::Space);
        let start = vertex(&window, 100);
        let to = pull(&mut window, 100, vec2(60.0, -40.0));
        press(&mut window, Key::Space);
        window.run_steps(20);
        let pull = window.state().snapshot().pull.expect("a pull");
        assert_eq!(pull.vertex, 100);
        assert!(vertex(&window, 100)[0] > start[0] + 0.005, "{mode:?}: the vertex must follow");
        button(&window, to, false);
        window.run_steps(2);
        assert_eq!(window.state().snapshot().pull, None);
    }
}

#[test]
fn a_pull_goes_on_when_another_model_makes_the_body_start_over() {
    let mut window = open("gingerbread");
    press(&mut window, Key::M);
    let to = pull(&mut window, 100, vec2(60.0, -40.0));
    let before = window.state().snapshot().generation;
    press(&mut window, Key::V);
    window.run_steps(5);
    assert_ne!(window.state().snapshot().generation, before);
    let pull = window.state().snapshot().pull.expect("a pull");
    assert!(pull.vertex == 100 && pull.force > 0.0, "{pull:?}");
    button(&window, to, false);
    window.run_steps(2);
    assert_eq!(window.state().snapshot().pull, None);
}

/// Appended to its mesh they would have it moved to a larger place, every frame.
#[test]
fn what_lies_over_a_body_is_painted_as_a_mesh_of_its_own() {
    let mut window = open("gingerbread");
    let at = on_screen(&window, vertex(&window, 100));
    window.hover_at(at);
    window.run_steps(30);
    let painted = window.ctx.tessellate(window.output().shapes.clone(), 1.0);
    let stage = stage(&window);
    let on_stage = painted.iter().filter(|painted| (painted.clip_rect.center() - stage.center()).length() < 3.0);
    let corners = |primitive: &Primitive| match primitive {
        Primitive::Mesh(mesh) => mesh.vertices.len(),
        Primitive::Callback(_) => 0,
    };
    let corners: Vec<_> = on_stage.map(|painted| corners(&painted.primitive)).collect();
    let (place, body) = corners.iter().enumerate().max_by_key(|(_, corners)| **corners).unwrap();
    let over = &corners[place + 1..];
    assert!(*body > 1000 && !over.is_empty() && over.iter().all(|over| *over < body / 4), "{corners:?}");
}

#[test]
fn a_paused_window_sleeps() {
    let mut window = open("gingerbread");
    window.run_steps(60);
    assert!(window.try_run().is_ok(), "nothing moves, so nothing asks to be drawn again");
}

/// The panels fold away.
#[test]
fn the_stage_stays_usable_at_600_by_600() {
    let mut window = open_level(level("gingerbread"), 600.0, 600.0);
    let stage_size = stage(&window).size();
    assert!(stage_size.x >= 590.0 && stage_size.y >= 440.0, "{stage_size:?}");
    let at = on_screen(&window, vertex(&window, 100));
    click_at(&mut window, at);
    assert!(window.state().snapshot().pins.contains(&100));

    assert!(window.query_by_label("Plane strain").is_none());
    click(&mut window, "Body panel");
    slide(&mut window, "Poisson's ratio", 0.25);
    assert_eq!(window.state().snapshot().level.bodies[0].material.poisson().get(), 0.25);
    assert_eq!(stage(&window).size(), stage_size, "the panel lies over the stage");
    click(&mut window, "Cost panel");
    assert!(window.query_by_label("Plane strain").is_none() && window.query_by_label("Wireframe").is_some());
    click(&mut window, "Cost panel");
    assert!(window.query_by_label("Wireframe").is_none());
    for side in [600.0, 500.0, 400.0] {
        window.set_size(vec2(side, side));
        window.run_steps(4);
        let roof = stage(&window).top();
        for label in ["Level", "Edit", "Simulate", "Collide", "Run", "Single step", "Undo", "Redo", "Keys"] {
            let rect = window.get_by_label(label).rect();
            let inside = rect.left() >= 0.0 && rect.right() <= side && rect.top() >= 0.0 && rect.bottom() <= roof;
            assert!(inside, "{label} is cut off at {side}: {rect:?}");
        }
    }
}

#[test]
fn a_drag_in_edit_mode_is_answered_and_a_click_still_pins() {
    let mut window = open("gingerbread");
    let told = |window: &Window| window.query_by_label_contains("press Space or M to let time run").is_some();
    let to = pull(&mut window, 100, vec2(60.0, -40.0));
    assert!(told(&window), "while it is dragged");
    button(&window, to, false);
    window.run_steps(30);
    assert!(told(&window) && window.state().snapshot().pins.is_empty());
    window.run_steps(360);
    assert!(!told(&window), "it has been read");
    let at = on_screen(&window, vertex(&window, 100));
    click_at(&mut window, at);
    assert!(!told(&window) && window.state().snapshot().pins.contains(&100));
    let to = pull(&mut window, 100, vec2(60.0, -40.0));
    button(&window, to, false);
    window.run_steps(1);
    press(&mut window, Key::M);
    assert!(!told(&window), "time runs");
}

#[test]
fn a_drag_over_a_panel_selects_no_text() {
    let mut window = open("gingerbread");
    let selected = |window: &Window| window.ctx.plugin::<LabelSelectionState>().lock().has_selection();
    let from = window.get_by_label("Simulated time").rect().left_center();
    button(&window, from, true);
    window.run_steps(1);
    for step in 1..10 {
        window.event(Event::PointerMoved(from + vec2(12.0 * step as f32, 4.0 * step as f32)));
        window.run_steps(1);
    }
    assert!(!selected(&window));
    button(&window, from + vec2(120.0, 40.0), false);
    window.run_steps(1);
    // What is worth copying can be selected.
    window.state_mut().open(std::path::Path::new("no-such-level.ron"));
    window.run_steps(3);
    let text = window.get_by_label_contains("no-such-level.ron").rect();
    button(&window, text.left_top() + vec2(2.0, 6.0), true);
    window.run_steps(1);
    window.event(Event::PointerMoved(text.right_bottom() - vec2(2.0, 6.0)));
    window.run_steps(2);
    assert!(selected(&window));
}
