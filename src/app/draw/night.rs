//! Draws the background: sky and snow, or paper in the light theme.

use super::{View, scatter, shape_buffer::ShapeBuffer};
use eframe::egui::{CornerRadius, Painter, Rect, Stroke, StrokeKind, pos2};

/// Slow sparse snow, which falls only while simulated time runs.
#[derive(Debug, Default)]
pub struct Snow {
    /// Time that the snow has fallen [s].
    time: f32,
}

impl Snow {
    /// Advances the snow by a time [s].
    pub fn fall(&mut self, dt: f32) {
        self.time += dt;
    }

    /// Draws the flakes.
    pub fn draw(&self, buffer: &mut ShapeBuffer, canvas: Rect, view: View) {
        let count = (canvas.area() / 9000.0).clamp(24.0, 240.0) as usize;
        let unit = (canvas.height() / 700.0).clamp(0.8, 2.5);
        for flake in 0..count {
            let near = scatter(flake, 1);
            let across = scatter(flake, 2) + 0.012 * (self.time * (0.3 + 0.4 * near) + 40.0 * near).sin();
            let down = (scatter(flake, 3) + self.time * (0.006 + 0.016 * near)).fract();
            let at = pos2(canvas.left() + canvas.width() * across, canvas.top() + canvas.height() * down);
            buffer.disc(at, unit * (0.7 + 1.5 * near * near), view.theme.snow.gamma_multiply(0.2 + 0.55 * near));
        }
    }
}

/// Draws the sky.
pub fn sky(buffer: &mut ShapeBuffer, canvas: Rect, view: View) {
    buffer.gradient(canvas, view.theme.sky);
}

/// Draws the world square, where there is no house.
pub fn square(painter: &Painter, view: View, presence: f32) {
    let (theme, corner) = (view.theme, CornerRadius::same(2));
    let world = view.camera.world();
    painter.rect_filled(world, corner, theme.world.gamma_multiply(presence));
    let edge = Stroke::new(1.0, theme.world_edge.gamma_multiply(presence));
    painter.rect_stroke(world, corner, edge, StrokeKind::Inside);
}
