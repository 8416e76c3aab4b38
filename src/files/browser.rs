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

/// Content of a file; `None` if there is none of this name.
pub fn read(path: &Path) -> Option<Vec<u8>> {
    files().get(path).cloned()
}
