//! The colour bar: which colour means what, with ticks and unit, at the right edge of the stage.

use super::{View, card, ink::Ink};
use crate::{
    app::{
        colour::{Scale, ticks},
        numbers::si,
    },
    snapshot::Field,
};
use eframe::egui::{Align2, CornerRadius, FontId, Painter, Pos2, Rect, pos2, vec2};

/// Where its parts are.
struct Layout {
    card: Rect,
    bar: Rect,
    font: FontId,
}

impl Layout {
    fn new(canvas: Rect) -> Self {
        let size = (canvas.height() / 55.0).clamp(11.5, 30.0);
        let height = (0.5 * canvas.height()).clamp(80.0, 40.0 * size);
        let extent = vec2(6.8 * size, height + 3.0 * size);
        let middle = pos2(canvas.right() - 8.0 - 0.5 * extent.x, canvas.center().y);
        let card = Rect::from_center_size(middle, extent);
        let bar = Rect::from_min_size(card.min + vec2(0.7 * size, 2.2 * size), vec2(1.1 * size, height));
        Self { card, bar, font: FontId::monospace(size) }
    }
}

/// Draws the bar for a field and its scale.
pub fn colour_bar(painter: &Painter, ink: &mut Ink, view: View, canvas: Rect, field: Field, scale: &Scale) {
    let (theme, layout) = (view.theme, Layout::new(canvas));
    painter.rect_filled(layout.card, CornerRadius::same(10), theme.card);
    gradient(ink, layout.bar, scale);
    let title = FontId::proportional(layout.font.size * 1.05);
    let at = pos2(layout.card.right(), layout.card.top() + 1.1 * layout.font.size);
    let at = at - vec2(0.7 * layout.font.size, 0.0);
    painter.text(at, Align2::RIGHT_CENTER, short_title(field), title, theme.ink);
    for value in ticks(scale.range()) {
        tick(painter, view, &layout, field, value, height_of(scale, layout.bar, value));
    }
}

/// The field's name, as short as a card is wide.
fn short_title(field: Field) -> &'static str {
    match field {
        Field::None => "",
        Field::EnergyDensity => "Energy ψ",
        Field::VonMises => "Von Mises",
        Field::Volume => "Area J",
    }
}

fn height_of(scale: &Scale, bar: Rect, value: f64) -> f32 {
    let [low, high] = scale.range();
    bar.bottom() - bar.height() * ((value - low) / (high - low)) as f32
}

fn gradient(ink: &mut Ink, bar: Rect, scale: &Scale) {
    let steps = 64;
    for i in 0..steps {
        let shares = [i, i + 1].map(|i| i as f32 / steps as f32);
        let [bottom, top] = shares.map(|share| bar.bottom() - bar.height() * share);
        let step = Rect::from_min_max(Pos2::new(bar.left(), top), Pos2::new(bar.right(), bottom));
        ink.gradient(step, [scale.at(shares[1]), scale.at(shares[0])]);
    }
}

fn tick(painter: &Painter, view: View, layout: &Layout, field: Field, value: f64, y: f32) {
    let theme = view.theme;
    let rest = field == Field::Volume && (value - 1.0).abs() < 1e-9;
    let reach = if rest { layout.bar.width() } else { 0.0 };
    let right = layout.bar.right();
    painter.hline(right - reach..=right + 4.0, y, (1.0, theme.ink));
    let text = if value == 0.0 { "0".to_owned() } else { si(value, field.unit()) };
    painter.text(pos2(right + 7.0, y), Align2::LEFT_CENTER, text, layout.font.clone(), theme.ink);
}

/// Writes the value under the pointer beside it.
pub fn reading(painter: &Painter, view: View, canvas: Rect, at: Pos2, field: Field, value: f64) {
    let text = si(value, field.unit());
    let font = FontId::monospace((canvas.height() / 55.0).clamp(12.0, 30.0));
    card(painter, view, canvas, (at + vec2(18.0, -18.0), Align2::LEFT_BOTTOM), (&text, font, view.theme.ink));
}
