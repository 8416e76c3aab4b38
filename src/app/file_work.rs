//! Opening and saving levels, and saving what plots show: a file that cannot be read changes nothing but shows why.

use super::{
    App,
    dialogs::{Answer, Purpose, stem},
    panels::{Export, FileWish, Notice, Prompt, View},
};
use crate::{
    command::Command,
    files::{self, FileError},
    level::Level,
};
use eframe::egui::Context;
use std::path::Path;

impl App {
    /// Answers wishes, dialogs and prompts.
    pub(super) fn file_work(&mut self, ctx: &Context) {
        self.view.develop(ctx);
        match self.view.file.take() {
            Some(FileWish::BuiltIn(index)) => match self.gallery.level(index) {
                Ok(level) => self.start(level),
                Err(message) => self.view.notice = Some(Notice::Trouble(message)),
            },
            Some(FileWish::Hard(name, model, method)) => match self.gallery.hard_level(name, model, method) {
                Ok(level) => {
                    // It would lie over what is to be watched.
                    self.view.hard.open = false;
                    self.start(level);
                    self.apply(None, Command::SetRunning(true));
                }
                Err(message) => self.view.notice = Some(Notice::Trouble(message)),
            },
            Some(FileWish::Open) => self.dialogs.ask(Purpose::Open),
            Some(FileWish::Save) => self.dialogs.ask(Purpose::Save(stem(&self.snapshot.level.name) + ".ron")),
            Some(FileWish::Export(export)) => self.dialogs.ask(Purpose::Export(export)),
            None => {}
        }
        match self.dialogs.poll(ctx) {
            Some(Answer::Chosen(purpose, path)) => self.answer(&purpose, &path),
            Some(Answer::Unavailable(purpose)) => self.ask_for_text(ctx, purpose),
            None => {}
        }
        if let Some(prompt) = self.view.prompt.take_if(|prompt| prompt.answered) {
            match (&prompt.purpose, cfg!(target_arch = "wasm32")) {
                (Purpose::Open, true) => self.open_text(&prompt.text, "pasted level"),
                (purpose, _) => self.answer(purpose, Path::new(prompt.text.trim())),
            }
        }
    }

    /// Starts a level that could be read; what was wrong with another one is forgotten.
    fn start(&mut self, level: Level) {
        self.view.notice = None;
        self.apply(None, Command::Open(Box::new(level)));
    }

    /// Opens a level file. If it cannot be read or built, its message is shown and the old scene goes on.
    pub fn open(&mut self, path: &Path) {
        match files::read(path) {
            Ok(level) => self.start(level),
            Err(error) => self.view.notice = Some(Notice::trouble(&error)),
        }
    }

    /// Opens a level from its text; `name` stands for the file in messages.
    pub fn open_text(&mut self, text: &str, name: &str) {
        match files::parse(text, name) {
            Ok(level) => self.start(level),
            Err(error) => self.view.notice = Some(Notice::trouble(&error)),
        }
    }

    /// Saves the level with everything as it is now. If it fails, a file that was there stays.
    pub fn save(&mut self, path: &Path) {
        let saved = files::save(path, &self.settled().saved());
        self.tell(path, saved);
    }

    /// Says what came of saving.
    fn tell(&mut self, path: &Path, saved: Result<(), FileError>) {
        self.view.notice = Some(match saved {
            Ok(()) => Notice::Done(format!("Saved as {}", path.display())),
            Err(error) => Notice::trouble(&error),
        });
    }

    /// Opens what is dropped on the window.
    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn take_dropped_files(&mut self, ctx: &Context) {
        for file in ctx.input_mut(|input| std::mem::take(&mut input.raw.dropped_files)) {
            self.open(file.path());
        }
    }

    /// Without dialogs: a path to type, or in a browser the text of a level itself.
    fn ask_for_text(&mut self, ctx: &Context, purpose: Purpose) {
        if cfg!(target_arch = "wasm32") && purpose != Purpose::Open {
            let text = match purpose {
                Purpose::Export(Export { bytes, .. }) => {
                    String::from_utf8(bytes).map_err(|_| "Pictures cannot be saved in a browser.".to_owned())
                }
                _ => files::write(&self.settled().saved()).map_err(|error| error.to_string()),
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

    fn answer(&mut self, purpose: &Purpose, path: &Path) {
        match purpose {
            Purpose::Open => self.open(path),
            Purpose::Save(_) => self.save(path),
            Purpose::Export(export) => self.tell(path, files::write_bytes(path, &export.bytes)),
        }
    }
}

impl View {
    /// Whether the next frame has something to do with files.
    pub(super) fn wants_files(&self) -> bool {
        self.file.is_some() || self.is_posing() || self.prompt.as_ref().is_some_and(|prompt| prompt.answered)
    }
}
