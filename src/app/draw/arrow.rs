//! Draws the mouse spring: an arrow with its force.

use super::{View, card, shape_buffer::ShapeBuffer};
use crate::{app::numbers::si_fixed, snapshot::Pull};
use eframe::egui::{Align2, Color32, FontId, Painter, Pos2, Rect, vec2};

/// Shaft width and head length of an arrow [points].
struct Size {
    width: f32,
    head: f32,
}

/// Draws the arrow from its vertex.
pub fn arrow(buffer: &mut ShapeBuffer, view: View, from: Pos2, pull: &Pull) {
    let to = view.camera.screen_from_world(pull.target);
    let length = from.distance(to);
    let width = (view.size(0.006, 2.5, 14.0) + 0.012 * length).min(view.size(0.013, 5.0, 30.0));
    let head = (0.35 * length).clamp(0.0, 5.0 * width);
    let outline = view.theme.icing.gamma_multiply(0.9);
    stroke(buffer, from, to, &Size { width: width + 3.0, head: head + 4.0 }, outline);
    stroke(buffer, from, to, &Size { width, head }, view.theme.pull);
}

fn stroke(buffer: &mut ShapeBuffer, from: Pos2, to: Pos2, size: &Size, color: Color32) {
    buffer.disc(from, 0.9 * size.width, color);
    if size.head < 1.5 * size.width {
        return buffer.line(&[from, to], false, size.width, color);
    }
    let along = (to - from).normalized();
    // The tip lies half a width beyond `to`, so that the outline is visible in front of the head and behind it.
    let tip = to + along * (0.5 * size.width);
    let neck = tip - along * size.head;
    buffer.line(&[from, neck], false, size.width, color);
    let aside = along.rot90() * (0.48 * size.head);
    let notch = neck + along * (0.18 * size.head);
    buffer.area(&[tip, neck + aside, notch, neck - aside], color);
    buffer.line(&[tip, neck + aside, notch, neck - aside], true, 0.4 * size.width, color);
}

/// Writes the force beside the arrow's head.
pub fn force(painter: &Painter, view: View, canvas: Rect, from: Pos2, pull: &Pull) {
    let to = view.camera.screen_from_world(pull.target);
    let right = to.x >= from.x;
    let gap = view.size(0.035, 18.0, 90.0);
    let font = FontId::monospace(view.size(0.024, 14.0, 40.0));
    // Without room beside the head the text lies above or below it.
    let room = if right { canvas.right() - to.x } else { to.x - canvas.left() };
    let (aside, anchor) = if room < gap + 6.5 * font.size {
        if to.y > from.y { (vec2(0.0, gap), Align2::CENTER_TOP) } else { (vec2(0.0, -gap), Align2::CENTER_BOTTOM) }
    } else if right {
        (vec2(gap, 0.0), Align2::LEFT_CENTER)
    } else {
        (vec2(-gap, 0.0), Align2::RIGHT_CENTER)
    };
    let text = si_fixed(pull.force, "N");
    let color = view.theme.pull.lerp_to_gamma(view.theme.annotation, 0.35);
    card(painter, view, canvas, (to + aside, anchor), (text.trim(), font, color));
}
