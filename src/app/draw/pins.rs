//! Draws pins.

use super::{View, shape_buffer::ShapeBuffer};
use crate::snapshot::Snapshot;
use eframe::egui::{Color32, Pos2, Vec2, vec2};
use std::f32::consts::TAU;

/// How long a pin takes to pop in [s].
const POP: f64 = 0.12;

/// Beyond this number pins are drawn small without looking at each other.
const MANY: usize = 300;

/// The pins of a scene and when each was put in.
#[derive(Debug, Default)]
pub struct Pins {
    generation: Option<u64>,
    since: Vec<(u32, f64)>,
}

impl Pins {
    /// Notices new pins at a time [s]. Those of a new scene have always been there.
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

    /// Whether a pin is still popping in.
    pub fn is_moving(&self, now: f64) -> bool {
        self.since.iter().any(|pin| now - pin.1 < POP)
    }

    /// Draws them on the vertices' places.
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

    /// The distance to the nearest other pin, so that a row of pins stays a row; not worth finding among very many.
    fn spacing(&self, place: usize, points: &[Pos2]) -> f32 {
        if self.since.len() > MANY {
            return 0.0;
        }
        let at = |i: usize| points.get(self.since[i].0 as usize).copied().unwrap_or_default();
        let others = (0..self.since.len()).filter(|&i| i != place);
        others.map(|i| at(i).distance(at(place))).fold(f32::INFINITY, f32::min)
    }
}

/// From 0 to 1, a little too far on the way.
fn pop(share: f32) -> f32 {
    let back = share - 1.0;
    1.0 + back * back * (2.7 * back + 1.7)
}

fn peppermint(buffer: &mut ShapeBuffer, view: View, at: Pos2, radius: f32) {
    let [red, _] = view.theme.candy;
    buffer.disc(at + vec2(0.0, 0.12 * radius), 1.14 * radius, Color32::from_black_alpha(110));
    buffer.disc(at, radius, Color32::WHITE);
    buffer.disc(at, 0.74 * radius, red);
    // Below this size a swirl is only noise.
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
