//! File dialogs of the system.

use super::{DialogResult, Purpose};
use crate::clock::{Duration, Instant};
use crate::{app::making::ENDINGS, files::FileError};
use eframe::egui::{Context, DroppedFileHandle};
use rfd::{AsyncFileDialog, FileHandle};
use std::{
    path::{Path, PathBuf},
    pin::Pin,
    sync::Arc,
    task::{Poll, Wake, Waker},
};

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
            Purpose::OpenMesh => Box::pin(dialog.add_filter("Mesh, drawing or picture", &ENDINGS).pick_file()),
            Purpose::OpenImage(_) => Box::pin(dialog.add_filter("Picture", &["png"]).pick_file()),
            Purpose::Save(name) => Box::pin(levels(dialog).set_file_name(name).save_file()),
            Purpose::Export(export) => Box::pin(dialog.set_file_name(&export.name).save_file()),
        };
        self.open = Some(Pending { choice, purpose, since: Instant::now() });
    }

    /// Paths of dropped files.
    #[expect(clippy::unused_self, reason = "in a browser their contents come later")]
    pub fn paths_of(&self, _: &Context, dropped: &[DroppedFileHandle]) -> Vec<PathBuf> {
        dropped.iter().map(|file| file.path().to_path_buf()).collect()
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
        let path = if purpose.reads() { path } else { with_extension(path, purpose.name()) };
        Some(DialogResult::Chosen(purpose, path))
    }
}

fn levels(dialog: AsyncFileDialog) -> AsyncFileDialog {
    let endings: Vec<_> = std::iter::once("ron").chain(ENDINGS).collect();
    dialog.add_filter("Level, mesh or drawing", &endings).add_filter("All files", &["*"])
}

/// Adds the extension of the suggested name to a file name without one.
fn with_extension(path: PathBuf, suggested: &str) -> PathBuf {
    let extension = Path::new(suggested).extension();
    match (path.extension(), extension) {
        (None, Some(extension)) => path.with_extension(extension),
        _ => path,
    }
}

/// How the notice about a saved file begins.
pub const SAVED: &str = "Saved as";

/// Address of the page: the program is none.
pub const fn page() -> String {
    String::new()
}

/// A saved file is on the disk already.
#[expect(clippy::unnecessary_wraps, reason = "a browser may refuse")]
pub const fn hand_over(_: &Path) -> Result<(), FileError> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_saved_without_an_extension_gets_one() {
        let named = |path: &str| with_extension(PathBuf::from(path), "chain-drift.csv");
        assert_eq!(named("drift"), PathBuf::from("drift.csv"));
        assert_eq!(named("drift.txt"), PathBuf::from("drift.txt"));
    }
}
