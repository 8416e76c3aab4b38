//! Probes: what they measure now, and plots of what was chosen over time.

use super::{
    PanelContext, View, energy, fixed, heading_here,
    plotting::{self, Figure},
};
use crate::{
    app::{
        canvas::{Measured, Tool},
        language::tr,
        numbers,
        probes::{ProbeRequest, Probes, Reading},
        theme::Theme,
    },
    probe::{Column, Probe},
    snapshot::Snapshot,
};
use eframe::egui::{
    self, Align, Align2, Button, CollapsingHeader, Color32, Layout, Popup, RichText, Sense, Ui, WidgetInfo, vec2,
};
use egui_plot::{Line, PlotPoint, PlotPoints, Text};

/// Height of a plot [points].
const HEIGHT: f32 = 130.0;

/// Least range of a plot, as a fraction of the greatest number in it: smaller changes are round-off.
const LEAST_RANGE: f64 = 1e-9;

pub fn show(ui: &mut Ui, context: &PanelContext<'_>, view: &mut View) {
    ui.add_space(6.0);
    ui.horizontal(|ui| {
        heading_here(ui, "Probes");
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            add(ui, context, view);
            ruler_button(ui, context, view);
            if !context.probes.readings().is_empty() {
                let level = &context.now.level;
                plotting::export_buttons(ui, view, Figure::Probes, &level.name, || context.probes.csv(level));
            }
        });
    });
    if view.stage.tool == Tool::Probe {
        ui.label(RichText::new(tr("Click a vertex or a triangle on the stage.")).small().weak());
    }
    if let Some(measured) = context.measured {
        ruler(ui, context.now, &measured, view);
    }
    let mut color = 0;
    for (place, reading) in context.probes.readings().iter().enumerate() {
        probe(ui, view, (place, reading), &mut color);
    }
    if std::mem::take(&mut view.shows_probes) {
        ui.scroll_to_cursor(Some(Align::BOTTOM));
    }
    let rect = ui.scope(|ui| plots(ui, context.probes)).response.rect;
    plotting::pose(ui, view, Figure::Probes, rect);
}

/// Draws the button that takes the ruler, or puts it away.
fn ruler_button(ui: &mut Ui, context: &PanelContext<'_>, view: &mut View) {
    if context.now.toy.is_some() {
        return;
    }
    let is_taken = view.stage.tool == Tool::Ruler;
    let button = Button::selectable(is_taken, RichText::new(tr("Ruler")).small()).small().min_size(vec2(34.0, 20.0));
    let about = "Measures distances and angles between points on the stage. A point on a vertex moves with it.";
    if ui.add(button).on_hover_text(tr(about)).clicked() {
        (view.stage.tool, view.drawer) = if is_taken { (Tool::Hand, view.drawer) } else { (Tool::Ruler, None) };
    }
}

/// Draws what the ruler measures.
fn ruler(ui: &mut Ui, now: &Snapshot, measured: &Measured, view: &mut View) {
    let names = ["dx", "dy", "dz"].into_iter().take(now.dimension);
    let mut rows = vec![("Distance", measured.length(), "m")];
    rows.extend(names.zip(measured.along).map(|(name, along)| (name, along, "m")));
    if now.dimension == 2 {
        rows.push(("Slope", measured.slope().to_degrees(), "°"));
    }
    rows.extend(measured.stretch().map(|stretch| ("Distance over that at the start", stretch, "")));
    rows.extend(measured.corner.map(|corner| ("Angle at the second point", corner.to_degrees(), "°")));
    CollapsingHeader::new(tr("Ruler")).id_salt("ruler").default_open(true).show(ui, |ui| {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            let button = |ui: &mut Ui, text: &str, about: &str| {
                let button = Button::new(RichText::new(text).small()).small();
                ui.add(button).on_hover_text(tr(about)).accessible_name(format!("{text}: Ruler"))
            };
            if button(ui, "Copy", "Copies the numbers, with all their digits.").clicked() {
                let lines: Vec<_> =
                    rows.iter().map(|(name, value, unit)| format!("{name}\t{value:e}\t{unit}")).collect();
                ui.ctx().copy_text(lines.join("\n"));
            }
            view.removes_ruler |= button(ui, "Remove", "Removes the ruler.").clicked();
        });
        for (name, value, unit) in &rows {
            ui.horizontal(|ui| {
                ui.label(*name);
                ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                    ui.monospace(fixed(*value, unit)).on_hover_text(format!("{value:.16e} {unit}"));
                });
            });
        }
    });
}

/// Draws the menu that adds a probe.
fn add(ui: &mut Ui, context: &PanelContext<'_>, view: &mut View) {
    let picks = view.stage.tool == Tool::Probe;
    let text = tr(if picks { "Cancel" } else { "Add…" });
    let button = Button::new(RichText::new(text).small()).small().min_size(vec2(34.0, 20.0));
    let button = ui.add(button).on_hover_text(tr("Adds a probe. [P probes what is under the pointer]"));
    let button = button.accessible_name(tr(if picks { "Cancel the probe" } else { "Add a probe" }));
    if picks {
        if button.clicked() {
            view.stage.tool = Tool::Hand;
        }
        return;
    }
    Popup::menu(&button).show(|ui| {
        let now = context.now;
        if now.toy.is_none() && ui.button(tr("On the stage…")).on_hover_text(tr("The next click probes. [P]")).clicked()
        {
            (view.stage.tool, view.drawer) = (Tool::Probe, None);
        }
        let is_there = |probe: &Probe| match probe {
            Probe::Numbers => now.toy.is_some(),
            Probe::Inversion => !now.bodies.is_empty(),
            _ => now.toy.is_none(),
        };
        for probe in Probe::OF_ALL.into_iter().filter(is_there) {
            if ui.button(name(probe)).clicked() {
                view.probe_requests.push(ProbeRequest::Add(probe));
            }
        }
    });
}

/// Name of a probe of a whole scene in the menu.
const fn name(probe: Probe) -> &'static str {
    match probe {
        Probe::Energy => "Energies",
        Probe::Momentum => "Momentum",
        Probe::Inversion => "Smallest J",
        Probe::Reaction => "Force of the pins",
        _ => "Numbers",
    }
}

/// Draws a probe: its name, buttons, and a row for each column. A click on a row draws it over time.
fn probe(ui: &mut Ui, view: &mut View, (place, reading): (usize, &Reading), color: &mut usize) {
    let theme = Theme::of(ui.ctx());
    let head = CollapsingHeader::new(&reading.title).id_salt(("probe", reading.probe.to_string())).default_open(true);
    let body = head.show(ui, |ui| {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            let button = |ui: &mut Ui, text: &str, about: &str| {
                let button = Button::new(RichText::new(text).small()).small();
                ui.add(button).on_hover_text(tr(about)).accessible_name(format!("{text}: {}", reading.title))
            };
            if button(ui, "Copy", "Copies the numbers, with all their digits.").clicked() {
                ui.ctx().copy_text(reading.text());
            }
            if let Probe::Vertex(vertex) = reading.probe
                && button(ui, "Forces", "Adds a probe of the forces on this vertex, by effect.").clicked()
            {
                view.probe_requests.push(ProbeRequest::Add(Probe::Forces(vertex)));
            }
            if button(ui, "Remove", "Removes the probe.").clicked() {
                view.probe_requests.push(ProbeRequest::Remove(place));
            }
            ui.weak(RichText::new(reading.probe.to_string()).small())
                .on_hover_text(tr("Its name for `gingerbread run --csv FILE --probe`"));
        });
        // Lines keep their colours where rows are hidden.
        let lines: Vec<_> = reading.drawn.iter().map(|drawn| drawn.then(|| line_color(theme, color))).collect();
        let mut rows = |ui: &mut Ui, details: bool| {
            for (number, column) in reading.columns.iter().enumerate().filter(|(_, own)| own.is_detail == details) {
                let (value, line) = (reading.numbers.get(number).copied(), lines.get(number).copied().flatten());
                if quantity(ui, (column, value.unwrap_or(f64::NAN)), (&reading.title, line)) {
                    view.probe_requests.push(ProbeRequest::Draw(place, number));
                }
            }
        };
        rows(ui, false);
        if reading.columns.iter().any(|column| column.is_detail) {
            CollapsingHeader::new(tr("All components"))
                .id_salt(("details", reading.probe.to_string()))
                .show(ui, |ui| rows(ui, true));
        }
    });
    if body.body_response.is_none() {
        *color += reading.drawn.iter().filter(|drawn| **drawn).count();
    }
}

/// The next colour of a line.
fn line_color(theme: &Theme, next: &mut usize) -> Color32 {
    let base = theme.series[*next % theme.series.len()];
    let is_first = *next < theme.series.len();
    *next += 1;
    if is_first { base } else { base.lerp_to_gamma(theme.text, 0.45) }
}

/// Draws a row with a number, and a dot if it is drawn over time; returns whether it was clicked.
fn quantity(ui: &mut Ui, (column, number): (&Column, f64), (of, line): (&str, Option<Color32>)) -> bool {
    let Column { label, unit, about, .. } = column;
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 18.0), Sense::click());
    response.widget_info(|| WidgetInfo::selected(egui::Role::CheckBox, true, line.is_some(), format!("{of}: {label}")));
    if response.hovered() {
        ui.painter().rect_filled(rect, 4.0, ui.visuals().widgets.hovered.weak_bg_fill);
    }
    let dot = rect.left_center() + vec2(6.0, 0.0);
    match line {
        Some(color) => ui.painter().circle_filled(dot, 4.0, color),
        None => ui.painter().circle_stroke(dot, 3.5, (1.0, ui.visuals().weak_text_color())),
    };
    let text = ui.visuals().text_color();
    let body = egui::TextStyle::Body.resolve(ui.style());
    let mono = egui::TextStyle::Monospace.resolve(ui.style());
    ui.painter().text(rect.left_center() + vec2(16.0, 0.0), Align2::LEFT_CENTER, label, body, text);
    ui.painter().text(rect.right_center(), Align2::RIGHT_CENTER, fixed(number, unit), mono, text);
    let about = if about.is_empty() { String::new() } else { format!("{about}\n") };
    response.on_hover_text(format!("{about}{number:.16e} {unit}\nA click draws it over time, or no longer.")).clicked()
}

/// Draws a plot for each unit of the columns that are drawn.
fn plots(ui: &mut Ui, probes: &Probes) {
    let theme = Theme::of(ui.ctx());
    let mut next = 0;
    let curves: Vec<_> = probes.drawn().map(|curve| (curve, line_color(theme, &mut next))).collect();
    let mut units: Vec<&str> = curves.iter().map(|((_, column, _), _)| column.unit).collect();
    units.sort_unstable();
    units.dedup();
    let end = probes.rows().next_back().map_or(0.0, |(time, _)| time);
    let first = probes.rows().next().map_or(0.0, |(time, _)| time);
    let begin = first.max(end - energy::WINDOW);
    for unit in units {
        let own: Vec<_> = curves.iter().filter(|((_, column, _), _)| column.unit == unit).collect();
        let points = |place: usize| {
            let rows = probes.rows().filter(move |(time, _)| *time >= begin);
            rows.filter_map(move |(time, row)| {
                row.get(place).copied().filter(|number| number.is_finite()).map(|number| [time, number])
            })
        };
        let values = own.iter().flat_map(|((.., place), _)| points(*place)).map(|[_, value]| value);
        let (low, high) = range(values);
        let span = (end - begin).max(f64::MIN_POSITIVE);
        let (divisor, symbol) = numbers::unit_for(low.abs().max(high.abs()), unit);
        let plot = plotting::still("probes", HEIGHT, theme)
            .id(ui.scope_id().with(("probes", unit)))
            .y_axis_min_width(52.0)
            .x_grid_spacer(|input| plotting::heights(input.bounds, 0.5))
            .y_grid_spacer(|input| plotting::heights(input.bounds, 0.4))
            .x_axis_formatter(move |mark, _| numbers::si(mark.value, "s"))
            .y_axis_formatter(move |mark, range| {
                axis_text(mark.value / divisor, (range.end() - range.start()) / divisor)
            });
        let response = plot.show(ui, |plot| {
            plot.set_plot_bounds_x(begin..=begin + 1.02 * span);
            plot.set_plot_bounds_y(low..=high);
            for ((_, column, place), color) in &own {
                let line: PlotPoints<'_> = points(*place).collect();
                plot.line(Line::new(column.name.as_str(), line).color(*color).width(1.6).allow_hover(false));
            }
            let corner = PlotPoint::new(begin + 0.01 * span, high);
            plot.text(
                Text::new("unit", corner, RichText::new(&symbol).small()).anchor(Align2::LEFT_TOP).allow_hover(false),
            );
        });
        let under = response.response.hover_pos().map(|at| response.transform.value_from_position(at).x);
        let at =
            under.and_then(|time| probes.rows().min_by(|(a, _), (b, _)| (a - time).abs().total_cmp(&(b - time).abs())));
        let mut text = match at {
            Some((time, _)) => format!("at {}", numbers::si(time, "s")),
            None => "over simulated time [s]".to_owned(),
        };
        for ((number, column, place), _) in &own {
            let value =
                at.and_then(|(_, row)| row.get(*place)).map(|value| format!(" = {}", numbers::si(*value, unit)));
            let title = &probes.readings()[*number].title;
            text.extend(["\n", title, ": ", &column.label, &value.unwrap_or_default()]);
        }
        response.response.on_hover_text_at_pointer(text);
    }
}

/// Text of a mark, with as many digits as the range needs.
fn axis_text(value: f64, range: f64) -> String {
    let digits = (1.0 - libm::floor(libm::log10(range))).clamp(0.0, 9.0) as usize;
    format!("{value:.digits$}")
}

/// A range that contains all values and ends at round numbers.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) =
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
    if low > high {
        return (0.0, 1.0);
    }
    let least = (LEAST_RANGE * low.abs().max(high.abs())).max(1e-300);
    let span = (high - low).max(least);
    let power = libm::pow(10.0, libm::floor(libm::log10(span)));
    let step = 0.5 * power;
    let (low, high) = (libm::floor(low / step) * step, libm::ceil(high / step) * step);
    let margin = 0.06 * (high - low).max(least);
    (low - margin, high + margin)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_holds_its_values_and_is_never_empty() {
        for values in [&[0.0][..], &[3.0], &[0.5, 0.500_1], &[-2e-12, 5e-12], &[1e5, -1e9], &[]] {
            let (low, high) = range(values.iter().copied());
            assert!(low < high && (low.is_finite() && high.is_finite()), "{values:?}: {low} to {high}");
            assert!(values.iter().all(|value| (low..=high).contains(value)), "{values:?}: {low} to {high}");
        }
    }

    #[test]
    fn marks_have_the_digits_that_their_range_needs() {
        assert_eq!((axis_text(0.5, 1.0), axis_text(0.500_2, 0.000_4)), ("0.5".to_owned(), "0.50020".to_owned()));
        assert_eq!(axis_text(1200.0, 500.0), "1200");
    }
}
