//! Writes files atomically where the folder allows it, and in place otherwise.

use super::FileError;
use crate::terminal;
use std::{
    fs::{self, File, Metadata, OpenOptions},
    io::{self, ErrorKind, IsTerminal, Write},
    path::{Path, PathBuf},
};

/// Destination of output under a path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Destination {
    /// Standard output of the program, also if the path is the file to which it is redirected.
    StandardOutput,
    /// Standard error of the program.
    StandardError,
    /// Any other path.
    Path(PathBuf),
}

/// Identity of an output file, to detect equal paths. A device such as `/dev/null` has none.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Identity {
    /// Standard output or standard error.
    Stream(Destination),
    /// Device and inode of an existing file.
    Node(u64, u64),
    /// Path of a file that does not exist yet.
    Place(PathBuf),
}

impl Destination {
    /// Destination of a path.
    pub fn of(path: &Path) -> Self {
        // A file called `-` can be given as `./-`.
        if path == Path::new("-") || path == Path::new("/dev/stdout") || is_descriptor(path, "1") {
            Self::StandardOutput
        } else if path == Path::new("/dev/stderr") || is_descriptor(path, "2") {
            Self::StandardError
        } else if is_standard_output(path) {
            Self::StandardOutput
        } else {
            Self::Path(path.to_path_buf())
        }
    }

    /// Identity of the destination. `None` for a device, which may be written any number of times.
    pub fn identity(&self) -> Option<Identity> {
        match self {
            Self::Path(path) => identity(path),
            stream => Some(Identity::Stream(stream.clone())),
        }
    }

    /// Checks that the destination can be written, without a change to an existing file.
    ///
    /// # Errors
    /// [`FileError::Access`] with the message of the system.
    pub fn probe(&self) -> Result<(), FileError> {
        match self {
            Self::Path(path) => probe(path).map_err(|error| access(path, &error)),
            _ => Ok(()),
        }
    }

    /// Writes all bytes.
    ///
    /// # Errors
    /// [`FileError::Access`] with the message of the system. If the reader of standard output has closed its end,
    /// that is no error.
    pub fn write(&self, bytes: &[u8]) -> Result<(), FileError> {
        let (name, written) = match self {
            Self::StandardOutput => {
                let written = stream(bytes, io::stdout().lock());
                let closed = written.as_ref().is_err_and(|error| error.kind() == ErrorKind::BrokenPipe);
                ("standard output", if closed { Ok(()) } else { written })
            }
            Self::StandardError => ("standard error", stream(bytes, io::stderr().lock())),
            Self::Path(path) => return write_path(path, bytes).map_err(|error| access(path, &error)),
        };
        written.map_err(|error| access(Path::new(name), &error))
    }
}

/// Writes bytes to a path. The first of these rules that fits is used:
/// - `/dev/stdout` and `/dev/stderr` are the program's own streams;
/// - a path that is not a file, such as a pipe or a device, is written to directly;
/// - a link is followed, also to a file that does not exist yet;
/// - a file is written beside its place and then moved there, with the permissions and the owner of the old file.
///   At every moment either the old file or the complete new one exists;
/// - if that is not possible, the file is written in place. Examples: a folder that may not be changed, a name too long
///   for another beside it, a mount point, a file of several names.
///
/// # Errors
/// [`FileError::Access`] if the system refuses. An existing file stays, unless writing in place fails half way.
pub fn write_bytes(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    #[cfg(target_arch = "wasm32")]
    {
        super::browser::write(path, bytes);
        Ok(())
    }
    #[cfg(not(target_arch = "wasm32"))]
    {
        // `-` means standard output only in an option of a command.
        let destination =
            if path == Path::new("-") { Destination::Path(PathBuf::from("./-")) } else { Destination::of(path) };
        destination.write(bytes)
    }
}

fn access(path: &Path, error: &io::Error) -> FileError {
    FileError::Access { file: path.display().to_string(), why: error.to_string() }
}

fn stream(bytes: &[u8], mut out: impl Write + IsTerminal) -> io::Result<()> {
    if out.is_terminal() {
        out.write_all(terminal::block(&String::from_utf8_lossy(bytes)).as_bytes())?;
    } else {
        out.write_all(bytes)?;
    }
    out.flush()
}

/// Whether a path names a descriptor of the program.
fn is_descriptor(path: &Path, number: &str) -> bool {
    ["/dev/fd", "/proc/self/fd"].iter().any(|folder| path == Path::new(folder).join(number))
}

/// Whether standard output is redirected to the file or pipe of this path. If both wrote to it, one would be lost.
#[cfg(unix)]
fn is_standard_output(path: &Path) -> bool {
    use std::os::{fd::AsFd, unix::fs::FileTypeExt};
    let own = io::stdout().as_fd().try_clone_to_owned().map(File::from).and_then(|file| file.metadata());
    let (Ok(own), Ok(named)) = (own, fs::metadata(path)) else { return false };
    let kept = own.is_file() || own.file_type().is_fifo();
    kept && node(&own) == node(&named)
}

#[cfg(not(unix))]
fn is_standard_output(_: &Path) -> bool {
    false
}

#[cfg(unix)]
fn node(known: &Metadata) -> (u64, u64) {
    use std::os::unix::fs::MetadataExt;
    (known.dev(), known.ino())
}

/// Identity of the file of a path. `None` for a device.
pub fn identity(path: &Path) -> Option<Identity> {
    let Ok(known) = fs::metadata(path) else { return resolved(path).ok().map(Identity::Place) };
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        let kind = known.file_type();
        if kind.is_char_device() || kind.is_block_device() {
            return None;
        }
        let (device, number) = node(&known);
        Some(Identity::Node(device, number))
    }
    #[cfg(not(unix))]
    fs::canonicalize(path).ok().filter(|_| known.is_file()).map(Identity::Place)
}

/// Path with all links resolved, even if the last one has no target. The folder must exist.
fn resolved(path: &Path) -> io::Result<PathBuf> {
    // Limit of Linux.
    const LINKS: usize = 40;
    let mut path = path.to_path_buf();
    for _ in 0..LINKS {
        if let Ok(whole) = fs::canonicalize(&path) {
            return Ok(whole);
        }
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        if let Ok(target) = fs::read_link(&path) {
            path = folder.join(target);
            continue;
        }
        let Some(name) = path.file_name() else { break };
        let folder = fs::canonicalize(folder).map_err(|error| match error.kind() {
            ErrorKind::NotFound => io::Error::new(ErrorKind::NotFound, "its folder is not there"),
            _ => error,
        })?;
        return Ok(folder.join(name));
    }
    Err(io::Error::other("this is no name of a file, or its links lead in a circle"))
}

fn probe(path: &Path) -> io::Result<()> {
    match fs::metadata(path) {
        Ok(known) if known.is_dir() => Err(io::Error::from(ErrorKind::IsADirectory)),
        Ok(known) if known.is_file() => OpenOptions::new().write(true).open(path).map(drop),
        // A pipe is not opened: opening waits for its reader, and closing would end that reader.
        Ok(known) if known.permissions().readonly() => Err(io::Error::from(ErrorKind::PermissionDenied)),
        Ok(_) => Ok(()),
        Err(_) => {
            if path.as_os_str().to_string_lossy().ends_with(std::path::is_separator) {
                return Err(io::Error::from(ErrorKind::IsADirectory));
            }
            let place = resolved(path)?;
            OpenOptions::new().write(true).create_new(true).open(&place)?;
            fs::remove_file(&place)
        }
    }
}

fn write_path(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let known = fs::metadata(path).ok();
    if known.as_ref().is_some_and(Metadata::is_dir) {
        return Err(io::Error::from(ErrorKind::IsADirectory));
    }
    if known.as_ref().is_some_and(|known| !known.is_file()) {
        return stream(bytes, OpenOptions::new().write(true).open(path)?);
    }
    // The path means this opened file itself, not another file of its name.
    if path.starts_with("/dev/fd") || path.starts_with("/proc") {
        return write_in_place(path, bytes, false);
    }
    let place = resolved(path)?;
    if known.as_ref().is_some_and(has_other_names) || !replace(&place, bytes, known.as_ref())? {
        return write_in_place(&place, bytes, known.is_none());
    }
    Ok(())
}

/// Writes a file beside its place and moves it there. Returns false, without any change, if that is not possible here.
fn replace(place: &Path, bytes: &[u8], known: Option<&Metadata>) -> io::Result<bool> {
    // A file without write permission must not be replaced either.
    if known.is_some() {
        OpenOptions::new().write(true).open(place)?;
    }
    let mut temporary = place.as_os_str().to_owned();
    temporary.push(format!(".{}.part", std::process::id()));
    let temporary = PathBuf::from(temporary);
    let mut file = match File::create(&temporary) {
        Ok(file) => file,
        Err(error) if is_about_the_place(&error) => return Ok(false),
        Err(error) => return Err(error),
    };
    let kept = known.is_none_or(|known| keep(&file, known).is_ok());
    let written = if kept { file.write_all(bytes).and_then(|()| file.sync_all()) } else { Ok(()) };
    let moved = written.and_then(|()| if kept { fs::rename(&temporary, place).map(|()| true) } else { Ok(false) });
    if !matches!(moved, Ok(true)) {
        // Best effort: the target file is unchanged in either case.
        let _ = fs::remove_file(&temporary);
    }
    moved.or_else(|error| if is_about_the_place(&error) { Ok(false) } else { Err(error) })
}

/// Whether the system refuses a second name in the folder, rather than the bytes.
fn is_about_the_place(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        ErrorKind::PermissionDenied
            | ErrorKind::ReadOnlyFilesystem
            | ErrorKind::InvalidFilename
            | ErrorKind::ResourceBusy
            | ErrorKind::CrossesDevices
    )
}

/// Copies the permissions and the owner of the old file to the new one.
fn keep(file: &File, known: &Metadata) -> io::Result<()> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::{MetadataExt, fchown};
        let new = file.metadata()?;
        if (new.uid(), new.gid()) != (known.uid(), known.gid()) {
            fchown(file, Some(known.uid()), Some(known.gid()))?;
        }
    }
    file.set_permissions(known.permissions())
}

/// Whether a file has several hard links. Moving another file to one of them would separate them.
fn has_other_names(known: &Metadata) -> bool {
    #[cfg(unix)]
    {
        std::os::unix::fs::MetadataExt::nlink(known) > 1
    }
    #[cfg(not(unix))]
    {
        let _ = known;
        false
    }
}

/// Overwrites a file in place, or creates it.
fn write_in_place(place: &Path, bytes: &[u8], new: bool) -> io::Result<()> {
    let mut file = OpenOptions::new().write(true).create(new).truncate(true).open(place)?;
    let written = file.write_all(bytes).and_then(|()| file.sync_all());
    if written.is_err() && new {
        // An incomplete new file is removed.
        let _ = fs::remove_file(place);
    }
    written
}
