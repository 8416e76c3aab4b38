//! Window of hard cases. They run in the background while the scene goes on.

use super::{
    FileRequest, PanelContext, View,
    plotting::Export,
    widgets::{Segment, segmented},
};
use crate::{
    app::{
        jobs::{Choice, JobRequest, Known},
        language::tr,
        theme::Theme,
    },
    hard::{ACCURATE, Cannot, Case, Entry, Method, Trial},
    materials::Model,
};
use eframe::egui::{
    Align, Button, Color32, ComboBox, Context, Frame, Id, Label, Layout, ProgressBar, RichText, ScrollArea, Sense,
    Shape, Stroke, Ui, Vec2, WidgetInfo, Window, epaint::PathShape, pos2, vec2,
};
use std::{f32::consts::TAU, sync::Arc};

/// Display settings of the hard cases.
pub struct HardSettings {
    /// Whether the window is shown.
    pub open: bool,
    /// Models and methods that are shown and run.
    choice: Choice,
}

impl Default for HardSettings {
    fn default() -> Self {
        Self { open: false, choice: Choice { method: Some(Method::ImplicitEuler), ..Choice::default() } }
    }
}

/// State of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Mark {
    /// Not started.
    Waiting,
    /// Running, with the completed share.
    Going(f32),
    /// Stable, and close to the reference if there is one.
    Held,
    /// Stable, but far from the reference.
    Far,
    /// Not stable, as expected: the file of the case states the reason.
    Cannot,
    /// Not stable, although no reason is stated.
    Failed,
}

impl Mark {
    const fn is_stable(self) -> bool {
        matches!(self, Self::Held | Self::Far)
    }
}

pub fn show(ctx: &Context, context: &PanelContext<'_>, view: &mut View) {
    if !view.hard.open || view.is_posing() {
        return;
    }
    let mut open = view.hard.open;
    let size = ctx.content_rect().size();
    Window::new("Hard cases")
        .id(Id::unique("hard cases"))
        .open(&mut open)
        .default_pos(ctx.content_rect().left_top() + vec2(((size.x - 820.0) / 2.0).max(12.0), 60.0))
        .default_size(vec2((size.x - 48.0).min(660.0), (size.y - 130.0).min(640.0)))
        .min_size(Vec2::new(300.0, 240.0))
        .constrain(true)
        .show(ctx, |ui| {
            let nothing = Known::default();
            let known = context.jobs.hard.findings().map_or(&nothing, |findings| &findings.results);
            top(ui, context, view, known);
            ui.separator();
            ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
                ui.set_max_width(ui.available_width() - 10.0);
                for (name, case) in context.gallery.hard() {
                    row(ui, (name, case), context, view, known);
                }
            });
        });
    view.hard.open = open;
}

/// Draws the choice, the button that runs it, and the number of stable runs.
fn top(ui: &mut Ui, context: &PanelContext<'_>, view: &mut View, known: &Known) {
    let choice = &mut view.hard.choice;
    ui.horizontal_wrapped(|ui| {
        let mut parts = vec![Segment { text: "All", name: "All materials", about: "", on: choice.model.is_none() }];
        parts.extend(Model::ALL.iter().map(|model| Segment {
            text: model.letter(),
            name: model.title(),
            about: model.formula(),
            on: choice.model == Some(*model) && choice.energy.is_none(),
        }));
        let typed = context.now.level.energy(view.body).or(choice.energy.as_deref()).cloned();
        // The choice follows its formula.
        if choice.energy.is_some() && choice.energy.as_deref() != typed.as_ref() {
            choice.energy = typed.clone().map(Arc::new);
        }
        parts.extend(typed.as_ref().map(|energy| Segment {
            text: "ψ",
            name: "Typed energy of the cases",
            about: energy.text(),
            on: choice.energy.is_some(),
        }));
        if let Some(clicked) = segmented(ui, "hard materials", &parts, false) {
            let energy = typed.clone().filter(|_| clicked > Model::ALL.len()).map(Arc::new);
            choice.model = match clicked.checked_sub(1).and_then(|number| Model::ALL.get(number).copied()) {
                None if energy.is_some() => Some(Case::TYPED),
                model => model,
            };
            choice.energy = energy;
        }
        let title = choice.method.map_or("All integrators", Method::title);
        let pick = ComboBox::from_id_salt("hard integrators").selected_text(title).height(400.0);
        let shown = pick.show_ui(ui, |ui| {
            ui.selectable_value(&mut choice.method, None, tr("All integrators"));
            for method in Method::ALL {
                ui.selectable_value(&mut choice.method, Some(method), method.title()).on_hover_text(method.about());
            }
        });
        shown.response.accessible_name(tr("Integrators of hard cases"));
        let help = "The same cases without damping, and not expected to come to rest.";
        ui.checkbox(&mut choice.undamped, tr("Undamped")).on_hover_text(tr(help));
    });
    let choice = choice.clone();
    ui.horizontal(|ui| {
        if context.jobs.hard.is_running() {
            if ui.button(tr("Cancel")).on_hover_text(tr("Stops; what is known stays.")).clicked() {
                view.requests.push(JobRequest::Cancel);
            }
            let done = context.jobs.hard.findings().map_or(0.0, |findings| findings.progress.done);
            ui.add(ProgressBar::new(done as f32).desired_width(90.0));
        } else if ui
            .button(tr("Run all"))
            .on_hover_text(tr("Runs every case with what is chosen, in the background."))
            .clicked()
        {
            view.requests.push(JobRequest::Hard(choice.clone()));
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if known.runs.iter().any(|(_, entry)| entry.verdict.is_some()) {
                let button = Button::new(RichText::new(tr("CSV")).small()).small().min_size(Vec2::new(34.0, 20.0));
                let help = "Saves everything that is known as comma-separated values.";
                if ui.add(button).on_hover_text(tr(help)).accessible_name(tr("Hard cases as CSV")).clicked() {
                    let (name, bytes) = ("hard-cases.csv".to_owned(), known.csv().into_bytes());
                    view.file = Some(FileRequest::Export(Export { name, bytes }));
                }
            }
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                ui.add(Label::new(RichText::new(summary(known, &choice, context)).small().weak()).wrap());
            });
        });
    });
}

/// Number of stable runs among the chosen ones, in a sentence.
fn summary(known: &Known, choice: &Choice, context: &PanelContext<'_>) -> String {
    let of = |wanted: Mark| chosen(known, choice).filter(|(trial, entry)| mark(trial, entry, true) == wanted).count();
    let [held, far, cannot, failed] = [Mark::Held, Mark::Far, Mark::Cannot, Mark::Failed].map(of);
    let models = if choice.model.is_some() { 1 } else { Model::ALL.len() };
    let methods = if choice.method.is_some() { 1 } else { Method::ALL.len() };
    let counts = |case: &Case| !choice.undamped || case.undamped_twin().is_some();
    let cases = context.gallery.hard().iter().filter(|(_, case)| counts(case)).count();
    let all = cases * models * methods;
    if held + far + cannot + failed == 0 {
        return format!("{all} runs. Each must be stable, or its case file states why it cannot.");
    }
    let far = if far > 0 { format!(" ({far} more than {:.0} % off)", 100.0 * ACCURATE) } else { String::new() };
    let cannot = if cannot > 0 { format!(", {cannot} known not to be") } else { String::new() };
    let failed = if failed > 0 { format!(", {failed} failed") } else { String::new() };
    let stable = chosen(known, choice).filter(|(trial, entry)| mark(trial, entry, true).is_stable()).count();
    format!("{stable} of {all} stable{far}{cannot}{failed}.")
}

/// Results of the chosen runs.
fn chosen<'a>(known: &'a Known, choice: &'a Choice) -> impl Iterator<Item = &'a (Trial, Entry)> {
    known.runs.iter().filter(|(trial, _)| choice.takes(trial))
}

fn mark(trial: &Trial, entry: &Entry, running: bool) -> Mark {
    match &entry.verdict {
        Some(Ok(verdict)) if verdict.held() => Mark::Held,
        Some(Ok(verdict)) if verdict.is_stable() => Mark::Far,
        Some(_) if trial.case.cannot(trial.model, trial.method).is_some() => Mark::Cannot,
        Some(_) => Mark::Failed,
        None if running && entry.done > 0.0 => Mark::Going(entry.done as f32),
        None => Mark::Waiting,
    }
}

/// Draws one case.
fn row(ui: &mut Ui, (name, case): (&'static str, &Case), context: &PanelContext<'_>, view: &mut View, known: &Known) {
    let running = context.jobs.hard.is_running();
    let choice = Choice { case: Some(name), ..view.hard.choice.clone() };
    let runs: Vec<_> = chosen(known, &choice).collect();
    let marks: Vec<_> = runs.iter().map(|(trial, entry)| mark(trial, entry, running)).collect();
    let theme = Theme::of(ui.ctx());
    ui.push_id(name, |ui| {
        Frame::new().inner_margin(vec2(2.0, 5.0)).show(ui, |ui| {
            let sum = together(&marks);
            let (text, seconds) = numbers(&runs, &marks);
            let number = |text: String| RichText::new(text).monospace().size(12.0).color(color(sum, theme));
            let beside = ui.horizontal(|ui| {
                paint(ui, sum, 18.0, theme, &format!("{}: {}", case.level.name, words(sum)));
                ui.label(RichText::new(&case.level.name).strong());
                let right = ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                    buttons(ui, &choice, &case.level.name, view);
                    if seconds > 0.0 {
                        ui.label(RichText::new(time(seconds)).small().weak()).on_hover_text(tr("Time spent on it"));
                    }
                    let room = ui.available_width() > 7.5 * text.chars().count() as f32;
                    if room {
                        ui.label(number(text.clone()));
                    }
                    room
                });
                right.inner
            });
            ui.horizontal(|ui| {
                ui.add_space(26.0);
                ui.vertical(|ui| {
                    ui.add(Label::new(RichText::new(&case.level.about).small()).wrap());
                    if !beside.inner && !text.is_empty() {
                        ui.label(number(text));
                    }
                    if runs.len() > 1 {
                        dots(ui, &runs, &marks, theme);
                    }
                    for why in reasons(&runs, &marks) {
                        ui.add(Label::new(RichText::new(why).small().weak()).wrap());
                    }
                });
            });
        });
    });
}

/// Draws the buttons that run one case or open it in the sandbox.
fn buttons(ui: &mut Ui, choice: &Choice, title: &str, view: &mut View) {
    let button = |text: &str| Button::new(RichText::new(text).small()).small().min_size(Vec2::new(40.0, 20.0));
    let model = choice.model.unwrap_or(Model::Corotated);
    let method = choice.method.unwrap_or(Method::ImplicitEuler);
    let energy = choice.energy.clone();
    let material = if energy.is_some() { "the typed energy" } else { model.title() };
    let help = format!("Shows it on the stage, running, with {material} and {}.", method.title());
    if ui.add(button("Open")).on_hover_text(help).accessible_name(format!("Open {title}")).clicked() {
        view.file = choice.case.map(|name| {
            let undamped = choice.undamped;
            FileRequest::Hard { name, undamped, model, energy, method }
        });
    }
    let help = "Runs this case alone with what is chosen.";
    if ui.add(button("Run")).on_hover_text(tr(help)).accessible_name(format!("Run {title}")).clicked() {
        view.requests.push(JobRequest::Hard(choice.clone()));
    }
}

/// Results of the runs of a case, and their computing time \[s\].
fn numbers(runs: &[&(Trial, Entry)], marks: &[Mark]) -> (String, f64) {
    let seconds = runs.iter().map(|(_, entry)| entry.seconds).sum();
    let over = runs.iter().filter(|(_, entry)| entry.verdict.is_some()).count();
    let text = match (runs, over) {
        (_, 0) => String::new(),
        ([(_, Entry { verdict: Some(Ok(verdict)), .. })], _) => {
            format!("{}; {}", verdict.decided_by(), verdict.accuracy())
        }
        ([(_, Entry { verdict: Some(Err(why)), .. })], _) => why.to_string(),
        _ => {
            let of = |wanted: fn(&Mark) -> bool| marks.iter().filter(|mark| wanted(mark)).count();
            let (stable, held) = (of(|mark| mark.is_stable()), of(|mark| *mark == Mark::Held));
            format!("{stable} of {} stable, {held} held", runs.len())
        }
    };
    (text, seconds)
}

/// Reasons why runs of a case are not stable, each once, with its materials.
fn reasons(runs: &[&(Trial, Entry)], marks: &[Mark]) -> Vec<String> {
    let mut found: Vec<(String, Vec<&str>)> = Vec::new();
    for ((trial, _), _) in runs.iter().zip(marks).filter(|(_, mark)| **mark == Mark::Cannot) {
        let Some(Cannot { why, shown_by, .. }) = trial.case.cannot(trial.model, trial.method) else { continue };
        let why = shown_by.map_or_else(|| why.clone(), |experiment| format!("{why} ({experiment})"));
        let at = found.iter().position(|(known, _)| *known == why).unwrap_or(found.len());
        if at == found.len() {
            found.push((why, Vec::new()));
        }
        if !found[at].1.contains(&trial.model.title()) {
            found[at].1.push(trial.model.title());
        }
    }
    found.into_iter().map(|(why, models)| format!("Known not to be stable with {}. {why}", models.join(", "))).collect()
}

/// Draws a small mark for every run, after the letter of its material.
fn dots(ui: &mut Ui, runs: &[&(Trial, Entry)], marks: &[Mark], theme: &Theme) {
    ui.spacing_mut().interact_size.y = 14.0;
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(3.0, 3.0);
        let mut last = None;
        for ((trial, entry), mark) in runs.iter().zip(marks) {
            if last.replace(trial.model) != Some(trial.model) {
                ui.add_space(4.0);
                let letter = if trial.case.energy().is_some() { "ψ" } else { trial.model.letter() };
                ui.label(RichText::new(letter).small().weak());
            }
            let number = match &entry.verdict {
                Some(Ok(verdict)) => format!("\n{}; {}", verdict.decided_by(), verdict.accuracy()),
                _ => String::new(),
            };
            let material = if trial.case.energy().is_some() { "Typed energy" } else { trial.model.title() };
            let about = format!("{material}, {}: {}{number}", trial.method.title(), words(*mark));
            paint(ui, *mark, 13.0, theme, &about);
        }
    });
}

/// Combined mark of several runs.
fn together(marks: &[Mark]) -> Mark {
    let any = |wanted: Mark| marks.contains(&wanted);
    let share = marks.iter().map(|mark| match mark {
        Mark::Going(share) => *share,
        Mark::Waiting => 0.0,
        _ => 1.0,
    });
    let done = share.sum::<f32>() / marks.len().max(1) as f32;
    if any(Mark::Failed) {
        Mark::Failed
    } else if done > 0.0 && done < 1.0 {
        Mark::Going(done)
    } else if marks.is_empty() || any(Mark::Waiting) {
        Mark::Waiting
    } else if any(Mark::Cannot) {
        Mark::Cannot
    } else if any(Mark::Far) {
        Mark::Far
    } else {
        Mark::Held
    }
}

const fn words(mark: Mark) -> &'static str {
    match mark {
        Mark::Waiting => "not run yet",
        Mark::Going(_) => "running",
        Mark::Held => "held",
        Mark::Far => "stable, but far off",
        Mark::Cannot => "known not to be stable, for a stated reason",
        Mark::Failed => "failed",
    }
}

const fn color(mark: Mark, theme: &Theme) -> Color32 {
    match mark {
        Mark::Held => theme.good,
        Mark::Far => theme.warning,
        Mark::Failed => theme.bad,
        Mark::Going(_) => theme.accent_line,
        Mark::Waiting | Mark::Cannot => theme.faint_text,
    }
}

/// Draws a mark: a ring for the completed share, a tick for stable, a dash for known failures, a cross for others.
fn paint(ui: &mut Ui, mark: Mark, size: f32, theme: &Theme, about: &str) {
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(size), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(eframe::egui::Role::Image, true, about));
    response.on_hover_text(tr(about));
    let (painter, color, centre, radius) = (ui.painter(), color(mark, theme), rect.center(), 0.5 * size - 1.0);
    let at = |x: f32, y: f32| pos2(centre.x + x * radius, centre.y + y * radius);
    let thick = Stroke::new(size / 9.0, color);
    let thin = Stroke::new(1.0, theme.line);
    let line = |points: Vec<_>| Shape::Path(PathShape::line(points, thick));
    match mark {
        Mark::Waiting => drop(painter.circle_stroke(centre, radius, thin)),
        Mark::Going(share) => {
            painter.circle_stroke(centre, radius, thin);
            let steps = (48.0 * share).ceil() as u32;
            let angle = |step: u32| TAU * (share * step as f32 / steps.max(1) as f32 - 0.25);
            painter.add(line((0..=steps).map(|step| at(angle(step).cos(), angle(step).sin())).collect()));
        }
        Mark::Held | Mark::Far => {
            painter.circle_filled(centre, radius, color.gamma_multiply(0.22));
            painter.add(line(vec![at(-0.45, 0.02), at(-0.12, 0.38), at(0.48, -0.36)]));
        }
        Mark::Cannot => {
            painter.circle_filled(centre, radius, color.gamma_multiply(0.18));
            painter.add(line(vec![at(-0.4, 0.0), at(0.4, 0.0)]));
        }
        Mark::Failed => {
            painter.circle_filled(centre, radius, color.gamma_multiply(0.22));
            painter.add(line(vec![at(-0.36, -0.36), at(0.36, 0.36)]));
            painter.add(line(vec![at(-0.36, 0.36), at(0.36, -0.36)]));
        }
    }
}

/// Formats a computing time briefly.
fn time(seconds: f64) -> String {
    if seconds < 0.9995 { format!("{:.0} ms", 1e3 * seconds) } else { format!("{seconds:.1} s") }
}
