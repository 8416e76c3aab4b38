//! Levels as text and as files: reading with the place of a mistake, and saving without ever losing what was there.

mod output;

pub use output::{Destination, Identity, identity, write_bytes};

use crate::{level::Level, levels, meshes::Files};
use ron::{extensions::Extensions, ser::PrettyConfig};
use std::{
    io::Read as _,
    path::{Path, PathBuf},
};

/// A level that cannot be read or written.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FileError {
    /// The text is not a level.
    #[error("{file}:{line}:{column}: {what}")]
    Text {
        /// Name of the file.
        file: String,
        /// Line of the mistake, from 1.
        line: usize,
        /// Column of the mistake, from 1.
        column: usize,
        /// What is wrong and what was expected.
        what: String,
    },
    /// There is no such file, or it cannot be read or written.
    #[error("{file}: {why}")]
    Access {
        /// Name of the file.
        file: String,
        /// What the system says.
        why: String,
    },
}

/// Largest level file that is read [bytes].
const LARGEST: u64 = 256 << 20;

fn options() -> ron::Options {
    ron::Options::default().with_default_extension(Extensions::UNWRAP_VARIANT_NEWTYPES | Extensions::IMPLICIT_SOME)
}

/// Reads a level from text; `file` is its name in messages.
///
/// # Errors
/// [`FileError::Text`] with line, column and what was expected.
pub fn parse(text: &str, file: &str) -> Result<Level, FileError> {
    parse_as(text, file)
}

/// Reads anything that is written like a level from text; `file` is its name in messages.
///
/// # Errors
/// [`FileError::Text`] with line, column and what was expected.
pub fn parse_as<T: serde::de::DeserializeOwned>(text: &str, file: &str) -> Result<T, FileError> {
    options().from_str(text).map_err(|error| FileError::Text {
        file: file.to_owned(),
        line: error.span.start.line,
        column: error.span.start.col,
        what: error.code.to_string(),
    })
}

/// A level as text that [`parse`] reads back to the same bits.
///
/// # Errors
/// [`FileError::Access`] if it cannot be written as RON.
pub fn write(level: &Level) -> Result<String, FileError> {
    let config = PrettyConfig::new().depth_limit(4).separate_tuple_members(false).compact_arrays(false);
    let text = options().to_string_pretty(level, config);
    text.map(|text| text + "\n").map_err(|error| FileError::Access { file: level.name.clone(), why: error.to_string() })
}

/// A path with all its folders, as messages show it; the name of a built-in level stays as it is.
pub fn whole_path(path: &Path) -> PathBuf {
    let built_in = path.extension().is_none() && levels::built_in(&path.display().to_string()).is_some();
    if built_in { path.to_path_buf() } else { std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf()) }
}

/// Reads a level from a file; a bare name such as `gingerbread` is that built-in level. Paths of meshes in it are
/// taken relative to its folder.
///
/// # Errors
/// [`FileError`] with the place and the reason.
pub fn read(path: &Path) -> Result<Level, FileError> {
    let name = path.display().to_string();
    if path.extension().is_none()
        && let Some(text) = levels::built_in(&name)
    {
        return parse(text, &format!("{name}.ron"));
    }
    let mut level = parse(&read_text(path)?, &name)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    each_mesh_path(&mut level, |mesh| folder.join(mesh));
    Ok(level)
}

/// Saves a level so that at every moment either the old file or the whole new one is there; see [`write_bytes`].
///
/// # Errors
/// [`FileError::Access`] if the system refuses.
pub fn save(path: &Path, level: &Level) -> Result<(), FileError> {
    write_text(path, &text_at(path, level)?)
}

/// A level as the text of a file at a path: paths of meshes below its folder are written relative to it, others in full.
///
/// # Errors
/// [`FileError::Access`] if it cannot be written as RON.
pub fn text_at(path: &Path, level: &Level) -> Result<String, FileError> {
    let mut level = level.clone();
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let absolute = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
    let folder = absolute(folder);
    each_mesh_path(&mut level, |mesh| {
        let mesh = absolute(mesh);
        mesh.strip_prefix(&folder).map(Path::to_path_buf).unwrap_or(mesh)
    });
    write(&level)
}

/// The files of the meshes that a level names.
pub fn mesh_paths(level: &Level) -> Vec<PathBuf> {
    let mut paths = Vec::new();
    for body in &level.bodies {
        paths.extend(body.mesh.clone().kind_mut().path_mut().map(|path| PathBuf::from(path.as_str())));
    }
    paths
}

/// Writes a text file; see [`write_bytes`].
///
/// # Errors
/// [`FileError::Access`] if the system refuses.
pub fn write_text(path: &Path, text: &str) -> Result<(), FileError> {
    write_bytes(path, text.as_bytes())
}

/// The text of a file.
///
/// # Errors
/// [`FileError::Access`] if it cannot be read, or is too large.
pub fn read_text(path: &Path) -> Result<String, FileError> {
    let fail = |why: String| FileError::Access { file: path.display().to_string(), why };
    let said = |error: std::io::Error| fail(error.to_string());
    if !std::fs::metadata(path).map_err(said)?.is_file() {
        return Err(fail("this is not a file with text".to_owned()));
    }
    let mut text = String::new();
    let read = std::fs::File::open(path).and_then(|file| file.take(LARGEST + 1).read_to_string(&mut text));
    if read.map_err(said)? as u64 > LARGEST {
        return Err(fail(format!("a file may have {} MB at most", LARGEST >> 20)));
    }
    Ok(text)
}

fn each_mesh_path(level: &mut Level, change: impl Fn(&Path) -> PathBuf) {
    for body in &mut level.bodies {
        if let Some(path) = body.mesh.kind_mut().path_mut() {
            *path = change(Path::new(path.as_str())).display().to_string();
        }
    }
}

/// The file system.
pub struct Disk;

impl Files for Disk {
    fn read(&self, path: &str) -> Result<String, String> {
        read_text(Path::new(path)).map_err(|error| match error {
            FileError::Access { why, .. } => why,
            FileError::Text { .. } => error.to_string(),
        })
    }
}
