//! Draws rollers: vertices of which one coordinate is fixed.

use super::{View, shape_buffer::ShapeBuffer};
use crate::snapshot::Snapshot;
use eframe::egui::{Color32, Pos2, Rect, vec2};

/// Draws a wheel at every vertex on rollers, and a rail for every side.
pub fn rollers(buffer: &mut ShapeBuffer, view: View, snapshot: &Snapshot, points: &[Pos2]) {
    let radius = view.size(0.007, 3.0, 12.0);
    let held = |slide: &(u32, usize)| {
        let at = points.get(slide.0 as usize).copied().unwrap_or_default();
        (slide.1, if slide.1 == 0 { at.x } else { at.y })
    };
    for side in snapshot.rollers.chunk_by(|a, b| held(a) == held(b)) {
        let wheels = || side.iter().filter_map(|slide| points.get(slide.0 as usize).copied());
        let Some(first) = wheels().next() else { continue };
        let along = if side[0].1 == 0 { vec2(0.0, 1.0) } else { vec2(1.0, 0.0) };
        let reach = wheels().fold(Rect::from_pos(first), |reach, at| reach.union(Rect::from_pos(at)));
        let beyond = along * (4.0 * radius);
        buffer.line(&[reach.min - beyond, reach.max + beyond], false, 0.6 * radius, view.theme.annotation);
        for at in wheels() {
            buffer.disc(at, radius, view.theme.annotation);
            buffer.disc(at, 0.62 * radius, Color32::WHITE);
        }
    }
}
