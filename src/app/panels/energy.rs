//! Energies of the last seconds: their record and their plot.

use super::{
    PanelContext, View, fixed, heading_here,
    plotting::{self, Figure},
    row,
};
use crate::{
    app::{language::tr, numbers, theme::Theme},
    effects::EffectKind,
    level::Level,
    snapshot::{Energies, Snapshot},
    study::{Setting, head},
    table::Table,
};
use eframe::egui::{self, Align2, Color32, RichText, Ui};
use egui_plot::{GridMark, Line, PlotPoint, PlotPoints, Text};
use std::collections::VecDeque;

/// Length of the history [s of simulated time].
pub const WINDOW: f64 = 10.0;

/// Most samples, one for each frame, and how many of the last ones are plotted: in slow motion they span a short time.
const MOST: usize = 2400;
const PLOTTED: usize = 600;

/// Energies of the last seconds.
#[derive(Default)]
pub struct History {
    samples: VecDeque<(f64, Energies)>,
    generation: u64,
}

impl History {
    /// Records the present energies. It clears the history if time went backwards or the scene has changed.
    pub fn record(&mut self, now: &Snapshot) {
        let back = self.samples.back().is_some_and(|(time, _)| now.time < *time);
        if back || self.generation != now.generation {
            self.samples.clear();
            self.generation = now.generation;
        }
        if self.samples.back().is_some_and(|(time, _)| now.time == *time) {
            self.samples.pop_back();
        }
        self.samples.push_back((now.time, now.energies));
        while self.samples.len() > MOST || self.samples.front().is_some_and(|(time, _)| now.time - time > WINDOW) {
            self.samples.pop_front();
        }
    }

    /// Time from which on it is plotted \[s\], and the length of the time axis \[s\].
    fn axis(&self) -> (f64, f64) {
        /// Frames in the length of a new plot.
        const FRAMES: f64 = 60.0;
        let end = self.samples.back().map_or(0.0, |(time, _)| *time);
        let begin = self.samples.get(self.samples.len().saturating_sub(PLOTTED)).map_or(0.0, |(time, _)| *time);
        let frame = self.samples.iter().rev().nth(1).map_or(1.0, |(before, _)| end - before);
        (begin, (end - begin).max((FRAMES * frame).min(1.0)))
    }

    /// The samples as comma-separated values, with a head that states their origin; `level` is the level that was run.
    pub fn csv(&self, level: &Level) -> String {
        let about = [
            ("stepped_by", Setting::of(level).label()),
            (
                "reference",
                "none: these are the energies of the scene as it ran, with all that was done to it".to_owned(),
            ),
        ];
        let columns = ["time_s", "kinetic_j", "elastic_j", "contact_j", "potential_j", "total_j"];
        let mut table = Table::new(head(&level.name, 1, &about), &columns);
        for (time, of) in &self.samples {
            table.row(
                [*time, of.kinetic, of.elastic, of.contact, of.potential, of.total()].map(|number| number.to_string()),
            );
        }
        table.text()
    }

    /// Samples, oldest first.
    pub fn samples(&self) -> impl Iterator<Item = &(f64, Energies)> {
        self.samples.iter()
    }

    /// The newest sample.
    pub fn last(&self) -> Option<&(f64, Energies)> {
        self.samples.back()
    }
}

/// Largest energy that is drawn \[J\].
const FARTHEST: f64 = 1e60;

/// Minimum and maximum height of the plot [points].
const HEIGHTS: (f32, f32) = (150.0, 300.0);

/// Curve of a plot.
struct Curve {
    name: &'static str,
    help: &'static str,
    value: fn(&Energies) -> f64,
    color: fn(&Theme) -> Color32,
}

const CURVES: [Curve; 5] = [
    Curve {
        name: "Kinetic",
        help: "Of motion: the sum of m v²/2 [J]",
        value: |of| of.kinetic,
        color: |theme| theme.series[1],
    },
    Curve {
        name: "Elastic",
        help: "Of deformation: the sum of ψ(F) times rest area [J]",
        value: |of| of.elastic,
        color: |theme| theme.series[0],
    },
    Curve {
        name: "Contact",
        help: "Of skins that are compressed, and of friction that sticks [J]",
        value: |of| of.contact,
        color: |theme| theme.series[3],
    },
    Curve {
        name: "Potential",
        help: "Of gravity and the mouse spring [J]",
        value: |of| of.potential,
        color: |theme| theme.series[2],
    },
    Curve {
        name: "Total",
        help: "The sum: constant without damping, contacts and a pull of the mouse [J]",
        value: |of| of.total(),
        color: |theme| theme.text,
    },
];

/// The curves of a scene: that of contact only where something can touch.
fn curves(level: &Level) -> Vec<&'static Curve> {
    let touches =
        |effect: &EffectKind| matches!(effect, EffectKind::Boundary(_) | EffectKind::Walls(_) | EffectKind::Contact(_));
    let can_touch = level.effects.iter().any(|listed| listed.switch.is_on() && touches(&listed.effect));
    CURVES.iter().filter(|curve| can_touch || curve.name != "Contact").collect()
}

/// Value of a curve; zero if it is round-off of the largest energy, or at most `negligible` for the scene \[J\].
fn visible(curve: &Curve, of: &Energies, negligible: f64) -> f64 {
    let largest = of.kinetic.abs().max(of.elastic.abs()).max(of.contact.abs()).max(of.potential.abs());
    numbers::or_zero((curve.value)(of), negligible.max(1e-12 * largest))
}

pub fn show(ui: &mut Ui, context: &PanelContext<'_>, view: &mut View) {
    let (history, level) = (context.history, &context.now.level);
    let Some(&(end, now)) = history.last() else { return };
    ui.add_space(6.0);
    ui.horizontal(|ui| {
        heading_here(ui, "Energies");
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            plotting::export_buttons(ui, view, Figure::Energies, &level.name, || history.csv(level));
        });
    });
    let theme = Theme::of(ui.ctx());
    let curves = curves(level);
    for pair in curves.chunks(2) {
        ui.spacing_mut().item_spacing.x = 20.0;
        ui.columns(pair.len(), |columns| {
            for (ui, curve) in columns.iter_mut().zip(pair) {
                let name = RichText::new(curve.name).color((curve.color)(theme));
                row(ui, name, &fixed(visible(curve, &now, context.now.negligible), "J"), curve.help);
            }
        });
    }
    let rect = ui.scope(|ui| plot(ui, (history, &curves), (end, context.now.negligible), theme)).response.rect;
    plotting::pose(ui, view, Figure::Energies, rect);
}

/// Height of a curve in the plot, limited to [`FARTHEST`]: egui cannot place the numbers of an explosion.
fn plotted(curve: &Curve, of: &Energies, negligible: f64) -> f64 {
    let value = visible(curve, of, negligible);
    if value.is_nan() { 0.0 } else { value.clamp(-FARTHEST, FARTHEST) }
}

fn plot(ui: &mut Ui, (history, curves): (&History, &[&'static Curve]), (end, negligible): (f64, f64), theme: &Theme) {
    let (begin, span) = history.axis();
    let seen = || history.samples().filter(|(time, _)| *time >= begin);
    let values = seen().flat_map(|(_, of)| curves.iter().map(|curve| plotted(curve, of, negligible)));
    let (low, high) = nice_range(values);
    let height = (ui.clip_rect().bottom() - ui.cursor().top() - 12.0).clamp(HEIGHTS.0, HEIGHTS.1);
    let apart = (high - low) * 13.0 / f64::from(height - 22.0);
    let response = plotting::still("energy", height, theme)
        .y_axis_min_width(52.0)
        .x_grid_spacer(move |input| marks(input.bounds, span))
        .y_grid_spacer(|input| plotting::heights(input.bounds, 0.4))
        .x_axis_formatter(|mark, _| time_text(mark))
        .y_axis_formatter(|mark, _| numbers::si(mark.value, "J"))
        .show(ui, |plot| {
            // The labels stand to the right of the ends of the lines.
            plot.set_plot_bounds_x(begin..=begin + 1.32 * span);
            plot.set_plot_bounds_y(low..=high);
            for curve in curves {
                let points: PlotPoints<'_> = seen().map(|(time, of)| [*time, plotted(curve, of, negligible)]).collect();
                let width = if curve.name == "Total" { 1.2 } else { 1.8 };
                plot.line(Line::new(curve.name, points).color((curve.color)(theme)).width(width).allow_hover(false));
            }
            let now = history.last().map(|(_, now)| *now).unwrap_or_default();
            for (curve, y) in curves.iter().zip(label_heights(curves, &now, negligible, [apart, high - apart])) {
                let at = PlotPoint::new(end + 0.02 * span, y);
                let text = RichText::new(curve.name).small().color((curve.color)(theme));
                plot.text(Text::new(curve.name, at, text).anchor(Align2::LEFT_BOTTOM).allow_hover(false));
            }
        });
    response.response.on_hover_text(tr("Energies [J] over simulated time [s]"));
}

/// Grid marks of the time axis with numbers, few enough that the numbers do not overlap.
pub(super) fn marks((from, to): (f64, f64), span: f64) -> Vec<GridMark> {
    let power = 10.0_f64.powf((0.32 * span).log10().floor());
    let step = power * [1.0, 2.0, 5.0].into_iter().find(|step| *step * power >= 0.32 * span).unwrap_or(10.0);
    let first = (from / step).ceil() as i64;
    let last = (to / step).floor() as i64;
    (first..=last).map(|mark| GridMark { value: mark as f64 * step, step_size: step }).collect()
}

/// Time of a grid mark, with as many decimals as tell it from the next one.
pub(super) fn time_text(mark: GridMark) -> String {
    let decimals = (-(mark.step_size * (1.0 + 1e-9)).log10().floor()).max(0.0) as usize;
    format!("{:.decimals$} s", mark.value)
}

/// Heights of the curve labels: at the last values, but at least `apart` from each other, and at most `top`.
fn label_heights(curves: &[&Curve], now: &Energies, negligible: f64, [apart, top]: [f64; 2]) -> Vec<f64> {
    let mut heights: Vec<_> = curves.iter().map(|curve| plotted(curve, now, negligible)).collect();
    let mut order: Vec<_> = (0..heights.len()).collect();
    order.sort_by(|a, b| heights[*a].total_cmp(&heights[*b]));
    let mut floor = f64::NEG_INFINITY;
    for &curve in &order {
        heights[curve] = heights[curve].max(floor);
        floor = heights[curve] + apart;
    }
    let mut ceiling = top;
    for curve in order.into_iter().rev() {
        heights[curve] = heights[curve].min(ceiling);
        ceiling = heights[curve] - apart;
    }
    heights
}

/// Range that contains all values and ends at round numbers, so that it stays constant while they change a little.
pub(super) fn nice_range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values.fold((0.0_f64, 0.0_f64), |(low, high), value| (low.min(value), high.max(value)));
    let round = |value: f64| {
        if value == 0.0 {
            return 0.0;
        }
        let power = 10f64.powf(value.abs().log10().floor());
        let lead = [1.0, 1.5, 2.0, 3.0, 5.0, 7.0, 10.0].into_iter().find(|lead| lead * power >= value.abs() * 0.999);
        lead.unwrap_or(10.0) * power * value.signum()
    };
    // If all values are zero, the range ends at 1 J.
    let high = if high > 0.0 || low < 0.0 { round(high) } else { 1.0 };
    let low = if low < -0.02 * high { round(low) } else { 0.0 };
    let margin = (high - low) * 0.06;
    (low - margin, high + margin)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(time: f64) -> Snapshot {
        Snapshot { time, ..Snapshot::default() }
    }

    #[test]
    fn the_plot_drops_old_samples_and_restarts_with_time() {
        let mut history = History::default();
        for frame in 0..3000 {
            history.record(&at(f64::from(frame) / 60.0));
        }
        assert!((590..=602).contains(&history.samples.len()), "{}", history.samples.len());
        history.record(&at(0.0));
        assert_eq!(history.samples.len(), 1);
    }

    #[test]
    fn slow_motion_does_not_fill_the_memory() {
        let mut history = History::default();
        for frame in 0..10_000 {
            history.record(&at(f64::from(frame) * 1e-4));
        }
        assert_eq!(history.samples.len(), MOST);
    }

    /// At every speed of time the plot spans the frames of ten seconds, and its marks can be told apart.
    #[test]
    fn the_plot_spans_the_last_frames_at_every_speed() {
        for factor in [1e-3, 0.1, 1.0] {
            let mut history = History::default();
            (0..300).for_each(|frame| history.record(&at(f64::from(frame) / 60.0)));
            let begin = 5.0;
            for frame in 0..800 {
                history.record(&at(begin + f64::from(frame) / 60.0 * factor));
            }
            let (from, span) = history.axis();
            assert!((span - 600.0 / 60.0 * factor).abs() < 0.02 * factor, "{factor}: {span}");
            assert!((from + span - (begin + 799.0 / 60.0 * factor)).abs() < 1e-9);
            let texts: Vec<_> = marks((from, from + span), span).into_iter().map(time_text).collect();
            assert!((2..=5).contains(&texts.len()) && texts.windows(2).all(|pair| pair[0] != pair[1]), "{texts:?}");
        }
        let mut history = History::default();
        history.record(&at(0.0));
        assert_eq!(history.axis(), (0.0, 1.0));
    }

    #[test]
    fn round_off_of_energies_is_drawn_as_zero() {
        let rest = Energies { kinetic: 3e-12, elastic: -6e-11, ..Energies::default() };
        let values = || CURVES.iter().map(|curve| plotted(curve, &rest, 1e-10));
        assert!(values().all(|value| value == 0.0));
        let (low, high) = nice_range(values());
        assert!(low > -0.1 && (0.5..2.0).contains(&high), "an axis of a joule: {low} to {high}");
        assert!(CURVES.iter().any(|curve| plotted(curve, &rest, 1e-13) != 0.0));
    }

    #[test]
    fn labels_of_equal_energies_do_not_cover_each_other() {
        let curves: Vec<_> = CURVES.iter().collect();
        let heights = label_heights(&curves, &Energies::default(), 0.0, [1.0, 3.0]);
        assert!(heights.iter().all(|height| *height <= 3.0));
        for (index, a) in heights.iter().enumerate() {
            assert!(heights[index + 1..].iter().all(|b| (a - b).abs() >= 1.0));
        }
    }
}
