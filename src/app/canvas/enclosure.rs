//! A box, or a closed line, that is drawn by one drag around vertices.

use super::drag::{DragState, drag_state};
use crate::{
    app::draw::{View, shape_buffer::ShapeBuffer},
    command::Command,
    meshes,
    snapshot::Snapshot,
};
use eframe::egui::{PointerButton, Pos2, Response, pos2};

/// Least distance between two points of a line [points].
const APART: f32 = 3.0;

/// What is drawn around vertices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Around {
    /// A box between two corners.
    Box,
    /// A line that is closed by its ends.
    Line,
}

/// A box or a line around vertices, while it is drawn.
#[derive(Default)]
pub struct Enclosure {
    /// Points of the drag so far.
    points: Vec<Pos2>,
    around: Option<Around>,
    /// Generation of the scene in which it began.
    generation: u64,
}

impl Enclosure {
    /// Whether it is being drawn.
    pub const fn is_open(&self) -> bool {
        self.around.is_some()
    }

    /// Follows the pointer for a frame, in which a drag would draw `around`. `points` are the vertices on the screen. When the drag ends, the vertices
    /// inside are pinned, or freed if all of them are pinned. Escape, a second finger and another scene cancel it.
    pub fn follow(
        &mut self,
        response: &Response,
        around: Option<Around>,
        (snapshot, points): (&Snapshot, &[Pos2]),
    ) -> Option<Command> {
        if response.drag_started_by(PointerButton::Primary) && around.is_some() {
            (self.around, self.generation) = (around, snapshot.generation);
            self.points.clear();
            self.points.extend(response.ctx.input(|input| input.pointer.press_origin()));
        }
        self.around?;
        let is_apart = |at: &Pos2| self.points.last().is_none_or(|last| last.distance(*at) >= APART);
        if let Some(at) = response.interact_pointer_pos().filter(is_apart) {
            self.points.push(at);
        }
        let state = drag_state(response, self.generation == snapshot.generation);
        if state == DragState::Cancelled {
            self.around = None;
        }
        if state != DragState::Ends {
            return None;
        }
        let outline: Vec<_> = self.outline().iter().map(|point| [f64::from(point.x), f64::from(point.y)]).collect();
        self.around = None;
        let is_inside = |vertex: &usize| {
            let at = points[*vertex];
            at.is_finite() && meshes::contains(&outline, [f64::from(at.x), f64::from(at.y)])
        };
        let inside: Vec<_> = (0..points.len()).filter(is_inside).collect();
        let is_pinned = |vertex: &usize| snapshot.pins.binary_search(&(*vertex as u32)).is_ok();
        let pins = !inside.iter().all(is_pinned);
        (!inside.is_empty()).then_some(Command::PinAll(inside, pins))
    }

    /// The corners of the box, or the points of the line.
    fn outline(&self) -> Vec<Pos2> {
        match (self.around, &self.points[..]) {
            (Some(Around::Box), [first, .., last]) => {
                vec![*first, pos2(last.x, first.y), *last, pos2(first.x, last.y)]
            }
            (_, points) => points.to_vec(),
        }
    }

    /// Draws it.
    pub fn draw(&self, buffer: &mut ShapeBuffer, view: View) {
        if self.is_open() {
            let outline = self.outline();
            buffer.line(&outline, true, 4.0, view.theme.card);
            buffer.line(&outline, true, 2.0, view.theme.accent_line);
        }
    }
}
