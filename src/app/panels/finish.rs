//! How a cloth looks: colours, pattern or image, and sheen.

use super::{FileRequest, View, apply_response, sliders};
use crate::{
    app::{language::tr, theme::Theme},
    command::Command,
    finish::{Colour, Finish, Pattern, Sheen},
    quantity::Quantity,
};
use eframe::egui::{Color32, ComboBox, Response, Ui};

/// Draws the controls of the finish of a net or membrane (by number: nets first); `candy` is the colour that the theme gives it.
pub fn show(ui: &mut Ui, number: usize, now: &Finish, candy: usize, view: &mut View, commands: &mut Vec<Command>) {
    let theme = Theme::of(ui.ctx());
    let mut finish = now.clone();
    let front = now.front.map_or(theme.candy[candy % 2], color);
    let (mut changed, mut ended) = (false, false);
    let mut note = |response: Response, name: &str, help: &str| {
        changed |= response.changed();
        ended |= response.drag_stopped();
        response.on_hover_text(tr(help)).accessible_name(name);
    };
    let has_image = now.image.is_some();
    ui.add_enabled_ui(!has_image, |ui| {
        ui.horizontal(|ui| {
            ui.label(tr("Colours"));
            note(pick(ui, &mut finish.front, front), "Front colour", "Colour of the front");
            if now.pattern == Pattern::Plain {
                let back = now.back.map_or(if now.front.is_some() { front } else { theme.icing }, color);
                note(pick(ui, &mut finish.back, back), "Back colour", "Colour of the back");
            } else {
                let second = now.second.map_or(theme.icing, color);
                note(pick(ui, &mut finish.second, second), "Second colour", "Second colour of the pattern");
            }
        })
    });
    let patterns = Pattern::ALL.map(|pattern| (pattern, pattern.name()));
    let sheens = Sheen::ALL.map(|sheen| (sheen, sheen.name()));
    ui.add_enabled_ui(!has_image, |ui| {
        choose(ui, ("Pattern", "What is printed or woven on both sides"), &mut finish.pattern, &patterns);
    });
    ui.horizontal(|ui| {
        ui.label(tr("Image"));
        if ui
            .button(tr("Open…"))
            .on_hover_text(tr("A PNG picture on both sides, in place of colours and pattern"))
            .accessible_name(tr("Open an image"))
            .clicked()
        {
            view.file = Some(FileRequest::OpenImage(number));
        }
        if has_image && ui.button(tr("Remove")).accessible_name(tr("Remove the image")).clicked() {
            (finish.image, ended) = (None, true);
        }
    });
    choose(ui, ("Sheen", "How it reflects light"), &mut finish.sheen, &sheens);
    ended |= (finish.pattern, finish.sheen) != (now.pattern, now.sheen);
    if now.pattern != Pattern::Plain && !has_image {
        let outcome = sliders(ui, [&mut finish.size as &mut dyn Quantity]);
        apply_response(outcome, Some(Command::SetFinish(number, finish.clone())), view, commands);
    }
    if changed || ended {
        commands.push(Command::SetFinish(number, finish));
    }
    if ended {
        commands.push(Command::EndGesture);
    }
}

const fn color(Colour([red, green, blue]): Colour) -> Color32 {
    Color32::from_rgb(red, green, blue)
}

/// A button that opens a picker of colours, and shows this one before.
fn pick(ui: &mut Ui, colour: &mut Option<Colour>, shown: Color32) -> Response {
    let mut rgb = [shown.r(), shown.g(), shown.b()];
    let response = ui.color_edit_button_srgb(&mut rgb);
    if response.changed() {
        *colour = Some(Colour(rgb));
    }
    response
}

/// A menu of kinds.
fn choose<T: Copy + PartialEq>(ui: &mut Ui, (label, help): (&str, &str), now: &mut T, all: &[(T, &str)]) {
    let name = all.iter().find(|(kind, _)| kind == now).map_or("", |(_, name)| name);
    ui.horizontal(|ui| {
        ui.label(tr(label));
        let menu = ComboBox::from_id_salt(label).width(ui.available_width()).selected_text(tr(name));
        let response = menu.show_ui(ui, |ui| {
            for (kind, name) in all {
                ui.selectable_value(now, *kind, tr(name));
            }
        });
        response.response.on_hover_text(tr(help)).accessible_name(tr(label));
    });
}
