//! Result of a command: output, remarks and exit code.

use super::{Interrupt, Outputs};
use crate::terminal;

/// Exit codes, for the help text.
pub const EXIT_CODES: &str = "Exit codes: 0 done; 1 the simulation stopped, or a hard case is not held that should be; 2 wrong \
arguments, or a file that cannot be read or written; 3 `run` came to its end, but the end state is not physical: positions or \
energies are not finite, the energy grew by over 1e5 times what the scene had, |J| is over 1e4, or triangles are inverted that were not at the start; 130 and 143 stopped by \
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
    pub(super) fn new(text: String, outputs: Outputs, code: u8, stopped: Option<Interrupt>) -> Self {
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
