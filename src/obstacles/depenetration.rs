//! Depenetration: the direction in which a body leaves the obstacles that it penetrates.

use super::{ContactCache, ContactQuery, Obstacle, Penetration, Start, Touching};
use std::ops::Range;

/// Most vertices of a body whose depenetration distance is computed, of all and of the deep ones.
const SAMPLES: usize = 64;

/// A body keeps its direction of depenetration unless another path is shorter than this fraction of it.
const KEEP_DIRECTION: f64 = 0.25;

/// A body that would end deeper in another wall than this fraction of its size stays inside, so that it is not crushed.
const MAX_BLOCKED: f64 = 0.1;

/// A pinned body that would have to move farther than this fraction of its size out of half-planes, or than
/// [`MAX_BLOCKED`] out of solids, stays inside, so that it is not torn from its pins.
const MAX_PINNED: f64 = 0.25;

/// Penetration of another wall that counts as round-off, as a fraction of the path.
const ROUND_OFF: f64 = 1e-6;

/// Finds the direction of depenetration of every body with deep vertices, from all obstacles and the contacts in the
/// cache, and writes the penetrations.
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
        // Where no direction leads out of all obstacles, as between walls that face each other, solids get one, and
        // each wall its own.
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
        // Vertices on rollers across the direction are projected on the nearest surface.
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

/// A path of depenetration.
#[derive(Clone, Copy)]
struct DepenetrationPath {
    /// Unit vector.
    direction: [f64; 2],
    /// Distance along the direction until the last vertex is out \[m\].
    length: f64,
    /// Greatest depth in another half-plane at its end \[m\].
    blocked: f64,
}

impl DepenetrationPath {
    const NONE: Self = Self { direction: [0.0; 2], length: 0.0, blocked: 0.0 };
}

/// A body with vertices deep inside an obstacle.
struct Body<'a> {
    start: &'a Start<'a>,
    vertices: Range<usize>,
    /// Contacts at the start of the step.
    touching: &'a [Touching],
    /// Mean velocity of the deep vertices relative to the obstacles, in units of the depenetration speed.
    relative_velocity: [f64; 2],
}

impl Body<'_> {
    /// Whether a movable vertex begins deep inside an obstacle.
    fn is_in<'t>(&self, obstacle: &ContactQuery<'_>, mut own: impl Iterator<Item = &'t Touching>) -> bool {
        own.any(|own| own.obstacle == obstacle.name() && own.is_deep && self.is_free(own))
    }

    /// Whether a pinned vertex is inside a solid: the part that penetrates with it then stays, so that it is not torn
    /// from the pin.
    fn is_kept<'t>(&self, obstacle: &ContactQuery<'_>, mut own: impl Iterator<Item = &'t Touching>) -> bool {
        obstacle.is_solid()
            && own.any(|own| own.obstacle == obstacle.name() && own.contact.distance < 0.0 && !self.is_free(own))
    }

    fn is_free(&self, own: &Touching) -> bool {
        self.start.movable(own.vertex, own.contact.normal).is_some()
    }

    /// A sample of the vertices of the body, and a sample of the deep ones.
    fn samples(&self) -> impl Iterator<Item = [f64; 2]> {
        let some = self.vertices.clone().step_by(self.vertices.len().div_ceil(SAMPLES).max(1));
        let deep = self.touching.iter().filter(|own| own.is_deep && self.vertices.contains(&own.vertex));
        let every = deep.clone().count().div_ceil(SAMPLES).max(1);
        some.chain(deep.step_by(every).map(|own| own.vertex))
            .map(|vertex| [self.start.x[2 * vertex], self.start.x[2 * vertex + 1]])
    }

    /// Diagonal of its bounding box \[m\].
    fn size(&self) -> f64 {
        let points = || self.vertices.clone().map(|vertex| [self.start.x[2 * vertex], self.start.x[2 * vertex + 1]]);
        let extent = |axis: usize| {
            let along = points().map(|point| point[axis]);
            along.clone().fold(f64::NEG_INFINITY, f64::max) - along.fold(f64::INFINITY, f64::min)
        };
        let (width, height) = (extent(0), extent(1));
        (width * width + height * height).sqrt()
    }

    /// Sum of its depths in these obstacles \[m\].
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

    /// The direction with the least distance out of the penetrated obstacles, of those that [`list_directions`] lists.
    /// A direction that leads into another obstacle is taken only if every other does. The distance along the present
    /// direction of motion counts less.
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
            // 0: free, 1: into a solid or a little into a wall, 2: blocked.
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

/// Lists candidate directions: those of each obstacle, the bisectors of one of a half-plane and any other, and
/// projections on the half-planes that one would lead into.
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
    /// Depth in this obstacle of a point after a displacement, if it enters or gets deeper; zero for a solid, which the
    /// body may pass \[m\].
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
