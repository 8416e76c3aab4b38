//! Unsaved changes: detects them and asks before they are lost.

use super::{
    App,
    dialogs::{Purpose, stem},
    panels::{Choice, FileRequest, Unsaved},
};
use eframe::egui::{Context, ViewportCommand};

impl App {
    /// Whether the level of either pane differs from the opened or saved one. Stepping is no change: it can be repeated.
    pub fn is_unsaved(&self) -> bool {
        let b = self.comparison.as_ref().map(|panes| panes.sandbox());
        std::iter::once(&self.sandbox).chain(b).any(|sandbox| *sandbox.document() != self.kept)
    }

    /// Marks the present document as saved.
    pub(super) fn mark_kept(&mut self) {
        self.kept = self.settled().document().clone();
    }

    /// Cancels a request to close the window while there are unsaved changes, and asks about them.
    pub(super) fn take_close_request(&mut self, ctx: &Context) {
        let requested = ctx.input(|input| input.viewport().close_requested());
        if requested && !self.leaves && self.is_unsaved() {
            // A minimized window could not show the dialog.
            for command in [ViewportCommand::CancelClose, ViewportCommand::Minimized(false), ViewportCommand::Focus] {
                ctx.send_viewport_cmd(command);
            }
            self.view.file = Some(FileRequest::Close);
        }
    }

    /// Returns the request, or shows the dialog first if the request would lose changes.
    pub(super) fn request_or_ask(&mut self, request: FileRequest) -> Option<FileRequest> {
        if request.replaces_level() && self.is_unsaved() {
            self.view.unsaved = Some(Unsaved { request, choice: None });
            return None;
        }
        Some(request)
    }

    /// Carries out the choice about unsaved changes. Returns the waiting request if it can continue now.
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
