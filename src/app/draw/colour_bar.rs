//! Draws the colour bar with ticks and unit.

use super::{View, card, shape_buffer::ShapeBuffer};
use crate::{
    app::{
        colour::{Scale, ticks},
        numbers::{si, unit_for},
    },
    snapshot::Field,
};
use eframe::egui::{Align2, Color32, CornerRadius, FontId, Painter, Pos2, Rect, pos2, vec2};

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
        let above = square.top() - canvas.top() - 16.0 - ends;
        let over = left < square.right() && above > 80.0;
        let height = if over { height.min(above) } else { height };
        let extent = vec2(width, height + ends);
        let top = if over { canvas.top() + 8.0 } else { canvas.center().y - 0.5 * extent.y };
        let middle = pos2(left + 0.5 * width, top + 0.5 * extent.y);
        let card = Rect::from_center_size(middle, extent);
        let bar = Rect::from_min_size(card.min + vec2(0.8 * size, 4.1 * size), vec2(1.1 * size, height));
        Self { card, bar, font: FontId::monospace(size) }
    }
}

/// Draws the bar for a field and its scale.
pub fn colour_bar(painter: &Painter, buffer: &mut ShapeBuffer, view: View, canvas: Rect, field: Field, scale: &Scale) {
    let (theme, layout, range) = (view.theme, Layout::new(canvas, view.camera.world()), scale.range());
    let size = layout.font.size;
    painter.rect_filled(layout.card, CornerRadius::same(10), theme.card);
    gradient(buffer, layout.bar, scale, field == Field::Volume);
    let (count, unit) = unit_for(range[1], field.unit());
    let title = pos2(layout.card.center().x, layout.card.top() + 0.5 * size);
    painter.text(title, Align2::CENTER_TOP, short_title(field), FontId::proportional(1.05 * size), theme.annotation);
    let below = title + vec2(0.0, 1.4 * size);
    painter.text(below, Align2::CENTER_TOP, unit, FontId::proportional(size), theme.faint_annotation);
    for value in ticks(range) {
        let rest = field == Field::Volume && (value - 1.0).abs() < 1e-9;
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

/// Draws the value under the pointer beside the pointer.
pub fn reading(painter: &Painter, view: View, canvas: Rect, at: Pos2, field: Field, value: f64) {
    let text = si(value, field.unit());
    let font = FontId::monospace((canvas.height() / 55.0).clamp(13.0, 32.0));
    card(painter, view, canvas, (at + vec2(18.0, -18.0), Align2::LEFT_BOTTOM), (&text, font, view.theme.annotation));
}
