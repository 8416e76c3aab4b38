//! What begins inside an obstacle, or beyond an edge of the world, leaves it slowly.
//!
//! No step gets a vertex in there, but a level may begin so, a wall may be switched on where a body already is, and a pin may be
//! taken out. Put on the surface at once, everything inside would be flat on it, with an energy that came from nowhere. Instead
//! the surface counts as beginning where the vertex is, and comes out with it at a [`Exit::speed`] at which the body keeps its
//! shape: what is inside then moves as one, and a front at speed u in a medium whose waves have the speed c strains it by no more
//! than u/c (Graff, *Wave Motion in Elastic Solids*, 1975, section 2.1).
//!
//! Out of a half-plane there is one way. Out of a solid a body goes along the one direction in which it is soonest past it, and
//! what else of it lies on that way may pass through meanwhile: nearest surfaces would tear it to all sides ([`Overlap`]).

use super::{Start, Surface};
use std::ops::Range;

/// How fast some vertices leave what they begin inside of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exit {
    /// One past the last of these vertices; the first follows on those of the exit before.
    pub end: usize,
    /// How fast they come out [m/s]; infinite if at once.
    pub speed: f64,
}

/// A body or net that begins inside a solid, and its way out.
#[derive(Clone, Debug, PartialEq)]
pub struct Overlap {
    /// Which of some obstacles it is.
    pub obstacle: usize,
    /// The vertices of the body or net.
    pub vertices: Range<usize>,
    /// Unit vector along the way out.
    pub way: [f64; 2],
}

/// What a vertex has to do that begins too deep inside to be put on a surface within one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rise {
    /// How fast it comes out at least [m/s].
    pub speed: f64,
    /// How far it comes in the step at least [m].
    pub length: f64,
}

/// The share of a reach that is no depth: round-off, and what nooks press in.
const SHALLOW: f64 = 0.01;

/// Whether a vertex at a distance from a surface [m] is inside by more than round-off. It counts as inside within `skin` of the
/// surface, and feels it within `reach` [m].
pub fn is_deep(distance: f64, [skin, reach]: [f64; 2]) -> bool {
    distance < skin - SHALLOW * reach
}

impl Start<'_> {
    /// How a vertex leaves what it begins inside of, if that is not at once.
    pub fn exit(&self, vertex: usize) -> Option<&Exit> {
        self.exits.get(self.exits.partition_point(|exit| exit.end <= vertex))
    }

    /// How a vertex comes out that begins at a distance from a surface [m], if it begins deeper inside than it can come in this
    /// step: see [`is_deep`].
    pub fn rise(&self, vertex: usize, distance: f64, extents: [f64; 2]) -> Option<Rise> {
        if !is_deep(distance, extents) {
            return None;
        }
        let speed = self.exit(vertex)?.speed;
        let length = speed * (self.time[1] - self.time[0]);
        (distance + length < extents[0]).then_some(Rise { speed, length })
    }

    /// The way out of the obstacle at hand for the body of a vertex, if that begins inside.
    pub fn overlap(&self, vertex: usize) -> Option<&Overlap> {
        self.overlaps.iter().find(|overlap| overlap.vertices.contains(&vertex))
    }

    /// What a surface does to the velocity of a vertex that comes out with it at a speed along its unit normal: see
    /// [`Surface::answer`]. It gives nothing back, and its work is booked.
    pub fn lift(&self, vertex: usize, normal: [f64; 2], speed: f64, v: &mut [f64; 2]) -> Option<f64> {
        self.inside.set(true);
        let outwards = normal.map(|along| speed * along);
        let mut after = [v[0] - outwards[0], v[1] - outwards[1]];
        let surface = Surface { restitution: 0.0, ..self.surface };
        let kept = surface.answer(normal, [0.0; 2], &mut after)?;
        let mut work = 0.0;
        for axis in (0..2).filter(|axis| self.inverse_mass[2 * vertex + axis] != 0.0) {
            let given = after[axis] + outwards[axis];
            work += (given - v[axis]) / self.inverse_mass[2 * vertex + axis] * outwards[axis];
            v[axis] = given;
        }
        self.supply(work);
        Some(kept)
    }
}
