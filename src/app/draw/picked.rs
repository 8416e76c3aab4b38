//! Highlights the vertex that a click would select.

use super::{View, shape_buffer::ShapeBuffer};
use eframe::egui::Pos2;

/// Duration of the fade of the glow [s].
const FADE: f32 = 0.1;

/// Glow of the picked vertex.
#[derive(Debug, Default)]
pub struct Picked {
    vertex: Option<usize>,
    strength: f32,
}

impl Picked {
    /// Moves the glow to another vertex, or fades it out.
    pub fn follow(&mut self, wanted: Option<usize>, dt: f32) {
        if wanted.is_some() && wanted != self.vertex {
            // The new vertex starts with at least half of the glow, so that nothing flashes when the pointer moves along a body.
            self.strength = if self.vertex.is_some() { self.strength.max(0.5) } else { 0.0 };
            self.vertex = wanted;
        }
        let step = dt / FADE;
        self.strength = if wanted.is_some() { self.strength + step } else { self.strength - step }.clamp(0.0, 1.0);
        if self.strength == 0.0 && wanted.is_none() {
            self.vertex = None;
        }
    }

    /// Whether the glow still changes.
    pub fn is_moving(&self) -> bool {
        self.vertex.is_some() && self.strength < 1.0
    }

    /// Draws the glow, and a thin line from a distant pointer.
    pub fn draw(&self, buffer: &mut ShapeBuffer, view: View, points: &[Pos2], pointer: Option<Pos2>) {
        let Some(&at) = self.vertex.and_then(|vertex| points.get(vertex)) else { return };
        let (radius, color) = (view.size(0.011, 5.5, 20.0), view.theme.glow.gamma_multiply(self.strength));
        if let Some(pointer) = pointer.filter(|pointer| pointer.distance(at) > 4.0 * radius) {
            let hair = [pointer, at + (pointer - at).normalized() * radius];
            buffer.line(&hair, false, 1.2, color.gamma_multiply(0.45));
        }
        buffer.halo(at, 3.6 * radius, color.gamma_multiply(0.55));
        let ring: Vec<Pos2> = (0..24).map(|i| at + eframe::egui::Vec2::angled(0.2618 * i as f32) * radius).collect();
        buffer.line(&ring, true, 3.5, view.theme.crust.gamma_multiply(0.5 * self.strength));
        buffer.line(&ring, true, 2.0, color);
    }
}
