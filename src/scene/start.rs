//! Start of bodies: shapes, pinned vertices and rollers.

use crate::{
    level::{Side, StartShape},
    meshes::{Numbering, extent, on_edge},
    random,
};

/// Applies the start shape to the free vertices of a body, flat \[m\]. Random numbers are drawn in the order of the list.
pub(super) fn reshape(
    shape: StartShape,
    (pins, rollers): (&[u32], &[(u32, usize)]),
    numbering: &Numbering,
    x: &mut [f64],
) {
    let constrained: Vec<(usize, f64)> = {
        let pinned = pins.iter().flat_map(|&pin| [(pin, 0), (pin, 1)]);
        let numbers = pinned.chain(rollers.iter().copied()).map(|(vertex, axis)| 2 * vertex as usize + axis);
        numbers.map(|number| (number, x[number])).collect()
    };
    let bounds = [extent(x, 0), extent(x, 1)];
    let middle = bounds.map(|(least, greatest)| 0.5 * (least + greatest));
    let half = bounds.map(|(least, greatest)| 0.5 * (greatest - least));
    match shape {
        StartShape::Rest => return,
        StartShape::Scrambled { seed } => {
            let mut random = random::stream(seed);
            for vertex in listed(numbering, x.len() / 2) {
                for axis in 0..2 {
                    x[2 * vertex + axis] = middle[axis] + half[axis] * random.next().unwrap_or(0.0);
                }
            }
        }
        StartShape::Line { seed, noise } => map(x, numbering, middle, [1.0, 0.0], (seed, noise.get() * size(half))),
        StartShape::Point { seed, noise } => map(x, numbering, middle, [0.0, 0.0], (seed, noise.get() * size(half))),
        StartShape::Mirrored { seed, noise } => {
            map(x, numbering, middle, [1.0, -1.0], (seed, noise.get() * size(half)));
        }
    }
    for (number, value) in constrained {
        x[number] = value;
    }
}

/// Vertices in the order of the list.
fn listed(numbering: &Numbering, count: usize) -> impl Iterator<Item = usize> {
    (0..count as u32).map(|name| numbering.vertex(name) as usize)
}

/// Length of the longer side of a box, from its halves.
fn size([width, height]: [f64; 2]) -> f64 {
    2.0 * width.max(height)
}

/// Scales positions along a random direction and across it about the centre; then adds noise up to a length \[m\] along
/// each axis.
fn map(x: &mut [f64], numbering: &Numbering, middle: [f64; 2], factors: [f64; 2], (seed, noise): (u32, f64)) {
    let mut random = random::stream(seed);
    let angle = std::f64::consts::PI * random.next().unwrap_or(0.0);
    let (c, s) = (libm::cos(angle), libm::sin(angle));
    for vertex in listed(numbering, x.len() / 2) {
        let point = &mut x[2 * vertex..2 * vertex + 2];
        let away = [point[0] - middle[0], point[1] - middle[1]];
        let along = factors[0] * (c * away[0] + s * away[1]);
        let across = factors[1] * (c * away[1] - s * away[0]);
        for (axis, moved) in [c * along - s * across, s * along + c * across].into_iter().enumerate() {
            point[axis] = middle[axis] + moved + noise * random.next().unwrap_or(0.0);
        }
    }
}

/// The vertices on rollers along a side, and their fixed coordinate.
pub(super) fn sliding(side: Side, rest: &[f64]) -> impl Iterator<Item = (u32, usize)> {
    let (axis, greatest) = side.across();
    on_edge(rest, axis, greatest).map(move |vertex| (vertex, axis))
}
