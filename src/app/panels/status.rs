//! The line at the bottom: the keys that matter now, or one warning in words with a button that mends it.

use super::{Desk, View};
use crate::{
    app::keys::{Binding, TABLE, When},
    command::{Command, Mode},
    level::Substeps,
    materials::Model,
    snapshot::Snapshot,
};
use eframe::egui::{self, Align, Button, Frame, Layout, Margin, Panel, RichText, TextStyle, Ui, vec2};

/// Something worth knowing, and what to do about it.
struct Warning {
    text: String,
    /// Words on the button, what it does, and a tooltip.
    mend: Option<(&'static str, Command, &'static str)>,
}

/// Time slower than this is worth a warning; faster than the other it is forgotten.
const SLOW: (f64, f64) = (0.85, 0.95);

/// Stepping that takes this long in a frame is what slows time down [s].
const MUCH: f64 = 0.009;

pub fn show(ui: &mut Ui, desk: &Desk<'_>, view: &mut View, commands: &mut Vec<Command>) {
    let frame = Frame::side_top_panel(ui.style()).inner_margin(Margin::symmetric(8, 4));
    let warning = warning(desk, view);
    Panel::bottom("status").frame(frame).exact_size(34.0).show(ui, |ui| {
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if let Some(warning) = &warning {
                complain(ui, warning, view, commands);
                ui.add_space(12.0);
            }
            let width = ui.available_width();
            ui.allocate_ui_with_layout(vec2(width, 26.0), Layout::left_to_right(Align::Center), |ui| {
                hints(ui, desk.now, view);
            });
        });
    });
}

/// Keys that matter in this mode, as far as there is room; each can be clicked instead.
fn hints(ui: &mut Ui, now: &Snapshot, view: &mut View) {
    ui.spacing_mut().item_spacing.x = 5.0;
    let places = [When::Edit, When::Moving, When::Test];
    let special = TABLE.iter().filter(|binding| places.contains(&binding.when) && binding.when.holds(now));
    let general = TABLE.iter().filter(|binding| ["Space", "M", "T", "D", "?"].contains(&binding.label));
    // A toy has no vertices to pin or pull, and nothing that could be damped.
    let special = special.filter(|binding| now.toy.is_none() || !["Click", "Drag"].contains(&binding.label));
    let general = general.filter(|binding| now.toy.is_none() || binding.label != "D");
    for binding in special.chain(general) {
        let words = brief(binding, now);
        let font = TextStyle::Small.resolve(ui.style());
        let color = ui.visuals().text_color();
        let width = |text: &str| ui.painter().layout_no_wrap(text.to_owned(), font.clone(), color).size().x;
        if width(binding.label) + width(words) + 40.0 > ui.available_width() {
            break;
        }
        let cap = Button::new(RichText::new(binding.label).small().strong()).small().min_size(vec2(20.0, 18.0));
        let cap = ui.add_enabled(!binding.shortcuts.is_empty(), cap);
        if cap.on_hover_text(binding.words).accessible_name(format!("{}: {}", binding.label, binding.words)).clicked() {
            view.pressed.push(binding);
        }
        ui.label(RichText::new(words).small());
        ui.add_space(6.0);
    }
}

/// The words of the table, shorter.
fn brief(binding: &Binding, now: &Snapshot) -> &'static str {
    match (binding.label, binding.when) {
        ("Click", _) => "pin / free",
        ("R", When::Edit) => "remove pins",
        ("R", _) => "start over",
        ("Drag", _) => "pull",
        ("Up", _) => "stretched",
        ("Down", _) => "compressed",
        ("Space", _) if now.running && now.mode != Mode::Edit => "pause",
        ("Space", _) => "run",
        ("M", _) if now.mode == Mode::Simulate => "edit",
        ("M", _) => "simulate",
        ("T", _) if now.mode == Mode::Collide => "edit",
        ("T", _) => "collide",
        ("D", _) if now.damping => "damping off",
        ("D", _) => "damping on",
        ("?", _) => "all keys",
        _ => binding.words,
    }
}

/// Writes the warning; what does not fit can be read in its tooltip.
fn complain(ui: &mut Ui, warning: &Warning, view: &mut View, commands: &mut Vec<Command>) {
    let put_away = ui.button("Hide").on_hover_text("Puts this warning away.");
    if put_away.clicked() {
        view.dismissed.push(warning.text.clone());
    }
    if let Some((words, command, help)) = &warning.mend
        && ui.button(*words).on_hover_text(*help).clicked()
    {
        commands.push(command.clone());
    }
    let color = ui.visuals().warn_fg_color;
    let room = (ui.available_width() * 0.75).max(120.0).min(ui.available_width());
    ui.scope(|ui| {
        ui.set_max_width(room);
        ui.add(egui::Label::new(RichText::new(&warning.text).color(color)).truncate());
    });
}

/// The one that matters most.
fn warning(desk: &Desk<'_>, view: &mut View) -> Option<Warning> {
    let now = desk.now;
    if let Some(factor) = desk.rates.map(|rates| rates.factor) {
        view.slow = factor < if view.slow { SLOW.1 } else { SLOW.0 };
    } else {
        view.slow = false;
    }
    let mut all = Vec::new();
    all.extend(inside_out(now));
    all.extend(now.bodies.iter().filter_map(|body| body.caution.clone().map(|text| caution(text, body.model))));
    if view.slow {
        all.extend(desk.rates.and_then(|rates| slow(now, rates.physics)));
    }
    all.extend(now.messages.iter().map(|text| Warning { text: text.clone(), mend: None }));
    view.dismissed.retain(|text| all.iter().any(|warning| warning.text == *text));
    all.into_iter().find(|warning| !view.dismissed.contains(&warning.text))
}

fn inside_out(now: &Snapshot) -> Option<Warning> {
    let text = match now.inverted {
        0 => return None,
        1 => "1 triangle is inside out".to_owned(),
        many => format!("{many} triangles are inside out"),
    };
    Some(Warning { text, mend: Some(("Start over", Command::Reset, "Positions and velocities go back to the start.")) })
}

fn caution(text: String, model: Model) -> Warning {
    let help = "Its energy grows without bound as a triangle is squeezed flat; all bodies start over.";
    let mend = (model != Model::NeoHookean).then_some(("Use neo-Hookean", Command::SetModel(Model::NeoHookean), help));
    Warning { text, mend }
}

fn slow(now: &Snapshot, physics: f64) -> Option<Warning> {
    if physics < MUCH {
        let text = "Frames come too seldom: time runs slower than real time".to_owned();
        return Some(Warning { text, mend: None });
    }
    let steps = now.level.substeps.get();
    let text = format!("This machine cannot afford {steps} steps a frame: time runs slower than real time");
    let fewer = Substeps::new(steps / 2).ok()?;
    let help = "Longer steps: cheaper, and less stable.";
    Some(Warning { text, mend: Some(("Halve the steps", Command::SetSubsteps(fewer), help)) })
}
