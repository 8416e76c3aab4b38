//! The stage: draws a snapshot and translates pointer input to commands. It does not know the simulation.

mod arranging;
mod drag;
mod drawing;
mod drawn_path;
mod enclosure;
mod look;
mod notes;
mod pointer_state;
mod probing;
mod refining;
mod ruler;
mod scenery;
mod tool;
pub use look::{Look, Viewpoint};
pub(super) use pointer_state::nearest as nearest_on_screen;
pub use probing::ProbeMark;
pub use ruler::Measured;
pub use tool::Tool;
#[cfg(test)]
mod tests;

use super::{
    arrows::{ArrowKind, Arrows},
    colour::{self, Scale},
    draw::{
        Camera, View, arrows,
        body::Bodies,
        ghost::{EarlierShape, Ghost},
        house::{self, Snow},
        legends,
        marks::{self, Picked, Pins},
        net::{self, Trail},
        shape_buffer::{Fill, ShapeBuffer},
        space::{self, SpaceCamera, Surfaces},
    },
    probes::Target,
    theme::Theme,
};
use crate::{
    command::{Command, Mode, Spot},
    impulse::Impulse,
    snapshot::{Field, Pull, Snapshot},
};
use arranging::Arranging;
use drawing::Drawing;
use drawn_path::DrawnPath;
use eframe::egui::{
    self, Align2, Area, CursorIcon, FocusDirection, Key, Order, Painter, PointerButton, Pos2, Rect, Response, Role,
    Sense, Ui, Vec2, WidgetInfo, vec2,
};
use enclosure::{Around, Enclosure};
use look::{Looking, Seen};
use pointer_state::{PointerState, Sight};
use probing::Probing;
use refining::Refining;
use ruler::{Mark, Ruler};
use scenery::{Scenery, WIRE};
use std::{ops::Range, time::Duration};

/// Maximum frame length for animations \[s\].
const LONGEST_FRAME: f32 = 0.1;

/// Duration of the hint after a drag in edit mode \[s\].
const TOLD: f64 = 5.0;

/// Text of the hint after a drag in edit mode.
const NOTHING_MOVES: &str = "Nothing moves in edit mode, and a click pins. To drag: press Space or M to let time run, then drag. A drag with Shift pins what is in a box.";

/// Display options of the stage.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Options {
    /// Field that colours the triangles, once the snapshot has its values.
    pub field: Field,
    /// A field whose colours have a held range, and the distance of its ends from the value at rest.
    pub held: Option<(Field, f64)>,
    /// Whether the edges of triangles are drawn.
    pub wireframe: bool,
    /// Whether surfaces in space are coloured by the directions of their normals.
    pub normals: bool,
    /// Whether the vertices are drawn.
    pub vertices: bool,
    /// What arrows show.
    pub arrows: ArrowKind,
    /// Solid whose sliders are under the pointer: number of its effect, and number of the solid in it.
    pub pointed: Option<[usize; 2]>,
    /// What a click or a drag does.
    pub tool: Tool,
    /// Whether the stage is drawn without its buttons.
    pub bare: bool,
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
    surfaces: Surfaces,
    /// Its size in the last frame [points].
    size: Vec2,
    /// From where the scene is seen.
    looking: Looking,
    probing: Probing,
    drawing: Drawing,
    enclosure: Enclosure,
    drawn_path: DrawnPath,
    refining: Refining,
    arranging: Arranging,
    ruler: Ruler,
    /// Where the drag of a push began.
    push_from: Option<Pos2>,
    /// The tool that was chosen on the stage.
    chosen_tool: Option<Tool>,
    ghost: Ghost,
    arrows: Arrows,
    /// Earlier shape that is drawn too.
    earlier: Option<EarlierShape>,
    /// Time until which the hint is shown \[s\].
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
    /// Camera of a scene in space.
    space: Option<SpaceCamera>,
    /// Present time and length of the frame \[s\].
    now: f64,
    dt: f32,
}

impl Canvas {
    /// Fills the rest of `ui` with the stage and appends the commands of the pointer to `commands`.
    pub fn show(&mut self, ui: &mut Ui, snapshot: &Snapshot, options: &Options, commands: &mut Vec<Command>) {
        let (response, painter) = ui.allocate_painter(ui.available_size(), Sense::CLICK | Sense::DRAG);
        describe(&response, snapshot, options.name);
        let canvas = response.rect;
        self.size = canvas.size();
        let part = response.hover_pos().and_then(|at| self.part_at(snapshot, at));
        let scene = Seen { snapshot, part: part.as_ref(), bare: options.bare, tool: options.tool };
        let space = (snapshot.dimension == 3).then(|| self.looking.follow_space(ui, &response, scene));
        let camera = match space {
            Some(space) => Camera::of_scale(canvas, space.length()),
            None => self.looking.follow_plane(ui, &response, scene, camera(snapshot, canvas)),
        };
        let view = View { camera, theme: Theme::of(ui.ctx()) };
        let (now, dt) = ui.input(|input| (input.time, input.stable_dt.min(LONGEST_FRAME)));
        let frame = Frame { snapshot, options, canvas, view, space, now, dt };

        if let Some(space) = &space {
            self.surfaces.place(snapshot, space, self.bodies.points_mut());
        } else {
            self.bodies.place(snapshot, view);
        }
        let before = self.pointer_state;
        let sight = sight(&frame, &self.surfaces);
        let picked = self.picked_target(&response, &frame);
        self.probing.found = picked.or(self.probing.found);
        let tool = if space.is_some() && options.tool == Tool::Outline { Tool::Hand } else { options.tool };
        let points = self.bodies.points();
        self.drawing.follow(&response, camera, tool == Tool::Outline);
        self.ruler.follow(&response, sight, (snapshot, points), tool == Tool::Ruler);
        let around = around(ui, snapshot, tool);
        commands.extend(self.enclosure.follow(&response, around, (snapshot, points)));
        let under = self.pointed_triangle(&response, &frame).filter(|_| tool == Tool::Refine);
        commands.extend(self.refining.follow(&response, tool == Tool::Refine, snapshot, under));
        let arranges = tool == Tool::Arrange && snapshot.level.test.is_none();
        if let Some(change) =
            self.arranging.follow(&response, arranges, (snapshot, sight), &|at| self.bodies.triangle_at(snapshot, at))
        {
            commands.extend([change, Command::EndGesture]);
        }
        commands.extend(self.note(&response, &frame).filter(|_| tool == Tool::Note));
        commands.extend(self.drawn_path.follow(&response, tool == Tool::DrawnPath, snapshot, (sight, points)));
        let opens =
            [self.enclosure.is_open(), self.refining.is_open(), self.drawn_path.is_open(), self.arranging.is_open()];
        if opens.contains(&true) {
            self.pointer_state.spend();
        }
        if tool == Tool::Hand {
            self.pointer_state.follow(&response, snapshot, sight, points, commands);
        }
        commands.extend(self.impulse(&response, &frame).map(Command::Impulse));
        self.chosen_tool = self.looking.take_tool().or(self.chosen_tool);
        if !self.enclosure.is_open() && before.is_dragged(ui.input(|input| input.pointer.interact_pos())) {
            self.told_until = now + TOLD;
        }
        self.tell(&response, snapshot, (now, tool));
        self.animate(&response, &frame);
        if ui.is_rect_visible(canvas) {
            self.draw(&painter, &frame, response.hover_pos());
        }
    }

    /// Its size in the last frame [points].
    pub const fn size(&self) -> Vec2 {
        self.size
    }

    /// From where the scene is seen.
    pub const fn viewpoint(&self) -> Viewpoint {
        self.looking.viewpoint()
    }

    /// Sees the scene from the viewpoint of another canvas.
    pub const fn see_from(&mut self, viewpoint: Viewpoint) {
        self.looking.see_from(viewpoint);
    }

    /// Changes the view in the next frame.
    pub fn look(&mut self, look: Look) {
        self.looking.ask(look);
    }

    /// Camera of a scene in the plane as it is seen now, if the stage fills `stage`.
    pub fn camera(&self, snapshot: &Snapshot, stage: Rect) -> Camera {
        self.looking.plane(camera(snapshot, stage), stage)
    }

    /// Shows the marks of probes, and says whether what is under the pointer is probed in the next frame.
    pub fn set_probes(&mut self, marks: Vec<ProbeMark>, now: bool) {
        self.probing = Probing { marks, now, found: self.probing.found };
    }

    /// What the ruler measures now, if it has two points.
    pub fn measured(&self, snapshot: &Snapshot) -> Option<Measured> {
        self.ruler.measured(snapshot)
    }

    /// Removes the points of the ruler.
    pub fn clear_ruler(&mut self) {
        self.ruler.clear();
    }

    /// Draws an earlier shape too, or none.
    pub fn set_earlier(&mut self, earlier: Option<EarlierShape>) {
        self.earlier = earlier;
    }

    /// Draws these arrows from now on.
    pub fn set_arrows(&mut self, arrows: &Arrows) {
        self.arrows.clone_from(arrows);
    }

    /// The outline that was drawn since the last call \[m\], with the length of a point of the screen \[m\].
    pub const fn take_outline(&mut self) -> Option<(Vec<[f64; 2]>, f64)> {
        self.drawing.take()
    }

    /// The tool that was chosen on the stage since the last call.
    pub const fn take_tool(&mut self) -> Option<Tool> {
        self.chosen_tool.take()
    }

    /// The body, net or membrane that was chosen on the stage since the last call, by its number in this order.
    pub const fn take_part(&mut self) -> Option<usize> {
        self.arranging.take_part()
    }

    /// What was probed since the last call.
    pub const fn take_target(&mut self) -> Option<Target> {
        self.probing.found.take()
    }

    /// What is probed in this frame.
    fn picked_target(&self, response: &Response, frame: &Frame<'_>) -> Option<Target> {
        let clicked = frame.options.tool == Tool::Probe && response.clicked();
        let at = response.hover_pos().filter(|_| self.probing.now || clicked)?;
        let (snapshot, points) = (frame.snapshot, self.bodies.points());
        let vertex = sight(frame, &self.surfaces).nearest(points, at);
        probing::target(snapshot, points, at, (self.triangle_at(frame, at), vertex))
    }

    /// The note that a click places.
    fn note(&self, response: &Response, frame: &Frame<'_>) -> Option<Command> {
        let at = response.interact_pointer_pos().filter(|_| response.clicked_by(PointerButton::Primary))?;
        let spot = match ruler::mark(sight(frame, &self.surfaces), self.bodies.points(), at)? {
            Mark::Vertex(vertex) => Spot::Vertex(vertex),
            Mark::Place([x, y]) => Spot::Place([x, y, 0.0]),
        };
        Some(Command::AddNote(spot))
    }

    /// The triangle at a point of the screen.
    fn triangle_at(&self, frame: &Frame<'_>, at: Pos2) -> Option<usize> {
        match frame.space {
            Some(_) => self.surfaces.triangle_at(self.bodies.points(), at),
            None => self.bodies.triangle_at(frame.snapshot, at),
        }
    }

    /// The triangle under the pointer.
    fn pointed_triangle(&self, response: &Response, frame: &Frame<'_>) -> Option<usize> {
        response.interact_pointer_pos().and_then(|at| self.triangle_at(frame, at))
    }

    /// Vertices of the part whose vertex was nearest to a point of the screen in the last frame.
    fn part_at(&self, snapshot: &Snapshot, at: Pos2) -> Option<Range<usize>> {
        let vertex = nearest_on_screen(self.bodies.points(), at)?;
        let nets = snapshot.nets.iter().map(|net| &net.vertices);
        let membranes = snapshot.membranes.iter().map(|membrane| &membrane.vertices);
        let mut all = snapshot.bodies.iter().map(|body| &body.vertices).chain(nets).chain(membranes);
        all.find(|vertices| vertices.contains(&vertex)).cloned()
    }

    /// The impulse that a key gives what is near the pointer, or a tool what is near a click or a drag.
    fn impulse(&mut self, response: &Response, frame: &Frame<'_>) -> Option<Impulse> {
        const PUSHES: [(Key, Vec2); 4] = [
            (Key::ArrowLeft, vec2(-1.0, 0.0)),
            (Key::ArrowRight, vec2(1.0, 0.0)),
            (Key::ArrowUp, vec2(0.0, -1.0)),
            (Key::ArrowDown, vec2(0.0, 1.0)),
        ];
        let (ctx, snapshot) = (&response.ctx, frame.snapshot);
        let drawn = self.drawn_impulse(response, frame.options.tool);
        let free = snapshot.mode != Mode::Edit && self.pointer_state.is_free();
        let by_key = || {
            let at = response.hover_pos()?;
            let pressed = |key: Key| ctx.input(|input| input.modifiers.is_none() && input.key_pressed(key));
            let push = PUSHES.into_iter().find(|(key, _)| pressed(*key)).map(|(_, way)| way);
            (!ctx.text_edit_focused() && (push.is_some() || pressed(Key::X))).then_some((at, push))
        };
        let (at, push) = drawn.or_else(by_key).filter(|_| free)?;
        let sight = sight(frame, &self.surfaces);
        let vertex = sight.nearest(self.bodies.points(), at)?;
        let size = snapshot.dimension;
        let place = snapshot.positions.get(size * vertex..size * (vertex + 1))?;
        let centre = std::array::from_fn(|axis| place.get(axis).copied().unwrap_or(0.0));
        let extents = (0..size).map(|axis| {
            let along = snapshot.start.iter().skip(axis).step_by(size);
            let [low, high] =
                along.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(*x), high.max(*x)]);
            high - low
        });
        let diagonal = extents.map(|extent| extent * extent).sum::<f64>().sqrt();
        let Some(way) = push else { return Some(Impulse::burst(centre, diagonal)) };
        if drawn.is_none() {
            // The focus has already reacted to the arrow key.
            ctx.memory_mut(|memory| memory.move_focus(FocusDirection::None));
        }
        let [from, to] = [at, at + way].map(|at| sight.target(at, vertex));
        let along: [f64; 3] = std::array::from_fn(|axis| to[axis] - from[axis]);
        let length = along.iter().map(|part| part * part).sum::<f64>().sqrt();
        Some(Impulse::push(centre, along.map(|part| part / length), diagonal))
    }

    /// Where a tool pushes, and in which direction on the screen; without one it is a burst.
    fn drawn_impulse(&mut self, response: &Response, tool: Tool) -> Option<(Pos2, Option<Vec2>)> {
        /// Shortest drag of a push [points].
        const SHORTEST: f32 = 6.0;
        if tool == Tool::Burst && response.clicked_by(PointerButton::Primary) {
            return Some((response.interact_pointer_pos()?, None));
        }
        if tool == Tool::Push && response.drag_started_by(PointerButton::Primary) {
            self.push_from = response.ctx.input(|input| input.pointer.press_origin());
        }
        if !response.drag_stopped_by(PointerButton::Primary) {
            return None;
        }
        let from = self.push_from.take().filter(|_| tool == Tool::Push)?;
        let way = response.interact_pointer_pos()? - from;
        (way.length() >= SHORTEST).then(|| (from, Some(way.normalized())))
    }

    /// Shows a hint after a drag in edit mode, where nothing moves, and for the tools that need one.
    fn tell(&mut self, response: &Response, snapshot: &Snapshot, (now, tool): (f64, Tool)) {
        if snapshot.mode != Mode::Edit {
            self.told_until = 0.0;
        }
        let left = self.told_until - now;
        let told = (left > 0.0).then_some(NOTHING_MOVES);
        let Some(text) = tool.hint().or(told) else { return };
        let (ctx, stage) = (&response.ctx, response.rect);
        if left > 0.0 {
            ctx.request_repaint_after(Duration::from_secs_f64(left));
        }
        let place = stage.center_bottom() - vec2(0.0, 14.0);
        let area = Area::new(response.id.with("told")).order(Order::Foreground).interactable(false);
        area.pivot(Align2::CENTER_BOTTOM).fixed_pos(place).constrain_to(stage).show(ctx, |ui| {
            ui.set_max_width((stage.width() - 40.0).min(440.0));
            egui::Frame::window(ui.style()).inner_margin(10).show(ui, |ui| ui.label(text));
        });
    }

    fn animate(&mut self, response: &Response, frame: &Frame<'_>) {
        let (snapshot, dt) = (frame.snapshot, frame.dt);
        let live = snapshot.running && snapshot.mode != Mode::Edit && !snapshot.is_asleep();
        let selects = frame.options.tool == Tool::Hand && !self.enclosure.is_open();
        let wanted = match self.pointer_state.vertex().filter(|_| selects) {
            Some(vertex) => Some(vertex),
            None if self.pointer_state.is_free() && selects => {
                let sight = sight(frame, &self.surfaces);
                response.hover_pos().and_then(|at| sight.nearest(self.bodies.points(), at))
            }
            None => None,
        };
        self.picked.follow(wanted, dt);
        self.pins.follow(snapshot, frame.now);
        self.scenery.follow(snapshot, dt);
        let held = frame.options.held.filter(|(field, _)| *field == snapshot.field);
        self.scale.follow(snapshot, dt, held.map(|(_, end)| end));
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
        if !selects {
            response.ctx.set_cursor_icon(self.arranging.cursor().unwrap_or(CursorIcon::Crosshair));
        } else if wanted.is_some() {
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
        self.middle.clear(pixels_per_point);
        if let Some(camera) = &frame.space {
            let seen = (self.bodies.points(), camera);
            for (points, closed) in self.scenery.wires() {
                let points: Vec<_> = points.iter().map(|point| camera.seen(*point).0).collect();
                self.middle.line(&points, closed, WIRE, view.theme.annotation.gamma_multiply(0.6));
            }
            let what = (options, &self.scale, self.scenery.surfaces());
            self.surfaces.follow(painter.ctx(), view, snapshot);
            self.surfaces.draw(&mut self.middle, view, snapshot, what, seen);
            painter.add(self.middle.finish());
            let mut painter = painter.clone();
            painter.set_clip_rect(painter.clip_rect().expand(0.01));
            space::axes(&painter, view, canvas, camera);
            self.draw_front(&painter, frame, pointer);
            return;
        }
        house::square(painter, view, 1.0 - self.scenery.room_presence());
        painter.add(self.scenery.draw(pixels_per_point, canvas, view, options.pointed));
        let mut fill = Fill::new(canvas);
        self.bodies.draw((&mut self.middle, &mut fill), view, snapshot, options, &self.scale);
        net::nets((&mut self.middle, &mut fill), view, snapshot, options, self.bodies.points());
        self.trail.draw(&mut self.middle, view, snapshot);
        painter.add(self.middle.finish());
        // A slightly larger clip rectangle, which changes nothing visible, makes the tessellator begin a new mesh here. Otherwise it
        // would move the large mesh to a larger buffer in every frame.
        let mut painter = painter.clone();
        painter.set_clip_rect(painter.clip_rect().expand(0.01));
        legends::strip_numbers(&painter, View { camera: camera(snapshot, canvas), ..view }, canvas, snapshot);
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
        self.probing.draw(&mut self.front, view, snapshot, points);
        self.drawing.draw(&mut self.front, view, pointer);
        self.enclosure.draw(&mut self.front, view);
        self.refining.draw(&mut self.front, view, snapshot, points);
        let sight = sight(frame, &self.surfaces);
        self.arranging.draw(&mut self.front, view, snapshot, sight);
        self.ruler.draw(&mut self.front, view, sight, points);
        self.drawn_path.draw(&mut self.front, view, sight);
        notes::draw(&mut self.front, view, snapshot, sight, points);
        if let Some(moment) = &self.earlier {
            self.ghost.draw(&mut self.front, view, snapshot, moment, |point| sight.seen(point));
        }
        arrows::draw(&mut self.front, view, &self.arrows, |point| sight.seen(point));
        let ends = |pull: &Pull| Some([*points.get(pull.vertex)?, sight.seen(pull.target)]);
        let pull = snapshot.pull.as_ref().and_then(|pull| Some((pull, ends(pull)?)));
        if let Some((_, ends)) = pull {
            marks::arrow(&mut self.front, view, ends);
        }
        if options.field != Field::None && options.field == snapshot.field && !snapshot.values.is_empty() {
            let rects = [canvas, camera(snapshot, canvas).world()];
            legends::colour_bar(painter, &mut self.front, view, rects, (snapshot.field, &self.scale));
            let value_at = |at| match frame.space {
                Some(_) => self.surfaces.value_at(snapshot, points, at),
                None => self.bodies.value_at(snapshot, at),
            };
            let under = free.and_then(|at| Some((at, value_at(at)?)));
            if let Some((at, value)) = under {
                legends::reading(painter, view, canvas, at, snapshot.field, colour::reading(snapshot, value));
            }
        }
        painter.add(self.front.finish());
        notes::write(painter, (view, canvas), snapshot, (sight, points));
        if !options.bare {
            legends::scale_bar(painter, view, canvas);
            arrows::legend(painter, view, canvas, &self.arrows);
            self.probing.write(painter, view, canvas, snapshot, points);
            self.ruler.write(painter, (view, canvas), snapshot, (sight, points));
        }
        if let Some((pull, ends)) = pull {
            marks::pull_force(painter, view, canvas, ends, pull);
        }
    }
}

/// What a drag draws around vertices: with the tools for it, and in edit mode with Shift.
fn around(ui: &Ui, snapshot: &Snapshot, tool: Tool) -> Option<Around> {
    match tool {
        Tool::PinBox => Some(Around::Box),
        Tool::PinLine => Some(Around::Line),
        Tool::Hand if snapshot.mode == Mode::Edit && ui.input(|input| input.modifiers.shift) => Some(Around::Box),
        _ => None,
    }
}

/// How the stage of a frame belongs to the scene.
fn sight<'a>(frame: &Frame<'_>, surfaces: &'a Surfaces) -> Sight<'a> {
    frame.space.map_or(Sight::Plane(frame.view.camera), |camera| Sight::Space(camera, surfaces))
}

/// Describes the stage for screen readers and tests.
fn describe(response: &Response, snapshot: &Snapshot, name: &str) {
    let name = if name.is_empty() { "Stage" } else { name };
    response.widget_info(|| WidgetInfo::labeled(Role::Canvas, true, name));
    response.ctx.accesskit_node_builder(response.id, |node| {
        let toy = snapshot.level.toy.iter().map(|toy| toy.kind().title());
        let bodies: Vec<&str> = snapshot.part_names().map(String::as_str).chain(toy).collect();
        let (vertices, pins) = (snapshot.vertex_count(), snapshot.pins.len());
        node.set_description(format!("stage: {}; {vertices} vertices, {pins} pinned", bodies.join(", ")));
    });
}

/// Camera of a stage that fills `canvas`; tests use it to point at vertices from outside.
pub fn camera(snapshot: &Snapshot, canvas: Rect) -> Camera {
    Camera::new(canvas, snapshot.width.max(1.0) as f32, legends::strip_height(snapshot, canvas))
}

/// Makes two canvases show equal values in equal colours, and their scenes from the same viewpoint.
pub fn share_view(a: &mut Canvas, b: &mut Canvas) {
    a.looking.share(&mut b.looking);
    a.scale.heed(Some(&b.scale));
    b.scale.heed(Some(&a.scale));
}

impl Canvas {
    /// Distance of the ends of the colour scale from the value at rest.
    pub fn scale_end(&self) -> f64 {
        self.scale.end()
    }

    /// Scales the colours by the canvas's own values alone.
    pub fn unshare_scale(&mut self) {
        self.scale.heed(None);
    }
}
