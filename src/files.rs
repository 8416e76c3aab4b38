//! Reads and writes levels; errors name file, line and column.
//!
//! ```
//! use gingerbread::{files, level::Level};
//!
//! let level = Level::new("Empty");
//! assert_eq!(files::parse(&files::write(&level)?, "empty.ron")?, level);
//! let error = files::parse("(name: \"a\", bodys: [])", "a.ron").unwrap_err().to_string();
//! assert!(error.starts_with("a.ron:1:"), "{error}");
//! # Ok::<(), files::FileError>(())
//! ```

#[cfg(target_arch = "wasm32")]
pub mod browser;
#[cfg(not(target_arch = "wasm32"))]
mod disk;
mod output;
mod slips;
mod spelling;
mod tokens;

#[cfg(target_arch = "wasm32")]
pub(crate) use browser::read_bytes;
#[cfg(not(target_arch = "wasm32"))]
pub(crate) use disk::read_bytes;
pub use output::{Destination, Identity, identity, write_bytes};

use crate::{
    level::{Level, ScriptedAction},
    levels,
    meshes::Files,
    text,
};
use ron::{extensions::Extensions, ser::PrettyConfig};
use std::path::{Path, PathBuf};

/// Error of reading or writing a level.
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
        /// Reason and expected content.
        what: String,
    },
    /// The file is missing, or cannot be read or written.
    #[error("{file}: {why}")]
    Access {
        /// Name of the file.
        file: String,
        /// Message of the system.
        why: String,
    },
}

fn options() -> ron::Options {
    ron::Options::default().with_default_extension(Extensions::UNWRAP_VARIANT_NEWTYPES | Extensions::IMPLICIT_SOME)
}

/// Reads a level from text. `file` is its name in messages. Of a hard case it reads the level with its scripted
/// actions.
///
/// # Errors
/// [`FileError::Text`] with line, column and what was expected.
pub fn parse(text: &str, file: &str) -> Result<Level, FileError> {
    if !is_case(text) {
        return parse_as(text, file);
    }
    let Scripted { mut level, actions, .. } = parse_as(text, file)?;
    level.actions.extend(actions);
    Ok(level)
}

/// Reads a value in the format of levels from text. `file` is its name in messages.
///
/// # Errors
/// [`FileError::Text`] with line, column and what was expected.
pub fn parse_as<T: serde::de::DeserializeOwned>(text: &str, file: &str) -> Result<T, FileError> {
    let text = text::normalised(text);
    let slashed = spelling::with_slashes(&text);
    let text = slashed.as_deref().unwrap_or(&text);
    let error = match options().from_str(text) {
        Ok(read) => return Ok(read),
        Err(error) => error,
    };
    // Other spellings are tried only after an error: most levels have none, and some are large.
    let unwrapped = if error.code == ron::Error::ExceededRecursionLimit { None } else { spelling::unwrapped(text) };
    let error = match unwrapped.map(|text| options().from_str(&text)) {
        Some(Ok(read)) => return Ok(read),
        Some(Err(later)) if place(&later) > place(&error) => later,
        _ => error,
    };
    let slips::Slip { line, column, what } = slips::explain(text, &error);
    Err(FileError::Text { file: file.to_owned(), line, column, what })
}

/// Line and column of an error.
const fn place(error: &ron::error::SpannedError) -> (usize, usize) {
    (error.span.start.line, error.span.start.col)
}

/// Level and actions of a hard case. [`crate::hard`] reads the rest.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Scripted {
    level: Level,
    #[serde(default, alias = "acts")]
    actions: Vec<ScriptedAction>,
    #[serde(rename = "lasts")]
    _lasts: serde::de::IgnoredAny,
    #[serde(rename = "expects")]
    _expects: serde::de::IgnoredAny,
    #[serde(default, rename = "within")]
    _within: serde::de::IgnoredAny,
    #[serde(default, rename = "cannot")]
    _cannot: serde::de::IgnoredAny,
}

/// Whether a text is a hard case. A hard case has a field `level`.
pub fn is_case(text: &str) -> bool {
    let mut tokens = tokens::Tokens::new(text.strip_prefix('\u{feff}').unwrap_or(text));
    let (mut depth, mut last) = (0_usize, None);
    for token in tokens.by_ref() {
        if depth == 1 && token.is(':') && last == Some("level") {
            return true;
        }
        if depth == 1 && token.is(':') && last == Some("name") {
            return false;
        }
        depth = if token.opens() { depth + 1 } else { depth.saturating_sub(usize::from(token.closes())) };
        last = Some(token.text);
    }
    false
}

/// Writes a level as text that [`parse`] reads back to the same bits.
///
/// # Errors
/// [`FileError::Access`] if it cannot be written as RON.
pub fn write(level: &Level) -> Result<String, FileError> {
    let config = PrettyConfig::new().depth_limit(4).separate_tuple_members(false).compact_arrays(false);
    let text = options().to_string_pretty(level, config);
    text.map(|text| text + "\n").map_err(|error| FileError::Access { file: level.name.clone(), why: error.to_string() })
}

/// Writes a level without spaces and line breaks.
///
/// # Errors
/// [`FileError::Access`] if it cannot be written as RON.
pub fn write_compact(level: &Level) -> Result<String, FileError> {
    let text = options().to_string(level);
    text.map_err(|error| FileError::Access { file: level.name.clone(), why: error.to_string() })
}

/// Full path for messages. The name of a built-in level or hard case stays unchanged.
pub fn whole_path(path: &Path) -> PathBuf {
    let built_in = path.extension().is_none() && named(&path.display().to_string()).is_some();
    if built_in { path.to_path_buf() } else { std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf()) }
}

/// Text of a built-in level or hard case.
fn named(name: &str) -> Option<&'static str> {
    levels::built_in(name).or_else(|| levels::hard_case(name))
}

/// Reads a level from a file, or with `-` from standard input.
/// A bare name such as `gingerbread` is a built-in level or hard case. Paths of meshes are relative to the folder of
/// the level.
///
/// # Errors
/// [`FileError`] with the place and the reason.
pub fn read(path: &Path) -> Result<Level, FileError> {
    let name = path.display().to_string();
    if path.extension().is_none()
        && let Some(text) = named(&name)
    {
        return parse(text, &format!("{name}.ron"));
    }
    let mut level = parse(&read_text(path)?, &name)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    each_mesh_path(&mut level, |mesh| found(folder.join(mesh)));
    Ok(level)
}

/// Saves a level. At every moment either the old file or the complete new one exists; see [`write_bytes`].
///
/// # Errors
/// [`FileError::Access`] if the system refuses.
pub fn save(path: &Path, level: &Level) -> Result<(), FileError> {
    write_text(path, &text_at(path, level)?)
}

/// Text of a level for a file at a path. Paths of meshes below its folder are relative to it, others are absolute.
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

/// Mesh files that a level names.
pub fn mesh_paths(level: &Level) -> Vec<PathBuf> {
    level.clone().mesh_paths_mut().into_iter().map(|path| path.clone()).collect()
}

/// Writes a text file; see [`write_bytes`].
///
/// # Errors
/// [`FileError::Access`] if the system refuses.
pub fn write_text(path: &Path, text: &str) -> Result<(), FileError> {
    write_bytes(path, text.as_bytes())
}

/// Reads the text of a file or pipe, or with `-` of standard input; in a browser that of a file that was opened there. See [`text::decode`].
///
/// # Errors
/// [`FileError::Access`] if it cannot be read, or is too large.
pub fn read_text(path: &Path) -> Result<String, FileError> {
    let bytes = read_bytes(path).map_err(|why| FileError::Access { file: path.display().to_string(), why })?;
    Ok(text::decode(bytes))
}

/// Path of an existing file. If none exists and the path has backslashes, as on Windows, the path with slashes is
/// tried.
fn found(path: PathBuf) -> PathBuf {
    let slashed = path.to_str().filter(|name| name.contains('\\')).map(|name| PathBuf::from(name.replace('\\', "/")));
    match slashed {
        Some(slashed) if !path.exists() => slashed,
        _ => path,
    }
}

fn each_mesh_path(level: &mut Level, change: impl Fn(&Path) -> PathBuf) {
    for path in level.mesh_paths_mut() {
        *path = change(path);
    }
}

/// File system as a source of mesh files.
pub struct Disk;

impl Files for Disk {
    fn read(&self, path: &Path) -> Result<String, String> {
        read_text(path).map_err(|error| match error {
            FileError::Access { why, .. } => why,
            FileError::Text { .. } => error.to_string(),
        })
    }
}
