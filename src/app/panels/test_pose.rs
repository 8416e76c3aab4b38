//! Controls of test levels.

use super::{
    heading,
    segmented::{Segment, segmented},
};
use crate::{
    command::{Command, Pose},
    snapshot::Snapshot,
};
use eframe::egui::Ui;

pub fn show(ui: &mut Ui, now: &Snapshot, commands: &mut Vec<Command>) {
    let Some(test) = now.level.test else { return };
    heading(ui, "Stretch test");
    let about = |key: &str, factor: f64| format!("Starts at {factor} x the rest height. [{key}]");
    let (up, down) = (about("Up", test.stretched.get()), about("Down", test.compressed.get()));
    let is_at = |pose, factor| match now.pose {
        Some(now) => now == pose,
        None => now.level.bodies.first().is_some_and(|body| body.stretch.1 == factor),
    };
    let part = |pose, factor, text, about| Segment { text, name: text, about, on: is_at(pose, factor) };
    let parts = [
        part(Pose::Stretched, test.stretched, "Stretched", &up),
        part(Pose::Compressed, test.compressed, "Compressed", &down),
    ];
    if let Some(clicked) = segmented(ui, "pose", &parts, true) {
        commands.push(Command::SetPose(if clicked == 0 { Pose::Stretched } else { Pose::Compressed }));
    }
    let mut together = now.side_by_side;
    let help = "One body for each constitutive model, so that their answers can be compared.";
    if ui.checkbox(&mut together, "All models side by side").on_hover_text(help).changed() {
        commands.push(Command::SetSideBySide(together));
    }
}
