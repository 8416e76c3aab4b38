//! A folder for the files of a test.
#![allow(dead_code, clippy::unwrap_used, reason = "each test file uses its own part, and a failing test should panic")]

use std::{fs, path::PathBuf};

/// A folder that is removed with all that is in it.
pub struct Folder(pub PathBuf);

impl Folder {
    /// A new folder with a name of its own for each test.
    pub fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("gingerbread-{name}-{}", std::process::id()));
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    /// The path of a file in it.
    pub fn file(&self, name: &str) -> String {
        self.0.join(name).display().to_string()
    }

    /// A file in it with a text; returns its path.
    pub fn with(&self, name: &str, text: &str) -> String {
        fs::write(self.0.join(name), text).unwrap();
        self.file(name)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}
