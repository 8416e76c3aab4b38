//! Pictures of the stage without a window: egui draws it, and its triangles are filled on the processor. The same scene gives the same
//! bytes on every machine.

use super::{
    arrows::{ArrowKind, Arrows},
    canvas::{Canvas, Look, Options, Viewpoint},
    raster::{Raster, Texture},
    theme,
};
use crate::{link, picture::Picture, sandbox::Sandbox, snapshot::Snapshot};
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
    /// Size \[points\], and pixels of the picture along a side of a point.
    size: [usize; 2],
    scale: usize,
    time: f64,
}

impl Stage {
    /// Draws the loads that act now on edges of a scene.
    pub fn follow_loads(&mut self, sandbox: &Sandbox) {
        let mut arrows = Arrows::default();
        arrows.follow(ArrowKind::None, sandbox);
        self.canvas.set_arrows(&arrows);
    }

    /// Time that passes for a stage before its first picture, in which everything on it takes its place \[s\].
    const SETTLING: f64 = 10.0;

    /// A stage by night or by day, of a size \[points\], with so many pixels along a side of a point.
    pub fn new((size, scale): ([usize; 2], usize), is_dark: bool, options: Options) -> Self {
        let context = Context::default();
        theme::install(&context);
        context.set_theme(if is_dark { Theme::Dark } else { Theme::Light });
        let canvas = Canvas::default();
        Self {
            context,
            canvas,
            options: Options { bare: true, ..options },
            textures: HashMap::new(),
            size,
            scale,
            time: 0.0,
        }
    }

    /// Sees the scene from another viewpoint.
    pub const fn see_from(&mut self, viewpoint: Viewpoint) {
        self.canvas.see_from(viewpoint);
    }

    /// Sees the next scene as a link says.
    pub fn look_from(&mut self, camera: link::Camera) {
        self.canvas.look(Look::From(camera));
    }

    /// Draws with other options.
    pub const fn set_options(&mut self, options: Options) {
        self.options = Options { bare: true, ..options };
    }

    /// The first picture of a snapshot.
    pub fn first_picture(&mut self, snapshot: &Snapshot) -> Picture {
        self.picture(snapshot, Self::SETTLING);
        self.picture(snapshot, 0.0)
    }

    /// A picture of a snapshot, so much time after the one before \[s\].
    pub fn picture(&mut self, snapshot: &Snapshot, passed: f64) -> Picture {
        self.time += passed;
        let [width, height] = self.size.map(|points| points as f32);
        let (fine, finer) = (FINER * self.scale, (FINER * self.scale) as f32);
        let viewport = ViewportInfo { native_pixels_per_point: Some(finer), ..ViewportInfo::default() };
        let input = RawInput {
            screen_rect: Some(Rect::from_min_max(pos2(0.0, 0.0), (vec2(width, height)).to_pos2())),
            viewports: std::iter::once((ViewportId::ROOT, viewport)).collect(),
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
        let mut raster = Raster::new(self.size.map(|points| fine * points));
        for shape in self.context.tessellate(output.shapes, finer) {
            // A stage has no callbacks.
            let Primitive::Mesh(mesh) = &shape.primitive else { continue };
            if let Some(texture) = self.textures.get(&mesh.texture_id) {
                raster.fill(mesh, texture, shape.clip_rect, finer);
            }
        }
        for id in &output.textures_delta.free {
            self.textures.remove(id);
        }
        output.textures_delta.clear();
        Picture { size: self.size.map(|points| self.scale * points), rgba: raster.coarser(FINER) }
    }
}
