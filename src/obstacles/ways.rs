//! Depenetration: the direction in which a body leaves what it begins inside of.

use super::{Encounter, Noted, Obstacle, Overlap, Start, Touching};
use std::ops::Range;

/// How many vertices of a body are asked how far they would have to go.
const ASKED: usize = 64;

/// What is on its way out goes on, unless another is shorter than this share of it.
const TURNS: f64 = 0.25;

/// What would end deeper in a wall than this share of its size has no room beyond: it stays where it is, rather than being crushed.
const TIGHT: f64 = 0.1;

/// What is pinned and would have to go farther than this share of its size out of half-planes, or than [`TIGHT`] out of solids, which
/// may be in the midst of it, stays too, rather than being torn.
const LEASH: f64 = 0.25;

/// How far into a wall is no way into it, as a share of the way.
const ROUND_OFF: f64 = 1e-6;

/// Finds a way out for every body of which something begins deep inside: of all these obstacles, with what touches them noted.
pub fn find_ways(obstacles: &[Encounter<'_>], start: &Start<'_>, noted: &mut Noted) {
    let Noted { touching, overlaps, ways } = noted;
    let mut first = 0;
    for exit in start.exits {
        let vertices = first..exit.end;
        first = exit.end;
        let own = || touching.iter().filter(|touching| vertices.contains(&touching.vertex));
        let deep = || own().filter(|own| own.is_deep);
        if deep().next().is_none() {
            continue;
        }
        let velocity = mean(deep().map(|own| [0, 1].map(|axis| start.v[2 * own.vertex + axis] - own.wall[axis])));
        let body = Body { start, vertices: vertices.clone(), touching, pace: velocity.map(|along| along / exit.speed) };
        let mut overlap = |obstacle: &Encounter<'_>, way| {
            overlaps.push(Overlap { obstacle: obstacle.name(), vertices: vertices.clone(), way });
        };
        let inside = obstacles.iter().filter(|obstacle| body.is_in(obstacle, own()));
        let (keeping, holding): (Vec<_>, Vec<&Encounter<'_>>) =
            inside.partition(|obstacle| body.is_kept(obstacle, own()));
        for obstacle in keeping {
            overlap(obstacle, [0.0; 2]);
        }
        // Where no way leads out of everything, as between walls that face each other, solids have one, and each wall has its own.
        let (solid, flat): (Vec<_>, Vec<&Encounter<'_>>) =
            holding.iter().copied().partition(|obstacle| obstacle.is_solid());
        let common = body.way_out(&holding, obstacles, ways);
        let apart = || body.way_out(&solid, obstacles, ways);
        let Some(WayOut { way, length, jam }) =
            common.or_else(apart).or_else(|| (!flat.is_empty()).then_some(WayOut::NONE))
        else {
            continue;
        };
        let jam = if common.is_none() { jam + body.depth(&flat) } else { jam };
        let is_pinned = || vertices.clone().any(|vertex| start.inverse_mass[2 * vertex..2 * vertex + 2] == [0.0; 2]);
        let leash = if solid.is_empty() { LEASH } else { TIGHT };
        if jam > TIGHT * body.size() || (length > leash * body.size() && is_pinned()) {
            for obstacle in holding {
                overlap(obstacle, [0.0; 2]);
            }
            continue;
        }
        // What slides on a rail across the way is left to the nearest surface.
        if deep().any(|own| start.movable(own.vertex, way).is_some()) {
            let together = if common.is_some() { &holding } else { &solid };
            for obstacle in together {
                overlap(obstacle, way);
            }
        }
        if common.is_none() {
            for obstacle in flat {
                obstacle.each_way(&mut |way| overlap(obstacle, way));
            }
        }
    }
    overlaps.sort_unstable_by_key(|overlap| (overlap.obstacle, overlap.vertices.start));
}

/// The mean of some vectors.
fn mean(vectors: impl Iterator<Item = [f64; 2]>) -> [f64; 2] {
    let (mut sum, mut count) = ([0.0; 2], 0.0);
    for [x, y] in vectors {
        sum = [sum[0] + x, sum[1] + y];
        count += 1.0;
    }
    sum.map(|sum| sum / count)
}

/// A way out of what holds a body.
#[derive(Clone, Copy)]
struct WayOut {
    /// Unit vector.
    way: [f64; 2],
    /// How far it is along there until the last of the body is out [m].
    length: f64,
    /// How deep it leads into some half-plane beyond [m].
    jam: f64,
}

impl WayOut {
    const NONE: Self = Self { way: [0.0; 2], length: 0.0, jam: 0.0 };
}

/// A body of which something begins deep inside.
struct Body<'a> {
    start: &'a Start<'a>,
    vertices: Range<usize>,
    /// What touches which obstacle.
    touching: &'a [Touching],
    /// The velocity of what is inside, seen from there, in speeds at which that comes out.
    pace: [f64; 2],
}

impl Body<'_> {
    /// Whether a vertex begins deep inside of an obstacle, and can be moved.
    fn is_in<'t>(&self, obstacle: &Encounter<'_>, mut own: impl Iterator<Item = &'t Touching>) -> bool {
        own.any(|own| own.obstacle == obstacle.name() && own.is_deep && self.is_free(own))
    }

    /// Whether a vertex inside of a solid is pinned: what is inside with it then stays, rather than being torn from it.
    fn is_kept<'t>(&self, obstacle: &Encounter<'_>, mut own: impl Iterator<Item = &'t Touching>) -> bool {
        obstacle.is_solid()
            && own.any(|own| own.obstacle == obstacle.name() && own.contact.distance < 0.0 && !self.is_free(own))
    }

    fn is_free(&self, own: &Touching) -> bool {
        self.start.movable(own.vertex, own.contact.normal).is_some()
    }

    /// Some vertices of the body, for all, and some of those that are deep inside.
    fn asked(&self) -> impl Iterator<Item = [f64; 2]> {
        let some = self.vertices.clone().step_by(self.vertices.len().div_ceil(ASKED).max(1));
        let deep = self.touching.iter().filter(|own| own.is_deep && self.vertices.contains(&own.vertex));
        let every = deep.clone().count().div_ceil(ASKED).max(1);
        some.chain(deep.step_by(every).map(|own| own.vertex))
            .map(|vertex| [self.start.x[2 * vertex], self.start.x[2 * vertex + 1]])
    }

    /// The diagonal of a box around it [m].
    fn size(&self) -> f64 {
        let points = || self.vertices.clone().map(|vertex| [self.start.x[2 * vertex], self.start.x[2 * vertex + 1]]);
        let extent = |axis: usize| {
            let along = points().map(|point| point[axis]);
            along.clone().fold(f64::NEG_INFINITY, f64::max) - along.fold(f64::INFINITY, f64::min)
        };
        let (width, height) = (extent(0), extent(1));
        (width * width + height * height).sqrt()
    }

    /// How deep it is in all of these together [m].
    fn depth(&self, flat: &[&Encounter<'_>]) -> f64 {
        let mut sum = 0.0;
        for wall in flat {
            wall.each_way(&mut |way| {
                sum += self.asked().filter_map(|point| wall.way_past(point, way)).fold(0.0, f64::max);
            });
        }
        sum
    }

    /// The direction in which the body is soonest past all that holds it, of those that [`list_ways`] lists; one that runs into
    /// something else only if every other does. Where it is on a way already, that counts as shorter.
    fn way_out(
        &self,
        holding: &[&Encounter<'_>],
        obstacles: &[Encounter<'_>],
        ways: &mut Vec<[f64; 2]>,
    ) -> Option<WayOut> {
        list_ways(holding, obstacles, ways);
        let holds = |wall: &Encounter<'_>| holding.iter().any(|holding| holding.name() == wall.name());
        let room = TIGHT * self.size();
        let mut best: Option<((u8, f64), WayOut)> = None;
        for &way in &*ways {
            let past = |obstacle: &&Encounter<'_>| {
                self.asked().filter_map(|point| obstacle.way_past(point, way)).fold(0.0, f64::max)
            };
            let length = holding.iter().map(past).fold(0.0, f64::max);
            let along = self.pace[0] * way[0] + self.pace[1] * way[1];
            let is_on = (0.5..=2.0).contains(&along);
            let long = if is_on { TURNS * length } else { length };
            if !long.is_finite() || best.is_some_and(|((trouble, least), _)| trouble == 0 && least <= long) {
                continue;
            }
            // Free, hindered, or closed.
            let (mut trouble, mut jam) = (0, 0.0_f64);
            for wall in obstacles.iter().filter(|wall| !holds(wall)) {
                for depth in self.asked().filter_map(|point| wall.blocks(point, way, length)) {
                    (trouble, jam) = (if depth > room { 2 } else { trouble.max(1) }, jam.max(depth));
                }
            }
            let price = (if is_on && trouble == 1 { 0 } else { trouble }, long);
            if best.is_none_or(|(least, _)| price < least) {
                best = Some((price, WayOut { way, length, jam }));
            }
        }
        best.map(|(_, way)| way)
    }
}

/// Writes the ways out of each obstacle, those half-way between one out of a half-plane and any other, and those along the
/// half-planes beyond which one would lead.
fn list_ways(holding: &[&Encounter<'_>], obstacles: &[Encounter<'_>], ways: &mut Vec<[f64; 2]>) {
    ways.clear();
    let add = |ways: &mut Vec<[f64; 2]>, way: [f64; 2]| {
        let length = (way[0] * way[0] + way[1] * way[1]).sqrt();
        if length > 0.1 {
            ways.push(way.map(|along| along / length));
        }
    };
    for obstacle in holding.iter().filter(|obstacle| !obstacle.is_solid()) {
        obstacle.each_way(&mut |way| ways.push(way));
    }
    let flat = ways.len();
    for obstacle in holding.iter().filter(|obstacle| obstacle.is_solid()) {
        obstacle.each_way(&mut |way| ways.push(way));
    }
    let single = ways.len();
    for a in 0..flat {
        for b in a + 1..single {
            add(ways, [ways[a][0] + ways[b][0], ways[a][1] + ways[b][1]]);
        }
    }
    let holds = |wall: &Encounter<'_>| holding.iter().any(|holding| holding.name() == wall.name());
    for wall in obstacles.iter().filter(|wall| !wall.is_solid() && !holds(wall)) {
        wall.each_way(&mut |[nx, ny]| {
            for number in 0..single {
                let [wx, wy] = ways[number];
                let inwards = wx * nx + wy * ny;
                if inwards < 0.0 {
                    add(ways, [wx - inwards * nx, wy - inwards * ny]);
                }
            }
        });
    }
}

impl Encounter<'_> {
    /// Whether a point that goes so far along a way would get into it, or deeper into a half-plane: how deep that is there, and
    /// nothing for a solid, round which there may be a way [m].
    fn blocks(&self, point: [f64; 2], way: [f64; 2], length: f64) -> Option<f64> {
        let from = self.carry().place(point);
        let way = way.map(|along| length * along);
        if self.is_solid() {
            return self.cast(from, way).map(|_| 0.0);
        }
        let before = self.contact(from).map_or(f64::INFINITY, |contact| contact.distance);
        let after = self.contact([from[0] + way[0], from[1] + way[1]])?.distance;
        (after.max(after - before) < -ROUND_OFF * length).then_some(-after)
    }
}
