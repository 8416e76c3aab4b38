//! Sliders, effects, levels, undo.

use crate::harness::*;
use eframe::egui::{Event, FontId, Key, Modifiers, Role, epaint::Primitive, pos2, vec2};
use egui_kittest::kittest::Queryable as _;
use gingerbread::app::keys::TABLE;
use gingerbread::command::Mode;
use gingerbread::effects::EffectKind;
use gingerbread::hard::Case;
use gingerbread::integrators::IntegratorKind;
use gingerbread::level::{Pin, SubstepMode};
use gingerbread::materials::{Model, Plane};
use gingerbread::{files, levels};

#[test]
fn a_slider_changes_the_lame_parameters_at_once() {
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
        ("Young's modulus", "-5", "Young's modulus must be greater than 0 and at most 1e15 Pa, got -5"),
        ("Poisson's ratio", "0.7", "Poisson's ratio must be greater than -1 and at most 0.5, got 0.7"),
        ("Young's modulus", "soft", "'soft' is not a number"),
        ("Substeps", "0", "substeps must be at least 1 and at most 100000, got 0"),
    ] {
        let mut window = open("gingerbread");
        let before = window.state().snapshot().level.clone();
        type_number(&mut window, name, text);
        assert!(window.state().notice().is_some_and(|notice| notice.contains(why)), "{:?}", window.state().notice());
        assert!(window.query_by_label_contains(why).is_some(), "the message is on the screen");
        assert_eq!(window.state().snapshot().level, before);
        click(&mut window, "Close");
        assert_eq!(window.state().notice(), None);
    }
}

#[test]
fn undo_and_redo_cover_pins_sliders_model_and_level() {
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
    choose(&mut window, "Hammock");
    click(&mut window, "Discard");
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
fn the_effects_panel_has_a_switch_for_every_effect() {
    let mut window = open("gingerbread_house");
    let effects = window.state().snapshot().level.effects.clone();
    for (number, listed) in effects.iter().enumerate() {
        let title = listed.effect.kind().title();
        widget(&window, Role::CheckBox, title).scroll_to_me();
        window.run_steps(30);
        widget(&window, Role::CheckBox, title).click();
        window.run_steps(3);
        let now = window.state().snapshot().level.effects[number].clone();
        assert_ne!(now.switch, listed.switch, "{title}");
        assert_eq!(now.effect, listed.effect, "{title}");
    }
}

/// It stands out while the pointer is over its group.
#[test]
fn sliders_of_walls_highlight_their_obstacle() {
    // High enough for all sliders.
    let mut window = open_level(level("jelly_disk"), 1280.0, 1400.0);
    // How much is painted at the top of the ball, and at the tip of the wedge.
    let painted = |window: &Window| {
        let places = [[0.36, 0.45], [0.6, 0.17]].map(|point| on_screen(window, point));
        let meshes = window.ctx.tessellate(window.output().shapes.clone(), 1.0);
        let vertices = meshes.iter().flat_map(|mesh| match &mesh.primitive {
            Primitive::Mesh(mesh) => mesh.vertices.as_slice(),
            Primitive::Callback(_) => &[],
        });
        let vertices: Vec<_> = vertices.collect();
        places.map(|place| vertices.iter().filter(|vertex| vertex.pos.distance(place) < 20.0).count())
    };
    let mut point_at = |name: &str| {
        let at = window.get_by_label(name).rect().center();
        window.hover_at(at);
        window.run_steps(3);
        painted(&window)
    };
    let ([ball, wedge], at_ball, at_wedge) = (point_at("Effects"), point_at("Ball"), point_at("Polygon"));
    assert!(at_ball[0] > ball && at_ball[1] == wedge, "{at_ball:?} in place of {ball} and {wedge}");
    assert!(at_wedge[0] == ball && at_wedge[1] > wedge, "{at_wedge:?} in place of {ball} and {wedge}");
    assert_eq!(point_at("Effects"), [ball, wedge]);
}

/// The picker finds levels by words of their names and descriptions; Enter opens the first.
#[test]
fn a_level_is_found_by_its_words() {
    let mut window = open("gingerbread");
    click(&mut window, "Level");
    window.event(Event::Text("rods CHAOTIC".to_owned()));
    window.run_steps(2);
    assert!(window.query_by_label("Double pendulum").is_some() && window.query_by_label("Hammock").is_none());
    press(&mut window, Key::Enter);
    window.run_steps(2);
    assert_eq!(window.state().snapshot().level.name, "Double pendulum");
    assert!(window.query_by_label("Search levels").is_none(), "the picker has closed");
    click(&mut window, "Level");
    window.event(Event::Text("no such words".to_owned()));
    window.run_steps(2);
    assert!(window.query_by_label_contains("No level has").is_some());
}

#[test]
fn every_level_opens_and_every_widget_has_a_name() {
    let mut window = open("gingerbread");
    for (file, text) in levels::BUILT_IN {
        let level = files::parse(text, file).unwrap();
        click(&mut window, "Level");
        // It may have to be scrolled to.
        window.get_all_by_label(&level.name).last().unwrap().scroll_to_me();
        window.run_steps(3);
        window.get_all_by_label(&level.name).last().unwrap().click();
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
fn the_fonts_have_every_letter_of_every_text() {
    let window = open("gingerbread");
    let mut texts: Vec<String> = TABLE.iter().map(|binding| binding.words.to_owned()).collect();
    for model in Model::ALL {
        texts.extend([model.title(), model.formula(), model.continuation()].map(str::to_owned));
    }
    texts.extend(
        IntegratorKind::all().iter().flat_map(|kind| [kind.kind().title(), kind.kind().about()].map(str::to_owned)),
    );
    texts.extend(
        EffectKind::all().iter().flat_map(|kind| [kind.kind().title(), kind.kind().about()].map(str::to_owned)),
    );
    for (_, text) in levels::BUILT_IN {
        let level = files::parse(text, "built in").unwrap();
        texts.extend([level.name, level.about]);
    }
    for (_, text) in levels::HARD {
        let case: Case = files::parse_as(text, "hard").unwrap();
        texts.extend([case.level.name, case.level.about]);
        texts.extend(case.cannot.into_iter().map(|cannot| cannot.why));
    }
    let font = FontId::proportional(14.0);
    let has = |letter: &char| window.ctx.fonts_mut(|fonts| fonts.has_glyph(&font, *letter));
    let missing = texts.iter().filter(|text| !text.chars().all(|letter| has(&letter)));
    let missing: Vec<_> =
        missing.map(|text| (text.chars().filter(|letter| !has(letter)).collect::<String>(), text)).collect();
    assert!(missing.is_empty(), "{missing:#?}");
}

/// Where no stiffness limits the step there is no such choice.
#[test]
fn the_panel_lists_the_multirate_steps_of_each_body() {
    let mut window = open("pea_and_cake");
    let parts =
        |window: &Window| window.state().snapshot().substep_plans.iter().map(|pace| pace.steps).collect::<Vec<_>>();
    let words = format!("cake {}, pea {}", parts(&window)[0], parts(&window)[1]);
    assert!(window.query_by_label(&words).is_some());
    assert!(window.query_by_label_contains("the stiffest body takes steps of").is_some());
    click(&mut window, "Multirate stepping");
    assert_eq!((window.state().snapshot().level.paces, parts(&window)), (SubstepMode::Same, Vec::new()));
    assert!(window.query_by_label_contains("cake 1,").is_none());
    click(&mut window, "Multirate stepping");
    assert!(window.query_by_label(&words).is_some());
    for name in ["Implicit Euler", "BDF2"] {
        let mut level = level("pea_and_cake");
        level.integrator = IntegratorKind::all().into_iter().find(|kind| kind.kind().title() == name).unwrap();
        let window = open_level(level, 1280.0, 800.0);
        assert!(window.query_by_label("Multirate stepping").is_none(), "{name}: no stiffness limits it");
    }
}

#[test]
fn exact_plane_stress_is_a_choice_and_refused_in_words() {
    let mut window = open("uniaxial_strip");
    let plane = |window: &Window| window.state().snapshot().level.bodies[0].material.plane();
    assert_eq!(plane(&window), Plane::Stress);
    click(&mut window, "Exact at large strain");
    assert_eq!(plane(&window), Plane::StressExact);
    press(&mut window, Key::S);
    assert!(window.query_by_label_contains("Stable neo-Hookean has no exact plane stress").is_some());
    assert_eq!(window.state().snapshot().level.bodies[0].material.model(), Model::NeoHookean, "nothing has changed");
    click(&mut window, "Close");
    press(&mut window, Key::C);
    assert!(window.query_by_label("Exact at large strain").is_none(), "plane stress is exact for this model");
    assert_eq!(plane(&window), Plane::StressExact);
    click(&mut window, "Plane strain");
    assert_eq!(plane(&window), Plane::Strain);
}

#[test]
fn a_large_mesh_is_made_while_the_scene_goes_on() {
    let mut window = in_mode("gingerbread_house", Mode::Collide);
    let (triangles, time) = (window.state().snapshot().triangles.len(), window.state().snapshot().time);
    slide(&mut window, "Number of triangles", 12_000.0);
    let now = window.state().snapshot();
    assert!(window.query_by_label_contains("Meshing about 12 000 triangles").is_some());
    assert!(now.triangles.len() == triangles && now.time > time && !now.can_undo, "the running scene stays");
    wait_until_gone(&mut window, "Cancel meshing");
    let finer = window.state().snapshot().triangles.len();
    assert!((10_000..14_000).contains(&finer), "{finer}");
    press_with(&mut window, Modifiers::COMMAND, Key::Z);
    assert_eq!(window.state().snapshot().triangles.len(), triangles, "one change, undone at once");
    press_with(&mut window, Modifiers::COMMAND, Key::Y);
    assert_eq!(window.state().snapshot().triangles.len(), finer, "the mesh is still known");
}

/// Cancel, a small mesh and another level give it up.
#[test]
fn a_large_mesh_can_be_given_up() {
    type Way = fn(&mut Window);
    let ways: [Way; 3] = [
        |window| click(window, "Cancel meshing"),
        |window| slide(window, "Number of triangles", 500.0),
        |window| choose(window, "Hammock"),
    ];
    for (number, give_up) in ways.into_iter().enumerate() {
        let mut window = open("gingerbread");
        slide(&mut window, "Number of triangles", 9_000.0);
        assert!(window.query_by_label("Cancel meshing").is_some());
        give_up(&mut window);
        assert!(window.query_by_label("Cancel meshing").is_none(), "way {number}");
        let triangles = window.state().snapshot().triangles.len();
        // Until whatever was begun is done: it is dropped.
        for _ in 0..200 {
            window.run_steps(1);
            std::thread::yield_now();
        }
        assert_eq!(window.state().snapshot().triangles.len(), triangles, "way {number}");
    }
}

#[test]
fn an_outline_can_be_simplified_in_the_window() {
    let mut window = open("jelly_disk");
    let text = "(name: \"stairs\", bodies: [(name: \"b\", mass: Total(1), material: (model: Corotated, young: 1000, poisson: 0.3),
        mesh: Outline(points: [(0.2, 0.2), (0.8, 0.2), (0.8, 0.3), (0.799, 0.3), (0.799, 0.8), (0.2, 0.8)], resolution: 300))])";
    window.state_mut().open_text(text, "stairs");
    window.run_steps(5);
    let before = window.state().snapshot().triangles.len();
    slide(&mut window, "Simplification", 0.01);
    let now = window.state().snapshot();
    assert!(now.triangles.len() < before, "{} triangles, and {before} before", now.triangles.len());
    assert!(now.messages.iter().any(|message| message.contains("left out to simplify")), "{:?}", now.messages);
}

/// Each pin mode of the menu, for nets in space, membranes and bodies; undo brings the old pins back.
#[test]
fn pins_are_chosen_from_a_menu() {
    for (name, vertices) in [
        ("princeton_cloth", [4, 26, 52, 100, 10]),
        ("toronto_cloth", [4, 20, 40, 76, 10]),
        ("cantilever", [4, 65, 18, 144, 10]),
    ] {
        let mut window = open(name);
        let before = window.state().snapshot().pins.len();
        for (mode, pinned) in ["Corners", "One edge", "Two edges", "Four edges", "Random"].into_iter().zip(vertices) {
            widget(&window, Role::ComboBox, "Pins").click();
            window.run_steps(3);
            click(&mut window, mode);
            window.run_steps(3);
            assert_eq!(window.state().snapshot().pins.len(), pinned, "{name}: {mode}");
        }
        widget(&window, Role::ComboBox, "Pins").click();
        window.run_steps(3);
        click(&mut window, "None");
        window.run_steps(3);
        assert!(window.state().snapshot().pins.is_empty(), "{name}");
        for _ in 0..6 {
            press_with(&mut window, Modifiers::COMMAND, Key::Z);
        }
        assert_eq!(window.state().snapshot().pins.len(), before, "{name}");
    }
}

/// Each kind of elements starts over with the same mesh, divided or not, and the same edge pinned; undo brings the old kind back.
#[test]
fn the_kind_of_elements_is_chosen_from_a_menu() {
    let mut window = open("cantilever");
    let before = window.state().snapshot().triangles.len();
    let pinned_now = |window: &Window| window.state().snapshot().pins.len();
    let pins = pinned_now(&window);
    for (kind, times, pinned) in [
        ("Mean dilatation", 4, 2 * pins - 1),
        ("Quadratic", 4, 2 * pins - 1),
        ("Linear", 1, pins),
        ("Quadratic", 4, 2 * pins - 1),
    ] {
        widget(&window, Role::ComboBox, "Element").click();
        window.run_steps(3);
        click(&mut window, kind);
        window.run_steps(3);
        let snapshot = window.state().snapshot();
        assert_eq!(snapshot.level.bodies[0].element.title(), kind);
        assert_eq!((snapshot.triangles.len(), pinned_now(&window)), (times * before, pinned), "{kind}");
    }
    press_with(&mut window, Modifiers::COMMAND, Key::Z);
    assert_eq!((window.state().snapshot().triangles.len(), pinned_now(&window)), (before, pins));
}

/// Membranes have the colours of bodies.
#[test]
fn cloth_is_coloured_by_its_stress() {
    let mut window = in_mode("toronto_cloth", Mode::Simulate);
    window.run_steps(10);
    for (name, least) in [("Energy density", 0.0), ("Von Mises stress", 0.0), ("Area ratio J", 0.5)] {
        click(&mut window, name);
        window.run_steps(3);
        let snapshot = window.state().snapshot();
        assert_eq!(snapshot.values.len(), 722, "{name}");
        assert!(snapshot.values.iter().all(|value| value.is_finite() && *value >= least), "{name}");
    }
    click(&mut window, "Gingerbread");
    window.run_steps(3);
    assert!(window.state().snapshot().values.is_empty());
}

/// The formula acts as soon as it is one. Text that is none stays in its field with the reason, and changes nothing.
#[test]
fn a_force_is_typed_as_a_formula() {
    let mut window = open("whirlpool");
    let formula = |window: &Window| match &window.state().snapshot().level.effects[0].effect {
        EffectKind::BodyForce(force) => force.x.text().to_owned(),
        other => unreachable!("{other:?}"),
    };
    let before = formula(&window);
    for is_seen in [false, true] {
        {
            let mut fields = window.get_all_by_role(Role::MultilineTextInput);
            let field = fields.find(|field| field.value().as_deref() == Some(before.as_str())).unwrap();
            if is_seen { field.click() } else { field.scroll_to_me() }
        }
        window.run_steps(30);
    }
    press_with(&mut window, Modifiers::COMMAND, Key::A);
    window.event(Event::Text("3*sin(t".to_owned()));
    window.run();
    assert_eq!(formula(&window), before);
    assert!(window.query_by_label_contains("column 8: expected `)`, found the end").is_some());
    window.event(Event::Text(")".to_owned()));
    window.run();
    assert_eq!(formula(&window), "3*sin(t)");
    assert!(window.query_by_label_contains("column").is_none());
    press(&mut window, Key::Enter);
    press_with(&mut window, Modifiers::COMMAND, Key::Z);
    assert_eq!(formula(&window), before);
}

/// W adds a wind that suits the cloth, and switches it; in the plane it does nothing.
#[test]
fn a_key_switches_the_wind() {
    for name in ["cornell_cloth", "princeton_cloth", "toronto_cloth", "mit_cloth", "cloth_man"] {
        let mut window = in_mode(name, Mode::Simulate);
        press(&mut window, Key::W);
        let winds = |window: &Window| {
            let effects = &window.state().snapshot().level.effects;
            effects
                .iter()
                .filter(|listed| listed.effect.name() == "Wind")
                .map(|listed| listed.switch.is_on())
                .collect::<Vec<_>>()
        };
        assert_eq!(winds(&window), [true], "{name}");
        window.run_steps(60);
        assert!(window.state().snapshot().fault.is_none(), "{name}: {:?}", window.state().snapshot().fault);
        press(&mut window, Key::W);
        assert_eq!(winds(&window), [false], "{name}");
        press(&mut window, Key::W);
        assert_eq!(winds(&window), [true], "{name}");
    }
    let mut window = in_mode("gingerbread", Mode::Simulate);
    press(&mut window, Key::W);
    assert!(window.state().snapshot().level.effects.iter().all(|listed| listed.effect.name() != "Wind"));
}

/// The menus of an edge load choose its sides and its body; what would load no edge is refused, and the scene stays.
#[test]
fn an_edge_load_acts_on_chosen_sides_of_a_chosen_body() {
    let mut window = open("hertz");
    let load = |window: &Window| {
        let listed = &window.state().snapshot().level.effects[0].effect;
        let EffectKind::EdgeLoad(load) = listed else { panic!("it is first: {listed:?}") };
        (load.of.clone().unwrap_or_default(), load.edges.clone())
    };
    assert_eq!(load(&window), ("plate".to_owned(), vec![Pin::Top]));
    click_in_panel(&mut window, "Loaded edges");
    click(&mut window, "Top");
    assert_eq!(load(&window).1, [Pin::Top], "a load needs an edge");
    click(&mut window, "Right");
    click(&mut window, "Top");
    assert_eq!(load(&window).1, [Pin::Right]);
    press(&mut window, Key::Escape);
    click_in_panel(&mut window, "Loaded body");
    click(&mut window, "dome");
    // The dome has one vertex at the far right.
    assert!(window.state().notice().is_some_and(|notice| notice.contains("names no edge")));
    assert_eq!(load(&window), ("plate".to_owned(), vec![Pin::Right]));
    click_in_panel(&mut window, "Loaded edges");
    click(&mut window, "Bottom");
    click(&mut window, "Right");
    press(&mut window, Key::Escape);
    click_in_panel(&mut window, "Loaded body");
    click(&mut window, "dome");
    assert_eq!(load(&window), ("dome".to_owned(), vec![Pin::Bottom]));
    window.check_accessibility();
}
