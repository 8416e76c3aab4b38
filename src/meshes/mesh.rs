//! Triangle mesh with checked topology.

use super::{
    Embedded, Fan, Locator, MeshError, Numbering, Stroke,
    error::MOST_TRIANGLES,
    topology::{Topology, fans},
};

use std::collections::BTreeMap;

/// Smallest area of a triangle relative to its longest side squared. Below it the rest shape has no usable inverse.
const FLATTEST: f64 = 1e-12;

/// Distance, as a share of the size of a shape, below which two points count as one point written twice.
pub(crate) const NEAR: f64 = 2e-5;

/// Ratio of shortest to longest side below which a triangle is a needle: its two near points may be one point written
/// twice.
const NEEDLE: f64 = 0.01;

/// Triangle mesh in its rest shape.
/// [`Mesh::new`] ensures finite points, counter-clockwise triangles with an area, at most two triangles per edge, one
/// row of triangles around every vertex, and no vertex without a triangle.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    points: Vec<[f64; 2]>,
    triangles: Vec<[u32; 3]>,
    fans: Vec<Fan>,
    icing: Vec<Stroke>,
    messages: Vec<String>,
    numbering: Numbering,
}

impl Mesh {
    /// Checks points \[m\] and triangles of three vertex numbers each.
    /// Clockwise triangles are reversed. This, separate pieces, and coincident vertices are reported in
    /// [`Mesh::messages`].
    ///
    /// # Errors
    /// [`MeshError`] names the vertex or triangle that makes the mesh invalid.
    pub fn new(points: Vec<[f64; 2]>, triangles: Vec<[u32; 3]>) -> Result<Self, MeshError> {
        Self::counted_from((0, NEAR), points, triangles)
    }

    /// As [`Mesh::new`], with vertices counted from `base` in errors and messages. Triangles count from 0.
    /// Two vertices of a needle that are nearer than the share `near` of the mesh's size are refused.
    pub(super) fn counted_from(
        (base, near): (usize, f64),
        points: Vec<[f64; 2]>,
        mut triangles: Vec<[u32; 3]>,
    ) -> Result<Self, MeshError> {
        check_points(base, &points)?;
        let mut messages = Vec::new();
        let turned = wind((base, near), &points, &mut triangles)?;
        if turned > 0 {
            messages.push(match turned {
                1 => "1 triangle was clockwise and has been turned over".to_owned(),
                _ => format!("{turned} triangles were clockwise and have been turned over"),
            });
        }
        check_used(base, points.len(), &triangles)?;
        let topology = Topology::new(points.len(), &triangles, base)?;
        let (pieces, fans) = (topology.pieces(), fans(&points, &topology));
        if pieces > 1 {
            messages.push(format!("the mesh is {pieces} separate pieces"));
        }
        messages.extend(coincident((base, near), &points));
        Ok(Self { points, triangles, fans, icing: Vec::new(), messages, numbering: Numbering::default() })
    }

    /// Same mesh with icing.
    #[must_use]
    pub fn with_icing(mut self, icing: Vec<Stroke>) -> Self {
        self.icing = icing;
        self
    }

    /// Adds a message to [`Mesh::messages`].
    pub(super) fn with_message(mut self, message: String) -> Self {
        self.messages.push(message);
        self
    }

    /// The mesh with all lengths multiplied by a factor, which must be positive.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let points = self.points.iter().map(|point| point.map(|along| factor * along)).collect();
        Self { points, ..self.clone() }
    }

    /// Same mesh with vertices and triangles in another order.
    #[must_use]
    pub fn renumbered(&self, numbering: Numbering) -> Self {
        let corners = |corners: [u32; 3]| corners.map(|corner| numbering.vertex(corner));
        let mut places = vec![0; self.triangles.len()];
        (0..places.len()).for_each(|triangle| places[numbering.element_name(triangle)] = triangle as u32);
        let mut icing = self.icing.clone();
        let embedded = icing.iter_mut().flat_map(|stroke| &mut stroke.points);
        embedded.for_each(|point| point.triangle = places[point.triangle as usize]);
        let renumbered = |fan: &Fan| {
            let mut triangles = fan.0.map(|triangle| places.get(triangle as usize).copied().unwrap_or(Fan::NONE));
            triangles.sort_unstable();
            Fan(triangles)
        };
        let mut fans: Vec<_> = self.fans.iter().map(renumbered).collect();
        fans.sort_unstable_by_key(|fan| fan.0);
        Self {
            points: numbering.vertices_of(&self.points),
            triangles: numbering.elements_of(&self.triangles).into_iter().map(corners).collect(),
            fans,
            icing,
            messages: self.messages.clone(),
            numbering,
        }
    }

    /// The mesh with each triangle (a, b, c) divided into four at the middles of its sides: (a, ab, ca), (ab, b, bc), (ca, bc, c) and (ab, bc,
    /// ca), which take its place. Vertices keep their numbers; the new ones come after them.
    ///
    /// # Errors
    /// [`MeshError::TooMany`], if these are too many triangles.
    pub fn refined(&self) -> Result<Self, MeshError> {
        let (mut points, count) = (self.points.clone(), self.points.len() as u32);
        let mut middles = BTreeMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                let [one, other] = [a, b].map(|end| self.points[end as usize]);
                points.push([0, 1].map(|axis| 0.5 * (one[axis] + other[axis])));
                points.len() as u32 - 1
            })
        };
        // In the order of the list, so that their numbers do not depend on the order in memory.
        let mut listed: Vec<_> = (0..self.triangles.len()).collect();
        listed.sort_by_key(|triangle| self.numbering.element_name(*triangle));
        for [a, b, c] in listed.iter().map(|triangle| self.triangles[*triangle]) {
            for [a, b] in [[a, b], [b, c], [c, a]] {
                middle(a, b);
            }
        }
        let divided = |&[a, b, c]: &[u32; 3]| {
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        };
        let triangles: Vec<_> = self.triangles.iter().flat_map(divided).collect();
        let numbering = if self.numbering.is_as_listed() {
            Numbering::default()
        } else {
            let names = (0..count).map(|vertex| self.numbering.name(vertex)).chain(count..points.len() as u32);
            let of_four = |part: usize| 4 * self.numbering.element_name(part / 4) + part % 4;
            Numbering::new(names.collect(), (0..triangles.len()).map(|part| of_four(part) as u32).collect())
        };
        let mut icing = self.icing.clone();
        icing.iter_mut().flat_map(|stroke| &mut stroke.points).for_each(Embedded::refine);
        let messages = self.messages.clone();
        // Near vertices were checked in this mesh.
        Ok(Self { icing, messages, numbering, ..Self::counted_from((0, 0.0), points, triangles)? })
    }

    /// The mesh with other triangles in place of its own, which cover the same shape up to its outline. Its icing stays at its places.
    ///
    /// # Errors
    /// As [`Mesh::new`].
    pub(super) fn divided(&self, points: Vec<[f64; 2]>, triangles: Vec<[u32; 3]>) -> Result<Self, MeshError> {
        // Near vertices were checked in this mesh.
        let divided = Self::counted_from((0, 0.0), points, triangles)?;
        let locator = Locator::new(&divided.points, &divided.triangles);
        let mut icing = self.icing.clone();
        for point in icing.iter_mut().flat_map(|stroke| &mut stroke.points) {
            let corners = self.corners(point.triangle as usize);
            let at = [0, 1].map(|axis| (0..3).map(|corner| point.weights[corner] * corners[corner][axis]).sum());
            *point = locator.embed(at);
        }
        Ok(Self { icing, messages: self.messages.clone(), ..divided })
    }

    /// Numbers of vertices and triangles in the original list.
    pub const fn numbering(&self) -> &Numbering {
        &self.numbering
    }

    /// Positions at rest \[m\].
    pub fn points(&self) -> &[[f64; 2]] {
        &self.points
    }

    /// Vertex numbers, counter-clockwise.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Icing, which is drawn on the body and moves with it.
    pub fn icing(&self) -> &[Stroke] {
        &self.icing
    }

    /// Fans of all triangles, in the order of their first triangles.
    pub fn fans(&self) -> &[Fan] {
        &self.fans
    }

    /// Messages about a usable mesh, for the user.
    pub fn messages(&self) -> &[String] {
        &self.messages
    }

    /// Boundary edges `(from, to)` with the body on their left, in the order of the triangles.
    pub fn boundary_edges(&self) -> Vec<[u32; 2]> {
        self.topology().map_or_else(Vec::new, |topology| topology.boundary_edges().collect())
    }

    /// Boundary as closed loops without a repeated vertex: outer ones counter-clockwise, holes clockwise.
    pub fn boundary_loops(&self) -> Vec<Vec<u32>> {
        self.topology().map_or_else(Vec::new, |topology| topology.boundary_loops())
    }

    /// Corners of a triangle \[m\].
    pub fn corners(&self, triangle: usize) -> [[f64; 2]; 3] {
        self.triangles[triangle].map(|vertex| self.points[vertex as usize])
    }

    /// Total area \[m²\].
    pub fn area(&self) -> f64 {
        (0..self.triangles.len()).map(|triangle| area(self.corners(triangle))).sum()
    }

    /// Smallest angle of all triangles [°]. A good mesh is near 60.
    pub fn min_angle(&self) -> f64 {
        (0..self.triangles.len()).map(|triangle| min_angle(self.corners(triangle))).fold(60.0, f64::min)
    }

    /// Bounding box of all points \[m\]: lower left and upper right corner.
    pub fn bounds(&self) -> [[f64; 2]; 2] {
        bounds(&self.points)
    }

    /// Triangle that contains a point \[m\] at rest, and the weights of its corners. For many points use one [`Locator`].
    pub fn locate(&self, point: [f64; 2]) -> Option<(usize, [f64; 3])> {
        Locator::new(&self.points, &self.triangles).locate(point)
    }

    /// As [`Mesh::locate`], or the nearest triangle to a point outside; see [`Locator::locate_nearest`].
    pub fn locate_nearest(&self, point: [f64; 2]) -> Option<(usize, [f64; 3])> {
        Locator::new(&self.points, &self.triangles).locate_nearest(point)
    }

    /// Topology. It is never `None`, because [`Mesh::new`] has checked the same edges.
    fn topology(&self) -> Option<Topology<'_>> {
        Topology::new(self.points.len(), &self.triangles, 0).ok()
    }
}

/// Signed area of a triangle \[m²\], positive counter-clockwise.
pub(super) fn area([a, b, c]: [[f64; 2]; 3]) -> f64 {
    0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
}

/// Smallest angle of a triangle [°].
pub(super) fn min_angle([a, b, c]: [[f64; 2]; 3]) -> f64 {
    let doubled = 2.0 * area([a, b, c]).abs();
    let angle = |p: [f64; 2], q: [f64; 2], r: [f64; 2]| {
        let along = (q[0] - p[0]) * (r[0] - p[0]) + (q[1] - p[1]) * (r[1] - p[1]);
        libm::atan2(doubled, along).to_degrees()
    };
    angle(a, b, c).min(angle(b, c, a)).min(angle(c, a, b))
}

/// Bounding box of points \[m\]: lower left and upper right corner.
pub(super) fn bounds(points: &[[f64; 2]]) -> [[f64; 2]; 2] {
    points.iter().fold([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]], |[low, high], point| {
        [[low[0].min(point[0]), low[1].min(point[1])], [high[0].max(point[0]), high[1].max(point[1])]]
    })
}

/// Checks that all points are finite.
fn check_points(base: usize, points: &[[f64; 2]]) -> Result<(), MeshError> {
    match points.iter().position(|point| !(point[0].is_finite() && point[1].is_finite())) {
        Some(vertex) => Err(MeshError::NotFinite { vertex: vertex + base }),
        None => Ok(()),
    }
}

/// Checks vertex numbers and areas, and reverses clockwise triangles. Returns the number of reversed ones.
fn wind((base, near): (usize, f64), points: &[[f64; 2]], triangles: &mut [[u32; 3]]) -> Result<usize, MeshError> {
    if triangles.is_empty() {
        return Err(MeshError::Empty);
    }
    if triangles.len() > MOST_TRIANGLES {
        return Err(MeshError::TooMany(triangles.len()));
    }
    let size = size(points);
    let mut turned = 0;
    for (triangle, corners) in triangles.iter_mut().enumerate() {
        if let Some(&vertex) = corners.iter().find(|&&vertex| vertex as usize >= points.len()) {
            let last = (points.len() + base).saturating_sub(1);
            return Err(MeshError::NoSuchVertex { triangle, vertex: vertex as usize + base, last });
        }
        let [a, b, c] = corners.map(|vertex| points[vertex as usize]);
        let signed = area([a, b, c]);
        let sides = [[a, b], [b, c], [c, a]].map(|[p, q]| squared_distance(p, q));
        let longest = sides.into_iter().fold(0.0, f64::max);
        let least = if sides[0] <= sides[1].min(sides[2]) { 0 } else { 1 + usize::from(sides[2] < sides[1]) };
        let vertices = [corners[least], corners[(least + 1) % 3]].map(|vertex| vertex as usize + base);
        let limit = (near * size).min(NEEDLE * longest.sqrt());
        if sides[least] < limit * limit && vertices[0] != vertices[1] {
            return Err(MeshError::Near { triangle, vertices, distance: sides[least].sqrt() });
        }
        // The form of this test also refuses overflow to infinity or NaN.
        let solid = signed.abs() > FLATTEST * longest && signed.is_finite() && longest.is_finite();
        if !solid {
            return Err(MeshError::NoArea { triangle, corners: corners.map(|vertex| vertex as usize + base) });
        }
        if signed < 0.0 {
            corners.swap(1, 2);
            turned += 1;
        }
    }
    Ok(turned)
}

/// Checks that every vertex belongs to a triangle.
fn check_used(base: usize, vertices: usize, triangles: &[[u32; 3]]) -> Result<(), MeshError> {
    let mut used = vec![false; vertices];
    for &vertex in triangles.iter().flatten() {
        used[vertex as usize] = true;
    }
    match used.iter().position(|&used| !used) {
        Some(vertex) => {
            Err(MeshError::Unused { vertex: vertex + base, count: used.iter().filter(|&&used| !used).count() })
        }
        None => Ok(()),
    }
}

/// Longer side of the bounding box of points \[m\].
pub(crate) fn size(points: &[[f64; 2]]) -> f64 {
    let [low, high] = bounds(points);
    (high[0] - low[0]).max(high[1] - low[1])
}

/// Message about vertices nearer than the share `near` of the size, which leave a crack between triangles that seem
/// to touch.
fn coincident((base, near): (usize, f64), points: &[[f64; 2]]) -> Option<String> {
    let near = near * size(points);
    let close = |a: usize, b: usize| (0..2).all(|axis| (points[a][axis] - points[b][axis]).abs() <= near);
    let mut pairs = Vec::new();
    // Columns have the width `near`, and the second pass shifts them by half, so that two near points share a column
    // once.
    for shift in [0.0, 0.5] {
        let column = |vertex: usize| if near > 0.0 { (points[vertex][0] / near + shift).floor() } else { 0.0 };
        let mut order: Vec<(f64, usize)> = (0..points.len()).map(|vertex| (column(vertex), vertex)).collect();
        order.sort_unstable_by(|a, b| {
            let [p, q] = [points[a.1], points[b.1]];
            a.0.total_cmp(&b.0).then(p[1].total_cmp(&q[1])).then(p[0].total_cmp(&q[0])).then(a.1.cmp(&b.1))
        });
        let neighbours = order.windows(2).map(|pair| (pair[0].1.min(pair[1].1), pair[0].1.max(pair[1].1)));
        pairs.extend(neighbours.filter(|&(a, b)| close(a, b)));
    }
    pairs.sort_unstable();
    pairs.dedup();
    let (first, second) = *pairs.first()?;
    Some(format!(
        "vertices {} and {} lie at the same place ({} such in all): the mesh is open there; give both triangles the same vertex if it \
         should hold together",
        first + base,
        second + base,
        pairs.len()
    ))
}

/// Squared distance of two points \[m²\].
pub(super) fn squared_distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1])
}

/// Squared distance from a point to the segment between two others \[m²\].
pub(super) fn squared_distance_to_side(from: [f64; 2], to: [f64; 2], point: [f64; 2]) -> f64 {
    squared_distance(nearest_on_side(from, to, point), point)
}

/// The point of the segment between two points that is nearest to a third \[m\].
pub(super) fn nearest_on_side(from: [f64; 2], to: [f64; 2], point: [f64; 2]) -> [f64; 2] {
    let along = [to[0] - from[0], to[1] - from[1]];
    let length = squared_distance(from, to);
    let share = ((point[0] - from[0]) * along[0] + (point[1] - from[1]) * along[1]) / length;
    // A side of zero length gives NaN here; its first end then counts.
    let share = if share > 0.0 { share.min(1.0) } else { 0.0 };
    [from[0] + share * along[0], from[1] + share * along[1]]
}
