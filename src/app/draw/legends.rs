//! Draws numbers over the stage: the colour bar with ticks and unit, and stretch and force of each strip of a test level.

use super::{View, card, shape_buffer::ShapeBuffer};
use crate::{
    app::{
        colour::{Scale, ticks},
        language::tr,
        numbers::{or_zero, si, si_fixed, unit_for},
    },
    snapshot::{BodySnapshot, Field, Snapshot},
};
use eframe::egui::{
    Align, Align2, Color32, CornerRadius, FontId, Painter, Pos2, Rect, epaint::text::LayoutJob, pos2, vec2,
};

/// Height of the buttons of the view at the upper right [points].
const BUTTONS: f32 = 28.0;

/// Positions of the parts of the bar.
struct Layout {
    card: Rect,
    bar: Rect,
    font: FontId,
}

impl Layout {
    fn new(canvas: Rect, square: Rect) -> Self {
        let size = (canvas.height() / 55.0).clamp(12.0, 32.0);
        let (width, ends) = (5.6 * size, 5.2 * size);
        // The bar lies at the edge of the stage, but not far from the house in a wide window.
        let left = (canvas.right() - 8.0 - width).min(square.right() + 0.14 * square.width());
        let height = (0.5 * canvas.height()).clamp(80.0, 40.0 * size);
        // On a tall stage there is room above the world, where the bar covers no body.
        let above = square.top() - canvas.top() - 16.0 - BUTTONS - ends;
        let over = left < square.right() && above > 80.0;
        let height = if over { height.min(above) } else { height };
        let extent = vec2(width, height + ends);
        let top = if over { canvas.top() + 8.0 + BUTTONS } else { canvas.center().y - 0.5 * extent.y };
        let middle = pos2(left + 0.5 * width, top + 0.5 * extent.y);
        let card = Rect::from_center_size(middle, extent);
        let bar = Rect::from_min_size(card.min + vec2(0.8 * size, 4.1 * size), vec2(1.1 * size, height));
        Self { card, bar, font: FontId::monospace(size) }
    }
}

/// Draws the bar for a field and its scale beside the `world`, as it lies where the whole of it is seen.
pub fn colour_bar(
    painter: &Painter,
    buffer: &mut ShapeBuffer,
    view: View,
    [canvas, world]: [Rect; 2],
    (field, scale): (Field, &Scale),
) {
    let (theme, layout, range) = (view.theme, Layout::new(canvas, world), scale.range());
    let size = layout.font.size;
    painter.rect_filled(layout.card, CornerRadius::same(10), theme.card);
    gradient(buffer, layout.bar, scale, field.is_signed());
    let (count, unit) = unit_for(range[1], field.unit());
    let title = pos2(layout.card.center().x, layout.card.top() + 0.5 * size);
    painter.text(
        title,
        Align2::CENTER_TOP,
        tr(short_title(field)),
        FontId::proportional(1.05 * size),
        theme.annotation,
    );
    let below = title + vec2(0.0, 1.4 * size);
    painter.text(below, Align2::CENTER_TOP, unit, FontId::proportional(size), theme.faint_annotation);
    for value in ticks(range) {
        let rest = field.is_signed() && (value - field.rest()).abs() < 1e-9 * range[1].abs();
        let y = layout.bar.bottom() - layout.bar.height() * scale.share(value);
        tick(painter, view, &layout, y, &si(value / count, ""), rest);
    }
}

/// Title of the field that fits the width of the card.
const fn short_title(field: Field) -> &'static str {
    match field {
        Field::None => "",
        Field::EnergyDensity => "Energy ψ",
        Field::VonMises => "Von Mises",
        Field::Volume => "Area J",
        Field::Stretch => "Stretch λ₁",
        Field::PrincipalStress => "Stress σ₁",
        Field::Pressure => "Pressure",
        Field::Speed => "Speed",
        Field::Displacement => "Displaced",
        Field::StressError => "Error η²",
    }
}

/// Draws the gradient, with a tip at an end beyond which values are cut off.
fn gradient(buffer: &mut ShapeBuffer, bar: Rect, scale: &Scale, both_ways: bool) {
    let steps = 64;
    for i in 0..steps {
        let shares = [i, i + 1].map(|i| i as f32 / steps as f32);
        let [bottom, top] = shares.map(|share| bar.bottom() - bar.height() * share);
        let step = Rect::from_min_max(Pos2::new(bar.left(), top), Pos2::new(bar.right(), bottom));
        buffer.gradient(step, [scale.at(shares[1]), scale.at(shares[0])]);
    }
    let tip = vec2(0.5 * bar.width(), -0.6 * bar.width());
    buffer.area(&[bar.left_top(), bar.left_top() + tip, bar.right_top()], scale.at(1.0));
    if both_ways {
        let tip = vec2(tip.x, -tip.y);
        buffer.area(&[bar.left_bottom(), bar.left_bottom() + tip, bar.right_bottom()], scale.at(0.0));
    }
}

/// Draws a tick with its number; the tick of the rest value crosses the bar.
fn tick(painter: &Painter, view: View, layout: &Layout, y: f32, text: &str, rest: bool) {
    let reach = if rest { layout.bar.width() } else { 0.0 };
    let right = layout.bar.right();
    let color = if rest { Color32::BLACK } else { view.theme.annotation };
    painter.hline(right - reach..=right + 4.0, y, (1.0, color));
    painter.text(pos2(right + 8.0, y), Align2::LEFT_CENTER, text, layout.font.clone(), view.theme.annotation);
}

/// Draws a bar of a round length, at the scale of the camera, with that length.
pub fn scale_bar(painter: &Painter, view: View, canvas: Rect) {
    /// Longest bar and least width of a stage that has one [points].
    const LONGEST: f64 = 110.0;
    const NARROWEST: f32 = 260.0;
    let scale = view.camera.scale();
    let most = LONGEST / scale;
    if canvas.width() < NARROWEST || !most.is_normal() {
        return;
    }
    let power = libm::pow(10.0, libm::floor(libm::log10(most)));
    let metres = [5.0, 2.0, 1.0].map(|lead| lead * power).into_iter().find(|metres| *metres <= most).unwrap_or(power);
    let from = canvas.left_bottom() + vec2(18.0, -14.0);
    let to = from + vec2((metres * scale) as f32, 0.0);
    let ground = Rect::from_min_max(from - vec2(10.0, 22.0), to + vec2(10.0, 8.0));
    painter.rect_filled(ground, CornerRadius::same(6), view.theme.card);
    let stroke = (1.5, view.theme.annotation);
    painter.line_segment([from, to], stroke);
    for end in [from, to] {
        painter.line_segment([end - vec2(0.0, 4.0), end + vec2(0.0, 4.0)], stroke);
    }
    let middle = from.lerp(to, 0.5) - vec2(0.0, 4.0);
    painter.text(middle, Align2::CENTER_BOTTOM, si(metres, "m"), FontId::proportional(12.0), view.theme.annotation);
}

/// Writes the name of a probe beside it.
pub fn tag(painter: &Painter, view: View, canvas: Rect, at: Pos2, text: &str) {
    let font = FontId::monospace(12.0);
    card(painter, view, canvas, (at, Align2::LEFT_BOTTOM), (text, font, view.theme.annotation));
}

/// Draws the value under the pointer beside the pointer.
pub fn reading(painter: &Painter, view: View, canvas: Rect, at: Pos2, field: Field, value: f64) {
    let text = si(value, field.unit());
    let font = FontId::monospace((canvas.height() / 55.0).clamp(13.0, 32.0));
    card(painter, view, canvas, (at + vec2(18.0, -18.0), Align2::LEFT_BOTTOM), (&text, font, view.theme.annotation));
}

/// Number of lines below the strips: a name, four numbers, and two lines for a warning.
const LINES: f32 = 7.2;

/// Text size in a canvas [points].
fn text_size(canvas: Rect) -> f32 {
    (canvas.height() / 42.0).min(canvas.width() / 34.0).clamp(11.0, 44.0)
}

/// Height of the numbers below the world [points].
pub fn strip_height(snapshot: &Snapshot, canvas: Rect) -> f32 {
    if snapshot.level.test.is_some() { LINES * 1.3 * text_size(canvas) } else { 0.0 }
}

/// Draws the numbers of all strips, and below them the warnings.
pub fn strip_numbers(painter: &Painter, view: View, canvas: Rect, snapshot: &Snapshot) {
    if snapshot.level.test.is_none() {
        return;
    }
    let (world, size) = (view.camera.world(), text_size(canvas));
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
