//! Plot of energy and momentum over time for every integrator.

use super::{
    PanelContext, View,
    axes::{self, Label, color_of, write_labels},
    export::{self, Figure},
    segmented::{Segment, segmented},
    studies::{caption, results},
};
use crate::{
    app::{
        jobs::{Course, Courses},
        numbers,
        theme::Theme,
    },
    study::{Invariant, Status},
};
use eframe::egui::{ComboBox, RichText, Ui};
use egui_plot::{HoverPosition, Line, MarkerShape, PlotPoint, Points};

/// Display settings of the drift plot.
#[derive(Default)]
pub struct DriftSettings {
    /// Index in [`Invariant::ALL`].
    invariant: usize,
    /// Index in [`TIMES`].
    time: usize,
}

/// Simulated times to choose from [s].
const TIMES: [f64; 4] = [2.0, 5.0, 20.0, 60.0];

/// Common logarithms of the least and greatest change that is drawn; others are drawn at the edge.
const EDGES: [f64; 2] = [-17.0, 3.0];

/// Tooltip of the measurement.
pub const HELP: &str = "Every scheme runs from the present state, without the mouse; explicit ones with the present step length, \
                        implicit ones with steps ten times as long, as each takes more computing time.";

impl DriftSettings {
    /// Simulated time [s].
    pub fn seconds(&self) -> f64 {
        TIMES.get(self.time).copied().unwrap_or(TIMES[0])
    }
}

pub fn show(ui: &mut Ui, context: &PanelContext<'_>, view: &mut View) {
    choose(ui, &mut view.studies.drift);
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
    if !courses.touching.is_empty() {
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
        Invariant::Energy => "Greatest change of the energy so far, over the greatest kinetic energy.".to_owned(),
        _ => format!("Greatest change of the {} so far [{}].", invariant.title(), invariant.unit()),
    };
    caption(ui, view, Figure::Drift, &about, &courses.level, &courses.csv);
    let rect = ui.scope(|ui| plot(ui, courses, number, *invariant)).response.rect;
    export::pose(ui, view, Figure::Drift, rect);
}

fn choose(ui: &mut Ui, settings: &mut DriftSettings) {
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
        shown.response.on_hover_text(help).accessible_name("Simulated time of the study");
    });
}

fn plot(ui: &mut Ui, courses: &Courses, number: usize, invariant: Invariant) {
    let theme = Theme::of(ui.ctx());
    let lines: Vec<_> = courses.each.iter().map(|course| (course, line(&course.changes[number]))).collect();
    let unit = invariant.unit();
    let axis = if unit.is_empty() {
        "change of energy".to_owned()
    } else {
        format!("change of {} [{unit}]", invariant.title())
    };
    let shown = axes::log_y("drift", theme)
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
                plot.line(Line::new(story(course), line.clone()).color(color).width(width));
                let Some(end) = line.last() else { continue };
                let (shape, radius) = match (course.status, course.current) {
                    (Status::Unstable, _) => (MarkerShape::Cross, 6.0),
                    (_, true) => (MarkerShape::Circle, 7.0),
                    (_, false) => (MarkerShape::Circle, 2.5),
                };
                let points = Points::new(story(course), vec![*end]).shape(shape).radius(radius);
                plot.points(points.color(color).filled(true));
            }
        });
    let screen = |[x, y]: [f64; 2]| shown.transform.position_from_point(&PlotPoint::new(x, y));
    let label = |(course, line): &(&Course, Vec<[f64; 2]>)| {
        let at = screen(*line.last()?);
        let color = color_of(&course.setting.integrator, theme);
        Some(Label { at, text: label(course, invariant), color })
    };
    let labels: Vec<_> = lines.iter().filter_map(label).collect();
    write_labels(ui, *shown.transform.frame(), &labels);
}

/// Points of a course: time and common logarithm of the change. The beginning, where nothing has changed yet, is left out.
fn line(changes: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let [low, high] = EDGES;
    let logarithm = |change: f64| if change.is_finite() { change.log10().clamp(low, high) } else { high };
    let changed = changes.iter().filter(|[_, change]| *change > 0.0 || change.is_nan());
    changed.map(|[time, change]| [*time, logarithm(*change)]).collect()
}

/// Label of a course: the scheme, and whether it gained or lost energy by the end.
fn label(course: &Course, invariant: Invariant) -> String {
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
fn story(course: &Course) -> String {
    let now = if course.current { " (now)" } else { "" };
    let ended = match course.status {
        Status::Ok => "",
        Status::Unstable => "\nunstable",
        Status::Unconverged => "\nsome equations were left unsolved",
    };
    format!("{}{now}{ended}", course.setting.label())
}
