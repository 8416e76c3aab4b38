//! Triangles that a click or a drag on the stage divides.

use super::{
    drag::{DragState, drag_state},
    probing,
};
use crate::{
    app::draw::{View, shape_buffer::ShapeBuffer},
    command::Command,
    snapshot::Snapshot,
};
use eframe::egui::{PointerButton, Pos2, Response};

/// The triangles under a drag, until it ends.
#[derive(Default)]
pub struct Refining {
    triangles: Vec<usize>,
    is_open: bool,
    /// Generation of the scene in which the drag began.
    generation: u64,
}

impl Refining {
    /// Whether a drag has begun.
    pub const fn is_open(&self) -> bool {
        self.is_open
    }

    /// Follows the pointer for a frame, with the triangle under it; `is_chosen` says whether the tool is chosen. Divides the triangle of a click,
    /// and those of a drag when it ends. Escape, a second finger and another scene cancel a drag.
    pub fn follow(
        &mut self,
        response: &Response,
        is_chosen: bool,
        snapshot: &Snapshot,
        triangle: Option<usize>,
    ) -> Option<Command> {
        if is_chosen && response.clicked_by(PointerButton::Primary) {
            return triangle.map(|triangle| Command::Refine(vec![triangle]));
        }
        if is_chosen && response.drag_started_by(PointerButton::Primary) {
            (self.is_open, self.generation) = (true, snapshot.generation);
            self.triangles.clear();
        }
        if !self.is_open {
            return None;
        }
        self.triangles.extend(triangle.filter(|triangle| !self.triangles.contains(triangle)));
        let state = drag_state(response, self.generation == snapshot.generation);
        self.is_open = state == DragState::Goes;
        let all = if self.is_open { Vec::new() } else { std::mem::take(&mut self.triangles) };
        (state == DragState::Ends && !all.is_empty()).then_some(Command::Refine(all))
    }

    /// Draws the triangles of the drag.
    pub fn draw(&self, buffer: &mut ShapeBuffer, view: View, snapshot: &Snapshot, points: &[Pos2]) {
        for triangle in &self.triangles {
            if let Some(corners) = probing::corners(snapshot, points, *triangle) {
                buffer.line(&corners, true, 2.0, view.theme.annotation);
            }
        }
    }
}
