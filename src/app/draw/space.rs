//! Draws scenes in space: the camera that turns about a point, shaded surfaces sorted by their depth, and springs.

use super::{
    View,
    cloth::{Look, Looks, of_direction, shaded},
    shape_buffer::ShapeBuffer,
};
use crate::{
    app::{canvas::Options, colour::Scale},
    finish::Sheen,
    obstacles::Triangulation,
    snapshot::{Field, Snapshot},
};
use eframe::egui::{Align2, Color32, Context, FontId, Painter, Pos2, Rect, epaint::WHITE_UV, pos2, vec2};

/// Half of the angle of view \[rad\].
const HALF_VIEW: f64 = 0.3;

/// Part of the stage that the scene fills when all of it is seen.
const FILLED: f64 = 0.8;

/// In place of the number of a net or membrane.
const OBSTACLE: u32 = u32::MAX;

/// Least depth of a point before the eye, as a fraction of its distance from the centre.
const NEAR: f64 = 0.02;

/// Where the eye looks, from which side, and how much it sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orbit {
    /// Point that the eye looks at \[m\].
    pub centre: [f64; 3],
    /// Radius of the sphere about it that fills the stage \[m\].
    pub radius: f64,
    /// Turn of the eye about the y axis, from the front to the right \[rad\].
    pub yaw: f64,
    /// Height of the eye above the horizon \[rad\].
    pub pitch: f64,
}

impl Orbit {
    /// A view from the front right and a little from above.
    pub const ASLANT: [f64; 2] = [0.55, 0.3];

    /// Sees a sphere around some points \[m\], flat.
    pub fn around(points: &[f64], [yaw, pitch]: [f64; 2]) -> Self {
        let all = || points.as_chunks::<3>().0.iter();
        let side = |axis: usize| {
            let (least, most) = all().fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), point| {
                (least.min(point[axis]), most.max(point[axis]))
            });
            if least <= most { 0.5 * (least + most) } else { 0.0 }
        };
        let centre = [side(0), side(1), side(2)];
        let distance = |point: &[f64; 3]| (0..3).map(|i| (point[i] - centre[i]).powi(2)).sum::<f64>().sqrt();
        let radius = all().map(distance).fold(0.0, f64::max);
        Self { centre, radius: if radius > 0.0 && radius.is_finite() { radius } else { 1.0 }, yaw, pitch }
    }

    /// The view of a scene that opens with some points \[m\], flat, with room for what will hang down.
    pub fn opening(points: &[f64]) -> Self {
        /// Radius as a multiple of that of the points.
        const ROOM: f64 = 1.7;
        let around = Self::around(points, Self::ASLANT);
        Self { radius: ROOM * around.radius, ..around }
    }

    /// Turns the eye by a drag [points].
    pub fn turn(&mut self, by: eframe::egui::Vec2) {
        /// Turn by a point \[rad\].
        const SPEED: f64 = 0.008;
        self.yaw -= SPEED * f64::from(by.x);
        self.pitch = (self.pitch + SPEED * f64::from(by.y)).clamp(-1.55, 1.55);
    }
}

/// Maps points in space to the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpaceCamera {
    eye: [f64; 3],
    /// To the right, up, and forwards.
    axes: [[f64; 3]; 3],
    middle: Pos2,
    /// Points on the screen of a tangent of one.
    scale: f64,
    near: f64,
    /// Distance of the eye from the centre \[m\].
    distance: f64,
}

impl SpaceCamera {
    /// The camera of a view on a stage.
    pub fn new(orbit: Orbit, canvas: Rect) -> Self {
        let Orbit { centre, radius, yaw, pitch } = orbit;
        let ((sy, cy), (sp, cp)) = (yaw.sin_cos(), pitch.sin_cos());
        // From the centre to the eye; z is towards the viewer.
        let back = [sy * cp, sp, cy * cp];
        let axes = [[cy, 0.0, -sy], [-sy * sp, cp, -cy * sp], back.map(|axis| -axis)];
        let distance = radius / HALF_VIEW.sin();
        let eye = [0, 1, 2].map(|axis| centre[axis] + distance * back[axis]);
        let half = 0.5 * f64::from(canvas.height().min(canvas.width()));
        Self {
            eye,
            axes,
            middle: canvas.center(),
            scale: FILLED * half / HALF_VIEW.tan(),
            near: NEAR * distance,
            distance,
        }
    }

    /// A point of space on the screen, and its depth before the eye \[m\].
    pub fn seen(&self, point: [f64; 3]) -> (Pos2, f64) {
        /// Farther points are not distinguished: an exploded scene must not break the drawing [points].
        const FARTHEST: f64 = 1e5;
        let [x, y, depth] = self.axes.map(|axis| (0..3).map(|i| axis[i] * (point[i] - self.eye[i])).sum::<f64>());
        let scale = self.scale / depth.max(self.near);
        let place = |from: f32, by: f64| from + by.clamp(-FARTHEST, FARTHEST) as f32;
        (pos2(place(self.middle.x, scale * x), place(self.middle.y, -scale * y)), depth)
    }

    /// The point of space at a depth \[m\] that is seen at a point of the screen.
    pub fn at_depth(&self, at: Pos2, depth: f64) -> [f64; 3] {
        let depth = depth.max(self.near);
        let (x, y) = (f64::from(at.x - self.middle.x), f64::from(self.middle.y - at.y));
        let along = [x / self.scale * depth, y / self.scale * depth, depth];
        [0, 1, 2].map(|i| self.eye[i] + (0..3).map(|axis| along[axis] * self.axes[axis][i]).sum::<f64>())
    }

    /// A displacement of the screen [points] in the plane of the centre \[m\].
    pub fn moved(&self, by: eframe::egui::Vec2) -> [f64; 3] {
        let scale = self.distance / self.scale;
        let (x, y) = (scale * f64::from(by.x), -scale * f64::from(by.y));
        [0, 1, 2].map(|i| x * self.axes[0][i] + y * self.axes[1][i])
    }

    /// Whether a point of space is before the eye, and not too near to it.
    pub fn shows(&self, point: [f64; 3]) -> bool {
        self.seen(point).1 > self.near
    }

    /// The axis nearest to the line of sight, and whether it points to the eye (1) or away from it (-1).
    pub fn axis_of_sight(&self) -> (usize, f64) {
        let forwards = self.axes[2];
        let steeper = |a: &usize, b: &usize| forwards[*a].abs().total_cmp(&forwards[*b].abs());
        let axis = (0..3).max_by(steeper).unwrap_or(2);
        (axis, -forwards[axis].signum())
    }

    /// Length on the screen of a metre at the centre [points].
    pub fn length(&self) -> f32 {
        (self.scale / self.distance) as f32
    }
}

/// Diagonal of the box around flat points in space \[m\].
fn diagonal(points: &[f64]) -> f64 {
    let length = |axis: usize| {
        let along = || points.iter().skip(axis).step_by(3).copied();
        along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min)
    };
    (0..3).map(length).map(|length| length * length).sum::<f64>().sqrt()
}

/// Buffers for drawing surfaces.
#[derive(Default)]
pub struct Surfaces {
    looks: Looks,
    /// All corners: the vertices, then those of obstacles, then those of shadows.
    corners: Vec<Pos2>,
    /// Numbers of vertices and corners of obstacles that are drawn alike, in their order, and how.
    alike: Vec<(usize, Look)>,
    /// Depth of each vertex and of each corner of an obstacle \[m\].
    depths: Vec<f64>,
    /// Sum of the normals of the triangles at each of them, seen from the eye: right, up, back.
    normals: Vec<[f32; 3]>,
    /// The triangles, the farthest first.
    order: Vec<Facet>,
    /// Distance by which a triangle of cloth may lie behind what it bends around \[m\].
    bend: f64,
    /// Number of triangles of surfaces without end, which come before the others.
    ground: usize,
    /// Triangles of shadows on them, and the colour of these.
    shadows: Vec<[u32; 3]>,
    shade: Color32,
}

/// A triangle to be drawn.
#[derive(Clone, Copy)]
struct Facet {
    /// Sum of the depths of its corners \[m\].
    depth: f32,
    corners: [u32; 3],
    /// Number of its net or membrane, nets first; or [`OBSTACLE`].
    part: u32,
    /// Its number among the triangles of all membranes; [`NONE`] if it is none of them.
    triangle: u32,
}

/// No triangle of a membrane.
const NONE: u32 = u32::MAX;

/// Direction to the sun, whose shadows fall on floors.
const SUN: [f64; 3] = [0.25, 1.0, 0.3];

/// Distance by which a triangle of cloth may lie behind what it bends around, as a fraction of its circumference.
const BEND: f64 = 0.15;

/// Share of its light that a floor loses in a shadow.
const SHADE: f32 = 0.3;

impl Surfaces {
    /// Follows what cloths look like.
    pub fn follow(&mut self, context: &Context, view: View, snapshot: &Snapshot) {
        self.looks.follow(context, view.theme, snapshot);
    }

    /// Maps the vertices to the screen.
    pub fn place(&mut self, snapshot: &Snapshot, camera: &SpaceCamera, points: &mut Vec<Pos2>) {
        points.clear();
        self.depths.clear();
        for point in snapshot.positions.as_chunks().0 {
            let (at, depth) = camera.seen(*point);
            points.push(at);
            self.depths.push(depth);
        }
    }

    /// Depth of a vertex \[m\].
    pub fn depth(&self, vertex: usize) -> Option<f64> {
        self.depths.get(vertex).copied()
    }

    /// The vertex that is meant at a point of the screen: the nearest there, and of several that lie on each other the nearest to the
    /// eye.
    pub fn pick(&self, points: &[Pos2], at: Pos2) -> Option<usize> {
        /// Greatest difference of their distances from the point [points].
        const TOGETHER: f32 = 2.0;
        let nearest = crate::app::canvas::nearest_on_screen(points, at)?;
        let reach = points[nearest].distance(at) + TOGETHER;
        let within = (0..points.len()).filter(|vertex| points[*vertex].distance(at) <= reach);
        let depth = |vertex: &usize| self.depths.get(*vertex).copied().unwrap_or(f64::INFINITY);
        within.min_by(|a, b| depth(a).total_cmp(&depth(b)))
    }

    /// Draws all membranes, nets and obstacles.
    pub fn draw<'a>(
        &mut self,
        buffer: &mut ShapeBuffer,
        view: View,
        snapshot: &Snapshot,
        (options, scale, obstacles): (&Options, &Scale, impl Iterator<Item = &'a Triangulation> + Clone),
        (points, camera): (&[Pos2], &SpaceCamera),
    ) {
        self.add_cloth(snapshot, (points, camera));
        let factor = (0.3 * diagonal(&snapshot.start)).max(1.0);
        self.add_obstacles(view, obstacles.clone(), camera, factor);
        self.order.sort_unstable_by(|a, b| b.depth.total_cmp(&a.depth));
        self.shadows.clear();
        let (floors, others): (Vec<_>, Vec<_>) = obstacles.partition(|obstacle| obstacle.endless_about.is_some());
        for floor in floors {
            self.add_shadows(view, snapshot, (floor, &others), camera);
        }
        let has_values = options.field != Field::None && options.field == snapshot.field;
        let is_coloured = has_values && self.order.iter().any(|facet| facet.triangle != NONE);
        if options.normals {
            self.shadows.clear();
            self.draw_facets(buffer, false, |_, side, normal| {
                let sign = if side == 0 { 1.0 } else { -1.0 };
                let of = |axis: usize| {
                    let [right, up, back] = normal.map(f64::from);
                    right * camera.axes[0][axis] + up * camera.axes[1][axis] - back * camera.axes[2][axis]
                };
                of_direction([0, 1, 2].map(|axis| sign * of(axis) as f32))
            });
        } else if is_coloured || self.looks.has_patterns() {
            self.draw_facets(buffer, !is_coloured, |facet, side, normal| {
                match snapshot.values.get(facet.triangle as usize).filter(|_| is_coloured) {
                    Some(value) => shaded(scale.at(scale.share(*value)), Sheen::Matte, normal),
                    None => self.look(facet.part, view).lit(side, normal),
                }
            });
        } else {
            self.draw_smooth(buffer);
        }
        Self::lines(buffer, view, snapshot, options, points);
    }

    /// Look of a net, membrane or obstacle.
    fn look(&self, part: u32, view: View) -> Look {
        self.looks.get(part as usize).copied().unwrap_or(Look::matte(view.theme.wall))
    }

    /// Begins with the faces of nets and membranes.
    fn add_cloth(&mut self, snapshot: &Snapshot, (points, camera): (&[Pos2], &SpaceCamera)) {
        self.order.clear();
        self.normals.clear();
        self.normals.resize(points.len(), [0.0; 3]);
        self.corners.clear();
        self.corners.extend_from_slice(points);
        self.alike.clear();
        self.bend = 0.0;
        let at = |vertex: u32| snapshot.position(vertex as usize);
        let mut triangle = 0;
        let nets = snapshot.nets.iter().map(|net| (net.faces.as_slice(), net.vertices.len(), false));
        let membranes = snapshot.membranes.iter();
        let membranes = membranes.map(|one| (one.elements.corners(), one.vertices.len(), true));
        for (part, (faces, vertices, is_membrane)) in nets.chain(membranes).enumerate() {
            if let Some([a, b, c]) = faces.first().map(|corners| corners.map(at)) {
                let length = |a: Option<[f64; 3]>, b: Option<[f64; 3]>| {
                    a.zip(b).map_or(0.0, |(a, b)| (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt())
                };
                self.bend = self.bend.max(BEND * (length(a, b) + length(b, c) + length(c, a)));
            }
            for corners in faces {
                self.add(&at, camera, *corners, (part as u32, if is_membrane { triangle } else { NONE }));
                triangle += u32::from(is_membrane);
            }
            if let Some(look) = self.looks.get(part) {
                self.alike.push((vertices, *look));
            }
        }
    }

    /// Adds the triangles of obstacles.
    fn add_obstacles<'a>(
        &mut self,
        view: View,
        obstacles: impl Iterator<Item = &'a Triangulation>,
        camera: &SpaceCamera,
        factor: f64,
    ) {
        let before = self.corners.len();
        self.ground = 0;
        for obstacle in obstacles {
            let first = self.corners.len() as u32;
            for point in (0..obstacle.points.len()).filter_map(|corner| obstacle.drawn(corner, factor)) {
                let (seen, depth) = camera.seen(point);
                self.corners.push(seen);
                self.depths.push(depth);
            }
            self.normals.resize(self.corners.len(), [0.0; 3]);
            let at = |corner: u32| obstacle.drawn((corner - first) as usize, factor);
            let from = self.order.len();
            for corners in &obstacle.triangles {
                self.add(&at, camera, corners.map(|corner| first + corner), (OBSTACLE, NONE));
            }
            if obstacle.endless_about.is_some() {
                self.ground += self.order.len() - from;
                self.order[from..].iter_mut().for_each(|facet| facet.depth = f32::MAX);
            }
        }
        self.alike.push((self.corners.len() - before, Look::matte(view.theme.wall)));
    }

    /// Adds the shadows of cloth and of other obstacles on a floor that the eye sees from above.
    fn add_shadows(
        &mut self,
        view: View,
        snapshot: &Snapshot,
        (floor, others): (&Triangulation, &[&Triangulation]),
        camera: &SpaceCamera,
    ) {
        /// Least height of a normal of a floor.
        const LEVEL: f64 = 0.7;
        let Some((origin, normal)) = floor.endless_about.zip(floor.normal()) else { return };
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let height = |point: [f64; 3]| dot(normal, [0, 1, 2].map(|i| point[i] - origin[i]));
        if normal[1] < LEVEL || height(camera.eye) <= 0.0 {
            return;
        }
        let (first, slope) = (self.corners.len() as u32, dot(normal, SUN));
        let cast = |point: &[f64; 3]| {
            let along = height(*point).max(0.0) / slope;
            camera.seen([0, 1, 2].map(|i| point[i] - along * SUN[i])).0
        };
        self.corners.extend(snapshot.positions.as_chunks::<3>().0.iter().map(cast));
        let of_nets = snapshot.nets.iter().flat_map(|net| net.faces.iter());
        let of_membranes = snapshot.membranes.iter().flat_map(|membrane| membrane.elements.corners());
        let above = |corners: &&[u32; 3]| {
            corners.iter().any(|corner| snapshot.position(*corner as usize).is_some_and(|point| height(point) > 0.0))
        };
        let faces = of_nets.chain(of_membranes).filter(above);
        self.shadows.extend(faces.map(|corners| corners.map(|corner| first + corner)));
        for obstacle in others {
            let first = self.corners.len() as u32;
            self.corners.extend(obstacle.points.iter().map(cast));
            self.shadows.extend(obstacle.triangles.iter().map(|corners| corners.map(|corner| first + corner)));
        }
        let [right, up, forwards] = camera.axes.map(|axis| dot(axis, normal) as f32);
        self.shade = shaded(view.theme.wall, Sheen::Matte, [right, up, -forwards]).lerp_to_gamma(Color32::BLACK, SHADE);
    }

    /// Draws triangles with shared corners: each corner twice, in the colours of the front and of the back.
    fn draw_smooth(&self, buffer: &mut ShapeBuffer) {
        let first = buffer.len();
        let looks = self.alike.iter().flat_map(|(count, look)| std::iter::repeat_n(look, *count));
        for ((point, normal), look) in self.corners.iter().zip(&self.normals).zip(looks) {
            for (side, sign) in [(0, 1.0), (1, -1.0)] {
                buffer.vertex(*point, look.lit(side, normal.map(|axis| sign * axis)));
            }
        }
        let lit = self.normals.len() as u32;
        for point in &self.corners[self.normals.len()..] {
            buffer.vertex(*point, self.shade);
        }
        let shadow = |corner: u32| first + 2 * lit + (corner - lit);
        let draw = |buffer: &mut ShapeBuffer, facet: &Facet| {
            let side = self.side(facet.corners) as u32;
            let [a, b, c] = facet.corners.map(|corner| first + 2 * corner + side);
            buffer.triangle(a, b, c);
        };
        let (ground, others) = self.order.split_at(self.ground);
        for facet in ground {
            draw(buffer, facet);
        }
        for corners in &self.shadows {
            let [a, b, c] = corners.map(shadow);
            buffer.triangle(a, b, c);
        }
        for facet in others {
            draw(buffer, facet);
        }
    }

    /// Draws each triangle in its own colours, by its side, 0 for the front, and the normal towards the eye; or with the pattern of its
    /// cloth.
    fn draw_facets(
        &self,
        buffer: &mut ShapeBuffer,
        has_patterns: bool,
        color: impl Fn(&Facet, usize, [f32; 3]) -> Color32,
    ) {
        let draw = |buffer: &mut ShapeBuffer, facet: &Facet| {
            let side = self.side(facet.corners);
            let sign = if side == 0 { 1.0 } else { -1.0 };
            let look = self.looks.get(facet.part as usize).filter(|_| has_patterns);
            let texture = look.and_then(|look| look.texture);
            buffer.texture(texture);
            let [a, b, c] = facet.corners.map(|corner| {
                let lit = color(facet, side, self.normals[corner as usize].map(|axis| sign * axis));
                let place = if texture.is_some() { self.looks.place(corner) } else { WHITE_UV };
                buffer.textured_vertex(self.corners[corner as usize], place, lit)
            });
            buffer.triangle(a, b, c);
        };
        let (ground, others) = self.order.split_at(self.ground);
        for facet in ground {
            draw(buffer, facet);
        }
        buffer.texture(None);
        for corners in &self.shadows {
            let [a, b, c] = corners.map(|corner| buffer.vertex(self.corners[corner as usize], self.shade));
            buffer.triangle(a, b, c);
        }
        for facet in others {
            draw(buffer, facet);
        }
        buffer.texture(None);
    }

    /// The side of a triangle that the eye sees: 0 is its front, 1 its back.
    fn side(&self, corners: [u32; 3]) -> usize {
        let [a, b, c] = corners.map(|corner| self.corners[corner as usize]);
        usize::from((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x) > 0.0)
    }

    /// Value of the nearest triangle at a point of the screen.
    pub fn value_at(&self, snapshot: &Snapshot, points: &[Pos2], at: Pos2) -> Option<f64> {
        snapshot.values.get(self.triangle_at(points, at)?).copied()
    }

    /// The nearest triangle at a point of the screen, if it is one of a membrane.
    pub fn triangle_at(&self, points: &[Pos2], at: Pos2) -> Option<usize> {
        let turn = |a: Pos2, b: Pos2| (b.x - a.x) * (at.y - a.y) - (b.y - a.y) * (at.x - a.x);
        let is_inside = |facet: &&Facet| {
            let [Some(a), Some(b), Some(c)] = facet.corners.map(|corner| points.get(corner as usize).copied()) else {
                return false;
            };
            let turns = [turn(a, b), turn(b, c), turn(c, a)];
            turns.iter().all(|&turn| turn >= 0.0) || turns.iter().all(|&turn| turn <= 0.0)
        };
        self.order
            .iter()
            .rev()
            .find(is_inside)
            .map(|facet| facet.triangle)
            .filter(|triangle| *triangle != NONE)
            .map(|triangle| triangle as usize)
    }

    /// Adds a triangle to the normals and to the order.
    fn add(
        &mut self,
        at: &dyn Fn(u32) -> Option<[f64; 3]>,
        camera: &SpaceCamera,
        corners: [u32; 3],
        (part, triangle): (u32, u32),
    ) {
        let [Some(a), Some(b), Some(c)] = corners.map(at) else { return };
        let (one, two) = ([0, 1, 2].map(|i| b[i] - a[i]), [0, 1, 2].map(|i| c[i] - a[i]));
        let normal =
            [one[1] * two[2] - one[2] * two[1], one[2] * two[0] - one[0] * two[2], one[0] * two[1] - one[1] * two[0]];
        let along = |axis: [f64; 3]| (0..3).map(|i| axis[i] * normal[i]).sum::<f64>() as f32;
        let [right, up, forwards] = camera.axes.map(along);
        for corner in corners {
            if let Some(sum) = self.normals.get_mut(corner as usize) {
                sum.iter_mut().zip([right, up, -forwards]).for_each(|(sum, part)| *sum += part);
            }
        }
        let depths = corners.iter().filter_map(|corner| self.depths.get(*corner as usize));
        // What lies on an obstacle is drawn after it, even where a triangle bends around it.
        let depth =
            if part == OBSTACLE { 3.0 * (depths.copied().fold(0.0, f64::max) + self.bend) } else { depths.sum() };
        self.order.push(Facet { depth: depth as f32, corners, part, triangle });
    }

    /// Draws the springs of nets without faces, and all edges if they are wanted.
    fn lines(buffer: &mut ShapeBuffer, view: View, snapshot: &Snapshot, options: &Options, points: &[Pos2]) {
        let reach = 1.0;
        let mut edges = Vec::new();
        for net in &snapshot.nets {
            let all = net
                .springs
                .links()
                .iter()
                .filter(|link| net.faces.is_empty() || link.role == crate::nets::Role::Structural);
            if net.faces.is_empty() || options.wireframe {
                edges.extend(all.map(|link| link.ends));
            }
        }
        if options.wireframe {
            for membrane in &snapshot.membranes {
                edges.extend(membrane.elements.corners().iter().flat_map(|[a, b, c]| [[*a, *b], [*b, *c], [*c, *a]]));
            }
        }
        if !edges.is_empty() {
            let color = if options.wireframe { view.theme.crust } else { view.theme.annotation };
            buffer.threads(points, &edges, reach, color.gamma_multiply(0.7));
        }
        for net in &snapshot.nets {
            super::net::particles_in_space(buffer, view, net, points);
        }
    }
}

/// Draws the three axes in a corner of the stage.
pub fn axes(painter: &Painter, view: View, canvas: Rect, camera: &SpaceCamera) {
    const LENGTH: f64 = 26.0;
    let from = canvas.left_bottom() + vec2(44.0, -44.0);
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        let [right, up, _] = camera.axes.map(|of| LENGTH * of[axis]);
        let to = from + vec2(right as f32, -up as f32);
        let color = view.theme.series[axis];
        painter.line_segment([from, to], (2.0, color));
        painter.text(to + 0.35 * (to - from), Align2::CENTER_CENTER, name, FontId::proportional(12.0), color);
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a failing test should panic")]
mod tests {
    use super::*;
    use crate::app::theme::Theme;

    #[test]
    fn the_camera_goes_there_and_back() {
        let canvas = Rect::from_min_max(pos2(240.0, 50.0), pos2(960.0, 770.0));
        let points = [0.0, 0.0, 0.0, 1.0, 2.0, 0.5, -1.0, 0.3, 0.7];
        for angles in [[0.0, 0.0], Orbit::ASLANT, [2.0, -1.0]] {
            let camera = SpaceCamera::new(Orbit::around(&points, angles), canvas);
            for point in points.as_chunks::<3>().0 {
                let (at, depth) = camera.seen(*point);
                assert!(canvas.contains(at) && depth > 0.0, "all is seen: {at:?}");
                let back = camera.at_depth(at, depth);
                assert!((0..3).all(|i| (back[i] - point[i]).abs() < 1e-5), "{point:?} {back:?}");
            }
        }
    }

    /// A cloth over a floor, seen from above, and from below, where the floor hides it.
    #[test]
    fn cloth_throws_a_shadow_on_a_floor_seen_from_above() {
        let level = crate::files::parse(crate::levels::built_in("tablecloth").unwrap(), "tablecloth.ron").unwrap();
        let sandbox = crate::sandbox::Sandbox::new(level, Box::new(crate::meshes::NoFiles)).unwrap();
        let mut snapshot = Snapshot::default();
        sandbox.snapshot(Field::None, &mut snapshot);
        let canvas = Rect::from_min_max(pos2(0.0, 0.0), pos2(400.0, 400.0));
        let view = View {
            camera: crate::app::draw::Camera::new(canvas, 1.0, 0.0),
            theme: Theme::for_mode(eframe::egui::Theme::Dark),
        };
        let floor = Triangulation {
            points: vec![[-9.0, -0.7, 9.0], [9.0, -0.7, 9.0], [0.0, -0.7, -9.0]],
            triangles: vec![[0, 1, 2]],
            endless_about: Some([0.0, -0.7, 0.0]),
        };
        for (pitch, is_seen) in [(0.4, true), (-0.4, false)] {
            let camera = SpaceCamera::new(Orbit { pitch, ..Orbit::opening(&snapshot.start) }, canvas);
            let (mut surfaces, mut points, mut buffer) = (Surfaces::default(), Vec::new(), ShapeBuffer::default());
            surfaces.place(&snapshot, &camera, &mut points);
            surfaces.follow(&Context::default(), view, &snapshot);
            let what = (&Options::default(), &Scale::default(), std::iter::once(&floor));
            surfaces.draw(&mut buffer, view, &snapshot, what, (&points, &camera));
            let faces = snapshot.membranes[0].elements.corners();
            assert_eq!(surfaces.shadows.len(), if is_seen { faces.len() } else { 0 });
            // A vertex and its shadow are on a line with the sun.
            if let ([corner, ..], Some([shadow, ..])) = (faces[0], surfaces.shadows.first()) {
                let from = snapshot.position(corner as usize).unwrap();
                let along = (from[1] + 0.7) / SUN[1];
                let wanted = camera.seen([0, 1, 2].map(|axis| from[axis] - along * SUN[axis])).0;
                assert!(surfaces.corners[*shadow as usize].distance(wanted) < 1e-3);
            }
        }
    }

    #[test]
    fn from_the_front_x_is_to_the_right_and_y_up() {
        let canvas = Rect::from_min_max(pos2(0.0, 0.0), pos2(400.0, 400.0));
        let camera = SpaceCamera::new(Orbit { centre: [0.0; 3], radius: 1.0, yaw: 0.0, pitch: 0.0 }, canvas);
        let middle = camera.seen([0.0; 3]);
        assert!(camera.seen([0.5, 0.0, 0.0]).0.x > middle.0.x && camera.seen([0.0, 0.5, 0.0]).0.y < middle.0.y);
        assert!(camera.seen([0.0, 0.0, 0.5]).1 < middle.1, "z is towards the eye");
    }
}
