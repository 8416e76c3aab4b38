//! Toolbar: level, mode, time, model, history and panels.

use super::{
    FileRequest, FilmRequest, Notice, PanelContext, Side, View, compare,
    widgets::{HEIGHT, Icon, Lit, Segment, icon_button, segmented},
};
use crate::{
    app::{
        clock::Pace,
        dialogs,
        film::FilmFormat,
        language::{tr, tr_with},
    },
    command::{Command, Mode},
    link,
    materials::Model,
    snapshot::Snapshot,
};
use eframe::egui::{
    self, Align, Atom, Button, Frame, IdSalt, Key, Layout, Margin, Panel, Popup, PopupCloseBehavior, Rect, ScrollArea,
    Shape, Stroke, TextEdit, Ui, Vec2, vec2,
};

/// Width of the six buttons on the right [points].
const LOOKS: f32 = 6.0 * HEIGHT + 5.0 * 2.0;

pub fn show(ui: &mut Ui, context: &PanelContext<'_>, view: &mut View, commands: &mut Vec<Command>, narrow: bool) {
    let frame = Frame::side_top_panel(ui.style()).inner_margin(Margin::symmetric(8, 6));
    let height = Panel::top("strip").frame(frame).show(ui, |ui| {
        ui.spacing_mut().item_spacing = vec2(2.0, 5.0);
        ui.horizontal_wrapped(|ui| {
            ui.set_min_height(HEIGHT);
            levels(ui, context, view);
            apart(ui);
            if let Some(mode) = modes(ui, context.now) {
                commands.push(Command::SetMode(mode));
            }
            apart(ui);
            time(ui, context.now, view, commands);
            if context.now.has_models() {
                if let Some(model) = models(ui, context.now) {
                    commands.push(Command::SetModel(model));
                }
                apart(ui);
            }
            history(ui, context.now, commands);
            compare::switch(ui, context, view);
            if narrow && ui.available_size_before_wrap().x < LOOKS {
                ui.end_row();
            }
            if !narrow {
                ui.add_space((ui.available_size_before_wrap().x - LOOKS).max(0.0));
            }
            looks(ui, context.now, view, commands, narrow);
        });
    });
    // A toolbar that wraps in another way is drawn whole only in the next frame.
    let height = height.response.rect.height();
    if view.strip_height != height {
        view.strip_height = height;
        ui.ctx().request_repaint();
    }
}

/// Draws a gap between groups; a narrow page, as on a phone, has a smaller one.
fn apart(ui: &mut Ui) {
    ui.add_space(if ui.ctx().content_rect().width() < 440.0 { 2.0 } else { 8.0 });
}

/// Draws the level picker with the file commands.
fn levels(ui: &mut Ui, context: &PanelContext<'_>, view: &mut View) {
    let name = if context.now.level.name.is_empty() { tr("Level") } else { &context.now.level.name };
    let shown = if context.is_unsaved { format!("• {name}") } else { name.to_owned() };
    let room_for_arrow = Atom::custom(IdSalt::new("arrow"), Vec2::splat(10.0));
    let button = Button::new((shown, room_for_arrow)).truncate().min_size(vec2(120.0, HEIGHT));
    let response = ui.scope(|ui| {
        ui.set_max_width(200.0);
        ui.add(button)
    });
    let arrow = Rect::from_center_size(response.inner.rect.right_center() - vec2(16.0, 0.0), vec2(9.0, 5.0));
    let corners = vec![arrow.left_top(), arrow.right_top(), arrow.center_bottom()];
    ui.painter().add(Shape::convex_polygon(corners, ui.visuals().text_color(), Stroke::NONE));
    let about = if context.now.level.about.is_empty() { tr("Choose a level") } else { &context.now.level.about };
    let response = response.inner.on_hover_text(about).accessible_name(tr("Level"));
    if response.clicked() {
        view.search.clear();
    }
    Popup::menu(&response).close_behavior(PopupCloseBehavior::CloseOnClickOutside).show(|ui| {
        ui.set_width(240.0);
        let field = TextEdit::singleline(&mut view.search).hint_text(tr("Search")).desired_width(f32::INFINITY);
        let field = ui.add(field).accessible_name(tr("Search levels"));
        if response.clicked() {
            field.request_focus();
        }
        let is_entered = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
        let room = ui.ctx().content_rect().height() - 236.0;
        let list = ScrollArea::vertical().max_height(room).min_scrolled_height(room).auto_shrink([false, true]);
        list.show(ui, |ui| {
            ui.with_layout(Layout::top_down_justified(Align::LEFT), |ui| {
                let mut found = context.gallery.found(&view.search).peekable();
                if found.peek().is_none() {
                    ui.weak(tr("No level has these words."));
                }
                let mut chosen = if is_entered { found.peek().map(|(index, _)| *index) } else { None };
                for (index, entry) in found {
                    let button = Button::selectable(entry.name == *name, entry.name.as_str());
                    if ui.add(button).on_hover_text(&entry.about).clicked() {
                        chosen = Some(index);
                    }
                }
                if let Some(index) = chosen {
                    view.file = Some(FileRequest::BuiltIn(index));
                    ui.close();
                }
            });
        });
        ui.separator();
        let about =
            "Difficult test cases: collapsed, inverted, overstretched and crushed bodies, and which models and methods pass them.";
        if ui.button(tr("Hard cases…")).on_hover_text(tr(about)).clicked() {
            view.hard.open = true;
            view.drawer = None;
            ui.close();
        }
        if ui.button(tr("Open…")).on_hover_text(tr("Open a level file. A file dropped on the window opens too. [Ctrl+O]")).clicked() {
            view.file = Some(FileRequest::Open);
            ui.close();
        }
        recent(ui, context, view);
        if ui.button(tr("Save…")).on_hover_text(tr("Save the level with everything as it is now. [Ctrl+S]")).clicked() {
            view.file = Some(FileRequest::Save);
            ui.close();
        }
        let about = "Save the states of the last seconds as arrays for NumPy (.npz): times, positions, velocities, energies, triangles and springs.";
        if context.now.toy.is_none() && ui.button(tr("Save recorded states…")).on_hover_text(tr(about)).clicked() {
            view.file = Some(FileRequest::RecordedStates);
            ui.close();
        }
        let about = "Copy a link to the page in a browser that opens this level at its start, with pins, sliders and view as they are now.";
        if ui.button(tr("Copy link")).on_hover_text(tr(about)).clicked() {
            view.notice = Some(copy_link(ui, context));
            ui.close();
        }
    });
}

/// Copies a link to the level. Returns what there is to say about it.
fn copy_link(ui: &Ui, context: &PanelContext<'_>) -> Notice {
    let level = &context.now.level;
    let fragment = match context.viewpoint.camera(context.now.dimension) {
        Some(camera) => link::fragment_seen_from(level, camera),
        None => link::fragment(level),
    };
    match fragment {
        Ok(fragment) => {
            let page = dialogs::page();
            let text = if page.is_empty() {
                "The link was copied from # on: put it behind the address of a page with Gingerbread."
            } else {
                "The link was copied."
            };
            ui.ctx().copy_text(page + &fragment);
            Notice::Done(text.to_owned())
        }
        Err(error) => Notice::trouble(&error),
    }
}

/// Draws the menu of the files that were used last.
fn recent(ui: &mut Ui, context: &PanelContext<'_>, view: &mut View) {
    if context.recent.is_empty() {
        return;
    }
    ui.menu_button(tr("Recent"), |ui| {
        for path in context.recent {
            let name = path.file_name().map_or_else(|| path.display().to_string(), |name| name.display().to_string());
            if ui.button(name).on_hover_text(path.display().to_string()).clicked() {
                view.file = Some(FileRequest::File(path.clone(), Vec::new()));
                ui.close();
            }
        }
    });
}

fn modes(ui: &mut Ui, now: &Snapshot) -> Option<Mode> {
    let part = |mode, text, about| Segment { text, name: text, about, on: now.mode == mode };
    let parts = [
        part(Mode::Edit, "Edit", "Nothing moves; click to pin and free vertices. [M or T]"),
        part(Mode::Simulate, "Simulate", "Time runs; drag to pull. [M]"),
        part(
            Mode::Collide,
            "Collide",
            "Time runs, also with the effects that the level has for this mode, such as gravity and walls. [T]",
        ),
    ];
    let clicked = segmented(ui, "mode", &parts, false)?;
    [Mode::Edit, Mode::Simulate, Mode::Collide].get(clicked).copied()
}

/// Draws the buttons of time: back, play, step and start over.
fn time(ui: &mut Ui, now: &Snapshot, view: &mut View, commands: &mut Vec<Command>) {
    ui.add_enabled_ui(now.rewind_length > 0.0, |ui| {
        let about = "Goes back 0.5 s in time, and pauses. [Backspace; hold it to go back further]";
        if icon_button(ui, Icon::Back, "Go back in time", about, false).clicked() {
            commands.push(Command::Rewind(0.5));
        }
    });
    let runs = now.running && now.mode != Mode::Edit;
    let (icon, name) = if runs { (Icon::Pause, "Pause") } else { (Icon::Play, "Run") };
    if icon_button(ui, icon, name, "[Space]", false).clicked() {
        commands.push(Command::SetRunning(!runs));
    }
    if icon_button(
        ui,
        Icon::Step,
        "Single step",
        "Pauses, and takes one step. [.] The comma takes the steps of 1/60 s. [,]",
        false,
    )
    .clicked()
    {
        commands.push(Command::StepOnce);
    }
    let about = "Positions and velocities go back to the start. [R while simulating]";
    if icon_button(ui, Icon::Reset, "Start over", about, false).clicked() {
        commands.push(Command::Reset);
    }
    pace(ui, view);
    apart(ui);
}

/// Draws the menu of the speed of simulated time.
fn pace(ui: &mut Ui, view: &mut View) {
    let text = |pace: Pace| format!("×\u{2009}{}", pace.label());
    let about = "Simulated time over real time: slow motion and time lapse. [Page down, Page up]";
    let button = ui.add(Button::new(text(view.pace)).min_size(vec2(44.0, HEIGHT)));
    let button = button.on_hover_text(tr(about)).accessible_name(format!("Speed of time: {}", view.pace.label()));
    Popup::menu(&button).show(|ui| {
        for pace in Pace::all() {
            if ui.add(Button::selectable(pace == view.pace, text(pace))).clicked() {
                view.pace = pace;
            }
        }
    });
}

fn models(ui: &mut Ui, now: &Snapshot) -> Option<Model> {
    let about =
        |model: &Model| format!("{}\nAll bodies use this model and start over. [{}]", model.formula(), model.letter());
    let abouts: Vec<_> = Model::ALL.iter().map(about).collect();
    let parts: Vec<_> = Model::ALL
        .iter()
        .zip(&abouts)
        .map(|(model, about)| Segment {
            text: model.letter(),
            name: model.title(),
            about,
            on: now.models().all(|own| own == Some(*model)),
        })
        .collect();
    let clicked = segmented(ui, "model", &parts, false)?;
    Model::ALL.get(clicked).copied()
}

fn history(ui: &mut Ui, now: &Snapshot, commands: &mut Vec<Command>) {
    let lit = |possible| if possible { Lit::Off } else { Lit::Disabled };
    let about = "Pins, sliders, model, level. [Ctrl+Z]";
    if icon_button(ui, Icon::Undo, "Undo", about, lit(now.can_undo)).clicked() {
        commands.push(Command::Undo);
    }
    if icon_button(ui, Icon::Redo, "Redo", "[Ctrl+Y or Ctrl+Shift+Z]", lit(now.can_redo)).clicked() {
        commands.push(Command::Redo);
    }
    apart(ui);
}

/// Draws the button of pictures and films, with its menu; while a film is recorded it ends it.
fn camera(ui: &mut Ui, now: &Snapshot, view: &mut View, commands: &mut Vec<Command>) {
    let records = view.film.is_some_and(|film| film.records);
    if records {
        if icon_button(ui, Icon::Camera, "End the film", "[Shift+V]", true).clicked() {
            view.film_requests.push(FilmRequest::Stop);
        }
        return;
    }
    let button =
        icon_button(ui, Icon::Camera, "Pictures and films", "Of the stage, without panels and buttons.", false);
    Popup::menu(&button).show(|ui| {
        if ui.button(tr("Picture (PNG)")).on_hover_text(tr("Twice as fine as on the screen. [I]")).clicked() {
            view.takes_picture = true;
        }
        for (place, format) in FilmFormat::offered().enumerate() {
            let [name, help] = format.titles();
            let key = if place == 0 { " [Shift+V]" } else { "" };
            let help = format!("{} {}{key}", tr(help), tr("Records until the same key or button ends it."));
            let button = Button::new(tr_with("Record a film ({name})", &[("name", name)]));
            if ui.add_enabled(view.film.is_none(), button).on_hover_text(help).clicked() {
                view.film_requests.push(FilmRequest::Start(format));
            }
        }
        let about = "Starts over, and writes pulls and pushes into the level as scripted actions. Start over then replays them, and a link or a \
                     saved file has them too: anyone who opens it sees whether the same state comes out. [Shift+R]";
        let button = Button::new(tr("Record actions"));
        if ui.add_enabled(!now.records && now.toy.is_none(), button).on_hover_text(tr(about)).clicked() {
            commands.push(Command::Record(true));
        }
    });
}

/// Draws the buttons of pictures, panels, theme and help.
fn looks(ui: &mut Ui, now: &Snapshot, view: &mut View, commands: &mut Vec<Command>, narrow: bool) {
    camera(ui, now, view, commands);
    let sides = [
        (Side::Left, Icon::Left, "Body panel", "What the body is made of and what acts on it."),
        (Side::Right, Icon::Right, "Cost panel", "Colours, what a frame costs, and the energies."),
    ];
    for (side, icon, name, about) in sides {
        let on = if narrow { view.drawer == Some(side) } else { !*view.hidden(side) };
        if icon_button(ui, icon, name, about, on).clicked() {
            if narrow {
                view.drawer = (!on).then_some(side);
            } else {
                *view.hidden(side) = on;
            }
        }
    }
    let about = "The stage alone on the whole screen, with larger text. [F11]";
    if icon_button(ui, Icon::Whole, "Present", about, false).clicked() {
        view.toggles_presentation = true;
    }
    let dark = ui.visuals().dark_mode;
    let (icon, name) = if dark { (Icon::Sun, "Light theme") } else { (Icon::Moon, "Dark theme") };
    if icon_button(ui, icon, name, "", false).clicked() {
        ui.ctx().set_theme(if dark { egui::Theme::Light } else { egui::Theme::Dark });
    }
    if icon_button(ui, Icon::Help, "Keys", "List of keys and mouse actions. [?]", view.help).clicked() {
        view.help = !view.help;
    }
}

impl View {
    const fn hidden(&mut self, side: Side) -> &mut bool {
        &mut self.hidden[side as usize]
    }
}
