//! What the window promises, kept without a display: real clicks, drags and keys against the real simulation. Time is the
//! test's own (1/60 s a frame) and every step that is owed is taken, so nothing depends on the machine.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a failing test should panic")]

use eframe::egui::{Event, Key, Modifiers, PointerButton, Pos2, Rect, Role, pos2, vec2};
use egui_kittest::{
    Harness, Node,
    kittest::{NodeT as _, Queryable as _},
};
use gingerbread::{
    app::{
        App,
        keys::{Binding, TABLE, When},
    },
    command::{Mode, Pose},
    files::{self, Disk},
    level::Level,
    levels,
    materials::{Lame, Model},
};

type Window = Harness<'static, App>;

fn level(name: &str) -> Level {
    files::parse(levels::built_in(name).unwrap(), name).unwrap()
}

fn open_level(level: Level, width: f32, height: f32) -> Window {
    let mut window = Harness::builder()
        .with_size([width, height])
        .with_step_dt(1.0 / 60.0)
        .build_eframe(move |cc| App::with_level(&cc.egui_ctx, level, Box::new(Disk)).unwrap().unhurried());
    window.run_steps(3);
    window
}

fn open(name: &str) -> Window {
    open_level(level(name), 1280.0, 800.0)
}

fn press(window: &mut Window, key: Key) {
    press_with(window, Modifiers::NONE, key);
}

fn press_with(window: &mut Window, modifiers: Modifiers, key: Key) {
    window.key_press_modifiers(modifiers, key);
    window.run_steps(3);
}

fn click(window: &mut Window, label: &str) {
    window.get_by_label(label).click();
    window.run_steps(3);
}

fn stage(window: &Window) -> Rect {
    window.get_by_label("Stage").rect()
}

fn vertex(window: &Window, number: usize) -> [f64; 2] {
    let positions = &window.state().snapshot().positions;
    [positions[2 * number], positions[2 * number + 1]]
}

fn on_screen(window: &Window, point: [f64; 2]) -> Pos2 {
    window.state().on_screen(stage(window), point)
}

fn button(window: &Window, pos: Pos2, pressed: bool) {
    window.event(Event::PointerMoved(pos));
    window.event(Event::PointerButton { pos, button: PointerButton::Primary, pressed, modifiers: Modifiers::NONE });
}

fn click_at(window: &mut Window, pos: Pos2) {
    window.hover_at(pos);
    window.run_steps(1);
    button(window, pos, true);
    window.run_steps(1);
    button(window, pos, false);
    window.run_steps(3);
}

fn lame(window: &Window) -> Lame {
    window.state().sandbox().simulation().scene().bodies[0].elements.lame()
}

/// Makes the triangles that would be painted, which the harness does not: numbers that are none would end it here.
fn draw(window: &Window) {
    window.ctx.tessellate(window.output().shapes.clone(), 1.0);
}

fn mode(window: &Window) -> Mode {
    window.state().snapshot().mode
}

/// The largest distance of a coordinate from the start.
fn moved(window: &Window) -> f64 {
    let now = window.state().snapshot();
    now.positions.iter().zip(now.start.iter()).map(|(now, start)| (now - start).abs()).fold(0.0, f64::max)
}

/// The widget of a kind with a name; a name may stand on a label, a number field and a slider.
fn widget<'a>(window: &'a Window, role: Role, name: &'a str) -> Node<'a> {
    let mut found = window.get_all_by_label(name).filter(|node| node.accesskit_node().role() == role);
    found.next().unwrap_or_else(|| panic!("there is no {role:?} {name:?}"))
}

fn click_number(window: &mut Window, name: &str) {
    widget(window, Role::SpinButton, name).click();
    window.run_steps(3);
}

/// Types into the number field of a parameter.
fn type_number(window: &mut Window, name: &str, text: &str) {
    click_number(window, name);
    window.event(Event::Text(text.to_owned()));
    window.run_steps(2);
    press(window, Key::Enter);
}

fn slide(window: &mut Window, name: &str, value: f64) {
    widget(window, Role::Slider, name).set_value_accesskit(value);
    window.run_steps(3);
}

#[test]
fn a_click_on_the_stage_pins_the_nearest_vertex_and_another_click_frees_it() {
    let mut window = open("gingerbread");
    let before = window.state().snapshot().pins.len();
    let at = on_screen(&window, vertex(&window, 100)) + vec2(1.0, -1.0);
    click_at(&mut window, at);
    assert!(window.state().snapshot().pins.contains(&100), "{:?}", window.state().snapshot().pins);
    click_at(&mut window, at);
    assert_eq!(window.state().snapshot().pins.len(), before);
}

#[test]
fn dragging_pulls_the_picked_vertex_towards_the_cursor_and_letting_go_ends_it() {
    for (key, mode) in [(Key::M, Mode::Simulate), (Key::T, Mode::Collide)] {
        let mut window = open("gingerbread");
        press(&mut window, key);
        assert_eq!(window.state().snapshot().mode, mode);
        press(&mut window, Key::Space);
        let start = vertex(&window, 100);
        let from = on_screen(&window, start);
        window.hover_at(from);
        window.run_steps(1);
        button(&window, from, true);
        window.run_steps(1);
        let to = from + vec2(60.0, -40.0);
        window.event(Event::PointerMoved(to));
        window.run_steps(2);
        press(&mut window, Key::Space);
        window.run_steps(20);
        let pull = window.state().snapshot().pull.expect("a pull");
        assert!(pull.vertex == 100 && pull.force >= 0.0, "{pull:?}");
        assert!(vertex(&window, 100)[0] > start[0] + 0.005, "{mode:?}: the vertex must follow");
        button(&window, to, false);
        window.run_steps(2);
        assert_eq!(window.state().snapshot().pull, None);
    }
}

/// Brings a new window of a level into a mode, running, with everything a little out of place.
fn in_mode(name: &str, mode: Mode) -> Window {
    let mut window = open(name);
    match mode {
        Mode::Edit => {}
        Mode::Simulate => press(&mut window, Key::M),
        Mode::Collide => press(&mut window, Key::T),
    }
    window.run_steps(5);
    window
}

fn expect(window: &Window, before: &gingerbread::snapshot::Snapshot, binding: &Binding) {
    let now = window.state().snapshot();
    let what = format!("{} in {:?}", binding.label, before.mode);
    let models = |model: Model| {
        assert!(now.bodies.iter().all(|body| body.model == model), "{what}");
        assert!(now.time < before.time || before.time == 0.0, "{what} must start over");
    };
    match (binding.label, before.mode) {
        ("C", _) => models(Model::Corotated),
        ("V", _) => models(Model::StVenantKirchhoff),
        ("N", _) => models(Model::NeoHookean),
        ("M", Mode::Simulate) | ("T", Mode::Collide) => assert_eq!(now.mode, Mode::Edit, "{what}"),
        ("M", _) => assert_eq!(now.mode, Mode::Simulate, "{what}"),
        ("T", _) => assert_eq!(now.mode, Mode::Collide, "{what}"),
        ("R", Mode::Edit) => assert!(now.pins.is_empty(), "{what}"),
        ("R", _) => assert!(now.time < before.time, "{what}"),
        ("D", _) => assert_ne!(now.damping, before.damping, "{what}"),
        ("Space", Mode::Edit) => assert!(now.running && now.mode == before.level.mode.into(), "{what}"),
        ("Space", _) => assert_eq!(now.running, !before.running, "{what}"),
        ("Up", _) => assert_eq!(now.pose, Some(Pose::Stretched), "{what}"),
        ("Down", _) => assert_eq!(now.pose, Some(Pose::Compressed), "{what}"),
        ("?", _) => assert!(window.query_by_label("Keys and mouse").is_some(), "{what}"),
        ("Ctrl+Z" | "Ctrl+Y", _) => {}
        (other, _) => panic!("{other} is in the table, but no test says what it does"),
    }
}

#[test]
fn every_key_does_in_every_mode_what_the_table_says() {
    for mode in [Mode::Edit, Mode::Simulate, Mode::Collide] {
        for binding in TABLE {
            for shortcut in binding.shortcuts {
                let mut window = in_mode("stretch_test", mode);
                let before = window.state().snapshot().clone();
                if !binding.when.holds(&before) {
                    continue;
                }
                press_with(&mut window, shortcut.modifiers, shortcut.logical_key);
                expect(&window, &before, binding);
            }
        }
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
    for (key, label) in [(Key::C, "Corotated"), (Key::V, "St. Venant-Kirchhoff"), (Key::N, "Neo-Hookean")] {
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
fn a_slider_changes_the_lame_parameters_of_the_running_scene_at_once() {
    let mut window = in_mode("gingerbread", Mode::Simulate);
    let (before, time) = (lame(&window), window.state().snapshot().time);
    let young = window.state().snapshot().level.bodies[0].material.young().get();
    slide(&mut window, "Young's modulus", 2.0 * young);
    let now = lame(&window);
    assert!((now.mu / before.mu - 2.0).abs() < 1e-12 && (now.lambda / before.lambda - 2.0).abs() < 1e-12);
    assert!(window.state().snapshot().time > time, "time goes on");
}

#[test]
fn a_typed_number_with_a_prefix_is_taken() {
    let mut window = open("gingerbread");
    type_number(&mut window, "Young's modulus", "60k");
    assert_eq!(window.state().snapshot().level.bodies[0].material.young().get(), 60e3);
}

#[test]
fn leaving_a_number_field_unchanged_does_not_round_the_number() {
    let mut odd = level("gingerbread");
    let material = &mut odd.bodies[0].material;
    let young = gingerbread::quantity::Young::new(31_234.567).unwrap();
    *material =
        gingerbread::materials::MaterialParameters::new(material.model(), young, material.poisson(), material.plane())
            .unwrap();
    let mut window = open_level(odd, 1280.0, 800.0);
    click_number(&mut window, "Young's modulus");
    press(&mut window, Key::Enter);
    assert_eq!(window.state().snapshot().level.bodies[0].material.young(), young);
    assert!(!window.state().snapshot().can_undo);
}

#[test]
fn a_refused_number_shows_why_and_changes_nothing() {
    for (name, text, why) in [
        ("Young's modulus", "-5", "Young's modulus must be in (0, 1e15] Pa, got -5"),
        ("Poisson's ratio", "0.7", "Poisson's ratio must be in (-1, 0.5], got 0.7"),
        ("Young's modulus", "soft", "'soft' is not a number"),
        ("Substeps", "0", "substeps must be in [1, 100000], got 0"),
    ] {
        let mut window = open("gingerbread");
        let before = window.state().snapshot().level.clone();
        type_number(&mut window, name, text);
        assert!(window.state().notice().is_some_and(|notice| notice.contains(why)), "{:?}", window.state().notice());
        assert!(window.query_by_label_contains(why).is_some(), "the message is on the screen");
        assert_eq!(window.state().snapshot().level, before);
        click(&mut window, "Got it");
        assert_eq!(window.state().notice(), None);
    }
}

#[test]
fn a_broken_level_file_shows_file_line_and_column_and_the_old_scene_goes_on() {
    let folder = std::env::temp_dir().join(format!("gingerbread-window-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("broken.ron");
    std::fs::write(&path, "(\n    name: \"broken\",\n    bodies: 7,\n)\n").unwrap();
    let mut window = in_mode("gingerbread", Mode::Simulate);
    let time = window.state().snapshot().time;
    window.state_mut().open(&path);
    window.run_steps(10);
    assert!(window.query_by_label_contains("broken.ron:3:").is_some(), "{:?}", window.state().notice());
    let now = window.state().snapshot();
    assert!(now.time > time && now.level.name == level("gingerbread").name);
    window.state_mut().open(&folder.join("missing.ron"));
    window.run_steps(3);
    assert!(window.query_by_label_contains("missing.ron").is_some());
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn what_is_saved_opens_again_as_it_was() {
    let folder = std::env::temp_dir().join(format!("gingerbread-save-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("saved.ron");
    let mut window = in_mode("gingerbread", Mode::Simulate);
    press(&mut window, Key::Space);
    let positions = window.state().snapshot().positions.clone();
    window.state_mut().save(&path);
    assert!(window.state().notice().is_some_and(|notice| notice.starts_with("Saved as")));
    press(&mut window, Key::N);
    window.state_mut().open(&path);
    window.run_steps(3);
    assert_eq!(window.state().snapshot().positions, positions);
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn undo_and_redo_take_back_and_make_again_pins_sliders_model_and_level() {
    let undo = |window: &mut Window| press_with(window, Modifiers::COMMAND, Key::Z);
    let redo = |window: &mut Window| press_with(window, Modifiers::COMMAND, Key::Y);
    let mut window = open("gingerbread");
    let first = window.state().snapshot().level.clone();

    let at = on_screen(&window, vertex(&window, 100));
    click_at(&mut window, at);
    let pinned = window.state().snapshot().level.clone();
    slide(&mut window, "Poisson's ratio", 0.4);
    let slid = window.state().snapshot().level.clone();
    press(&mut window, Key::N);
    let modelled = window.state().snapshot().level.clone();
    click(&mut window, "Level");
    click(&mut window, "Hammock");
    let opened = window.state().snapshot().level.clone();
    let all = [first, pinned, slid, modelled, opened];
    assert!(all.windows(2).all(|pair| pair[0] != pair[1]));

    for level in all.iter().rev().skip(1) {
        undo(&mut window);
        assert_eq!(window.state().snapshot().level, *level);
    }
    assert!(!window.state().snapshot().can_undo);
    for level in all.iter().skip(1) {
        redo(&mut window);
        assert_eq!(window.state().snapshot().level, *level);
    }
    press_with(&mut window, Modifiers::COMMAND, Key::Z);
    press_with(&mut window, Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    assert_eq!(window.state().snapshot().level, all[4], "Ctrl+Shift+Z makes again, too");
}

#[test]
fn one_drag_of_a_slider_is_undone_as_one_step() {
    let mut window = open("gingerbread");
    let before = window.state().snapshot().level.clone();
    let rail = widget(&window, Role::Slider, "Young's modulus").rect();
    for (from, to) in [(0.3, 0.7), (0.7, 0.6)] {
        let at = |share: f32| pos2(rail.left() + share * rail.width(), rail.center().y);
        window.hover_at(at(from));
        window.run_steps(1);
        button(&window, at(from), true);
        window.run_steps(1);
        for step in 1..=8 {
            window.event(Event::PointerMoved(at(from + (to - from) * step as f32 / 8.0)));
            window.run_steps(1);
        }
        button(&window, at(to), false);
        window.run_steps(3);
    }
    assert_ne!(window.state().snapshot().level, before);
    click(&mut window, "Undo");
    assert_ne!(window.state().snapshot().level, before, "two drags are two steps");
    click(&mut window, "Undo");
    assert_eq!(window.state().snapshot().level, before);
    assert!(!window.state().snapshot().can_undo);
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
    click(&mut window, "All three models side by side");
    assert_eq!(window.state().snapshot().bodies.len(), 3);
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
fn the_effects_panel_shows_every_effect_of_a_level_with_a_switch_and_its_numbers() {
    let mut window = open("gingerbread_house");
    let effects = window.state().snapshot().level.effects.clone();
    for (number, listed) in effects.iter().enumerate() {
        let title = listed.effect.kind().title();
        widget(&window, Role::CheckBox, title).click();
        window.run_steps(3);
        let now = window.state().snapshot().level.effects[number].clone();
        assert_ne!(now.switch, listed.switch, "{title}");
        assert_eq!(now.effect, listed.effect, "{title}");
    }
}

#[test]
fn at_600_by_600_the_sides_fold_away_and_the_stage_stays_usable() {
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
fn when_time_stops_the_banner_says_why_and_its_buttons_mend_it() {
    let mut wild = level("gingerbread_house");
    wild.substeps = gingerbread::level::Substeps::new(2).unwrap();
    wild.bodies[0].material = wild.bodies[0].material.with_model(Model::NeoHookean);
    for (label, substeps) in [("Reset", 2), ("Halve the step", 4), ("Damp", 2)] {
        let mut window = open_level(wild.clone(), 1280.0, 800.0);
        press(&mut window, Key::T);
        for _ in 0..300 {
            if window.state().snapshot().fault.is_some() {
                break;
            }
            window.run_steps(1);
        }
        window.run_steps(2);
        assert!(window.query_by_label("Time stopped").is_some(), "it must fail, and say so");
        draw(&window);
        assert!(window.state().snapshot().positions.iter().all(|x| x.is_finite()));
        press(&mut window, Key::Space);
        click(&mut window, label);
        let now = window.state().snapshot();
        assert_eq!((now.fault.clone(), now.level.substeps.get()), (None, substeps), "{label}");
        assert_eq!(now.damping, label == "Damp");
    }
}

#[test]
fn a_body_that_flies_apart_does_not_bring_the_window_down() {
    for (model, young) in [(Key::C, "1e15"), (Key::V, "1e15"), (Key::N, "1e15"), (Key::V, "1e9")] {
        let mut window = open("gingerbread_house");
        press(&mut window, model);
        type_number(&mut window, "Young's modulus", young);
        press(&mut window, Key::T);
        for frame in 0..40 {
            for label in ["Energy density", "Von Mises stress", "Area ratio J"] {
                if frame % 10 == 0 {
                    click(&mut window, label);
                }
            }
            window.run_steps(1);
            draw(&window);
        }
        assert!(window.state().snapshot().positions.iter().all(|x| x.is_finite()));
    }
}

#[test]
fn every_level_opens_from_the_picker_and_every_widget_has_a_name() {
    let mut window = open("gingerbread");
    for (file, text) in levels::BUILT_IN {
        let level = files::parse(text, file).unwrap();
        click(&mut window, "Level");
        let entry = window.get_all_by_label(&level.name).last().unwrap();
        entry.click();
        window.run_steps(3);
        assert_eq!(window.state().snapshot().level.name, level.name);
        window.check_accessibility();
    }
    for size in [vec2(400.0, 400.0), vec2(600.0, 600.0), vec2(3840.0, 2160.0)] {
        window.set_size(size);
        window.run_steps(5);
        window.check_accessibility();
        for panel in ["Body panel", "Cost panel", "Keys"] {
            click(&mut window, panel);
            window.check_accessibility();
        }
        press(&mut window, Key::Escape);
    }
}

#[test]
fn a_paused_window_sleeps() {
    let mut window = open("gingerbread");
    window.run_steps(60);
    assert!(window.try_run().is_ok(), "nothing moves, so nothing asks to be drawn again");
}

#[test]
fn the_table_has_every_promised_key() {
    let labels: Vec<_> = TABLE.iter().map(|binding| binding.label).collect();
    for key in ["C", "V", "N", "M", "T", "R", "D", "Space", "Up", "Down", "Click", "Drag", "Ctrl+Z", "Ctrl+Y", "?"] {
        assert!(labels.contains(&key), "{key}");
    }
    assert_eq!(
        TABLE.iter().filter(|binding| binding.label == "R").map(|b| b.when).collect::<Vec<_>>(),
        [When::Edit, When::Moving]
    );
}
