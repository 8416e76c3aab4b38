//! The way out of a solid that a body begins inside of.

use super::{Contact, Encounter, Obstacle, Start};
use std::ops::Range;

/// How many directions are tried, and how many vertices are asked how far they would have to go.
const TRIED: [usize; 2] = [8, 96];

/// The direction in which a body, by its vertices, is soonest past an obstacle that some of them begin deep inside of; `None` if none
/// do. Directions are those to the nearest surface, of some of these vertices spread among them all.
pub(super) fn out(obstacle: &Encounter<'_>, start: &Start<'_>, vertices: Range<usize>) -> Option<[f64; 2]> {
    let place = |vertex: usize| obstacle.carry().place([start.x[2 * vertex], start.x[2 * vertex + 1]]);
    let extents = [obstacle.skin(), obstacle.reach()];
    let contact = |vertex: usize| -> Option<Contact> {
        let contact = obstacle.contact(place(vertex)).filter(|contact| contact.distance < extents[0])?;
        start.rise(vertex, contact.distance, extents)?;
        start.movable(vertex, contact.normal).map(|_| contact)
    };
    let deep = vertices.clone().filter_map(contact).count();
    let asked = || vertices.clone().step_by(vertices.len().div_ceil(TRIED[1]).max(1)).map(place);
    let tried = vertices.clone().filter_map(contact).step_by(deep.div_ceil(TRIED[0]).max(1));
    let ways = tried.map(|Contact { normal, .. }| {
        let past = asked().filter_map(|point| obstacle.way_past(point, normal));
        (past.fold(0.0, f64::max), normal)
    });
    ways.min_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, way)| way)
}
