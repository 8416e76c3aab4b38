//! Triangulation of an outline with nearly equilateral triangles.
//! It places points along the outline and a triangular lattice inside, and then smooths. Each round moves every inner
//! point to the area-weighted mean of the centroids around it and triangulates again (centroidal patch triangulation:
//! L. Chen, "Mesh smoothing schemes based on optimal Delaunay triangulations", 13th International Meshing Roundtable,
//! 2004, section 3). Spade computes the Delaunay triangulations. Where an outline's own corners leave slivers, it
//! applies Ruppert's refinement.

use super::{
    MeshError,
    delaunay::{self, Filled},
    mesh, polygon,
};

/// Smallest acceptable angle [°].
pub(super) const GOOD_ANGLE: f64 = 25.0;
/// Height of an equilateral triangle of side 1.
const ROW: f64 = 0.866_025_403_784_438_6;
/// Least distance of the lattice from the outline [edge lengths]. Rows then settle near one triangle's height.
const CLEARANCE: f64 = 0.64;
/// Rounds of smoothing. Angles change by less than a degree after about thirty.
const ROUNDS: usize = 30;
/// Offsets of the lattice [edge lengths], tried in order until all angles are good.
const STARTS: [[f64; 2]; 4] = [[0.0, 0.0], [0.5, 0.29], [0.25, 0.14], [0.13, 0.43]];

/// Triangulates an outline with about `target` triangles.
/// `outline` gives its counter-clockwise points for an edge length [m]; `area` is the enclosed area [m²].
///
/// # Errors
/// [`MeshError::Recipe`] if the outline touches itself or is too thin for its triangles.
pub(super) fn fill(target: f64, area: f64, outline: &dyn Fn(f64) -> Vec<[f64; 2]>) -> Result<Filled, MeshError> {
    let mut best: Option<(f64, usize, Filled)> = None;
    for start in STARTS {
        let (boundary, edge) = spacing(target, area, outline, start);
        if polygon::crossing(&boundary).is_some() {
            return Err(delaunay::too_narrow());
        }
        let filled = relax(&boundary, lattice(&boundary, edge, start))?;
        let angle = smallest_angle(&filled);
        if best.as_ref().is_none_or(|(so_far, ..)| angle > *so_far) {
            best = Some((angle, boundary.len(), filled));
        }
        // A much smaller angle comes from the outline itself. Another offset does not help.
        if !(0.6 * GOOD_ANGLE..GOOD_ANGLE).contains(&angle) {
            break;
        }
    }
    let Some((angle, fixed, filled)) = best else { return Err(delaunay::too_narrow()) };
    if angle >= GOOD_ANGLE { Ok(filled) } else { delaunay::refine(&filled.0, fixed, 2 * target as usize) }
}

/// Side [m] of an equilateral triangle of the given area [m²].
pub(super) fn edge_length(area: f64) -> f64 {
    (2.0 * area / ROW).sqrt()
}

/// Smallest angle of all triangles [°].
fn smallest_angle((points, triangles): &Filled) -> f64 {
    let angle = |triangle: &[u32; 3]| mesh::min_angle(triangle.map(|vertex| points[vertex as usize]));
    triangles.iter().map(angle).fold(60.0, f64::min)
}

/// Points of the outline and the edge length [m] that come nearest to the requested number of triangles.
/// A simple polygon with `b` points on it and `i` inside has `2 i + b - 2` triangles in every triangulation (Euler).
fn spacing(target: f64, area: f64, outline: &dyn Fn(f64) -> Vec<[f64; 2]>, start: [f64; 2]) -> (Vec<[f64; 2]>, f64) {
    let mut edge = edge_length(area / target);
    let mut best = (f64::INFINITY, Vec::new(), edge);
    for _ in 0..12 {
        let boundary = outline(edge);
        let count = (2 * lattice(&boundary, edge, start).len() + boundary.len()) as f64 - 2.0;
        let miss = (count / target - 1.0).abs();
        let next = edge * (count / target).sqrt();
        if miss < best.0 {
            best = (miss, boundary, edge);
        }
        if miss < 0.01 {
            break;
        }
        edge = next;
    }
    (best.1, best.2)
}

/// Points of a triangular lattice inside a polygon and clear of its sides.
fn lattice(boundary: &[[f64; 2]], edge: f64, start: [f64; 2]) -> Vec<[f64; 2]> {
    let [low, high] = mesh::bounds(boundary);
    let origin = [0, 1].map(|axis| 0.5 * (low[axis] + high[axis]) + start[axis] * edge);
    let rows = ((high[1] - low[1]) / (ROW * edge)) as usize / 2 + 2;
    let clearance = CLEARANCE * edge;
    let mut points = Vec::new();
    for (index, near) in sides_by_row(boundary, origin[1], ROW * edge, rows, clearance).iter().enumerate() {
        let row = index as f64 - rows as f64;
        let y = origin[1] + row * ROW * edge;
        let left = origin[0] + if index % 2 == 0 { 0.0 } else { 0.5 * edge };
        for run in crossings(near, y).chunks_exact(2) {
            let (first, last) = (((run[0] - left) / edge).ceil() as i64, ((run[1] - left) / edge).floor() as i64);
            points.extend((first..=last).map(|column| [left + column as f64 * edge, y]).filter(|&point| {
                let square = |[from, to]: &[[f64; 2]; 2]| mesh::squared_distance_to_side(*from, *to, point);
                near.iter().all(|side| square(side) > clearance * clearance)
            }));
        }
    }
    points
}

/// Sides of the polygon within `clearance` of each of `2 rows + 1` horizontal lines about the height `middle` [m].
fn sides_by_row(
    boundary: &[[f64; 2]],
    middle: f64,
    height: f64,
    rows: usize,
    clearance: f64,
) -> Vec<Vec<[[f64; 2]; 2]>> {
    let mut near = vec![Vec::new(); 2 * rows + 1];
    let row = |y: f64| ((y - middle) / height + rows as f64).max(0.0);
    for side in polygon::sides(boundary) {
        let [low, high] = mesh::bounds(&side);
        let (first, last) = (row(low[1] - clearance).ceil() as usize, row(high[1] + clearance) as usize);
        for list in near.iter_mut().take(last + 1).skip(first) {
            list.push(side);
        }
    }
    near
}

/// Crossings of a horizontal line with the sides of a polygon, from left to right.
fn crossings(sides: &[[[f64; 2]; 2]], y: f64) -> Vec<f64> {
    let mut crossings: Vec<f64> = sides
        .iter()
        .filter(|[from, to]| (from[1] > y) != (to[1] > y))
        .map(|[from, to]| from[0] + (y - from[1]) / (to[1] - from[1]) * (to[0] - from[0]))
        .collect();
    crossings.sort_unstable_by(f64::total_cmp);
    crossings
}

/// Triangulates the points and smooths them. The boundary stays.
fn relax(boundary: &[[f64; 2]], inner: Vec<[f64; 2]>) -> Result<Filled, MeshError> {
    let fixed = boundary.len();
    let mut points = boundary.to_vec();
    points.extend(inner);
    for _ in 0..ROUNDS {
        let triangles = delaunay::triangles(&points, fixed)?;
        smooth(&mut points, &triangles, fixed);
    }
    let triangles = delaunay::triangles(&points, fixed)?;
    Ok((points, triangles))
}

/// Moves every point from number `fixed` on to the area-weighted mean of the centroids of its triangles.
fn smooth(points: &mut [[f64; 2]], triangles: &[[u32; 3]], fixed: usize) {
    let mut sums = vec![[0.0; 3]; points.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|vertex| points[vertex as usize]);
        let area = mesh::area([a, b, c]);
        for &vertex in triangle {
            let sum = &mut sums[vertex as usize];
            sum[0] += area * (a[0] + b[0] + c[0]) / 3.0;
            sum[1] += area * (a[1] + b[1] + c[1]) / 3.0;
            sum[2] += area;
        }
    }
    for (point, [x, y, area]) in points.iter_mut().zip(sums).skip(fixed) {
        if area > 0.0 {
            *point = [x / area, y / area];
        }
    }
}
