//! The path that a vertex is dragged along, with the times at which it was where.

use super::{
    drag::{DragState, drag_state},
    pointer_state::Sight,
};
use crate::{
    app::draw::{View, shape_buffer::ShapeBuffer},
    command::Command,
    snapshot::Snapshot,
};
use eframe::egui::{PointerButton, Pos2, Response};

/// Least time between two points \[s\].
const APART: f64 = 0.02;

/// Least time of a whole path \[s\].
const SHORTEST: f64 = 0.1;

/// A path while it is dragged.
#[derive(Default)]
pub struct DrawnPath {
    vertex: Option<usize>,
    /// Place of the pointer when the drag began, as deep as the vertex \[m\].
    from: [f64; 3],
    /// Times since then \[s\], and how far the pointer has moved \[m\].
    points: Vec<(f64, [f64; 3])>,
    /// When the drag began \[s\].
    began: f64,
    /// Generation of the scene in which it began.
    generation: u64,
}

impl DrawnPath {
    /// Whether it is being dragged.
    pub const fn is_open(&self) -> bool {
        self.vertex.is_some()
    }

    /// Follows the pointer for a frame; `is_chosen` says whether the tool is chosen, and `points` are the vertices on the screen. The end of a
    /// drag prescribes this path to the vertex. Escape, a second finger and another scene cancel it.
    pub fn follow(
        &mut self,
        response: &Response,
        is_chosen: bool,
        snapshot: &Snapshot,
        (sight, points): (Sight<'_>, &[Pos2]),
    ) -> Option<Command> {
        let now = response.ctx.input(|input| input.time);
        if is_chosen && response.drag_started_by(PointerButton::Primary) {
            let origin = response.ctx.input(|input| input.pointer.press_origin())?;
            let vertex = sight.nearest(points, origin)?;
            self.from = sight.target(origin, vertex);
            (self.vertex, self.began, self.generation) = (Some(vertex), now, snapshot.generation);
            self.points.clear();
            self.points.push((0.0, [0.0; 3]));
        }
        let vertex = self.vertex?;
        let since = now - self.began;
        if let Some(at) = response.interact_pointer_pos() {
            let (to, from) = (sight.as_deep_as(at, self.from), self.from);
            let point = (since, std::array::from_fn(|axis| to[axis] - from[axis]));
            match self.points.last_mut() {
                Some(last) if last.0 > 0.0 && since - last.0 < APART => *last = point,
                Some(last) if since - last.0 < APART => {}
                _ => self.points.push(point),
            }
        }
        let state = drag_state(response, self.generation == snapshot.generation);
        if state == DragState::Goes {
            return None;
        }
        self.vertex = None;
        let path = std::mem::take(&mut self.points);
        let is_long = path.last().is_some_and(|last| last.0 >= SHORTEST);
        (state == DragState::Ends && is_long).then_some(Command::MoveAlong(vertex, path))
    }

    /// Draws it.
    pub fn draw(&self, buffer: &mut ShapeBuffer, view: View, sight: Sight<'_>) {
        if self.is_open() {
            let at = |moved: &[f64; 3]| std::array::from_fn(|axis| self.from[axis] + moved[axis]);
            let seen: Vec<_> = self.points.iter().map(|(_, moved)| sight.seen(at(moved))).collect();
            buffer.line(&seen, false, 4.0, view.theme.card);
            buffer.line(&seen, false, 2.0, view.theme.accent_line);
        }
    }
}
