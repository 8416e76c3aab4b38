//! Overlay with the list of keys.

use super::{View, icons::Icon, segmented::icon_button};
use crate::{
    app::keys::{TABLE, When},
    snapshot::Snapshot,
};
use eframe::egui::{self, Align, Button, Context, Grid, Id, Key, Layout, Modal, RichText, ScrollArea, Ui, vec2};

pub fn show(ctx: &Context, now: &Snapshot, view: &mut View) {
    if !view.help {
        return;
    }
    let room = ctx.content_rect().size() - vec2(48.0, 96.0);
    let modal = Modal::new(Id::unique("keys")).show(ctx, |ui| {
        ui.set_width(room.x.min(460.0));
        ui.horizontal(|ui| {
            ui.label(RichText::new("Keys and mouse").heading());
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                if icon_button(ui, Icon::Close, "Close", "[Esc]", false).clicked() {
                    view.help = false;
                }
            });
        });
        ui.separator();
        ScrollArea::vertical()
            .max_height(room.y)
            .min_scrolled_height(room.y)
            .auto_shrink([false, true])
            .show(ui, |ui| table(ui, now, view));
    });
    if modal.backdrop_response.clicked() || ctx.input_mut(|input| input.consume_key(egui::Modifiers::NONE, Key::Escape))
    {
        view.help = false;
    }
}

fn table(ui: &mut Ui, now: &Snapshot, view: &mut View) {
    for group in When::ALL {
        ui.add_space(6.0);
        ui.label(RichText::new(group.title()).strong());
        Grid::new(group.title()).num_columns(2).min_col_width(72.0).spacing([12.0, 4.0]).show(ui, |ui| {
            for binding in TABLE.iter().filter(|binding| binding.when == group) {
                let cap = Button::new(RichText::new(binding.label).strong()).min_size(vec2(34.0, 22.0));
                let usable = !binding.shortcuts.is_empty() && group.applies(now);
                let cap = ui.add_enabled(usable, cap).accessible_name(format!("{}, {}", binding.label, binding.words));
                if cap.clicked() {
                    view.pressed.push(binding);
                }
                ui.label(binding.words);
                ui.end_row();
            }
        });
    }
}
