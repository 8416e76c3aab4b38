//! Text for a terminal. Control characters are escaped, and a stream that cannot be written never causes a panic.
//!
//! ```
//! assert_eq!(gingerbread::terminal::line("a\tb\u{1b}"), "a\\u{9}b\\u{1b}");
//! ```

use std::{
    fmt::Write as _,
    io::{self, Write as _},
};

/// Text for one line of a terminal.
/// Control characters, line ends among them, and characters that reorder text are escaped as `\u{1b}`.
pub fn line(text: &str) -> String {
    escape(text, |_| false)
}

/// Text for several lines of a terminal. Line ends and tabs stay; the rest is escaped as in [`line()`].
pub fn block(text: &str) -> String {
    escape(text, |c| matches!(c, '\n' | '\t'))
}

fn escape(text: &str, stays: impl Fn(char) -> bool) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        if is_harmful(c) && !stays(c) {
            // Writing to a string cannot fail.
            let _ = write!(escaped, "{}", c.escape_unicode());
        } else {
            escaped.push(c);
        }
    }
    escaped
}

/// Whether a character is escaped: control characters (C0, DEL, C1), line and paragraph separators, marks of text
/// direction, tag characters.
fn is_harmful(c: char) -> bool {
    let reorders = matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    c.is_control() || reorders || matches!(c, '\u{2028}' | '\u{2029}' | '\u{feff}' | '\u{e0000}'..='\u{e007f}')
}

/// Prints text and a line end to standard output. If the reader has closed its end of the pipe, that is no error.
///
/// # Errors
/// Error of the system if the text cannot be written, for example on a full disk.
pub fn print(text: &str) -> io::Result<()> {
    let mut out = io::stdout().lock();
    let written = out.write_all((block(text) + "\n").as_bytes()).and_then(|()| out.flush());
    written.or_else(|error| if error.kind() == io::ErrorKind::BrokenPipe { Ok(()) } else { Err(error) })
}

/// Prints text and a line end to standard error. A failure is ignored, because it cannot be reported.
pub fn report(text: &str) {
    let mut stream = io::stderr().lock();
    let _ = stream.write_all((block(text) + "\n").as_bytes()).and_then(|()| stream.flush());
}
