//! Writes files atomically where the folder allows it, and in place otherwise.

use super::FileError;
use crate::terminal;
use std::{
    fs::{self, File, Metadata, OpenOptions},
    io::{self, ErrorKind, IsTerminal, Write},
    path::{Path, PathBuf},
};

/// Where what is written under a path goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Destination {
    /// The program's own standard output, also where a path leads to the file that it is redirected to.
    StandardOutput,
    /// The program's own standard error.
    StandardError,
    /// Anything else.
    Path(PathBuf),
}

/// What makes two paths the same file. A device such as `/dev/null` is the same as nothing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Identity {
    /// Standard output or standard error.
    Stream(Destination),
    /// Device and inode of a file that exists.
    Node(u64, u64),
    /// Where a file would be made.
    Place(PathBuf),
}

impl Destination {
    /// Where a path leads.
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

    /// What tells this from other files; nothing for a device, of which any number of files may be written.
    pub fn identity(&self) -> Option<Identity> {
        match self {
            Self::Path(path) => identity(path),
            stream => Some(Identity::Stream(stream.clone())),
        }
    }

    /// Finds out whether this can be written, and leaves what is there as it is.
    ///
    /// # Errors
    /// [`FileError::Access`] with what the system says.
    pub fn probe(&self) -> Result<(), FileError> {
        match self {
            Self::Path(path) => probe(path).map_err(|error| access(path, &error)),
            _ => Ok(()),
        }
    }

    /// Writes all of it.
    ///
    /// # Errors
    /// [`FileError::Access`] with what the system says. A reader that has closed its end of standard output is no failure.
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

/// Writes to a path, in this order:
/// - `/dev/stdout` and `/dev/stderr` are the program's own streams;
/// - what is no file, such as a pipe or a device, is written to as it is;
/// - a link is followed, also to a file that is not there yet;
/// - a file is written beside its place and then moved there, with the permissions and the owner of the old one, so that at every moment
///   either the old file or the whole new one is there;
/// - where that cannot be, as in a folder that may not be changed, with a name too long for another beside it, on a mount point, or
///   for a file of several names, the file is written in place.
///
/// # Errors
/// [`FileError::Access`] if the system refuses. A file that was there stays, unless writing in place fails half way.
pub fn write_bytes(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    // Only an option of a command can mean standard output by `-`.
    let destination =
        if path == Path::new("-") { Destination::Path(PathBuf::from("./-")) } else { Destination::of(path) };
    destination.write(bytes)
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

/// Whether a path is a name of one of the program's own descriptors.
fn is_descriptor(path: &Path, number: &str) -> bool {
    ["/dev/fd", "/proc/self/fd"].iter().any(|folder| path == Path::new(folder).join(number))
}

/// Whether standard output is redirected to the file or pipe of this path. Writing it twice would lose one of the two.
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

/// What tells the file of a path from others; nothing for a device.
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

/// The path without links, also where the last of them leads to nothing. The folder has to be there.
fn resolved(path: &Path) -> io::Result<PathBuf> {
    // As many as Linux follows.
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
        // To open a pipe would wait for its reader, and to close it again would end that one.
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
    // A file that somebody has opened already is meant itself, and not another one of its name.
    if path.starts_with("/dev/fd") || path.starts_with("/proc") {
        return write_in_place(path, bytes, false);
    }
    let place = resolved(path)?;
    if known.as_ref().is_some_and(has_other_names) || !replace(&place, bytes, known.as_ref())? {
        return write_in_place(&place, bytes, known.is_none());
    }
    Ok(())
}

/// Writes a file beside its place and moves it there. Returns false, with everything as it was, if that cannot be done here.
fn replace(place: &Path, bytes: &[u8], known: Option<&Metadata>) -> io::Result<bool> {
    // A file that may not be written must not be replaced either.
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
        // Best effort: the file that counts is untouched either way.
        let _ = fs::remove_file(&temporary);
    }
    moved.or_else(|error| if is_about_the_place(&error) { Ok(false) } else { Err(error) })
}

/// Whether another name in the same folder is what the system refuses, rather than the bytes.
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

/// Gives a new file the permissions and the owner of the old one.
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

/// Whether a file has several names, which moving another one to one of them would part.
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

/// Writes over a file as it is, or makes it.
fn write_in_place(place: &Path, bytes: &[u8], new: bool) -> io::Result<()> {
    let mut file = OpenOptions::new().write(true).create(new).truncate(true).open(place)?;
    let written = file.write_all(bytes).and_then(|()| file.sync_all());
    if written.is_err() && new {
        // Half a file is worth less than none.
        let _ = fs::remove_file(place);
    }
    written
}
