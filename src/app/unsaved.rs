//! Unsaved changes: detects them and asks before they are lost.

use super::{
    App,
    dialogs::{Purpose, stem},
    panels::{Choice, FileRequest, Unsaved},
};
use eframe::egui::{Context, ViewportCommand};

impl App {
    /// Whether the level differs from what was opened or saved last, in either pane. Stepping is no change: it can be repeated.
    pub fn is_unsaved(&self) -> bool {
        let b = self.comparison.as_ref().map(|panes| panes.sandbox());
        std::iter::once(&self.sandbox).chain(b).any(|sandbox| *sandbox.document() != self.kept)
    }

    /// What is shown now is what a file, or the gallery, has.
    pub(super) fn mark_kept(&mut self) {
        self.kept = self.settled().document().clone();
    }

    /// Keeps the window open while there are unsaved changes, and asks about them.
    pub(super) fn take_close_request(&mut self, ctx: &Context) {
        let requested = ctx.input(|input| input.viewport().close_requested());
        if requested && !self.leaves && self.is_unsaved() {
            // A window that is minimized could not ask.
            for command in [ViewportCommand::CancelClose, ViewportCommand::Minimized(false), ViewportCommand::Focus] {
                ctx.send_viewport_cmd(command);
            }
            self.view.file = Some(FileRequest::Close);
        }
    }

    /// Returns the request, or asks first about the changes that it would lose.
    pub(super) fn request_or_ask(&mut self, request: FileRequest) -> Option<FileRequest> {
        if request.replaces_level() && self.is_unsaved() {
            self.view.unsaved = Some(Unsaved { request, choice: None });
            return None;
        }
        Some(request)
    }

    /// Does what was decided about unsaved changes; returns the request that was waiting for it, if it may go on now.
    pub(super) fn decide(&mut self) -> Option<FileRequest> {
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
