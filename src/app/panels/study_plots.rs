//! Plots of the studies: error against processor time for integrators and for meshes; energy and momentum over time.

use super::{
    PanelContext, View, count,
    plotting::{self, Figure, Label, color_of, write_labels},
    scheme::percent,
    studies::{caption, results},
    widgets::{Segment, segmented},
};
use crate::{
    app::{
        jobs::{Course, Courses, Diagram, Mesh, MeshFindings, SECONDS, TARGETS},
        language::tr,
        numbers,
        theme::Theme,
    },
    clock::MILLISECONDS,
    command::Command,
    study::{
        Curve, Invariant, LockingNumber, Measure, MeasuredOrder, MeshMoment, MeshReference, MeshSeries, Outcome, Point,
        Price, Status, price_in_words,
    },
};
use eframe::egui::{Align2, Color32, ComboBox, Grid, RichText, TextStyle, Ui, pos2};
use egui_plot::{HoverPosition, Line, MarkerShape, PlotPoint, PlotPoints, Points};

/// Display settings of the diagram.
#[derive(Default)]
pub struct DiagramSettings {
    /// Quantity of the horizontal axis.
    pub price: Price,
    /// Number of the chosen target error; without a choice, a default target that is reached.
    pub target: Option<usize>,
}

/// Tooltip of the measurement.
pub const ACCURACY_HELP: &str =
    "Every scheme runs the next second from the present state, without the mouse, with many steps.";

/// Common logarithm of the error at which unstable runs are drawn.
const TOP: f64 = 1.0;

pub fn show_accuracy(ui: &mut Ui, context: &PanelContext<'_>, view: &mut View, commands: &mut Vec<Command>) {
    let invitation = "Every scheme runs the next second from the present state, without the mouse, with many steps; each run \
                      is a point.";
    let Some(diagram) = results(ui, context.jobs.accuracy.findings(), invitation) else { return };
    if let Some(why) = &diagram.no_errors {
        ui.label(RichText::new(format!("{why}.")).color(Theme::of(ui.ctx()).warning));
    } else {
        suggest(ui, diagram, view, commands);
    }
    let reference = diagram.reference.as_ref();
    let about = reference.map_or_else(
        || "Looking for a reference to measure errors against.".to_owned(),
        |(source, own)| {
            let own = if diagram.no_errors.is_none() {
                format!("; the error of that reference is {}. Times: {}", percent(*own), price_in_words())
            } else {
                String::new()
            };
            format!("{SECONDS} s, compared with {source}{own}.")
        },
    );
    caption(ui, view, Figure::Accuracy, &about, &diagram.level, &diagram.csv);
    if diagram.no_errors.is_some() {
        return;
    }
    let rect = ui.scope(|ui| plot_accuracy(ui, diagram, view.studies.diagram.price)).response.rect;
    plotting::pose(ui, view, Figure::Accuracy, rect);
}

fn suggest(ui: &mut Ui, diagram: &Diagram, view: &mut View, commands: &mut Vec<Command>) {
    let settings = &mut view.studies.diagram;
    ui.horizontal_wrapped(|ui| {
        let parts = [
            (Price::Time, "Time", "Measured processor time [ms] for a simulated second"),
            (
                Price::ForceEvaluations,
                "Force evaluations",
                "The same on every computer, but the time for solving equations is not counted",
            ),
        ];
        let segments =
            parts.map(|(price, text, about)| Segment { text, name: text, about, on: settings.price == price });
        if let Some((price, ..)) = segmented(ui, "price", &segments, false).and_then(|clicked| parts.get(clicked)) {
            settings.price = *price;
        }
        ui.label(tr("Cheapest under"));
        let price = usize::from(settings.price == Price::ForceEvaluations);
        let mut target = settings.target.unwrap_or_else(|| diagram.usual_target(price));
        let before = target;
        let shown = percent(TARGETS[target % TARGETS.len()]);
        let combo = ComboBox::from_id_salt("target").width(72.0).selected_text(shown).show_ui(ui, |ui| {
            for (number, error) in TARGETS.iter().enumerate() {
                ui.selectable_value(&mut target, number, percent(*error));
            }
        });
        combo.response.accessible_name(tr("Error to stay under"));
        ui.label(tr("mean error:"));
        if target != before {
            settings.target = Some(target);
        }
        match diagram.suggestions.get(target).and_then(|by_price| by_price[price].as_ref()) {
            Some(suggestion) => {
                ui.label(RichText::new(suggestion.to_string()).strong());
                if ui
                    .button(tr("Use it"))
                    .on_hover_text(tr("Steps like this from now on; Ctrl+Z takes it back."))
                    .clicked()
                {
                    commands.extend(suggestion.commands());
                }
            }
            None => drop(ui.label(tr("nothing measured yet is that accurate."))),
        }
    });
}

fn plot_accuracy(ui: &mut Ui, diagram: &Diagram, price: Price) {
    let theme = Theme::of(ui.ctx());
    let unit = if price == Price::Time {
        format!("{MILLISECONDS} per simulated second")
    } else {
        "force evaluations".to_owned()
    };
    let measured = |curve: &Curve| -> Vec<(Point, Outcome)> {
        curve.points.iter().filter_map(|point| Some((point.clone(), point.outcome.clone()?))).collect()
    };
    let places = || diagram.curves.iter().flat_map(measured).map(|(_, outcome)| outcome_at(&outcome, price));
    let blown = places().any(|[_, y]| y >= TOP);
    let right = places().map(|[x, _]| x).fold(f64::NEG_INFINITY, f64::max);
    let left = places().map(|[x, _]| x).fold(f64::INFINITY, f64::min);
    let mut plot = plotting::log_log("work and precision", theme)
        .x_axis_label(unit)
        .y_axis_label("relative RMS position error, mean over frames")
        .label_formatter(|hovered| match hovered {
            HoverPosition::NearDataPoint { plot_name, .. } => Some((*plot_name).to_owned()),
            HoverPosition::Elsewhere { .. } => None,
        });
    if left.is_finite() {
        // The margin leaves room for the names of the lines.
        plot = plot.include_x(right + 0.36 * (right - left).max(1.0)).include_y(TOP + 0.4);
    }
    let shown = plot.show(ui, |plot| {
        for curve in &diagram.curves {
            let color = color_of(&curve.integrator, theme);
            let points = measured(curve);
            let stable: PlotPoints<'_> = points
                .iter()
                .filter(|(_, outcome)| sound(outcome))
                .map(|(_, outcome)| outcome_at(outcome, price))
                .collect();
            plot.line(Line::new(curve.integrator.name(), stable).color(color).width(1.6).allow_hover(false));
            for (point, outcome) in &points {
                plot.points(marker(diagram, point, outcome, price, color));
            }
        }
    });
    let screen = |[x, y]: [f64; 2]| shown.transform.position_from_point(&PlotPoint::new(x, y));
    let frame = *shown.transform.frame();
    if blown {
        let at = pos2(frame.left() + 8.0, screen([0.0, TOP]).y - 9.0);
        let font = TextStyle::Small.resolve(ui.style());
        ui.painter_at(frame).text(at, Align2::LEFT_BOTTOM, "× unstable", font, theme.bad);
    }
    let labels: Vec<_> = diagram
        .curves
        .iter()
        .filter_map(|curve| {
            let points = measured(curve);
            let (_, last) = points.iter().rev().find(|(_, outcome)| sound(outcome))?;
            Some(Label {
                at: screen(outcome_at(last, price)),
                text: curve_label(curve),
                color: color_of(&curve.integrator, theme),
            })
        })
        .collect();
    write_labels(ui, frame, &labels);
}

fn sound(outcome: &Outcome) -> bool {
    outcome.status == Status::Ok && outcome.error > 0.0
}

/// Point of a run, in common logarithms. An unstable run lies at the top.
fn outcome_at(outcome: &Outcome, price: Price) -> [f64; 2] {
    let blown = outcome.status == Status::Unstable || !outcome.error.is_finite();
    let error = if blown { TOP } else { outcome.error.max(1e-16).log10().min(TOP) };
    [price.of(outcome).max(1e-6).log10(), error]
}

/// Marker of a run: a large filled dot for the current setting and small dots for other runs. Unstable runs are crosses, runs with
/// unsolved equations are empty squares.
fn marker<'a>(diagram: &Diagram, point: &Point, outcome: &Outcome, price: Price, color: Color32) -> Points<'a> {
    let (shape, radius) = match (outcome.status, point.current) {
        (Status::Ok, true) => (MarkerShape::Circle, 7.0),
        (Status::Ok, false) => (MarkerShape::Circle, 2.5),
        (Status::Unconverged, _) => (MarkerShape::Square, 4.0),
        (Status::Unstable, true) => (MarkerShape::Cross, 7.0),
        (Status::Unstable, false) => (MarkerShape::Cross, 4.0),
    };
    let filled = outcome.status != Status::Unconverged;
    let points = Points::new(outcome_story(diagram, point, outcome), vec![outcome_at(outcome, price)]);
    points.shape(shape).filled(filled).radius(radius).color(color)
}

/// Tooltip of a run.
fn outcome_story(diagram: &Diagram, point: &Point, outcome: &Outcome) -> String {
    let note = diagram.limits.note(outcome.error).map_or_else(String::new, |note| format!(" ({})", note.words()));
    let errors = || format!("mean error {}{note}, largest {}", percent(outcome.error), percent(outcome.greatest_error));
    let came = match outcome.status {
        Status::Unstable => "unstable".to_owned(),
        Status::Ok => errors(),
        Status::Unconverged => format!("{}, some equations not solved", errors()),
    };
    let time = numbers::si(1e-3 * outcome.ms_per_second, "s");
    let now = if point.current { " (now)" } else { "" };
    let runs = outcome.runs;
    format!("{}{now}\n{came}\n{time} for a simulated second, least of {runs}", point.setting.label())
}

/// Label of a scheme with its measured order.
fn curve_label(curve: &Curve) -> String {
    let title = curve.integrator.kind().title();
    match curve.order {
        Ok(order) => format!("{title}, order {order:.2}"),
        Err(reason) => format!("{title}, no order: {reason}"),
    }
}

/// Display settings of the mesh plot.
#[derive(Default)]
pub struct MeshPlotSettings {
    /// Quantity that is compared between meshes.
    pub measure: Measure,
    /// Whether meshes are also refined only where the stress has its error.
    pub adaptive: bool,
}

/// Tooltip of the measurement.
pub const MESHES_HELP: &str = "The level from its start, on meshes of 1/64 to 4 times as many triangles.";

pub fn show_meshes(ui: &mut Ui, context: &PanelContext<'_>, view: &mut View) {
    let settings = &mut view.studies.meshes;
    let parts = [
        (Measure::TipDeflection, "Tip deflection", "The greatest displacement of any vertex along x or y [m]"),
        (Measure::ElasticEnergy, "Elastic energy", "The sum over all triangles [J]"),
        (Measure::GreatestStress, "Greatest stress", "The greatest von Mises stress of all triangles [Pa]"),
    ];
    let segments =
        parts.map(|(measure, text, about)| Segment { text, name: text, about, on: settings.measure == measure });
    if let Some((measure, ..)) = segmented(ui, "measure", &segments, false).and_then(|clicked| parts.get(clicked)) {
        settings.measure = *measure;
    }
    let help = "Also compares adaptive meshes of each kind of elements. They begin with the coarsest mesh, and the triangles with the greatest estimated error of the stress are divided. Only for levels whose pins or rollers hold the bodies.";
    ui.checkbox(&mut settings.adaptive, tr("Adaptive meshes too")).on_hover_text(tr(help));
    let invitation = format!(
        "The level from its start, on meshes of 1/64 to 4 times as many triangles: at rest if pins or rollers hold it, else after \
         {SECONDS} s. Each mesh is a point."
    );
    let Some(study) = results(ui, context.jobs.meshes.findings(), &invitation) else { return };
    if let Some(Err(why)) = study.reference {
        ui.label(RichText::new(format!("{why}.")).color(Theme::of(ui.ctx()).warning));
    }
    if study.meshes.is_empty() {
        return;
    }
    mesh_words(ui, study);
    caption(ui, view, Figure::Meshes, &about_meshes(study), &study.level, &study.csv);
    let known = study.meshes.iter().any(|mesh| mesh.error.is_some());
    let rect = ui.scope(|ui| if known { plot_meshes(ui, study) } else { mesh_table(ui, study) }).response.rect;
    plotting::pose(ui, view, Figure::Meshes, rect);
}

/// Text about the compared quantity, its time and its reference.
fn about_meshes(study: &MeshFindings) -> String {
    let when = match study.moment {
        MeshMoment::AtRest => "at rest".to_owned(),
        MeshMoment::AtTheEnd => format!("after {SECONDS} s, as neither pins nor rollers hold the level"),
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
fn mesh_words(ui: &mut Ui, study: &MeshFindings) {
    let known = |(series, order): &(MeshSeries, MeasuredOrder)| Some((*series, order.as_ref().ok().copied()?));
    let orders: Vec<_> = study.orders.iter().filter_map(known).collect();
    if !orders.is_empty() {
        let each = orders.iter().map(|(series, order)| format!("{} h^{order:.2}", series.title().to_lowercase()));
        ui.label(format!("The error falls like: {}.", each.collect::<Vec<_>>().join(", ")))
            .on_hover_text(tr("h: the size of the triangles; the slope of log error over log h where it is steady."));
    } else if let Some((_, Err(reason))) = study.orders.first() {
        ui.label(format!("Order of the error: not measurable here: {reason}."));
    }
    for sentence in &study.remarks {
        ui.label(sentence);
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
        let linear = study.locking.iter().any(|number| number.meshes[0].is_linear);
        let remedy = if tight && linear { " Elements of mean dilatation, or quadratic ones, do not lock." } else { "" };
        let text = format!("Locking: {}.{meshes}{remedy}", numbers.join("; "));
        ui.label(RichText::new(text).color(color)).on_hover_text(tr(help));
    }
}

/// Draws the values so far, as long as the errors are unknown.
fn mesh_table(ui: &mut Ui, study: &MeshFindings) {
    ui.set_min_width(ui.available_width());
    Grid::new("meshes").num_columns(4).spacing([28.0, 4.0]).show(ui, |ui| {
        for title in ["Element", "Triangles", study.measure.title(), "time"] {
            ui.label(RichText::new(title).small().weak());
        }
        ui.end_row();
        for mesh in &study.meshes {
            let point = &mesh.point;
            ui.label(point.series.title());
            ui.monospace(count(point.triangles));
            match (point.value, point.status) {
                (Some(value), _) => ui.monospace(numbers::si_fixed(value, study.measure.unit())),
                (None, Status::Ok) => ui.label("…"),
                (None, Status::Unstable) => ui.label(tr("unstable")),
                (None, Status::Unconverged) => ui.label(tr("no rest found")),
            };
            ui.monospace(if point.ms > 0.0 { numbers::si_fixed(1e-3 * point.ms, "s") } else { String::new() });
            ui.end_row();
        }
    });
}

fn plot_meshes(ui: &mut Ui, study: &MeshFindings) {
    let theme = Theme::of(ui.ctx());
    let known: Vec<_> = study.meshes.iter().filter_map(|mesh| Some((mesh, mesh_at(mesh)?))).collect();
    let what = if study.moment == MeshMoment::AtRest { "to find the rest" } else { "per simulated second" };
    let unit = format!("{MILLISECONDS} {what}");
    let (left, right) =
        known.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, r), (_, [x, _])| (l.min(*x), r.max(*x)));
    let mut all: Vec<_> = study.meshes.iter().map(|mesh| mesh.point.series).collect();
    all.dedup();
    let color = |series: MeshSeries| {
        let place = all.iter().position(|other| *other == series).unwrap_or(0);
        theme.series[place % theme.series.len()]
    };
    let shown = plotting::log_log("meshes", theme)
        .x_axis_label(unit)
        .y_axis_label(format!("relative error of the {}", study.measure.title()))
        .include_x(right + 0.2 * (right - left).max(0.5))
        .label_formatter(|hovered| match hovered {
            HoverPosition::NearDataPoint { plot_name, .. } => Some((*plot_name).to_owned()),
            HoverPosition::Elsewhere { .. } => None,
        })
        .show(ui, |plot| {
            for series in &all {
                let own = known.iter().filter(|(mesh, _)| mesh.point.series == *series);
                let line: Vec<_> = own.map(|(_, at)| *at).collect();
                plot.line(Line::new(series.title(), line).color(color(*series)).width(1.6).allow_hover(false));
            }
            for (mesh, at) in &known {
                let radius = if mesh.current { 7.0 } else { 3.5 };
                let points = Points::new(mesh_story(study, mesh), vec![*at]).shape(MarkerShape::Circle).radius(radius);
                // The reference is extrapolated beyond the finest mesh. An error not above that of the reference is only an estimate.
                let own = study.reference.and_then(Result::ok).map(|reference| reference.own_error);
                let estimate = mesh.error.zip(own).is_some_and(|(error, own)| error <= own);
                plot.points(points.color(color(mesh.point.series)).filled(!estimate));
            }
        });
    let screen = |[x, y]: [f64; 2]| shown.transform.position_from_point(&PlotPoint::new(x, y));
    let label = |(mesh, at): &(&Mesh, [f64; 2])| {
        let now = if mesh.current { " triangles, now" } else { "" };
        // The last point of a line names it.
        let series = mesh.point.series;
        let last = known.iter().rfind(|(other, _)| other.point.series == series);
        let is_last = last.is_some_and(|(other, _)| std::ptr::eq(*other, *mesh));
        let name = if is_last { series.title() + ", " } else { String::new() };
        let color = if is_last { color(series) } else { theme.text };
        Label { at: screen(*at), text: name + &count(mesh.point.triangles) + now, color }
    };
    let labels: Vec<_> = known.iter().map(label).collect();
    write_labels(ui, *shown.transform.frame(), &labels);
}

/// Point of a mesh, in common logarithms.
fn mesh_at(mesh: &Mesh) -> Option<[f64; 2]> {
    Some([mesh.point.ms.max(1e-3).log10(), mesh.error?.max(1e-16).log10()])
}

/// Tooltip of a mesh.
fn mesh_story(study: &MeshFindings, mesh: &Mesh) -> String {
    let point = &mesh.point;
    let value = point.value.map_or_else(String::new, |value| numbers::si(value, study.measure.unit()));
    let error = mesh.error.map_or_else(String::new, percent);
    let (triangles, vertices) = (count(point.triangles), count(point.vertices));
    let size = numbers::si(point.size, "m");
    let (title, time) = (study.measure.title(), numbers::si(1e-3 * point.ms, "s"));
    let runs = point.runs;
    let kind = point.series.title();
    format!(
        "{kind}: {triangles} triangles of {size}, {vertices} vertices\n{title} {value}, error {error}\n{time}, least of {runs}"
    )
}

/// Display settings of the drift plot.
#[derive(Default)]
pub struct DriftSettings {
    /// Index in [`Invariant::ALL`].
    invariant: usize,
    /// Index in [`TIMES`].
    time: usize,
}

/// Simulated times to choose from \[s\].
const TIMES: [f64; 4] = [2.0, 5.0, 20.0, 60.0];

/// Common logarithms of the least and greatest change that is drawn; others are drawn at the edge.
const EDGES: [f64; 2] = [-17.0, 3.0];

/// Tooltip of the measurement.
pub const DRIFT_HELP: &str = "Every scheme runs from the present state, without the mouse; explicit ones with the present step length, \
                        implicit ones with steps ten times as long, as each takes more computing time.";

impl DriftSettings {
    /// Simulated time \[s\].
    pub fn seconds(&self) -> f64 {
        TIMES.get(self.time).copied().unwrap_or(TIMES[0])
    }
}

pub fn show_drift(ui: &mut Ui, context: &PanelContext<'_>, view: &mut View) {
    choose_invariant(ui, &mut view.studies.drift);
    let invitation = "Every scheme runs from the present state, without the mouse: which schemes conserve energy and momentum, \
                      and which gain or lose some?";
    let Some(courses) = results(ui, context.jobs.drift.findings(), invitation) else { return };
    let number = view.studies.drift.invariant;
    let (Some(invariant), Some((reasons, nothing))) = (Invariant::ALL.get(number), courses.words.get(number)) else {
        return;
    };
    let theme = Theme::of(ui.ctx());
    if let Some(nothing) = nothing {
        ui.label(RichText::new(*nothing).color(theme.warning));
        return;
    }
    if !reasons.is_empty() {
        let text = format!("Here {reasons} also change the {}: that is not an error of a scheme.", invariant.title());
        ui.label(RichText::new(text).color(theme.warning));
    }
    if !courses.touching.is_empty() && *invariant != Invariant::Energy {
        let valid = courses.each.iter().filter(|course| course.status != Status::Unstable).count();
        let who = if courses.touching.len() == valid {
            "all that stay stable".to_owned()
        } else {
            courses.touching.join(", ")
        };
        let text = format!("Walls that are touched change the {} too, for {who}.", invariant.title());
        ui.label(RichText::new(text).color(theme.warning));
    }
    if courses.each.is_empty() {
        return;
    }
    let about = match invariant {
        Invariant::Energy => {
            "Greatest change of the energy and heat less work so far, over the greatest kinetic energy.".to_owned()
        }
        _ => format!("Greatest change of the {} so far [{}].", invariant.title(), invariant.unit()),
    };
    caption(ui, view, Figure::Drift, &about, &courses.level, &courses.csv);
    let rect = ui.scope(|ui| plot_drift(ui, courses, number, *invariant)).response.rect;
    plotting::pose(ui, view, Figure::Drift, rect);
}

fn choose_invariant(ui: &mut Ui, settings: &mut DriftSettings) {
    ui.horizontal_wrapped(|ui| {
        let abouts = [
            "Kinetic, elastic and potential energy together [J]",
            "The sum of m v [kg m/s]",
            "The sum of m x × v about the origin [kg m²/s]",
        ];
        let texts = ["Energy", "Momentum", "Angular momentum"];
        let mut parts = texts.map(|text| Segment { text, name: text, about: "", on: false });
        for (number, (part, about)) in parts.iter_mut().zip(abouts).enumerate() {
            (part.about, part.on) = (about, number == settings.invariant);
        }
        if let Some(clicked) = segmented(ui, "invariant", &parts, false) {
            settings.invariant = clicked;
        }
        let time = |number: usize| TIMES.get(number).map_or_else(String::new, |time| format!("{time} s"));
        let shown = ComboBox::from_id_salt("time").width(64.0).selected_text(time(settings.time)).show_ui(ui, |ui| {
            for number in 0..TIMES.len() {
                ui.selectable_value(&mut settings.time, number, time(number));
            }
        });
        let help = "How much time to simulate when it is measured next.";
        shown.response.on_hover_text(tr(help)).accessible_name(tr("Simulated time of the study"));
    });
}

fn plot_drift(ui: &mut Ui, courses: &Courses, number: usize, invariant: Invariant) {
    let theme = Theme::of(ui.ctx());
    let lines: Vec<_> = courses.each.iter().map(|course| (course, drift_line(&course.changes[number]))).collect();
    let unit = invariant.unit();
    let axis = if unit.is_empty() {
        "change of energy".to_owned()
    } else {
        format!("change of {} [{unit}]", invariant.title())
    };
    let shown = plotting::log_y("drift", theme)
        .x_axis_label("simulated time [s]")
        .y_axis_label(axis)
        .include_x(0.0)
        // The margin leaves room for the names of the lines.
        .include_x(1.42 * courses.seconds)
        .label_formatter(|hovered| match hovered {
            HoverPosition::NearDataPoint { plot_name, .. } => Some((*plot_name).to_owned()),
            HoverPosition::Elsewhere { .. } => None,
        })
        .show(ui, |plot| {
            for (course, line) in &lines {
                let color = color_of(&course.setting.integrator, theme);
                let width = if course.current { 3.0 } else { 1.6 };
                plot.line(Line::new(course_story(course), line.clone()).color(color).width(width));
                let Some(end) = line.last() else { continue };
                let (shape, radius) = match (course.status, course.current) {
                    (Status::Unstable, _) => (MarkerShape::Cross, 6.0),
                    (_, true) => (MarkerShape::Circle, 7.0),
                    (_, false) => (MarkerShape::Circle, 2.5),
                };
                let points = Points::new(course_story(course), vec![*end]).shape(shape).radius(radius);
                plot.points(points.color(color).filled(true));
            }
        });
    let screen = |[x, y]: [f64; 2]| shown.transform.position_from_point(&PlotPoint::new(x, y));
    let label = |(course, line): &(&Course, Vec<[f64; 2]>)| {
        let at = screen(*line.last()?);
        let color = color_of(&course.setting.integrator, theme);
        Some(Label { at, text: course_label(course, invariant), color })
    };
    let labels: Vec<_> = lines.iter().filter_map(label).collect();
    write_labels(ui, *shown.transform.frame(), &labels);
}

/// Points of a course: time and common logarithm of the change. The beginning, where nothing has changed yet, is left out.
fn drift_line(changes: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let [low, high] = EDGES;
    let logarithm = |change: f64| if change.is_finite() { change.log10().clamp(low, high) } else { high };
    let changed = changes.iter().filter(|[_, change]| *change > 0.0 || change.is_nan());
    changed.map(|[time, change]| [*time, logarithm(*change)]).collect()
}

/// Label of a course: the scheme, and whether it gained or lost energy by the end.
fn course_label(course: &Course, invariant: Invariant) -> String {
    let title = course.setting.integrator.kind().title();
    match (course.status, invariant) {
        (Status::Unstable, _) => format!("{title} unstable"),
        (_, Invariant::Energy) if course.gain.abs() >= 1e-4 => {
            let sign = if course.gain > 0.0 { "+" } else { "−" };
            format!("{title} {sign}{} %", numbers::si(100.0 * course.gain.abs(), ""))
        }
        _ => title.to_owned(),
    }
}

/// Tooltip of a course.
fn course_story(course: &Course) -> String {
    let now = if course.current { " (now)" } else { "" };
    let ended = match course.status {
        Status::Ok => "",
        Status::Unstable => "\nunstable",
        Status::Unconverged => "\nsome equations were left unsolved",
    };
    format!("{}{now}{ended}", course.setting.label())
}
