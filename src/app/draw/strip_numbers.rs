//! What a test level says about each strip, below it: numbers that a projector shows, and where not to trust a model.

use super::View;
use crate::{
    app::numbers::si_fixed,
    snapshot::{BodySnapshot, Snapshot},
};
use eframe::egui::{Align, Color32, FontId, Painter, Pos2, Rect, epaint::text::LayoutJob, pos2};

/// Lines below a strip: name, four numbers, and room for a caution.
const LINES: f32 = 7.6;

/// Text size in a canvas [points].
fn size(canvas: Rect) -> f32 {
    (canvas.height() / 42.0).min(canvas.width() / 42.0).clamp(11.0, 44.0)
}

/// How much room the numbers need below the world [points].
pub fn height(snapshot: &Snapshot, canvas: Rect) -> f32 {
    if snapshot.level.test.is_some() { LINES * 1.3 * size(canvas) } else { 0.0 }
}

/// Writes the numbers of all strips.
pub fn strip_numbers(painter: &Painter, view: View, canvas: Rect, snapshot: &Snapshot) {
    if snapshot.level.test.is_none() {
        return;
    }
    let square = view.camera.square();
    let middles: Vec<f32> = snapshot.bodies.iter().filter_map(|body| middle(view, snapshot, body)).collect();
    let gap = middles.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(canvas.width(), f32::min);
    let most = if middles.len() < 2 { square.width() } else { gap - 10.0 };
    for (body, &middle) in snapshot.bodies.iter().zip(&middles) {
        let top = pos2(middle, square.bottom() + 0.7 * size(canvas));
        column(painter, view, top, most, size(canvas), body, snapshot.side_by_side);
    }
}

/// The middle of a body's start on the screen: text that does not move with it.
fn middle(view: View, snapshot: &Snapshot, body: &BodySnapshot) -> Option<f32> {
    let start = snapshot.start.get(2 * body.vertices.start..2 * body.vertices.end)?;
    let across = || start.iter().step_by(2).copied();
    let (least, most) = (across().fold(f64::INFINITY, f64::min), across().fold(f64::NEG_INFINITY, f64::max));
    Some(view.camera.screen_from_world([0.5 * (least + most), 0.0]).x)
}

fn column(painter: &Painter, view: View, top: Pos2, width: f32, size: f32, body: &BodySnapshot, models: bool) {
    let theme = view.theme;
    let name = if models { body.model.title().to_owned() } else { format!("{}: {}", body.name, body.model.title()) };
    let rows = [
        ("width ", si_fixed(body.mid_width, "m")),
        ("force ", si_fixed(body.top_force, "N")),
        ("energy", si_fixed(body.energy, "J")),
        ("min J ", format!("{}   ", si_fixed(body.min_j, ""))),
    ];
    // A row is 16 letters of about 0.6 em: narrow columns get smaller figures.
    let figures = FontId::monospace(size.min(width / 9.8));
    let mut y = line(painter, top, width, &name, FontId::proportional(1.1 * size.min(width / 8.0)), theme.ink);
    for (label, number) in &rows {
        y = line(painter, pos2(top.x, y), width, &format!("{label} {number}"), figures.clone(), theme.ink);
    }
    if let Some(caution) = &body.caution {
        let font = FontId::proportional(0.9 * size);
        line(painter, pos2(top.x, y + 0.2 * size), width, caution, font, theme.caution);
    }
}

/// Writes a paragraph about a middle and returns where it ends.
fn line(painter: &Painter, top: Pos2, width: f32, text: &str, font: FontId, color: Color32) -> f32 {
    let mut job = LayoutJob::simple(text.to_owned(), font, color, width);
    job.halign = Align::Center;
    let galley = painter.layout_job(job);
    let height = galley.size().y;
    painter.galley(top, galley, color);
    top.y + 1.04 * height
}
