//! The diagram of accuracy against cost, over the window while it is wanted.

use super::{
    Desk, View, heading,
    scheme::percent,
    segmented::{Segment, segmented},
};
use crate::{
    app::{
        lab::{Diagram, SECONDS, TARGETS, Wish},
        theme::Theme,
    },
    command::Command,
    study::{Curve, Outcome, Point, Price, Status},
};
use eframe::egui::{self, Color32, ComboBox, Context, Id, ProgressBar, RichText, Ui, Vec2, Window};
use egui_plot::{Corner, GridMark, Legend, Line, MarkerShape, Plot, PlotPoints, Points};

/// How the diagram is looked at.
#[derive(Default)]
pub struct Look {
    /// Whether it is shown.
    pub open: bool,
    /// What the horizontal axis shows.
    pub price: Price,
    /// Which of the targets is asked about.
    pub target: usize,
}

/// The button that opens it.
pub fn button(ui: &mut Ui, view: &mut View) {
    heading(ui, "Accuracy against time");
    let help = "Runs the next second with every scheme and many steps, and draws error against time.";
    if ui.button("Work-precision diagram").on_hover_text(help).clicked() {
        view.diagram.open = !view.diagram.open;
    }
}

pub fn show(ctx: &Context, desk: &Desk<'_>, view: &mut View, commands: &mut Vec<Command>) {
    let mut open = view.diagram.open;
    let size = ctx.content_rect().size();
    Window::new("Accuracy against time")
        .id(Id::unique("diagram"))
        .open(&mut open)
        .default_pos(ctx.content_rect().left_top() + Vec2::new(((size.x - 900.0) / 2.0).max(12.0), 72.0))
        .default_size(Vec2::new((size.x - 60.0).min(760.0), (size.y - 140.0).min(560.0)))
        .constrain(true)
        .show(ctx, |ui| {
            top(ui, desk, view);
            let Some(diagram) = desk.lab.diagram() else {
                ui.label("Every scheme runs the next second from the present state, without the mouse, with many steps; each run is a point.");
                return;
            };
            if let Some(trouble) = &diagram.trouble {
                ui.colored_label(Theme::of(ui.ctx()).bad, trouble);
            }
            suggest(ui, diagram, view, commands);
            plot(ui, diagram, view.diagram.price);
        });
    view.diagram.open = open;
}

fn top(ui: &mut Ui, desk: &Desk<'_>, view: &mut View) {
    ui.horizontal(|ui| {
        if desk.lab.is_measuring() {
            if ui.button("Cancel").on_hover_text("Stops; what is measured stays.").clicked() {
                view.wishes.push(Wish::Cancel);
            }
        } else if ui.button("Measure").on_hover_text(format!("{SECONDS} s of simulated time from now.")).clicked() {
            view.wishes.push(Wish::Measure);
        }
        let parts = [
            (Price::Time, "Time", "Measured [ms] for a simulated second"),
            (
                Price::ForceEvaluations,
                "Force evaluations",
                "The same on every machine, but blind to the price of solving equations",
            ),
        ];
        let segments =
            parts.map(|(price, text, about)| Segment { text, name: text, about, on: view.diagram.price == price });
        if let Some((price, ..)) = segmented(ui, "price", &segments, false).and_then(|clicked| parts.get(clicked)) {
            view.diagram.price = *price;
        }
        if let Some(diagram) = desk.lab.diagram().filter(|diagram| !diagram.csv.is_empty())
            && ui.button("Copy CSV").on_hover_text("The whole table as comma-separated values.").clicked()
        {
            ui.ctx().copy_text(diagram.csv.clone());
        }
        if desk.lab.is_measuring() {
            let done = desk.lab.diagram().map_or(0.0, |diagram| diagram.progress.done);
            ui.add(ProgressBar::new(done as f32).desired_width(140.0).show_percentage());
        }
    });
    if let Some((source, own)) = desk.lab.diagram().and_then(|diagram| diagram.reference.as_ref()) {
        ui.label(RichText::new(format!("Reference: {source}; its own error is {}.", percent(*own))).small().weak());
    }
}

fn suggest(ui: &mut Ui, diagram: &Diagram, view: &mut View, commands: &mut Vec<Command>) {
    ui.horizontal_wrapped(|ui| {
        ui.label("Cheapest under");
        let target = &mut view.diagram.target;
        ComboBox::from_id_salt("target").width(72.0).selected_text(percent(TARGETS[*target % TARGETS.len()])).show_ui(
            ui,
            |ui| {
                for (number, error) in TARGETS.iter().enumerate() {
                    ui.selectable_value(target, number, percent(*error));
                }
            },
        );
        ui.label("error:");
        let price = usize::from(view.diagram.price == Price::ForceEvaluations);
        match diagram.suggestions.get(*target).and_then(|by_price| by_price[price].as_ref()) {
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
    let unit = if price == Price::Time { "ms per simulated second" } else { "force evaluations" };
    let spacer = |input: egui_plot::GridInput| decades(input.bounds);
    Plot::new("work and precision")
        .legend(Legend::default().position(Corner::LeftBottom).text_style(egui::TextStyle::Small))
        .x_axis_label(unit)
        .y_axis_label("relative RMS position error")
        .x_grid_spacer(spacer)
        .y_grid_spacer(spacer)
        .x_axis_formatter(|mark, _| power_of_ten(mark.value))
        .y_axis_formatter(|mark, _| power_of_ten(mark.value))
        .grid_color(theme.line)
        .allow_scroll(false)
        .show(ui, |plot| {
            for (number, curve) in diagram.curves.iter().enumerate() {
                let color = color(number, theme);
                let name = legend(curve);
                let measured = || curve.points.iter().filter_map(|point| Some((point, point.outcome.as_ref()?)));
                let stable: PlotPoints<'_> =
                    measured().filter(|(_, outcome)| sound(outcome)).map(|(_, outcome)| at(outcome, price)).collect();
                plot.line(Line::new(name.clone(), stable).color(color).width(1.6));
                for (point, outcome) in measured() {
                    plot.points(marker(&name, point, outcome, price, color));
                }
            }
        });
}

fn sound(outcome: &Outcome) -> bool {
    outcome.status == Status::Ok && outcome.error > 0.0
}

/// Where a run stands, in powers of ten; what blew up stands at an error of 10.
fn at(outcome: &Outcome, price: Price) -> [f64; 2] {
    let error = if outcome.error.is_finite() { outcome.error.clamp(1e-16, 10.0) } else { 10.0 };
    [price.of(outcome).max(1e-6).log10(), error.log10()]
}

/// The current setting is a large filled dot, other runs small ones, and runs that blew up crosses.
fn marker<'a>(name: &str, point: &Point, outcome: &Outcome, price: Price, color: Color32) -> Points<'a> {
    let (shape, radius) = match (outcome.status, point.current) {
        (Status::Ok, true) => (MarkerShape::Circle, 7.0),
        (Status::Ok, false) => (MarkerShape::Circle, 3.0),
        _ => (MarkerShape::Cross, 4.0),
    };
    let [x, y] = at(outcome, price);
    Points::new(name.to_owned(), vec![[x, y]]).shape(shape).radius(radius).color(color)
}

/// The scheme with the order that was measured.
fn legend(curve: &Curve) -> String {
    let title = curve.integrator.kind().title();
    curve.order.map_or_else(|| title.to_owned(), |order| format!("{title}, order {order:.2}"))
}

fn color(number: usize, theme: &Theme) -> Color32 {
    let base = theme.series[number % theme.series.len()];
    // The second round of colours is lighter or darker, so that eleven lines can be told apart.
    if number < theme.series.len() { base } else { base.lerp_to_gamma(theme.text, 0.45) }
}

/// A line for every power of ten.
fn decades((from, to): (f64, f64)) -> Vec<GridMark> {
    let every = ((to - from) / 10.0).ceil().max(1.0);
    let (first, last) = ((from / every).ceil() as i64, (to / every).floor() as i64);
    (first..=last).map(|mark| GridMark { value: mark as f64 * every, step_size: every }).collect()
}

fn power_of_ten(exponent: f64) -> String {
    match exponent.round() as i32 {
        0 => "1".to_owned(),
        1 => "10".to_owned(),
        2 => "100".to_owned(),
        power => format!("1e{power}"),
    }
}
