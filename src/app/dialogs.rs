//! Native dialogs for opening and saving, polled so that nothing waits for them. Where there are none (a browser, a bare
//! system) the answer is [`Answer::Unavailable`], and the window asks for text instead.

use std::path::PathBuf;

/// What came out of a dialog.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Answer {
    /// Open this file.
    Open(PathBuf),
    /// Save to this file.
    Save(PathBuf),
    /// There is no native dialog here.
    Unavailable {
        /// Whether it was to save.
        saving: bool,
    },
}

#[cfg(not(target_arch = "wasm32"))]
pub use native::Dialogs;
#[cfg(target_arch = "wasm32")]
pub use nowhere::Dialogs;

#[cfg(not(target_arch = "wasm32"))]
mod native {
    use super::{Answer, PathBuf};
    use eframe::egui::Context;
    use rfd::{AsyncFileDialog, FileHandle};
    use std::{
        pin::Pin,
        sync::Arc,
        task::{Poll, Wake, Waker},
    };
    use web_time::{Duration, Instant};

    /// Nobody closes a dialog that fast: there was none.
    const TOO_FAST: Duration = Duration::from_millis(250);

    /// The dialog that is open, if one is.
    #[derive(Default)]
    pub struct Dialogs {
        open: Option<Pending>,
        folder: Option<PathBuf>,
    }

    struct Pending {
        choice: Pin<Box<dyn Future<Output = Option<FileHandle>>>>,
        saving: bool,
        since: Instant,
    }

    /// Wakes the window when the dialog closes.
    struct Repaint(Context);

    impl Wake for Repaint {
        fn wake(self: Arc<Self>) {
            self.0.request_repaint();
        }
    }

    impl Dialogs {
        /// Asks for a file to open.
        pub fn ask_open(&mut self) {
            let choice = self.dialog().set_title("Open a level").pick_file();
            self.begin(Box::pin(choice), false);
        }

        /// Asks where to save; `name` is the suggestion.
        pub fn ask_save(&mut self, name: &str) {
            let choice = self.dialog().set_title("Save the level").set_file_name(name).save_file();
            self.begin(Box::pin(choice), true);
        }

        fn dialog(&self) -> AsyncFileDialog {
            let dialog =
                AsyncFileDialog::new().add_filter("Gingerbread level", &["ron"]).add_filter("All files", &["*"]);
            match &self.folder {
                Some(folder) => dialog.set_directory(folder),
                None => dialog,
            }
        }

        fn begin(&mut self, choice: Pin<Box<dyn Future<Output = Option<FileHandle>>>>, saving: bool) {
            // A second dialog while one is open would only be lost behind it.
            if self.open.is_none() {
                self.open = Some(Pending { choice, saving, since: Instant::now() });
            }
        }

        /// Looks whether a dialog was answered. Never waits.
        pub fn poll(&mut self, ctx: &Context) -> Option<Answer> {
            let waker = Waker::from(Arc::new(Repaint(ctx.clone())));
            let pending = self.open.as_mut()?;
            let Poll::Ready(choice) = pending.choice.as_mut().poll(&mut std::task::Context::from_waker(&waker)) else {
                return None;
            };
            let (saving, fast) = (pending.saving, pending.since.elapsed() < TOO_FAST);
            self.open = None;
            let Some(path) = choice.map(|file| file.path().to_path_buf()) else {
                return fast.then_some(Answer::Unavailable { saving });
            };
            self.folder = path.parent().map(PathBuf::from);
            Some(if saving { Answer::Save(with_extension(path)) } else { Answer::Open(path) })
        }
    }

    /// A level file without an extension gets one.
    pub(super) fn with_extension(path: PathBuf) -> PathBuf {
        if path.extension().is_some() { path } else { path.with_extension("ron") }
    }
}

#[cfg(target_arch = "wasm32")]
mod nowhere {
    use super::Answer;

    /// A browser has no file dialogs that can be waited for.
    #[derive(Default)]
    pub struct Dialogs {
        asked: Option<Answer>,
    }

    impl Dialogs {
        /// Asks for a level to open.
        pub fn ask_open(&mut self) {
            self.asked = Some(Answer::Unavailable { saving: false });
        }

        /// Asks what to do with a level.
        pub fn ask_save(&mut self, _name: &str) {
            self.asked = Some(Answer::Unavailable { saving: true });
        }

        /// Looks whether there is an answer.
        pub fn poll(&mut self, _ctx: &egui::Context) -> Option<Answer> {
            self.asked.take()
        }
    }
}

/// A file name from the name of a level: `A soft house` gives `a-soft-house.ron`.
pub fn file_name(level: &str) -> String {
    let words = level.split(|letter: char| !letter.is_alphanumeric()).filter(|word| !word.is_empty());
    let name = words.map(str::to_lowercase).collect::<Vec<_>>().join("-");
    if name.is_empty() { "level.ron".to_owned() } else { name + ".ron" }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_level_suggests_a_file_name_that_any_system_takes() {
        assert_eq!(file_name("A soft house: 2/3"), "a-soft-house-2-3.ron");
        assert_eq!(file_name("?"), "level.ron");
    }
}
