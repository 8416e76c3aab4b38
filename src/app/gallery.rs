//! The levels that come with the program, by name.

use crate::{files, level::Level, levels};

/// One level of the picker.
pub struct Entry {
    /// Name in the picker.
    pub name: String,
    /// What there is to see.
    pub about: String,
    file: &'static str,
    text: &'static str,
}

/// All of them.
pub struct Gallery {
    entries: Vec<Entry>,
}

impl Default for Gallery {
    fn default() -> Self {
        let entry = |(file, text): &(&'static str, &'static str)| {
            let (name, about) = files::parse(text, file)
                .map_or_else(|error| ((*file).to_owned(), error.to_string()), |level| (level.name, level.about));
            Entry { name, about, file, text }
        };
        Self { entries: levels::BUILT_IN.iter().map(entry).collect() }
    }
}

impl Gallery {
    /// The levels, in the order of the picker.
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// Reads the level that the program starts with.
    ///
    /// # Errors
    /// What is wrong with its text, with file, line and column.
    pub fn first(&self) -> Result<Level, String> {
        let first = |entry: &Entry| entry.file.strip_suffix(".ron") == Some(levels::FIRST);
        self.level(self.entries.iter().position(first).unwrap_or(0))
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
