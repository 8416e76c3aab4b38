//! Panel of effects: a switch and sliders for each.

use super::{View, apply_response, heading, obstacles, sliders, widgets};
use crate::{
    app::language::tr,
    command::Command,
    effects::{EffectKind, Group},
    level::{EffectLevel, Pin, Switch, When},
    snapshot::Snapshot,
};
use eframe::egui::{Button, Checkbox, ComboBox, PopupCloseBehavior, RichText, Ui};

pub fn show(ui: &mut Ui, now: &Snapshot, view: &mut View, commands: &mut Vec<Command>) {
    if now.level.toy.is_some() {
        return;
    }
    heading(ui, "Effects");
    for (index, effect) in now.level.effects.iter().enumerate() {
        ui.push_id(("effect", index), |ui| one(ui, (index, effect), now, view, commands));
    }
    add(ui, now, commands);
}

/// Draws a menu of the effects that the level does not have and that can act in it.
fn add(ui: &mut Ui, now: &Snapshot, commands: &mut Vec<Command>) {
    let listed = |kind: &EffectKind| now.level.effects.iter().any(|listed| listed.effect.name() == kind.name());
    let missing: Vec<_> = EffectKind::all().into_iter().filter(|kind| !listed(kind)).collect();
    if missing.is_empty() {
        return;
    }
    ui.menu_button(tr("Add an effect"), |ui| {
        for kind in missing.into_iter().filter(|kind| kind.fits(&now.elements).is_ok()) {
            let entry = ui.button(tr(kind.kind().title())).on_hover_text(tr(kind.kind().about()));
            if entry.clicked() {
                commands.extend([Command::AddEffect(kind), Command::EndGesture]);
            }
        }
    });
}

/// Draws the switch that allows an effect to be skipped.
fn auto(ui: &mut Ui, index: usize, effect: &EffectLevel, commands: &mut Vec<Command>) {
    let now = effect.switch == Switch::Auto;
    let help = if now {
        "Auto: skipped whenever it cannot change anything; the results are the same bit for bit. Click to evaluate it in \
         every step."
    } else {
        "On: evaluated in every step. Click to skip it whenever it cannot change anything."
    };
    let words = RichText::new(tr(if now { "Auto" } else { "On" })).small();
    if ui.add(Button::new(words).small().frame(!now)).on_hover_text(tr(help)).clicked() {
        let switch = if now { Switch::On } else { Switch::Auto };
        commands.extend([Command::SetEffect(index, EffectLevel { switch, ..effect.clone() }), Command::EndGesture]);
    }
}

/// Draws which body an edge load acts on, and on which of its sides.
fn loaded(ui: &mut Ui, (index, effect): (usize, &EffectLevel), now: &Snapshot, commands: &mut Vec<Command>) {
    let mut changed = effect.clone();
    let Some(rules) = changed.effect.kind_mut().rules_mut().filter(|rules| rules.are_of_edges) else { return };
    let before = (rules.of.clone(), rules.pins.clone());
    ui.indent("loaded", |ui| {
        if now.level.bodies.len() > 1 {
            ui.horizontal(|ui| {
                ui.label(tr("Body"));
                let all = tr("All bodies");
                let shown = rules.of.clone().unwrap_or_else(|| all.to_owned());
                let menu = ComboBox::from_id_salt("loaded body").width(ui.available_width()).selected_text(shown);
                let menu = menu.show_ui(ui, |ui| {
                    ui.selectable_value(rules.of, None, all);
                    for body in &now.level.bodies {
                        ui.selectable_value(rules.of, Some(body.name.clone()), &body.name);
                    }
                });
                menu.response.on_hover_text(tr("Which body the load acts on")).accessible_name(tr("Loaded body"));
            });
        }
        ui.horizontal(|ui| {
            ui.label(tr("Edges"));
            let names: Vec<_> =
                SIDES.iter().filter(|(_, side)| rules.pins.contains(side)).map(|(name, _)| tr(name)).collect();
            let shown = if names.len() == rules.pins.len() { names.join(", ") } else { tr("Other").to_owned() };
            let menu = ComboBox::from_id_salt("edges").width(ui.available_width()).selected_text(shown);
            let menu = menu.close_behavior(PopupCloseBehavior::CloseOnClickOutside).show_ui(ui, |ui| {
                for (name, side) in SIDES {
                    let mut is_loaded = rules.pins.contains(&side);
                    // A load needs an edge.
                    let is_last = is_loaded && names.len() == 1;
                    if ui.add_enabled(!is_last, Checkbox::new(&mut is_loaded, tr(name))).changed() {
                        // Rules of other kinds come from the file, and give way to sides.
                        rules.pins.retain(|pin| *pin != side && SIDES.iter().any(|(_, side)| side == pin));
                        rules.pins.extend(is_loaded.then_some(side));
                    }
                }
            });
            let help = tr(
                "Which of its sides the load acts on: all edges with both ends at the greatest or least x or y at rest. Rules of another kind, from the file, give way",
            );
            menu.response.on_hover_text(help).accessible_name(tr("Loaded edges"));
        });
    });
    if before != (rules.of.clone(), rules.pins.clone()) {
        commands.extend([Command::SetEffect(index, changed), Command::EndGesture]);
    }
}

/// The sides of a body that a load may act on.
const SIDES: [(&str, Pin); 4] =
    [("Top", Pin::Top), ("Bottom", Pin::Bottom), ("Left", Pin::Left), ("Right", Pin::Right)];

fn one(
    ui: &mut Ui,
    (index, effect): (usize, &EffectLevel),
    now: &Snapshot,
    view: &mut View,
    commands: &mut Vec<Command>,
) {
    let mut on = effect.switch.is_on();
    let title = effect.effect.kind().title();
    ui.horizontal(|ui| {
        let switch =
            ui.checkbox(&mut on, RichText::new(tr(title)).strong()).on_hover_text(tr(effect.effect.kind().about()));
        if switch.changed() {
            let switch = if on { Switch::default() } else { Switch::Off };
            commands.extend([Command::SetEffect(index, EffectLevel { switch, ..effect.clone() }), Command::EndGesture]);
        }
        if on {
            auto(ui, index, effect, commands);
        }
        if effect.when == When::Collide {
            let note = RichText::new(tr("only in collide mode")).small().weak();
            ui.label(note).on_hover_text(tr("Acts in collide mode only. [T] switches to that mode."));
        }
    });
    if on {
        obstacles::show(ui, (index, effect), now, view, commands);
        loaded(ui, (index, effect), now, commands);
    }
    let mut changed = effect.clone();
    if !on || changed.effect.kind_mut().groups().iter().all(|group| group.numbers.is_empty()) {
        return;
    }
    let mut sum = widgets::SliderResponse::default();
    ui.indent("parameters", |ui| {
        for (name, formula) in changed.effect.kind_mut().formulas().into_iter().take(now.elements.dimension()) {
            sum.add(widgets::formula(ui, name, formula));
        }
        let mut groups = changed.effect.kind_mut().groups();
        groups.retain(|group| !group.numbers.is_empty());
        for (number, Group { title, solid, numbers }) in groups.into_iter().enumerate() {
            let group = ui.push_id(number, |ui| {
                if let Some(title) = title {
                    ui.label(RichText::new(title).small());
                }
                let outcome = sliders(ui, numbers);
                let changed = outcome.changed;
                sum.add(outcome);
                changed
            });
            if let Some(solid) = solid.filter(|_| group.inner || group.response.contains_pointer()) {
                view.meant = Some([index, solid]);
            }
        }
    });
    apply_response(sum, Some(Command::SetEffect(index, changed)), view, commands);
}
