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
        let holds = |obstacle: &Encounter<'_>| {
            let own = touching.iter().filter(|touching| touching.obstacle == obstacle.number());
            own.filter(|touching| vertices.contains(&touching.vertex)).any(|own| obstacle.holds(start, own))
        };
        let holding = near.clone().filter(holds);
        let Some(way) = out(&holding, near, start, &vertices) else { continue };
        // What slides on a rail across the way is left to the nearest surface.
        let mut deep = touching.iter().filter(|touching| touching.is_deep && vertices.contains(&touching.vertex));
        if !deep.any(|deep| start.movable(deep.vertex, way).is_some()) {
            continue;
        }
        overlaps.extend(holding.map(|obstacle| Overlap {
            obstacle: obstacle.number(),
            vertices: vertices.clone(),
            way,
        }));
    }
    noted.overlaps.sort_unstable_by_key(|overlap| (overlap.obstacle, overlap.vertices.start));
}

/// The direction in which a body, by its vertices, is soonest past all solids that hold it, of those across their sides; one that
/// runs into another wall only if every other does.
fn out<'a>(
    holding: &(impl Iterator<Item = Encounter<'a>> + Clone),
    near: &(impl Iterator<Item = Encounter<'a>> + Clone),
    start: &Start<'_>,
    vertices: &Range<usize>,
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
            let price = (is_blocked, length);
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

    /// Whether a point that goes so far along a way would get into a half-plane, or deeper into it.
    fn blocks(&self, point: [f64; 2], [wx, wy]: [f64; 2], length: f64) -> bool {
        let from = self.carry().place(point);
        let before = self.contact(from).map_or(f64::INFINITY, |contact| contact.distance);
        let after = self.contact([from[0] + length * wx, from[1] + length * wy]);
        !self.is_solid() && after.is_some_and(|after| after.distance < 0.0 && after.distance < before)
    }
}
