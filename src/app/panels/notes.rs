//! The notes of the level: their texts, which can be changed, and a button that removes each.

use super::{PanelContext, View, heading_here};
use crate::{app::language::tr, command::Command, level::Note};
use eframe::egui::{Align, Layout, TextEdit, Ui};

/// Draws the notes, if there are any. The text of one that was just placed takes the keyboard.
pub fn show(ui: &mut Ui, context: &PanelContext<'_>, view: &mut View, commands: &mut Vec<Command>) {
    let notes = &context.now.level.notes;
    let is_new = std::mem::take(&mut view.has_new_note);
    if notes.is_empty() {
        return;
    }
    ui.add_space(6.0);
    heading_here(ui, "Notes");
    for (number, note) in notes.iter().enumerate() {
        ui.horizontal(|ui| {
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                let name = format!("note {}", number + 1);
                let button = ui.small_button(tr("Remove")).on_hover_text(tr("Removes the note."));
                if button.accessible_name(format!("Remove {name}")).clicked() {
                    let mut others = notes.clone();
                    others.remove(number);
                    commands.extend([Command::SetNotes(others), Command::EndGesture]);
                }
                let mut text = note.text.clone();
                let edit =
                    ui.add(TextEdit::singleline(&mut text).char_limit(Note::LONGEST).desired_width(f32::INFINITY));
                let edit = edit.accessible_name(format!("Text of {name}"));
                if is_new && number + 1 == notes.len() {
                    edit.request_focus();
                    edit.scroll_to_me(Some(Align::Center));
                }
                if edit.changed() {
                    let mut all = notes.clone();
                    all[number].text = text;
                    commands.push(Command::SetNotes(all));
                }
                if edit.lost_focus() {
                    commands.push(Command::EndGesture);
                }
            });
        });
    }
}
