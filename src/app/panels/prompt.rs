//! Text input where there are no native file dialogs.

use super::View;
use crate::app::files::Purpose;
use eframe::egui::{self, Context, Id, Key, Modal, RichText, TextEdit, vec2};

/// State of a text input.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Prompt {
    /// Purpose of the requested file.
    pub purpose: Purpose,
    /// Typed text.
    pub text: String,
    /// Whether the answer was confirmed.
    pub answered: bool,
}

/// Whether files are named by a path. In a browser the text of the level itself is pasted.
const PATHS: bool = cfg!(not(target_arch = "wasm32"));

pub fn show(ctx: &Context, view: &mut View) {
    let Some(prompt) = &mut view.prompt else { return };
    let mut closed = false;
    let modal = Modal::new(Id::unique("prompt")).show(ctx, |ui| {
        ui.set_width((ctx.content_rect().width() - 48.0).min(420.0));
        let verb = if prompt.purpose == Purpose::Open { "Open" } else { "Save" };
        ui.label(RichText::new(prompt.purpose.title()).heading());
        let question =
            if PATHS { "There is no file dialog on this system. Path of the file:" } else { "Paste a level:" };
        ui.label(question);
        let edit = if PATHS { TextEdit::singleline(&mut prompt.text) } else { TextEdit::multiline(&mut prompt.text) };
        let field = ui.add(edit.desired_width(f32::INFINITY).hint_text("my-level.ron")).accessible_name("File");
        let entered = PATHS && field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
        if !prompt.answered && ui.memory(|memory| memory.focused().is_none()) {
            field.request_focus();
        }
        ui.add_space(6.0);
        ui.horizontal(|ui| {
            let ready = !prompt.text.trim().is_empty();
            let button = egui::Button::new(verb).min_size(vec2(72.0, 26.0));
            let pressed = ui.add_enabled(ready, button).clicked();
            prompt.answered |= ready && (pressed || entered);
            closed |= ui.button("Cancel").clicked();
        });
    });
    if closed || modal.should_close() && !prompt.answered {
        view.prompt = None;
    }
}
