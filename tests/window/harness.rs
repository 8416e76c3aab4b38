//! The window under test, and the hands that use it.

use eframe::egui::{
    DroppedFile, Event, Key, Modifiers, OutputCommand, PointerButton, Pos2, Rect, Role, Vec2, ViewportCommand,
    ViewportEvent, ViewportId,
};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use egui_kittest::{Harness, Node};
use gingerbread::app::App;
use gingerbread::command::Mode;
use gingerbread::files::Disk;
use gingerbread::level::Level;
use gingerbread::materials::Lame;
use gingerbread::{files, levels};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

pub type Window = Harness<'static, App>;

pub fn level(name: &str) -> Level {
    files::parse(levels::built_in(name).unwrap(), name).unwrap()
}

pub fn open_level(level: Level, width: f32, height: f32) -> Window {
    let mut window = Harness::builder().with_size([width, height]).with_step_dt(1.0 / 60.0).build_eframe(move |cc| {
        App::with_level(&cc.egui_ctx, level, Box::new(Disk)).unwrap().unhurried().without_dialogs()
    });
    window.run_steps(3);
    window
}

pub fn open(name: &str) -> Window {
    open_level(level(name), 1280.0, 800.0)
}

pub fn press(window: &mut Window, key: Key) {
    press_with(window, Modifiers::NONE, key);
}

pub fn press_with(window: &mut Window, modifiers: Modifiers, key: Key) {
    window.key_press_modifiers(modifiers, key);
    window.run_steps(3);
}

/// Clicks what has a label in a panel that may have to be scrolled.
pub fn click_in_panel(window: &mut Window, label: &str) {
    window.get_by_label(label).scroll_to_me();
    window.run_steps(30);
    click(window, label);
}

pub fn click(window: &mut Window, label: &str) {
    window.get_by_label(label).click();
    window.run_steps(3);
}

/// Answers the question for a path.
pub fn type_path(window: &mut Window, path: &Path, button: &str) {
    press_with(window, Modifiers::COMMAND, Key::A);
    window.event(Event::Text(path.display().to_string()));
    window.run_steps(2);
    click(window, button);
    window.run_steps(3);
}

/// Chooses a level in the picker, by its name.
pub fn choose(window: &mut Window, name: &str) {
    click(window, "Level");
    window.event(Event::Text(name.to_owned()));
    window.run_steps(2);
    click(window, name);
}

pub fn stage(window: &Window) -> Rect {
    window.get_by_label("Stage").rect()
}

pub fn vertex(window: &Window, number: usize) -> [f64; 2] {
    let positions = &window.state().snapshot().positions;
    [positions[2 * number], positions[2 * number + 1]]
}

pub fn on_screen(window: &Window, point: [f64; 2]) -> Pos2 {
    window.state().on_screen(stage(window), point)
}

pub fn button(window: &Window, pos: Pos2, pressed: bool) {
    window.event(Event::PointerMoved(pos));
    window.event(Event::PointerButton { pos, button: PointerButton::Primary, pressed, modifiers: Modifiers::NONE });
}

pub fn click_at(window: &mut Window, pos: Pos2) {
    window.hover_at(pos);
    window.run_steps(1);
    button(window, pos, true);
    window.run_steps(1);
    button(window, pos, false);
    window.run_steps(3);
}

/// What a click copies in one of the next frames.
pub fn copied(window: &mut Window) -> String {
    for _ in 0..4 {
        window.run_steps(1);
        let commands = &window.output().platform_output.commands;
        let text = commands.iter().find_map(|command| match command {
            OutputCommand::CopyText(text) => Some(text.clone()),
            _ => None,
        });
        if let Some(text) = text {
            return text;
        }
    }
    panic!("nothing was copied: {:?}", window.state().notice());
}

/// Moves the pointer over the stage from place to place while the button is held.
pub fn drag(window: &mut Window, places: &[Pos2], modifiers: Modifiers) {
    window.event(Event::ModifiersChanged(modifiers));
    window.hover_at(places[0]);
    window.run_steps(1);
    let press = |pos, pressed| Event::PointerButton { pos, button: PointerButton::Primary, pressed, modifiers };
    window.event(press(places[0], true));
    window.run_steps(1);
    for place in &places[1..] {
        window.event(Event::PointerMoved(*place));
        window.run_steps(1);
    }
    window.event(press(places[places.len() - 1], false));
    window.run_steps(2);
    window.event(Event::ModifiersChanged(Modifiers::NONE));
    window.run_steps(1);
}

/// Presses a vertex and moves the pointer away from it, by so much; returns where it is held.
pub fn pull(window: &mut Window, number: usize, by: Vec2) -> Pos2 {
    let from = on_screen(window, vertex(window, number));
    window.hover_at(from);
    window.run_steps(1);
    button(window, from, true);
    window.run_steps(1);
    window.event(Event::PointerMoved(from + by));
    window.run_steps(2);
    from + by
}

pub fn lame(window: &Window) -> Lame {
    window.state().sandbox().simulation().scene().bodies[0].elements.material().lame()
}

#[derive(Debug)]
struct Dropped(PathBuf);

impl DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

/// Drops files on the window, all at once.
pub fn drop_files(window: &mut Window, paths: &[&Path]) {
    for path in paths {
        window.input_mut().dropped_files.push(Arc::new(Dropped(path.to_path_buf())));
    }
    window.run_steps(4);
}

/// Makes the triangles that would be painted, which the harness does not: numbers that are none would end it here.
pub fn draw(window: &Window) {
    window.ctx.tessellate(window.output().shapes.clone(), 1.0);
}

/// Goes on drawing until a widget is gone, such as the button that cancels work in the background.
pub fn wait_until_gone(window: &mut Window, label: &str) {
    for _ in 0..1_000_000 {
        if window.query_by_label(label).is_none() {
            return;
        }
        window.run_steps(1);
    }
    panic!("{label} is never gone");
}

/// How long the window wants to wait before it draws again.
pub fn pause(window: &Window) -> Duration {
    window.output().viewport_output[&ViewportId::ROOT].repaint_delay
}

pub fn mode(window: &Window) -> Mode {
    window.state().snapshot().mode
}

/// The largest distance of a coordinate from the start.
pub fn moved(window: &Window) -> f64 {
    let now = window.state().snapshot();
    now.positions.iter().zip(now.start.iter()).map(|(now, start)| (now - start).abs()).fold(0.0, f64::max)
}

/// The widget of a kind with a name; a name may stand on a label, a number field and a slider.
pub fn widget<'a>(window: &'a Window, role: Role, name: &'a str) -> Node<'a> {
    let mut found = window.get_all_by_label(name).filter(|node| node.accesskit_node().role() == role);
    found.next().unwrap_or_else(|| panic!("there is no {role:?} {name:?}"))
}

pub fn click_number(window: &mut Window, name: &str) {
    widget(window, Role::SpinButton, name).click();
    window.run_steps(3);
}

/// Types into the number field of a parameter.
pub fn type_number(window: &mut Window, name: &str, text: &str) {
    click_number(window, name);
    window.event(Event::Text(text.to_owned()));
    window.run_steps(2);
    press(window, Key::Enter);
}

pub fn slide(window: &mut Window, name: &str, value: f64) {
    widget(window, Role::Slider, name).set_value_accesskit(value);
    window.run_steps(3);
}

/// Brings a new window of a level into a mode, running, with everything a little out of place.
pub fn in_mode(name: &str, mode: Mode) -> Window {
    let mut window = open(name);
    match mode {
        Mode::Edit => {}
        Mode::Simulate => press(&mut window, Key::M),
        Mode::Collide => press(&mut window, Key::T),
    }
    window.run_steps(5);
    window
}

/// Asks the window to close, and returns what it asks of its display in the next frames.
pub fn close(window: &mut Window) -> Vec<ViewportCommand> {
    let events = &mut window.input_mut().viewports.entry(ViewportId::ROOT).or_default().events;
    events.push(ViewportEvent::Close);
    asked(window)
}

/// What the window asks of its display in the next frames.
pub fn asked(window: &mut Window) -> Vec<ViewportCommand> {
    let mut all = Vec::new();
    for _ in 0..4 {
        window.run_steps(1);
        all.extend(window.output().viewport_output[&ViewportId::ROOT].commands.iter().cloned());
    }
    all
}
