//! What becomes of a drag on the stage.

use eframe::egui::{Event, PointerButton, Response};

/// State of a drag of the primary button, in a frame after it has begun.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DragState {
    /// It goes on.
    Goes,
    /// It ends in this frame.
    Ends,
    /// It has no effect.
    Cancelled,
}

/// State of a drag that has begun in the present scene, or in another. Escape, a second finger, a lost focus and another scene cancel it.
pub fn drag_state(response: &Response, is_same_scene: bool) -> DragState {
    let is_lost = response
        .ctx
        .input(|input| input.multi_touch().is_some() || input.events.contains(&Event::WindowFocused(false)));
    if is_lost || !is_same_scene {
        return DragState::Cancelled;
    }
    match (response.drag_stopped_by(PointerButton::Primary), response.dragged_by(PointerButton::Primary)) {
        (true, _) => DragState::Ends,
        (false, true) => DragState::Goes,
        // egui ends the drag at Escape.
        (false, false) => DragState::Cancelled,
    }
}
