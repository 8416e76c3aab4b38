//! Pinned vertices and rollers.

use super::{extent, nearest};
use crate::{
    level::{Pin, Side},
    meshes::Numbering,
};

/// Pinned vertices, ascending, from flat rest positions. Of vertices equally near a point, the one listed first is
/// pinned.
pub(super) fn pinned(pins: &[Pin], rest: &[f64], numbering: &Numbering) -> Result<Vec<u32>, String> {
    let count = rest.len() / 2;
    let on_edge = |axis: usize, greatest: bool| on_edge(rest, axis, greatest);
    let mut pinned = Vec::new();
    for &pin in pins {
        match pin {
            Pin::Vertex(vertex) if (vertex as usize) < count => pinned.push(numbering.vertex(vertex)),
            Pin::Vertex(vertex) => {
                return Err(format!("a pin names vertex {vertex}, but they go from 0 to {}", count - 1));
            }
            Pin::Nearest(point) => {
                let listed = (0..count as u32).map(|name| numbering.vertex(name) as usize);
                pinned.extend(nearest(listed, rest, point.get()).map(|i| i as u32));
            }
            Pin::Left => pinned.extend(on_edge(0, false)),
            Pin::Right => pinned.extend(on_edge(0, true)),
            Pin::Bottom => pinned.extend(on_edge(1, false)),
            Pin::Top => pinned.extend(on_edge(1, true)),
        }
    }
    pinned.sort_unstable();
    pinned.dedup();
    Ok(pinned)
}

/// The vertices on rollers along a side, and their fixed coordinate.
pub(super) fn sliding(side: Side, rest: &[f64]) -> impl Iterator<Item = (u32, usize)> {
    let (axis, greatest) = side.across();
    on_edge(rest, axis, greatest).map(move |vertex| (vertex, axis))
}

/// The vertices at the least or greatest coordinate along an axis, to round-off.
pub(super) fn on_edge(x: &[f64], axis: usize, greatest: bool) -> impl Iterator<Item = u32> {
    let (low, high) = extent(x, axis);
    let (edge, slack) = (if greatest { high } else { low }, 1e-9 * (high - low));
    (0..x.len() / 2).filter(move |i| (x[2 * i + axis] - edge).abs() <= slack).map(|i| i as u32)
}
