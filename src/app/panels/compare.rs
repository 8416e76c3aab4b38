//! Panel of the comparison: which pane is edited, and the differences.

use super::{
    PanelContext, Side, View,
    energy::{WINDOW, marks, nice_range, time_text},
    fixed, heading_here,
    plotting::{self, Figure},
    row,
    scheme::percent,
    widgets::{HEIGHT, Segment, segmented},
};
use crate::app::{
    compare::{Comparison, Moment, Pane, PaneRequest, Record, color},
    language::tr,
    numbers,
    theme::Theme,
};
use crate::study::Apart;
use eframe::egui::{self, Button, Rect, RichText, Ui, vec2};
use egui_plot::{Line, PlotPoints};

/// Height of a plot [points].
const PLOT: f32 = 92.0;

/// Distance of positions below which they differ only by round-off \[m\].
const ROUNDING: f64 = 1e-12;

/// Draws the button that splits the stage and, while it is split, the choice of the pane that the panels edit.
pub fn switch(ui: &mut Ui, context: &PanelContext<'_>, view: &mut View) {
    let on = context.comparison.is_some();
    let button = Button::selectable(on, "A | B").min_size(vec2(46.0, HEIGHT));
    let help = if on {
        "One pane again: A stays. [B]"
    } else {
        "Two panes of this scene with the same pull of the mouse, and a different scheme, step, model or mesh in each. [B]"
    };
    if ui.add(button).on_hover_text(tr(help)).accessible_name(tr("Compare")).clicked() {
        view.panes.push(PaneRequest::Toggle);
    }
    if let Some(panes) = context.comparison {
        let about = "The panels, and the model beside, show and change this pane.";
        let part = |pane: Pane, name| Segment { text: pane.letter(), name, about, on: panes.chosen() == pane };
        let parts = [part(Pane::A, "Edit pane A"), part(Pane::B, "Edit pane B")];
        let chosen = segmented(ui, "pane", &parts, false).and_then(|clicked| Pane::BOTH.get(clicked));
        view.panes.extend(chosen.map(|pane| PaneRequest::Choose(*pane)));
    }
    ui.add_space(8.0);
}

/// Draws the name of the pane that a panel shows.
pub fn caption(ui: &mut Ui, context: &PanelContext<'_>, side: Side) {
    let Some(panes) = context.comparison else { return };
    let pane = panes.chosen();
    let theme = Theme::of(ui.ctx());
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        ui.label(RichText::new(format!("Pane {}", pane.letter())).strong().color(color(theme, pane)));
        let words = match side {
            Side::Left if context.now.bodies.is_empty() => "everything here applies to both panes",
            Side::Left => "its mesh; everything else here applies to both panes",
            Side::Right => "its step, scheme, cost and energies",
        };
        ui.label(RichText::new(words).small().weak());
    });
}

/// Draws the distance of the panes, now and over the last seconds, and the cost of each.
pub fn show(ui: &mut Ui, context: &PanelContext<'_>, view: &mut View) {
    let Some(panes) = context.comparison else { return };
    let record = panes.record();
    ui.add_space(6.0);
    ui.horizontal(|ui| {
        heading_here(ui, "Difference B − A");
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            plotting::export_buttons(ui, view, Figure::Difference, &context.now.level.name, || record.csv());
        });
    });
    let Some(last) = record.last() else { return };
    let help = "sqrt(mean |x_B − x_A|²), and as a share of the farthest that A has been from its start, measured likewise. With \
                other meshes, B is looked at where A's vertices are in the rest shape.";
    let top = ui.cursor().min;
    row(ui, tr("Positions"), &last.positions.map_or("–".to_owned(), words), help);
    let share = |of: &Moment| of.positions.map(share).filter(|share| share.is_finite());
    plot(ui, record, &Curve { name: "difference of positions", unit: "", value: &share });
    let help = "Total energy (kinetic, elastic, potential) of B less that of A [J]";
    let negligible = context.now.negligible;
    let energy =
        if last.energy.is_finite() { fixed(numbers::or_zero(last.energy, negligible), "J") } else { "–".to_owned() };
    row(ui, tr("Total energy"), &energy, help);
    plot(
        ui,
        record,
        &Curve {
            name: "difference of energies",
            unit: "J",
            value: &|of| Some(numbers::or_zero(of.energy, negligible)),
        },
    );
    plotting::pose(ui, view, Figure::Difference, Rect::from_min_max(top, ui.min_rect().max));
    costs(ui, record.prices());
    ui.add_space(4.0);
    ui.separator();
}

/// Relative distance of positions over the farthest displacement of A [%]; zero if it is only round-off.
fn share(apart: Apart) -> f64 {
    if apart.metres < ROUNDING { 0.0 } else { 100.0 * apart.relative }
}

/// Distance of positions in words.
fn words(apart: Apart) -> String {
    if apart.metres == 0.0 {
        "exactly 0".to_owned()
    } else if apart.metres < ROUNDING {
        format!("under {}", numbers::si(ROUNDING, "m"))
    } else {
        let share = if apart.relative.is_finite() { percent(apart.relative) } else { String::new() };
        format!("{}{share:>9}", fixed(apart.metres, "m"))
    }
}

/// Distance of the panes and cost of B, in one line.
pub fn apart(panes: &Comparison) -> String {
    let record = panes.record();
    let apart = record.last().and_then(|last| last.positions).map_or(String::new(), |apart| match apart.metres {
        0.0 => "no difference".to_owned(),
        metres => format!("{} apart", fixed(metres.max(ROUNDING), "m").trim_end()),
    });
    let ratio = record.prices().filter(|[a, b]| *a > 0.0 && *b > 0.0).map(|[a, b]| b / a);
    ratio.map_or(apart.clone(), |ratio| format!("{apart}, {:>4} × cost", times(ratio))).replace(' ', "\u{a0}")
}

/// Draws the computing time for a second of simulated time, and the cost of B relative to A.
fn costs(ui: &mut Ui, prices: Option<[f64; 2]>) {
    let theme = Theme::of(ui.ctx());
    let help = "Time of computing for a second of simulated time that was not slept through [s]; above 1 s a pane alone is slower than real time.";
    for pane in Pane::BOTH {
        let name = RichText::new(format!("Computing 1 s of {}", pane.letter())).color(color(theme, pane));
        row(ui, name, &prices.map_or("–".to_owned(), |prices| fixed(prices[pane as usize], "s")), help);
    }
    if let Some([a, b]) = prices.filter(|[a, b]| *a > 0.0 && *b > 0.0) {
        ui.label(RichText::new(verdict(b / a)).strong()).on_hover_text(tr(help));
    }
}

/// Formats a ratio of costs with two digits.
fn times(ratio: f64) -> String {
    let digits = if ratio < 0.995 { 2 } else { usize::from(ratio < 9.95) };
    format!("{ratio:.digits$}")
}

/// Cost of B relative to A, in words.
fn verdict(ratio: f64) -> String {
    if (0.95..=1.05).contains(&ratio) {
        "B costs as much as A.".to_owned()
    } else if ratio > 1.0 {
        format!("B costs {} × A.", times(ratio))
    } else {
        format!("A costs {} × B.", times(1.0 / ratio))
    }
}

/// Curve of a plot.
struct Curve<'a> {
    name: &'static str,
    unit: &'static str,
    value: &'a dyn Fn(&Moment) -> Option<f64>,
}

/// Draws a small plot of the last seconds.
fn plot(ui: &mut Ui, record: &Record, curve: &Curve<'_>) {
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
    let response = plotting::still(curve.name, PLOT, theme)
        .y_axis_min_width(58.0)
        .x_grid_spacer(move |input| {
            let mut marks = marks(input.bounds, span);
            marks.retain(|mark| mark.value < begin + 0.96 * span);
            marks
        })
        .y_grid_spacer(|input| plotting::heights(input.bounds, 0.62))
        .x_axis_formatter(|mark, _| time_text(mark))
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

#[cfg(test)]
mod tests {
    use super::{share, verdict};
    use crate::{app::panels::energy::nice_range, study::Apart};

    /// The axis begins at a picometre.
    #[test]
    fn differences_below_a_picometre_are_drawn_as_zero() {
        let shares = [2e-16, 9e-13].map(|metres| share(Apart { metres, relative: 3.0 * metres }));
        assert_eq!(shares, [0.0; 2]);
        for greatest in [share(Apart { metres: 2e-12, relative: 6e-12 }), 1e-13, 0.0] {
            let (low, high) = nice_range([0.0, greatest].into_iter());
            assert!(low >= -0.1 * high && high > greatest, "{low} to {high} for {greatest}");
        }
    }

    #[test]
    fn the_dearer_pane_is_named() {
        assert_eq!(verdict(3.21), "B costs 3.2 × A.");
        assert_eq!(verdict(0.05), "A costs 20 × B.");
        assert_eq!(verdict(1.01), "B costs as much as A.");
    }
}
