//! Draws marks at vertices: pins, rollers, the vertex that a click would select, and the mouse spring with its force.

use super::{View, card, shape_buffer::ShapeBuffer};
use crate::{
    app::numbers::si_fixed,
    snapshot::{Pull, Snapshot},
};
use eframe::egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Vec2, vec2};
use std::f32::consts::TAU;

/// Duration of the animation of a new pin \[s\].
const POP: f64 = 0.12;

/// Number of pins above which they are drawn small, without computing their distances.
const MANY: usize = 300;

/// The pins of a scene and the time at which each was placed.
#[derive(Debug, Default)]
pub struct Pins {
    generation: Option<u64>,
    since: Vec<(u32, f64)>,
}

impl Pins {
    /// Adds new pins at a time \[s\]. Pins of a new scene have no animation.
    pub fn follow(&mut self, snapshot: &Snapshot, now: f64) {
        let known = self.generation == Some(snapshot.generation);
        self.generation = Some(snapshot.generation);
        if self.since.iter().map(|pin| pin.0).eq(snapshot.pins.iter().copied()) {
            return;
        }
        let since = |&vertex: &u32| match self.since.binary_search_by_key(&vertex, |pin| pin.0) {
            Ok(place) if known => self.since[place],
            _ => (vertex, if known { now } else { f64::NEG_INFINITY }),
        };
        self.since = snapshot.pins.iter().map(since).collect();
    }

    /// Whether the animation of a pin is running.
    pub fn is_moving(&self, now: f64) -> bool {
        self.since.iter().any(|pin| now - pin.1 < POP)
    }

    /// Draws the pins at their vertices.
    pub fn draw(&self, buffer: &mut ShapeBuffer, view: View, points: &[Pos2], now: f64) {
        let full = view.size(0.0115, 5.5, 22.0);
        for (place, &(vertex, since)) in self.since.iter().enumerate() {
            let Some(&at) = points.get(vertex as usize) else { continue };
            let spacing = 0.56 * self.spacing(place, points);
            peppermint(
                buffer,
                view,
                at,
                spacing.clamp(0.5 * full, full) * pop(((now - since) / POP).clamp(0.0, 1.0) as f32),
            );
        }
    }

    /// Distance to the nearest other pin, so that pins in a row do not overlap; 0 above [`MANY`], where it takes too long.
    fn spacing(&self, place: usize, points: &[Pos2]) -> f32 {
        if self.since.len() > MANY {
            return 0.0;
        }
        let at = |i: usize| points.get(self.since[i].0 as usize).copied().unwrap_or_default();
        let others = (0..self.since.len()).filter(|&i| i != place);
        others.map(|i| at(i).distance(at(place))).fold(f32::INFINITY, f32::min)
    }
}

/// Easing curve from 0 to 1 that overshoots slightly.
fn pop(share: f32) -> f32 {
    let back = share - 1.0;
    1.0 + back * back * (2.7 * back + 1.7)
}

fn peppermint(buffer: &mut ShapeBuffer, view: View, at: Pos2, radius: f32) {
    let [red, _] = view.theme.candy;
    buffer.disc(at + vec2(0.0, 0.12 * radius), 1.14 * radius, Color32::from_black_alpha(110));
    buffer.disc(at, radius, Color32::WHITE);
    buffer.disc(at, 0.74 * radius, red);
    // A swirl of this size would be noise.
    if radius < 8.0 {
        buffer.disc(at - Vec2::splat(0.2 * radius), 0.17 * radius, Color32::WHITE);
        return;
    }
    for arm in 0..5 {
        let arc = |turn: f32, share: f32| at + Vec2::angled(TAU * (arc_of(arm) + turn)) * (share * radius);
        let outline = [at, arc(0.05, 0.42), arc(0.12, 0.75), arc(0.21, 0.75), arc(0.15, 0.42)];
        buffer.area(&outline, Color32::WHITE);
    }
}

fn arc_of(arm: u8) -> f32 {
    f32::from(arm) / 5.0
}

/// Draws a wheel at every vertex on rollers, and a rail for every side.
pub fn rollers(buffer: &mut ShapeBuffer, view: View, snapshot: &Snapshot, points: &[Pos2]) {
    let radius = view.size(0.007, 3.0, 12.0);
    let held = |slide: &(u32, usize)| {
        let at = points.get(slide.0 as usize).copied().unwrap_or_default();
        (slide.1, if slide.1 == 0 { at.x } else { at.y })
    };
    for side in snapshot.rollers.chunk_by(|a, b| held(a) == held(b)) {
        let wheels = || side.iter().filter_map(|slide| points.get(slide.0 as usize).copied());
        let Some(first) = wheels().next() else { continue };
        let along = if side[0].1 == 0 { vec2(0.0, 1.0) } else { vec2(1.0, 0.0) };
        let reach = wheels().fold(Rect::from_pos(first), |reach, at| reach.union(Rect::from_pos(at)));
        let beyond = along * (4.0 * radius);
        buffer.line(&[reach.min - beyond, reach.max + beyond], false, 0.6 * radius, view.theme.annotation);
        for at in wheels() {
            buffer.disc(at, radius, view.theme.annotation);
            buffer.disc(at, 0.62 * radius, Color32::WHITE);
        }
    }
}

/// Duration of the fade of the glow \[s\].
const FADE: f32 = 0.1;

/// Glow of the picked vertex.
#[derive(Debug, Default)]
pub struct Picked {
    vertex: Option<usize>,
    strength: f32,
}

impl Picked {
    /// Moves the glow to another vertex, or fades it out.
    pub fn follow(&mut self, wanted: Option<usize>, dt: f32) {
        if wanted.is_some() && wanted != self.vertex {
            // The new vertex starts with at least half of the glow, so that nothing flashes when the pointer moves along a body.
            self.strength = if self.vertex.is_some() { self.strength.max(0.5) } else { 0.0 };
            self.vertex = wanted;
        }
        let step = dt / FADE;
        self.strength = if wanted.is_some() { self.strength + step } else { self.strength - step }.clamp(0.0, 1.0);
        if self.strength == 0.0 && wanted.is_none() {
            self.vertex = None;
        }
    }

    /// Whether the glow still changes.
    pub fn is_moving(&self) -> bool {
        self.vertex.is_some() && self.strength < 1.0
    }

    /// Draws the glow, and a thin line from a distant pointer.
    pub fn draw(&self, buffer: &mut ShapeBuffer, view: View, points: &[Pos2], pointer: Option<Pos2>) {
        let Some(&at) = self.vertex.and_then(|vertex| points.get(vertex)) else { return };
        let (radius, color) = (view.size(0.011, 5.5, 20.0), view.theme.glow.gamma_multiply(self.strength));
        if let Some(pointer) = pointer.filter(|pointer| pointer.distance(at) > 4.0 * radius) {
            let hair = [pointer, at + (pointer - at).normalized() * radius];
            buffer.line(&hair, false, 1.2, color.gamma_multiply(0.45));
        }
        buffer.halo(at, 3.6 * radius, color.gamma_multiply(0.55));
        let ring: Vec<Pos2> = (0..24).map(|i| at + eframe::egui::Vec2::angled(0.2618 * i as f32) * radius).collect();
        buffer.line(&ring, true, 3.5, view.theme.crust.gamma_multiply(0.5 * self.strength));
        buffer.line(&ring, true, 2.0, color);
    }
}

/// Shaft width and head length of an arrow [points].
struct Size {
    width: f32,
    head: f32,
}

/// Draws the arrow from its vertex to its target.
pub fn arrow(buffer: &mut ShapeBuffer, view: View, [from, to]: [Pos2; 2]) {
    let length = from.distance(to);
    let width = (view.size(0.006, 2.5, 14.0) + 0.012 * length).min(view.size(0.013, 5.0, 30.0));
    let head = (0.35 * length).clamp(0.0, 5.0 * width);
    let outline = view.theme.icing.gamma_multiply(0.9);
    stroke(buffer, from, to, &Size { width: width + 3.0, head: head + 4.0 }, outline);
    stroke(buffer, from, to, &Size { width, head }, view.theme.pull);
}

fn stroke(buffer: &mut ShapeBuffer, from: Pos2, to: Pos2, size: &Size, color: Color32) {
    buffer.disc(from, 0.9 * size.width, color);
    if size.head < 1.5 * size.width {
        return buffer.line(&[from, to], false, size.width, color);
    }
    let along = (to - from).normalized();
    // The tip lies half a width beyond `to`, so that the outline is visible in front of the head and behind it.
    let tip = to + along * (0.5 * size.width);
    let neck = tip - along * size.head;
    buffer.line(&[from, neck], false, size.width, color);
    let aside = along.rot90() * (0.48 * size.head);
    let notch = neck + along * (0.18 * size.head);
    buffer.area(&[tip, neck + aside, notch, neck - aside], color);
    buffer.line(&[tip, neck + aside, notch, neck - aside], true, 0.4 * size.width, color);
}

/// Writes the force beside the arrow's head.
pub fn pull_force(painter: &Painter, view: View, canvas: Rect, [from, to]: [Pos2; 2], pull: &Pull) {
    let right = to.x >= from.x;
    let gap = view.size(0.035, 18.0, 90.0);
    let font = FontId::monospace(view.size(0.024, 14.0, 40.0));
    // Without room beside the head the text lies above or below it.
    let room = if right { canvas.right() - to.x } else { to.x - canvas.left() };
    let (aside, anchor) = if room < gap + 6.5 * font.size {
        if to.y > from.y { (vec2(0.0, gap), Align2::CENTER_TOP) } else { (vec2(0.0, -gap), Align2::CENTER_BOTTOM) }
    } else if right {
        (vec2(gap, 0.0), Align2::LEFT_CENTER)
    } else {
        (vec2(-gap, 0.0), Align2::RIGHT_CENTER)
    };
    let text = si_fixed(pull.force, "N");
    let color = view.theme.pull.lerp_to_gamma(view.theme.annotation, 0.35);
    card(painter, view, canvas, (to + aside, anchor), (text.trim(), font, color));
}
