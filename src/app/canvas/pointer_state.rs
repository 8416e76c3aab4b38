//! State of the pointer: a press pins in edit mode and pulls in the other modes.

use crate::{
    app::draw::{
        Camera,
        space::{SpaceCamera, Surfaces},
    },
    command::{Command, Mode},
    snapshot::Snapshot,
};
use eframe::egui::{Event, PointerButton, Pos2, Response};

/// Distance that a press may move and still pin its vertex [points].
const STILL: f32 = 14.0;

/// State of a press.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum PointerState {
    /// Nothing is pressed.
    #[default]
    Nothing,
    /// The vertex is pinned or freed when the press ends.
    Pin { vertex: usize, origin: Pos2, generation: u64 },
    /// The vertex, one of `of`, is pulled to a point \[m\].
    Pull { vertex: usize, of: usize, target: [f64; 3], generation: u64 },
    /// The press was interrupted and has no effect until it ends.
    Spent,
}

/// How the screen belongs to the scene.
#[derive(Clone, Copy)]
pub enum Sight<'a> {
    /// A scene in the plane.
    Plane(Camera),
    /// A scene in space.
    Space(SpaceCamera, &'a Surfaces),
}

impl Sight<'_> {
    /// The vertex that is meant at a point of the screen.
    pub fn nearest(self, points: &[Pos2], at: Pos2) -> Option<usize> {
        match self {
            Self::Plane(_) => nearest(points, at),
            Self::Space(_, surfaces) => surfaces.pick(points, at),
        }
    }

    /// Where a vertex would be at a point of the screen \[m\]: in space at its present depth before the eye.
    pub fn target(self, at: Pos2, vertex: usize) -> [f64; 3] {
        match self {
            Self::Plane(camera) => {
                let [x, y] = camera.world_from_screen(at);
                [x, y, 0.0]
            }
            Self::Space(camera, surfaces) => camera.at_depth(at, surfaces.depth(vertex).unwrap_or(0.0)),
        }
    }

    /// Where a point would be at a point of the screen \[m\]: in space as deep before the eye as it is, so that the depth does not follow a vertex.
    pub fn as_deep_as(self, at: Pos2, point: [f64; 3]) -> [f64; 3] {
        match self {
            Self::Plane(_) => self.target(at, 0),
            Self::Space(camera, _) => camera.at_depth(at, camera.seen(point).1),
        }
    }

    /// The axis nearest to the line of sight, and whether it points to the eye (1) or away from it (-1).
    pub fn axis_of_sight(self) -> (usize, f64) {
        match self {
            Self::Plane(_) => (2, 1.0),
            Self::Space(camera, _) => camera.axis_of_sight(),
        }
    }

    /// Whether a point of the scene is before the eye.
    pub fn shows(self, point: [f64; 3]) -> bool {
        match self {
            Self::Plane(_) => true,
            Self::Space(camera, _) => camera.shows(point),
        }
    }

    /// A point of the scene on the screen.
    pub fn seen(self, [x, y, z]: [f64; 3]) -> Pos2 {
        match self {
            Self::Plane(camera) => camera.screen_from_world([x, y]),
            Self::Space(camera, _) => camera.seen([x, y, z]).0,
        }
    }
}

/// Pointer in this frame.
struct Pointer {
    /// Whether the stage is pressed.
    down: bool,
    /// Whether the window lost the focus in this frame, or a second finger came.
    lost: bool,
    /// Position of the press, if there is one.
    origin: Option<Pos2>,
    /// Present position.
    at: Option<Pos2>,
}

impl Pointer {
    fn new(response: &Response) -> Self {
        let pressed = response.is_pointer_button_down_on();
        response.ctx.input(|input| Self {
            down: pressed && input.pointer.primary_down(),
            lost: input.events.contains(&Event::WindowFocused(false)) || input.multi_touch().is_some(),
            origin: input.pointer.press_origin(),
            at: input.pointer.interact_pos().or(response.interact_pointer_pos()),
        })
    }
}

impl PointerState {
    /// Vertex of the press.
    pub const fn vertex(&self) -> Option<usize> {
        match *self {
            Self::Pin { vertex, .. } | Self::Pull { vertex, .. } => Some(vertex),
            Self::Nothing | Self::Spent => None,
        }
    }

    /// Whether nothing is pressed, so that a press starts an action.
    pub const fn is_free(&self) -> bool {
        matches!(self, Self::Nothing)
    }

    /// Whether a vertex is pulled.
    pub const fn is_pulling(&self) -> bool {
        matches!(self, Self::Pull { .. })
    }

    /// Whether a press that would pin was dragged away to a point.
    pub fn is_dragged(&self, at: Option<Pos2>) -> bool {
        matches!(*self, Self::Pin { origin, .. } if at.is_some_and(|at| at.distance(origin) >= STILL))
    }

    /// Makes the present press, if there is one, do nothing.
    pub fn spend(&mut self) {
        if !self.is_free() {
            *self = Self::Spent;
        }
    }

    /// Updates the state for a frame. `points` are the vertices on the screen.
    pub fn follow(
        &mut self,
        response: &Response,
        snapshot: &Snapshot,
        sight: Sight<'_>,
        points: &[Pos2],
        commands: &mut Vec<Command>,
    ) {
        let pointer = Pointer::new(response);
        *self = match *self {
            Self::Nothing if pointer.down => begin(&pointer, snapshot, sight, points, commands),
            Self::Nothing => {
                // A press that ends within one frame is reported only as a click.
                if response.clicked_by(PointerButton::Primary) && snapshot.mode == Mode::Edit {
                    let vertex = pointer.at.and_then(|at| sight.nearest(points, at));
                    commands.extend(vertex.map(Command::TogglePin));
                }
                Self::Nothing
            }
            Self::Pin { vertex, origin, generation } => {
                if pointer.lost || generation != snapshot.generation || snapshot.mode != Mode::Edit {
                    spent(&pointer)
                } else if pointer.down {
                    *self
                } else {
                    if pointer.at.is_none_or(|at| at.distance(origin) < STILL) {
                        commands.push(Command::TogglePin(vertex));
                    }
                    Self::Nothing
                }
            }
            Self::Pull { vertex, of, target, generation } => {
                if pointer.lost || snapshot.mode == Mode::Edit || of != points.len() || !pointer.down {
                    commands.push(Command::Release);
                    spent(&pointer)
                } else if generation != snapshot.generation {
                    // The scene was built again with the same vertices, for example with another material.
                    commands.push(Command::Grab(vertex, target));
                    Self::Pull { vertex, of, target, generation: snapshot.generation }
                } else {
                    self.pulled(&pointer, sight, commands)
                }
            }
            Self::Spent => spent(&pointer),
        };
    }

    /// Continues the pull to the present position of the pointer.
    fn pulled(self, pointer: &Pointer, sight: Sight<'_>, commands: &mut Vec<Command>) -> Self {
        let (Self::Pull { vertex, of, target: old, generation }, Some(at)) = (self, pointer.at) else { return self };
        let target = sight.as_deep_as(at, old);
        if target == old {
            return self;
        }
        commands.push(Command::Pull(target));
        Self::Pull { vertex, of, target, generation }
    }
}

/// Starts a press. Its vertex is the one nearest to the position of the press, however far the pointer has moved since.
fn begin(
    pointer: &Pointer,
    snapshot: &Snapshot,
    sight: Sight<'_>,
    points: &[Pos2],
    commands: &mut Vec<Command>,
) -> PointerState {
    let generation = snapshot.generation;
    let begun = pointer.origin.and_then(|origin| Some((origin, sight.nearest(points, origin)?)));
    match begun {
        None => PointerState::Spent,
        Some((origin, vertex)) if snapshot.mode == Mode::Edit => PointerState::Pin { vertex, origin, generation },
        Some((origin, vertex)) => {
            let target = sight.target(pointer.at.unwrap_or(origin), vertex);
            commands.push(Command::Grab(vertex, target));
            PointerState::Pull { vertex, of: points.len(), target, generation }
        }
    }
}

const fn spent(pointer: &Pointer) -> PointerState {
    if pointer.down { PointerState::Spent } else { PointerState::Nothing }
}

/// Vertex nearest to a point of the screen, at any distance; the first of several.
pub fn nearest(points: &[Pos2], at: Pos2) -> Option<usize> {
    let distance = |i: &usize| points[*i].distance_sq(at);
    (0..points.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)))
}
