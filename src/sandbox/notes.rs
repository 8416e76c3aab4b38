//! Notes: where they are in a scene.

use super::{Refused, Sandbox};
use crate::{
    command::Spot,
    document::Document,
    level::{Note, NotePlace},
    quantity::Position,
    scene::{Scene, nearest_vertex},
};

impl Sandbox {
    /// Adds a note with the text "Note N".
    pub(super) fn add_note(&self, document: &mut Document, spot: Spot) -> Result<(), Refused> {
        const NOWHERE: Refused =
            Refused::NotHere("no note can be there: there is no such vertex, or a coordinate is out of range");
        let scene = self.simulation.scene();
        let notes = &mut document.level.notes;
        if notes.len() >= Note::MOST {
            return Err(Refused::NotHere("a level has at most 100 notes"));
        }
        let position = |coordinates: Option<&[f64]>| coordinates.and_then(Position::new).ok_or(NOWHERE);
        let place = match spot {
            Spot::Vertex(vertex) => NotePlace::Vertex(position(scene.rest.get(scene.numbers(&(vertex..vertex + 1))))?),
            Spot::Place(at) => NotePlace::Point(position(at.get(..scene.dimension.clamp(2, 3)))?),
        };
        notes.push(Note { text: format!("Note {}", notes.len() + 1), place });
        Ok(())
    }

    /// Vertices of the notes, by their numbers in the scene; `None` for one at a point.
    pub(crate) fn note_vertices(&self) -> Vec<Option<usize>> {
        let scene = self.simulation.scene();
        self.shown.notes.iter().map(|note| note_vertex(scene, note)).collect()
    }
}

fn note_vertex(scene: &Scene, note: &Note) -> Option<usize> {
    let NotePlace::Vertex(at) = note.place else { return None };
    nearest_vertex(&scene.rest, at.get().get(..scene.dimension)?)
}
