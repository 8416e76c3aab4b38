//! The window as an instrument: zoom, slow motion, probes and their plots.

use crate::{arrays::array_of, folder::Folder, harness::*};
use eframe::egui::{
    Event, Key, Modifiers, MouseWheelSource, MouseWheelUnit, PointerButton, Role, TouchPhase, epaint::Primitive, vec2,
};
use egui_kittest::kittest::Queryable as _;
use gingerbread::command::Mode;

/// Turns the wheel over a point of the stage.
fn wheel(window: &mut Window, at: eframe::egui::Pos2, by: f32) {
    window.hover_at(at);
    window.event(Event::MouseWheel {
        unit: MouseWheelUnit::Point,
        delta: vec2(0.0, by),
        phase: TouchPhase::Move,
        source: MouseWheelSource::Unknown,
        modifiers: Modifiers::NONE,
    });
    window.run_steps(30);
}

#[test]
fn the_wheel_zooms_about_the_pointer_and_a_click_still_pins_what_is_seen() {
    let mut window = open("gingerbread");
    let place = vertex(&window, 7);
    let at = on_screen(&window, place);
    let width = |window: &Window| on_screen(window, [1.0, 0.0]).x - on_screen(window, [0.0, 0.0]).x;
    let whole = width(&window);
    wheel(&mut window, at, 600.0);
    assert!(width(&window) > 2.0 * whole, "{} for {whole}", width(&window));
    assert!(on_screen(&window, place).distance(at) < 0.5, "what is under the pointer stays there");
    click_at(&mut window, at);
    assert_eq!(*window.state().snapshot().pins, [7]);
    // A drag of the right button moves the view, and pins nothing.
    let to = at + vec2(60.0, -40.0);
    for (pos, pressed) in [(at, true), (to, false)] {
        window.event(Event::PointerMoved(pos));
        let button = PointerButton::Secondary;
        window.event(Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE });
        window.run_steps(2);
    }
    assert!(on_screen(&window, place).distance(to) < 0.5, "{:?}", on_screen(&window, place));
    assert_eq!(*window.state().snapshot().pins, [7]);
    click(&mut window, "See all");
    assert_eq!(width(&window), whole);
    click(&mut window, "Zoom in");
    assert!(width(&window) > 1.2 * whole);
}

#[test]
fn another_level_is_seen_as_a_whole() {
    let mut window = open("gingerbread");
    let whole = on_screen(&window, [1.0, 1.0]);
    click(&mut window, "Zoom in");
    assert_ne!(on_screen(&window, [1.0, 1.0]), whole);
    choose(&mut window, "Gingerbread house");
    assert_eq!(on_screen(&window, [1.0, 1.0]), whole);
}

#[test]
fn slow_motion_and_time_lapse_change_the_speed_and_not_the_motion() {
    let mut after = Vec::new();
    for (key, presses, factor) in [(Key::PageDown, 2, 0.1), (Key::PageUp, 0, 1.0), (Key::PageUp, 2, 10.0)] {
        // A toy never sleeps.
        let mut window = open("circle");
        for _ in 0..presses {
            press(&mut window, key);
        }
        press(&mut window, Key::M);
        let before = window.state().snapshot().time;
        window.run_steps(30);
        let passed = window.state().snapshot().time - before;
        assert!((passed / (0.5 * factor) - 1.0).abs() < 0.1, "{passed} s in half a second at {factor}");
        // The same steps, however long they took.
        let steps = window.state().snapshot().steps;
        press(&mut window, Key::Space);
        after.push((steps, window.state().sandbox().step_length()));
    }
    assert!(after.windows(2).all(|pair| pair[0].0 < pair[1].0 && pair[0].1 == pair[1].1), "{after:?}");
}

#[test]
fn a_comma_takes_a_frame_and_a_dot_one_step() {
    let mut window = in_mode("gingerbread", Mode::Simulate);
    press(&mut window, Key::Space);
    let steps = |window: &Window| window.state().snapshot().steps;
    let before = steps(&window);
    press(&mut window, Key::Comma);
    let frame = window.state().sandbox().simulation().scene().steps_per_frame();
    assert!(frame > 1);
    assert_eq!(steps(&window), before + frame);
    press(&mut window, Key::Period);
    assert_eq!(steps(&window), before + frame + 1);
    // Both panes of a comparison take the same time.
    press(&mut window, Key::B);
    press(&mut window, Key::Comma);
    let b = window.state().comparison().unwrap().snapshot().time;
    assert_eq!((steps(&window), b), (before + 2 * frame + 1, window.state().snapshot().time));
}

#[test]
fn p_probes_what_is_under_the_pointer() {
    let mut window = open("gingerbread");
    let at = on_screen(&window, vertex(&window, 7));
    window.hover_at(at);
    window.run_steps(2);
    press(&mut window, Key::P);
    assert!(window.query_by_label_contains("Remove: Vertex ").is_some(), "a vertex is probed");
    let corners = window.state().snapshot().triangles[40].map(|corner| vertex(&window, corner as usize));
    let middle = [0, 1].map(|axis| corners.iter().map(|corner| corner[axis]).sum::<f64>() / 3.0);
    let middle = on_screen(&window, middle);
    window.hover_at(middle);
    window.run_steps(2);
    press(&mut window, Key::P);
    assert!(window.query_by_label_contains("Remove: Triangle ").is_some(), "a triangle is probed");
    assert!(window.state().snapshot().pins.is_empty());
    let removals = window.query_all_by_label_contains("Remove: ").count();
    assert_eq!(removals, 2);
    choose(&mut window, "Cantilever");
    assert_eq!(window.query_all_by_label_contains("Remove: ").count(), 0, "another level has other numbers");
}

#[test]
fn a_probe_is_added_with_the_mouse_alone_and_drawn_over_time() {
    let mut window = open("gingerbread");
    click_in_panel(&mut window, "Add a probe");
    click(&mut window, "On the stage…");
    assert!(window.query_by_label("Cancel the probe").is_some());
    let at = on_screen(&window, vertex(&window, 7));
    click_at(&mut window, at);
    assert!(window.state().snapshot().pins.is_empty(), "the click probes and pins nothing");
    let row = window.query_by_label_contains(": vx").unwrap();
    row.scroll_to_me();
    window.run_steps(30);
    window.get_by_label_contains(": vx").click();
    window.run_steps(3);
    press(&mut window, Key::M);
    window.run_steps(40);
    click_in_panel(&mut window, "Probes as CSV");
    assert!(window.query_by_label("Save").is_some(), "asks where to save the numbers");
    press(&mut window, Key::Escape);
    // The menu has the quantities of the whole scene.
    click_in_panel(&mut window, "Add a probe");
    click(&mut window, "Force of the pins");
    assert!(window.query_by_label_contains("Force of the pins: reaction x").is_some());
    let name = window.get_by_label_contains("Remove: Force of the pins");
    name.scroll_to_me();
    window.run_steps(30);
    window.get_by_label_contains("Remove: Force of the pins").click();
    window.run_steps(3);
    assert!(window.query_by_label_contains("Force of the pins: reaction x").is_none());
}

#[test]
fn every_field_colours_the_body_and_has_a_bar() {
    use gingerbread::elements::Field;
    let mut window = open("gingerbread_pulled");
    for field in &Field::ALL[4..] {
        click(&mut window, "More colours");
        widget(&window, Role::Button, field.title()).click();
        window.run_steps(3);
        let now = window.state().snapshot();
        assert_eq!((now.field, now.values.len()), (*field, now.triangles.len()), "{field:?}");
        draw(&window);
    }
    click(&mut window, "Gingerbread");
    assert_eq!(window.state().snapshot().field, Field::None);
}

/// Number of corners of all painted triangles.
fn painted(window: &Window) -> usize {
    let all = window.ctx.tessellate(window.output().shapes.clone(), 1.0);
    let corners = |primitive: &Primitive| match primitive {
        Primitive::Mesh(mesh) => mesh.indices.len(),
        Primitive::Callback(_) => 0,
    };
    all.iter().map(|painted| corners(&painted.primitive)).sum()
}

#[test]
fn the_shape_of_an_earlier_moment_is_drawn_in_the_plane_and_in_space() {
    for level in ["gingerbread_house", "hanging_net", "toronto_cloth"] {
        let mut window = open(level);
        let off = painted(&window);
        click(&mut window, "Before");
        let on = painted(&window);
        // The button that appears beside the switch has far fewer.
        assert!(on > off + 700, "{level}: {on} corners and {off} without");
        press(&mut window, Key::T);
        window.run_steps(10);
        click(&mut window, "Now");
        draw(&window);
        click(&mut window, "Before");
        assert!(window.query_by_label("Now").is_none(), "{level}");
    }
}

/// Pictures with one range can be compared.
#[test]
fn a_held_range_of_colours_stays_until_it_is_let_go() {
    let mut window = open("gingerbread_pulled");
    click(&mut window, "Von Mises stress");
    press(&mut window, Key::M);
    window.run_steps(60);
    click(&mut window, "Hold range");
    let end = window.state().colour_scale_end();
    type_number(&mut window, "End of range", "2 kPa");
    window.run_steps(30);
    assert!(end > 0.0 && end != 2000.0 && window.state().colour_scale_end() == 2000.0, "{end}");
    type_number(&mut window, "End of range", "-1");
    assert!(window.query_by_label_contains("expected a number above zero").is_some());
    press(&mut window, Key::Escape);
    click(&mut window, "Area ratio J");
    window.run_steps(30);
    assert!(window.query_by_label("Range on both sides").is_none(), "another field has its own range");
    click(&mut window, "Hold range");
    assert!(window.query_all_by_label("Range on both sides").next().is_some());
    click(&mut window, "Hold range");
    click(&mut window, "Von Mises stress");
    window.run_steps(120);
    assert!(window.state().colour_scale_end() != 2000.0, "it follows the values again");
}

/// A level with known results shows them, and whether they were met, once their time has come; other levels have no such list.
#[test]
fn known_results_are_shown_and_marked() {
    let mut window = open("bar_vibration");
    assert!(window.query_by_label("Known results").is_some());
    let name = "Displacement of the left end in half a period";
    assert!(window.query_by_label(name).is_some());
    assert_eq!(window.query_all_by_label("met").count(), 0);
    press(&mut window, Key::M);
    let run_to = |window: &mut Window, time: f64| {
        for _ in 0..200 {
            if window.state().snapshot().time < time {
                window.run_steps(1);
            }
        }
    };
    run_to(&mut window, 0.15);
    assert_eq!(window.query_all_by_label("met").count(), 2);
    run_to(&mut window, 0.25);
    assert_eq!(window.query_all_by_label("met").count(), 3);
    assert_eq!(window.query_all_by_label("missed").count(), 0);
    // A restart measures anew.
    press(&mut window, Key::R);
    assert_eq!(window.query_all_by_label("met").count(), 0);
    choose(&mut window, "Gingerbread house");
    assert!(window.query_by_label("Known results").is_none());
}

/// The states of the last seconds become arrays, from the first moment to the one that is shown, with the energies of each.
#[test]
fn the_last_seconds_are_saved_as_arrays() {
    let folder = Folder::new("recorded-states");
    let path = folder.0.join("arm.npz");
    let mut window = in_mode("gingerbread", Mode::Simulate);
    let begin = window.state().snapshot().energies.total();
    window.run_steps(20);
    press(&mut window, Key::Space);
    click(&mut window, "Level");
    click(&mut window, "Save recorded states…");
    type_path(&mut window, &path, "Save");
    let archive = std::fs::read(&path).unwrap();
    let numbers = |name| array_of(&archive, name).1.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect::<Vec<_>>();
    let (now, times) = (window.state().snapshot(), numbers("time"));
    assert!(times.len() > 10 && times[0] == 0.0 && times.last() == Some(&now.time), "{times:?}");
    assert!(times.windows(2).all(|pair| pair[1] > pair[0] && pair[1] - pair[0] < 0.02), "{times:?}");
    let (positions, count) = (numbers("positions"), now.positions.len());
    assert_eq!(positions.len(), times.len() * count);
    let simulation = window.state().sandbox().simulation();
    assert_eq!(positions[positions.len() - count..], *simulation.scene().listed(&simulation.state().x));
    let energies = numbers("energies");
    let total = |row: usize| energies[4 * row..4 * row + 4].iter().sum::<f64>();
    assert!((total(times.len() - 1) - now.energies.total()).abs() < 1e-9 * begin.abs().max(1.0));
    assert!(energies[4 * (times.len() - 1)] > 0.0 && energies[0] < energies[4 * (times.len() - 1)], "it began to move");
    // A toy has no vertices.
    choose(&mut window, "Circle");
    click(&mut window, "Level");
    assert!(window.query_by_label("Save recorded states…").is_none());
}
