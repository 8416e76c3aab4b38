//! The built-in levels and hard cases by name.

use crate::{
    files,
    hard::{Case, Method},
    level::Level,
    levels,
    materials::{Model, TypedEnergy},
};
use std::{path::Path, sync::Arc};

/// Level of the picker.
pub struct Entry {
    /// Name in the picker.
    pub name: String,
    /// Description.
    pub about: String,
    file: &'static str,
    text: &'static str,
}

impl Entry {
    /// Whether the program starts with this level.
    fn is_first(&self) -> bool {
        self.file.strip_suffix(".ron") == Some(levels::FIRST)
    }
}

/// Built-in levels and hard cases.
pub struct Gallery {
    entries: Vec<Entry>,
    hard: Vec<(&'static str, Case)>,
}

impl Default for Gallery {
    fn default() -> Self {
        let entry = |(file, text): &(&'static str, &'static str)| {
            let (name, about) = files::parse(text, file)
                .map_or_else(|error| ((*file).to_owned(), error.to_string()), |level| (level.name, level.about));
            Entry { name, about, file, text }
        };
        let hard = Case::names().filter_map(|name| Some((name, Case::read(Path::new(name)).ok()?)));
        let mut entries: Vec<_> = levels::BUILT_IN.iter().map(entry).collect();
        entries.sort_by_key(|entry| (!entry.is_first(), entry.name.to_lowercase()));
        Self { entries, hard: hard.collect() }
    }
}

impl Gallery {
    /// Levels whose name or description has all the words of a search, in the order of the picker: the first level of the program, then the
    /// others by name; with their numbers there.
    pub fn found<'a>(&'a self, search: &str) -> impl Iterator<Item = (usize, &'a Entry)> {
        let words: Vec<_> = search.split_whitespace().map(str::to_lowercase).collect();
        let has_all = move |(_, entry): &(usize, &Entry)| {
            let text = format!("{} {} {}", entry.file, entry.name, entry.about).to_lowercase();
            words.iter().all(|word| text.contains(word))
        };
        self.entries.iter().enumerate().filter(has_all)
    }

    /// Hard cases with their names, in the order of their gallery.
    pub fn hard(&self) -> &[(&'static str, Case)] {
        &self.hard
    }

    /// Level of a hard case, or of its undamped twin, with a model or a typed energy and a method.
    ///
    /// # Errors
    /// A message if there is no such case or it cannot be prepared.
    pub fn hard_level(
        &self,
        (name, undamped): (&str, bool),
        (model, energy): (Model, Option<Arc<TypedEnergy>>),
        method: Method,
    ) -> Result<Level, String> {
        let (_, case) = self.hard.iter().find(|(known, _)| *known == name).ok_or("there is no such hard case")?;
        let twin = if undamped { case.undamped_twin() } else { None };
        let case = twin.unwrap_or_else(|| case.clone()).with_energy(energy);
        case.watched(model, method).map_err(|error| error.to_string())
    }

    /// Reads the level that the program starts with.
    ///
    /// # Errors
    /// A message about its text with file, line and column.
    pub fn first(&self) -> Result<Level, String> {
        self.level(self.entries.iter().position(Entry::is_first).unwrap_or(0))
    }

    /// Reads a level of the picker.
    ///
    /// # Errors
    /// A message about its text with file, line and column, or that there is no such level.
    pub fn level(&self, index: usize) -> Result<Level, String> {
        let entry = self.entries.get(index).ok_or("there is no such level")?;
        files::parse(entry.text, entry.file).map_err(|error| error.to_string())
    }
}
