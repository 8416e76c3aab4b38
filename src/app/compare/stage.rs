//! The split stage: two canvases, each with a title.

use super::{Pane, PaneRequest};
use crate::{
    app::{
        canvas::{self, Canvas, Options},
        language::tr_with,
        numbers::si,
        panels::count,
        theme::Theme,
    },
    command::Command,
    snapshot::Snapshot,
};
use eframe::egui::{
    Align, Button, CornerRadius, FontId, Galley, Layout, Rect, RichText, Role, Sense, Stroke, Ui, UiBuilder,
    WidgetInfo, epaint::text::LayoutJob, epaint::text::TextFormat, pos2, vec2,
};
use std::sync::Arc;

/// Gap between the panes [points].
const GAP: f32 = 3.0;

/// Padding around the text of a head [points].
const PAD: f32 = 7.0;

/// Side of the square with the letter [points].
const BADGE: f32 = 20.0;

/// Minimum width of a pane whose head shows measured values [points].
const WIDE: f32 = 560.0;

/// Width of the button in a head [points].
const KEEP: f32 = 58.0;

/// Canvas of pane B and the pointer commands of both panes.
#[derive(Default)]
pub struct Stage {
    canvas: Canvas,
    /// Commands of the pointer, with the pane whose vertices they concern.
    pub asked: Vec<(Pane, Command)>,
}

/// Settings of a snapshot, most important first: scheme, step, model, mesh.
pub fn settings(seen: &Snapshot) -> Vec<String> {
    let level = &seen.level;
    let mut all = vec![level.integrator.kind().title().to_owned(), si(level.substeps.step(), "s")];
    let mut models: Vec<&str> = seen.bodies.iter().map(|body| body.material.title()).collect();
    models.dedup();
    match models.as_slice() {
        [] => {}
        [model] => all.push((*model).to_owned()),
        _ => all.push("several models".to_owned()),
    }
    if !seen.triangles.is_empty() {
        all.push(format!("{} triangles", count(seen.triangles.len())));
    }
    all
}

/// Both panes and the chosen one.
pub struct Split<'a> {
    /// Snapshots of the panes.
    pub seen: [&'a Snapshot; 2],
    /// Pane that the panels edit.
    pub chosen: Pane,
    /// Distance of the panes in words, for the head of B.
    pub apart: String,
}

impl Stage {
    /// Whether all pointer commands only grab, pull or release a vertex.
    pub fn only_pulls(&self) -> bool {
        self.asked.iter().all(|(_, command)| command.is_of_the_hand())
    }

    /// Canvas of pane B.
    pub const fn canvas(&self) -> &Canvas {
        &self.canvas
    }

    /// The same, to be changed.
    pub const fn canvas_mut(&mut self) -> &mut Canvas {
        &mut self.canvas
    }

    /// The same, for a stage where only B is kept.
    pub fn into_canvas(self) -> Canvas {
        self.canvas
    }

    /// Fills the rest of `ui` with both panes; `first` is the canvas of pane A.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        first: &mut Canvas,
        split: &Split<'_>,
        options: &Options,
    ) -> Option<PaneRequest> {
        let whole = ui.available_rect_before_wrap();
        ui.allocate_rect(whole, Sense::hover());
        let parts = split_rect(whole, split.seen[0]);
        ui.painter().rect_filled(whole, 0.0, ui.visuals().widgets.noninteractive.bg_stroke.color);
        let texts = texts(ui, split, parts[0].width());
        let height = texts.iter().map(|text| text.size().y + 2.0 * 4.0).fold(BADGE + 6.0, f32::max);
        canvas::share_view(first, &mut self.canvas);
        let mut request = None;
        let canvases = [first, &mut self.canvas];
        for ((pane, part), (canvas, text)) in Pane::BOTH.into_iter().zip(parts).zip(canvases.into_iter().zip(texts)) {
            let (top, rest) = part.split_top_bottom_at_y(part.top() + height);
            request = head(ui, top, pane, text, split).or(request);
            let builder = UiBuilder::new().id_salt(pane.letter()).max_rect(rest);
            let mut commands = Vec::new();
            let name = if pane == Pane::A { "Stage A" } else { "Stage B" };
            let pointed = options.pointed.filter(|_| pane == split.chosen);
            let options = Options { pointed, name, ..*options };
            ui.scope_builder(builder, |ui| {
                ui.set_clip_rect(rest.intersect(ui.clip_rect()));
                canvas.show(ui, split.seen[pane as usize], &options, &mut commands);
            });
            self.asked.extend(commands.into_iter().map(|command| (pane, command)));
        }
        request
    }
}

/// Splits a rectangle side by side or one above the other, whichever shows the world larger.
fn split_rect(whole: Rect, seen: &Snapshot) -> [Rect; 2] {
    // The parts are exactly equal, so that both show the world at the same scale.
    let half = ((whole.size() - vec2(GAP, GAP)) * 0.5).floor();
    let beside = [whole.with_max_x(whole.left() + half.x), whole.with_min_x(whole.right() - half.x)];
    let stacked = [whole.with_max_y(whole.top() + half.y), whole.with_min_y(whole.bottom() - half.y)];
    let size = |rect: Rect| canvas::camera(seen, rect.with_min_y(rect.top() + BADGE + 6.0)).length(1.0);
    if size(stacked[0]) > size(beside[0]) { stacked } else { beside }
}

/// Texts of both heads: different settings are strong, equal ones are faint.
fn texts(ui: &Ui, split: &Split<'_>, width: f32) -> [Arc<Galley>; 2] {
    let theme = Theme::of(ui.ctx());
    let all = split.seen.map(settings);
    Pane::BOTH.map(|pane| {
        let (own, other) = (&all[pane as usize], &all[pane.other() as usize]);
        let mut job = LayoutJob::default();
        job.wrap.max_width = (width - BADGE - KEEP - 3.0 * PAD).max(60.0);
        job.wrap.max_rows = 2;
        for (number, part) in own.iter().enumerate() {
            let differs = other.get(number) != Some(part);
            let color = if differs { theme.text } else { theme.faint_text };
            let format =
                |color| TextFormat { valign: Align::Center, ..TextFormat::simple(FontId::proportional(13.0), color) };
            job.append(&part.replace(' ', "\u{a0}"), 0.0, format(color));
            if number + 1 < own.len() {
                job.append("\u{a0}· ", 0.0, format(theme.faint_text));
            }
        }
        if pane == Pane::B && width > WIDE && !split.apart.is_empty() {
            let format =
                TextFormat { valign: Align::Center, ..TextFormat::simple(FontId::monospace(12.0), theme.text) };
            job.append(&split.apart, 14.0, format);
        }
        ui.painter().layout_job(job)
    })
}

/// Draws a head: letter, settings and a button that keeps only this pane. A click on the head chooses the pane.
fn head(ui: &mut Ui, rect: Rect, pane: Pane, text: Arc<Galley>, split: &Split<'_>) -> Option<PaneRequest> {
    let theme = Theme::of(ui.ctx());
    let chosen = split.chosen == pane;
    let words = settings(split.seen[pane as usize]).join(" · ");
    let response = ui.interact(rect, ui.scope_id().with(("head", pane.letter())), Sense::click());
    let name = format!("{} · {words}", pane.letter());
    response.widget_info(|| WidgetInfo::selected(Role::RadioButton, true, chosen, &name));
    let back = if chosen { theme.panel } else { theme.well };
    ui.painter().rect_filled(rect, 0.0, if response.hovered() { theme.button[0] } else { back });
    let color = super::color(theme, pane);
    let badge = Rect::from_center_size(pos2(rect.left() + PAD + 0.5 * BADGE, rect.center().y), vec2(BADGE, BADGE));
    let (fill, ink) = if chosen { (color, theme.well) } else { (theme.well, color) };
    ui.painter().rect(badge, CornerRadius::same(5), fill, Stroke::new(1.5, color), eframe::egui::StrokeKind::Inside);
    let letter = ui.painter().layout_no_wrap(pane.letter().to_owned(), FontId::proportional(15.0), ink);
    ui.painter().galley(badge.center() - 0.5 * letter.size(), letter, ink);
    let at = pos2(badge.right() + PAD, rect.center().y - 0.5 * text.size().y);
    ui.painter().galley(at, text, theme.text);
    if chosen {
        let line = Rect::from_min_max(pos2(rect.left(), rect.bottom() - 2.0), rect.max);
        ui.painter().rect_filled(line, 0.0, color);
    }
    let place = Rect::from_min_max(pos2(rect.right() - KEEP - PAD, rect.top()), rect.max - vec2(PAD, 0.0));
    let mut keep = false;
    ui.scope_builder(UiBuilder::new().max_rect(place).layout(Layout::right_to_left(Align::Center)), |ui| {
        let letter = [("pane", pane.letter())];
        let words = tr_with("Keep {pane}", &letter);
        let help = tr_with("Ends the comparison: {pane} stays, with everything as it is now.", &letter);
        keep = ui.add(Button::new(RichText::new(words).small()).small()).on_hover_text(help).clicked();
    });
    let response = response.on_hover_text(format!("{name}\nClick: the panels show and change this pane."));
    if keep {
        return Some(PaneRequest::Keep(pane));
    }
    response.clicked().then_some(PaneRequest::Choose(pane))
}
