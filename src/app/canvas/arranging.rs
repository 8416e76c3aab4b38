//! Bodies that are moved, turned and scaled by handles on the stage. The frame with the handles is around the rest shape of a body at its place, where the scene
//! begins.

use super::drag::{DragState, drag_state};
use crate::{
    app::draw::{Camera, View, shape_buffer::ShapeBuffer},
    command::Command,
    level::Place,
    quantity::{Angle, Factor, Point},
    snapshot::Snapshot,
};
use eframe::egui::{CursorIcon, PointerButton, Pos2, Rect, Response, Vec2, pos2};

/// Size of a handle, and the distance at which it is gripped [points].
const SIZE: f32 = 9.0;
const REACH: f32 = 14.0;

/// Distance of the handle that turns from the box [points].
const ABOVE: f32 = 26.0;

/// Turns with Shift are multiples of this [°].
const TURN: f64 = 15.0;

/// What a drag does to a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Grip {
    Move,
    Turn,
    Scale,
}

/// A drag of a body.
#[derive(Clone, Copy)]
struct Drag {
    grip: Grip,
    /// Where it began \[m\].
    from: [f64; 2],
    /// Centre of the box around the body then \[m\].
    centre: [f64; 2],
    /// The place of the body then, and now.
    places: [Place; 2],
    /// Generation of the scene in which it began.
    generation: u64,
}

/// The chosen body, by its number, and a drag of it.
#[derive(Default)]
pub struct Arranging {
    chosen: Option<usize>,
    /// Its name.
    name: String,
    drag: Option<Drag>,
    cursor: Option<CursorIcon>,
}

impl Arranging {
    /// Whether a drag has begun.
    pub const fn is_open(&self) -> bool {
        self.drag.is_some()
    }

    /// Cursor over a handle or the chosen body.
    pub const fn cursor(&self) -> Option<CursorIcon> {
        self.cursor
    }

    /// Follows the pointer for a frame, with the triangle under it; `is_chosen` says whether the tool is chosen. A click chooses a body. A drag of it or of a handle changes its place when it ends. Escape, a second finger and another scene cancel a
    /// drag.
    pub fn follow(
        &mut self,
        response: &Response,
        is_chosen: bool,
        (snapshot, camera): (&Snapshot, &Camera),
        triangle: Option<usize>,
    ) -> Option<Command> {
        if !is_chosen {
            *self = Self::default();
            return None;
        }
        let name = |body: usize| snapshot.level.bodies.get(body).map(|body| body.name.as_str());
        self.chosen = self.chosen.filter(|body| name(*body) == Some(&self.name));
        if self.chosen.is_none() {
            self.drag = None;
        }
        let under =
            triangle.and_then(|triangle| snapshot.bodies.iter().position(|body| body.triangles.contains(&triangle)));
        let at = response.interact_pointer_pos().or_else(|| response.hover_pos());
        if response.clicked_by(PointerButton::Primary) && at.is_none_or(|at| !self.is_on_handle(at, snapshot, camera)) {
            self.choose(under, snapshot);
        }
        if response.drag_started_by(PointerButton::Primary) {
            let origin = response.ctx.input(|input| input.pointer.press_origin())?;
            self.begin(origin, under, (snapshot, camera));
        }
        let grip = self.drag.map(|drag| drag.grip).or_else(|| self.grip(at?, snapshot, camera));
        self.cursor = grip.map(|grip| match grip {
            Grip::Move => CursorIcon::Move,
            Grip::Turn => CursorIcon::Grab,
            Grip::Scale => CursorIcon::ResizeNwSe,
        });
        let (body, mut drag) = (self.chosen?, self.drag?);
        if let Some(at) = response.interact_pointer_pos() {
            let snaps = response.ctx.input(|input| input.modifiers.shift);
            drag.places[1] = drag.place(camera.world_from_screen(at), snaps);
            self.drag = Some(drag);
        }
        let state = drag_state(response, drag.generation == snapshot.generation);
        if state == DragState::Goes {
            return None;
        }
        self.drag = None;
        let [before, now] = drag.places;
        (state == DragState::Ends && now != before).then_some(Command::SetPlace(body, now))
    }

    fn choose(&mut self, body: Option<usize>, snapshot: &Snapshot) {
        let name = body.and_then(|body| snapshot.level.bodies.get(body)).map(|body| body.name.clone());
        (self.chosen, self.name) = (body, name.unwrap_or_default());
    }

    /// Begins a drag at a point of the screen: of a handle, of the body under it, or of the chosen one in its frame.
    fn begin(&mut self, origin: Pos2, under: Option<usize>, (snapshot, camera): (&Snapshot, &Camera)) {
        self.drag = None;
        let grip = self.grip(origin, snapshot, camera);
        if grip.is_none() || grip == Some(Grip::Move) && under.is_some() {
            self.choose(under, snapshot);
        }
        let Some((body, frame)) = self.chosen.and_then(|body| Some((body, frame(snapshot, camera, body)?))) else {
            return;
        };
        let Some(listed) = snapshot.level.bodies.get(body) else { return };
        self.drag = Some(Drag {
            grip: grip.unwrap_or(Grip::Move),
            from: camera.world_from_screen(origin),
            centre: camera.world_from_screen(frame.center()),
            places: [listed.place; 2],
            generation: snapshot.generation,
        });
    }

    fn is_on_handle(&self, at: Pos2, snapshot: &Snapshot, camera: &Camera) -> bool {
        matches!(self.grip(at, snapshot, camera), Some(Grip::Turn | Grip::Scale))
    }

    /// What a drag from a point of the screen would do to the chosen body.
    fn grip(&self, at: Pos2, snapshot: &Snapshot, camera: &Camera) -> Option<Grip> {
        let frame = frame(snapshot, camera, self.chosen?)?;
        let is_near = |handle: &Pos2| handle.distance(at) <= REACH;
        if is_near(&turner(frame)) {
            return Some(Grip::Turn);
        }
        if corners(frame).iter().any(is_near) {
            return Some(Grip::Scale);
        }
        frame.contains(at).then_some(Grip::Move)
    }

    /// Draws the outline of the chosen body at its place with its frame and handles; during a drag, the outline where it would be.
    pub fn draw(&self, buffer: &mut ShapeBuffer, view: View, snapshot: &Snapshot) {
        let Some((body, frame)) = self.chosen.and_then(|body| Some((body, frame(snapshot, &view.camera, body)?)))
        else {
            return;
        };
        let (Some(listed), Some(shown)) = (snapshot.level.bodies.get(body), snapshot.bodies.get(body)) else { return };
        let (line, place) = (view.theme.accent_line, self.drag.map_or(listed.place, |drag| drag.places[1]));
        for outline in shown.mesh.boundary_loops() {
            let point = |vertex: &u32| shown.mesh.points().get(*vertex as usize);
            let seen =
                outline.iter().filter_map(point).map(|point| view.camera.screen_from_world(placed(place, *point)));
            let seen: Vec<_> = seen.collect();
            buffer.line(&seen, true, 4.0, view.theme.card);
            buffer.line(&seen, true, 2.0, line);
        }
        if self.is_open() {
            return;
        }
        buffer.line(&corners(frame), true, 1.0, line);
        buffer.line(&[pos2(frame.center().x, frame.top()), turner(frame)], false, 1.0, line);
        for handle in corners(frame).into_iter().chain([turner(frame)]) {
            buffer.dot(handle, 0.5 * SIZE + 1.0, view.theme.card);
            buffer.dot(handle, 0.5 * SIZE, line);
        }
    }
}

impl Drag {
    /// Scale, and turn \[degrees\], about the centre, and the shift \[m\], that the pointer at a place makes.
    fn change(&self, [x, y]: [f64; 2], snaps: bool) -> (f64, f64, [f64; 2]) {
        let ([cx, cy], [fx, fy]) = (self.centre, self.from);
        match self.grip {
            Grip::Move => (1.0, 0.0, [x - fx, y - fy]),
            Grip::Scale => {
                let before = libm::hypot(fx - cx, fy - cy);
                (libm::hypot(x - cx, y - cy) / before, 0.0, [0.0; 2])
            }
            Grip::Turn => {
                let turn = (libm::atan2(y - cy, x - cx) - libm::atan2(fy - cy, fx - cx)).to_degrees();
                let whole = self.places[0].turn.get() + turn;
                let snapped = TURN * libm::round(whole / TURN) - self.places[0].turn.get();
                (1.0, if snaps { snapped } else { turn }, [0.0; 2])
            }
        }
    }

    /// The place of the body with the pointer at a place; its last one, if a number is out of its range.
    fn place(&self, at: [f64; 2], snaps: bool) -> Place {
        let (scale, turn, shift) = self.change(at, snaps);
        let before = &self.places[0];
        let (sin, cos) = (libm::sin(turn.to_radians()), libm::cos(turn.to_radians()));
        let [x, y] = before.offset.get();
        let (dx, dy) = (scale * (x - self.centre[0]), scale * (y - self.centre[1]));
        let offset = [self.centre[0] + cos * dx - sin * dy + shift[0], self.centre[1] + sin * dx + cos * dy + shift[1]];
        // Within half a turn, as sliders show it.
        let whole = before.turn.get() + turn;
        let whole = whole - 360.0 * libm::round(whole / 360.0);
        let made = || {
            Some(Place {
                scale: Factor::new(before.scale.get() * scale).ok()?,
                turn: Angle::new(whole).ok()?,
                offset: Point::new(offset).ok()?,
            })
        };
        made().unwrap_or(self.places[1])
    }
}

/// A point of a mesh at a place \[m\].
fn placed(place: Place, [x, y]: [f64; 2]) -> [f64; 2] {
    let (scale, turn, [dx, dy]) = (place.scale.get(), place.turn.get().to_radians(), place.offset.get());
    let (sin, cos) = (scale * libm::sin(turn), scale * libm::cos(turn));
    [cos * x - sin * y + dx, sin * x + cos * y + dy]
}

/// The frame around a body at its place on the screen, so large that there is room between its handles.
fn frame(snapshot: &Snapshot, camera: &Camera, body: usize) -> Option<Rect> {
    let (place, mesh) = (snapshot.level.bodies.get(body)?.place, &snapshot.bodies.get(body)?.mesh);
    let points: Vec<_> = mesh.points().iter().map(|point| camera.screen_from_world(placed(place, *point))).collect();
    let around = Rect::from_points(&points);
    (!points.is_empty()).then(|| Rect::from_center_size(around.center(), around.size().max(Vec2::splat(3.0 * REACH))))
}

/// The handles that scale.
fn corners(frame: Rect) -> [Pos2; 4] {
    [frame.left_top(), frame.right_top(), frame.right_bottom(), frame.left_bottom()]
}

/// The handle that turns.
fn turner(frame: Rect) -> Pos2 {
    pos2(frame.center().x, frame.top() - ABOVE)
}
