//! Output files of a command: checked before the work, written after it.

use super::HeadlessError;
use crate::files::{Destination, FileError, Identity, identity};
use std::path::{Path, PathBuf};

/// Requested output files of a command.
pub struct Outputs {
    wanted: Vec<(&'static str, PathBuf, Destination)>,
    failures: Vec<String>,
}

impl Outputs {
    /// Checks the paths of the options against each other and against the input files. No file is changed.
    ///
    /// # Errors
    /// If a path cannot be written, or is the same file as another one or as an input.
    pub fn new(options: &[(&'static str, Option<&PathBuf>)], inputs: &[PathBuf]) -> Result<Self, HeadlessError> {
        let given = options.iter().filter_map(|(option, path)| Some((*option, path.as_ref()?)));
        let wanted: Vec<_> = given.map(|(option, path)| (option, (*path).clone(), Destination::of(path))).collect();
        let mut known: Vec<(String, Identity)> = Vec::new();
        for path in inputs.iter().filter(|path| path.exists()) {
            known.extend(identity(path).map(|identity| (format!("the input {}", path.display()), identity)));
        }
        for (option, path, destination) in &wanted {
            let refuse = |why| FileError::Access { file: format!("{option} {}", path.display()), why };
            if let Some(own) = destination.identity() {
                if let Some((other, _)) = known.iter().find(|(_, identity)| *identity == own) {
                    return Err(refuse(format!("this is the same file as {other}; choose another one")).into());
                }
                known.push((format!("that of {option}"), own));
            }
            destination.probe().map_err(|error| match error {
                FileError::Access { why, .. } => refuse(why),
                other @ FileError::Text { .. } => other,
            })?;
        }
        Ok(Self { wanted, failures: Vec::new() })
    }

    /// Whether standard output holds data other than the summary.
    pub fn take_standard_output(&self) -> bool {
        self.wanted.iter().any(|(_, _, destination)| *destination == Destination::StandardOutput)
    }

    /// Path given for an option.
    pub fn path(&self, option: &str) -> Option<&Path> {
        self.wanted.iter().find(|(name, ..)| *name == option).map(|(_, path, _)| path.as_path())
    }

    /// Writes the text of an option, if it was given. A failure is recorded for the end.
    pub fn write(&mut self, option: &str, text: impl FnOnce(&Path) -> Result<String, String>) {
        let Some((option, path, destination)) = self.wanted.iter().find(|(name, ..)| *name == option) else { return };
        let written = text(path).and_then(|text| {
            destination.write(text.as_bytes()).map_err(|error| match error {
                FileError::Access { why, .. } => why,
                FileError::Text { .. } => error.to_string(),
            })
        });
        if let Err(why) = written {
            self.failures.push(format!("{option} {}: {why}", path.display()));
        }
    }

    /// Outputs that could not be written, with the reasons.
    pub fn failures(self) -> Vec<String> {
        self.failures
    }
}
