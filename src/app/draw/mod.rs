//! Drawing of the stage: one file for each thing on it.

pub mod arrow;
pub mod body;
pub mod candy;
pub mod colour_bar;
mod ears;
pub mod fill;
pub mod house;
mod icing;
pub mod net;
pub mod night;
pub mod picked;
pub mod pins;
pub mod rollers;
mod roof;
pub mod shape_buffer;
pub mod strip_numbers;
pub mod toy;

use super::{camera::Camera, theme::Theme};
use eframe::egui::{Align2, Color32, CornerRadius, FontId, Painter, Pos2, Rect, vec2};

/// Camera and theme of a drawing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Camera of the stage.
    pub camera: Camera,
    /// Colours of the theme.
    pub theme: &'static Theme,
}

impl View {
    /// Length on the screen of a length of the world [m], limited to stay readable [points].
    fn size(&self, metres: f32, least: f32, most: f32) -> f32 {
        self.camera.length(metres).clamp(least, most)
    }
}

/// Draws text on a card, which keeps it readable on any background, inside `within`. Returns the card.
fn card(painter: &Painter, view: View, within: Rect, at: (Pos2, Align2), text: (&str, FontId, Color32)) -> Rect {
    let (text, font, color) = text;
    let galley = painter.layout_no_wrap(text.to_owned(), font, color);
    let padding = vec2(7.0, 3.0);
    let mut rect = at.1.anchor_size(at.0, galley.size() + 2.0 * padding);
    let inside = within.shrink(4.0);
    rect = rect.translate(vec2((inside.left() - rect.left()).max(0.0), (inside.top() - rect.top()).max(0.0)));
    rect = rect.translate(vec2((inside.right() - rect.right()).min(0.0), (inside.bottom() - rect.bottom()).min(0.0)));
    painter.rect_filled(rect, CornerRadius::same(6), view.theme.card);
    painter.galley(rect.min + padding, galley, color);
    rect
}

/// Pseudo-random number from 0 to 1, fixed by its two seeds.
fn scatter(seed: usize, salt: u32) -> f32 {
    let mut hash = (seed as u32).wrapping_mul(0x9E37_79B9) ^ salt.wrapping_mul(0x85EB_CA6B);
    hash = (hash ^ (hash >> 15)).wrapping_mul(0x2C1B_3C6D);
    hash = (hash ^ (hash >> 12)).wrapping_mul(0x297A_2D39);
    (hash ^ (hash >> 15)) as f32 / u32::MAX as f32
}
