//! Notes on the stage.

use crate::quantity::Position;
use serde::{Deserialize, Deserializer, Serialize, de::Error as _};

/// A text that is shown at a place. It changes nothing else.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Note {
    /// The text, of one line.
    pub text: String,
    /// Where it is shown.
    pub place: NotePlace,
}

/// Where a note is shown.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum NotePlace {
    /// At the vertex that is nearest to a point at rest \[m\]; it moves with it.
    Vertex(Position),
    /// At a point \[m\].
    Point(Position),
}

impl Note {
    /// Greatest number of notes of a level.
    pub const MOST: usize = 100;
    /// Greatest number of letters of a note.
    pub const LONGEST: usize = 200;
}

/// Reads the notes of a level.
pub(super) fn notes<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<Note>, D::Error> {
    let notes = Vec::<Note>::deserialize(from)?;
    if notes.len() > Note::MOST {
        return Err(D::Error::custom(format_args!("a level has at most {} notes, got {}", Note::MOST, notes.len())));
    }
    match notes.iter().map(|note| note.text.chars().count()).find(|letters| *letters > Note::LONGEST) {
        Some(letters) => {
            Err(D::Error::custom(format_args!("a note has at most {} letters, got {letters}", Note::LONGEST)))
        }
        None => Ok(notes),
    }
}
