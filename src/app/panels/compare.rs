//! Two panes: the switch in the strip, which of them the panels edit, and how far they are apart.

use super::{
    Desk, View,
    energy::{marks, nice_range},
    fixed, heading_here,
    history::WINDOW,
    row,
    scheme::percent,
    segmented::{HEIGHT, Segment, segmented},
};
use crate::app::{
    compare::{Moment, Pane, Record, Wish, color},
    numbers,
    theme::Theme,
};
use eframe::egui::{self, Button, RichText, Ui, vec2};
use egui_plot::{Line, Plot, PlotPoints};

/// Height of a plot [points].
const PLOT: f32 = 92.0;

/// Splits the stage; while it is split, chooses the pane that the panels edit.
pub fn switch(ui: &mut Ui, desk: &Desk<'_>, view: &mut View) {
    let on = desk.comparison.is_some();
    let button = Button::selectable(on, "A | B").min_size(vec2(46.0, HEIGHT));
    let help = if on {
        "One pane again: A stays. [B]"
    } else {
        "Two panes of this scene, pulled by one hand, with another scheme, step, model or mesh in each. [B]"
    };
    if ui.add(button).on_hover_text(help).accessible_name("Compare").clicked() {
        view.panes.push(Wish::Toggle);
    }
    if let Some(panes) = desk.comparison {
        let about = "The panels, and the model beside, show and change this pane.";
        let part = |pane: Pane, name| Segment { text: pane.letter(), name, about, on: panes.chosen() == pane };
        let parts = [part(Pane::A, "Edit pane A"), part(Pane::B, "Edit pane B")];
        let chosen = segmented(ui, "pane", &parts, false).and_then(|clicked| Pane::BOTH.get(clicked));
        view.panes.extend(chosen.map(|pane| Wish::Choose(*pane)));
    }
    ui.add_space(8.0);
}

/// Says which pane a panel is about.
pub fn caption(ui: &mut Ui, desk: &Desk<'_>) {
    let Some(panes) = desk.comparison else { return };
    let pane = panes.chosen();
    let theme = Theme::of(ui.ctx());
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        ui.label(RichText::new(format!("Pane {}", pane.letter())).strong().color(color(theme, pane)));
        ui.label(RichText::new("scheme, step, model, mesh; all else is for both").small().weak());
    });
}

/// How far the panes are apart, now and in the last seconds, and what each costs.
pub fn show(ui: &mut Ui, desk: &Desk<'_>) {
    let Some(panes) = desk.comparison else { return };
    let record = panes.record();
    ui.add_space(6.0);
    ui.horizontal(|ui| {
        heading_here(ui, "Difference B − A");
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let help = "Copies time, differences and costs as comma-separated values.";
            if ui.small_button("Copy CSV").on_hover_text(help).accessible_name("Copy the difference as CSV").clicked() {
                ui.ctx().copy_text(record.csv());
            }
        });
    });
    let Some(last) = record.last() else { return };
    let help = "Relative RMS difference of positions: sqrt(mean |x_B − x_A|²) over the root mean square of how far A has moved \
                from its start. With other meshes, B is looked at where A's vertices are in the rest shape.";
    let positions = last.positions.filter(|value| value.is_finite()).map_or("–".to_owned(), percent);
    row(ui, "Positions", &positions, help);
    plot(
        ui,
        record,
        &Curve { name: "difference of positions", unit: "", value: |of| of.positions.map(|share| 100.0 * share) },
    );
    let help = "Total energy (kinetic, elastic, potential) of B less that of A [J]";
    row(ui, "Total energy", &fixed(last.energy, "J"), help);
    plot(ui, record, &Curve { name: "difference of energies", unit: "J", value: |of| Some(of.energy) });
    costs(ui, record.prices());
    ui.add_space(4.0);
    ui.separator();
}

/// Time of computing for a second of simulated time, and how many times as dear B is.
fn costs(ui: &mut Ui, prices: Option<[f64; 2]>) {
    let theme = Theme::of(ui.ctx());
    let help = "Time of computing for a second of simulated time [s]; above 1 s a pane alone is slower than real time.";
    for pane in Pane::BOTH {
        let name = RichText::new(format!("Computing {}, for 1 s", pane.letter())).color(color(theme, pane));
        row(ui, name, &prices.map_or("–".to_owned(), |prices| fixed(prices[pane as usize], "s")), help);
    }
    if let Some([a, b]) = prices.filter(|[a, b]| *a > 0.0 && *b > 0.0) {
        ui.label(RichText::new(verdict(b / a)).strong()).on_hover_text(help);
    }
}

/// How many times as dear B is, in words.
fn verdict(ratio: f64) -> String {
    let times = |ratio: f64| if ratio < 9.95 { format!("{ratio:.1}") } else { format!("{ratio:.0}") };
    if (0.95..=1.05).contains(&ratio) {
        "B costs as much as A.".to_owned()
    } else if ratio > 1.0 {
        format!("B costs {} × A.", times(ratio))
    } else {
        format!("A costs {} × B.", times(1.0 / ratio))
    }
}

/// A line of a plot.
struct Curve {
    name: &'static str,
    unit: &'static str,
    value: fn(&Moment) -> Option<f64>,
}

/// A small plot over the last seconds.
fn plot(ui: &mut Ui, record: &Record, curve: &Curve) {
    let theme = Theme::of(ui.ctx());
    let end = record.last().map_or(0.0, |moment| moment.time);
    let begin = record.moments().next().map_or(0.0, |moment| moment.time).max(end - WINDOW);
    let span = (end - begin).max(1.0);
    let values = || record.moments().filter_map(|moment| Some((moment.time, (curve.value)(moment)?)));
    let (low, high) = nice_range(values().map(|(_, value)| value).filter(|value| value.is_finite()));
    let unit = curve.unit;
    let format = move |value: f64| {
        if unit.is_empty() { format!("{} %", numbers::si(value, "")) } else { numbers::si(value, unit) }
    };
    let response = Plot::new(curve.name)
        .height(PLOT)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .allow_double_click_reset(false)
        .grid_color(theme.line)
        .show_x(false)
        .show_y(false)
        .y_axis_min_width(58.0)
        .x_grid_spacer(move |input| marks(input.bounds, span))
        .x_axis_formatter(|mark, _| format!("{} s", mark.value))
        .y_axis_formatter(move |mark, _| format(mark.value))
        .show(ui, |plot| {
            plot.set_plot_bounds_x(begin..=begin + 1.03 * span);
            plot.set_plot_bounds_y(low..=high);
            let points: PlotPoints<'_> =
                values().filter(|(_, value)| value.is_finite()).map(|(time, value)| [time, value]).collect();
            plot.line(Line::new(curve.name, points).color(color(theme, Pane::B)).width(1.8).allow_hover(false));
        });
    response.response.on_hover_text(format!("The {} over simulated time [s]", curve.name));
}
