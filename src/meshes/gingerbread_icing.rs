//! Icing of the gingerbread man. Coordinates are metres from his centre.

use std::f64::consts::{PI, TAU};

use super::{IcingColor, Locator, Stroke, gingerbread_shape, mesh::squared_distance, polygon};

/// Distance of the piping from the edge [m].
const INSET: f64 = 0.021;
/// Width of the piping [m].
const WIDTH: f64 = 0.0075;
/// Amplitude of the piping's wave [m].
const SWING: f64 = 0.0045;
/// Approximate wavelength of the piping [m].
const WAVE: f64 = 0.034;
/// Points per wave.
const PER_WAVE: usize = 12;

/// All icing, in drawing order.
pub(super) fn icing(locator: &Locator) -> Vec<Stroke> {
    let mut strokes = vec![Stroke::line(locator, &piping(), true, WIDTH, IcingColor::White)];
    for side in [-1.0, 1.0] {
        strokes.push(Stroke::area(locator, &disc([side * 0.042, 0.229], 0.0145), IcingColor::White));
    }
    strokes.push(Stroke::line(locator, &smile(), false, 0.0105, IcingColor::White));
    for (y, color) in [(0.042, IcingColor::Red), (-0.018, IcingColor::Green), (-0.078, IcingColor::Red)] {
        strokes.push(Stroke::area(locator, &disc([0.0, y], 0.0165), color));
    }
    strokes
}

/// Point of the body in the world [m].
fn world([x, y]: [f64; 2]) -> [f64; 2] {
    [x + gingerbread_shape::MIDDLE[0], y + gingerbread_shape::MIDDLE[1]]
}

/// Circle of 32 points [m].
fn disc(centre: [f64; 2], radius: f64) -> Vec<[f64; 2]> {
    let at = |angle: f64| world([centre[0] + radius * libm::cos(angle), centre[1] + radius * libm::sin(angle)]);
    (0..32).map(|step| at(TAU * f64::from(step) / 32.0)).collect()
}

/// Line of the mouth [m].
fn smile() -> Vec<[f64; 2]> {
    let at = |angle: f64| world([0.060 * libm::cos(angle), 0.206 + 0.054 * libm::sin(angle)]);
    (0..=24).map(|step| at(PI * (1.17 + 0.66 * f64::from(step) / 24.0))).collect()
}

/// Closed wave along the edge [m], symmetric like the outline.
fn piping() -> Vec<[f64; 2]> {
    let edge = gingerbread_shape::outline();
    let line = shifted(&edge, |_| -INSET);
    let length: f64 = line.windows(2).map(|pair| squared_distance(pair[0], pair[1]).sqrt()).sum();
    let waves = (length / WAVE).round();
    let steps = waves as usize * PER_WAVE;
    let even = polygon::spaced(&line, steps + 1);
    let half = shifted(&even, |step| SWING * libm::cos(TAU * step as f64 / PER_WAVE as f64));
    let left = half.iter().take(steps).skip(1).rev().map(|&[x, y]| [1.0 - x, y]);
    half.iter().copied().chain(left).collect()
}

/// Line from axis to axis with each point moved outwards, to the left of its direction, by a distance [m].
fn shifted(line: &[[f64; 2]], distance: impl Fn(usize) -> f64) -> Vec<[f64; 2]> {
    let last = line.len() - 1;
    let move_out = |(index, point): (usize, &[f64; 2])| {
        let (before, after) = (line[index.saturating_sub(1)], line[(index + 1).min(last)]);
        // At the axis the line continues in its mirror image, so its direction there is horizontal.
        let rise = if index == 0 || index == last { 0.0 } else { after[1] - before[1] };
        let run = after[0] - before[0];
        let share = distance(index) / (rise * rise + run * run).sqrt();
        [point[0] - share * rise, point[1] + share * run]
    };
    line.iter().enumerate().map(move_out).collect()
}
