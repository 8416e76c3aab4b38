//! Opening and saving levels: a file that cannot be read changes nothing but shows why.

use super::{
    App,
    dialogs::{Answer, file_name},
    panels::{FileWish, Notice, Prompt, View},
};
use crate::{command::Command, files, level::Level};
use eframe::egui::Context;
use std::path::Path;

impl App {
    /// Answers wishes, dialogs and prompts.
    pub(super) fn file_work(&mut self, ctx: &Context) {
        match self.view.file.take() {
            Some(FileWish::BuiltIn(index)) => match self.gallery.level(index) {
                Ok(level) => self.start(level),
                Err(message) => self.view.notice = Some(Notice::Trouble(message)),
            },
            Some(FileWish::Open) => self.dialogs.ask_open(),
            Some(FileWish::Save) => self.dialogs.ask_save(&file_name(&self.snapshot.level.name)),
            None => {}
        }
        match self.dialogs.poll(ctx) {
            Some(Answer::Open(path)) => self.open(&path),
            Some(Answer::Save(path)) => self.save(&path),
            Some(Answer::Unavailable { saving }) => self.ask_for_text(ctx, saving),
            None => {}
        }
        if let Some(prompt) = self.view.prompt.take_if(|prompt| prompt.answered) {
            self.answer(&prompt);
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
        self.view.notice = Some(match files::save(path, &self.settled().saved()) {
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
    fn ask_for_text(&mut self, ctx: &Context, saving: bool) {
        if cfg!(target_arch = "wasm32") && saving {
            self.view.notice = Some(match files::write(&self.settled().saved()) {
                Ok(text) => {
                    ctx.copy_text(text);
                    Notice::Done("The level is in the clipboard: paste it into a file.".to_owned())
                }
                Err(error) => Notice::trouble(&error),
            });
            return;
        }
        let text = if saving { file_name(&self.snapshot.level.name) } else { String::new() };
        self.view.prompt = Some(Prompt { saving, text, answered: false });
    }

    fn answer(&mut self, prompt: &Prompt) {
        let path = Path::new(prompt.text.trim());
        match (prompt.saving, cfg!(target_arch = "wasm32")) {
            (true, _) => self.save(path),
            (false, true) => self.open_text(&prompt.text, "pasted level"),
            (false, false) => self.open(path),
        }
    }
}

impl View {
    /// Whether the next frame has something to do with files.
    pub(super) fn wants_files(&self) -> bool {
        self.file.is_some() || self.prompt.as_ref().is_some_and(|prompt| prompt.answered)
    }
}
