//! Triangulation of an outline with nearly equilateral triangles.
//!
//! It places points along the outline and a triangular lattice inside, and then smooths. Each round moves every inner
//! point to the area-weighted mean of the centroids around it and triangulates again (centroidal patch triangulation:
//! L. Chen, "Mesh smoothing schemes based on optimal Delaunay triangulations", 13th International Meshing Roundtable,
//! 2004, section 3). The crate spade computes the constrained Delaunay triangulations. Where an outline's own corners leave
//! slivers, it applies Ruppert's refinement.

use super::{MeshError, mesh, polygon};
use spade::{AngleLimit, ConstrainedDelaunayTriangulation, HasPosition, Point2, RefinementParameters, Triangulation};

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

/// Closed lines of points: an outline, and those of its holes.
pub(super) type Loops = Vec<Vec<[f64; 2]>>;

/// Triangulates an outline with about `target` triangles.
/// `outline` gives its points and those of its holes for an edge length \[m\]; `area` is the enclosed area \[m²\].
///
/// # Errors
/// [`MeshError::Recipe`] if the outline touches itself or is too thin for its triangles.
pub(super) fn fill(target: f64, area: f64, outline: &dyn Fn(f64) -> Loops) -> Result<Filled, MeshError> {
    let mut best: Option<(f64, Vec<usize>, Filled)> = None;
    for start in STARTS {
        let (boundary, edge) = spacing(target, area, outline, start);
        if polygon::crossing_of_loops(&boundary.iter().map(Vec::as_slice).collect::<Vec<_>>()).is_some() {
            return Err(too_narrow());
        }
        let filled = relax(&boundary, lattice(&boundary, edge, start))?;
        let angle = smallest_angle(&filled);
        if best.as_ref().is_none_or(|(so_far, ..)| angle > *so_far) {
            best = Some((angle, boundary.iter().map(Vec::len).collect(), filled));
        }
        // A much smaller angle comes from the outline itself. Another offset does not help.
        if !(0.6 * GOOD_ANGLE..GOOD_ANGLE).contains(&angle) {
            break;
        }
    }
    let Some((angle, fixed, filled)) = best else { return Err(too_narrow()) };
    if angle >= GOOD_ANGLE { Ok(filled) } else { refine(&filled.0, &fixed, 2 * target as usize) }
}

/// Side \[m\] of an equilateral triangle of the given area \[m²\].
pub(super) fn edge_length(area: f64) -> f64 {
    (2.0 * area / ROW).sqrt()
}

/// Smallest angle of all triangles [°].
fn smallest_angle((points, triangles): &Filled) -> f64 {
    let angle = |triangle: &[u32; 3]| mesh::min_angle(triangle.map(|vertex| points[vertex as usize]));
    triangles.iter().map(angle).fold(60.0, f64::min)
}

/// Points of the outline and the edge length \[m\] that come nearest to the requested number of triangles.
/// A polygon with `h` holes, `b` points on it and `i` inside has `2 i + b + 2 h - 2` triangles in every triangulation (Euler).
fn spacing(target: f64, area: f64, outline: &dyn Fn(f64) -> Loops, start: [f64; 2]) -> (Loops, f64) {
    let mut edge = edge_length(area / target);
    let mut best = (f64::INFINITY, Vec::new(), edge);
    for _ in 0..12 {
        let boundary = outline(edge);
        let on_it: usize = boundary.iter().map(Vec::len).sum();
        let count = (2 * lattice(&boundary, edge, start).len() + on_it + 2 * boundary.len()) as f64 - 4.0;
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

/// Points of a triangular lattice inside an outline, outside of its holes, and clear of the sides of all.
fn lattice(boundary: &Loops, edge: f64, start: [f64; 2]) -> Vec<[f64; 2]> {
    let [low, high] = mesh::bounds(boundary.first().map_or(&[], Vec::as_slice));
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

/// Sides of the polygon within `clearance` of each of `2 rows + 1` horizontal lines about the height `middle` \[m\].
fn sides_by_row(boundary: &Loops, middle: f64, height: f64, rows: usize, clearance: f64) -> Vec<Vec<[[f64; 2]; 2]>> {
    let mut near = vec![Vec::new(); 2 * rows + 1];
    let row = |y: f64| ((y - middle) / height + rows as f64).max(0.0);
    for side in boundary.iter().flat_map(|corners| polygon::sides(corners)) {
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
fn relax(boundary: &Loops, inner: Vec<[f64; 2]>) -> Result<Filled, MeshError> {
    let fixed: Vec<usize> = boundary.iter().map(Vec::len).collect();
    let mut points = boundary.concat();
    let count = points.len();
    points.extend(inner);
    for _ in 0..ROUNDS {
        let triangles = delaunay(&points, &fixed)?;
        smooth(&mut points, &triangles, count);
    }
    let triangles = delaunay(&points, &fixed)?;
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

/// Circumradius over shortest edge, `1 / (2 sin 26°)`: the angle limit of the refinement, a little above 25 degrees.
const RATIO: f64 = 1.1406;

/// Points, and triangles of point numbers from 0.
type Filled = (Vec<[f64; 2]>, Vec<[u32; 3]>);

/// Point with its number in this module. The order in spade differs.
struct Site {
    position: Point2<f64>,
    index: u32,
}

impl HasPosition for Site {
    type Scalar = f64;
    fn position(&self) -> Point2<f64> {
        self.position
    }
}

impl From<Point2<f64>> for Site {
    /// Point added by refinement. Its number follows later.
    fn from(position: Point2<f64>) -> Self {
        Self { position, index: u32::MAX }
    }
}

type Delaunay = ConstrainedDelaunayTriangulation<Site>;

/// Error of an outline that is too narrow for its triangles.
fn too_narrow() -> MeshError {
    MeshError::Recipe("the outline is too narrow for its triangles; ask for more of them".to_owned())
}

/// Delaunay triangles inside the polygons of the first points, which have so many each.
///
/// # Errors
/// [`MeshError::Recipe`] if points coincide or lie on the polygon's sides, or if coordinates are too large or too
/// small.
fn delaunay(points: &[[f64; 2]], fixed: &[usize]) -> Result<Vec<[u32; 3]>, MeshError> {
    Ok(inside(&triangulation(points, fixed)?))
}

/// Ruppert's refinement: adds points, also on the sides, until only the polygon's own corners give small angles.
/// At most `most` points are added.
///
/// # Errors
/// As [`triangles`].
fn refine(points: &[[f64; 2]], fixed: &[usize], most: usize) -> Result<Filled, MeshError> {
    let mut delaunay = triangulation(points, fixed)?;
    let parameters = RefinementParameters::new()
        .exclude_outer_faces(true)
        .with_angle_limit(AngleLimit::from_radius_to_shortest_edge_ratio(RATIO))
        .with_max_additional_vertices(most);
    delaunay.refine(parameters);
    let handles: Vec<_> = delaunay.fixed_vertices().collect();
    for &handle in &handles {
        delaunay.vertex_data_mut(handle).index = handle.index() as u32;
    }
    let all: Vec<_> = delaunay.vertices().map(|vertex| [vertex.position().x, vertex.position().y]).collect();
    Ok(without_unused(&all, inside(&delaunay)))
}

/// Delaunay triangulation that keeps the polygons of the first points, which have so many each.
fn triangulation(points: &[[f64; 2]], fixed: &[usize]) -> Result<Delaunay, MeshError> {
    let sites = points.iter().enumerate();
    let sites = sites.map(|(index, &[x, y])| Site { position: Point2::new(x, y), index: index as u32 }).collect();
    // Constraints are added one by one: spade's joint bulk load iterates over a hash set, whose order differs from
    // run to run.
    let mut delaunay = Delaunay::bulk_load(sites)
        .map_err(|error| MeshError::Recipe(format!("the outline cannot be cut into triangles: {error}")))?;
    let mut handles = vec![None; points.len()];
    for vertex in delaunay.vertices() {
        handles[vertex.data().index as usize] = Some(vertex.fix());
    }
    let mut first = 0;
    for count in fixed {
        for from in 0..*count {
            let ends = [from, (from + 1) % count].map(|place| handles[first + place]);
            let [Some(from), Some(to)] = ends else { return Err(too_narrow()) };
            if from == to || !delaunay.can_add_constraint(from, to) {
                return Err(too_narrow());
            }
            delaunay.add_constraint(from, to);
        }
        first += count;
    }
    Ok(delaunay)
}

/// Triangles that are reached from outside over an odd number of constraints.
fn inside(delaunay: &Delaunay) -> Vec<[u32; 3]> {
    // Whether a triangle is inside, once that is known.
    let mut known: Vec<Option<bool>> = vec![None; delaunay.num_all_faces()];
    let rim = delaunay.directed_edges().filter(spade::handles::DirectedEdgeHandle::is_outer_edge);
    let mut todo: Vec<_> =
        rim.filter_map(|edge| Some((edge.rev().face().as_inner()?, edge.is_constraint_edge()))).collect();
    while let Some((face, is_inside)) = todo.pop() {
        if known[face.fix().index()].replace(is_inside).is_some() {
            continue;
        }
        let next = face.adjacent_edges().into_iter();
        todo.extend(
            next.filter_map(|edge| Some((edge.rev().face().as_inner()?, is_inside != edge.is_constraint_edge()))),
        );
    }
    let inner = delaunay.inner_faces().filter(|face| known[face.fix().index()] == Some(true));
    inner.map(|face| face.vertices().map(|vertex| vertex.data().index)).collect()
}

/// Removes points that no triangle uses.
fn without_unused(points: &[[f64; 2]], mut triangles: Vec<[u32; 3]>) -> Filled {
    let mut used = vec![false; points.len()];
    triangles.iter().flatten().for_each(|&vertex| used[vertex as usize] = true);
    let mut renamed = vec![0; points.len()];
    let mut kept = Vec::new();
    for (old, &point) in points.iter().enumerate().filter(|&(old, _)| used[old]) {
        renamed[old] = kept.len() as u32;
        kept.push(point);
    }
    triangles.iter_mut().flatten().for_each(|vertex| *vertex = renamed[*vertex as usize]);
    (kept, triangles)
}
