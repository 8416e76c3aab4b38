//! Mesh of the gingerbread man: his shape and his icing.
//!
//! His shape is circles and capsules joined by smooth fillets. A level function is negative inside; its zero level is the
//! outline. Coordinates of shape and icing are metres from the middle of the body. Source of the distance to a capsule of
//! two radii and of the smooth minimum: I. Quilez, "2D distance functions" and "Smooth minimum".

use super::{
    Files, IcingColor, Locator, Mesh, MeshError, MeshSource, Stroke, Whole, mesh::squared_distance, numbering, polygon,
    triangulate,
};
use crate::quantity::{Quantity, Triangles};
use std::f64::consts::{PI, TAU};

/// The gingerbread man, 0.56 m wide and 0.65 m tall in the middle of the 1 m x 1 m world, with his icing. Left and right
/// are mirror images in outline, and no angle is below 25 degrees.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Gingerbread {
    /// Number of triangles to aim for.
    pub resolution: Whole<Triangles>,
}

impl Default for Gingerbread {
    fn default() -> Self {
        Self { resolution: Whole::literal(Triangles::literal(2000.0)) }
    }
}

impl MeshSource for Gingerbread {
    fn build(&self, _: &dyn Files) -> Result<Mesh, MeshError> {
        let half = outline();
        let area = polygon::signed_area(&mirrored(&half));
        let target = f64::from(self.resolution.count());
        let (points, triangles) = triangulate::fill(target, area, &|edge| vec![sampled(&half, edge)])?;
        let (points, triangles) = numbering::by_place(&points, &triangles);
        let icing = icing(&Locator::new(&points, &triangles));
        Ok(Mesh::new(points, triangles)?.with_icing(icing))
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.resolution]
    }

    fn onto_outline(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [x, y] = onto([x - MIDDLE[0], y - MIDDLE[1]], false);
        [x + MIDDLE[0], y + MIDDLE[1]]
    }
}

/// Outline in points about one edge length \[m\] apart, counter-clockwise, with equal numbers on the left and right.
fn sampled(half: &[[f64; 2]], edge: f64) -> Vec<[f64; 2]> {
    let length: f64 = 0.5 * polygon::perimeter(&mirrored(half));
    let pieces = ((length / edge).round() as usize).max(2);
    mirrored(&polygon::spaced(half, pieces + 1))
}

/// Whole outline from its right half, which runs from crown to crotch: up on the right, down on the left.
fn mirrored(half: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let left = half.iter().take(half.len() - 1).skip(1).map(|&[x, y]| [1.0 - x, y]);
    half.iter().rev().copied().chain(left).collect()
}

/// Middle of the body in the world \[m\].
const MIDDLE: [f64; 2] = [0.5, 0.5];
/// Step along the outline \[m\]: the polyline is then within 0.01 mm of the curve.
const STEP: f64 = 0.001;

/// Capsule: two circles, by centres and radii \[m\], and the band around both.
struct Capsule([f64; 2], f64, [f64; 2], f64);

const HEAD: Capsule = Capsule([-0.004, 0.208], 0.117, [0.004, 0.208], 0.117);
const TRUNK: Capsule = Capsule([0.0, 0.02], 0.083, [0.0, -0.09], 0.098);
const ARM: Capsule = Capsule([0.04, 0.025], 0.050, [0.2165, 0.066], 0.0635);
const LEG: Capsule = Capsule([0.05, -0.10], 0.066, [0.12, -0.2555], 0.0695);

/// Difference of the distances to two parts at which their fillet begins \[m\]: neck, armpits, hips and crotch.
const NECK: f64 = 0.08;
const ARMPIT: f64 = 0.06;
const HIP: f64 = 0.05;
const CROTCH: f64 = 0.06;

/// Level function: negative inside, positive outside, near the outline about the distance from it \[m\].
fn level([x, y]: [f64; 2]) -> f64 {
    let side = x.abs();
    let legs = blend(LEG.distance([side, y]), LEG.distance([-side, y]), CROTCH);
    let trunk = blend(TRUNK.distance([side, y]), legs, HIP);
    let limbs = blend(trunk, ARM.distance([side, y]), ARMPIT);
    blend(limbs, HEAD.distance([side, y]), NECK)
}

impl Capsule {
    /// Distance from the boundary \[m\], negative inside.
    fn distance(&self, point: [f64; 2]) -> f64 {
        let &Self(from, start, to, end) = self;
        let length = squared_distance(from, to).sqrt();
        let axis = [(to[0] - from[0]) / length, (to[1] - from[1]) / length];
        let offset = [point[0] - from[0], point[1] - from[1]];
        let along = offset[0] * axis[0] + offset[1] * axis[1];
        let across = (offset[0] * axis[1] - offset[1] * axis[0]).abs();
        // Sine and cosine of the angle between the axis and the straight side.
        let sine = (start - end) / length;
        let cosine = (1.0 - sine * sine).sqrt();
        let place = cosine * along - sine * across;
        if place < 0.0 {
            squared_distance(point, from).sqrt() - start
        } else if place > cosine * length {
            squared_distance(point, to).sqrt() - end
        } else {
            cosine * across + sine * along - start
        }
    }
}

/// Smooth minimum of two distances, rounded where they differ by less than `fillet` \[m\].
fn blend(a: f64, b: f64, fillet: f64) -> f64 {
    let overlap = (fillet - (a - b).abs()).max(0.0);
    a.min(b) - 0.25 * overlap * overlap / fillet
}

/// Gradient of [`level`], by central differences.
fn slope([x, y]: [f64; 2]) -> [f64; 2] {
    const H: f64 = 1e-6;
    [(level([x + H, y]) - level([x - H, y])) / (2.0 * H), (level([x, y + H]) - level([x, y - H])) / (2.0 * H)]
}

/// Right half of the outline in world coordinates \[m\], from the axis above the head to the axis between the legs.
fn outline() -> Vec<[f64; 2]> {
    let mut point = onto([0.0, 0.325], true);
    let mut line = vec![point];
    // The half outline is 1.4 m long. The bound only stops the loop for an invalid shape.
    for _ in 0..10_000 {
        let [gx, gy] = slope(point);
        let size = (gx * gx + gy * gy).sqrt();
        let next = onto([point[0] + STEP * gy / size, point[1] - STEP * gx / size], false);
        if next[0] < 0.25 * STEP {
            break;
        }
        point = next;
        line.push(point);
    }
    line.push(onto([0.0, point[1]], true));
    line.iter().map(|&[x, y]| [x + MIDDLE[0], y + MIDDLE[1]]).collect()
}

/// Projects a point near the outline onto it by Newton's method; only vertically if it must stay on the axis.
fn onto([mut x, mut y]: [f64; 2], on_axis: bool) -> [f64; 2] {
    for _ in 0..4 {
        let [gx, gy] = slope([x, y]);
        let gx = if on_axis { 0.0 } else { gx };
        let excess = level([x, y]) / (gx * gx + gy * gy);
        (x, y) = (x - excess * gx, y - excess * gy);
    }
    [x, y]
}

/// Distance of the piping from the edge \[m\].
const INSET: f64 = 0.021;
/// Width of the piping \[m\].
const WIDTH: f64 = 0.0075;
/// Amplitude of the piping's wave \[m\].
const SWING: f64 = 0.0045;
/// Approximate wavelength of the piping \[m\].
const WAVE: f64 = 0.034;
/// Points per wave.
const PER_WAVE: usize = 12;

/// All icing, in drawing order.
fn icing(locator: &Locator) -> Vec<Stroke> {
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

/// Point of the body in the world \[m\].
fn world([x, y]: [f64; 2]) -> [f64; 2] {
    [x + MIDDLE[0], y + MIDDLE[1]]
}

/// Circle of 32 points \[m\].
fn disc(centre: [f64; 2], radius: f64) -> Vec<[f64; 2]> {
    let at = |angle: f64| world([centre[0] + radius * libm::cos(angle), centre[1] + radius * libm::sin(angle)]);
    (0..32).map(|step| at(TAU * f64::from(step) / 32.0)).collect()
}

/// Line of the mouth \[m\].
fn smile() -> Vec<[f64; 2]> {
    let at = |angle: f64| world([0.060 * libm::cos(angle), 0.206 + 0.054 * libm::sin(angle)]);
    (0..=24).map(|step| at(PI * (1.17 + 0.66 * f64::from(step) / 24.0))).collect()
}

/// Closed wave along the edge \[m\], symmetric like the outline.
fn piping() -> Vec<[f64; 2]> {
    let edge = outline();
    let line = shifted(&edge, |_| -INSET);
    let length: f64 = line.windows(2).map(|pair| squared_distance(pair[0], pair[1]).sqrt()).sum();
    let waves = (length / WAVE).round();
    let steps = waves as usize * PER_WAVE;
    let even = polygon::spaced(&line, steps + 1);
    let half = shifted(&even, |step| SWING * libm::cos(TAU * step as f64 / PER_WAVE as f64));
    let left = half.iter().take(steps).skip(1).rev().map(|&[x, y]| [1.0 - x, y]);
    half.iter().copied().chain(left).collect()
}

/// Line from axis to axis with each point moved outwards, to the left of its direction, by a distance \[m\].
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
