//! Bodies, nets, membranes and obstacles that are moved, turned and scaled by handles on the stage. The frame with the handles is around the shape at
//! the start of the scene.
//!
//! In space a drag moves along the plane of the screen, an arrow along its axis, and the handle above turns about the axis that is nearest to the line of sight.

use super::{
    drag::{DragState, drag_state},
    nearest_on_screen,
    pointer_state::Sight,
    scenery,
};
use crate::{
    app::draw::{View, shape_buffer::ShapeBuffer, space::SpaceCamera},
    command::Command,
    level::{EffectLevel, Level, Place},
    meshes,
    obstacles::{ObstacleKind, Similarity, Triangulation, placed},
    quantity::Factor,
    snapshot::Snapshot,
};
use eframe::egui::{CursorIcon, PointerButton, Pos2, Rect, Response, Vec2, pos2};
use std::ops::Range;

/// Size of a handle, and the distance at which it is gripped [points].
const SIZE: f32 = 9.0;
const REACH: f32 = 14.0;

/// Distance of the handle that turns from the box [points].
const ABOVE: f32 = 26.0;

/// Farthest move along an axis, in halves of the longest side.
const FARTHEST: f64 = 1e3;

/// Turns with Shift are multiples of this [°].
const TURN: f64 = 15.0;

/// What a drag does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Grip {
    Move,
    /// Move along an axis of space.
    Along(usize),
    Turn,
    Scale,
}

/// A drag of what is chosen.
#[derive(Clone, Copy)]
struct Drag {
    grip: Grip,
    /// Where it began, in space as deep as the centre \[m\].
    from: [f64; 3],
    /// Centre of the frame then, and half of its longest side \[m\].
    centre: [f64; 3],
    reach: f64,
    /// Axis about which it turns.
    axis: usize,
    /// Turn in the plane then \[degrees\].
    turn: f64,
    /// What it does so far.
    change: Similarity,
    /// Generation of the scene in which it began.
    generation: u64,
}

/// What can be chosen.
#[derive(Clone, Debug, PartialEq)]
enum Chosen {
    /// A body, by its number and name.
    Body(usize, String),
    /// A net or membrane in space, by its number (nets first) and name.
    Cloth(usize, String),
    /// An obstacle: the numbers of its effect and of it, and how many obstacles there are.
    Obstacle(usize, usize, usize),
}

/// What is chosen, and a drag of it.
#[derive(Default)]
pub struct Arranging {
    chosen: Option<Chosen>,
    drag: Option<Drag>,
    cursor: Option<CursorIcon>,
    /// A body, net or membrane that was chosen since it was last asked for.
    part: Option<usize>,
}

/// The frame around what is chosen.
#[derive(Clone, Copy)]
struct Frame {
    /// On the screen.
    rect: Rect,
    /// Its centre \[m\].
    centre: [f64; 3],
    /// Half of its sides along the axes \[m\].
    half: [f64; 3],
    /// Whether it can be turned.
    turns: bool,
}

impl Arranging {
    /// The body, net or membrane that was chosen since the last call, by its number in this order.
    pub const fn take_part(&mut self) -> Option<usize> {
        self.part.take()
    }

    /// Whether a drag has begun.
    pub const fn is_open(&self) -> bool {
        self.drag.is_some()
    }

    /// Cursor over a handle or what is chosen.
    pub const fn cursor(&self) -> Option<CursorIcon> {
        self.cursor
    }

    /// Follows the pointer for a frame; `is_chosen` says whether the tool is chosen, and `triangle_at` finds the triangle of a body at a point of the screen. A click
    /// chooses. A drag of it or of a handle changes its place when it ends. Escape, a second finger and another scene cancel a drag.
    pub fn follow(
        &mut self,
        response: &Response,
        is_chosen: bool,
        (snapshot, sight): (&Snapshot, Sight<'_>),
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
        let under = |at: Pos2| match sight {
            Sight::Plane(camera) => Chosen::of_triangle(snapshot, triangle_at(at))
                .or_else(|| Chosen::at(snapshot, camera.world_from_screen(at))),
            Sight::Space(camera, _) => Chosen::in_space(snapshot, &camera, at),
        };
        if response.clicked_by(PointerButton::Primary) && at.is_none_or(|at| !self.is_on_handle(at, snapshot, sight)) {
            self.choose(at.and_then(under), snapshot);
        }
        if response.drag_started_by(PointerButton::Primary) {
            let origin = response.ctx.input(|input| input.pointer.press_origin())?;
            self.begin(origin, under(origin), (snapshot, sight));
        }
        let grip = self.drag.map(|drag| drag.grip).or_else(|| self.grip(at?, snapshot, sight));
        self.cursor = grip.map(|grip| match grip {
            Grip::Move | Grip::Along(_) => CursorIcon::Move,
            Grip::Turn => CursorIcon::Grab,
            Grip::Scale => CursorIcon::ResizeNwSe,
        });
        let (chosen, mut drag) = (self.chosen.as_ref()?, self.drag?);
        if let Some(at) = response.interact_pointer_pos() {
            let snaps = response.ctx.input(|input| input.modifiers.shift);
            let change = drag.to(sight, at, snaps);
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

    fn choose(&mut self, chosen: Option<Chosen>, snapshot: &Snapshot) {
        match chosen {
            Some(Chosen::Body(body, _)) => self.part = Some(body),
            Some(Chosen::Cloth(number, _)) => self.part = Some(snapshot.level.bodies.len() + number),
            _ => {}
        }
        self.chosen = chosen;
    }

    /// Begins a drag at a point of the screen: of a handle, of what is under it, or of what is chosen in its frame.
    fn begin(&mut self, origin: Pos2, under: Option<Chosen>, (snapshot, sight): (&Snapshot, Sight<'_>)) {
        self.drag = None;
        let grip = self.grip(origin, snapshot, sight);
        if grip.is_none() || grip == Some(Grip::Move) && under.is_some() {
            self.choose(under, snapshot);
        }
        let Some((chosen, frame)) =
            self.chosen.as_ref().and_then(|chosen| Some((chosen, chosen.frame(snapshot, sight)?)))
        else {
            return;
        };
        self.drag = Some(Drag {
            grip: grip.unwrap_or(Grip::Move),
            from: sight.as_deep_as(origin, frame.centre),
            centre: frame.centre,
            reach: frame.half.into_iter().fold(0.0, f64::max),
            axis: sight.axis_of_sight().0,
            turn: chosen.turn(&snapshot.level),
            change: Similarity::NONE,
            generation: snapshot.generation,
        });
    }

    fn is_on_handle(&self, at: Pos2, snapshot: &Snapshot, sight: Sight<'_>) -> bool {
        self.grip(at, snapshot, sight).is_some_and(|grip| grip != Grip::Move)
    }

    /// What a drag from a point of the screen would do to what is chosen.
    fn grip(&self, at: Pos2, snapshot: &Snapshot, sight: Sight<'_>) -> Option<Grip> {
        let frame = self.chosen.as_ref()?.frame(snapshot, sight)?;
        let turner = frame.turner(sight).map(|handle| (Grip::Turn, handle));
        let tips = frame.arrows(sight).map(|(axis, [_, tip])| (Grip::Along(axis), tip));
        let corners = corners(frame.rect).map(|corner| (Grip::Scale, corner));
        let near = turner.into_iter().chain(tips).chain(corners).filter(|(_, handle)| handle.distance(at) <= REACH);
        let nearest = near.min_by(|(_, a), (_, b)| a.distance(at).total_cmp(&b.distance(at)));
        nearest.map(|(grip, _)| grip).or_else(|| frame.rect.contains(at).then_some(Grip::Move))
    }

    /// Draws the outline of what is chosen with its frame and handles; during a drag, the outline where it would be.
    pub fn draw(&self, buffer: &mut ShapeBuffer, view: View, snapshot: &Snapshot, sight: Sight<'_>) {
        let Some((chosen, frame)) =
            self.chosen.as_ref().and_then(|chosen| Some((chosen, chosen.frame(snapshot, sight)?)))
        else {
            return;
        };
        let line = view.theme.accent_line;
        for outline in chosen.outlines(snapshot, &self.drag.map_or(Similarity::NONE, |drag| drag.change)) {
            let seen: Vec<_> = outline.into_iter().map(|point| sight.seen(point)).collect();
            buffer.line(&seen, true, 4.0, view.theme.card);
            buffer.line(&seen, true, 2.0, line);
        }
        if self.is_open() {
            return;
        }
        let (corners, turner) = (corners(frame.rect), frame.turner(sight));
        buffer.line(&corners, true, 1.0, line);
        if let Some(turner) = turner {
            buffer.line(&[pos2(frame.rect.center().x, frame.rect.top()), turner], false, 1.0, line);
        }
        for (axis, ends) in frame.arrows(sight) {
            buffer.line(&ends, false, 2.0, view.theme.series[axis]);
        }
        let round = corners.into_iter().chain(turner).map(|handle| (handle, line));
        for (handle, color) in round.chain(frame.arrows(sight).map(|(axis, [_, tip])| (tip, view.theme.series[axis]))) {
            buffer.dot(handle, 0.5 * SIZE + 1.0, view.theme.card);
            buffer.dot(handle, 0.5 * SIZE, color);
        }
    }
}

impl Frame {
    /// The handle that turns, above all others.
    fn turner(self, sight: Sight<'_>) -> Option<Pos2> {
        let top = self.arrows(sight).fold(self.rect.top(), |top, (_, [_, tip])| top.min(tip.y));
        self.turns.then(|| pos2(self.rect.center().x, top - ABOVE))
    }

    /// The arrows along the axes of space, from the centre to their tips on the screen; without those that point to the eye.
    fn arrows(self, sight: Sight<'_>) -> impl Iterator<Item = (usize, [Pos2; 2])> {
        /// Least length on the screen [points].
        const LEAST: f32 = 2.0 * REACH;
        let axes = if matches!(sight, Sight::Space(..)) { 0..3 } else { 0..0 };
        let longest = self.half.into_iter().fold(0.0, f64::max);
        axes.filter_map(move |axis| {
            let mut tip = self.centre;
            tip[axis] += self.half[axis] + 0.7 * longest;
            let ends = [sight.seen(self.centre), sight.seen(tip)];
            (ends[0].distance(ends[1]) >= LEAST).then_some((axis, ends))
        })
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

    /// What is nearest to the eye at a point of the screen in space: a net or membrane, or an obstacle that has an end.
    fn in_space(snapshot: &Snapshot, camera: &SpaceCamera, at: Pos2) -> Option<Self> {
        let seen = |point: [f64; 3]| camera.seen(point);
        let mut nearest: Option<(f64, Self)> = None;
        let mut find = |depth: f64, chosen: &dyn Fn() -> Option<Self>| {
            if nearest.as_ref().is_none_or(|(other, _)| depth < *other)
                && let Some(chosen) = chosen()
            {
                nearest = Some((depth, chosen));
            }
        };
        for (number, (vertices, faces)) in cloths(snapshot).enumerate() {
            let points: Vec<_> = vertices.filter_map(|vertex| snapshot.position(vertex)).map(seen).collect();
            let cloth = || Some(Self::Cloth(number, cloth_name(&snapshot.level, number)?.clone()));
            if let Some(depth) = depth_of_facets(&points, faces, at) {
                find(depth, &cloth);
            }
            // Nets without faces are gripped by their particles.
            let places: Vec<_> = points.iter().map(|(place, _)| *place).collect();
            let particle = nearest_on_screen(&places, at).filter(|_| faces.1.is_empty());
            if let Some((place, depth)) = particle.and_then(|particle| points.get(particle))
                && place.distance(at) <= REACH
            {
                find(*depth, &cloth);
            }
        }
        for (number, effect) in snapshot.level.effects.iter().enumerate() {
            let obstacles = effect.effect.kind().obstacles();
            if scenery::presence_in(snapshot.mode, effect) == 0.0 {
                continue;
            }
            for (obstacle, kind) in obstacles.iter().enumerate() {
                let surface = surface_at(kind, snapshot, snapshot.time);
                let points: Vec<_> =
                    surface.iter().flat_map(|surface| &surface.points).map(|point| seen(*point)).collect();
                let triangles = surface.as_ref().map_or(&[][..], |surface| &surface.triangles);
                if let Some(depth) = depth_of_facets(&points, (0, triangles), at) {
                    find(depth, &|| Some(Self::Obstacle(number, obstacle, obstacles.len())));
                }
            }
        }
        nearest.map(|(_, chosen)| chosen)
    }

    /// Whether it is still there.
    fn is_in(&self, snapshot: &Snapshot) -> bool {
        match self {
            Self::Body(body, name) => snapshot.level.bodies.get(*body).is_some_and(|body| body.name == *name),
            Self::Cloth(number, name) => cloth_name(&snapshot.level, *number) == Some(name),
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

    /// Its turn in the plane \[degrees\].
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

    /// Its outlines at the start, after a change \[m\]; in space, the edges of the box around it.
    fn outlines(&self, snapshot: &Snapshot, by: &Similarity) -> Vec<Vec<[f64; 3]>> {
        let flat = |outline: Vec<[f64; 2]>| outline.into_iter().map(|[x, y]| [x, y, 0.0]).collect();
        match self {
            Self::Body(body, _) => {
                let (Some(listed), Some(shown)) = (snapshot.level.bodies.get(*body), snapshot.bodies.get(*body)) else {
                    return Vec::new();
                };
                let map = listed.place.map();
                let at = |vertex: &u32| {
                    let [x, y] = map(*shown.mesh.points().get(*vertex as usize)?);
                    Some(by.point([x, y, 0.0]))
                };
                let loops = shown.mesh.boundary_loops().into_iter();
                loops.map(|outline| outline.iter().filter_map(at).collect()).collect()
            }
            Self::Cloth(number, _) => {
                let Some((vertices, _)) = cloths(snapshot).nth(*number) else { return Vec::new() };
                let points = snapshot.start.as_chunks::<3>().0.get(vertices).unwrap_or_default();
                box_around(points, by)
            }
            Self::Obstacle(..) => {
                let Some((_, kind)) = self.obstacle(&snapshot.level) else { return Vec::new() };
                if kind.kind().dimension() == 3 {
                    let surface = surface_at(kind, snapshot, 0.0);
                    return surface.map_or_else(Vec::new, |surface| box_around(&surface.points, by));
                }
                kind.arranged(by).map(|kind| flat(kind.outline_at(0.0))).into_iter().collect()
            }
        }
    }

    /// The frame around it, on the screen so large that there is room between its handles.
    fn frame(&self, snapshot: &Snapshot, sight: Sight<'_>) -> Option<Frame> {
        let outlines = self.outlines(snapshot, &Similarity::NONE);
        let points = || outlines.iter().flatten();
        let seen: Vec<_> = points().map(|point| sight.seen(*point)).collect();
        if seen.is_empty() {
            return None;
        }
        let [least, most] = [f64::min, f64::max].map(|of| {
            let start = *points().next().unwrap_or(&[0.0; 3]);
            points().fold(start, |all, point| [0, 1, 2].map(|axis| of(all[axis], point[axis])))
        });
        let around = Rect::from_points(&seen);
        Some(Frame {
            rect: Rect::from_center_size(around.center(), around.size().max(Vec2::splat(3.0 * REACH))),
            centre: [0, 1, 2].map(|axis| 0.5 * (least[axis] + most[axis])),
            half: [0, 1, 2].map(|axis| 0.5 * (most[axis] - least[axis])),
            turns: matches!((self, sight), (Self::Cloth(..), _) | (_, Sight::Plane(_))),
        })
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
            Self::Cloth(number, _) => {
                let place = level.space(*number)?.arranged(by)?;
                Some(Command::SetSpacePlace(*number, place))
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
    /// What it does with the pointer at a point of the screen.
    fn to(&self, sight: Sight<'_>, at: Pos2, snaps: bool) -> Similarity {
        let about = Similarity { from: self.centre, to: self.centre, axis: self.axis, ..Similarity::NONE };
        let centre = sight.seen(self.centre);
        let (from, to) = (sight.seen(self.from) - centre, at - centre);
        match self.grip {
            Grip::Move => {
                let to = sight.as_deep_as(at, self.centre);
                Similarity { to: [0, 1, 2].map(|axis| to[axis] - self.from[axis]), ..Similarity::NONE }
            }
            Grip::Along(axis) => {
                let mut to = [0.0; 3];
                to[axis] = self.along(sight, axis, at - from).unwrap_or(self.change.to[axis]);
                Similarity { to, ..Similarity::NONE }
            }
            Grip::Scale => Similarity { scale: f64::from(to.length() / from.length()), ..about },
            Grip::Turn => {
                let angle = |along: Vec2| f64::from(-along.y).atan2(f64::from(along.x)).to_degrees();
                let turn = sight.axis_of_sight().1 * (angle(to) - angle(from));
                let snapped = TURN * libm::round((self.turn + turn) / TURN) - self.turn;
                Similarity { turn: if snaps { snapped } else { turn }, ..about }
            }
        }
    }

    /// Displacement of the centre along an axis \[m\] with which it is seen nearest to a point of the screen; `None` where there is none, as beyond the point
    /// at which the axis vanishes.
    fn along(&self, sight: Sight<'_>, axis: usize, wanted: Pos2) -> Option<f64> {
        /// Iterations of Newton's method: perspective bends little.
        const ITERATIONS: u32 = 8;
        /// Farthest place from what was asked [points].
        const CLOSE: f32 = 1.0;
        let moved = |by: f64| {
            let mut point = self.centre;
            point[axis] += by;
            point
        };
        let start = sight.seen(self.centre);
        let length = 1e-3 * self.reach.max(f64::MIN_POSITIVE);
        // Points of the screen per metre.
        let slope = |by: f64| (sight.seen(moved(by + length)) - sight.seen(moved(by))) / length as f32;
        // What is asked for on the line that the axis is on the screen.
        let line = slope(0.0).normalized();
        let wanted = start + line * (wanted - start).dot(line);
        let by = (0..ITERATIONS).fold(0.0, |by, _| {
            let slope = slope(by);
            let next = by + f64::from((wanted - sight.seen(moved(by))).dot(slope) / slope.length_sq());
            if next.is_finite() { next.clamp(-FARTHEST * self.reach, FARTHEST * self.reach) } else { by }
        });
        (sight.shows(moved(by)) && sight.seen(moved(by)).distance(wanted) <= CLOSE).then_some(by)
    }
}

/// Vertices of the nets and membranes in space, with the number of the first and their faces by the numbers of the scene.
fn cloths(snapshot: &Snapshot) -> impl Iterator<Item = (Range<usize>, (usize, &[[u32; 3]]))> {
    let nets = snapshot.nets.iter().map(|net| (net.vertices.clone(), (net.vertices.start, net.faces.as_slice())));
    let membranes = snapshot.membranes.iter();
    nets.chain(membranes.map(|one| (one.vertices.clone(), (one.vertices.start, one.elements.corners()))))
}

/// Name of a net or membrane (by number: nets first).
fn cloth_name(level: &Level, number: usize) -> Option<&String> {
    level.part_names().nth(level.bodies.len() + number)
}

/// The surface of an obstacle in space at a time \[s\]; `None` for one without an end.
fn surface_at(kind: &ObstacleKind, snapshot: &Snapshot, time: f64) -> Option<Triangulation> {
    let surface = kind.kind().triangulation(&snapshot.elements.surfaces).moved(&placed(&kind.kind().motions(), time));
    (surface.endless_about.is_none() && !surface.points.is_empty()).then_some(surface)
}

/// Depth \[m\] of the nearest of some facets at a point of the screen, given by their points there with their depths, and by the number of the first of these.
/// Facets with a corner behind the eye are passed over.
fn depth_of_facets(points: &[(Pos2, f64)], (first, facets): (usize, &[[u32; 3]]), at: Pos2) -> Option<f64> {
    let depth = |facet: &[u32; 3]| {
        let [a, b, c] = facet.map(|corner| points.get(corner as usize - first).filter(|(_, depth)| *depth > 0.0));
        let corners = [a?, b?, c?];
        let turn = |a: Pos2, b: Pos2| f64::from((b.x - a.x) * (at.y - a.y) - (b.y - a.y) * (at.x - a.x));
        // The turn over a side is the share of the corner opposite to it, times the same for all.
        let turns = [0, 1, 2].map(|side| turn(corners[side].0, corners[(side + 1) % 3].0));
        let is_inside = turns.iter().all(|turn| *turn >= 0.0) || turns.iter().all(|turn| *turn <= 0.0);
        let whole: f64 = turns.iter().sum();
        // On the screen the inverse of the depth is linear.
        let inverse = (0..3).map(|side| turns[side] / corners[(side + 2) % 3].1).sum::<f64>() / whole;
        (is_inside && whole != 0.0).then(|| inverse.recip())
    };
    facets.iter().filter_map(depth).reduce(f64::min)
}

/// The edges of the box around some points after a change, each as a closed line \[m\].
fn box_around(points: &[[f64; 3]], by: &Similarity) -> Vec<Vec<[f64; 3]>> {
    let Some(first) = points.first() else { return Vec::new() };
    let [least, most] = [f64::min, f64::max]
        .map(|of| points.iter().fold(*first, |all, point| [0, 1, 2].map(|axis| of(all[axis], point[axis]))));
    let corner =
        |bits: usize| by.point([0, 1, 2].map(|axis| if bits >> axis & 1 == 0 { least[axis] } else { most[axis] }));
    let edges = (0..8_usize).flat_map(|from| (0..3).map(move |axis| (from, from | 1 << axis)));
    edges.filter(|(from, to)| from != to).map(|(from, to)| vec![corner(from), corner(to)]).collect()
}

/// The handles that scale.
fn corners(frame: Rect) -> [Pos2; 4] {
    [frame.left_top(), frame.right_top(), frame.right_bottom(), frame.left_bottom()]
}
