//! Tests of pointer input on the stage, frame by frame.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a failing test should panic")]

use super::{Canvas, Options, Tool, camera};
use crate::{
    app::draw::space::{Orbit, SpaceCamera},
    command::{Command, Mode},
    files,
    level::SpacePlace,
    levels,
    meshes::NoFiles,
    sandbox::Sandbox,
    snapshot::{Field, Snapshot},
};
use eframe::egui::{Event, Key, Modifiers, PointerButton, Pos2, Rect, pos2, vec2};
use egui_kittest::{Harness, kittest::Queryable as _};

/// A stage with its snapshot, options and commands.
struct Bench {
    canvas: Canvas,
    snapshot: Snapshot,
    options: Options,
    commands: Vec<Command>,
}

/// A level in a mode, paused.
fn seen(name: &str, mode: Mode) -> Snapshot {
    let level = files::parse(levels::built_in(name).unwrap(), name).unwrap();
    let mut sandbox = Sandbox::new(level, Box::new(NoFiles)).unwrap();
    sandbox.apply(Command::SetMode(mode)).unwrap();
    sandbox.apply(Command::SetRunning(false)).unwrap();
    let mut snapshot = Snapshot::default();
    sandbox.snapshot(Field::VonMises, &mut snapshot);
    snapshot
}

fn bench(mode: Mode) -> Harness<'static, Bench> {
    bench_of("jelly_disk", mode)
}

fn bench_of(level: &str, mode: Mode) -> Harness<'static, Bench> {
    let snapshot = seen(level, mode);
    let options = Options { field: Field::VonMises, wireframe: true, vertices: true, ..Options::default() };
    let bench = Bench { canvas: Canvas::default(), snapshot, options, commands: Vec::new() };
    let mut harness = Harness::builder().with_size(vec2(600.0, 600.0)).build_ui_state(
        |ui, bench: &mut Bench| bench.canvas.show(ui, &bench.snapshot, &bench.options, &mut bench.commands),
        bench,
    );
    harness.run_steps(2);
    harness
}

fn rect(harness: &Harness<'_, Bench>) -> Rect {
    harness.get_by_label("Stage").rect()
}

/// Point near a vertex.
fn beside(harness: &Harness<'_, Bench>, vertex: usize) -> Pos2 {
    let snapshot = &harness.state().snapshot;
    let point = [snapshot.positions[2 * vertex], snapshot.positions[2 * vertex + 1]];
    camera(snapshot, rect(harness)).screen_from_world(point) + vec2(0.5, 0.5)
}

fn world(harness: &Harness<'_, Bench>, at: Pos2) -> [f64; 3] {
    let [x, y] = camera(&harness.state().snapshot, rect(harness)).world_from_screen(at);
    [x, y, 0.0]
}

fn button(pos: Pos2, pressed: bool) -> Event {
    Event::PointerButton { pos, button: PointerButton::Primary, pressed, modifiers: Modifiers::NONE }
}

/// Plays events, each in a frame of its own, and takes the commands.
fn play(harness: &mut Harness<'_, Bench>, events: impl IntoIterator<Item = Event>) -> Vec<Command> {
    for event in events {
        harness.event(event);
        harness.run_steps(1);
    }
    std::mem::take(&mut harness.state_mut().commands)
}

/// Plays events in a single frame.
fn at_once(harness: &mut Harness<'_, Bench>, events: impl IntoIterator<Item = Event>) -> Vec<Command> {
    harness.input_mut().events.extend(events);
    harness.run_steps(1);
    play(harness, [])
}

#[test]
fn a_drag_grabs_at_once_where_it_began_and_ends_once() {
    let mut harness = bench(Mode::Simulate);
    let (from, to) = (beside(&harness, 40), pos2(20.0, 30.0));
    let asked = play(&mut harness, [Event::PointerMoved(from), button(from, true)]);
    assert_eq!(asked, [Command::Grab(40, world(&harness, from))]);
    let asked = play(&mut harness, [Event::PointerMoved(to), Event::PointerMoved(to)]);
    assert_eq!(asked, [Command::Pull(world(&harness, to))], "a pointer that holds still asks for nothing new");
    assert_eq!(play(&mut harness, [button(to, false), Event::PointerMoved(from)]), [Command::Release]);
}

#[test]
fn a_drag_within_one_frame_grabs_where_it_began() {
    let mut harness = bench(Mode::Collide);
    let (from, to) = (beside(&harness, 7), beside(&harness, 90));
    play(&mut harness, [Event::PointerMoved(from)]);
    let asked = at_once(&mut harness, [button(from, true), Event::PointerMoved(to)]);
    assert_eq!(asked, [Command::Grab(7, world(&harness, to))]);
}

fn typed(key: Key) -> [Event; 2] {
    [true, false].map(|pressed| Event::Key {
        key,
        physical_key: None,
        pressed,
        repeat: false,
        modifiers: Modifiers::NONE,
    })
}

#[test]
fn keys_push_and_burst_what_is_under_the_pointer() {
    let mut harness = bench(Mode::Simulate);
    let at = beside(&harness, 40);
    play(&mut harness, [Event::PointerMoved(at)]);
    let impulse = |harness: &mut Harness<'_, Bench>, key| match play(harness, typed(key))[..] {
        [Command::Impulse(impulse)] => impulse,
        ref other => panic!("{other:?}"),
    };
    let place = |harness: &Harness<'_, Bench>, axis: usize| harness.state().snapshot.positions[80 + axis];
    let burst = impulse(&mut harness, Key::X);
    assert_eq!(burst.centre, [place(&harness, 0), place(&harness, 1), 0.0]);
    assert!(burst.burst > 0.0 && burst.push == [0.0; 3]);
    for (key, way) in [
        (Key::ArrowLeft, [-1.0, 0.0]),
        (Key::ArrowRight, [1.0, 0.0]),
        (Key::ArrowUp, [0.0, 1.0]),
        (Key::ArrowDown, [0.0, -1.0]),
    ] {
        let push = impulse(&mut harness, key);
        let speed = push.push[0].hypot(push.push[1]);
        assert!(push.burst == 0.0 && speed > 0.0, "{push:?}");
        assert!((0..2).all(|axis| (push.push[axis] / speed - way[axis]).abs() < 1e-4), "{key:?} {push:?}");
    }
    // Neither away from the body nor in edit mode.
    play(&mut harness, [Event::PointerMoved(pos2(3.0, 3.0))]);
    assert_eq!(play(&mut harness, typed(Key::X)), []);
    play(&mut harness, [Event::PointerMoved(at)]);
    harness.state_mut().snapshot.mode = Mode::Edit;
    assert_eq!(play(&mut harness, typed(Key::X)), []);
}

#[test]
fn losing_the_window_lets_go_until_the_next_press() {
    let mut harness = bench(Mode::Simulate);
    let from = beside(&harness, 12);
    play(&mut harness, [Event::PointerMoved(from), button(from, true)]);
    assert_eq!(play(&mut harness, [Event::WindowFocused(false)]), [Command::Release]);
    assert_eq!(play(&mut harness, [Event::PointerMoved(pos2(50.0, 50.0)), button(from, false)]), []);
    assert_eq!(play(&mut harness, [button(from, true)]).len(), 1);
}

#[test]
fn another_body_or_edit_mode_ends_a_drag() {
    let ends: [fn(&mut Snapshot); 2] =
        [|snapshot| snapshot.mode = Mode::Edit, |snapshot| *snapshot = seen("gingerbread", Mode::Simulate)];
    for end in ends {
        let mut harness = bench(Mode::Simulate);
        let from = beside(&harness, 12);
        play(&mut harness, [Event::PointerMoved(from), button(from, true)]);
        end(&mut harness.state_mut().snapshot);
        assert_eq!(play(&mut harness, [Event::PointerMoved(from + vec2(9.0, 0.0))]), [Command::Release]);
        assert_eq!(play(&mut harness, [Event::PointerMoved(from)]), []);
    }
}

#[test]
fn a_body_that_starts_over_is_grabbed_again_where_it_was() {
    let mut harness = bench(Mode::Simulate);
    let from = beside(&harness, 12);
    let target = world(&harness, from);
    play(&mut harness, [Event::PointerMoved(from), button(from, true)]);
    harness.state_mut().snapshot.generation += 1;
    assert_eq!(play(&mut harness, [Event::PointerMoved(from)]), [Command::Grab(12, target)]);
    assert_eq!(play(&mut harness, [button(from, false)]), [Command::Release]);
}

#[test]
fn a_click_pins_even_within_one_frame_but_a_drag_does_not() {
    let mut harness = bench(Mode::Edit);
    let from = beside(&harness, 33);
    let click = [Event::PointerMoved(from), button(from, true), button(from, false)];
    assert_eq!(play(&mut harness, click.clone()), [Command::TogglePin(33)]);
    assert_eq!(at_once(&mut harness, click), [Command::TogglePin(33)]);
    let away = from + vec2(80.0, 0.0);
    assert_eq!(play(&mut harness, [button(from, true), Event::PointerMoved(away), button(away, false)]), []);
}

#[test]
fn draws_a_scene_that_is_empty_or_has_exploded() {
    let mut harness = bench(Mode::Simulate);
    harness.state_mut().snapshot.positions.iter_mut().enumerate().for_each(|(i, x)| *x *= 1e200 * (i % 3) as f64);
    harness.run_steps(2);
    let old = &mut harness.state_mut().snapshot;
    *old = Snapshot { generation: old.generation + 1, ..Snapshot::default() };
    harness.run_steps(2);
    let at = rect(&harness).center();
    assert_eq!(play(&mut harness, [Event::PointerMoved(at), button(at, true), button(at, false)]), []);
}

/// Camera of a scene in space, as it opens or after a button.
fn space(harness: &Harness<'_, Bench>, orbit: Orbit) -> SpaceCamera {
    SpaceCamera::new(orbit, rect(harness))
}

#[test]
fn a_vertex_in_space_is_pinned_and_pulled_where_it_is_seen() {
    for level in ["mit_cloth", "toronto_cloth"] {
        for vertex in [0, 5, 20] {
            let mut harness = bench_of(level, Mode::Edit);
            let orbit = Orbit::opening(&harness.state().snapshot.start);
            let (camera, place) = (space(&harness, orbit), harness.state().snapshot.position(vertex).unwrap());
            let (at, depth) = camera.seen(place);
            let click = [Event::PointerMoved(at), button(at, true), button(at, false)];
            assert_eq!(play(&mut harness, click), [Command::TogglePin(vertex)], "{level}");
            let mut harness = bench_of(level, Mode::Simulate);
            let asked = play(&mut harness, [Event::PointerMoved(at), button(at, true)]);
            assert_eq!(asked, [Command::Grab(vertex, camera.at_depth(at, depth))], "{level}");
            let away = at + vec2(40.0, -30.0);
            let asked = play(&mut harness, [Event::PointerMoved(away)]);
            let pulled = |command: &Command| if let Command::Pull(to) = command { Some(*to) } else { None };
            let to = asked.iter().find_map(pulled).unwrap();
            let (seen, deep) = camera.seen(to);
            assert!(seen.distance(away) < 0.01 && (deep / depth - 1.0).abs() < 1e-6, "in the plane that faces the eye");
        }
    }
}

#[test]
fn the_right_button_turns_the_view_and_asks_for_nothing() {
    let mut harness = bench_of("mit_cloth", Mode::Edit);
    let vertex = 7;
    let place = harness.state().snapshot.position(vertex).unwrap();
    let button_two = |pos: Pos2, pressed: bool| Event::PointerButton {
        pos,
        button: PointerButton::Secondary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    let middle = rect(&harness).center();
    let to = middle + vec2(50.0, -30.0);
    let drag = [Event::PointerMoved(middle), button_two(middle, true), Event::PointerMoved(to), button_two(to, false)];
    assert_eq!(play(&mut harness, drag), []);
    let (_, orbit) = harness.state().canvas.viewpoint().orbit.unwrap();
    assert!(orbit.yaw < Orbit::ASLANT[0] - 0.1 && orbit.pitch < Orbit::ASLANT[1] - 0.05, "{orbit:?}");
    let (at, _) = SpaceCamera::new(orbit, rect(&harness)).seen(place);
    let click = [Event::PointerMoved(at), button(at, true), button(at, false)];
    assert_eq!(play(&mut harness, click), [Command::TogglePin(vertex)]);
    for (name, angles) in [("Front", [0.0, 0.0]), ("Top", [0.0, std::f64::consts::FRAC_PI_2])] {
        harness.get_by_label(name).click();
        harness.run_steps(3);
        let orbit = Orbit::around(&harness.state().snapshot.positions, angles);
        let (at, _) = space(&harness, orbit).seen(place);
        let click = [Event::PointerMoved(at), button(at, true), button(at, false)];
        assert_eq!(play(&mut harness, click), [Command::TogglePin(vertex)], "{name}");
    }
}

/// The only command for the place of a net or membrane, before the end of the gesture.
fn placed(asked: &[Command]) -> SpacePlace {
    match asked {
        [Command::SetSpacePlace(0, place), Command::EndGesture] => *place,
        other => panic!("{other:?}"),
    }
}

/// Presses at one point of the screen, and lets go at another.
fn dragged(from: Pos2, to: Pos2) -> [Event; 5] {
    let way = [from, from.lerp(to, 0.5), to].map(Event::PointerMoved);
    let [start, middle, end] = way;
    [start, button(from, true), middle, end, button(to, false)]
}

/// In space a net or membrane follows the pointer along the screen and along an axis, is scaled by a corner, and turned about the axis that points to the eye.
#[test]
fn cloth_in_space_is_moved_scaled_and_turned_by_handles() {
    for (level, vertex) in [("mit_cloth", 27), ("toronto_cloth", 200)] {
        let opened = || {
            let mut harness = bench_of(level, Mode::Edit);
            harness.state_mut().options.tool = Tool::Arrange;
            harness.run_steps(2);
            harness
        };
        let mut harness = opened();
        let start = harness.state().snapshot.start.clone();
        let camera = space(&harness, Orbit::opening(&start));
        let now = *harness.state().snapshot.level.space(0).unwrap();
        let on_cloth = camera.seen(harness.state().snapshot.position(vertex).unwrap()).0;
        let [least, most] = [f64::min, f64::max].map(|of| {
            let all = start.as_chunks::<3>().0.iter();
            all.copied().reduce(|a, b| [0, 1, 2].map(|axis| of(a[axis], b[axis]))).unwrap()
        });
        let (centre, half) =
            ([0, 1, 2].map(|i| 0.5 * (least[i] + most[i])), [0, 1, 2].map(|i| 0.5 * (most[i] - least[i])));
        let middle = camera.seen(centre).0;
        // A drag along the screen moves the centre with the pointer, in the plane that faces the eye.
        let place = placed(&play(&mut harness, dragged(on_cloth, on_cloth + vec2(40.0, -25.0))));
        let moved = |place: SpacePlace| [0, 1, 2].map(|axis| place.offset.get()[axis] - now.offset.get()[axis]);
        let to = camera.seen([0, 1, 2].map(|axis| centre[axis] + moved(place)[axis]));
        assert!(to.0.distance(middle + vec2(40.0, -25.0)) < 0.05, "{level}: {to:?} {middle:?}");
        assert!((to.1 / camera.seen(centre).1 - 1.0).abs() < 1e-6 && place.turn == now.turn, "{level}");
        // The tip of an arrow moves along its axis alone.
        let longest = half.into_iter().fold(0.0, f64::max);
        for axis in 0..3 {
            let (mut tip, mut along) = (centre, centre);
            tip[axis] += half[axis] + 0.7 * longest;
            along[axis] += 0.25 * longest;
            let (tip, by) = (camera.seen(tip).0, camera.seen(along).0 - middle);
            let place = placed(&play(&mut harness, dragged(tip, tip + by)));
            let mut wanted = [0.0; 3];
            wanted[axis] = 0.25 * longest;
            let all = moved(place).iter().zip(wanted).all(|(a, b)| (a - b).abs() < 0.06 * longest);
            assert!(
                all && (0..3).all(|other| other == axis || moved(place)[other] == 0.0),
                "{level} {axis}: {place:?}"
            );
        }
        // A corner of the frame twice as far from the centre doubles it, about the centre.
        let corners: Vec<_> = (0..8)
            .map(|bits| camera.seen([0, 1, 2].map(|i| if bits >> i & 1 == 0 { least[i] } else { most[i] })).0)
            .collect();
        let corner = Rect::from_points(&corners).left_bottom();
        let place = placed(&play(&mut harness, dragged(corner, middle + 1.3 * (corner - middle))));
        assert!((place.scale.get() - 1.3).abs() < 1e-4, "{level}: {place:?}");
        let centre_of = |place: SpacePlace| {
            let local = [0, 1, 2].map(|axis| centre[axis] - now.offset.get()[axis]);
            [0, 1, 2].map(|axis| place.offset.get()[axis] + place.scale.get() * local[axis])
        };
        assert!(centre_of(place).iter().zip(centre).all(|(a, b)| (a - b).abs() < 1e-9 * longest.max(1.0)), "{level}");
        // The handle above, dragged to the right by a quarter, turns clockwise about z, which points to the eye.
        let frame = Rect::from_points(&corners);
        let above = |axis: usize| {
            let mut tip = centre;
            tip[axis] += half[axis] + 0.7 * longest;
            camera.seen(tip).0.y
        };
        let handle = pos2(frame.center().x, (0..3).map(above).fold(frame.top(), f32::min) - 26.0);
        let aside = middle - (handle - middle).rot90();
        let place = placed(&play(&mut harness, dragged(handle, aside)));
        let turned = |place: SpacePlace, point: [f64; 2]| place.turned(point);
        for point in [[1.0, 0.0], [0.0, 1.0]] {
            let ([x, y, z], after) = (turned(now, point), turned(place, point));
            let wanted = [y, -x, z];
            assert!(after.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-3), "{level}: {after:?} {wanted:?}");
        }
    }
}

/// Of what is behind each other the nearest is chosen; an obstacle follows the pointer too, and is not turned.
#[test]
fn an_obstacle_in_space_is_moved_by_hand() {
    let mut harness = bench_of("mit_sphere", Mode::Edit);
    harness.state_mut().options.tool = Tool::Arrange;
    harness.run_steps(2);
    let camera = space(&harness, Orbit::opening(&harness.state().snapshot.start));
    // The sphere swings, and begins at the end of its way.
    let seen = camera.seen([0.7, -0.2, 2.1]).0;
    let asked = play(&mut harness, dragged(seen, seen + vec2(30.0, 10.0)));
    let [Command::SetEffect(2, effect), Command::EndGesture] = &asked[..] else { panic!("{asked:?}") };
    let ([x, y, z], from) = (effect.effect.kind().obstacles()[0].kind().place(), [0.7, -0.2, 1.2]);
    let by = camera.seen([x, y, z + 0.9]).0 - camera.seen([from[0], from[1], from[2] + 0.9]).0;
    assert!((by - vec2(30.0, 10.0)).length() < 0.1, "{by:?}");
}
