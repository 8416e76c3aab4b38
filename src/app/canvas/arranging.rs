//! Bodies and obstacles that are moved, turned and scaled by handles on the stage. The frame with the handles is around the shape at the start of the scene.

use super::{
    drag::{DragState, drag_state},
    scenery,
};
use crate::{
    app::draw::{Camera, View, shape_buffer::ShapeBuffer},
    command::Command,
    level::{EffectLevel, Level, Place},
    meshes,
    obstacles::{ObstacleKind, Similarity},
    quantity::Factor,
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

/// What a drag does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Grip {
    Move,
    Turn,
    Scale,
}

/// A drag of a body or an obstacle.
#[derive(Clone, Copy)]
struct Drag {
    grip: Grip,
    /// Where it began \[m\].
    from: [f64; 2],
    /// Centre of the frame then \[m\].
    centre: [f64; 2],
    /// Turn of the body or obstacle then \[degrees\].
    turn: f64,
    /// What it does so far.
    change: Similarity,
    /// Generation of the scene in which it began.
    generation: u64,
}

/// A body or an obstacle.
#[derive(Clone, Debug, PartialEq)]
enum Chosen {
    /// A body, by its number and name.
    Body(usize, String),
    /// An obstacle: the numbers of its effect and of it, and how many obstacles there are.
    Obstacle(usize, usize, usize),
}

/// What is chosen, and a drag of it.
#[derive(Default)]
pub struct Arranging {
    chosen: Option<Chosen>,
    drag: Option<Drag>,
    cursor: Option<CursorIcon>,
    /// A body that was chosen since it was last asked for.
    body: Option<usize>,
}

impl Arranging {
    /// The body that was chosen since the last call, by its number.
    pub const fn take_body(&mut self) -> Option<usize> {
        self.body.take()
    }

    /// Whether a drag has begun.
    pub const fn is_open(&self) -> bool {
        self.drag.is_some()
    }

    /// Cursor over a handle or what is chosen.
    pub const fn cursor(&self) -> Option<CursorIcon> {
        self.cursor
    }

    /// Follows the pointer for a frame; `is_chosen` says whether the tool is chosen, and `triangle_at` finds the triangle at a point of the screen. A click chooses a
    /// body or an obstacle. A drag of it or of a handle changes its place when it ends. Escape, a second finger and another scene cancel a drag.
    pub fn follow(
        &mut self,
        response: &Response,
        is_chosen: bool,
        (snapshot, camera): (&Snapshot, &Camera),
        triangle_at: &dyn Fn(Pos2) -> Option<usize>,
    ) -> Option<Command> {
        if !is_chosen {
            *self = Self::default();
            return None;
        }
        self.chosen = self.chosen.take().filter(|chosen| chosen.is_in(snapshot));
        if self.chosen.is_none() {
            self.drag = None;
        }
        let at = response.interact_pointer_pos().or_else(|| response.hover_pos());
        let under = |at: Pos2| {
            Chosen::of_triangle(snapshot, triangle_at(at))
                .or_else(|| Chosen::at(snapshot, camera.world_from_screen(at)))
        };
        if response.clicked_by(PointerButton::Primary) && at.is_none_or(|at| !self.is_on_handle(at, snapshot, camera)) {
            self.choose(at.and_then(under));
        }
        if response.drag_started_by(PointerButton::Primary) {
            let origin = response.ctx.input(|input| input.pointer.press_origin())?;
            self.begin(origin, under(origin), (snapshot, camera));
        }
        let grip = self.drag.map(|drag| drag.grip).or_else(|| self.grip(at?, snapshot, camera));
        self.cursor = grip.map(|grip| match grip {
            Grip::Move => CursorIcon::Move,
            Grip::Turn => CursorIcon::Grab,
            Grip::Scale => CursorIcon::ResizeNwSe,
        });
        let (chosen, mut drag) = (self.chosen.as_ref()?, self.drag?);
        if let Some(at) = response.interact_pointer_pos() {
            let snaps = response.ctx.input(|input| input.modifiers.shift);
            let change = drag.to(camera.world_from_screen(at), snaps);
            // It stays where a number would leave its range.
            if chosen.arranged(&snapshot.level, &change).is_some() {
                drag.change = change;
            }
            self.drag = Some(drag);
        }
        let state = drag_state(response, drag.generation == snapshot.generation);
        if state == DragState::Goes {
            return None;
        }
        self.drag = None;
        let is_moved = state == DragState::Ends && !drag.change.is_none();
        is_moved.then(|| chosen.arranged(&snapshot.level, &drag.change))?
    }

    fn choose(&mut self, chosen: Option<Chosen>) {
        if let Some(Chosen::Body(body, _)) = chosen {
            self.body = Some(body);
        }
        self.chosen = chosen;
    }

    /// Begins a drag at a point of the screen: of a handle, of what is under it, or of what is chosen in its frame.
    fn begin(&mut self, origin: Pos2, under: Option<Chosen>, (snapshot, camera): (&Snapshot, &Camera)) {
        self.drag = None;
        let grip = self.grip(origin, snapshot, camera);
        if grip.is_none() || grip == Some(Grip::Move) && under.is_some() {
            self.choose(under);
        }
        let Some((chosen, frame)) =
            self.chosen.as_ref().and_then(|chosen| Some((chosen, chosen.frame(snapshot, camera)?)))
        else {
            return;
        };
        self.drag = Some(Drag {
            grip: grip.unwrap_or(Grip::Move),
            from: camera.world_from_screen(origin),
            centre: camera.world_from_screen(frame.center()),
            turn: chosen.turn(&snapshot.level),
            change: Similarity::NONE,
            generation: snapshot.generation,
        });
    }

    fn is_on_handle(&self, at: Pos2, snapshot: &Snapshot, camera: &Camera) -> bool {
        matches!(self.grip(at, snapshot, camera), Some(Grip::Turn | Grip::Scale))
    }

    /// What a drag from a point of the screen would do to what is chosen.
    fn grip(&self, at: Pos2, snapshot: &Snapshot, camera: &Camera) -> Option<Grip> {
        let frame = self.chosen.as_ref()?.frame(snapshot, camera)?;
        let is_near = |handle: &Pos2| handle.distance(at) <= REACH;
        if is_near(&turner(frame)) {
            return Some(Grip::Turn);
        }
        if corners(frame).iter().any(is_near) {
            return Some(Grip::Scale);
        }
        frame.contains(at).then_some(Grip::Move)
    }

    /// Draws the outline of what is chosen with its frame and handles; during a drag, the outline where it would be.
    pub fn draw(&self, buffer: &mut ShapeBuffer, view: View, snapshot: &Snapshot) {
        let Some((chosen, frame)) =
            self.chosen.as_ref().and_then(|chosen| Some((chosen, chosen.frame(snapshot, &view.camera)?)))
        else {
            return;
        };
        let line = view.theme.accent_line;
        for outline in chosen.outlines(snapshot, &self.drag.map_or(Similarity::NONE, |drag| drag.change)) {
            let seen: Vec<_> = outline.into_iter().map(|point| view.camera.screen_from_world(point)).collect();
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

impl Chosen {
    /// The body that a triangle belongs to.
    fn of_triangle(snapshot: &Snapshot, triangle: Option<usize>) -> Option<Self> {
        let body = snapshot.bodies.iter().position(|body| triangle.is_some_and(|own| body.triangles.contains(&own)))?;
        Some(Self::Body(body, snapshot.level.bodies.get(body)?.name.clone()))
    }

    /// The obstacle at a point \[m\]: the last one that is there now, as it is drawn above the others, or else one that is there at the start.
    fn at(snapshot: &Snapshot, point: [f64; 2]) -> Option<Self> {
        let is_shown = |(_, effect): &(usize, &EffectLevel)| scenery::presence_in(snapshot.mode, effect) > 0.0;
        let there = |time: f64| {
            let acting = snapshot.level.effects.iter().enumerate().filter(is_shown);
            let mut all = acting.flat_map(|(number, effect)| {
                let obstacles = effect.effect.kind().obstacles();
                obstacles.iter().enumerate().map(move |(obstacle, kind)| (number, obstacle, obstacles.len(), kind))
            });
            all.rfind(|(.., kind)| meshes::contains(&kind.outline_at(time), point))
        };
        let (effect, obstacle, count, _) = there(snapshot.time).or_else(|| there(0.0))?;
        Some(Self::Obstacle(effect, obstacle, count))
    }

    /// Whether it is still there.
    fn is_in(&self, snapshot: &Snapshot) -> bool {
        match self {
            Self::Body(body, name) => snapshot.level.bodies.get(*body).is_some_and(|body| body.name == *name),
            Self::Obstacle(_, _, count) => self.obstacle(&snapshot.level).is_some_and(|(effect, _)| {
                scenery::presence_in(snapshot.mode, effect) > 0.0 && effect.effect.kind().obstacles().len() == *count
            }),
        }
    }

    /// The obstacle and its effect, if it is one.
    fn obstacle<'a>(&self, level: &'a Level) -> Option<(&'a EffectLevel, &'a ObstacleKind)> {
        let Self::Obstacle(effect, obstacle, _) = self else { return None };
        let effect = level.effects.get(*effect)?;
        Some((effect, effect.effect.kind().obstacles().get(*obstacle)?))
    }

    /// Its turn \[degrees\].
    fn turn(&self, level: &Level) -> f64 {
        let of_obstacle = |kind: &ObstacleKind| match kind {
            ObstacleKind::Cuboid(cuboid) => cuboid.turn.get(),
            _ => 0.0,
        };
        match (self, self.obstacle(level)) {
            (Self::Body(body, _), _) => level.bodies.get(*body).map_or(0.0, |body| body.place.turn.get()),
            (_, Some((_, ObstacleKind::Moving(moving)))) => of_obstacle(&moving.obstacle),
            (_, Some((_, kind))) => of_obstacle(kind),
            _ => 0.0,
        }
    }

    /// Its outlines at the start, after a change \[m\].
    fn outlines(&self, snapshot: &Snapshot, by: &Similarity) -> Vec<Vec<[f64; 2]>> {
        let Self::Body(body, _) = self else {
            let arranged = self.obstacle(&snapshot.level).and_then(|(_, kind)| kind.arranged(by));
            return arranged.map(|kind| kind.outline_at(0.0)).into_iter().collect();
        };
        let (Some(listed), Some(shown)) = (snapshot.level.bodies.get(*body), snapshot.bodies.get(*body)) else {
            return Vec::new();
        };
        let map = listed.place.map();
        let at = |vertex: &u32| {
            let [x, y] = map(*shown.mesh.points().get(*vertex as usize)?);
            let [x, y, _] = by.point([x, y, 0.0]);
            Some([x, y])
        };
        shown.mesh.boundary_loops().into_iter().map(|outline| outline.iter().filter_map(at).collect()).collect()
    }

    /// The frame around it on the screen, so large that there is room between its handles.
    fn frame(&self, snapshot: &Snapshot, camera: &Camera) -> Option<Rect> {
        let points: Vec<_> = self
            .outlines(snapshot, &Similarity::NONE)
            .iter()
            .flatten()
            .map(|point| camera.screen_from_world(*point))
            .collect();
        let around = Rect::from_points(&points);
        (!points.is_empty())
            .then(|| Rect::from_center_size(around.center(), around.size().max(Vec2::splat(3.0 * REACH))))
    }

    /// The command that arranges it; `None` if a number would leave its range.
    fn arranged(&self, level: &Level, by: &Similarity) -> Option<Command> {
        match self {
            Self::Body(body, _) => {
                let Place { scale, turn, offset } = level.bodies.get(*body)?.place;
                let place = Place {
                    scale: Factor::new(scale.get() * by.scale).ok()?,
                    turn: by.of_angle(turn)?,
                    offset: by.of_point(offset)?,
                };
                Some(Command::SetPlace(*body, place))
            }
            Self::Obstacle(number, obstacle, _) => {
                let (effect, kind) = self.obstacle(level)?;
                let mut effect = effect.clone();
                *effect.effect.kind_mut().obstacles_mut()?.get_mut(*obstacle)? = kind.arranged(by)?;
                Some(Command::SetEffect(*number, effect))
            }
        }
    }
}

impl Drag {
    /// What it does with the pointer at a place.
    fn to(&self, [x, y]: [f64; 2], snaps: bool) -> Similarity {
        let ([cx, cy], [fx, fy]) = (self.centre, self.from);
        let about = Similarity { from: [cx, cy, 0.0], to: [cx, cy, 0.0], ..Similarity::NONE };
        match self.grip {
            Grip::Move => Similarity { to: [x - fx, y - fy, 0.0], ..Similarity::NONE },
            Grip::Scale => Similarity { scale: libm::hypot(x - cx, y - cy) / libm::hypot(fx - cx, fy - cy), ..about },
            Grip::Turn => {
                let turn = (libm::atan2(y - cy, x - cx) - libm::atan2(fy - cy, fx - cx)).to_degrees();
                let snapped = TURN * libm::round((self.turn + turn) / TURN) - self.turn;
                Similarity { turn: if snaps { snapped } else { turn }, ..about }
            }
        }
    }
}

/// The handles that scale.
fn corners(frame: Rect) -> [Pos2; 4] {
    [frame.left_top(), frame.right_top(), frame.right_bottom(), frame.left_bottom()]
}

/// The handle that turns.
fn turner(frame: Rect) -> Pos2 {
    pos2(frame.center().x, frame.top() - ABOVE)
}
