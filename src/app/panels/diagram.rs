//! Plot of error against processor time for every integrator.

use super::{
    PanelContext, View,
    axes::{self, Label, color_of, write_labels},
    export::{self, Figure},
    scheme::percent,
    segmented::{Segment, segmented},
    studies::{caption, results},
};
use crate::{
    app::{
        jobs::{Diagram, SECONDS, TARGETS},
        numbers,
        theme::Theme,
    },
    command::Command,
    study::{Curve, Outcome, Point, Price, Status, price_in_words},
};
use eframe::egui::{Align2, Color32, ComboBox, RichText, TextStyle, Ui, pos2};
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
pub const HELP: &str = "Every scheme runs the next second from the present state, without the mouse, with many steps.";

/// Common logarithm of the error at which unstable runs are drawn.
const TOP: f64 = 1.0;

pub fn show(ui: &mut Ui, context: &PanelContext<'_>, view: &mut View, commands: &mut Vec<Command>) {
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
    let rect = ui.scope(|ui| plot(ui, diagram, view.studies.diagram.price)).response.rect;
    export::pose(ui, view, Figure::Accuracy, rect);
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
        ui.label("Cheapest under");
        let price = usize::from(settings.price == Price::ForceEvaluations);
        let mut target = settings.target.unwrap_or_else(|| diagram.usual_target(price));
        let before = target;
        let shown = percent(TARGETS[target % TARGETS.len()]);
        let combo = ComboBox::from_id_salt("target").width(72.0).selected_text(shown).show_ui(ui, |ui| {
            for (number, error) in TARGETS.iter().enumerate() {
                ui.selectable_value(&mut target, number, percent(*error));
            }
        });
        combo.response.accessible_name("Error to stay under");
        ui.label("mean error:");
        if target != before {
            settings.target = Some(target);
        }
        match diagram.suggestions.get(target).and_then(|by_price| by_price[price].as_ref()) {
            Some(suggestion) => {
                ui.label(RichText::new(suggestion.to_string()).strong());
                if ui.button("Use it").on_hover_text("Steps like this from now on; Ctrl+Z takes it back.").clicked() {
                    commands.extend(suggestion.commands());
                }
            }
            None => drop(ui.label("nothing measured yet is that accurate.")),
        }
    });
}

fn plot(ui: &mut Ui, diagram: &Diagram, price: Price) {
    let theme = Theme::of(ui.ctx());
    let unit = if price == Price::Time { "processor ms per simulated second" } else { "force evaluations" };
    let measured = |curve: &Curve| -> Vec<(Point, Outcome)> {
        curve.points.iter().filter_map(|point| Some((point.clone(), point.outcome.clone()?))).collect()
    };
    let places = || diagram.curves.iter().flat_map(measured).map(|(_, outcome)| at(&outcome, price));
    let blown = places().any(|[_, y]| y >= TOP);
    let right = places().map(|[x, _]| x).fold(f64::NEG_INFINITY, f64::max);
    let left = places().map(|[x, _]| x).fold(f64::INFINITY, f64::min);
    let mut plot = axes::log_log("work and precision", theme)
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
            let stable: PlotPoints<'_> =
                points.iter().filter(|(_, outcome)| sound(outcome)).map(|(_, outcome)| at(outcome, price)).collect();
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
            Some(Label { at: screen(at(last, price)), text: label(curve), color: color_of(&curve.integrator, theme) })
        })
        .collect();
    write_labels(ui, frame, &labels);
}

fn sound(outcome: &Outcome) -> bool {
    outcome.status == Status::Ok && outcome.error > 0.0
}

/// Point of a run, in common logarithms. An unstable run lies at the top.
fn at(outcome: &Outcome, price: Price) -> [f64; 2] {
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
    let points = Points::new(story(diagram, point, outcome), vec![at(outcome, price)]);
    points.shape(shape).filled(filled).radius(radius).color(color)
}

/// Tooltip of a run.
fn story(diagram: &Diagram, point: &Point, outcome: &Outcome) -> String {
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
fn label(curve: &Curve) -> String {
    let title = curve.integrator.kind().title();
    match curve.order {
        Ok(order) => format!("{title}, order {order:.2}"),
        Err(reason) => format!("{title}, no order: {reason}"),
    }
}
