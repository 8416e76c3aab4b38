//! Notes on the stage: a dot with a text at each.

use super::pointer_state::Sight;
use crate::{
    app::draw::{View, legends, shape_buffer::ShapeBuffer},
    level::{Note, NotePlace},
    snapshot::Snapshot,
};
use eframe::egui::{Painter, Pos2, Rect, vec2};

/// Most letters of a note that are shown.
const LONGEST: usize = 100;

/// Texts of the notes and their places on the screen, in the order of the level, without those whose vertex is not there.
fn places<'a>(
    snapshot: &'a Snapshot,
    (sight, points): (Sight<'a>, &'a [Pos2]),
) -> impl Iterator<Item = (&'a str, Pos2)> {
    let vertices = snapshot.note_vertices.iter().copied().chain(std::iter::repeat(None));
    let place = move |(note, vertex): (&'a Note, Option<usize>)| {
        let at = match note.place {
            NotePlace::Vertex(_) => points.get(vertex?).copied()?,
            NotePlace::Point(at) => sight.seen(at.get()),
        };
        at.is_finite().then_some((note.text.as_str(), at))
    };
    snapshot.level.notes.iter().zip(vertices).filter_map(place)
}

/// Draws the dots.
pub fn draw(buffer: &mut ShapeBuffer, view: View, snapshot: &Snapshot, sight: Sight<'_>, points: &[Pos2]) {
    for (_, at) in places(snapshot, (sight, points)) {
        buffer.disc(at, 5.0, view.theme.card);
        buffer.disc(at, 3.5, view.theme.annotation);
    }
}

/// Writes the texts.
pub fn write(
    painter: &Painter,
    (view, canvas): (View, Rect),
    snapshot: &Snapshot,
    (sight, points): (Sight<'_>, &[Pos2]),
) {
    for (text, at) in places(snapshot, (sight, points)).filter(|(text, at)| !text.is_empty() && canvas.contains(*at)) {
        let shown: String = text.chars().take(LONGEST).collect();
        legends::tag(painter, view, canvas, at + vec2(9.0, -9.0), &shown);
    }
}
