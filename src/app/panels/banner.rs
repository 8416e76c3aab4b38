//! What went wrong, over the stage, with buttons that mend it.

use super::{Desk, Notice, View};
use crate::{
    app::{
        compare::{Pane, Wish},
        numbers,
        theme::Theme,
    },
    command::Command,
    fault::Cause,
    level::Substeps,
    snapshot::Snapshot,
};
use eframe::egui::{self, Align2, Area, Color32, Context, Frame, Id, Key, Order, Rect, RichText, Stroke, Ui, vec2};

pub fn show(ctx: &Context, stage: Rect, desk: &Desk<'_>, view: &mut View, commands: &mut Vec<Command>) {
    let now = desk.now;
    let other = desk.comparison.filter(|_| now.fault.is_none()).and_then(|panes| {
        let seen = if panes.chosen() == Pane::A { panes.snapshot() } else { desk.first };
        Some((panes.chosen().other(), seen.fault.as_ref()?))
    });
    if now.fault.is_none() && other.is_none() && view.notice.is_none() {
        return;
    }
    // Below the heads of two panes, which say what stopped.
    let down = if desk.comparison.is_some() { 54.0 } else { 10.0 };
    let top = stage.center_top() + vec2(0.0, down);
    let area = Area::new(Id::unique("banner")).order(Order::Foreground).pivot(Align2::CENTER_TOP).fixed_pos(top);
    area.constrain_to(stage).show(ctx, |ui| {
        let width = (stage.width() - 56.0).clamp(160.0, 520.0);
        ui.set_max_width(width);
        if let Some(fault) = &now.fault {
            let pane = desk.comparison.map(|panes| format!("Time stopped in {}", panes.chosen().letter()));
            let title = pane.as_deref().unwrap_or("Time stopped");
            card(ui, width, Theme::of(ctx).bad, title, &fault.to_string(), |ui| {
                remedies(ui, now, commands);
            });
        }
        if let Some((pane, fault)) = other {
            let title = format!("Time stopped in {}", pane.letter());
            card(ui, width, Theme::of(ctx).bad, &title, &fault.to_string(), |ui| {
                let help = "The panels show this pane, and the remedies are offered here.";
                if ui.button(format!("Edit {}", pane.letter())).on_hover_text(help).clicked() {
                    view.panes.push(Wish::Choose(pane));
                }
            });
        }
        let mut read = false;
        if let Some(notice) = &view.notice {
            let (title, color) = match notice {
                Notice::Trouble(_) => ("Error", Theme::of(ctx).caution),
                Notice::Done(_) => ("Done", Theme::of(ctx).good),
            };
            card(ui, width, color, title, notice.text(), |ui| {
                read = ui.button("Close").on_hover_text("[Esc]").clicked();
            });
        }
        if read || (view.notice.is_some() && ui.input(|input| input.key_pressed(Key::Escape))) {
            view.notice = None;
        }
    });
}

fn card(ui: &mut Ui, width: f32, color: Color32, title: &str, text: &str, buttons: impl FnOnce(&mut Ui)) {
    let frame = Frame::window(ui.style()).inner_margin(12).stroke(Stroke::new(1.5, color));
    frame.show(ui, |ui| {
        ui.set_width(width);
        ui.label(RichText::new(title).strong().color(color));
        ui.label(text);
        ui.add_space(4.0);
        ui.horizontal_wrapped(buttons);
    });
}

/// What helps against a fault.
fn remedies(ui: &mut Ui, now: &Snapshot, commands: &mut Vec<Command>) {
    let reach = now.rewind_reach.min(1.0);
    if reach > 0.0 {
        let help = "Goes back in time to before the failure, and pauses: change something, then run again. [Backspace]";
        if ui.button(format!("Back {}", numbers::si(reach, "s"))).on_hover_text(help).clicked() {
            commands.push(Command::Rewind(reach));
        }
    }
    if ui.button("Reset").on_hover_text("Positions and velocities go back to the start. [R]").clicked() {
        commands.push(Command::Reset);
    }
    let help = "Switches damping on and starts over: vibrations die out. [D, R]";
    if ui.add_enabled(!now.damping, egui::Button::new("Damp")).on_hover_text(help).clicked() {
        commands.extend([Command::SetDamping(true), Command::Reset]);
    }
    if let Ok(finer) = Substeps::new(now.level.substeps.get().saturating_mul(2)) {
        let help = "Starts over with twice as many steps of half the length: more computing time, and stable for stiffer bodies.";
        if ui.button("Halve the step").on_hover_text(help).clicked() {
            commands.extend([Command::SetSubsteps(finer), Command::EndGesture, Command::Reset]);
        }
    }
    if let Some(enough) = now.fault.as_ref().and_then(|fault| enough(fault.cause)) {
        let help = "As many steps in 1/60 s as the stability limit asks for, and starts over.";
        if ui.button(format!("Use {} substeps", enough.get())).on_hover_text(help).clicked() {
            commands.extend([Command::SetSubsteps(enough), Command::EndGesture, Command::Reset]);
        }
    }
}

/// As many steps as a stability limit asks for, with a fifth to spare, if that is a number of steps at all.
fn enough(cause: Cause) -> Option<Substeps> {
    let Cause::StepTooLong { limit, .. } = cause else { return None };
    let count = (1.2 / (60.0 * limit)).ceil();
    (count <= f64::from(Substeps::MAX)).then(|| Substeps::new(count as u32).ok()).flatten()
}
