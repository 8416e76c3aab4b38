//! Native dialogs for opening and saving, polled so that the window never blocks. Where there are none (in a browser or on a minimal
//! system), the result is [`DialogResult::Unavailable`], and the window shows a text input instead.

use super::panels::Export;
use std::path::PathBuf;

/// Purpose of a file dialog.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Purpose {
    /// Open a level.
    #[default]
    Open,
    /// Save the level. The field is the suggested name.
    Save(String),
    /// Save the data of a plot.
    Export(Export),
}

impl Purpose {
    /// Title of the dialog.
    pub const fn title(&self) -> &'static str {
        match self {
            Self::Open => "Open a level",
            Self::Save(_) => "Save the level",
            Self::Export(_) => "Save the plot",
        }
    }

    /// Suggested file name.
    pub fn name(&self) -> &str {
        match self {
            Self::Open => "",
            Self::Save(name) => name,
            Self::Export(export) => &export.name,
        }
    }
}

/// Result of a dialog.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DialogResult {
    /// This file was chosen.
    Chosen(Purpose, PathBuf),
    /// No native dialog is available.
    Unavailable(Purpose),
}

#[cfg(not(target_arch = "wasm32"))]
pub use native::Dialogs;
#[cfg(target_arch = "wasm32")]
pub use nowhere::Dialogs;

#[cfg(not(target_arch = "wasm32"))]
mod native {
    use super::{DialogResult, PathBuf, Purpose};
    use eframe::egui::Context;
    use rfd::{AsyncFileDialog, FileHandle};
    use std::{
        pin::Pin,
        sync::Arc,
        task::{Poll, Wake, Waker},
    };
    use web_time::{Duration, Instant};

    /// Minimum time in which a user can close a dialog. A dialog that closed sooner without a file was never shown.
    const TOO_FAST: Duration = Duration::from_millis(250);

    /// State of the native dialogs.
    #[derive(Default)]
    pub struct Dialogs {
        open: Option<Pending>,
        folder: Option<PathBuf>,
        /// Whether native dialogs are disabled.
        silent: bool,
        refused: Option<Purpose>,
    }

    struct Pending {
        choice: Pin<Box<dyn Future<Output = Option<FileHandle>>>>,
        purpose: Purpose,
        since: Instant,
    }

    /// Requests a frame when the dialog closes.
    struct Repaint(Context);

    impl Wake for Repaint {
        fn wake(self: Arc<Self>) {
            self.0.request_repaint();
        }
    }

    impl Dialogs {
        /// Disables native dialogs: every request is answered in the window.
        pub fn silent() -> Self {
            Self { silent: true, ..Self::default() }
        }

        /// Opens a dialog.
        pub fn ask(&mut self, purpose: Purpose) {
            if self.silent {
                self.refused = Some(purpose);
                return;
            }
            // A second dialog would be hidden behind the open one.
            if self.open.is_some() {
                return;
            }
            let dialog = AsyncFileDialog::new().set_title(purpose.title());
            let dialog = match &self.folder {
                Some(folder) => dialog.set_directory(folder),
                None => dialog,
            };
            let choice: Pin<Box<dyn Future<Output = _>>> = match &purpose {
                Purpose::Open => Box::pin(levels(dialog).pick_file()),
                Purpose::Save(name) => Box::pin(levels(dialog).set_file_name(name).save_file()),
                Purpose::Export(export) => Box::pin(dialog.set_file_name(&export.name).save_file()),
            };
            self.open = Some(Pending { choice, purpose, since: Instant::now() });
        }

        /// Whether a result is expected.
        pub const fn is_waiting(&self) -> bool {
            self.open.is_some() || self.refused.is_some()
        }

        /// Returns the result of a closed dialog. It never blocks.
        pub fn poll(&mut self, ctx: &Context) -> Option<DialogResult> {
            let waker = Waker::from(Arc::new(Repaint(ctx.clone())));
            if let Some(purpose) = self.refused.take() {
                return Some(DialogResult::Unavailable(purpose));
            }
            let pending = self.open.as_mut()?;
            let Poll::Ready(choice) = pending.choice.as_mut().poll(&mut std::task::Context::from_waker(&waker)) else {
                return None;
            };
            let Pending { purpose, since, .. } = self.open.take()?;
            let Some(path) = choice.map(|file| file.path().to_path_buf()) else {
                return (since.elapsed() < TOO_FAST).then_some(DialogResult::Unavailable(purpose));
            };
            self.folder = path.parent().map(PathBuf::from);
            let path = if purpose == Purpose::Open { path } else { with_extension(path, purpose.name()) };
            Some(DialogResult::Chosen(purpose, path))
        }
    }

    fn levels(dialog: AsyncFileDialog) -> AsyncFileDialog {
        dialog.add_filter("Gingerbread level", &["ron"]).add_filter("All files", &["*"])
    }

    /// Adds the extension of the suggested name to a file name without one.
    pub(super) fn with_extension(path: PathBuf, suggested: &str) -> PathBuf {
        let extension = std::path::Path::new(suggested).extension();
        match (path.extension(), extension) {
            (None, Some(extension)) => path.with_extension(extension),
            _ => path,
        }
    }
}

#[cfg(target_arch = "wasm32")]
mod nowhere {
    use super::{DialogResult, Purpose};

    /// Replacement in a browser, which has no file dialogs that can be awaited.
    #[derive(Default)]
    pub struct Dialogs {
        asked: Option<Purpose>,
    }

    impl Dialogs {
        /// The same as the default: there are no native dialogs.
        pub fn silent() -> Self {
            Self::default()
        }

        /// Requests a file.
        pub fn ask(&mut self, purpose: Purpose) {
            self.asked = Some(purpose);
        }

        /// Whether a result is expected.
        pub const fn is_waiting(&self) -> bool {
            self.asked.is_some()
        }

        /// Returns the result of a request.
        pub fn poll(&mut self, _ctx: &eframe::egui::Context) -> Option<DialogResult> {
            self.asked.take().map(DialogResult::Unavailable)
        }
    }
}

/// Stem of a file name for the name of a level: `A soft house` gives `a-soft-house`.
pub fn stem(level: &str) -> String {
    let words = level.split(|letter: char| !letter.is_alphanumeric()).filter(|word| !word.is_empty());
    let name = words.map(str::to_lowercase).collect::<Vec<_>>().join("-");
    if name.is_empty() { "level".to_owned() } else { name }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_level_suggests_a_file_name_that_any_system_takes() {
        assert_eq!(stem("A soft house: 2/3"), "a-soft-house-2-3");
        assert_eq!(stem("?"), "level");
    }

    #[test]
    #[cfg(not(target_arch = "wasm32"))]
    fn a_file_saved_without_an_extension_gets_one() {
        let named = |path: &str| native::with_extension(PathBuf::from(path), "chain-drift.csv");
        assert_eq!(named("drift"), PathBuf::from("drift.csv"));
        assert_eq!(named("drift.txt"), PathBuf::from("drift.txt"));
    }
}
