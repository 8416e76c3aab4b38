//! Window of the studies: accuracy, meshes, drift and error budget. A study runs in the background while the scene goes on, and shows its results
//! so far.

use super::{
    PanelContext, View, budget, heading,
    plotting::{self, Figure},
    study_plots,
    widgets::{Segment, segmented},
};
use crate::{
    app::{
        jobs::{Findings, JobRequest, Topic},
        language::tr,
        theme::Theme,
    },
    command::Command,
};
use eframe::egui::{Align, Context, Id, Layout, ProgressBar, RichText, Ui, Vec2, Window};

/// Display settings of the studies.
#[derive(Default)]
pub struct StudiesSettings {
    /// Whether the window is shown.
    pub open: bool,
    /// Chosen topic.
    pub topic: Topic,
    /// Display settings of the accuracy diagram.
    pub diagram: study_plots::DiagramSettings,
    /// Display settings of the mesh plot.
    pub meshes: study_plots::MeshPlotSettings,
    /// Display settings of the drift plot.
    pub drift: study_plots::DriftSettings,
}

/// Topics with short text, name and tooltip.
const TOPICS: [(Topic, &str, &str, &str); 4] = [
    (
        Topic::Accuracy,
        "Accuracy",
        "Work-precision diagram",
        "Runs the next second with every scheme and many steps, and draws error against time.",
    ),
    (
        Topic::Meshes,
        "Meshes",
        "Mesh study",
        "Runs the level on coarser and finer meshes, and draws error against time; tells how much its triangles lock.",
    ),
    (
        Topic::Drift,
        "Drift",
        "Drift study",
        "Runs the next seconds with every scheme, and draws what it does to energy and momentum.",
    ),
    (
        Topic::Budget,
        "Budget",
        "Error budget",
        "Refines one source of error after another, and tells how far each moves the result, and at what cost.",
    ),
];

/// Draws the buttons that open the window.
pub fn buttons(ui: &mut Ui, view: &mut View) {
    heading(ui, "What accuracy costs");
    let settings = &mut view.studies;
    let parts = TOPICS.map(|(topic, text, name, about)| Segment {
        text,
        name,
        about,
        on: settings.open && settings.topic == topic,
    });
    if let Some((topic, ..)) = segmented(ui, "studies", &parts, true).and_then(|clicked| TOPICS.get(clicked)) {
        settings.open = !settings.open || settings.topic != *topic;
        settings.topic = *topic;
        // A panel that covers the stage would overlap the window.
        view.drawer = None;
    }
}

pub fn show(ctx: &Context, context: &PanelContext<'_>, view: &mut View, commands: &mut Vec<Command>) {
    // The picture of a plot beside the window is being taken.
    if view.poses(Figure::Energies) {
        return;
    }
    let mut open = view.studies.open;
    let size = ctx.content_rect().size();
    Window::new("What accuracy costs")
        .id(Id::unique("studies"))
        .open(&mut open)
        .default_pos(ctx.content_rect().left_top() + Vec2::new(((size.x - 960.0) / 2.0).max(12.0), 72.0))
        .default_size(Vec2::new((size.x - 60.0).min(760.0), (size.y - 140.0).min(560.0)))
        .min_size(Vec2::new(320.0, 280.0))
        .constrain(true)
        .show(ctx, |ui| {
            top(ui, context, view);
            match view.studies.topic {
                Topic::Accuracy => study_plots::show_accuracy(ui, context, view, commands),
                Topic::Meshes => study_plots::show_meshes(ui, context, view),
                Topic::Drift => study_plots::show_drift(ui, context, view),
                Topic::Budget => budget::show(ui, context, view),
            }
        });
    view.studies.open = open;
}

/// Draws the choice of the study and the button that starts or stops it.
fn top(ui: &mut Ui, context: &PanelContext<'_>, view: &mut View) {
    ui.horizontal_wrapped(|ui| {
        let now = view.studies.topic;
        let parts = TOPICS.map(|(topic, text, _, about)| Segment { text, name: text, about, on: now == topic });
        if let Some((topic, ..)) = segmented(ui, "topic", &parts, false).and_then(|clicked| TOPICS.get(clicked)) {
            view.studies.topic = *topic;
        }
        let topic = view.studies.topic;
        if context.jobs.is_running(topic) {
            if ui.button(tr("Cancel")).on_hover_text(tr("Stops; what is measured stays.")).clicked() {
                view.requests.push(JobRequest::Cancel);
            }
            let done = context.jobs.done(topic).unwrap_or(0.0);
            ui.add(ProgressBar::new(done as f32).desired_width(110.0));
            ui.label(format!("{:.0} %", 100.0 * done));
            return;
        }
        let (request, help) = match topic {
            Topic::Accuracy => (JobRequest::Accuracy, study_plots::ACCURACY_HELP),
            Topic::Meshes => (
                JobRequest::Meshes(view.studies.meshes.measure, view.studies.meshes.adaptive),
                study_plots::MESHES_HELP,
            ),
            Topic::Drift => (JobRequest::Drift(view.studies.drift.seconds()), study_plots::DRIFT_HELP),
            Topic::Budget => (JobRequest::Budget, budget::HELP),
        };
        if ui.button(tr("Measure")).on_hover_text(tr(help)).clicked() {
            view.requests.push(request);
        }
        if !context.now.level.actions.is_empty() {
            ui.label(
                RichText::new(tr("The scripted actions of this level are not performed in a study.")).small().weak(),
            );
        }
    });
}

/// Results of a study; without results it draws the reason.
pub fn results<'a, R>(ui: &mut Ui, findings: Option<&'a Findings<R>>, invitation: &str) -> Option<&'a R> {
    let Some(findings) = findings else {
        ui.label(invitation);
        return None;
    };
    if let Some(trouble) = &findings.trouble {
        let mut text = trouble.clone();
        // Messages of the library begin with a small letter, because in a terminal they follow a file name.
        text.get_mut(..1).into_iter().for_each(str::make_ascii_uppercase);
        ui.label(RichText::new(text + ".").color(Theme::of(ui.ctx()).warning));
        return None;
    }
    Some(&findings.results)
}

/// Draws the caption above a plot, and the export buttons on the right.
pub fn caption(ui: &mut Ui, view: &mut View, figure: Figure, text: &str, level: &str, table: &str) {
    ui.horizontal(|ui| {
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            plotting::export_buttons(ui, view, figure, level, || table.to_owned());
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                ui.add(eframe::egui::Label::new(RichText::new(text).small().weak()).wrap());
            });
        });
    });
}
