//! Files of a page in a browser, which has no file system: what was opened, dropped or saved there, by name.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    sync::{Mutex, MutexGuard, PoisonError},
};

static FILES: Mutex<BTreeMap<PathBuf, Vec<u8>>> = Mutex::new(BTreeMap::new());

fn files() -> MutexGuard<'static, BTreeMap<PathBuf, Vec<u8>>> {
    FILES.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Keeps a file. One of the same name is replaced.
pub fn write(path: &Path, bytes: &[u8]) {
    files().insert(path.to_path_buf(), bytes.to_vec());
}

/// Content of a file.
///
/// # Errors
/// The reason, if there is none of this name.
pub fn read_bytes(path: &Path) -> Result<Vec<u8>, String> {
    files().get(path).cloned().ok_or_else(|| "no file of this name was opened or dropped on this page".to_owned())
}
