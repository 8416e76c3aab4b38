//! Rules for pinning vertices of a flat shape.

use super::{Numbering, count::natural};
use crate::{
    quantity::{Point, Radius},
    random,
};
use serde::{Deserialize, Serialize};

/// A rule for pinning vertices, judged on the rest shape.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Pin {
    /// One vertex, by its number in the body or net.
    Vertex(#[serde(deserialize_with = "natural")] u32),
    /// The vertex nearest to a point.
    Nearest(Point),
    /// All vertices at the greatest y.
    Top,
    /// All vertices at the least y.
    Bottom,
    /// All vertices at the least x.
    Left,
    /// All vertices at the greatest x.
    Right,
    /// All vertices within a distance of a point.
    Disk(Point, Radius),
    /// All vertices in a box, from its least to its greatest corner, sides included.
    Box(Point, Point),
    /// The vertices nearest to the four corners of the box around all.
    Corners,
    /// Vertices chosen at random.
    Random {
        /// How many; all, if there are not more.
        #[serde(deserialize_with = "natural")]
        count: u32,
        /// Number that chooses them: the same number gives the same vertices.
        #[serde(deserialize_with = "natural")]
        seed: u32,
    },
}

/// Pinned vertices, ascending, from flat rest positions. Of vertices equally near a point, the one listed first is
/// pinned.
///
/// # Errors
/// A sentence, if a vertex is named that does not exist.
pub fn pinned(pins: &[Pin], rest: &[f64], numbering: &Numbering) -> Result<Vec<u32>, String> {
    let count = rest.len() / 2;
    let on_edge = |axis: usize, greatest: bool| on_edge(rest, axis, greatest);
    let listed = || (0..count as u32).map(|name| numbering.vertex(name) as usize);
    let mut pinned = Vec::new();
    for &pin in pins {
        match pin {
            Pin::Vertex(vertex) if (vertex as usize) < count => pinned.push(numbering.vertex(vertex)),
            Pin::Vertex(vertex) => {
                return Err(format!("a pin names vertex {vertex}, but they go from 0 to {}", count - 1));
            }
            Pin::Nearest(point) => pinned.extend(nearest(listed(), rest, &point.get()).map(|i| i as u32)),
            Pin::Left => pinned.extend(on_edge(0, false)),
            Pin::Right => pinned.extend(on_edge(0, true)),
            Pin::Bottom => pinned.extend(on_edge(1, false)),
            Pin::Top => pinned.extend(on_edge(1, true)),
            Pin::Disk(centre, radius) => {
                let [x, y] = centre.get();
                let is_within = |point: &[f64; 2]| libm::hypot(point[0] - x, point[1] - y) <= radius.get();
                pinned.extend(places(rest, is_within));
            }
            Pin::Box(least, greatest) => {
                let (least, greatest) = (least.get(), greatest.get());
                let is_within =
                    |point: &[f64; 2]| (0..2).all(|axis| point[axis] >= least[axis] && point[axis] <= greatest[axis]);
                pinned.extend(places(rest, is_within));
            }
            Pin::Corners => {
                let [(left, right), (bottom, top)] = [extent(rest, 0), extent(rest, 1)];
                let corners = [[left, bottom], [right, bottom], [left, top], [right, top]];
                pinned.extend(corners.iter().filter_map(|corner| nearest(listed(), rest, corner)).map(|i| i as u32));
            }
            Pin::Random { count: wanted, seed } => {
                let mut lots: Vec<_> = random::stream(seed).zip(0..count as u32).collect();
                lots.sort_by(|(a, _), (b, _)| a.total_cmp(b));
                pinned.extend(lots.iter().take(wanted as usize).map(|(_, name)| numbering.vertex(*name)));
            }
        }
    }
    pinned.sort_unstable();
    pinned.dedup();
    Ok(pinned)
}

/// The vertices whose flat positions a rule is true of.
fn places(x: &[f64], is_within: impl Fn(&[f64; 2]) -> bool) -> impl Iterator<Item = u32> {
    x.as_chunks().0.iter().zip(0..).filter(move |(point, _)| is_within(point)).map(|(_, vertex)| vertex)
}

/// The vertices at the least or greatest coordinate along an axis, to round-off.
pub fn on_edge(x: &[f64], axis: usize, greatest: bool) -> impl Iterator<Item = u32> {
    let (low, high) = extent(x, axis);
    let (edge, slack) = (if greatest { high } else { low }, 1e-9 * (high - low));
    (0..x.len() / 2).filter(move |i| (x[2 * i + axis] - edge).abs() <= slack).map(|i| i as u32)
}

/// Least and greatest of one coordinate (0 or 1) of flat points in the plane.
pub fn extent(points: &[f64], axis: usize) -> (f64, f64) {
    range(points.iter().skip(axis).step_by(2))
}

/// Least and greatest of some numbers.
fn range<'a>(along: impl Iterator<Item = &'a f64>) -> (f64, f64) {
    along.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, greatest), &value| (value.min(least), value.max(greatest)))
}

/// The vertex of these that is nearest to a point, by flat positions; the first of equals.
pub fn nearest(vertices: impl Iterator<Item = usize>, x: &[f64], point: &[f64]) -> Option<usize> {
    let dimension = point.len();
    let square = |vertex: usize| {
        let own = &x[dimension * vertex..dimension * (vertex + 1)];
        own.iter().zip(point).map(|(x, p)| (x - p) * (x - p)).sum::<f64>()
    };
    let squares = vertices.map(|vertex| (vertex, square(vertex)));
    squares.min_by(|(_, a), (_, b)| a.total_cmp(b)).map(|(vertex, _)| vertex)
}
