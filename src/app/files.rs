//! Opens and saves levels and exports plots and pictures: native dialogs, and unsaved changes, which it asks about before they are lost.
//!
//! Dialogs are polled so that the window never blocks. Where there are none (in a browser or on a minimal system), the result is
//! [`DialogResult::Unavailable`], and the window shows a text input instead.

#[cfg(not(target_arch = "wasm32"))]
pub use native::Dialogs;
#[cfg(target_arch = "wasm32")]
pub use nowhere::Dialogs;

use super::{
    App, making,
    panels::{Choice, Export, FileRequest, FilmRequest, Notice, Prompt, Unsaved, View},
};
use crate::{
    command::Command,
    files::{self, FileError},
    level::Level,
};
use eframe::egui::{Context, ViewportCommand};
use std::path::{Path, PathBuf};

impl App {
    /// Handles file requests, dialogs and text inputs.
    pub(super) fn handle_files(&mut self, ctx: &Context) {
        self.view.develop(ctx);
        self.take_close_request(ctx);
        if let Some(request) = self.decide() {
            self.grant(request);
        }
        if let Some(request) = self.view.file.take().and_then(|request| self.request_or_ask(request)) {
            self.grant(request);
        }
        match self.dialogs.poll(ctx) {
            Some(DialogResult::Chosen(purpose, path)) => self.handle_dialog(&purpose, &path),
            Some(DialogResult::Unavailable(purpose)) => self.ask_for_text(ctx, purpose),
            None => {}
        }
        if let Some(prompt) = self.view.prompt.take_if(|prompt| prompt.answered) {
            match (&prompt.purpose, cfg!(target_arch = "wasm32")) {
                (Purpose::Open, true) => self.open_text(&prompt.text, "pasted level"),
                (purpose, _) => self.handle_dialog(purpose, Path::new(prompt.text.trim())),
            }
        }
        if self.view.prompt.is_none() && !self.dialogs.is_waiting() {
            // If no file name was given, the request that waits for saving is dropped.
            self.after_saving = None;
        }
        if self.leaves {
            ctx.send_viewport_cmd(ViewportCommand::Close);
        }
    }

    /// Carries out a file request, after the decision about unsaved changes.
    fn grant(&mut self, request: FileRequest) {
        match request {
            FileRequest::BuiltIn(index) => match self.gallery.level(index) {
                Ok(level) => drop(self.start(level)),
                Err(message) => self.view.notice = Some(Notice::Trouble(message)),
            },
            FileRequest::Hard { name, undamped, model, method } => {
                match self.gallery.hard_level(name, undamped, model, method) {
                    Ok(level) => {
                        // The window would cover the scene.
                        self.view.hard.open = false;
                        if self.start(level) {
                            self.apply(None, Command::SetRunning(true));
                        }
                    }
                    Err(message) => self.view.notice = Some(Notice::Trouble(message)),
                }
            }
            FileRequest::Open => self.dialogs.ask(Purpose::Open),
            FileRequest::OpenMesh => self.dialogs.ask(Purpose::OpenMesh),
            FileRequest::SaveAgain => match self.path.clone() {
                Some(path) => self.save(&path),
                None => self.grant(FileRequest::Save),
            },
            FileRequest::Save => self.dialogs.ask(Purpose::Save(stem(&self.snapshot.level.name) + ".ron")),
            FileRequest::Export(export) => self.dialogs.ask(Purpose::Export(export)),
            FileRequest::File(path, ignored) => {
                self.open(&path);
                if !ignored.is_empty() {
                    self.tell_ignored(&ignored);
                }
            }
            FileRequest::Close => self.leaves = true,
        }
    }

    /// Starts a level that was read, and clears the notice. Returns whether it could be built.
    pub(super) fn start(&mut self, level: Level) -> bool {
        self.view.notice = None;
        let done = self.apply(None, Command::Open(Box::new(level)));
        if done {
            self.mark_kept();
            (self.view.picks, self.view.stage.draws) = (false, false);
            self.path = None;
        }
        done
    }

    /// Opens a level file without asking about unsaved changes, or adds a body whose mesh is in the file. If it cannot be read or built, a notice is shown and the present scene
    /// stays.
    pub fn open(&mut self, path: &Path) {
        if making::is_mesh(path) {
            self.add_from_file(path);
            return;
        }
        let path = files::whole_path(path);
        match files::read(&path) {
            Ok(level) => {
                if self.start(level) {
                    self.view.notice = Some(Notice::Done(format!("Opened {}", path.display())));
                    self.remember(path);
                }
            }
            Err(error) => self.view.notice = Some(Notice::trouble(&error)),
        }
    }

    /// Adds the names of ignored files to the notice about the opened file.
    fn tell_ignored(&mut self, ignored: &[PathBuf]) {
        let names: Vec<_> = ignored.iter().map(|path| files::whole_path(path).display().to_string()).collect();
        let text = format!("Not opened: {}. Only one level is open at a time: drop one file.", names.join(", "));
        self.view.notice = Some(match self.view.notice.take() {
            Some(Notice::Trouble(before)) => Notice::Trouble(format!("{before}\n{text}")),
            Some(Notice::Done(before)) => Notice::Done(format!("{before}\n{text}")),
            None => Notice::Done(text),
        });
    }

    /// Opens a level from its text; `name` stands for the file in messages.
    pub fn open_text(&mut self, text: &str, name: &str) {
        match files::parse(text, name) {
            Ok(level) => drop(self.start(level)),
            Err(error) => self.view.notice = Some(Notice::trouble(&error)),
        }
    }

    /// Saves the level with its present state. If it fails, an existing file stays.
    pub fn save(&mut self, path: &Path) {
        let saved = files::save(path, &self.settled().saved());
        let done = saved.is_ok();
        self.tell(path, saved);
        if done {
            self.remember(files::whole_path(path));
        }
        self.saved(done);
    }

    /// Remembers the file of the level, for saving it again and among those that were used last.
    fn remember(&mut self, path: PathBuf) {
        /// Number of files in the list.
        const MOST: usize = 8;
        self.recent.retain(|other| *other != path);
        self.recent.insert(0, path.clone());
        self.recent.truncate(MOST);
        self.path = Some(path);
    }

    /// Writes the name of the level and whether it has changes into the title of the window.
    pub(super) fn show_title(&mut self, ctx: &Context) {
        let mark = if self.is_unsaved() { "• " } else { "" };
        let title = format!("{mark}{} – Gingerbread", self.snapshot.level.name);
        if title != self.title {
            ctx.send_viewport_cmd(ViewportCommand::Title(title.clone()));
            self.title = title;
        }
    }

    /// After saving: marks the changes as saved and carries out the request that waited for it.
    fn saved(&mut self, done: bool) {
        let request = self.after_saving.take();
        if done {
            self.mark_kept();
            if let Some(request) = request {
                self.grant(request);
            }
        }
    }

    /// Shows the result of saving as a notice.
    fn tell(&mut self, path: &Path, saved: Result<(), FileError>) {
        self.view.notice = Some(match saved {
            Ok(()) => Notice::Done(format!("Saved as {}", files::whole_path(path).display())),
            Err(error) => Notice::trouble(&error),
        });
    }

    /// Requests the opening of a dropped file: of several files the first level, or else the first file.
    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn take_dropped_files(&mut self, ctx: &Context) {
        let dropped = ctx.input_mut(|input| std::mem::take(&mut input.raw.dropped_files));
        let mut paths: Vec<PathBuf> = dropped.iter().map(|file| file.path().to_path_buf()).collect();
        if paths.is_empty() {
            return;
        }
        let is_level = |path: &PathBuf| path.extension().is_some_and(|extension| extension == "ron");
        let first = paths.remove(paths.iter().position(is_level).unwrap_or(0));
        self.view.file = Some(FileRequest::File(first, paths));
    }

    /// Shows a text input: for a path, or in a browser for the text of a level.
    fn ask_for_text(&mut self, ctx: &Context, purpose: Purpose) {
        if cfg!(target_arch = "wasm32") && purpose == Purpose::OpenMesh {
            let text = "In a browser no mesh file can be opened yet: paste its points as an Outline into a level.";
            self.view.notice = Some(Notice::Trouble(text.to_owned()));
            return;
        }
        if cfg!(target_arch = "wasm32") && purpose != Purpose::Open {
            let text = if let Purpose::Export(Export { bytes, .. }) = purpose {
                String::from_utf8(bytes).map_err(|_| "Pictures cannot be saved in a browser.".to_owned())
            } else {
                let text = files::write(&self.settled().saved()).map_err(|error| error.to_string());
                self.saved(text.is_ok());
                text
            };
            self.view.notice = Some(match text {
                Ok(text) => {
                    ctx.copy_text(text);
                    Notice::Done("The text was copied to the clipboard: paste it into a file.".to_owned())
                }
                Err(why) => Notice::Trouble(why),
            });
            return;
        }
        let text = purpose.name().to_owned();
        self.view.prompt = Some(Prompt { purpose, text, answered: false });
    }

    fn handle_dialog(&mut self, purpose: &Purpose, path: &Path) {
        match purpose {
            Purpose::Open => self.open(path),
            Purpose::OpenMesh if making::is_mesh(path) => self.add_from_file(path),
            Purpose::OpenMesh => {
                self.view.notice = Some(Notice::Trouble(format!("{} is no OBJ file.", path.display())));
            }
            Purpose::Save(_) => self.save(path),
            Purpose::Export(export) => self.tell(path, files::write_bytes(path, &export.bytes)),
        }
    }
}

impl View {
    /// Whether the next frame has file requests to handle.
    pub(super) fn wants_files(&self) -> bool {
        self.file.is_some()
            || self.is_posing()
            || self.prompt.as_ref().is_some_and(|prompt| prompt.answered)
            || self.unsaved.as_ref().is_some_and(|unsaved| unsaved.choice.is_some())
    }
}

impl App {
    /// Whether the level of either pane differs from the opened or saved one. Stepping is no change: it can be repeated.
    pub fn is_unsaved(&self) -> bool {
        let b = self.comparison.as_ref().map(|panes| panes.sandbox());
        std::iter::once(&self.sandbox).chain(b).any(|sandbox| *sandbox.document() != self.kept)
    }

    /// Marks the present document as saved.
    fn mark_kept(&mut self) {
        self.kept = self.settled().document().clone();
    }

    /// Cancels a request to close the window while a film is recorded, which ends then, or while there are unsaved changes, and asks about
    /// them.
    fn take_close_request(&mut self, ctx: &Context) {
        let requested = ctx.input(|input| input.viewport().close_requested());
        let films = self.view.film.is_some();
        if let Some(zoom) = self.view.presents.filter(|_| requested) {
            // The interface opens in its usual size again.
            ctx.set_zoom_factor(zoom);
        }
        if requested && !self.leaves && (films || self.is_unsaved()) {
            // A minimized window could not show the dialog.
            for command in [ViewportCommand::CancelClose, ViewportCommand::Minimized(false), ViewportCommand::Focus] {
                ctx.send_viewport_cmd(command);
            }
            if films {
                self.view.film_requests.push(FilmRequest::Stop);
                let text = "The film that is recorded ends here. Save or discard it, then close the window again.";
                self.view.notice = Some(Notice::Done(text.to_owned()));
            } else {
                self.view.file = Some(FileRequest::Close);
            }
        }
    }

    /// Returns the request, or shows the dialog first if the request would lose changes.
    fn request_or_ask(&mut self, request: FileRequest) -> Option<FileRequest> {
        if request.replaces_level() && self.is_unsaved() {
            self.view.unsaved = Some(Unsaved { request, choice: None });
            return None;
        }
        Some(request)
    }

    /// Carries out the choice about unsaved changes. Returns the waiting request if it can continue now.
    fn decide(&mut self) -> Option<FileRequest> {
        let Unsaved { request, choice } = self.view.unsaved.take_if(|unsaved| unsaved.choice.is_some())?;
        match choice? {
            Choice::Discard => Some(request),
            Choice::Cancel => None,
            Choice::Save => {
                self.after_saving = Some(request);
                self.dialogs.ask(Purpose::Save(stem(&self.snapshot.level.name) + ".ron"));
                None
            }
        }
    }
}

/// Purpose of a file dialog.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Purpose {
    /// Open a level.
    #[default]
    Open,
    /// Add a body whose mesh is in a file.
    OpenMesh,
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
            Self::OpenMesh => "Add a body from a mesh file",
            Self::Save(_) => "Save the level",
            Self::Export(_) => "Save the file",
        }
    }

    /// Suggested file name.
    pub fn name(&self) -> &str {
        match self {
            Self::Open | Self::OpenMesh => "",
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
                Purpose::OpenMesh => Box::pin(dialog.add_filter("Mesh", &["obj"]).pick_file()),
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
            let path = if matches!(purpose, Purpose::Open | Purpose::OpenMesh) {
                path
            } else {
                with_extension(path, purpose.name())
            };
            Some(DialogResult::Chosen(purpose, path))
        }
    }

    fn levels(dialog: AsyncFileDialog) -> AsyncFileDialog {
        dialog.add_filter("Level or mesh", &["ron", "obj"]).add_filter("All files", &["*"])
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
