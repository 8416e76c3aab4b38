//! Detection of the plane of points in space.

use super::mesh::area;

/// Greatest variation of the coordinate across the plane, as a share of the size of the mesh.
/// It is above the last printed digit of a file, and far below the thickness of a solid.
const FLATNESS: f64 = 1e-4;

/// Variations below this share of the size give no message.
const ROUND_OFF: f64 = 1e-9;

/// Names of the coordinates.
const NAMES: [char; 3] = ['x', 'y', 'z'];

/// Points in their plane.
pub(super) struct Flat {
    pub points: Vec<[f64; 2]>,
    /// Messages for the user.
    pub messages: Vec<String>,
}

/// Points in their plane: x-y is tried before x-z, and x-z before y-z.
/// The planes x-z and y-z are seen from the side on which the faces run counter-clockwise. z points up or down in
/// x-z, and up in y-z. Points of the x-y plane stay unchanged.
///
/// # Errors
/// The first vertex outside every plane, and the reason.
pub(super) fn flat<'a>(
    points: &[[f64; 3]],
    faces: impl Iterator<Item = &'a [u32]> + Clone,
) -> Result<Flat, (usize, String)> {
    let extent = |axis: usize| {
        let along = points.iter().map(|point| point[axis]);
        along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (value.min(low), value.max(high)))
    };
    let spans = [0, 1, 2].map(|axis| (extent(axis).1 - extent(axis).0).max(0.0));
    let size = spans.into_iter().fold(0.0, f64::max);
    let Some(across) = [2, 1, 0].into_iter().find(|&axis| spans[axis] <= FLATNESS * size || points.is_empty()) else {
        let [x, y, z] = spans;
        let first = points[0][2];
        let vertex = points.iter().position(|point| (point[2] - first).abs() > FLATNESS * size).unwrap_or(0);
        let reason = format!(
            "z is {}, but {first} before; expected a flat mesh, but the file spans {x} in x, {y} in y and {z} in z: make one of them the \
             same everywhere",
            points[vertex][2]
        );
        return Err((vertex, reason));
    };
    let axes = match across {
        2 => [0, 1],
        1 => [0, 2],
        _ => [1, 2],
    };
    let mut flat: Vec<_> = points.iter().map(|point| axes.map(|axis| point[axis])).collect();
    let mut messages = Vec::new();
    if across != 2 {
        let turns = |face: &[u32]| -> f64 {
            let at = |corner: u32| flat[corner as usize];
            face.windows(2).map(|side| area([at(face[0]), at(side[0]), at(side[1])])).sum()
        };
        let turned: f64 = faces.map(turns).sum();
        // Seen from the other side, the second axis of x-z points up and the first axis of y-z to the right.
        let mirrored = turned < 0.0;
        let axis = usize::from(across == 1);
        if mirrored {
            for point in &mut flat {
                point[axis] = -point[axis];
            }
        }
        let name = |number: usize| {
            let sign = if mirrored && number == axis { "-" } else { "" };
            format!("{sign}{}", NAMES[axes[number]])
        };
        let [a, b] = axes.map(|axis| NAMES[axis]);
        messages.push(format!(
            "the file's mesh lies in its {a}-{b} plane: its {} is x here, and its {} is y",
            name(0),
            name(1)
        ));
    }
    if spans[across] > ROUND_OFF * size {
        messages.push(format!("{} varies by {:.1e} m in the file, which is passed over", NAMES[across], spans[across]));
    }
    Ok(Flat { points: flat, messages })
}
