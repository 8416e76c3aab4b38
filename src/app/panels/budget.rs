//! Error budget: a bar of the sources of error, and a table with what they move and cost.

use super::{
    PanelContext, View,
    plotting::{self, Figure},
    scheme::percent,
    studies::{caption, results},
};
use crate::{
    app::{
        jobs::{Budget, SECONDS},
        language::tr,
        numbers,
        theme::Theme,
    },
    study::{ErrorSource, SourceKind},
};
use eframe::egui::{Color32, Grid, Rect, RichText, Sense, Ui, pos2, vec2};

/// Tooltip of the measurement.
pub const HELP: &str = "The first second of the level, once as it is, and once more for each source of error.";

pub fn show(ui: &mut Ui, context: &PanelContext<'_>, view: &mut View) {
    let invitation = "The first second of the level runs as it is, and once more for each source of error: with half of the step, a finer mesh, \
                      stiffer contact, without sleep, with quadratic elements, and without each effect. How far does each move the result, and what does it cost?";
    let Some(budget) = results(ui, context.jobs.budget.findings(), invitation) else { return };
    let Some(ms) = budget.ms_per_second else { return };
    let about = format!(
        "{SECONDS} s of the level as it is: {}. Distances are relative to the motion; what removes most of them for its time comes first.",
        numbers::si(1e-3 * ms, "s")
    );
    caption(ui, view, Figure::Budget, &about, &budget.level, &budget.csv);
    let rect = ui.scope(|ui| contents(ui, budget, ms)).response.rect;
    plotting::pose(ui, view, Figure::Budget, rect);
}

fn contents(ui: &mut Ui, budget: &Budget, ms: f64) {
    let theme = Theme::of(ui.ctx());
    let of = |kind: SourceKind| budget.sources.iter().filter(move |source| source.kind == kind);
    bar(ui, of(SourceKind::Numerical), theme);
    ui.add_space(6.0);
    let series = |number: usize| theme.series[number % theme.series.len()];
    let refined = of(SourceKind::Numerical).enumerate().map(|(number, source)| (Some(series(number)), source));
    let together = of(SourceKind::Together).map(|source| (None, source));
    let replaced = of(SourceKind::Replaced).map(|source| (None, source));
    table(ui, ["Refined", "to", "Moves by", "Error", "Time"], refined.chain(together).chain(replaced), ms);
    ui.add_space(10.0);
    table(ui, ["Effect", "", "Moves by", "", "Time"], of(SourceKind::Effect).map(|source| (None, source)), ms);
}

/// Draws the distances of the sources beside each other.
fn bar<'a>(ui: &mut Ui, sources: impl Iterator<Item = &'a ErrorSource>, theme: &Theme) {
    let moved: Vec<_> = sources.map(|source| source.moved.unwrap_or(0.0)).collect();
    let sum: f64 = moved.iter().sum();
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 18.0), Sense::hover());
    response.on_hover_text(tr("Shares of what each refinement moves: the widest part is the greatest source of error"));
    ui.painter().rect_filled(rect, 4.0, ui.visuals().extreme_bg_color);
    let mut left = rect.left();
    for (number, moved) in moved.into_iter().enumerate().filter(|_| sum > 0.0) {
        let right = left + rect.width() * (moved / sum) as f32;
        let part = Rect::from_min_max(pos2(left, rect.top()), pos2(right, rect.bottom()));
        ui.painter().rect_filled(part, 2.0, theme.series[number % theme.series.len()]);
        left = right;
    }
}

fn table<'a>(
    ui: &mut Ui,
    titles: [&str; 5],
    sources: impl Iterator<Item = (Option<Color32>, &'a ErrorSource)>,
    ms: f64,
) {
    Grid::new(titles[0]).num_columns(6).spacing([18.0, 4.0]).show(ui, |ui| {
        ui.label("");
        for title in titles {
            ui.label(RichText::new(title).small().weak());
        }
        ui.end_row();
        for (color, source) in sources {
            let (rect, _) = ui.allocate_exact_size(vec2(10.0, 10.0), Sense::hover());
            ui.painter().rect_filled(rect, 2.0, color.unwrap_or(Color32::TRANSPARENT));
            ui.label(&source.name);
            ui.label(&source.change);
            let share = |value: Option<f64>| value.map_or_else(String::new, percent);
            match &source.trouble {
                Some(trouble) => drop(ui.label(RichText::new(trouble).small())),
                None if source.moved.is_none() => drop(ui.label("…")),
                None => drop(ui.monospace(share(source.moved))),
            }
            ui.monospace(share(source.error));
            let time = source.price.map_or_else(String::new, |price| {
                let change = 1e-3 * ms * (price - 1.0);
                let sign = if change < 0.0 { "−" } else { "+" };
                format!("{sign}{}", numbers::si_fixed(change.abs(), "s"))
            });
            ui.monospace(time);
            ui.end_row();
        }
    });
}
