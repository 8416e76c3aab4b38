//! The accuracy dial: a wanted error, and the cheapest scheme and step for it.

use super::{PanelContext, View, scheme::percent};
use crate::{
    app::{
        jobs::{DialFindings, JobRequest, SECONDS, TARGETS},
        language::tr,
        numbers,
        theme::Theme,
    },
    command::Command,
    study::{Reached, Twin},
};
use eframe::egui::{ComboBox, RichText, Ui};
use std::fmt::Write as _;

/// State of the dial.
pub struct DialSettings {
    /// Number of the wanted error in [`TARGETS`].
    wanted: usize,
    /// Generation of the scene for which it was set: what is found is used when the search ends, unless another scene was opened meanwhile.
    set_for: Option<u64>,
}

impl Default for DialSettings {
    fn default() -> Self {
        Self { wanted: 1, set_for: None }
    }
}

/// Draws the dial, and what it has found.
pub fn show(ui: &mut Ui, context: &PanelContext<'_>, view: &mut View, commands: &mut Vec<Command>) {
    let help = "Finds the scheme and the step that keep 95 % of the frames of the next second within this error at the least cost, from the \
                present state and without the mouse, and steps like this from then on. The error is the root mean square over the vertices, \
                over that of the displacements of all frames.";
    let is_running = context.jobs.dial.is_running();
    ui.horizontal(|ui| {
        ui.label(tr("Wanted error")).on_hover_text(tr(help));
        let dial = &mut view.dial;
        let shown = percent(TARGETS[dial.wanted % TARGETS.len()]);
        let combo = ComboBox::from_id_salt("wanted").width(72.0).selected_text(shown).show_ui(ui, |ui| {
            for (number, error) in TARGETS.iter().enumerate() {
                ui.selectable_value(&mut dial.wanted, number, percent(*error));
            }
        });
        combo.response.on_hover_text(tr(help)).accessible_name(tr("Wanted error"));
        if is_running {
            if ui.button(tr("Cancel")).accessible_name(tr("Cancel the search")).clicked() {
                view.requests.push(JobRequest::Cancel);
                view.dial.set_for = None;
            }
            let done = context.jobs.dial.findings().map_or(0.0, |findings| findings.progress.done);
            ui.label(format!("{:.0} %", 100.0 * done));
        } else if ui.button(tr("Set")).on_hover_text(tr(help)).accessible_name(tr("Set the wanted error")).clicked() {
            view.requests.extend([JobRequest::Dial(TARGETS[dial.wanted % TARGETS.len()]), JobRequest::Twin(true)]);
            dial.set_for = Some(context.now.generation);
        }
    });
    let Some(findings) = context.jobs.dial.findings() else { return };
    let over = findings.progress.finished || findings.trouble.is_some();
    if over
        && view.dial.set_for.take() == Some(context.now.generation)
        && let Some(Reached { setting, .. }) = &findings.results.cheapest
    {
        commands.extend(setting.commands());
    }
    let theme = Theme::of(ui.ctx());
    if let Some(trouble) = findings.trouble.as_ref().or(findings.results.trouble.as_ref()) {
        let mut text = format!("{trouble}.");
        text.get_mut(..1).into_iter().for_each(str::make_ascii_uppercase);
        ui.label(RichText::new(text).small().color(theme.warning));
    } else if findings.progress.finished {
        let now = context.jobs.twin().and_then(Twin::error).filter(|_| is_used(context, &findings.results));
        let is_above = now.is_some_and(|now| now > findings.results.wanted);
        let text = RichText::new(words(context, &findings.results)).small();
        // A line that comes and goes would move all below it.
        if is_above {
            let above = "The error now is above the wanted one: set it again to search from here.";
            ui.label(text.color(theme.warning)).on_hover_text(above);
        } else {
            ui.label(text).on_hover_text(tr(help));
        }
    }
}

/// Whether the scene steps with what was found.
fn is_used(context: &PanelContext<'_>, findings: &DialFindings) -> bool {
    let level = &context.now.level;
    let same = |Reached { setting, .. }: &Reached| {
        (&level.integrator, level.substeps) == (&setting.integrator, setting.substeps)
    };
    findings.cheapest.as_ref().is_some_and(same)
}

/// What was found, and what it costs.
fn words(context: &PanelContext<'_>, findings: &DialFindings) -> String {
    let wanted = percent(findings.wanted);
    let Some(Reached { setting, outcome }) = &findings.cheapest else {
        return format!("Nothing reaches {wanted} here.");
    };
    if !is_used(context, findings) {
        return format!("For {wanted}: {}, which is not used now.", setting.label());
    }
    let frame = |ms: f64| numbers::si(1e-3 * ms / 60.0, "s");
    let mut text = format!("{wanted} over {SECONDS} s: {} a frame", frame(outcome.ms_per_second));
    if let Some(loose) = &findings.tenfold {
        let digit = (outcome.ms_per_second - loose.outcome.ms_per_second).max(0.0) / outcome.ms_per_second;
        // Writing to a string cannot fail.
        let _ = write!(text, ", {:.0} % of it for the last digit", 100.0 * digit);
    }
    // A second of computation for a second of motion.
    if outcome.ms_per_second > 1e3 {
        text += "; this computer cannot do it in real time";
    }
    text + "."
}
