//! Panel of a toy: equation, parameters and error.

use super::{View, apply_response, fixed, heading, row, sliders};
use crate::{command::Command, snapshot::Snapshot};
use eframe::egui::{RichText, Ui};

pub fn show(ui: &mut Ui, now: &Snapshot, view: &mut View, commands: &mut Vec<Command>) {
    let (Some(listed), Some(shown)) = (&now.level.toy, &now.toy) else { return };
    heading(ui, listed.kind().title());
    ui.label(RichText::new(listed.kind().about()).small().weak());
    ui.add_space(4.0);
    let mut toy = listed.clone();
    let outcome = sliders(ui, toy.kind_mut().parameters());
    apply_response(outcome, Some(Command::SetToy(toy)), view, commands);
    for reading in &shown.readings {
        row(ui, reading.name, &fixed(reading.value, reading.unit), reading.help);
    }
}
