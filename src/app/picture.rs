//! Pictures of the stage without a window: egui draws it, and its triangles are filled on the processor. The same scene gives the same
//! bytes on every machine.

use super::{
    canvas::{Canvas, Options},
    raster::{Raster, Texture},
    theme,
};
use crate::snapshot::Snapshot;
use eframe::egui::{
    Context, RawInput, Rect, TextureId, Theme, ViewportId, ViewportInfo, epaint::Primitive, pos2, vec2,
};
use std::collections::HashMap;

/// Pixels of the raster along a side of a pixel of the picture: edges are smooth by their means.
const FINER: usize = 2;

/// A stage that is drawn into pictures, one after another.
pub struct Stage {
    context: Context,
    canvas: Canvas,
    options: Options,
    textures: HashMap<TextureId, Texture>,
    size: [usize; 2],
    time: f64,
}

impl Stage {
    /// A stage by night or by day, of a size \[pixels\].
    pub fn new(size: [usize; 2], is_dark: bool, options: Options) -> Self {
        let context = Context::default();
        theme::install(&context);
        context.set_theme(if is_dark { Theme::Dark } else { Theme::Light });
        let canvas = Canvas::default();
        Self { context, canvas, options: Options { bare: true, ..options }, textures: HashMap::new(), size, time: 0.0 }
    }

    /// A picture of a snapshot, so much time after the one before \[s\]: rows from the top, four bytes a pixel: red, green, blue and 255.
    pub fn picture(&mut self, snapshot: &Snapshot, passed: f64) -> Vec<u8> {
        self.time += passed;
        let [width, height] = self.size.map(|pixels| pixels as f32);
        let finer = ViewportInfo { native_pixels_per_point: Some(FINER as f32), ..ViewportInfo::default() };
        let input = RawInput {
            screen_rect: Some(Rect::from_min_max(pos2(0.0, 0.0), (vec2(width, height)).to_pos2())),
            viewports: std::iter::once((ViewportId::ROOT, finer)).collect(),
            time: Some(self.time),
            predicted_dt: passed as f32,
            ..RawInput::default()
        };
        let (canvas, options) = (&mut self.canvas, &self.options);
        let mut output = self.context.run_ui(input, |ui| canvas.show(ui, snapshot, options, &mut Vec::new()));
        for (id, changes) in &output.textures_delta.set {
            let texture = self.textures.entry(*id).or_default();
            changes.iter().for_each(|change| texture.change(change));
        }
        let mut raster = Raster::new(self.size.map(|pixels| FINER * pixels));
        for shape in self.context.tessellate(output.shapes, FINER as f32) {
            // A stage has no callbacks.
            let Primitive::Mesh(mesh) = &shape.primitive else { continue };
            if let Some(texture) = self.textures.get(&mesh.texture_id) {
                raster.fill(mesh, texture, shape.clip_rect, FINER as f32);
            }
        }
        for id in &output.textures_delta.free {
            self.textures.remove(id);
        }
        output.textures_delta.clear();
        raster.coarser(FINER)
    }
}
