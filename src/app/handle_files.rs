//! Opens and saves levels and exports plots.

use super::{
    App,
    dialogs::{DialogResult, Purpose, stem},
    panels::{Export, FileRequest, Notice, Prompt, View},
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
            FileRequest::Hard(name, model, method) => match self.gallery.hard_level(name, model, method) {
                Ok(level) => {
                    // The window would cover the scene.
                    self.view.hard.open = false;
                    if self.start(level) {
                        self.apply(None, Command::SetRunning(true));
                    }
                }
                Err(message) => self.view.notice = Some(Notice::Trouble(message)),
            },
            FileRequest::Open => self.dialogs.ask(Purpose::Open),
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
    fn start(&mut self, level: Level) -> bool {
        self.view.notice = None;
        let done = self.apply(None, Command::Open(Box::new(level)));
        if done {
            self.mark_kept();
        }
        done
    }

    /// Opens a level file without asking about unsaved changes. If it cannot be read or built, a notice is shown and the present scene
    /// stays.
    pub fn open(&mut self, path: &Path) {
        let path = files::whole_path(path);
        match files::read(&path) {
            Ok(level) => {
                if self.start(level) {
                    self.view.notice = Some(Notice::Done(format!("Opened {}", path.display())));
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
        self.saved(done);
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
