//! What a vertex touches of cloth near it, and what two edges of cloth touch of each other.

use super::{
    ClothMesh, ClothPlace, Curvature, Place,
    candidates::minus,
    obstacle_contact::tangents,
    space_points::{Feature, Point, along, cross, direction, nearest_of_segment, nearest_of_triangle},
    stencil::Stencil,
    touch::dot,
};

/// Geometry of a contact in space.
pub(super) type ClothStencil = Stencil<3, 2, 4>;

/// A vertex near cloth.
///
/// With m the number of triangles at an edge or a vertex, and n the number of edges at a vertex, the sum of a function of the distances from all triangles,
/// less m - 1 times that from each edge, and plus 1 + m - n times that from each vertex, is the function of the distance from the
/// surface, by the principle of inclusion and exclusion, if the part of the surface within any given distance of the vertex is one piece without holes. This holds over flat
/// and convex surfaces. In a concave fold both sides count. Inside a tube narrower than the skin the far side is subtracted. As each term is a function of the distance from something convex, the sum is continuously differentiable wherever no distance is zero (Li et al., *Convergent
/// Incremental Potential Contact*, 2023).
///
/// The terms of an edge or a vertex are shared by its triangles in equal parts. All terms of a triangle have one memory: the place in its plane that the
/// vertex is over, also beside the triangle. Where cloth is flat, friction cancels as the pressure does.
pub(super) struct ClothQuery<'a, A: Fn(u32) -> bool> {
    pub mesh: &'a ClothMesh,
    /// Positions at rest \[m\].
    pub rest: &'a [f64],
    /// Positions \[m\].
    pub x: &'a [f64],
    /// Position of the vertex \[m\].
    pub point: Point,
    /// Thickness of the skin \[m\].
    pub thickness: f64,
    /// Whether the vertex may touch a triangle.
    pub can_touch: A,
    /// Whether it may touch all triangles that share a corner with the one that is asked for.
    pub touches_all: bool,
}

/// A triangle of a query.
struct Triangle {
    corners: [Point; 3],
    normal: Point,
    /// Gradients of its barycentric coordinates [1/m].
    gradients: [Point; 3],
    /// Corners at rest \[m\], and gradients there [1/m].
    at_rest: [Point; 3],
    rest_gradients: [Point; 3],
}

impl<A: Fn(u32) -> bool> ClothQuery<'_, A> {
    /// Calls `act` with the geometry of the terms of a triangle: first that of the triangle itself, with a share of one.
    pub fn each(&self, triangle: u32, act: &mut dyn FnMut(ClothStencil)) {
        let own = &self.mesh.triangles()[triangle as usize];
        let [corners, at_rest] = [self.x, self.rest].map(|x| self.mesh.corners(x, triangle));
        let ((normal, gradients), (_, rest_gradients)) = (gradients(corners), gradients(at_rest));
        let triangle = Triangle { corners, normal, gradients, at_rest, rest_gradients };
        let (feature, shares) = nearest_of_triangle(self.point, corners);
        act(self.stencil(&triangle, feature == Feature::Face, shares, 1.0));
        for (side, edge) in own.sides.into_iter().enumerate() {
            let next = (side + 1) % 3;
            let t = nearest_of_segment(self.point, [corners[side], corners[next]]);
            if self.is_near(along([corners[side], corners[next]], t)) {
                let count = self.count_beside(edge);
                let mut shares = [0.0; 3];
                (shares[side], shares[next]) = (1.0 - t, t);
                if count > 1.0 {
                    act(self.stencil(&triangle, false, shares, 1.0 / count - 1.0));
                }
            }
        }
        for (corner, vertex) in own.corners.into_iter().enumerate() {
            if self.is_near(corners[corner]) {
                let [triangles, edges] = self.counts_around(vertex);
                let mut shares = [0.0; 3];
                shares[corner] = 1.0;
                let share = (1.0 + triangles - edges) / triangles;
                if share != 0.0 {
                    act(self.stencil(&triangle, false, shares, share));
                }
            }
        }
    }

    fn is_near(&self, point: Point) -> bool {
        let between = minus(self.point, point);
        dot(between, between) < self.thickness * self.thickness
    }

    /// Triangles at an edge that it may touch, ascending.
    fn beside(&self, edge: u32) -> impl Iterator<Item = u32> {
        self.mesh.beside(edge).filter(|triangle| (self.can_touch)(*triangle))
    }

    fn count_beside(&self, edge: u32) -> f64 {
        if self.touches_all { self.mesh.count_beside(edge) } else { self.beside(edge).map(|_| 1.0).sum() }
    }

    /// Number of triangles at a vertex that it may touch, and of their edges there.
    fn counts_around(&self, vertex: u32) -> [f64; 2] {
        if self.touches_all {
            return self.mesh.counts_around(vertex);
        }
        let mut counts = [0.0; 2];
        for triangle in self.mesh.around(vertex).filter(|triangle| (self.can_touch)(*triangle)) {
            let sides = self.mesh.triangles()[triangle as usize].sides;
            let at_vertex = sides.into_iter().filter(|edge| self.mesh.edges()[*edge as usize].ends.contains(&vertex));
            // Each edge at the first of its triangles.
            let own = at_vertex.filter(|edge| self.beside(*edge).next() == Some(triangle));
            counts = [counts[0] + 1.0, counts[1] + own.map(|_| 1.0).sum::<f64>()];
        }
        counts
    }

    /// Contact with the point of a triangle that has these barycentric coordinates.
    ///
    /// The rate of the slip is that of the vertex at p relative to the point c, along the surface, and relative to the rotation of the triangle: `t . (dp - dc -
    /// w x (p - c))`. With the surface gradient `H = sum(dx_i grad l_i')` and the normal m of the triangle, `w x m = -H' m`, and across m it is
    /// the skew part of H. On the face this is the derivative of the displacement of c over the triangle.
    fn stencil(&self, triangle: &Triangle, is_face: bool, shares: [f64; 3], share: f64) -> ClothStencil {
        let Triangle { corners, normal: own_normal, gradients, at_rest, rest_gradients } = *triangle;
        let from_first = minus(self.point, corners[0]);
        let (normal, distance) = if is_face {
            // Exact at any distance.
            let height = dot(own_normal, from_first);
            (if height < 0.0 { own_normal.map(|n| -n) } else { own_normal }, height.abs())
        } else {
            let nearest = |axis: usize| (0..3).fold(0.0, |sum, i| sum + shares[i] * corners[i][axis]);
            direction(minus(self.point, std::array::from_fn(nearest)))
        };
        let between = normal.map(|n| distance * n);
        let height = dot(between, own_normal);
        let beside = combined(1.0, between, -height, own_normal);
        let ways: [Point; 2] = tangents(normal);
        let mut place = ClothPlace { point: at_rest[0], ..ClothPlace::default() };
        let mut slips = [ways, [[0.0; 3]; 2], [[0.0; 3]; 2], [[0.0; 3]; 2]];
        for i in 0..3 {
            let at_rest = minus(at_rest[i], at_rest[0]);
            place.point = combined(1.0, place.point, dot(gradients[i], from_first), at_rest);
            for (way, tangent) in ways.into_iter().enumerate() {
                let upward = dot(tangent, own_normal);
                let flat = combined(1.0, tangent, -upward, own_normal);
                let (rate, lean) = (dot(gradients[i], tangent), dot(gradients[i], beside));
                let reach = dot(minus(corners[i], corners[0]), tangent);
                place.to[way] = combined(1.0, place.to[way], reach, rest_gradients[i]);
                place.back[way] = combined(1.0, place.back[way], rate, at_rest);
                let turned = combined(0.5 * lean, flat, -0.5 * rate, beside);
                let turned = combined(1.0, turned, upward * lean - height * rate, own_normal);
                slips[1 + i][way] = combined(-shares[i], tangent, -1.0, turned);
            }
        }
        place.invert();
        ClothStencil {
            weights: [1.0, -shares[0], -shares[1], -shares[2]],
            normal,
            slips,
            distance,
            curvature: Curvature::Flat,
            place: Place::Cloth(place),
            radius: 0.0,
            share,
            share_gradient: None,
        }
    }
}

/// Unit normal of a triangle, and gradients of its barycentric coordinates [1/m].
fn gradients([a, b, c]: [Point; 3]) -> (Point, [Point; 3]) {
    let doubled = cross(minus(b, a), minus(c, a));
    let square = dot(doubled, doubled);
    let scale = if square > 0.0 { 1.0 / square } else { 0.0 };
    let gradient = |side: Point| cross(doubled, side).map(|number| number * scale);
    (direction(doubled).0, [minus(c, b), minus(a, c), minus(b, a)].map(gradient))
}

/// Fraction of an edge at each end over which the share of its contact with another edge rises from zero to one.
const END: f64 = 0.25;
/// Square of the sine of the angle up to which the share of two edges rises from zero to one, at their lengths at rest. Between nearly parallel edges the
/// nearest points change fast.
const PARALLEL: f64 = 0.1;
/// Weight of a pair of edges, relative to their mean area. It is less than one, because the terms of vertices alone give the energy of two parallel
/// sheets.
const CROSSED: f64 = 0.25;

/// Contact of two edges that cross each other, whose product of lengths at rest is `lengths` \[m²\].
///
/// With u and w the edges, their nearest points at s and t, q the vector between these, `a = u . u`, `b = u . w`, `e = w . w` and `C = a e - b²`,
/// the conditions q . u = 0 and q . w = 0 give `C ds = b R2 - e R1` and `C dt = a R2 - b R1` with `R1 = u . r + q . du`,
/// `R2 = w . r + q . dw` and r the relative displacement of the two points of the edges. The share of the area is a
/// product of three ramps: of s, of t, and of `C/(0.1 lengths²)`.
pub(super) fn between_edges(
    [x0, x1]: [Point; 2],
    [x2, x3]: [Point; 2],
    lengths: f64,
    thickness: f64,
) -> Option<ClothStencil> {
    let (u, w, r) = (minus(x1, x0), minus(x3, x2), minus(x0, x2));
    let (a, b, e) = (dot(u, u), dot(u, w), dot(w, w));
    let between = a * e - b * b;
    let scale = PARALLEL * lengths * lengths;
    if between.is_nan() || between <= 1e-6 * scale {
        return None;
    }
    let (c, f) = (dot(u, r), dot(w, r));
    let [s, t] = [(b * f - e * c) / between, (a * f - b * c) / between];
    let ramps = [ramp(s, END), ramp(t, END), risen(between / scale)];
    let [along_s, along_t, across] = ramps.map(|[value, _]| value);
    let share = CROSSED * along_s * along_t * across;
    // The vector between the nearest points is orthogonal to both edges: exact at any distance.
    let (across_both, _) = direction(cross(u, w));
    let height = dot(across_both, r);
    let (normal, distance) = (if height < 0.0 { across_both.map(|n| -n) } else { across_both }, height.abs());
    if share == 0.0 || distance >= thickness {
        return None;
    }
    let q = normal.map(|n| n * distance);
    let weights = [1.0 - s, s, t - 1.0, -t];
    // How du and dw depend on each vertex.
    let (by_u, by_w) = ([-1.0, 1.0, 0.0, 0.0], [0.0, 0.0, -1.0, 1.0]);
    let (turn_u, turn_w) = (combined(2.0 * e, u, -2.0 * b, w), combined(2.0 * a, w, -2.0 * b, u));
    let ways: [Point; 2] = tangents(normal);
    let mut slips = [[[0.0; 3]; 2]; 4];
    let mut share_gradient = [[0.0; 3]; 4];
    for i in 0..4 {
        let (r1, r2) = (combined(weights[i], u, by_u[i], q), combined(weights[i], w, by_w[i], q));
        let ds = combined(-e / between, r1, b / between, r2);
        let dt = combined(-b / between, r1, a / between, r2);
        let angle = combined(by_u[i] / scale, turn_u, by_w[i] / scale, turn_w);
        let ends = combined(ramps[0][1] * along_t, ds, along_s * ramps[1][1], dt);
        share_gradient[i] = combined(CROSSED * across, ends, CROSSED * along_s * along_t * ramps[2][1], angle);
        slips[i] = ways.map(|way| combined(dot(way, u), ds, -dot(way, w), dt));
    }
    let [[m00, m01], [m10, m11]] = ways.map(|way| [dot(way, u), -dot(way, w)]);
    let determinant = m00 * m11 - m01 * m10;
    let place = ClothPlace {
        point: [s, t, 0.0],
        to: [[m00, m01, 0.0], [m10, m11, 0.0]],
        back: [[m11, -m10, 0.0], [-m01, m00, 0.0]].map(|row| row.map(|number| number / determinant)),
    };
    Some(ClothStencil {
        weights,
        normal,
        slips,
        distance,
        curvature: Curvature::Flat,
        place: Place::Cloth(place),
        radius: 0.0,
        share,
        share_gradient: Some(share_gradient),
    })
}

/// `a x + b y`.
fn combined(a: f64, x: Point, b: f64, y: Point) -> Point {
    std::array::from_fn(|axis| a * x[axis] + b * y[axis])
}

/// Rises from 0 at both ends of an edge to 1 within a part of it; and its derivative.
fn ramp(t: f64, part: f64) -> [f64; 2] {
    let (end, sign) = if t < 0.5 { (t, 1.0) } else { (1.0 - t, -1.0) };
    let [value, slope] = risen(end / part);
    [value, sign * slope / part]
}

/// Rises from 0 at 0 to 1 at 1, twice continuously differentiable: `y³ (10 - 15 y + 6 y²)`; and its derivative.
fn risen(y: f64) -> [f64; 2] {
    let y = y.clamp(0.0, 1.0);
    [y * y * y * (10.0 - 15.0 * y + 6.0 * y * y), 30.0 * y * y * (1.0 - y) * (1.0 - y)]
}
