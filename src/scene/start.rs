//! Start of bodies and membranes: shapes, pinned vertices and rollers.

use crate::{
    level::{Side, StartShape},
    meshes::{Numbering, on_edge},
    random,
};

/// Applies the start shape to the free vertices of a body, or of a membrane with its own plane as the first two of three axes, flat
/// \[m\]. Random numbers are drawn in the order of the list.
pub(super) fn reshape<const D: usize>(
    shape: StartShape,
    (pins, rollers): (&[u32], &[(u32, usize)]),
    numbering: &Numbering,
    x: &mut [f64],
) {
    let constrained: Vec<(usize, f64)> = {
        let pinned = pins.iter().flat_map(|&pin| (0..D).map(move |axis| (pin, axis)));
        let numbers = pinned.chain(rollers.iter().copied()).map(|(vertex, axis)| D * vertex as usize + axis);
        numbers.map(|number| (number, x[number])).collect()
    };
    let bounds: [_; D] = std::array::from_fn(|axis| {
        let along = x.iter().skip(axis).step_by(D).copied();
        (along.clone().fold(f64::INFINITY, f64::min), along.fold(f64::NEG_INFINITY, f64::max))
    });
    let middle = bounds.map(|(least, greatest)| 0.5 * (least + greatest));
    let mut half = bounds.map(|(least, greatest)| 0.5 * (greatest - least));
    // Across its plane a membrane gets as deep as it is long.
    let longest = half.into_iter().fold(0.0, f64::max);
    half.iter_mut().skip(2).for_each(|half| *half = longest);
    match shape {
        StartShape::Rest => return,
        StartShape::Scrambled { seed } => {
            let mut random = random::stream(seed);
            for vertex in listed(numbering, x.len() / D) {
                for axis in 0..D {
                    x[D * vertex + axis] = middle[axis] + half[axis] * random.next().unwrap_or(0.0);
                }
            }
        }
        StartShape::Line { seed, noise } => map(x, numbering, middle, [1.0, 0.0], (seed, noise.get() * 2.0 * longest)),
        StartShape::Point { seed, noise } => map(x, numbering, middle, [0.0, 0.0], (seed, noise.get() * 2.0 * longest)),
        StartShape::Mirrored { seed, noise } => {
            map(x, numbering, middle, [1.0, -1.0], (seed, noise.get() * 2.0 * longest));
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

/// Scales positions along a random direction of the plane and across it about the centre; then adds noise up to a length \[m\] along
/// each axis.
fn map<const D: usize>(
    x: &mut [f64],
    numbering: &Numbering,
    middle: [f64; D],
    factors: [f64; 2],
    (seed, noise): (u32, f64),
) {
    let mut random = random::stream(seed);
    let angle = std::f64::consts::PI * random.next().unwrap_or(0.0);
    let (c, s) = (libm::cos(angle), libm::sin(angle));
    for vertex in listed(numbering, x.len() / D) {
        let point = &mut x[D * vertex..D * vertex + D];
        let away = [point[0] - middle[0], point[1] - middle[1]];
        let along = factors[0] * (c * away[0] + s * away[1]);
        let across = factors[1] * (c * away[1] - s * away[0]);
        let moved = [c * along - s * across, s * along + c * across, 0.0];
        for (axis, point) in point.iter_mut().enumerate() {
            *point = middle[axis] + moved[axis] + noise * random.next().unwrap_or(0.0);
        }
    }
}

/// The vertices on rollers along a side, and their fixed coordinate.
pub(super) fn sliding(side: Side, rest: &[f64]) -> impl Iterator<Item = (u32, usize)> {
    let (axis, greatest) = side.across();
    on_edge(rest, axis, greatest).map(move |vertex| (vertex, axis))
}
