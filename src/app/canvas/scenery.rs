//! Scenery: the obstacles and rooms of effects, which fade in and out.

use crate::{
    app::draw::{View, house, shape_buffer::ShapeBuffer},
    command::Mode,
    effects::Shape,
    level::{EffectLevel, Switch, When},
    obstacles::Triangulation,
    snapshot::Snapshot,
};
use eframe::egui::{self, Rect};

/// Duration of a cross-fade \[s\].
const FADE: f32 = 0.2;

/// Width of a wire \[points\].
pub const WIRE: f32 = 2.0;

/// Presence in edit mode of effects that act only in collide mode.
const PALE: f32 = 0.72;

/// State of the scenery.
#[derive(Default)]
pub struct Scenery {
    generation: Option<u64>,
    /// The shapes of each effect, and their presence from 0 to 1.
    effects: Vec<(Vec<Shape>, f32)>,
    moving: bool,
    buffer: ShapeBuffer,
    /// Content of the buffer; it is drawn again when this differs.
    drawn: Option<(View, Rect, u32, Option<[usize; 2]>)>,
    changed: bool,
}

impl Scenery {
    /// Updates the presence of each effect, which fades in and out.
    pub fn follow(&mut self, snapshot: &Snapshot, dt: f32) {
        let known = self.generation == Some(snapshot.generation);
        self.generation = Some(snapshot.generation);
        self.moving = false;
        if self.effects.len() != snapshot.level.effects.len() {
            self.effects.resize_with(snapshot.level.effects.len(), || (Vec::new(), 0.0));
            self.changed = true;
        }
        for (effect, (shapes, presence)) in snapshot.level.effects.iter().zip(&mut self.effects) {
            let now = effect.effect.kind().shapes(snapshot.time, &snapshot.elements.surfaces);
            let wanted = if now.is_empty() { 0.0 } else { presence_in(snapshot.mode, effect) };
            let step = if known { dt / FADE } else { 1.0 };
            let next = *presence + (wanted - *presence).clamp(-step, step);
            self.changed |= *shapes != now || *presence != next;
            self.moving |= next != wanted;
            (*shapes, *presence) = (now, next);
        }
    }

    /// Whether an effect is fading.
    pub fn is_moving(&self) -> bool {
        self.moving
    }

    /// The surfaces of obstacles in space that are there.
    pub fn surfaces(&self) -> impl Iterator<Item = &Triangulation> + Clone {
        let there = self.effects.iter().filter(|(_, presence)| *presence > 0.5);
        there.flat_map(|(shapes, _)| shapes).filter_map(|shape| match shape {
            Shape::Surface(surface) => Some(surface),
            _ => None,
        })
    }

    /// The wires in space that are there, and whether they are closed.
    pub fn wires(&self) -> impl Iterator<Item = (&[[f64; 3]], bool)> {
        let there = self.effects.iter().filter(|(_, presence)| *presence > 0.5);
        there.flat_map(|(shapes, _)| shapes).filter_map(|shape| match shape {
            Shape::Wire { points, closed } => Some((points.as_slice(), *closed)),
            _ => None,
        })
    }

    /// Presence of a room, which replaces the plain world square.
    pub fn room_presence(&self) -> f32 {
        let rooms =
            self.effects.iter().filter(|(shapes, _)| shapes.iter().any(|shape| matches!(shape, Shape::Room(_))));
        rooms.map(|effect| effect.1).fold(0.0, f32::max)
    }

    /// Returns the drawing, made again only if something has changed. The solid `pointed` is highlighted.
    pub fn draw(
        &mut self,
        pixels_per_point: f32,
        canvas: Rect,
        view: View,
        pointed: Option<[usize; 2]>,
    ) -> egui::Shape {
        let wanted = Some((view, canvas, pixels_per_point.to_bits(), pointed));
        if !self.changed && self.drawn == wanted {
            return self.buffer.again();
        }
        (self.drawn, self.changed) = (wanted, false);
        self.buffer.clear(pixels_per_point);
        let there = self.effects.iter().filter(|(_, presence)| *presence > 0.02);
        let mut shapes: Vec<(&Shape, f32)> =
            there.flat_map(|(shapes, presence)| shapes.iter().map(move |shape| (shape, *presence))).collect();
        shapes.sort_by_key(|(shape, _)| match shape {
            Shape::Edges(..) => 0,
            Shape::Room(_) => 1,
            Shape::Solid(_) => 2,
            Shape::Surface(_) => 3,
            Shape::Wire { .. } => 4,
        });
        for (number, (shape, presence)) in shapes.into_iter().enumerate() {
            match shape {
                Shape::Edges(least, greatest) => house::edges(&mut self.buffer, view, [*least, *greatest], presence),
                Shape::Room(room) => house::house(&mut self.buffer, view, canvas, room, presence),
                Shape::Solid(outline) => house::gumdrop(&mut self.buffer, view, outline, number, presence),
                Shape::Wire { points, closed } => {
                    let points: Vec<_> =
                        points.iter().map(|[x, y, _]| view.camera.screen_from_world([*x, *y])).collect();
                    let color = view.theme.annotation.gamma_multiply(0.6 * presence);
                    self.buffer.line(&points, *closed, WIRE, color);
                }
                // Those in space are sorted together with the membranes.
                Shape::Surface(_) => {}
            }
        }
        let pointed = pointed.and_then(|[effect, solid]| {
            let (shapes, presence) = self.effects.get(effect)?;
            let mut solids =
                shapes.iter().filter_map(|shape| if let Shape::Solid(outline) = shape { Some(outline) } else { None });
            Some((solids.nth(solid)?, *presence))
        });
        if let Some((outline, presence)) = pointed {
            house::ring(&mut self.buffer, view, outline, presence);
        }
        self.buffer.finish()
    }
}

/// Target presence of an effect in a mode.
pub fn presence_in(mode: Mode, effect: &EffectLevel) -> f32 {
    match (effect.switch, effect.when, mode) {
        (Switch::Off, ..) | (_, When::Collide, Mode::Simulate) => 0.0,
        (_, When::Collide, Mode::Edit) => PALE,
        _ => 1.0,
    }
}
