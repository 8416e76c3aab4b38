//! Tools on the stage: boxes and lines that pin, and the ruler.

use crate::harness::*;
use eframe::egui::{Event, Key, Modifiers, Pos2, Role, pos2, vec2};
use egui_kittest::kittest::Queryable as _;
use gingerbread::{command::Mode, obstacles::ObstacleKind};

/// Vertices of a scene in the plane that are seen between two corners.
fn between(window: &Window, [least, greatest]: [Pos2; 2]) -> Vec<u32> {
    let count = window.state().snapshot().vertex_count();
    let is_within = |number: &u32| {
        let at = on_screen(window, vertex(window, *number as usize));
        at.x > least.x && at.x < greatest.x && at.y > least.y && at.y < greatest.y
    };
    (0..count as u32).filter(is_within).collect()
}

#[test]
fn a_drag_with_shift_in_edit_mode_pins_what_is_in_its_box() {
    let mut window = open("gingerbread");
    let head = on_screen(&window, vertex(&window, 0));
    let corners = [head - vec2(60.0, 40.0), head + vec2(60.0, 50.0)];
    let inside = between(&window, corners);
    assert!(inside.len() > 10, "{}", inside.len());
    drag(&mut window, &[corners[0], head, corners[1]], Modifiers::SHIFT);
    assert_eq!(*window.state().snapshot().pins, inside);
    // Once more frees them, as all of them are pinned; one change is undone at a time.
    drag(&mut window, &[corners[1], head, corners[0]], Modifiers::SHIFT);
    assert!(window.state().snapshot().pins.is_empty());
    press_with(&mut window, Modifiers::COMMAND, Key::Z);
    assert_eq!(*window.state().snapshot().pins, inside);
    press_with(&mut window, Modifiers::COMMAND, Key::Z);
    assert!(window.state().snapshot().pins.is_empty());
    // Escape in the middle of it cancels.
    window.event(Event::ModifiersChanged(Modifiers::SHIFT));
    window.hover_at(corners[0]);
    window.run_steps(1);
    button(&window, corners[0], true);
    window.run_steps(1);
    window.event(Event::PointerMoved(corners[1]));
    window.run_steps(2);
    press(&mut window, Key::Escape);
    button(&window, corners[1], false);
    window.run_steps(2);
    window.event(Event::ModifiersChanged(Modifiers::NONE));
    assert!(window.state().snapshot().pins.is_empty(), "it was cancelled");
    // A box around nothing changes nothing, and a click is still a click.
    drag(&mut window, &[pos2(head.x + 300.0, head.y), pos2(head.x + 330.0, head.y + 9.0)], Modifiers::SHIFT);
    assert!(window.state().snapshot().pins.is_empty());
    click_at(&mut window, head);
    assert_eq!(*window.state().snapshot().pins, [0]);
}

#[test]
fn a_line_pins_what_is_inside_in_the_plane_and_in_space() {
    for name in ["cantilever", "mit_cloth"] {
        let mut window = open(name);
        widget(&window, Role::ComboBox, "Pins").scroll_to_me();
        window.run_steps(30);
        widget(&window, Role::ComboBox, "Pins").click();
        window.run_steps(3);
        click(&mut window, "Inside a line…");
        let before = window.state().snapshot().pins.to_vec();
        let stage = stage(&window).shrink(20.0);
        // A triangle over the left half, drawn from corner to corner.
        let corners = [stage.left_top(), stage.left_bottom(), stage.center()];
        let line = |[from, to]: [Pos2; 2]| (0..10_u8).map(move |i| from.lerp(to, f32::from(i) / 10.0));
        let places: Vec<_> =
            [[0, 1], [1, 2], [2, 0]].into_iter().flat_map(|ends| line(ends.map(|i| corners[i]))).collect();
        drag(&mut window, &places[1..], Modifiers::NONE);
        let pins = window.state().snapshot().pins.to_vec();
        let count = window.state().snapshot().vertex_count();
        assert!(pins.len() > before.len() && pins.len() < count, "{name}: {} of {count}", pins.len());
        assert!(before.iter().all(|pin| pins.contains(pin)), "{name}: pins stay");
        press(&mut window, Key::Escape);
        drag(&mut window, &places[1..], Modifiers::NONE);
        assert_eq!(window.state().snapshot().pins.to_vec(), pins, "{name}: the tool was put away");
    }
}

/// Sum of the velocities of all vertices along x and y.
fn velocity(window: &Window) -> [f64; 2] {
    let velocities = &window.state().sandbox().simulation().state().v;
    [0, 1].map(|axis| velocities.iter().skip(axis).step_by(2).sum())
}

#[test]
fn the_menu_of_tools_pushes_and_bursts() {
    let mut window = in_mode("gingerbread", Mode::Simulate);
    press(&mut window, Key::Space);
    let middle = stage(&window).center();
    click(&mut window, "Tool");
    click(&mut window, "Push");
    drag(&mut window, &[middle, middle + vec2(20.0, 0.0), middle + vec2(60.0, 0.0)], Modifiers::NONE);
    let [x, y] = velocity(&window);
    assert!(x > 1.0 && y.abs() < 1e-6 * x, "{x} {y}");
    assert!(window.state().snapshot().pull.is_none(), "it does not pull");
    click(&mut window, "Tool");
    click(&mut window, "Burst");
    let squares = |window: &Window| window.state().snapshot().energies.kinetic;
    let before = squares(&window);
    click_at(&mut window, middle);
    assert!(squares(&window) > 2.0 * before, "{before} J before, {} J after", squares(&window));
    // Nothing moves in edit mode, and the hand pins again.
    press(&mut window, Key::M);
    let before = velocity(&window);
    click_at(&mut window, middle);
    assert_eq!(velocity(&window), before);
    press(&mut window, Key::Escape);
    click_at(&mut window, middle);
    assert_eq!(window.state().snapshot().pins.len(), 1);
}

/// The numbers of the ruler, by their names.
fn measured(window: &mut Window) -> Vec<(String, f64)> {
    click_in_panel(window, "Copy: Ruler");
    // The text is in the frame of the click.
    window.get_by_label("Copy: Ruler").click();
    let text = copied(window);
    let number = |line: &str| {
        let mut parts = line.split('\t').map(str::to_owned);
        (parts.next().unwrap(), parts.next().unwrap().parse().unwrap())
    };
    text.lines().map(number).collect()
}

#[test]
fn a_ruler_measures_distances_and_angles_and_moves_with_vertices() {
    let mut window = open("cantilever");
    let count = window.state().snapshot().vertex_count();
    let ends = [vertex(&window, 0), vertex(&window, count - 1)];
    let seen = ends.map(|end| on_screen(&window, end));
    click_in_panel(&mut window, "Ruler");
    for at in seen {
        click_at(&mut window, at);
    }
    assert!(window.state().snapshot().level.bodies[0].pins.len() < 3, "clicks of the ruler pin nothing");
    let numbers = measured(&mut window);
    let value = |numbers: &[(String, f64)], wanted: &str| {
        numbers.iter().find(|(name, _)| name == wanted).map_or(f64::NAN, |(_, value)| *value)
    };
    let [dx, dy] = [0, 1].map(|axis| ends[1][axis] - ends[0][axis]);
    assert_eq!(value(&numbers, "Distance"), (dx * dx + dy * dy).sqrt());
    assert_eq!((value(&numbers, "dx"), value(&numbers, "dy")), (dx, dy));
    assert_eq!(value(&numbers, "Slope"), dy.atan2(dx).to_degrees());
    assert_eq!(value(&numbers, "Distance over that at the start"), 1.0);
    // A third point away from all vertices: the angle at the second.
    let third = on_screen(&window, [ends[1][0], ends[1][1] + 0.3]);
    click_at(&mut window, third);
    let corner = value(&measured(&mut window), "Angle at the second point");
    let wanted = (-dy).atan2(-dx).to_degrees().rem_euclid(360.0) - 90.0;
    assert!((corner - wanted.abs()).abs() < 0.01, "{corner} for {wanted}");
    // It stays on the vertices while they move.
    press(&mut window, Key::Escape);
    press(&mut window, Key::Space);
    assert_ne!(window.state().snapshot().mode, Mode::Edit);
    window.run_steps(20);
    press(&mut window, Key::Space);
    let now = [vertex(&window, 0), vertex(&window, count - 1)];
    let numbers = measured(&mut window);
    assert_eq!(value(&numbers, "dy"), now[1][1] - now[0][1]);
    assert_ne!(value(&numbers, "Distance over that at the start"), 1.0);
    click_in_panel(&mut window, "Remove: Ruler");
    assert!(window.query_by_label("Copy: Ruler").is_none());
}

#[test]
fn a_drag_of_the_ruler_measures_in_space_between_vertices() {
    let mut window = open("mit_cloth");
    click_in_panel(&mut window, "Ruler");
    let middle = stage(&window).center();
    drag(&mut window, &[middle - vec2(80.0, 0.0), middle, middle + vec2(80.0, 0.0)], Modifiers::NONE);
    let numbers = measured(&mut window);
    let names: Vec<_> = numbers.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["Distance", "dx", "dy", "dz", "Distance over that at the start"]);
    let [distance, dx, dy, dz] = [0, 1, 2, 3].map(|place| numbers[place].1);
    assert!(distance > 0.0 && (distance - (dx * dx + dy * dy + dz * dz).sqrt()).abs() < 1e-12 * distance);
}

/// A click and a drag with the tool divide triangles of bodies and of cloth, each as one change to undo; Escape cancels a drag.
#[test]
fn the_refine_tool_divides_triangles() {
    for name in ["gingerbread", "flag"] {
        let mut window = open(name);
        let triangles = |window: &Window| {
            let now = window.state().snapshot();
            now.triangles.len() + now.membranes.iter().map(|membrane| membrane.mesh.triangles().len()).sum::<usize>()
        };
        let before = triangles(&window);
        click(&mut window, "Tool");
        click(&mut window, "Refine");
        let middle = stage(&window).center();
        click_at(&mut window, middle);
        let once = triangles(&window);
        assert!(once >= before + 3 && once < before + 30, "{name}: {once} of {before}, {:?}", window.state().notice());
        let way = [middle - vec2(30.0, 0.0), middle, middle + vec2(30.0, 10.0), middle + vec2(60.0, 10.0)];
        drag(&mut window, &way, Modifiers::NONE);
        let dragged = triangles(&window);
        assert!(dragged > once + 6, "{name}: {dragged} of {once}");
        assert!(window.state().snapshot().pins.len() < 60, "{name}: it does not pin");
        press_with(&mut window, Modifiers::COMMAND, Key::Z);
        assert_eq!(triangles(&window), once, "{name}");
        // Escape in the middle of a drag.
        button(&window, middle, true);
        window.run_steps(1);
        window.event(Event::PointerMoved(middle + vec2(50.0, 0.0)));
        window.run_steps(2);
        press(&mut window, Key::Escape);
        button(&window, middle, false);
        window.run_steps(2);
        assert_eq!(triangles(&window), once, "{name}: it was cancelled");
    }
}

/// The button divides where the stress has its error, tells what changed, and another takes the original mesh.
#[test]
fn a_button_refines_by_error() {
    let mut window = open("cantilever");
    let triangles = |window: &Window| window.state().snapshot().triangles.len();
    let before = triangles(&window);
    click_in_panel(&mut window, "Refine by error");
    assert_eq!(triangles(&window), before);
    assert!(window.state().notice().is_some_and(|notice| notice.contains("zero in every triangle")), "it is at rest");
    press(&mut window, Key::M);
    window.run_steps(30);
    press(&mut window, Key::Space);
    click_in_panel(&mut window, "Refine by error");
    let refined = triangles(&window);
    assert!(refined > before && refined < 4 * before, "{refined} of {before}");
    assert!(window.state().sandbox().simulation().state().time > 0.0, "time goes on");
    assert!(window.query_by_label_contains("triangles became").is_some());
    click(&mut window, "More colours");
    click(&mut window, "Stress error");
    window.run_steps(3);
    assert!(window.query_by_label_contains("Stress error, estimated").is_some());
    click_in_panel(&mut window, "Remove refinement");
    assert_eq!(triangles(&window), before);
}

/// A click places a note, on a vertex with which it moves, or at a point. Its text is typed at once, and each note is one change to undo.
#[test]
fn notes_are_placed_typed_and_removed() {
    for name in ["gingerbread", "toronto_cloth"] {
        let mut window = open(name);
        let notes = |window: &Window| window.state().snapshot().level.notes.clone();
        let count = window.state().snapshot().vertex_count();
        let middle = stage(&window).center();
        click(&mut window, "Tool");
        click(&mut window, "Note");
        click_at(&mut window, middle);
        assert_eq!(notes(&window).len(), 1, "{name}");
        press_with(&mut window, Modifiers::COMMAND, Key::A);
        window.event(Event::Text("it bends here".to_owned()));
        window.run_steps(3);
        press(&mut window, Key::Enter);
        let [note] = &notes(&window)[..] else { unreachable!("there is one") };
        assert_eq!(note.text, "it bends here", "{name}");
        let vertices = window.state().snapshot().note_vertices.clone();
        assert!(vertices[0].is_none_or(|vertex| vertex < count), "{name}: {vertices:?}");
        // The hand is back: a click pins, and places no other note.
        click_at(&mut window, middle);
        assert_eq!(notes(&window).len(), 1, "{name}");
        let pins = window.state().snapshot().pins.len();
        press_with(&mut window, Modifiers::COMMAND, Key::Z);
        assert_ne!(window.state().snapshot().pins.len(), pins);
        press_with(&mut window, Modifiers::COMMAND, Key::Z);
        press_with(&mut window, Modifiers::COMMAND, Key::Z);
        assert!(notes(&window).is_empty(), "{name}: the text, then the note are undone");
        press_with(&mut window, Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
        assert_eq!(notes(&window).len(), 1);
        click_in_panel(&mut window, "Remove note 1");
        assert!(notes(&window).is_empty(), "{name}");
    }
}

/// A vertex is dragged along a path, which is an effect of the level then: the scene runs, and the vertex goes the same way.
#[test]
fn a_vertex_is_told_to_move_along_a_drag() {
    for name in ["gingerbread", "toronto_cloth"] {
        let mut window = open(name);
        let effects = |window: &Window| window.state().snapshot().level.effects.len();
        let before = effects(&window);
        click(&mut window, "Tool");
        click(&mut window, "Move along a path");
        let middle = stage(&window).center();
        let way: Vec<_> = (0..20_u8).map(|i| middle + vec2(3.0 * f32::from(i), -2.0 * f32::from(i))).collect();
        drag(&mut window, &way, Modifiers::NONE);
        assert_eq!(effects(&window), before + 1, "{name}: {:?}", window.state().notice());
        let held: Vec<_> = window.state().sandbox().simulation().scene().held().collect();
        assert!(!held.is_empty(), "{name}");
        let place = |window: &Window| window.state().snapshot().position(held[0] as usize).unwrap();
        let start = place(&window);
        press(&mut window, Key::Space);
        window.run_steps(40);
        let moved: f64 = place(&window).iter().zip(start).map(|(now, start)| (now - start).powi(2)).sum();
        assert!(moved.sqrt() > 0.02, "{name}: moved by {} m", moved.sqrt());
        press_with(&mut window, Modifiers::COMMAND, Key::Z);
        assert_eq!(effects(&window), before, "{name}");
    }
}

/// Notes belong to the document alone: a multistep scheme goes on as if there were none, and a recorded end stays.
#[test]
fn notes_change_nothing_else() {
    let mut window = in_mode("gingerbread", Mode::Simulate);
    press(&mut window, Key::Space);
    window.run_steps(5);
    let simulation = |window: &Window| window.state().sandbox().simulation().restart();
    let before = simulation(&window);
    click(&mut window, "Tool");
    click(&mut window, "Note");
    let middle = stage(&window).center();
    click_at(&mut window, middle);
    assert_eq!(window.state().snapshot().level.notes.len(), 1);
    assert_eq!(simulation(&window), before);
}

/// Bodies are moved, scaled and turned by hand; each is one change to undo, and pinned vertices stay pinned.
#[test]
fn bodies_are_moved_scaled_and_turned_by_handles() {
    let mut window = open("gingerbread");
    let head = on_screen(&window, vertex(&window, 0));
    click_at(&mut window, head);
    let pinned = window.state().snapshot().pins.clone();
    assert_eq!(*pinned, [0]);
    click(&mut window, "Tool");
    click(&mut window, "Arrange");
    let place = |window: &Window| window.state().snapshot().level.bodies[0].place;
    let frame = |window: &Window| {
        let points =
            (0..window.state().snapshot().vertex_count()).map(|number| on_screen(window, vertex(window, number)));
        eframe::egui::Rect::from_points(&points.collect::<Vec<_>>())
    };
    let (before, first) = (frame(&window), place(&window));
    let chest = before.center();
    drag(&mut window, &[chest, chest + vec2(10.0, 5.0), chest + vec2(40.0, 20.0)], Modifiers::NONE);
    let moved = frame(&window).center() - chest;
    assert!((moved - vec2(40.0, 20.0)).length() < 1.5, "{moved:?}");
    // It stays chosen, with its handles. A corner half as far from the centre halves it.
    let now = frame(&window);
    let corner = now.right_bottom();
    let half = now.center() + (corner - now.center()) * 0.5;
    drag(&mut window, &[corner, corner + (half - corner) * 0.5, half], Modifiers::NONE);
    assert!((place(&window).scale.get() - 0.5).abs() < 0.02, "{:?}", place(&window));
    assert!((frame(&window).center() - now.center()).length() < 2.0, "about its centre");
    // A quarter turn, in steps of 15 degrees with Shift.
    let now = frame(&window);
    let handle = pos2(now.center().x, now.top() - 26.0);
    let aside = now.center() + vec2(now.center().y - handle.y, 6.0);
    drag(&mut window, &[handle, handle + vec2(30.0, 10.0), aside], Modifiers::SHIFT);
    assert!((place(&window).turn.get() + 90.0).abs() < 1e-9, "{:?}", place(&window));
    let turned = frame(&window);
    assert!((turned.center() - now.center()).length() < 3.0 && turned.width() > turned.height(), "{turned:?} {now:?}");
    assert_eq!(*window.state().snapshot().pins, [0], "the same vertex is pinned");
    for _ in 0..3 {
        press_with(&mut window, Modifiers::COMMAND, Key::Z);
    }
    assert_eq!(place(&window), first, "three changes");
    assert_eq!(*window.state().snapshot().pins, *pinned);
    // A click beside it takes the handles away, and then a drag beside it does nothing.
    click_at(&mut window, pos2(before.left() - 40.0, before.center().y));
    let corner = frame(&window).right_bottom();
    drag(&mut window, &[corner, corner + vec2(30.0, 30.0)], Modifiers::NONE);
    assert_eq!(place(&window), first);
    press(&mut window, Key::Escape);
    // Exact numbers, and a copy.
    widget(&window, Role::Button, "Copy this body").scroll_to_me();
    window.run_steps(30);
    click(&mut window, "Copy this body");
    let bodies = &window.state().snapshot().level.bodies;
    assert_eq!(bodies.len(), 2);
    assert!(bodies[1].place.offset.get()[0] > 0.5 && bodies[1].name != bodies[0].name);
    assert_eq!(window.state().snapshot().pins.len(), 2, "the copy is pinned like it");
    // A click on a body with the tool chooses it in the panel too.
    let copy = bodies[1].name.clone();
    click(&mut window, "Tool");
    click(&mut window, "Arrange");
    let first = on_screen(&window, vertex(&window, 0)) + vec2(0.0, 6.0);
    click_at(&mut window, first);
    widget(&window, Role::Button, "Remove this body").scroll_to_me();
    window.run_steps(30);
    click(&mut window, "Remove this body");
    assert_eq!(window.state().snapshot().level.bodies.iter().map(|body| &body.name).collect::<Vec<_>>(), [&copy]);
}

/// Obstacles are arranged as bodies are; the scene goes on. What is not shown cannot be chosen.
#[test]
fn obstacles_are_arranged_by_handles_and_numbers() {
    let mut window = open("jelly_disk");
    let obstacles =
        |window: &Window| window.state().snapshot().level.effects.last().unwrap().effect.kind().obstacles().to_vec();
    let before = obstacles(&window);
    click(&mut window, "Tool");
    click(&mut window, "Arrange");
    let ball = on_screen(&window, [0.36, 0.36]);
    drag(&mut window, &[ball, ball + vec2(10.0, 5.0), ball + vec2(40.0, 20.0)], Modifiers::NONE);
    let moved = obstacles(&window);
    let [x, y, _] = moved[0].kind().place();
    assert!((on_screen(&window, [x, y]) - ball - vec2(40.0, 20.0)).length() < 0.5, "{moved:?}");
    assert_eq!((&moved[1..], window.state().snapshot().steps), (&before[1..], 0));
    // A corner of its frame twice as far from the centre doubles it.
    let (centre, right) = (on_screen(&window, [x, y]), on_screen(&window, [x + 0.09, y - 0.09]));
    drag(&mut window, &[right, right + (right - centre) * 0.5, right + (right - centre)], Modifiers::NONE);
    let radius = |window: &Window| match &obstacles(window)[0] {
        ObstacleKind::Ball(ball) => ball.radius.get(),
        other => panic!("{other:?}"),
    };
    assert!((radius(&window) - 0.16).abs() < 0.002, "{}", radius(&window));
    for _ in 0..2 {
        press_with(&mut window, Modifiers::COMMAND, Key::Z);
    }
    assert_eq!(obstacles(&window), before, "two changes");
    // Exact numbers, copies and removal.
    window.get_by_label("Arrange obstacles").scroll_to_me();
    window.run_steps(30);
    click(&mut window, "Arrange obstacles");
    window.run_steps(30);
    type_number(&mut window, "Ball: x", "0.3");
    assert_eq!(obstacles(&window)[0].kind().place()[0], 0.3);
    click(&mut window, "Copy Cuboid");
    let all = obstacles(&window);
    assert_eq!((all.len(), all[3].name()), (4, "Cuboid"));
    assert!(all[3].kind().place()[0] > 1.0, "beside everything: {:?}", all[3]);
    click(&mut window, "Remove Polygon");
    assert_eq!(obstacles(&window).iter().map(ObstacleKind::name).collect::<Vec<_>>(), ["Ball", "Cuboid", "Cuboid"]);
    click(&mut window, "Add an obstacle");
    click(&mut window, "Plane");
    assert_eq!(obstacles(&window).last().unwrap().name(), "Plane");
    for _ in 0..4 {
        press_with(&mut window, Modifiers::COMMAND, Key::Z);
    }
    assert_eq!(obstacles(&window), before, "one change each");
    // The scene goes on with another obstacle, and what acts in collide mode alone is not there to be chosen in simulate mode.
    press(&mut window, Key::T);
    window.run_steps(20);
    let steps = window.state().snapshot().steps;
    assert!(steps > 0);
    drag(&mut window, &[ball, ball + vec2(10.0, 5.0), ball + vec2(-20.0, -30.0)], Modifiers::NONE);
    assert!(obstacles(&window) != before && window.state().snapshot().steps >= steps);
    press_with(&mut window, Modifiers::COMMAND, Key::Z);
    press(&mut window, Key::M);
    window.run_steps(5);
    drag(&mut window, &[ball, ball + vec2(10.0, 5.0), ball + vec2(-20.0, -30.0)], Modifiers::NONE);
    assert_eq!(obstacles(&window), before);
}

/// In space the tool of the menu moves cloth too; the view stays, and the move is one change to undo. The panel copies and removes it.
#[test]
fn cloth_in_space_is_arranged_by_hand_and_copied() {
    let mut window = open("toronto_cloth");
    click(&mut window, "Tool");
    click(&mut window, "Arrange");
    let place = |window: &Window| *window.state().snapshot().level.space(0).unwrap();
    let before = place(&window);
    let middle = stage(&window).center();
    drag(&mut window, &[middle, middle + vec2(20.0, 0.0), middle + vec2(60.0, 0.0)], Modifiers::NONE);
    let once = place(&window);
    assert!(once != before && once.turn == before.turn && once.scale == before.scale, "{once:?}");
    // The view has not followed it: the same drag from where it is now moves it as far again.
    let from = middle + vec2(60.0, 0.0);
    drag(&mut window, &[from, from + vec2(20.0, 0.0), from + vec2(60.0, 0.0)], Modifiers::NONE);
    let twice = place(&window);
    for axis in 0..3 {
        let at = [before, once, twice].map(|place| place.offset.get()[axis]);
        assert!((at[2] - at[1] - (at[1] - at[0])).abs() < 0.02 * (at[1] - at[0]).abs() + 1e-3, "{axis}: {at:?}");
    }
    for _ in 0..2 {
        press_with(&mut window, Modifiers::COMMAND, Key::Z);
    }
    assert_eq!(place(&window), before);
    click_in_panel(&mut window, "Copy this membrane");
    assert_eq!(window.state().snapshot().level.membranes.len(), 2);
    click_in_panel(&mut window, "Remove this membrane");
    let left: Vec<_> = window.state().snapshot().level.membranes.iter().map(|one| one.space).collect();
    assert_eq!(left, [before], "the copy is chosen, and removed");
}

/// An obstacle that moves is gripped where it is seen at the start, and moves along.
#[test]
fn a_moving_obstacle_is_arranged_where_it_is_seen() {
    let mut window = open("press");
    let plate = |window: &Window| {
        let effects = &window.state().snapshot().level.effects;
        let all = effects.iter().flat_map(|effect| effect.effect.kind().obstacles());
        all.map(|kind| kind.kind().place()).next().unwrap()
    };
    let before = plate(&window);
    click(&mut window, "Tool");
    click(&mut window, "Arrange");
    // It swings from 0.09 m on the left of its place on.
    let seen = on_screen(&window, [before[0] - 0.09, 0.3]);
    drag(&mut window, &[seen, seen + vec2(-5.0, 5.0), seen + vec2(-20.0, 30.0)], Modifiers::NONE);
    let after = plate(&window);
    let moved = on_screen(&window, [after[0], after[1]]) - on_screen(&window, [before[0], before[1]]);
    assert!((moved - vec2(-20.0, 30.0)).length() < 0.5, "{moved:?}");
}
