//! Overlays: text input where there are no file dialogs, unsaved changes, progress of meshing, and the list of keys.

use super::{
    FileRequest, FilmRequest, View, count,
    widgets::{Icon, icon_button},
};
use crate::{
    app::{
        dialogs::Purpose,
        film::Recorder,
        keys::{TABLE, When},
        language::{Language, tr, tr_with},
        theme::Theme,
    },
    command::{Command, Mode},
    snapshot::Snapshot,
};
use eframe::egui::{
    self, Align, Align2, Area, Button, Context, Frame, Grid, Id, Key, Layout, Modal, Order, Rect, RichText, ScrollArea,
    Sense, Spinner, TextEdit, Ui, vec2,
};

/// State of a text input.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Prompt {
    /// Purpose of the requested file.
    pub purpose: Purpose,
    /// Typed text.
    pub text: String,
    /// Whether the answer was confirmed.
    pub answered: bool,
}

pub fn show_prompt(ctx: &Context, view: &mut View) {
    let Some(prompt) = &mut view.prompt else { return };
    let mut closed = false;
    let modal = Modal::new(Id::unique("prompt")).show(ctx, |ui| {
        ui.set_width((ctx.content_rect().width() - 48.0).min(420.0));
        let verb = tr(if prompt.purpose.reads() { "Open" } else { "Save" });
        ui.label(RichText::new(tr(prompt.purpose.title())).heading());
        ui.label(tr("There is no file dialog on this system. Path of the file:"));
        let edit = TextEdit::singleline(&mut prompt.text);
        let field = ui.add(edit.desired_width(f32::INFINITY).hint_text(tr("my-level.ron"))).accessible_name(tr("File"));
        let entered = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
        if !prompt.answered && ui.memory(|memory| memory.focused().is_none()) {
            field.request_focus();
        }
        ui.add_space(6.0);
        ui.horizontal(|ui| {
            let ready = !prompt.text.trim().is_empty();
            let button = egui::Button::new(verb).min_size(vec2(72.0, 26.0));
            let pressed = ui.add_enabled(ready, button).clicked();
            prompt.answered |= ready && (pressed || entered);
            closed |= ui.button(tr("Cancel")).clicked();
        });
    });
    if closed || modal.should_close() && !prompt.answered {
        view.prompt = None;
    }
}

/// Dialog about unsaved changes that a request would lose.
#[derive(Clone, Debug, PartialEq)]
pub struct Unsaved {
    /// Request that waits for the choice.
    pub request: FileRequest,
    /// Choice, once it is made.
    pub choice: Option<Choice>,
}

/// Choices for unsaved changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Choice {
    /// The changes are saved, then the request is carried out.
    Save,
    /// The changes are lost and the request is carried out.
    Discard,
    /// Nothing changes.
    Cancel,
}

pub fn show_unsaved(ctx: &Context, name: &str, view: &mut View) {
    let Some(unsaved) = view.unsaved.as_mut().filter(|unsaved| unsaved.choice.is_none()) else { return };
    let modal = Modal::new(Id::unique("unsaved")).show(ctx, |ui| {
        ui.set_width((ctx.content_rect().width() - 48.0).min(420.0));
        ui.label(RichText::new(tr("Save the changes?")).heading());
        let then = match unsaved.request {
            FileRequest::Close => "If the window closes now, they are lost.",
            _ => "If another level is opened now, they are lost.",
        };
        let name = if name.is_empty() { tr("This level") } else { name };
        ui.label(format!("{} {}", tr_with("{name} has changes that are not saved.", &[("name", name)]), tr(then)));
        ui.add_space(6.0);
        ui.horizontal(|ui| {
            let choices = [
                (Choice::Save, "Save", "Asks for a file, saves, and goes on. [Enter]"),
                (Choice::Discard, "Discard", "Goes on without saving. [Tab, Enter]"),
                (Choice::Cancel, "Cancel", "Everything stays as it is. [Esc]"),
            ];
            for (choice, words, help) in choices {
                let button = ui.add(Button::new(tr(words)).min_size(vec2(84.0, 28.0))).on_hover_text(tr(help));
                if choice == Choice::Save && ui.memory(|memory| memory.focused().is_none()) {
                    button.request_focus();
                }
                if button.clicked() {
                    unsaved.choice = Some(choice);
                }
            }
        });
    });
    if modal.should_close() && unsaved.choice.is_none() {
        unsaved.choice = Some(Choice::Cancel);
    }
}

pub fn show_meshing(ctx: &Context, stage: Rect, view: &mut View) {
    let Some(progress) = &view.meshing else { return };
    let seconds = format!("{:.0}", progress.seconds);
    let text = tr_with(
        "Meshing about {count} triangles: {seconds} s",
        &[("count", &count(progress.triangles)), ("seconds", &seconds)],
    );
    let corner = stage.center_bottom() - vec2(0.0, 12.0);
    let area = Area::new(Id::unique("meshing")).order(Order::Foreground).pivot(Align2::CENTER_BOTTOM).fixed_pos(corner);
    area.constrain_to(stage).show(ctx, |ui| {
        Frame::window(ui.style()).inner_margin(10).show(ui, |ui| {
            ui.horizontal(|ui| {
                ui.add(Spinner::new().size(18.0));
                ui.label(text);
                let help = "The mesh stays as it is. What is computed already is dropped.";
                view.cancel_mesh = ui.button(tr("Cancel meshing")).on_hover_text(tr(help)).clicked();
            });
        });
    });
}

/// Draws the button that ends the presentation, pale until the pointer is on it.
pub fn show_way_back(ctx: &Context, stage: Rect, view: &mut View) {
    let place = stage.left_top() + vec2(10.0, 10.0);
    let area = Area::new(Id::unique("way back")).order(Order::Middle).fixed_pos(place);
    area.show(ctx, |ui| {
        ui.set_opacity(if ui.rect_contains_pointer(Rect::from_min_size(place, vec2(60.0, 40.0))) { 1.0 } else { 0.35 });
        let button = ui.small_button("×").on_hover_text(tr("Shows the panels again. [F11 or Escape]"));
        if button.accessible_name(tr("Show the panels")).clicked() {
            view.toggles_presentation = true;
        }
    });
}

/// Shows that a film is being recorded, with its length, or how far it is drawn.
pub fn show_film(ctx: &Context, stage: Rect, now: &Snapshot, view: &mut View) {
    let Some(progress) = view.film else { return };
    let corner = stage.center_bottom() - vec2(0.0, if view.meshing.is_some() { 64.0 } else { 12.0 });
    let area = Area::new(Id::unique("film")).order(Order::Foreground).pivot(Align2::CENTER_BOTTOM).fixed_pos(corner);
    area.constrain_to(stage).show(ctx, |ui| {
        Frame::window(ui.style()).inner_margin(10).show(ui, |ui| {
            ui.horizontal(|ui| {
                let red = Theme::of(ctx).bad;
                if progress.records {
                    let (mark, _) = ui.allocate_exact_size(vec2(14.0, 14.0), Sense::hover());
                    ui.painter().circle_filled(mark.center(), 6.0, red);
                    let seconds = (progress.taken.saturating_sub(1)) as f64 / f64::from(Recorder::RATE);
                    let stands = now.mode == Mode::Edit || !now.running || now.rests();
                    let waits = if stands { tr(", waits for time to run") } else { "" };
                    ui.label(RichText::new(format!("{seconds:.2} s{waits}")).strong()).on_hover_text(tr(
                        "Simulated time in the film. Where drawing is slower, simulated time waits for it, so that the film is smooth.",
                    ));
                    let help = "Ends the film, and asks where to save it. [Shift+V]";
                    if ui.button(tr("Stop recording")).on_hover_text(tr(help)).clicked() {
                        view.film_requests.push(FilmRequest::Stop);
                    }
                } else {
                    ui.add(Spinner::new().size(18.0));
                    ui.label(tr_with("Drawing the film: {drawn} of {taken} frames", &[("drawn", &count(progress.drawn as usize)), ("taken", &count(progress.taken as usize))]));
                }
                if ui.button(tr("Discard film")).on_hover_text(tr("Drops what was recorded.")).clicked() {
                    view.film_requests.push(FilmRequest::Discard);
                }
            });
        });
    });
}

/// Shows that actions are recorded, since when, and how many there are.
pub fn show_recording(ctx: &Context, stage: Rect, now: &Snapshot, view: &View, commands: &mut Vec<Command>) {
    if !now.records {
        return;
    }
    let below = [view.meshing.is_some(), view.film.is_some()].into_iter().filter(|shown| *shown).count();
    let corner = stage.center_bottom() - vec2(0.0, 12.0 + 52.0 * below as f32);
    let area =
        Area::new(Id::unique("recording")).order(Order::Foreground).pivot(Align2::CENTER_BOTTOM).fixed_pos(corner);
    area.constrain_to(stage).show(ctx, |ui| {
        Frame::window(ui.style()).inner_margin(10).show(ui, |ui| {
            ui.horizontal(|ui| {
                let (mark, _) = ui.allocate_exact_size(vec2(14.0, 14.0), Sense::hover());
                ui.painter().circle_filled(mark.center(), 6.0, Theme::of(ctx).bad);
                let actions = count(now.level.actions.len());
                let waits = if now.running { "" } else { tr(", waits for time to run") };
                let told = tr_with("Actions: {count} in {time} s", &[("count", &actions), ("time", &format!("{:.2}", now.time))]);
                ui.label(RichText::new(told + waits).strong()).on_hover_text(tr(
                    "Pulls and pushes are written into the level, at frames of 1/60 s of simulated time. Any other change ends the recording.",
                ));
                let help = "Ends the recording and pauses. Start over replays it; a saved file or a copied link has it too. [Shift+R]";
                if ui.button(tr("End recording")).on_hover_text(tr(help)).clicked() {
                    commands.push(Command::Record(false));
                }
            });
        });
    });
}

pub fn show_help(ctx: &Context, now: &Snapshot, view: &mut View) {
    if !view.help {
        return;
    }
    let room = ctx.content_rect().size() - vec2(48.0, 96.0);
    let modal = Modal::new(Id::unique("keys")).show(ctx, |ui| {
        ui.set_width(room.x.min(540.0));
        ui.horizontal(|ui| {
            ui.label(RichText::new(tr("Keys and mouse")).heading());
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                if icon_button(ui, Icon::Close, "Close", "[Esc]", false).clicked() {
                    view.help = false;
                }
            });
        });
        ui.separator();
        ScrollArea::vertical().max_height(room.y).min_scrolled_height(room.y).auto_shrink([false, true]).show(
            ui,
            |ui| {
                languages(ui, view);
                key_table(ui, now, view);
            },
        );
    });
    if modal.backdrop_response.clicked() || ctx.input_mut(|input| input.consume_key(egui::Modifiers::NONE, Key::Escape))
    {
        view.help = false;
    }
}

/// Draws the choice of the language.
fn languages(ui: &mut Ui, view: &mut View) {
    ui.horizontal(|ui| {
        ui.label(tr("Language")).on_hover_text(tr("What a language lacks stays English."));
        for language in Language::ALL {
            ui.selectable_value(&mut view.language, language, language.title());
        }
    });
}

fn key_table(ui: &mut Ui, now: &Snapshot, view: &mut View) {
    for group in When::ALL {
        ui.add_space(6.0);
        ui.label(RichText::new(tr(group.title())).strong());
        Grid::new(group.title()).num_columns(2).min_col_width(72.0).spacing([12.0, 4.0]).show(ui, |ui| {
            for binding in TABLE.iter().filter(|binding| binding.when == group) {
                let cap = Button::new(RichText::new(binding.label).strong()).min_size(vec2(34.0, 22.0));
                let usable = !binding.shortcuts.is_empty() && group.applies(now);
                let cap =
                    ui.add_enabled(usable, cap).accessible_name(format!("{}, {}", binding.label, tr(binding.words)));
                if cap.clicked() {
                    view.pressed.push(binding);
                }
                ui.label(tr(binding.words));
                ui.end_row();
            }
        });
    }
}
