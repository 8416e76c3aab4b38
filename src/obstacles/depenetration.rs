//! Depenetration: the direction in which a body leaves what it begins inside of.

use super::{ContactCache, ContactQuery, Obstacle, Penetration, Start, Touching};
use std::ops::Range;

/// How many vertices of a body are asked how far they would have to go.
const SAMPLES: usize = 64;

/// What is on its way out goes on, unless another is shorter than this share of it.
const KEEP_DIRECTION: f64 = 0.25;

/// What would end deeper in a wall than this share of its size has no room beyond: it stays where it is, rather than being crushed.
const MAX_BLOCKED: f64 = 0.1;

/// What is pinned and would have to go farther than this share of its size out of half-planes, or than [`MAX_BLOCKED`] out of solids, which
/// may be in the midst of it, stays too, rather than being torn.
const MAX_PINNED: f64 = 0.25;

/// How far into a wall is no way into it, as a share of the way.
const ROUND_OFF: f64 = 1e-6;

/// Finds a way out for every body of which something begins deep inside: of all these obstacles, with what touches them noted.
pub fn find_penetrations(obstacles: &[ContactQuery<'_>], start: &Start<'_>, contact_cache: &mut ContactCache) {
    let ContactCache { touching, penetrations, directions } = contact_cache;
    let mut first = 0;
    for depenetration in start.depenetrations {
        let vertices = first..depenetration.end;
        first = depenetration.end;
        let own = || touching.iter().filter(|touching| vertices.contains(&touching.vertex));
        let deep = || own().filter(|own| own.is_deep);
        if deep().next().is_none() {
            continue;
        }
        let velocity = mean(deep().map(|own| [0, 1].map(|axis| start.v[2 * own.vertex + axis] - own.wall[axis])));
        let body = Body {
            start,
            vertices: vertices.clone(),
            touching,
            relative_velocity: velocity.map(|along| along / depenetration.speed),
        };
        let mut penetration = |obstacle: &ContactQuery<'_>, direction| {
            penetrations.push(Penetration { obstacle: obstacle.name(), vertices: vertices.clone(), direction });
        };
        let inside = obstacles.iter().filter(|obstacle| body.is_in(obstacle, own()));
        let (keeping, holding): (Vec<_>, Vec<&ContactQuery<'_>>) =
            inside.partition(|obstacle| body.is_kept(obstacle, own()));
        for obstacle in keeping {
            penetration(obstacle, [0.0; 2]);
        }
        // Where no way leads out of everything, as between walls that face each other, solids have one, and each wall has its own.
        let (solid, flat): (Vec<_>, Vec<&ContactQuery<'_>>) =
            holding.iter().copied().partition(|obstacle| obstacle.is_solid());
        let common = body.find_path(&holding, obstacles, directions);
        let apart = || body.find_path(&solid, obstacles, directions);
        let Some(DepenetrationPath { direction, length, blocked }) =
            common.or_else(apart).or_else(|| (!flat.is_empty()).then_some(DepenetrationPath::NONE))
        else {
            continue;
        };
        let blocked = if common.is_none() { blocked + body.depth(&flat) } else { blocked };
        let is_pinned = || vertices.clone().any(|vertex| start.inverse_mass[2 * vertex..2 * vertex + 2] == [0.0; 2]);
        let leash = if solid.is_empty() { MAX_PINNED } else { MAX_BLOCKED };
        if blocked > MAX_BLOCKED * body.size() || (length > leash * body.size() && is_pinned()) {
            for obstacle in holding {
                penetration(obstacle, [0.0; 2]);
            }
            continue;
        }
        // What slides on a rail across the way is left to the nearest surface.
        if deep().any(|own| start.movable(own.vertex, direction).is_some()) {
            let together = if common.is_some() { &holding } else { &solid };
            for obstacle in together {
                penetration(obstacle, direction);
            }
        }
        if common.is_none() {
            for obstacle in flat {
                obstacle.each_direction(&mut |direction| penetration(obstacle, direction));
            }
        }
    }
    penetrations.sort_unstable_by_key(|penetration| (penetration.obstacle, penetration.vertices.start));
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
struct DepenetrationPath {
    /// Unit vector.
    direction: [f64; 2],
    /// How far it is along there until the last of the body is out [m].
    length: f64,
    /// How deep it leads into some half-plane beyond [m].
    blocked: f64,
}

impl DepenetrationPath {
    const NONE: Self = Self { direction: [0.0; 2], length: 0.0, blocked: 0.0 };
}

/// A body of which something begins deep inside.
struct Body<'a> {
    start: &'a Start<'a>,
    vertices: Range<usize>,
    /// What touches which obstacle.
    touching: &'a [Touching],
    /// The velocity of what is inside, seen from there, in speeds at which that comes out.
    relative_velocity: [f64; 2],
}

impl Body<'_> {
    /// Whether a vertex begins deep inside of an obstacle, and can be moved.
    fn is_in<'t>(&self, obstacle: &ContactQuery<'_>, mut own: impl Iterator<Item = &'t Touching>) -> bool {
        own.any(|own| own.obstacle == obstacle.name() && own.is_deep && self.is_free(own))
    }

    /// Whether a vertex inside of a solid is pinned: what is inside with it then stays, rather than being torn from it.
    fn is_kept<'t>(&self, obstacle: &ContactQuery<'_>, mut own: impl Iterator<Item = &'t Touching>) -> bool {
        obstacle.is_solid()
            && own.any(|own| own.obstacle == obstacle.name() && own.contact.distance < 0.0 && !self.is_free(own))
    }

    fn is_free(&self, own: &Touching) -> bool {
        self.start.movable(own.vertex, own.contact.normal).is_some()
    }

    /// Some vertices of the body, for all, and some of those that are deep inside.
    fn samples(&self) -> impl Iterator<Item = [f64; 2]> {
        let some = self.vertices.clone().step_by(self.vertices.len().div_ceil(SAMPLES).max(1));
        let deep = self.touching.iter().filter(|own| own.is_deep && self.vertices.contains(&own.vertex));
        let every = deep.clone().count().div_ceil(SAMPLES).max(1);
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
    fn depth(&self, flat: &[&ContactQuery<'_>]) -> f64 {
        let mut sum = 0.0;
        for wall in flat {
            wall.each_direction(&mut |direction| {
                sum += self
                    .samples()
                    .filter_map(|point| wall.depenetration_distance(point, direction))
                    .fold(0.0, f64::max);
            });
        }
        sum
    }

    /// The direction in which the body is soonest past all that holds it, of those that [`list_directions`] lists; one that runs into
    /// something else only if every other does. Where it is on a way already, that counts as shorter.
    fn find_path(
        &self,
        holding: &[&ContactQuery<'_>],
        obstacles: &[ContactQuery<'_>],
        directions: &mut Vec<[f64; 2]>,
    ) -> Option<DepenetrationPath> {
        list_directions(holding, obstacles, directions);
        let holds = |wall: &ContactQuery<'_>| holding.iter().any(|holding| holding.name() == wall.name());
        let clearance = MAX_BLOCKED * self.size();
        let mut best: Option<((u8, f64), DepenetrationPath)> = None;
        for &direction in &*directions {
            let past = |obstacle: &&ContactQuery<'_>| {
                self.samples().filter_map(|point| obstacle.depenetration_distance(point, direction)).fold(0.0, f64::max)
            };
            let length = holding.iter().map(past).fold(0.0, f64::max);
            let along = self.relative_velocity[0] * direction[0] + self.relative_velocity[1] * direction[1];
            let is_on = (0.5..=2.0).contains(&along);
            let long = if is_on { KEEP_DIRECTION * length } else { length };
            if !long.is_finite() || best.is_some_and(|((trouble, least), _)| trouble == 0 && least <= long) {
                continue;
            }
            // Free, hindered, or closed.
            let (mut trouble, mut blocked) = (0, 0.0_f64);
            for wall in obstacles.iter().filter(|wall| !holds(wall)) {
                for depth in self.samples().filter_map(|point| wall.blocks(point, direction, length)) {
                    (trouble, blocked) = (if depth > clearance { 2 } else { trouble.max(1) }, blocked.max(depth));
                }
            }
            let price = (if is_on && trouble == 1 { 0 } else { trouble }, long);
            if best.is_none_or(|(least, _)| price < least) {
                best = Some((price, DepenetrationPath { direction, length, blocked }));
            }
        }
        best.map(|(_, path)| path)
    }
}

/// Writes the ways out of each obstacle, those half-way between one out of a half-plane and any other, and those along the
/// half-planes beyond which one would lead.
fn list_directions(holding: &[&ContactQuery<'_>], obstacles: &[ContactQuery<'_>], directions: &mut Vec<[f64; 2]>) {
    directions.clear();
    let add = |directions: &mut Vec<[f64; 2]>, direction: [f64; 2]| {
        let length = (direction[0] * direction[0] + direction[1] * direction[1]).sqrt();
        if length > 0.1 {
            directions.push(direction.map(|along| along / length));
        }
    };
    for obstacle in holding.iter().filter(|obstacle| !obstacle.is_solid()) {
        obstacle.each_direction(&mut |direction| directions.push(direction));
    }
    let flat = directions.len();
    for obstacle in holding.iter().filter(|obstacle| obstacle.is_solid()) {
        obstacle.each_direction(&mut |direction| directions.push(direction));
    }
    let single = directions.len();
    for a in 0..flat {
        for b in a + 1..single {
            add(directions, [directions[a][0] + directions[b][0], directions[a][1] + directions[b][1]]);
        }
    }
    let holds = |wall: &ContactQuery<'_>| holding.iter().any(|holding| holding.name() == wall.name());
    for wall in obstacles.iter().filter(|wall| !wall.is_solid() && !holds(wall)) {
        wall.each_direction(&mut |[nx, ny]| {
            for number in 0..single {
                let [wx, wy] = directions[number];
                let inwards = wx * nx + wy * ny;
                if inwards < 0.0 {
                    add(directions, [wx - inwards * nx, wy - inwards * ny]);
                }
            }
        });
    }
}

impl ContactQuery<'_> {
    /// Whether a point that goes so far along a way would get into it, or deeper into a half-plane: how deep that is there, and
    /// nothing for a solid, round which there may be a way [m].
    fn blocks(&self, point: [f64; 2], direction: [f64; 2], length: f64) -> Option<f64> {
        let from = self.swept_motion().place(point);
        let displacement = direction.map(|along| length * along);
        if self.is_solid() {
            return self.cast(from, displacement).map(|_| 0.0);
        }
        let before = self.contact(from).map_or(f64::INFINITY, |contact| contact.distance);
        let after = self.contact([from[0] + displacement[0], from[1] + displacement[1]])?.distance;
        (after.max(after - before) < -ROUND_OFF * length).then_some(-after)
    }
}
