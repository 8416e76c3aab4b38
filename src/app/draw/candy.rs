//! Draws obstacles and the domain boundary.

use super::{View, scatter, shape_buffer::ShapeBuffer};
use eframe::egui::{Color32, Pos2, Rect, vec2};

/// Draws a solid as a gumdrop: lighter on top, with sugar and a dark foot. `number` selects its colour.
pub fn gumdrop(buffer: &mut ShapeBuffer, view: View, outline: &[[f64; 2]], number: usize, presence: f32) {
    let points: Vec<Pos2> = outline.iter().map(|&point| view.camera.screen_from_world(point)).collect();
    if points.len() < 3 {
        return;
    }
    let color = |color| view.theme.present(color, presence);
    let candy = view.theme.candy[number % 2];
    let bounds = Rect::from_points(&points);
    let (bright, dark) = (candy.lerp_to_gamma(Color32::WHITE, 0.22), candy.lerp_to_gamma(Color32::BLACK, 0.3));
    buffer.shaded(&points, |at| color(bright.lerp_to_gamma(dark, (at.y - bounds.top()) / bounds.height().max(1.0))));
    buffer.line(&points, true, view.size(0.005, 1.5, 20.0), color(dark));
    sugar(buffer, view, &points, bounds, color(candy.lerp_to_gamma(Color32::WHITE, 0.75)));
}

/// Draws a line around a highlighted solid.
pub fn ring(buffer: &mut ShapeBuffer, view: View, outline: &[[f64; 2]], presence: f32) {
    let points: Vec<Pos2> = outline.iter().map(|&point| view.camera.screen_from_world(point)).collect();
    buffer.line(&points, true, view.size(0.009, 3.0, 20.0), view.theme.accent_line.gamma_multiply(presence));
}

/// Draws sugar grains inside an outline.
fn sugar(buffer: &mut ShapeBuffer, view: View, outline: &[Pos2], bounds: Rect, color: Color32) {
    let size = view.size(0.0028, 0.8, 8.0);
    let world = view.camera.length(1.0);
    let count = (1800.0 * bounds.area() / (world * world)).clamp(8.0, 300.0) as usize;
    for grain in 0..count {
        let at = bounds.min + vec2(scatter(grain, 11), scatter(grain, 12)) * bounds.size();
        if is_inside(outline, at) {
            buffer.disc(at, size * (0.6 + 0.6 * scatter(grain, 13)), color.gamma_multiply(0.8));
        }
    }
}

/// Whether a point lies inside an outline, by the number of edges to its right.
fn is_inside(outline: &[Pos2], at: Pos2) -> bool {
    let mut inside = false;
    for (i, a) in outline.iter().enumerate() {
        let b = outline[(i + 1) % outline.len()];
        if (a.y > at.y) != (b.y > at.y) && at.x < a.x + (at.y - a.y) / (b.y - a.y) * (b.x - a.x) {
            inside = !inside;
        }
    }
    inside
}

/// Draws the boundary of the domain as a thread of icing.
pub fn edges(buffer: &mut ShapeBuffer, view: View, [least, greatest]: [[f64; 2]; 2], presence: f32) {
    let corners = [least, [greatest[0], least[1]], greatest, [least[0], greatest[1]]];
    let points = corners.map(|corner| view.camera.screen_from_world(corner));
    let color = view.theme.world_edge.gamma_multiply(presence);
    buffer.line(&points, true, view.size(0.003, 1.5, 8.0), color);
}
