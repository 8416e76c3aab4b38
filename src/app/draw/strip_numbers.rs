//! Draws the stretch and force of each strip of a test level.

use super::View;
use crate::{
    app::numbers::{or_zero, si_fixed},
    snapshot::{BodySnapshot, Snapshot},
};
use eframe::egui::{Align, Color32, FontId, Painter, Pos2, Rect, epaint::text::LayoutJob, pos2};

/// Number of lines below the strips: a name, four numbers, and two lines for a warning.
const LINES: f32 = 7.2;

/// Text size in a canvas [points].
fn size(canvas: Rect) -> f32 {
    (canvas.height() / 42.0).min(canvas.width() / 34.0).clamp(11.0, 44.0)
}

/// Height of the numbers below the world [points].
pub fn height(snapshot: &Snapshot, canvas: Rect) -> f32 {
    if snapshot.level.test.is_some() { LINES * 1.3 * size(canvas) } else { 0.0 }
}

/// Draws the numbers of all strips, and below them the warnings.
pub fn strip_numbers(painter: &Painter, view: View, canvas: Rect, snapshot: &Snapshot) {
    if snapshot.level.test.is_none() {
        return;
    }
    let (world, size) = (view.camera.world(), size(canvas));
    let middles: Vec<f32> = snapshot.bodies.iter().filter_map(|body| middle(view, snapshot, body)).collect();
    let gap = middles.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(canvas.width(), f32::min);
    let top = world.bottom() + 0.8 * size;
    let mut bottom = top;
    let width = gap - 0.8 * size;
    let names: Vec<_> = snapshot.bodies.iter().map(|body| name(body, snapshot.bodies.len() > 1)).collect();
    let head = names.iter().map(|name| fitting(painter, name, 1.15 * size, width)).fold(f32::INFINITY, f32::min);
    for ((body, name), &middle) in snapshot.bodies.iter().zip(&names).zip(&middles) {
        let column = Column { top: pos2(middle, top), width, size, head };
        bottom = bottom.max(column.write(painter, view, name, (body, snapshot.negligible)));
    }
    for strip_warning in snapshot.bodies.iter().filter_map(|body| body.strip_warning.as_deref()) {
        bottom = sentence(
            painter,
            pos2(canvas.center().x, bottom + 0.25 * size),
            canvas.width() - size,
            strip_warning,
            (FontId::proportional(size), view.theme.warning),
        );
    }
}

/// Horizontal centre of a body's start shape on the screen, so that the text does not move with the body.
fn middle(view: View, snapshot: &Snapshot, body: &BodySnapshot) -> Option<f32> {
    let start = snapshot.start.get(2 * body.vertices.start..2 * body.vertices.end)?;
    let across = || start.iter().step_by(2).copied();
    let (least, most) = (across().fold(f64::INFINITY, f64::min), across().fold(f64::NEG_INFINITY, f64::max));
    Some(view.camera.screen_from_world([0.5 * (least + most), 0.0]).x)
}

/// Title above a body's numbers.
fn name(body: &BodySnapshot, models: bool) -> String {
    let model = body.material.title();
    if models { model.to_owned() } else { format!("{}: {model}", body.name) }
}

/// Text size, at most `size`, at which a name fits into `width`.
fn fitting(painter: &Painter, name: &str, size: f32, width: f32) -> f32 {
    let natural = painter.layout_no_wrap(name.to_owned(), FontId::proportional(size), Color32::PLACEHOLDER).size().x;
    size * (width / natural.max(1.0)).min(1.0)
}

/// Place for the numbers of one strip.
struct Column {
    top: Pos2,
    width: f32,
    /// Text sizes of the numbers and of the names, the same for all strips.
    size: f32,
    head: f32,
}

impl Column {
    /// Draws name and numbers, and returns their lower end.
    fn write(&self, painter: &Painter, view: View, name: &str, (body, negligible): (&BodySnapshot, f64)) -> f32 {
        let color = view.theme.annotation;
        let force = or_zero(body.top_force, negligible / body.mesh.area().sqrt());
        let numbers = [
            format!("width  {}", si_fixed(body.mid_width, "m")),
            format!("force  {}", si_fixed(force, "N")),
            format!("energy {}", si_fixed(or_zero(body.energy, negligible), "J")),
            format!("min J  {}", si_fixed(body.min_j, "")),
        ];
        self.fitted(painter, self.top, name, FontId::proportional(self.head), color);
        let below = pos2(self.top.x, self.top.y + 1.5 * self.size);
        self.fitted(painter, below, &numbers.join("\n"), FontId::monospace(self.size), color)
    }

    /// Draws lines as a centred block, smaller if they are too wide, and returns their lower end.
    fn fitted(&self, painter: &Painter, top: Pos2, text: &str, font: FontId, color: Color32) -> f32 {
        let layout = |font| painter.layout(text.to_owned(), font, color, f32::INFINITY);
        let mut galley = layout(font.clone());
        if galley.size().x > self.width {
            galley = layout(FontId { size: font.size * self.width / galley.size().x, ..font });
        }
        let size = galley.size();
        painter.galley(pos2(top.x - 0.5 * size.x, top.y), galley, color);
        top.y + size.y
    }
}

/// Draws a centred sentence, in several lines if necessary, and returns its lower end.
fn sentence(painter: &Painter, top: Pos2, width: f32, text: &str, (font, color): (FontId, Color32)) -> f32 {
    let mut job = LayoutJob::simple(text.to_owned(), font, color, width);
    job.halign = Align::Center;
    let galley = painter.layout_job(job);
    let height = galley.size().y;
    painter.galley(top, galley, color);
    top.y + height
}
