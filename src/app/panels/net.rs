//! Panel of a net.

use super::{View, apply_response, sliders};
use crate::{command::Command, level::NetLevel, quantity::Quantity};
use eframe::egui::Ui;

/// Draws the sliders of a net: the mass of its particles and its parameters.
pub fn show(ui: &mut Ui, number: usize, listed: &NetLevel, view: &mut View, commands: &mut Vec<Command>) {
    let (mut net, mut mass) = (listed.net.clone(), listed.mass);
    let springs = net.kind_mut().parameters();
    let outcome = sliders(ui, std::iter::once(&mut mass as &mut dyn Quantity).chain(springs));
    apply_response(outcome, Some(Command::SetNet(number, net, mass)), view, commands);
}
