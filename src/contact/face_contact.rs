//! Contact of triangles of membranes with obstacles in space, between their corners.

use super::{
    BetweenVertices, ClothTriangle, ContactName, FacePoint, FacePoints, Members, Met, ObstacleContact, Path,
    PlacedObstacle, Touch,
    candidates::minus,
    obstacle_contact::SurfacePoint,
    touch::{coordinates, dot},
};
use crate::{
    effects::{Bounds, Motion},
    obstacles::{Rigid, SweptMotion},
    solvers::{SparseMatrix, Weights},
};

/// Contact with obstacles in space.
type SpaceContact = ObstacleContact<3, 2, 4>;

impl SpaceContact {
    /// Lets triangles touch at points between their corners too, where obstacles at rest have edges, corners or small spheres. Obstacles that move touch
    /// vertices alone: where they crush cloth against others, the truncation at points would drive vertices into these.
    #[must_use]
    pub fn with_faces(mut self, faces: FacePoints) -> Self {
        let parts = self.surface.parts() as u32;
        let divisions = |placed: &PlacedObstacle<3>, part: u32| {
            let reach = self.potential(part).thickness.max(placed.obstacle.margin());
            if placed.motions.is_empty() { faces.divisions(part, placed.obstacle.spacing(reach)) } else { 1 }
        };
        let all = self.obstacles.iter().flat_map(|placed| (0..parts).map(move |part| divisions(placed, part)));
        self.divisions = all.collect();
        self.faces = self.divisions.iter().any(|m| *m > 1).then_some(faces);
        self
    }

    /// Number of parts that the sides of the triangles of a part are divided into for an obstacle.
    fn divisions(&self, obstacle: usize, part: u32) -> usize {
        self.divisions[obstacle * self.surface.parts() + part as usize]
    }

    /// Name of the contact of a point with an obstacle.
    fn face_name(&self, obstacle: usize, (vertex, number): (u32, u32)) -> ContactName {
        let count = self.obstacles.len() as u32;
        ContactName { effect: self.number(), surface: count * (1 + number) + obstacle as u32, vertex }
    }

    /// The triangle and the number of a point with this name, if it touches this obstacle.
    fn face_named(&self, faces: &FacePoints, obstacle: usize, name: ContactName) -> Option<(u32, u32)> {
        let count = self.obstacles.len() as u32;
        let number = (name.surface / count).checked_sub(1).filter(|_| name.surface % count == obstacle as u32)?;
        faces.named((name.vertex, number))
    }

    /// Calls `act` for each point of a triangle that touches an obstacle, which is at a place.
    fn each_of_face(
        &self,
        (motion, moved): (Motion<'_>, f64),
        (faces, triangle): (&FacePoints, u32),
        (number, at): (usize, Option<Rigid<3>>),
        act: &mut dyn FnMut(&Touch<3, 2, 4>),
    ) {
        let own = faces.triangles()[triangle as usize];
        let divisions = self.divisions(number, own.part);
        if divisions == 1 {
            return;
        }
        let corners = own.corners.map(|corner| coordinates(motion.x, corner));
        let (middle, radius) = ball_around(corners);
        let obstacle = &self.obstacles[number].obstacle;
        let reach = self.potential(own.part).thickness + self.offset(own.part, obstacle.margin()) + moved;
        if obstacle.distance(at.map_or(middle, |at| at.back(middle)), reach + radius).is_none() {
            return;
        }
        let [a, b, c] = own.corners;
        for point in faces.of(triangle, divisions) {
            let [p, q, r] = point.shares;
            let x = mean(point.shares, corners);
            let point = || SurfacePoint {
                name: self.face_name(number, faces.name(&point)),
                vertices: [a, a, b, c],
                members: Members::Surface,
                weights: [-1.0, p, q, r],
                area: point.area,
            };
            self.touch_of((motion, moved), (number, at), (x, own.part), point, act);
        }
    }
}

/// Successive triangles that are tested at once.
const BLOCK: usize = 16;

/// The box around the corners of some triangles.
fn box_around(triangles: &[ClothTriangle], x: &[f64]) -> Bounds<3> {
    let (mut least, mut greatest) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for corner in triangles.iter().flat_map(|triangle| triangle.corners) {
        let at: [f64; 3] = coordinates(x, corner);
        for axis in 0..3 {
            least[axis] = least[axis].min(at[axis]);
            greatest[axis] = greatest[axis].max(at[axis]);
        }
    }
    Bounds([least, greatest])
}

/// The middle of a triangle, and the greatest distance of a corner from it \[m\].
fn ball_around(corners: [[f64; 3]; 3]) -> ([f64; 3], f64) {
    let middle = mean([1.0 / 3.0; 3], corners);
    let square = |corner: [f64; 3]| {
        let from = minus(corner, middle);
        dot(from, from)
    };
    (middle, corners.map(square).into_iter().fold(0.0, f64::max).sqrt())
}

/// The point with these barycentric coordinates.
fn mean(shares: [f64; 3], corners: [[f64; 3]; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| (0..3).fold(0.0, |sum, i| sum + shares[i] * corners[i][axis]))
}

impl BetweenVertices<3, 2, 4> for SpaceContact {
    fn each_between(&self, motion: Motion<'_>, act: &mut dyn FnMut(&Touch<3, 2, 4>)) {
        let Some(faces) = &self.faces else { return };
        let moved = motion.half_displacement();
        let reach = self.greatest_thickness() + moved;
        self.each_near(motion, reach, |number, placed, at| {
            for (block, triangles) in faces.triangles().chunks(BLOCK).enumerate() {
                if placed.is_near(box_around(triangles, motion.x).grown(reach), at) {
                    for triangle in (BLOCK * block..).take(triangles.len()) {
                        self.each_of_face((motion, moved), (faces, triangle as u32), (number, at), act);
                    }
                }
            }
        });
    }

    fn between_pattern(&self, add: &mut dyn FnMut(u32, u32)) {
        for triangle in self.faces.iter().flat_map(FacePoints::triangles) {
            let [a, b, c] = triangle.corners;
            for [one, other] in [[a, b], [b, c], [c, a]] {
                add(one, other);
            }
        }
    }

    fn add_between_stiffness(&self, motion: Motion<'_>, weights: Weights, matrix: &mut dyn SparseMatrix) {
        let (Some(faces), Some(matrix)) = (&self.faces, matrix.blocks::<3>()) else { return };
        let moved = motion.half_displacement();
        for triangle in 0..faces.triangles().len() as u32 {
            let mut blocks = [nalgebra::Matrix3::zeros(); 3];
            for (number, placed) in self.obstacles.iter().enumerate() {
                let at = placed.within(motion.time, motion.span);
                self.each_of_face((motion, moved), (faces, triangle), (number, at), &mut |touch| {
                    let linearised = touch.linearised(weights);
                    for i in touch.range() {
                        matrix.diagonal(touch.vertices[i] as usize, &linearised.block(i, i));
                    }
                    for (block, [i, j]) in blocks.iter_mut().zip([[1, 2], [2, 3], [3, 1]]) {
                        *block += linearised.block(i, j);
                    }
                });
            }
            for block in &blocks {
                matrix.off_diagonal(block);
            }
        }
    }

    fn each_candidate_between(
        &self,
        path: &Path<'_>,
        (number, motion, is_short): (usize, &SweptMotion<3>, bool),
        act: &mut dyn FnMut(u32, u32),
    ) {
        let Some(faces) = &self.faces else { return };
        if is_short {
            let own = self.own_anchors(path.known()).iter();
            own.filter_map(|anchor| self.face_named(faces, number, anchor.contact)).for_each(|(a, b)| act(a, b));
            return;
        }
        for (triangle, own) in (0..).zip(faces.triangles()) {
            let divisions = self.divisions(number, own.part);
            let [start, end] = [path.start, path.end].map(|x| own.corners.map(|corner| coordinates(x, corner)));
            let start = start.map(|point| motion.place(point));
            let bounds = Bounds::of([start, end].as_flattened().as_flattened()).grown(self.greatest_thickness());
            if divisions > 1 && self.obstacles[number].is_near(bounds, motion.end()) {
                faces.of(triangle, divisions).for_each(|point| act(triangle, point.number));
            }
        }
    }

    fn find_between(
        &self,
        path: &Path<'_>,
        (number, motion): (usize, &SweptMotion<3>),
        (triangle, point): (u32, u32),
    ) -> Option<Met<3>> {
        let faces = self.faces.as_ref()?;
        let own = faces.triangles()[triangle as usize];
        let mut points = faces.of(triangle, self.divisions(number, own.part));
        let point: FacePoint = points.find(|own| own.number == point)?;
        let [from, to] =
            [path.start, path.end].map(|x| mean(point.shares, own.corners.map(|corner| coordinates(x, corner))));
        let name = self.face_name(number, faces.name(&point));
        let met = self.find_point(path, (number, motion), ([from, to], own.part, name))?;
        Some(Met { vertices: own.corners.map(|corner| corner as usize), weights: point.shares, ..met })
    }

    fn split_surface(&self, surface: u32) -> Option<(usize, u32)> {
        let count = self.obstacles.len() as u32;
        Some((surface.checked_rem(count)? as usize, surface / count))
    }

    fn join_surface(&self, obstacle: usize, part: u32) -> Option<u32> {
        let count = self.obstacles.len() as u32;
        part.checked_mul(count)?.checked_add(obstacle as u32).filter(|_| obstacle < self.obstacles.len())
    }

    fn share_between(&self, obstacle: usize, part: u32) -> f64 {
        let parts = self.faces.as_ref().map_or(1, |_| self.divisions(obstacle, part));
        1.0 - 1.0 / (parts * parts) as f64
    }

    fn area_around(&self, vertex: u32, _: u32, own: f64) -> f64 {
        self.faces.as_ref().map_or(own, |faces| own.max(faces.area_around(vertex)))
    }
}
