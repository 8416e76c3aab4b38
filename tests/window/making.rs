//! Bodies that are made in the window: drawn, from a file, and of a typed energy.

use crate::{folder::Folder, harness::*};
use eframe::egui::{Event, Key, Modifiers};
use egui_kittest::kittest::Queryable as _;

/// Drags the pointer along points of the world.
fn drag_along(window: &mut Window, points: &[[f64; 2]]) {
    let at = on_screen(window, points[0]);
    window.hover_at(at);
    window.run_steps(1);
    button(window, at, true);
    window.run_steps(1);
    for point in &points[1..] {
        window.event(Event::PointerMoved(on_screen(window, *point)));
        window.run_steps(1);
    }
    button(window, on_screen(window, points[points.len() - 1]), false);
    window.run_steps(4);
}

/// A small star of five tips about the middle of the stage.
fn star() -> Vec<[f64; 2]> {
    let corner = |number: u32| {
        let (radius, angle) =
            (if number.is_multiple_of(2) { 0.12 } else { 0.053 }, f64::from(number) * std::f64::consts::PI / 5.0);
        [0.5 + radius * angle.sin(), 0.5 + radius * angle.cos()]
    };
    (0..10).map(corner).collect()
}

#[test]
fn a_star_is_drawn_pinned_and_dropped_with_the_mouse_alone() {
    let mut window = open("gingerbread_house");
    let triangles = window.state().snapshot().triangles.len();
    click_in_panel(&mut window, "Add a body");
    click(&mut window, "Draw its outline…");
    // By one drag, with points between the corners and a little shaking of the hand.
    let corners = star();
    let next = corners.iter().cycle().skip(1);
    let line: Vec<_> = corners
        .iter()
        .zip(next)
        .flat_map(|(a, b)| {
            let at = |share: f64, axis: usize| a[axis] + share * (b[axis] - a[axis]);
            (0..6_u8).map(move |part| {
                let share = f64::from(part) / 6.0;
                [at(share, 0) + 5e-4 * (40.0 * share).sin(), at(share, 1)]
            })
        })
        .collect();
    drag_along(&mut window, &line);
    let now = window.state().snapshot();
    assert_eq!(now.bodies.len(), 2, "{:?}", window.state().notice());
    assert_eq!(now.bodies[1].name, "drawn body");
    let area: f64 = now.bodies[1].mesh.area();
    let corners_area = 5.0 * 0.12 * 0.053 * (std::f64::consts::PI / 5.0).sin();
    assert!((area / corners_area - 1.0).abs() < 0.03, "{area} m² and not {corners_area}");
    // Its triangles are about as large as those of the man, and it is as dense.
    let each = |body: usize| now.bodies[body].mesh.area() / now.bodies[body].triangles.len() as f64;
    assert!((0.4..2.5).contains(&(each(1) / each(0))), "{} {}", each(1), each(0));
    assert!(now.triangles.len() > triangles);
    // Two tips are pinned by clicks; then he falls and the star hangs.
    let first = now.bodies[1].vertices.start;
    let tip = |window: &Window, corner: [f64; 2]| {
        let distance = |number: &usize| {
            let [x, y] = vertex(window, *number);
            (x - corner[0]).hypot(y - corner[1])
        };
        let vertices = window.state().snapshot().bodies[1].vertices.clone();
        vertices.min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap()
    };
    let tips = [corners[2], corners[8]].map(|corner| tip(&window, corner));
    assert!(tips.iter().all(|tip| *tip >= first));
    for number in tips {
        let at = on_screen(&window, vertex(&window, number));
        click_at(&mut window, at);
    }
    let mut pins = window.state().snapshot().pins.to_vec();
    pins.sort_unstable();
    assert_eq!(pins.len(), 2, "{pins:?}");
    // Undo takes the star away again, after the pins.
    for _ in 0..3 {
        press_with(&mut window, Modifiers::COMMAND, Key::Z);
    }
    assert_eq!(window.state().snapshot().bodies.len(), 1);
}

#[test]
fn corners_are_clicked_and_the_first_one_closes_the_outline() {
    let mut window = open("gingerbread");
    for end in ["the first corner", "Enter"] {
        let before = window.state().snapshot().bodies.len();
        click_in_panel(&mut window, "Add a body");
        click(&mut window, "Draw its outline…");
        let corners = [[0.1, 0.15], [0.3, 0.15], [0.2, 0.3]];
        for corner in corners {
            let at = on_screen(&window, corner);
            click_at(&mut window, at);
        }
        if end == "Enter" {
            press(&mut window, Key::Enter);
        } else {
            let at = on_screen(&window, corners[0]);
            click_at(&mut window, at);
        }
        let now = window.state().snapshot();
        assert_eq!(now.bodies.len(), before + 1, "{end}: {:?}", window.state().notice());
        let area = now.bodies[before].mesh.area();
        assert!((area / 0.015 - 1.0).abs() < 0.05, "{end}: {area}");
        assert!(now.pins.is_empty(), "{end}: clicks draw and pin nothing");
    }
    let names: Vec<_> = window.state().snapshot().part_names().cloned().collect();
    assert_eq!(names, ["gingerbread man", "drawn body", "drawn body 2"]);
    click_in_panel(&mut window, "Remove this body");
    assert_eq!(window.state().snapshot().bodies.len(), 2);
    // Escape drops what was begun, and a line that crosses itself is refused in words.
    click_in_panel(&mut window, "Add a body");
    click(&mut window, "Draw its outline…");
    let at = on_screen(&window, [0.5, 0.5]);
    click_at(&mut window, at);
    press(&mut window, Key::Escape);
    click_at(&mut window, at);
    assert_eq!(window.state().snapshot().pins.len(), 1, "a click pins again");
    click_in_panel(&mut window, "Add a body");
    click(&mut window, "Draw its outline…");
    for corner in [[0.1, 0.6], [0.4, 0.9], [0.4, 0.6], [0.1, 0.9]] {
        let at = on_screen(&window, corner);
        click_at(&mut window, at);
    }
    press(&mut window, Key::Enter);
    assert_eq!(window.state().snapshot().bodies.len(), 2);
    let told = window.state().notice().unwrap_or_default().to_owned();
    assert!(told.contains("cross") || told.contains("meet"), "{told}");
}

#[test]
fn a_mesh_file_that_is_dropped_becomes_a_body() {
    let folder = Folder::new("dropped-mesh");
    let path = std::path::PathBuf::from(folder.file("wedge.obj"));
    std::fs::write(&path, "v 0 0 0\nv 30 0 0\nv 30 20 0\nv 0 20 0\nv 15 10 0\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n")
        .unwrap();
    for (level, bodies) in [("gingerbread", 2), ("cornell_cloth", 1)] {
        let mut window = open(level);
        drop_files(&mut window, &[&path]);
        let now = window.state().snapshot();
        assert_eq!(now.bodies.len(), bodies, "{level}: {:?}", window.state().notice());
        let body = &now.bodies[bodies - 1];
        assert_eq!((body.name.as_str(), body.triangles.len()), ("wedge", 4), "{level}");
        let xs: Vec<f64> = body.vertices.clone().map(|number| vertex(&window, number)[0]).collect();
        let (least, most) = xs.iter().fold((f64::MAX, f64::MIN), |(a, b), x| (a.min(*x), b.max(*x)));
        assert!((least - 0.25).abs() < 1e-9 && (most - 0.75).abs() < 1e-9, "{level}: {least} to {most}");
    }
    std::fs::write(&path, "f 1 2 3\n").unwrap();
    let mut window = open("gingerbread");
    drop_files(&mut window, &[&path]);
    assert_eq!(window.state().snapshot().bodies.len(), 1);
    assert!(window.state().notice().is_some_and(|told| told.contains("wedge.obj")), "{:?}", window.state().notice());
}

#[test]
fn an_energy_is_typed_in_the_window() {
    let mut window = open("gingerbread");
    click_in_panel(&mut window, "Typed energy");
    let energy = |window: &Window| window.state().sandbox().document().level.bodies[0].energy.clone();
    assert!(energy(&window).is_some());
    window.get_by_label("ψ").scroll_to_me();
    window.run_steps(30);
    let fields: Vec<_> = window.query_all_by_role(eframe::egui::accesskit::Role::MultilineTextInput).collect();
    fields[0].focus();
    window.run_steps(2);
    press_with(&mut window, Modifiers::COMMAND, Key::A);
    window.event(Event::Text("c/2*(I1 - 2 - 2*log(J))".to_owned()));
    window.run_steps(3);
    assert!(energy(&window).unwrap().text().starts_with("mu/2"), "an unknown name changes nothing");
    click(&mut window, "Make c a parameter");
    window.run_steps(3);
    let now = energy(&window).unwrap();
    assert_eq!((now.text(), now.parameters()), ("c/2*(I1 - 2 - 2*log(J))", &[("c".to_owned(), 1.0)][..]));
    assert!((lame(&window).mu - 1.0).abs() < 1e-12);
    // The key of a model goes back to it.
    press(&mut window, Key::Escape);
    window.run_steps(2);
    click(&mut window, "Neo-Hookean");
    assert_eq!(energy(&window), None);
}

#[test]
fn drawings_and_pictures_become_bodies() {
    let folder = Folder::new("drawings");
    let path = folder.0.join("letters.svg");
    let ring = "M0 0h60v60h-60zM20 20v20h20v-20z";
    let drawing =
        format!("<svg xmlns='http://www.w3.org/2000/svg'><path d='{ring}'/><circle cx='90' cy='30' r='20'/></svg>");
    std::fs::write(&path, drawing).unwrap();
    let mut window = open("gingerbread");
    drop_files(&mut window, &[&path]);
    let names: Vec<_> = window.state().snapshot().bodies.iter().map(|body| body.name.clone()).collect();
    assert_eq!(names, ["gingerbread man", "letters", "letters 2"]);
    let bodies = &window.state().snapshot().bodies;
    assert_eq!([1, 2].map(|body| bodies[body].mesh.boundary_loops().len()), [2, 1], "a hole stays a hole");

    let outline = folder.0.join("ring.svg");
    click_in_panel(&mut window, "Outline (SVG)…");
    type_path(&mut window, &outline, "Save");
    assert!(std::fs::read_to_string(&outline).unwrap().starts_with("<svg"), "the chosen body is the last one");
    let count = |window: &Window| window.state().snapshot().bodies.len();
    press_with(&mut window, Modifiers::COMMAND, Key::Z);
    assert_eq!(count(&window), 1, "one drawing is one change");
    press_with(&mut window, Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    assert_eq!(count(&window), 3);
    let mut window = open("pendulum");
    drop_files(&mut window, &[&outline]);
    let now = window.state().snapshot();
    assert_eq!((now.level.name.as_str(), now.bodies.len()), ("ring", 1), "a level of its own, where there was a toy");

    std::fs::write(&path, "<svg xmlns='http://www.w3.org/2000/svg'><path d='M0 0 30 30 30 0 0 30z'/></svg>").unwrap();
    drop_files(&mut window, &[&path]);
    let told = window.state().notice().unwrap();
    assert!(told.contains("letters.svg") && told.contains("cross"), "{told}");
    assert_eq!(window.state().snapshot().bodies.len(), 1, "the scene stays");
}
