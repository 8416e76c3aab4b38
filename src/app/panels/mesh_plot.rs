//! Plot of error against processor time for several meshes, and locking.

use super::{
    PanelContext, View,
    axes::{self, Label, write_labels},
    count,
    export::{self, Figure},
    scheme::percent,
    segmented::{Segment, segmented},
    studies::{caption, results},
};
use crate::{
    app::{
        jobs::{Mesh, MeshFindings, SECONDS},
        numbers,
        theme::Theme,
    },
    study::{LockingNumber, Measure, MeshMoment, MeshReference, Status, price_in_words},
};
use eframe::egui::{Grid, RichText, Ui};
use egui_plot::{HoverPosition, Line, MarkerShape, PlotPoint, Points};

/// Display settings of the mesh plot.
#[derive(Default)]
pub struct MeshPlotSettings {
    /// Quantity that is compared between meshes.
    pub measure: Measure,
}

/// Tooltip of the measurement.
pub const HELP: &str = "The level from its start, on meshes of 1/64 to 4 times as many triangles.";

pub fn show(ui: &mut Ui, context: &PanelContext<'_>, view: &mut View) {
    let settings = &mut view.studies.meshes;
    let parts = [
        (Measure::TipDeflection, "Tip deflection", "The greatest displacement of any vertex along x or y [m]"),
        (Measure::ElasticEnergy, "Elastic energy", "The sum over all triangles [J]"),
    ];
    let segments =
        parts.map(|(measure, text, about)| Segment { text, name: text, about, on: settings.measure == measure });
    if let Some((measure, ..)) = segmented(ui, "measure", &segments, false).and_then(|clicked| parts.get(clicked)) {
        settings.measure = *measure;
    }
    let invitation = format!(
        "The level from its start, on meshes of 1/64 to 4 times as many triangles: at rest if pins hold it, else after \
         {SECONDS} s. Each mesh is a point."
    );
    let Some(study) = results(ui, context.jobs.meshes.findings(), &invitation) else { return };
    if let Some(Err(why)) = study.reference {
        ui.label(RichText::new(format!("{why}.")).color(Theme::of(ui.ctx()).warning));
    }
    if study.meshes.is_empty() {
        return;
    }
    words(ui, study);
    caption(ui, view, Figure::Meshes, &about(study), &study.level, &study.csv);
    let known = study.meshes.iter().any(|mesh| mesh.error.is_some());
    let rect = ui.scope(|ui| if known { plot(ui, study) } else { table(ui, study) }).response.rect;
    export::pose(ui, view, Figure::Meshes, rect);
}

/// Text about the compared quantity, its time and its reference.
fn about(study: &MeshFindings) -> String {
    let when = match study.moment {
        MeshMoment::AtRest => "at rest".to_owned(),
        MeshMoment::AtTheEnd => format!("after {SECONDS} s, as pins do not hold the level"),
    };
    let what = study.measure.title();
    match study.reference {
        Some(Ok(MeshReference { value, own_error, .. })) => {
            let (value, own) = (numbers::si(value, study.measure.unit()), percent(own_error));
            let times = price_in_words();
            format!(
                "The {what} {when}, compared with the extrapolated value {value}, whose error is about {own}. Times: {times}."
            )
        }
        Some(Err(_)) => format!("The {what} {when}."),
        None => format!("The {what} {when}; errors are known when the finest mesh is done."),
    }
}

/// Draws the order of the error, and the locking of the triangles.
fn words(ui: &mut Ui, study: &MeshFindings) {
    match study.order {
        Some(Ok(order)) => {
            let finer = 2_f64.powf(order);
            ui.label(format!("Error falls like h^{order:.2}: triangles of half the size are {finer:.1} times better."))
                .on_hover_text("h: the size of the triangles; the slope of log error over log h where it is steady.");
        }
        Some(Err(reason)) => drop(ui.label(format!("Order of the error: not measurable here: {reason}."))),
        None => {}
    }
    let locks = |number: &LockingNumber| {
        let at_most = if number.is_bound() { "at most " } else { "" };
        format!("at ν = {} the tip moves {at_most}{} of what it should", number.poisson, percent(number.ratio()))
    };
    let numbers: Vec<_> = study.locking.iter().map(locks).collect();
    if !numbers.is_empty() {
        let help = "Tip deflection at rest in plane strain on the level's own mesh, over that of a finer mesh, crossed where bodies are \
                    rectangles: linear triangles cannot bend without changing area, and so lock where area is kept. Where the finer \
                    mesh may lock too, the true share is smaller.";
        let tight = study.locking.iter().any(|number| number.is_tight() && number.ratio() < 0.5);
        let theme = Theme::of(ui.ctx());
        let color = if tight { theme.warning } else { theme.text };
        let meshes = study.locking.first().map_or_else(String::new, |number| {
            let [own, better] = number.meshes;
            format!(" Own mesh: {own}; compared with: {better}.")
        });
        let text = format!("Locking: {}.{meshes}", numbers.join("; "));
        ui.label(RichText::new(text).color(color)).on_hover_text(help);
    }
}

/// Draws the values so far, as long as the errors are unknown.
fn table(ui: &mut Ui, study: &MeshFindings) {
    ui.set_min_width(ui.available_width());
    Grid::new("meshes").num_columns(3).spacing([28.0, 4.0]).show(ui, |ui| {
        for title in ["Triangles", study.measure.title(), "time"] {
            ui.label(RichText::new(title).small().weak());
        }
        ui.end_row();
        for mesh in &study.meshes {
            let point = &mesh.point;
            ui.monospace(count(point.triangles));
            match (point.value, point.status) {
                (Some(value), _) => ui.monospace(numbers::si_fixed(value, study.measure.unit())),
                (None, Status::Ok) => ui.label("…"),
                (None, Status::Unstable) => ui.label("unstable"),
                (None, Status::Unconverged) => ui.label("no rest found"),
            };
            ui.monospace(if point.ms > 0.0 { numbers::si_fixed(1e-3 * point.ms, "s") } else { String::new() });
            ui.end_row();
        }
    });
}

fn plot(ui: &mut Ui, study: &MeshFindings) {
    let theme = Theme::of(ui.ctx());
    let known: Vec<_> = study.meshes.iter().filter_map(|mesh| Some((mesh, at(mesh)?))).collect();
    let unit = if study.moment == MeshMoment::AtRest {
        "processor ms to find the rest"
    } else {
        "processor ms per simulated second"
    };
    let (left, right) =
        known.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, r), (_, [x, _])| (l.min(*x), r.max(*x)));
    let color = theme.series[0];
    let shown = axes::log_log("meshes", theme)
        .x_axis_label(unit)
        .y_axis_label(format!("relative error of the {}", study.measure.title()))
        .include_x(right + 0.2 * (right - left).max(0.5))
        .label_formatter(|hovered| match hovered {
            HoverPosition::NearDataPoint { plot_name, .. } => Some((*plot_name).to_owned()),
            HoverPosition::Elsewhere { .. } => None,
        })
        .show(ui, |plot| {
            let line: Vec<_> = known.iter().map(|(_, at)| *at).collect();
            plot.line(Line::new("error", line).color(color).width(1.6).allow_hover(false));
            for (mesh, at) in &known {
                let radius = if mesh.current { 7.0 } else { 3.5 };
                let points = Points::new(story(study, mesh), vec![*at]).shape(MarkerShape::Circle).radius(radius);
                // The reference is extrapolated beyond the finest mesh. An error not above that of the reference is only an estimate.
                let own = study.reference.and_then(Result::ok).map(|reference| reference.own_error);
                let estimate = mesh.error.zip(own).is_some_and(|(error, own)| error <= own);
                plot.points(points.color(color).filled(!estimate));
            }
        });
    let screen = |[x, y]: [f64; 2]| shown.transform.position_from_point(&PlotPoint::new(x, y));
    let label = |(mesh, at): &(&Mesh, [f64; 2])| {
        let now = if mesh.current { " triangles, now" } else { "" };
        Label { at: screen(*at), text: count(mesh.point.triangles) + now, color: theme.text }
    };
    let labels: Vec<_> = known.iter().map(label).collect();
    write_labels(ui, *shown.transform.frame(), &labels);
}

/// Point of a mesh, in common logarithms.
fn at(mesh: &Mesh) -> Option<[f64; 2]> {
    Some([mesh.point.ms.max(1e-3).log10(), mesh.error?.max(1e-16).log10()])
}

/// Tooltip of a mesh.
fn story(study: &MeshFindings, mesh: &Mesh) -> String {
    let point = &mesh.point;
    let value = point.value.map_or_else(String::new, |value| numbers::si(value, study.measure.unit()));
    let error = mesh.error.map_or_else(String::new, percent);
    let (triangles, vertices) = (count(point.triangles), count(point.vertices));
    let size = numbers::si(point.size, "m");
    let (title, time) = (study.measure.title(), numbers::si(1e-3 * point.ms, "s"));
    let runs = point.runs;
    format!(
        "{triangles} triangles of {size}, {vertices} vertices\n{title} {value}, error {error}\n{time}, least of {runs}"
    )
}
