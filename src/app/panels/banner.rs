//! Banner over the stage: faults and their remedies.

use super::{Notice, PanelContext, View};
use crate::{
    app::{
        advice::{Facts, Trouble},
        compare::{Pane, PaneRequest},
        language::tr,
        numbers,
        theme::Theme,
    },
    command::Command,
};
use eframe::egui::{Align2, Area, Color32, Context, Frame, Id, Key, Label, Order, Rect, RichText, Stroke, Ui, vec2};

pub fn show(ctx: &Context, stage: Rect, context: &PanelContext<'_>, view: &mut View, commands: &mut Vec<Command>) {
    let now = context.now;
    let other = context.comparison.filter(|_| now.fault.is_none()).and_then(|panes| {
        let seen = if panes.chosen() == Pane::A { panes.snapshot() } else { context.first };
        Some((panes.chosen().other(), seen.fault.as_ref()?))
    });
    if now.fault.is_none() && other.is_none() && view.notice.is_none() {
        return;
    }
    // The banner lies below the heads of two panes, which name the pane with the fault.
    let down = if context.comparison.is_some() { 54.0 } else { 10.0 };
    let top = stage.center_top() + vec2(0.0, down);
    let area = Area::new(Id::unique("banner")).order(Order::Foreground).pivot(Align2::CENTER_TOP).fixed_pos(top);
    area.constrain_to(stage).show(ctx, |ui| {
        let width = (stage.width() - 56.0).clamp(160.0, 520.0);
        ui.set_max_width(width);
        if let Some(fault) = &now.fault {
            let pane = context.comparison.map(|panes| format!("Time stopped in {}", panes.chosen().letter()));
            let title = pane.as_deref().unwrap_or("Time stopped");
            card(ui, width, Theme::of(ctx).bad, title, &fault.to_string(), |ui| {
                remedies(ui, context, view, commands);
            });
        }
        if let Some((pane, fault)) = other {
            let title = format!("Time stopped in {}", pane.letter());
            card(ui, width, Theme::of(ctx).bad, &title, &fault.to_string(), |ui| {
                let help = "The panels show this pane, and the remedies are offered here.";
                if ui.button(format!("Edit {}", pane.letter())).on_hover_text(tr(help)).clicked() {
                    view.panes.push(PaneRequest::Choose(pane));
                }
            });
        }
        let mut read = false;
        if let Some(notice) = &view.notice {
            let (title, color) = match notice {
                Notice::Trouble(_) => ("Error", Theme::of(ctx).warning),
                Notice::Done(_) => ("Done", Theme::of(ctx).good),
            };
            card(ui, width, color, title, notice.text(), |ui| {
                read = ui.button(tr("Close")).on_hover_text(tr("[Esc]")).clicked();
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
        // A message can be copied.
        ui.add(Label::new(text).selectable(true));
        ui.add_space(4.0);
        ui.horizontal_wrapped(buttons);
    });
}

/// Draws the remedies of a fault.
fn remedies(ui: &mut Ui, context: &PanelContext<'_>, view: &mut View, commands: &mut Vec<Command>) {
    let now = context.now;
    let reach = now.rewind_length.min(1.0);
    if reach > 0.0 {
        let help = "Goes back in time to before the failure, and pauses: change something, then run again. [Backspace]";
        if ui.button(format!("Back {}", numbers::si(reach, "s"))).on_hover_text(tr(help)).clicked() {
            commands.push(Command::Rewind(reach));
        }
    }
    if ui.button(tr("Reset")).on_hover_text(tr("Positions and velocities go back to the start. [R]")).clicked() {
        commands.push(Command::Reset);
    }
    let Some(fault) = &now.fault else { return };
    let advice = Facts::of(now, context.jobs.limit_at_rest(), view).advise(Trouble::Fault(fault.cause));
    for (number, remedy) in advice.remedies.iter().enumerate() {
        let help = format!("{} {}", tr(remedy.help()), tr("Starts over."));
        if ui.button(remedy.label()).on_hover_text(help).clicked() {
            commands.extend(advice.apply(number, now, view));
        }
    }
}
