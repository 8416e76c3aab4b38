//! An outline that is drawn on the stage: by one drag, or corner after corner by clicks.

use crate::app::draw::{Camera, View, shape_buffer::ShapeBuffer};
use eframe::egui::{Key, PointerButton, Pos2, Response};

/// Least distance between two points of a drag [points].
const APART: f32 = 3.0;

/// Distance from the first corner at which a click closes the outline [points].
const CLOSING: f32 = 12.0;

/// An outline that is drawn.
#[derive(Default)]
pub struct Drawing {
    /// Its points so far \[m\].
    points: Vec<[f64; 2]>,
    /// Whether they are those of a drag.
    is_dragged: bool,
    /// The finished outline \[m\], and the length of a point of the screen there \[m\].
    finished: Option<(Vec<[f64; 2]>, f64)>,
}

impl Drawing {
    /// The outline that was finished since the last call \[m\], with the length of a point of the screen \[m\].
    pub const fn take(&mut self) -> Option<(Vec<[f64; 2]>, f64)> {
        self.finished.take()
    }

    /// Follows the pointer for a frame while outlines are drawn; otherwise drops what was drawn.
    pub fn follow(&mut self, response: &Response, camera: Camera, draws: bool) {
        if !draws {
            self.points.clear();
            self.is_dragged = false;
            return;
        }
        let at = response.interact_pointer_pos().or(response.hover_pos());
        if response.drag_started_by(PointerButton::Primary) && self.points.is_empty() {
            self.is_dragged = true;
            let origin = response.ctx.input(|input| input.pointer.press_origin());
            self.points.extend(origin.map(|origin| camera.world_from_screen(origin)));
        }
        if let Some(at) = at.filter(|_| self.is_dragged) {
            let is_apart = |last: &[f64; 2]| camera.screen_from_world(*last).distance(at) >= APART;
            if self.points.last().is_none_or(is_apart) {
                self.points.push(camera.world_from_screen(at));
            }
        }
        let is_released = response.drag_stopped_by(PointerButton::Primary);
        if is_released && self.is_dragged {
            self.finish(camera);
        } else if let Some(at) = at.filter(|_| is_released || response.clicked_by(PointerButton::Primary)) {
            let is_near = |corner: &[f64; 2]| camera.screen_from_world(*corner).distance(at) < CLOSING;
            if self.points.len() >= 3 && self.points.first().is_some_and(is_near) {
                self.finish(camera);
            } else if !self.points.last().is_some_and(|last| camera.screen_from_world(*last).distance(at) < APART) {
                self.points.push(camera.world_from_screen(at));
            }
        }
        if self.points.len() >= 3 && response.ctx.input(|input| input.key_pressed(Key::Enter)) {
            self.finish(camera);
        }
    }

    fn finish(&mut self, camera: Camera) {
        self.finished = Some((std::mem::take(&mut self.points), 1.0 / camera.scale()));
        self.is_dragged = false;
    }

    /// Draws the line so far, to the pointer where corners are clicked.
    pub fn draw(&self, buffer: &mut ShapeBuffer, view: View, pointer: Option<Pos2>) {
        let mut points: Vec<_> = self.points.iter().map(|point| view.camera.screen_from_world(*point)).collect();
        if !self.is_dragged {
            for corner in &points {
                buffer.disc(*corner, 4.0, view.theme.annotation);
            }
        }
        points.extend(pointer.filter(|_| !self.points.is_empty()));
        buffer.line(&points, false, 4.0, view.theme.card);
        buffer.line(&points, false, 2.0, view.theme.annotation);
        if let Some(first) = points.first().filter(|_| self.points.len() >= 3) {
            buffer.disc(*first, 6.0, view.theme.accent_line);
        }
    }
}
