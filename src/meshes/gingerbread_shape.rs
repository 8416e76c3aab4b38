//! Shape of the gingerbread man: circles and capsules joined by smooth fillets.
//! A level function is negative inside; its zero level is the outline. Coordinates are metres from the middle of the
//! body.
//! Source of the distance to a capsule of two radii and of the smooth minimum: I. Quilez, "2D distance functions" and
//! "Smooth minimum".

use super::mesh::squared_distance;

/// Middle of the body in the world [m].
pub(super) const MIDDLE: [f64; 2] = [0.5, 0.5];
/// Step along the outline [m]: the polyline is then within 0.01 mm of the curve.
const STEP: f64 = 0.001;

/// Capsule: two circles, by centres and radii [m], and the band around both.
struct Capsule([f64; 2], f64, [f64; 2], f64);

const HEAD: Capsule = Capsule([-0.004, 0.208], 0.117, [0.004, 0.208], 0.117);
const TRUNK: Capsule = Capsule([0.0, 0.02], 0.083, [0.0, -0.09], 0.098);
const ARM: Capsule = Capsule([0.04, 0.025], 0.050, [0.2165, 0.066], 0.0635);
const LEG: Capsule = Capsule([0.05, -0.10], 0.066, [0.12, -0.2555], 0.0695);

/// Difference of the distances to two parts at which their fillet begins [m]: neck, armpits, hips and crotch.
const NECK: f64 = 0.08;
const ARMPIT: f64 = 0.06;
const HIP: f64 = 0.05;
const CROTCH: f64 = 0.06;

/// Level function: negative inside, positive outside, near the outline about the distance from it [m].
fn level([x, y]: [f64; 2]) -> f64 {
    let side = x.abs();
    let legs = blend(LEG.distance([side, y]), LEG.distance([-side, y]), CROTCH);
    let trunk = blend(TRUNK.distance([side, y]), legs, HIP);
    let limbs = blend(trunk, ARM.distance([side, y]), ARMPIT);
    blend(limbs, HEAD.distance([side, y]), NECK)
}

impl Capsule {
    /// Distance from the boundary [m], negative inside.
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

/// Smooth minimum of two distances, rounded where they differ by less than `fillet` [m].
fn blend(a: f64, b: f64, fillet: f64) -> f64 {
    let overlap = (fillet - (a - b).abs()).max(0.0);
    a.min(b) - 0.25 * overlap * overlap / fillet
}

/// Gradient of [`level`], by central differences.
fn slope([x, y]: [f64; 2]) -> [f64; 2] {
    const H: f64 = 1e-6;
    [(level([x + H, y]) - level([x - H, y])) / (2.0 * H), (level([x, y + H]) - level([x, y - H])) / (2.0 * H)]
}

/// Right half of the outline in world coordinates [m], from the axis above the head to the axis between the legs.
pub(super) fn outline() -> Vec<[f64; 2]> {
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
