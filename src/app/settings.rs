//! What the window remembers from run to run, beside what egui keeps: its theme, zoom, size and place. A page in a browser remembers its scene too,
//! as it may be closed at any time without a question.

use super::{App, language::Language};
use crate::{files, level::Level};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// What is remembered. Fields that an older version did not write have their defaults.
#[derive(Debug, Default, Deserialize, Serialize)]
#[serde(default)]
pub struct Settings {
    /// Whether the left and the right panel are hidden in a wide window.
    hidden: [bool; 2],
    /// Language of the texts.
    language: Language,
    /// Level files that were used last, the newest first.
    recent: Vec<PathBuf>,
}

impl App {
    /// What is remembered now.
    fn settings(&self) -> Settings {
        Settings { hidden: self.view.hidden, language: self.view.language, recent: self.recent.clone() }
    }

    /// Takes what was remembered, if it can be read.
    pub fn recall(&mut self, storage: &dyn eframe::Storage) {
        let Some(Settings { hidden, language, recent }) = eframe::get_value(storage, eframe::APP_KEY) else { return };
        (self.view.hidden, self.view.language) = (hidden, language);
        if !IS_PAGE {
            // The files of a page are gone with it.
            self.recent = recent;
        }
    }

    /// Writes what is remembered.
    pub fn keep(&self, storage: &mut dyn eframe::Storage) {
        eframe::set_value(storage, eframe::APP_KEY, &self.settings());
        if IS_PAGE && let Ok(text) = files::write(&self.sandbox.saved()) {
            storage.set_string(SCENE, text);
        }
    }
}

/// Whether this is a page in a browser.
const IS_PAGE: bool = cfg!(target_arch = "wasm32");
/// Key of the scene.
const SCENE: &str = "scene";

/// The remembered scene, if there is one that can be read.
pub fn last_scene(storage: &dyn eframe::Storage) -> Option<Level> {
    let text = storage.get_string(SCENE).filter(|_| IS_PAGE)?;
    files::parse(&text, SCENE).ok()
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a failing test should panic")]
mod tests {
    use super::*;

    #[test]
    fn settings_of_another_version_are_read_as_far_as_they_are_known() {
        let old: Settings = ron::from_str("(recent: [\"a.ron\"], language: \"xx\", forgotten: 7)").unwrap();
        assert_eq!(
            (old.hidden, old.language, old.recent),
            ([false; 2], Language::English, vec![PathBuf::from("a.ron")])
        );
        let german = Settings { language: Language::German, ..Settings::default() };
        let read: Settings = ron::from_str(&ron::to_string(&german).unwrap()).unwrap();
        assert_eq!(read.language, Language::German);
    }
}
