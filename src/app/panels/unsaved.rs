//! Dialog about unsaved changes.

use super::{FileRequest, View};
use eframe::egui::{Button, Context, Id, Modal, RichText, vec2};

/// Dialog about unsaved changes that a request would lose.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unsaved {
    /// Request that waits for the choice.
    pub request: FileRequest,
    /// Choice, once it is made.
    pub choice: Option<Choice>,
}

/// Choices for unsaved changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Choice {
    /// The changes are saved, then the request is carried out.
    Save,
    /// The changes are lost and the request is carried out.
    Discard,
    /// Nothing changes.
    Cancel,
}

pub fn show(ctx: &Context, name: &str, view: &mut View) {
    let Some(unsaved) = view.unsaved.as_mut().filter(|unsaved| unsaved.choice.is_none()) else { return };
    let modal = Modal::new(Id::unique("unsaved")).show(ctx, |ui| {
        ui.set_width((ctx.content_rect().width() - 48.0).min(420.0));
        ui.label(RichText::new("Save the changes?").heading());
        let then = match unsaved.request {
            FileRequest::Close => "If the window closes now, they are lost.",
            _ => "If another level is opened now, they are lost.",
        };
        let name = if name.is_empty() { "This level" } else { name };
        ui.label(format!("{name} has changes that are not saved. {then}"));
        ui.add_space(6.0);
        ui.horizontal(|ui| {
            let choices = [
                (Choice::Save, "Save", "Asks for a file, saves, and goes on. [Enter]"),
                (Choice::Discard, "Discard", "Goes on without saving. [Tab, Enter]"),
                (Choice::Cancel, "Cancel", "Everything stays as it is. [Esc]"),
            ];
            for (choice, words, help) in choices {
                let button = ui.add(Button::new(words).min_size(vec2(84.0, 28.0))).on_hover_text(help);
                if choice == Choice::Save && ui.memory(|memory| memory.focused().is_none()) {
                    button.request_focus();
                }
                if button.clicked() {
                    unsaved.choice = Some(choice);
                }
            }
        });
    });
    if modal.should_close() && unsaved.choice.is_none() {
        unsaved.choice = Some(Choice::Cancel);
    }
}
