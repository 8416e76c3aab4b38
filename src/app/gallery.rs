//! The built-in levels and hard cases by name.

use crate::{
    files,
    hard::{Case, Method},
    level::Level,
    levels,
    materials::Model,
};
use std::path::Path;

/// One level of the picker.
pub struct Entry {
    /// Name in the picker.
    pub name: String,
    /// What there is to see.
    pub about: String,
    file: &'static str,
    text: &'static str,
}

impl Entry {
    /// Whether the program starts with it.
    fn is_first(&self) -> bool {
        self.file.strip_suffix(".ron") == Some(levels::FIRST)
    }
}

/// All of them.
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
    /// The levels, in the order of the picker: the one that the program starts with, then by name.
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// The hard cases with their names, in the order of their gallery.
    pub fn hard(&self) -> &[(&'static str, Case)] {
        &self.hard
    }

    /// The level of a hard case, ready to be watched with a model and a method.
    ///
    /// # Errors
    /// In words, if it is not there.
    pub fn hard_level(&self, name: &str, model: Model, method: Method) -> Result<Level, String> {
        let (_, case) = self.hard.iter().find(|(known, _)| *known == name).ok_or("there is no such hard case")?;
        case.watched(model, method).map_err(|error| error.to_string())
    }

    /// Reads the level that the program starts with.
    ///
    /// # Errors
    /// What is wrong with its text, with file, line and column.
    pub fn first(&self) -> Result<Level, String> {
        self.level(self.entries.iter().position(Entry::is_first).unwrap_or(0))
    }

    /// Reads a level of the picker.
    ///
    /// # Errors
    /// What is wrong with its text, with file, line and column.
    pub fn level(&self, index: usize) -> Result<Level, String> {
        let entry = self.entries.get(index).ok_or("there is no such level")?;
        files::parse(entry.text, entry.file).map_err(|error| error.to_string())
    }
}
