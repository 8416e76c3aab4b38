//! Opens and saves levels and exports plots and pictures. Before changes are lost it asks.

use super::{
    App,
    canvas::{Look, Tool},
    dialogs::{self, DialogResult, Purpose},
    making,
    panels::{Choice, Export, FileRequest, FilmRequest, Notice, Prompt, Unsaved, View},
};
use crate::{
    archive::States,
    command::Command,
    files::{self, FileError},
    finish::{Finish, Image},
    level::Level,
    link,
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
            Some(DialogResult::Unavailable(purpose)) => self.ask_for_path(purpose),
            None => {}
        }
        if let Some(prompt) = self.view.prompt.take_if(|prompt| prompt.answered) {
            self.handle_dialog(&prompt.purpose, Path::new(prompt.text.trim()));
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
            FileRequest::Hard { name, undamped, model, energy, method } => {
                match self.gallery.hard_level((name, undamped), (model, energy), method) {
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
            FileRequest::OpenImage(number) => self.dialogs.ask(Purpose::OpenImage(number)),
            FileRequest::SaveAgain => match self.path.clone() {
                Some(path) => self.save(&path),
                None => self.grant(FileRequest::Save),
            },
            FileRequest::Save => self.dialogs.ask(Purpose::Save(stem(&self.snapshot.level.name) + ".ron")),
            FileRequest::RecordedStates => match self.recorded_states() {
                Ok(export) => self.dialogs.ask(Purpose::Export(export)),
                Err(message) => self.view.notice = Some(Notice::Trouble(message)),
            },
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

    /// The states of the last seconds as an archive of arrays, with the energies that they have in the scene as it is now.
    fn recorded_states(&mut self) -> Result<Export, String> {
        let name = stem(&self.snapshot.level.name) + ".npz";
        let sandbox = self.settled();
        let simulation = sandbox.simulation();
        let mut states = States::new(simulation.scene())?;
        let now = simulation.restart();
        let earlier = sandbox.recorded().filter(|moment| moment.state.steps < now.state.steps);
        for moment in earlier.chain([&now]) {
            states.record(simulation.scene(), &moment.state, &simulation.energies_at(moment));
        }
        Ok(Export { name, bytes: states.bytes()? })
    }

    /// Starts a level that was read, and clears the notice. Returns whether it could be built.
    pub(super) fn start(&mut self, level: Level) -> bool {
        self.view.notice = None;
        let done = self.apply(None, Command::Open(Box::new(level)));
        if done {
            self.mark_kept();
            self.view.stage.tool = Tool::Hand;
            self.path = None;
            if self.sandbox.document().level.recorded.is_some() {
                self.apply(None, Command::SetRunning(true));
            }
        }
        done
    }

    /// Opens a level file or a link without asking about unsaved changes, or adds a body whose mesh is in the file. If it cannot be read or built, a notice is
    /// shown and the present scene stays.
    pub fn open(&mut self, path: &Path) {
        match path.to_str().and_then(link::level) {
            Some(Ok(level)) => {
                let mode = level.mode;
                if self.start(level) {
                    let camera = path.to_str().and_then(|address| link::view(address).camera);
                    self.view.looks.extend(camera.map(Look::From));
                    if self.view.presents.is_some() {
                        self.apply(None, Command::SetMode(mode.into()));
                    }
                }
                return;
            }
            Some(Err(error)) => {
                self.view.notice = Some(Notice::trouble(&error));
                return;
            }
            None => {}
        }
        if making::holds_body(path) {
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

    /// Requests the opening of the level in an address, if there is one.
    pub fn open_link(&mut self, address: &str) {
        if link::is_link(address) {
            self.view.file = Some(FileRequest::File(PathBuf::from(address), Vec::new()));
        }
        let link::View { embed, wireframe, .. } = link::view(address);
        self.view.stage.wireframe |= wireframe;
        if embed {
            self.view.presents = Some(1.0);
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
        let saved = saved.and_then(|()| dialogs::hand_over(path));
        self.view.notice = Some(match saved {
            Ok(()) => Notice::Done(format!("{} {}", dialogs::SAVED, files::whole_path(path).display())),
            Err(error) => Notice::trouble(&error),
        });
    }

    /// Requests the opening of a dropped file: of several files the first level, or else the first file.
    pub(super) fn take_dropped_files(&mut self, ctx: &Context) {
        let dropped = ctx.input_mut(|input| std::mem::take(&mut input.raw.dropped_files));
        let mut paths = self.dialogs.paths_of(ctx, &dropped);
        if paths.is_empty() {
            return;
        }
        let is_level = |path: &PathBuf| path.extension().is_some_and(|extension| extension == "ron");
        let first = paths.remove(paths.iter().position(is_level).unwrap_or(0));
        self.view.file = Some(FileRequest::File(first, paths));
    }

    /// Shows a text input for a path.
    fn ask_for_path(&mut self, purpose: Purpose) {
        let text = purpose.name().to_owned();
        self.view.prompt = Some(Prompt { purpose, text, answered: false });
    }

    fn handle_dialog(&mut self, purpose: &Purpose, path: &Path) {
        match purpose {
            Purpose::Open => self.open(path),
            Purpose::OpenMesh if making::holds_body(path) => self.add_from_file(path),
            Purpose::OpenMesh => {
                self.view.notice = Some(Notice::Trouble(format!(
                    "{}: expected a file that ends in .{}.",
                    path.display(),
                    making::ENDINGS.join(", .")
                )));
            }
            Purpose::OpenImage(number) => self.put_image(*number, path),
            Purpose::Save(_) => self.save(path),
            Purpose::Export(export) => self.tell(path, files::write_bytes(path, &export.bytes)),
        }
    }
}

impl App {
    /// Puts the picture of a file on a net or membrane, by number: nets first.
    fn put_image(&mut self, number: usize, path: &Path) {
        let path = files::whole_path(path);
        let image = files::read_bytes(&path).and_then(|bytes| Image::of_file(&bytes));
        match image {
            Ok(image) => {
                let mut level = self.settled().document().level.clone();
                if let Some(finish) = level.finish_mut(number) {
                    let finish = Finish { image: Some(image), ..finish.clone() };
                    self.apply(None, Command::SetFinish(number, finish));
                    self.apply(None, Command::EndGesture);
                }
            }
            Err(why) => self.view.notice = Some(Notice::Trouble(format!("{}: {why}.", path.display()))),
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
}
