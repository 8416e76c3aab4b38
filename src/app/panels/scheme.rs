//! Panel of time stepping: integrator, step and stability limit.

use super::{PanelContext, View, apply_response, count, dial, fixed, heading, row, widgets};
use crate::{
    app::{jobs::JobRequest, language::tr, numbers, theme::Theme},
    command::Command,
    integrators::{Class, IntegratorKind, Scheme},
    level::{Sleep, Toggle},
    snapshot::Snapshot,
};
use eframe::egui::{Color32, ComboBox, Rect, RichText, Sense, Ui, vec2};

/// Height of the list of all schemes [points].
const ALL: f32 = 400.0;

pub fn show(ui: &mut Ui, context: &PanelContext<'_>, view: &mut View, commands: &mut Vec<Command>) {
    heading(ui, "Time stepping");
    dial::show(ui, context, view, commands);
    choose(ui, context, commands);
    parameters(ui, context, view, commands);
    gauge(ui, context);
    // A toy has no energy to lose, and never rests.
    if context.now.toy.is_none() {
        ui.horizontal_wrapped(|ui| {
            guard(ui, context, commands);
            sleep(ui, context, commands);
        });
        sleep_tolerance(ui, context, view, commands);
    }
    error_now(ui, context, view);
}

fn choose(ui: &mut Ui, context: &PanelContext<'_>, commands: &mut Vec<Command>) {
    let now = &context.now.level.integrator;
    let toy = context.now.level.toy.is_some();
    let title = now.kind().title();
    let width = ui.available_width();
    let all = ComboBox::from_id_salt("integrator").selected_text(title).width(width).height(ALL);
    let combo = all.show_ui(ui, |ui| {
        let own = Some(now.clone()).filter(|kind| matches!(kind, IntegratorKind::Own(_)));
        for kind in IntegratorKind::all().into_iter().chain(own) {
            let fits = !toy || matches!(kind.kind().scheme(), Scheme::First(_));
            let chosen = kind.name() == now.name();
            let response = ui.add_enabled_ui(fits, |ui| ui.selectable_label(chosen, kind.kind().title())).inner;
            if response.on_hover_text(kind.kind().about()).clicked() && !chosen {
                commands.extend([Command::SetIntegrator(kind), Command::EndGesture]);
            }
        }
    });
    combo.response.on_hover_text(now.kind().about());
}

fn parameters(ui: &mut Ui, context: &PanelContext<'_>, view: &mut View, commands: &mut Vec<Command>) {
    let mut changed = context.now.level.integrator.clone();
    let mut sum = widgets::SliderResponse::default();
    for (number, parameter) in changed.kind_mut().parameters().into_iter().enumerate() {
        let outcome = ui.push_id(("scheme", number), |ui| widgets::quantity(ui, parameter)).inner;
        sum.changed |= outcome.changed;
        sum.ended |= outcome.ended;
        sum.refused = outcome.refused.or(sum.refused.take());
    }
    apply_response(sum, Some(Command::SetIntegrator(changed)), view, commands);
}

/// Draws the ratio of the step to the longest stable step, as a bar and in a sentence.
fn gauge(ui: &mut Ui, context: &PanelContext<'_>) {
    let integrator = context.now.level.integrator.kind();
    let scene = context.now.level.substeps.step();
    let step = context.now.substep_plans.iter().map(|plan| plan.step).fold(scene, f64::min);
    let theme = Theme::of(ui.ctx());
    let (words, share) = match (integrator.class(), context.jobs.limit()) {
        (Class::Implicit, _) => {
            // Implicit Euler reduces the amplitude of a vibration with h w = 0.5 by a tenth in every step.
            let unresolved = numbers::si(0.5 / (std::f64::consts::TAU * step), "Hz");
            (format!("Stable for every step length; vibrations faster than {unresolved} are not resolved."), None)
        }
        (Class::ErrorControlled, _) => ("Chooses its own steps; the tolerance limits its error.".to_owned(), None),
        (Class::Explicit, None) if context.now.level.toy.is_some() => (
            "No stability limit is known for this toy problem; the step length determines the accuracy.".to_owned(),
            None,
        ),
        (Class::Explicit, None) => {
            ("No stiffness here limits the step length; it determines the accuracy.".to_owned(), None)
        }
        (Class::Explicit, Some(limit)) => {
            let limit = 0.5 * integrator.stability_limit().unwrap_or(2.0) * limit;
            (verdict(step, limit, step < scene, context.now.level.guard), Some(step / limit))
        }
    };
    if let Some(share) = share {
        let color = if share > 1.0 {
            theme.bad
        } else if share > 0.8 {
            theme.warning
        } else {
            theme.good
        };
        bar(ui, share, color);
    }
    let help = "Step length h over the stability limit 2/ω, where ω² is the largest eigenvalue of M⁻¹K in the present state; the limit changes as the body deforms.";
    ui.label(RichText::new(words).small()).on_hover_text(tr(help));
}

/// Draws the switch of the guard and its present division of steps.
fn guard(ui: &mut Ui, context: &PanelContext<'_>, commands: &mut Vec<Command>) {
    let now = context.now;
    let help = "Repeats a step as up to 64 shorter ones when it is unstable: when the total energy grows although no work is done, \
                or a value is not finite. Switch it off to see the instability.";
    let mut on = now.level.guard == Toggle::On;
    if ui.checkbox(&mut on, tr("Guard")).on_hover_text(tr(help)).changed() {
        commands.extend([Command::SetGuard(on.into()), Command::EndGesture]);
    }
    let words = match (on && now.guarded > 0, now.guard_substeps) {
        (false, _) => return,
        (true, 1) if now.guarded == 1 => "1 step was divided into shorter ones".to_owned(),
        (true, 1) => format!("{} steps were divided into shorter ones", count(now.guarded as usize)),
        (true, parts) => format!("divides each step into {parts}; {} steps so far", count(now.guarded as usize)),
    };
    let color = if now.guard_substeps > 1 { ui.visuals().warn_fg_color } else { ui.visuals().text_color() };
    ui.label(RichText::new(words).small().color(color)).on_hover_text(tr(help));
}

/// Draws the switch of sleep and the share of the scene that sleeps.
fn sleep(ui: &mut Ui, context: &PanelContext<'_>, commands: &mut Vec<Command>) {
    let now = context.now;
    let help = "Bodies and nets that have been at rest for half a second are not computed until something acts on them: a pull, or a \
                changed effect or number. While all of them sleep, nothing is redrawn.";
    let mut on = now.level.sleep != Sleep::Off;
    if ui.checkbox(&mut on, tr("Sleep")).on_hover_text(tr(help)).changed() {
        commands.extend([Command::SetSleep(if on { Sleep::On } else { Sleep::Off }), Command::EndGesture]);
    }
    if on && now.level.bodies.iter().any(|body| !body.element.has_six_nodes()) {
        sleep_of_regions(ui, now, commands);
    }
    let words = match (now.asleep, now.part_count(), now.regions) {
        (0, _, [0, _]) => return,
        (0, _, [asleep, all]) => format!("{asleep} of {all} regions sleep"),
        (asleep, all, _) if asleep == all => "everything sleeps".to_owned(),
        (asleep, all, [0, _]) => format!("{asleep} of {all} sleep"),
        (asleep, all, [regions, _]) => format!("{asleep} of {all} sleep, and {regions} regions"),
    };
    ui.label(RichText::new(words).small()).on_hover_text(tr(help));
}

/// Draws the switch of sleep of regions.
fn sleep_of_regions(ui: &mut Ui, now: &Snapshot, commands: &mut Vec<Command>) {
    let help = "Regions of a body that pins hold sleep too while the rest of it moves. A region wakes when something beside it has moved by more than \
                the tolerance, a share of the size of the region. What sleeps is off by about this share of the size of the body.";
    let mut on = matches!(now.level.sleep, Sleep::Regions(_));
    if ui.checkbox(&mut on, tr("Regions of bodies")).on_hover_text(tr(help)).changed() {
        let sleep = if on { Sleep::Regions(Sleep::TOLERANCE) } else { Sleep::On };
        commands.extend([Command::SetSleep(sleep), Command::EndGesture]);
    }
}

/// Draws the tolerance of sleeping regions.
fn sleep_tolerance(ui: &mut Ui, context: &PanelContext<'_>, view: &mut View, commands: &mut Vec<Command>) {
    if let Sleep::Regions(mut tolerance) = context.now.level.sleep {
        let response = widgets::quantity(ui, &mut tolerance);
        apply_response(response, Some(Command::SetSleep(Sleep::Regions(tolerance))), view, commands);
    }
}

/// Sentence about the step and its limit; `own` is true if the step is that of the stiffest body alone.
fn verdict(step: f64, limit: f64, own: bool, guard: Toggle) -> String {
    if limit <= 0.0 {
        "Unstable for every step length: undamped vibrations grow. Damping or a short run can hide it.".to_owned()
    } else if step > limit && guard == Toggle::On {
        format!("Stable up to {}; this step is longer, and the guard divides it.", numbers::si(limit, "s"))
    } else if step > limit {
        format!("Stable up to {}; this step is longer, so the run will be unstable.", numbers::si(limit, "s"))
    } else if own {
        format!(
            "Stable up to {}; the stiffest body takes steps of {}.",
            numbers::si(limit, "s"),
            numbers::si(step, "s")
        )
    } else {
        format!("Stable up to {}.", numbers::si(limit, "s"))
    }
}

fn bar(ui: &mut Ui, share: f64, color: Color32) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 10.0), Sense::hover());
    response.on_hover_text(format!("{:.0} % of the longest stable step", 100.0 * share));
    ui.painter().rect_filled(rect, 5.0, ui.visuals().extreme_bg_color);
    // The limit lies at two thirds of the bar, so that steps beyond the limit can be compared with it.
    let filled = rect.width() * (share / 1.5).clamp(0.02, 1.0) as f32;
    ui.painter().rect_filled(Rect::from_min_size(rect.min, vec2(filled, rect.height())), 5.0, color);
    let mark = rect.left() + rect.width() / 1.5;
    ui.painter().vline(mark, rect.y_range(), (1.5, ui.visuals().strong_text_color()));
}

/// Draws the switch of the twin, a copy with short steps, and the present error of the scene.
fn error_now(ui: &mut Ui, context: &PanelContext<'_>, view: &mut View) {
    let mut on = context.jobs.twin().is_some();
    let help = "Compares positions with the exact solution where one is known; otherwise with a reference: a second run of the same \
                scene with far shorter steps and the same pull of the mouse. The error is sqrt(mean |x − x_ref|²) over the root mean \
                square of the displacements.";
    if ui.checkbox(&mut on, tr("Measure the error now")).on_hover_text(tr(help)).changed() {
        view.requests.push(JobRequest::Twin(on));
    }
    let Some(twin) = context.jobs.twin() else { return };
    let still = if twin.age() > 0.0 { "nothing moves" } else { "–" };
    let error = twin.error().map_or_else(|| still.to_owned(), percent);
    row(ui, tr("Error now"), &error, help);
    if let Some(exact) = twin.exact() {
        ui.label(
            RichText::new(format!("Compared with the exact solution: {}.", exact.words.trim_end_matches('.'))).small(),
        );
        return;
    }
    let own = match (twin.is_checking(), twin.error()) {
        (true, _) => "checking".to_owned(),
        (false, Some(_)) => percent(twin.own_error()),
        (false, None) => "–".to_owned(),
    };
    row(
        ui,
        tr("Error of the reference"),
        &own,
        "Difference between the reference run and one with half its step length",
    );
    let cost = "Processor time of the reference run for 1 s of simulated time [s]";
    row(ui, tr("Cost of the reference"), &fixed(twin.ms_per_second() * 1e-3, "s"), cost);
}

/// Formats a share in per cent with three digits.
pub fn percent(share: f64) -> String {
    if share == 0.0 || share >= 1e-5 {
        format!("{} %", three(100.0 * share))
    } else {
        format!("{:.1e} %", 100.0 * share)
    }
}

fn three(value: f64) -> String {
    let digits = (2.0 - value.abs().max(1e-9).log10().floor()).clamp(0.0, 6.0) as usize;
    format!("{value:.digits$}")
}
