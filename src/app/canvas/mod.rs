//! The stage: draws a snapshot and translates pointer input to commands. It does not know the simulation.

mod pointer_state;
mod scenery;
#[cfg(test)]
mod tests;

use super::{
    colour::{self, Scale},
    draw::{
        Camera, View,
        body::Bodies,
        house::{self, Snow},
        legends,
        marks::{self, Picked, Pins},
        net::{self, Trail},
        shape_buffer::{Fill, ShapeBuffer},
    },
    theme::Theme,
};
use crate::{
    command::{Command, Mode},
    snapshot::{Field, Snapshot},
};
use eframe::egui::{
    self, Align2, Area, CursorIcon, Order, Painter, Pos2, Rect, Response, Role, Sense, Ui, WidgetInfo, vec2,
};
use pointer_state::PointerState;
use scenery::Scenery;
use std::time::Duration;

/// Maximum frame length for animations [s].
const LONGEST_FRAME: f32 = 0.1;

/// Duration of the hint after a drag in edit mode [s].
const TOLD: f64 = 5.0;

/// Text of the hint after a drag in edit mode.
const NOTHING_MOVES: &str =
    "Nothing moves in edit mode, and a click pins. To drag: press Space or M to let time run, then drag.";

/// Display options of the stage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// Field that colours the triangles, once the snapshot has its values.
    pub field: Field,
    /// Whether the edges of triangles are drawn.
    pub wireframe: bool,
    /// Whether the vertices are drawn.
    pub vertices: bool,
    /// Solid whose sliders are under the pointer: number of its effect, and number of the solid in it.
    pub pointed: Option<[usize; 2]>,
    /// Accessible name of the stage, where there are two.
    pub name: &'static str,
}

/// The stage with its state between frames; none of it is physics.
#[derive(Default)]
pub struct Canvas {
    pointer_state: PointerState,
    bodies: Bodies,
    trail: Trail,
    pins: Pins,
    picked: Picked,
    scale: Scale,
    scenery: Scenery,
    snow: Snow,
    /// Time until which the hint is shown [s].
    told_until: f64,
    /// Layers of the drawing: background and scenery, bodies, and annotations.
    behind: ShapeBuffer,
    middle: ShapeBuffer,
    front: ShapeBuffer,
}

/// Data for drawing a frame.
#[derive(Clone, Copy)]
struct Frame<'a> {
    snapshot: &'a Snapshot,
    options: &'a Options,
    canvas: Rect,
    view: View,
    /// Present time and length of the frame [s].
    now: f64,
    dt: f32,
}

impl Canvas {
    /// Fills the rest of `ui` with the stage and appends the commands of the pointer to `commands`.
    pub fn show(&mut self, ui: &mut Ui, snapshot: &Snapshot, options: &Options, commands: &mut Vec<Command>) {
        let (response, painter) = ui.allocate_painter(ui.available_size(), Sense::CLICK | Sense::DRAG);
        describe(&response, snapshot, options.name);
        let canvas = response.rect;
        let camera = camera(snapshot, canvas);
        let view = View { camera, theme: Theme::of(ui.ctx()) };
        let (now, dt) = ui.input(|input| (input.time, input.stable_dt.min(LONGEST_FRAME)));
        let frame = Frame { snapshot, options, canvas, view, now, dt };

        self.bodies.place(snapshot, view);
        let before = self.pointer_state;
        self.pointer_state.follow(&response, snapshot, camera, self.bodies.points(), commands);
        if before.is_dragged(ui.input(|input| input.pointer.interact_pos())) {
            self.told_until = now + TOLD;
        }
        self.tell(&response, snapshot, now);
        self.animate(&response, &frame);
        if ui.is_rect_visible(canvas) {
            self.draw(&painter, &frame, response.hover_pos());
        }
    }

    /// Shows a hint after a drag in edit mode, where nothing moves.
    fn tell(&mut self, response: &Response, snapshot: &Snapshot, now: f64) {
        if snapshot.mode != Mode::Edit {
            self.told_until = 0.0;
        }
        let left = self.told_until - now;
        if left <= 0.0 {
            return;
        }
        let (ctx, stage) = (&response.ctx, response.rect);
        ctx.request_repaint_after(Duration::from_secs_f64(left));
        let place = stage.center_bottom() - vec2(0.0, 14.0);
        let area = Area::new(response.id.with("told")).order(Order::Foreground).interactable(false);
        area.pivot(Align2::CENTER_BOTTOM).fixed_pos(place).constrain_to(stage).show(ctx, |ui| {
            ui.set_max_width((stage.width() - 40.0).min(440.0));
            egui::Frame::window(ui.style()).inner_margin(10).show(ui, |ui| ui.label(NOTHING_MOVES));
        });
    }

    fn animate(&mut self, response: &Response, frame: &Frame<'_>) {
        let (snapshot, dt) = (frame.snapshot, frame.dt);
        let live = snapshot.running && snapshot.mode != Mode::Edit && !snapshot.is_asleep();
        let wanted = match self.pointer_state.vertex() {
            Some(vertex) => Some(vertex),
            None if self.pointer_state.is_free() => {
                response.hover_pos().and_then(|at| pointer_state::nearest(self.bodies.points(), at))
            }
            None => None,
        };
        self.picked.follow(wanted, dt);
        self.pins.follow(snapshot, frame.now);
        self.scenery.follow(snapshot, dt);
        self.scale.follow(snapshot, dt);
        self.trail.follow(snapshot);
        if live {
            self.snow.fall(dt);
        }
        let moving = self.picked.is_moving()
            || self.pins.is_moving(frame.now)
            || self.scenery.is_moving()
            || self.scale.is_moving();
        if live || moving {
            response.ctx.request_repaint();
        }
        if wanted.is_some() {
            let pulling = self.pointer_state.is_pulling();
            let free = if snapshot.mode == Mode::Edit { CursorIcon::PointingHand } else { CursorIcon::Grab };
            response.ctx.set_cursor_icon(if pulling { CursorIcon::Grabbing } else { free });
        }
    }

    fn draw(&mut self, painter: &Painter, frame: &Frame<'_>, pointer: Option<Pos2>) {
        let Frame { snapshot, options, canvas, view, .. } = *frame;
        let pixels_per_point = painter.pixels_per_point();
        self.behind.clear(pixels_per_point);
        house::sky(&mut self.behind, canvas, view);
        self.snow.draw(&mut self.behind, canvas, view);
        painter.add(self.behind.finish());
        house::square(painter, view, 1.0 - self.scenery.room_presence());
        painter.add(self.scenery.draw(pixels_per_point, canvas, view, options.pointed));

        self.middle.clear(pixels_per_point);
        let mut fill = Fill::new(canvas);
        self.bodies.draw((&mut self.middle, &mut fill), view, snapshot, options, &self.scale);
        net::nets((&mut self.middle, &mut fill), view, snapshot, options, self.bodies.points());
        self.trail.draw(&mut self.middle, view, snapshot);
        painter.add(self.middle.finish());
        // A slightly larger clip rectangle, which changes nothing visible, makes the tessellator begin a new mesh here. Otherwise it
        // would move the large mesh to a larger buffer in every frame.
        let mut painter = painter.clone();
        painter.set_clip_rect(painter.clip_rect().expand(0.01));
        legends::strip_numbers(&painter, view, canvas, snapshot);
        self.draw_front(&painter, frame, pointer);
    }

    fn draw_front(&mut self, painter: &Painter, frame: &Frame<'_>, pointer: Option<Pos2>) {
        let Frame { snapshot, options, canvas, view, now, .. } = *frame;
        let points = self.bodies.points();
        self.front.clear(painter.pixels_per_point());
        let free = pointer.filter(|_| self.pointer_state.is_free());
        self.picked.draw(&mut self.front, view, points, free);
        marks::rollers(&mut self.front, view, snapshot, points);
        self.pins.draw(&mut self.front, view, points, now);
        let pull = snapshot.pull.as_ref().and_then(|pull| Some((pull, *points.get(pull.vertex)?)));
        if let Some((pull, from)) = pull {
            marks::arrow(&mut self.front, view, from, pull);
        }
        if options.field != Field::None && options.field == snapshot.field && !snapshot.triangles.is_empty() {
            legends::colour_bar(painter, &mut self.front, view, canvas, snapshot.field, &self.scale);
            let under = free.and_then(|at| Some((at, self.bodies.value_at(snapshot, at)?)));
            if let Some((at, value)) = under {
                legends::reading(painter, view, canvas, at, snapshot.field, colour::reading(snapshot, value));
            }
        }
        painter.add(self.front.finish());
        if let Some((pull, from)) = pull {
            marks::pull_force(painter, view, canvas, from, pull);
        }
    }
}

/// Describes the stage for screen readers and tests.
fn describe(response: &Response, snapshot: &Snapshot, name: &str) {
    let name = if name.is_empty() { "Stage" } else { name };
    response.widget_info(|| WidgetInfo::labeled(Role::Canvas, true, name));
    response.ctx.accesskit_node_builder(response.id, |node| {
        let nets = snapshot.nets.iter().map(|net| net.name.as_str());
        let toy = snapshot.level.toy.iter().map(|toy| toy.kind().title());
        let bodies: Vec<&str> = snapshot.bodies.iter().map(|body| body.name.as_str()).chain(nets).chain(toy).collect();
        let (vertices, pins) = (snapshot.positions.len() / 2, snapshot.pins.len());
        node.set_description(format!("stage: {}; {vertices} vertices, {pins} pinned", bodies.join(", ")));
    });
}

/// Camera of a stage that fills `canvas`; tests use it to point at vertices from outside.
pub fn camera(snapshot: &Snapshot, canvas: Rect) -> Camera {
    Camera::new(canvas, snapshot.width.max(1.0) as f32, legends::strip_height(snapshot, canvas))
}

/// Makes two canvases show equal values in equal colours.
pub fn share_scale(a: &mut Canvas, b: &mut Canvas) {
    a.scale.heed(Some(&b.scale));
    b.scale.heed(Some(&a.scale));
}

impl Canvas {
    /// Scales the colours by the canvas's own values alone.
    pub fn unshare_scale(&mut self) {
        self.scale.heed(None);
    }
}
