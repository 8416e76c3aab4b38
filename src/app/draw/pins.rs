//! Draws pins.

use super::{View, shape_buffer::ShapeBuffer};
use crate::snapshot::Snapshot;
use eframe::egui::{Color32, Pos2, Vec2, vec2};
use std::f32::consts::TAU;

/// Duration of the animation of a new pin [s].
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
    /// Adds new pins at a time [s]. Pins of a new scene have no animation.
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
