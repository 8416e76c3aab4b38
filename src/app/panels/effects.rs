//! What acts on the bodies: a switch and sliders for every effect of the level, whatever effects there are.

use super::{View, heading, settle, sliders};
use crate::{
    command::Command,
    level::{EffectLevel, Switch, When},
    snapshot::Snapshot,
};
use eframe::egui::{RichText, Ui};

pub fn show(ui: &mut Ui, now: &Snapshot, view: &mut View, commands: &mut Vec<Command>) {
    if now.level.effects.is_empty() {
        return;
    }
    heading(ui, "Effects");
    for (index, effect) in now.level.effects.iter().enumerate() {
        ui.push_id(("effect", index), |ui| one(ui, index, effect, view, commands));
    }
}

fn one(ui: &mut Ui, index: usize, effect: &EffectLevel, view: &mut View, commands: &mut Vec<Command>) {
    let mut on = effect.switch == Switch::On;
    let title = effect.effect.kind().title();
    ui.horizontal(|ui| {
        let switch = ui.checkbox(&mut on, RichText::new(title).strong()).on_hover_text(effect.effect.kind().about());
        if switch.changed() {
            let switch = if on { Switch::On } else { Switch::Off };
            commands.extend([Command::SetEffect(index, EffectLevel { switch, ..effect.clone() }), Command::EndGesture]);
        }
        if effect.when == When::Collide {
            let note = RichText::new("only in collide mode").small().weak();
            ui.label(note).on_hover_text("It acts in collide mode only; the key T goes there.");
        }
    });
    let mut changed = effect.clone();
    let parameters = changed.effect.kind_mut().parameters();
    if !on || parameters.is_empty() {
        return;
    }
    let sum = ui.indent("parameters", |ui| sliders(ui, parameters)).inner;
    settle(sum, Some(Command::SetEffect(index, changed)), view, commands);
}
