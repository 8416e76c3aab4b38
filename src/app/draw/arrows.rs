//! Draws arrows over the scene, and the value of the longest.

use super::{View, card, shape_buffer::ShapeBuffer};
use crate::app::{
    arrows::{Arrow, Arrows},
    numbers::si,
};
use eframe::egui::{Align2, Color32, FontId, Painter, Pos2, Rect, vec2};

/// Width of a line, and the light edge around it [points].
const WIDTH: f32 = 1.6;
const EDGE: f32 = 1.0;

/// Length of an arrow's head, and half of a bar [points].
const HEAD: f32 = 5.5;

/// Arrows that are shorter are not drawn [points].
const SHORTEST: f32 = 1.5;

/// Colours of tension and compression.
const SIGNS: [Color32; 2] = [Color32::from_rgb(0xc0, 0x30, 0x28), Color32::from_rgb(0x1c, 0x6a, 0xb0)];

/// Draws the arrows; `seen` maps a point of the scene to the screen.
pub fn draw(buffer: &mut ShapeBuffer, view: View, arrows: &Arrows, seen: impl Fn([f64; 3]) -> Pos2) {
    // All light edges come first, so that they cover no other arrow.
    for with_edge in [true, false] {
        for Arrow { at, along, tension } in arrows.loads().iter().chain(arrows.all()) {
            let end = |sign: f64| seen(std::array::from_fn(|axis| at[axis] + sign * along[axis]));
            let (from, to) = (if tension.is_some() { end(-1.0) } else { seen(*at) }, end(1.0));
            if from.distance(to) < SHORTEST || !from.is_finite() || !to.is_finite() {
                continue;
            }
            let color = match tension {
                None => view.theme.pull,
                Some(tension) => SIGNS[usize::from(!tension)],
            };
            let (width, color) = if with_edge { (WIDTH + 2.0 * EDGE, view.theme.icing) } else { (WIDTH, color) };
            buffer.line(&[from, to], false, width, color);
            if *tension == Some(false) {
                bar(buffer, from, to, (width, color));
                bar(buffer, to, from, (width, color));
            } else {
                head(buffer, from, to, (width, color));
                if tension.is_some() {
                    head(buffer, to, from, (width, color));
                }
            }
        }
    }
}

/// Draws the head of an arrow as two short lines from its tip.
fn head(buffer: &mut ShapeBuffer, from: Pos2, to: Pos2, (width, color): (f32, Color32)) {
    let back = (from - to).normalized() * HEAD.min(0.6 * from.distance(to));
    let aside = 0.6 * back.rot90();
    buffer.line(&[to + back + aside, to, to + back - aside], false, width, color);
}

/// Draws a bar across the end of a line.
fn bar(buffer: &mut ShapeBuffer, from: Pos2, to: Pos2, (width, color): (f32, Color32)) {
    let aside = (from - to).normalized().rot90() * (0.5 * HEAD).min(0.3 * from.distance(to));
    buffer.line(&[to + aside, to - aside], false, width, color);
}

/// Writes the value of the longest arrow above the scale bar.
pub fn legend(painter: &Painter, view: View, canvas: Rect, arrows: &Arrows) {
    let Some((greatest, unit)) = arrows.greatest() else { return };
    let text = format!("longest arrow {}", si(greatest, unit));
    let place = canvas.left_bottom() + vec2(8.0, -44.0);
    let font = FontId::proportional(12.0);
    card(painter, view, canvas, (place, Align2::LEFT_BOTTOM), (&text, font, view.theme.annotation));
}
