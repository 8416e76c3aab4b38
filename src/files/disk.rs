//! Reads files of the system.

use std::{
    fs::{self, File},
    io::{self, Read as _},
    path::Path,
};

/// Largest file that is read [bytes].
const LARGEST: u64 = 256 << 20;

/// Content of a file or pipe, or with `-` of standard input.
///
/// # Errors
/// The reason, if it cannot be read, or is too large.
pub fn read_bytes(path: &Path) -> Result<Vec<u8>, String> {
    let said = |error: io::Error| error.to_string();
    let mut bytes = Vec::new();
    let read = if path == Path::new("-") {
        io::stdin().lock().take(LARGEST + 1).read_to_end(&mut bytes)
    } else if holds_text(&fs::metadata(path).map_err(said)?) {
        File::open(path).and_then(|file| file.take(LARGEST + 1).read_to_end(&mut bytes))
    } else {
        return Err("this is not a file with text".to_owned());
    };
    if read.map_err(said)? as u64 > LARGEST {
        return Err(format!("a file may have {} MB at most", LARGEST >> 20));
    }
    Ok(bytes)
}

/// Whether the path is a file or a pipe. A folder or a device such as `/dev/zero` is neither.
fn holds_text(known: &fs::Metadata) -> bool {
    #[cfg(unix)]
    let pipe = std::os::unix::fs::FileTypeExt::is_fifo(&known.file_type());
    #[cfg(not(unix))]
    let pipe = false;
    known.is_file() || pipe
}
