//! Constrained Delaunay triangulation and refinement by the crate spade.

use spade::{AngleLimit, ConstrainedDelaunayTriangulation, HasPosition, Point2, RefinementParameters, Triangulation};

use super::MeshError;

/// Circumradius over shortest edge, `1 / (2 sin 26°)`: the angle limit of the refinement, a little above 25 degrees.
const RATIO: f64 = 1.1406;

/// Points, and triangles of point numbers from 0.
pub(super) type Filled = (Vec<[f64; 2]>, Vec<[u32; 3]>);

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
pub(super) fn too_narrow() -> MeshError {
    MeshError::Recipe("the outline is too narrow for its triangles; ask for more of them".to_owned())
}

/// Delaunay triangles inside the simple polygon of the first `fixed` points.
///
/// # Errors
/// [`MeshError::Recipe`] if points coincide or lie on the polygon's sides, or if coordinates are too large or too
/// small.
pub(super) fn triangles(points: &[[f64; 2]], fixed: usize) -> Result<Vec<[u32; 3]>, MeshError> {
    Ok(inside(&triangulation(points, fixed)?))
}

/// Ruppert's refinement: adds points, also on the sides, until only the polygon's own corners give small angles.
/// At most `most` points are added.
///
/// # Errors
/// As [`triangles`].
pub(super) fn refine(points: &[[f64; 2]], fixed: usize, most: usize) -> Result<Filled, MeshError> {
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

/// Delaunay triangulation that keeps the polygon of the first `fixed` points.
fn triangulation(points: &[[f64; 2]], fixed: usize) -> Result<Delaunay, MeshError> {
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
    for from in 0..fixed {
        let (Some(from), Some(to)) = (handles[from], handles[(from + 1) % fixed]) else { return Err(too_narrow()) };
        if from == to || !delaunay.can_add_constraint(from, to) {
            return Err(too_narrow());
        }
        delaunay.add_constraint(from, to);
    }
    Ok(delaunay)
}

/// Triangles that cannot be reached from outside without crossing a constraint.
fn inside(delaunay: &Delaunay) -> Vec<[u32; 3]> {
    let mut outside = vec![false; delaunay.num_all_faces()];
    let rim = delaunay.directed_edges().filter(|edge| edge.is_outer_edge() && !edge.is_constraint_edge());
    let mut todo: Vec<_> = rim.filter_map(|edge| edge.rev().face().as_inner()).collect();
    while let Some(face) = todo.pop() {
        if std::mem::replace(&mut outside[face.fix().index()], true) {
            continue;
        }
        let open = face.adjacent_edges().into_iter().filter(|edge| !edge.is_constraint_edge());
        todo.extend(open.filter_map(|edge| edge.rev().face().as_inner()));
    }
    let inner = delaunay.inner_faces().filter(|face| !outside[face.fix().index()]);
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
