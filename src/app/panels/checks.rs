//! Known results of the level: what is measured now, and whether it is what it should be.

use super::{PanelContext, fixed, heading_here};
use crate::{app::theme::Theme, snapshot::CheckReading};
use eframe::egui::{Align, Layout, RichText, Ui};

/// Draws the known results, if the level has any.
pub fn show(ui: &mut Ui, context: &PanelContext<'_>) {
    let checks = &context.now.checks;
    if checks.is_empty() {
        return;
    }
    ui.add_space(6.0);
    heading_here(ui, "Known results");
    for reading in checks {
        row(ui, reading);
    }
}

/// Draws one: its name, and below it what is known and its value.
fn row(ui: &mut Ui, reading: &CheckReading) {
    let theme = Theme::of(ui.ctx());
    let CheckReading { check, unit, now, measured, is_met } = reading;
    let (value, mark, color) = match (measured, is_met) {
        (Some(value), true) => (*value, "met", theme.good),
        (Some(value), false) => (*value, "missed", theme.warning),
        (None, _) => (*now, "", theme.text),
    };
    let [known, tolerance] = [check.value.get(), check.tolerance.get()].map(|value| fixed(value, unit));
    let known = format!("known: {} ± {} at {} s", known.trim(), tolerance.trim(), check.at.get());
    let exactly = |value: f64| format!("{value:.7} {unit}").trim_end().to_owned();
    let state = match (measured, is_met) {
        (Some(value), true) => format!("It was met, with {}.", exactly(*value)),
        (Some(value), false) => format!("It was missed, with {}.", exactly(*value)),
        (None, _) => "It is measured when that time comes in a run from the start.".to_owned(),
    };
    let about = format!("{}\n{known}\n{}\n{state}", check.name, check.source);
    ui.scope(|ui| {
        ui.label(&check.name);
        ui.horizontal(|ui| {
            ui.label(RichText::new(known).small().weak());
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                ui.label(RichText::new(mark).small().color(color));
                ui.label(RichText::new(fixed(value, unit).trim()).monospace().color(color));
            });
        });
    })
    .response
    .on_hover_text(about);
}
