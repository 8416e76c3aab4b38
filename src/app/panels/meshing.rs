//! Progress of meshing in the background, with a cancel button.

use super::{View, count};
use eframe::egui::{Align2, Area, Context, Frame, Id, Order, Rect, Spinner, vec2};

pub fn show(ctx: &Context, stage: Rect, view: &mut View) {
    let Some(progress) = &view.meshing else { return };
    let text = format!("Meshing about {} triangles: {:.0} s", count(progress.triangles), progress.seconds);
    let corner = stage.center_bottom() - vec2(0.0, 12.0);
    let area = Area::new(Id::unique("meshing")).order(Order::Foreground).pivot(Align2::CENTER_BOTTOM).fixed_pos(corner);
    area.constrain_to(stage).show(ctx, |ui| {
        Frame::window(ui.style()).inner_margin(10).show(ui, |ui| {
            ui.horizontal(|ui| {
                ui.add(Spinner::new().size(18.0));
                ui.label(text);
                let help = "The mesh stays as it is. What is computed already is dropped.";
                view.cancel_mesh = ui.button("Cancel meshing").on_hover_text(help).clicked();
            });
        });
    });
}
