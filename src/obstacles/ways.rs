//! The way out of solids that a body begins inside of.

use super::{Encounter, Noted, Obstacle, Overlap, Start, Touching};
use std::ops::Range;

/// How many vertices of a body are asked how far they would have to go.
const ASKED: usize = 96;

/// Looks where all vertices are, seen from obstacles that come in the order of their numbers, and which bodies begin inside some.
pub fn note<'a>(near: &(impl Iterator<Item = Encounter<'a>> + Clone), start: &Start<'_>, noted: &mut Noted) {
    noted.touching.clear();
    noted.overlaps.clear();
    near.clone().for_each(|obstacle| obstacle.find_touching(start, &mut noted.touching));
    if !noted.touching.iter().any(|touching| touching.is_deep) {
        return;
    }
    let mut first = 0;
    for exit in start.exits {
        let vertices = first..exit.end;
        first = exit.end;
        let Noted { touching, overlaps } = &mut *noted;
        let own = || touching.iter().filter(|touching| vertices.contains(&touching.vertex));
        let holds =
            |obstacle: &Encounter<'_>| own().any(|own| own.obstacle == obstacle.number() && obstacle.holds(start, own));
        let keeps = |obstacle: &Encounter<'_>| own().any(|own| obstacle.keeps(start, own));
        let overlap =
            |obstacle: Encounter<'_>, way| Overlap { obstacle: obstacle.number(), vertices: vertices.clone(), way };
        let keeping = near.clone().filter(|obstacle| holds(obstacle) && keeps(obstacle));
        overlaps.extend(keeping.map(|obstacle| overlap(obstacle, [0.0; 2])));
        let holding = near.clone().filter(|obstacle| holds(obstacle) && !keeps(obstacle));
        let deep = || own().filter(|own| own.is_deep).map(|own| own.vertex);
        let velocity = mean(start.v, deep());
        let is_on = |way: [f64; 2]| (0.5..=2.0).contains(&((velocity[0] * way[0] + velocity[1] * way[1]) / exit.speed));
        let Some(way) = out(&holding, near, start, &vertices, &is_on) else { continue };
        // What slides on a rail across the way is left to the nearest surface.
        if deep().any(|vertex| start.movable(vertex, way).is_some()) {
            overlaps.extend(holding.map(|obstacle| overlap(obstacle, way)));
        }
    }
    noted.overlaps.sort_unstable_by_key(|overlap| (overlap.obstacle, overlap.vertices.start));
}

/// The mean of what some vertices have.
fn mean(values: &[f64], vertices: impl Iterator<Item = usize>) -> [f64; 2] {
    let (mut sum, mut count) = ([0.0; 2], 0.0);
    for vertex in vertices {
        sum = [sum[0] + values[2 * vertex], sum[1] + values[2 * vertex + 1]];
        count += 1.0;
    }
    sum.map(|sum| sum / count)
}

/// What is on its way out goes on, unless another is shorter than this share of it.
const TURNS: f64 = 0.25;

/// The direction in which a body, by its vertices, is soonest past all solids that hold it, of those across their sides; one that
/// runs into another wall only if every other does. Where it is on a way already, that counts as shorter.
fn out<'a>(
    holding: &(impl Iterator<Item = Encounter<'a>> + Clone),
    near: &(impl Iterator<Item = Encounter<'a>> + Clone),
    start: &Start<'_>,
    vertices: &Range<usize>,
    is_on: &dyn Fn([f64; 2]) -> bool,
) -> Option<[f64; 2]> {
    let asked = || {
        let some = vertices.clone().step_by(vertices.len().div_ceil(ASKED).max(1));
        some.map(|vertex| [start.x[2 * vertex], start.x[2 * vertex + 1]])
    };
    let mut best: Option<((bool, f64), [f64; 2])> = None;
    for solid in holding.clone() {
        solid.each_way(&mut |way| {
            let past = holding.clone().flat_map(|solid| asked().filter_map(move |point| solid.way_past(point, way)));
            let length = past.fold(0.0, f64::max);
            let is_blocked = near.clone().any(|wall| asked().any(|point| wall.blocks(point, way, length)));
            let price = (is_blocked, if is_on(way) { TURNS * length } else { length });
            if best.is_none_or(|(least, _)| price < least) {
                best = Some((price, way));
            }
        });
    }
    best.map(|(_, way)| way)
}

impl Encounter<'_> {
    /// Whether a vertex begins inside of it that it has a choice of ways for, and can be moved.
    fn holds(&self, start: &Start<'_>, own: &Touching) -> bool {
        own.is_deep && self.is_solid() && start.movable(own.vertex, own.contact.normal).is_some()
    }

    /// Whether a vertex inside of it is pinned: what is inside with it then stays, rather than being torn from it.
    fn keeps(&self, start: &Start<'_>, own: &Touching) -> bool {
        own.obstacle == self.number()
            && own.contact.distance < 0.0
            && start.movable(own.vertex, own.contact.normal).is_none()
    }

    /// Whether a point that goes so far along a way would get into a half-plane, or deeper into it.
    fn blocks(&self, point: [f64; 2], [wx, wy]: [f64; 2], length: f64) -> bool {
        let from = self.carry().place(point);
        let before = self.contact(from).map_or(f64::INFINITY, |contact| contact.distance);
        let after = self.contact([from[0] + length * wx, from[1] + length * wy]);
        !self.is_solid() && after.is_some_and(|after| after.distance < 0.0 && after.distance < before)
    }
}
