//! Results of a command: output, remarks and exit code; and output files, checked before the work and written after it.

use super::{HeadlessError, Interrupt};
use crate::{
    files::{Destination, FileError, Identity, identity},
    terminal,
};
use std::path::{Path, PathBuf};

/// Exit codes, for the help text.
pub const EXIT_CODES: &str = "Exit codes: 0 done; 1 the simulation stopped, a hard case is not held that should be, or `break` found a run that goes wrong; 2 wrong \
arguments, or a file that cannot be read or written; 3 `run` came to its end, but the end state is not physical: positions or \
energies are not finite, the energy grew by over 1e5 times what the scene had, |J| is over 1e4, or triangles are inverted that were not at the start; 4 `run` came to another state than that recorded in the level; 5 `run` missed a known result of the level; 130 and 143 stopped by \
SIGINT or SIGTERM, with what there was written and marked as partial.\n\nA path of `-` or `/dev/stdout` is standard output; the \
summary then goes to standard error.";

/// Result of a command.
#[derive(Debug, Default)]
pub struct Ending {
    /// Results to print.
    pub text: String,
    /// Whether standard output holds data, so that the results go to standard error.
    pub aside: bool,
    /// Sentences for standard error, one per line.
    pub remarks: Vec<String>,
    /// Exit code.
    pub code: u8,
}

impl Ending {
    /// Result of a command that wrote its outputs, with the code of its work and the signal that stopped it.
    pub(crate) fn new(text: String, outputs: Outputs, code: u8, stopped: Option<Interrupt>) -> Self {
        let (aside, remarks) = (outputs.take_standard_output(), outputs.failures());
        let failed = if remarks.is_empty() { 0 } else { 2 };
        // The first nonzero code counts: of a signal, of the work, of an output that was not written.
        let code = stopped.map_or(if code == 0 { failed } else { code }, Interrupt::exit_code);
        Self { text, aside, remarks, code }
    }

    /// Prints everything and returns the exit code.
    pub fn tell(&self) -> u8 {
        let printed = if self.aside {
            terminal::report(&self.text);
            Ok(())
        } else {
            terminal::print(&self.text)
        };
        let failed = printed.err().map(|error| format!("standard output: {error}"));
        for remark in self.remarks.iter().chain(&failed) {
            terminal::report(&format!("gingerbread: {}", terminal::line(remark)));
        }
        if self.code == 0 && failed.is_some() { 2 } else { self.code }
    }
}

/// Prints warnings about an input before the work begins.
pub(super) fn warn<'a>(input: &str, warnings: impl IntoIterator<Item = &'a String>) {
    for warning in warnings {
        terminal::report(&format!("gingerbread: {}", terminal::line(&format!("{input}: {warning}"))));
    }
}

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

    /// Writes the text or the bytes of an option, if it was given. A failure is recorded for the end.
    pub fn write<T: AsRef<[u8]>>(&mut self, option: &str, content: impl FnOnce(&Path) -> Result<T, String>) {
        let Some((option, path, destination)) = self.wanted.iter().find(|(name, ..)| *name == option) else { return };
        let written = content(path).and_then(|content| {
            destination.write(content.as_ref()).map_err(|error| match error {
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
