//! The typed energy of a body or membrane: its formula and its parameters.

use super::{
    Notice, View,
    widgets::{self, SliderResponse},
};
use crate::{
    app::language::tr,
    command::Command,
    formula::FormulaError,
    materials::{BadEnergy, MaterialParameters, TypedEnergy},
};
use eframe::egui::{DragValue, RichText, Ui};

const HELP: &str = "The energy density ψ [J/m²] as a formula of I1 = tr FᵀF and J = det F in the plane, in place of that of the model. It knows \
                    mu, lambda, E [Pa] and nu of the sliders, and parameters of its own. Functions: exp, log, log10, sqrt, abs, min, max.";

/// Draws the switch, and the formula where it is on; `listed` is that of the part.
pub fn show(
    ui: &mut Ui,
    (part, listed): (usize, Option<&TypedEnergy>),
    material: MaterialParameters,
    view: &mut View,
    commands: &mut Vec<Command>,
) {
    let mut on = listed.is_some();
    let mut set = |energy| commands.extend([Command::SetEnergy(part, energy), Command::EndGesture]);
    if ui.checkbox(&mut on, tr("Typed energy")).on_hover_text(tr(HELP)).changed() {
        match TypedEnergy::new(TypedEnergy::NEO_HOOKEAN, Vec::new()) {
            Ok(energy) => set(on.then_some(energy)),
            Err(why) => view.notice = Some(Notice::trouble(&why)),
        }
    }
    let Some(energy) = listed else { return };
    let mut new = None;
    let mut unknown: Option<String> = None;
    let outcome = widgets::formula_field(ui, ("ψ", HELP), energy.text(), |text| {
        let typed = TypedEnergy::new(text, energy.parameters().to_vec()).inspect_err(|why| {
            if let BadEnergy::Formula(FormulaError { unknown: name, .. }) = why {
                unknown.clone_from(name);
            }
        });
        let typed = typed.map_err(|why| why.to_string())?;
        typed.material(material)?;
        new = Some(typed);
        Ok(())
    });
    if let Some(name) = unknown {
        let button = ui.small_button(format!("Make {name} a parameter"));
        if button.on_hover_text(tr("It gets the value 1.")).clicked() {
            // What was typed is read again with it in the next frame.
            match energy.with_parameter(&name, 1.0) {
                Ok(typed) => set(Some(typed)),
                Err(why) => view.notice = Some(Notice::trouble(&why)),
            }
        }
    }
    apply(&outcome, (part, new), commands);
    parameters(ui, (part, energy), view, commands);
}

fn apply(outcome: &SliderResponse, (part, new): (usize, Option<TypedEnergy>), commands: &mut Vec<Command>) {
    commands.extend(new.map(|energy| Command::SetEnergy(part, Some(energy))));
    if outcome.ended {
        commands.push(Command::EndGesture);
    }
}

/// Draws the values of the parameters.
fn parameters(ui: &mut Ui, (part, energy): (usize, &TypedEnergy), view: &mut View, commands: &mut Vec<Command>) {
    for (name, value) in energy.parameters() {
        ui.horizontal(|ui| {
            ui.monospace(name);
            let mut new = *value;
            let speed = (0.01 * value.abs()).max(1e-3);
            let response = ui.add(DragValue::new(&mut new).speed(speed).max_decimals(9));
            let response =
                response.on_hover_text(tr("Drag, or click to type.")).accessible_name(format!("Parameter {name}"));
            if new != *value {
                match energy.with_parameter(name, new) {
                    Ok(energy) => commands.push(Command::SetEnergy(part, Some(energy))),
                    Err(why) => view.notice = Some(Notice::trouble(&why)),
                }
            }
            if response.drag_stopped() || response.lost_focus() {
                commands.push(Command::EndGesture);
            }
            let remove = ui.small_button("×").on_hover_text(tr("Removes the parameter."));
            if remove.accessible_name(format!("Remove {name}")).clicked() {
                let others = energy.parameters().iter().filter(|(other, _)| other != name).cloned().collect();
                if let Ok(energy) = TypedEnergy::new(energy.text(), others) {
                    commands.extend([Command::SetEnergy(part, Some(energy)), Command::EndGesture]);
                } else {
                    let why = format!("{name} cannot be removed: the formula uses it");
                    view.notice = Some(Notice::Trouble(why));
                }
            }
        });
    }
    if !energy.parameters().is_empty() {
        ui.label(RichText::new(tr("A value that leaves a stress at rest is refused.")).small().weak());
    }
}
