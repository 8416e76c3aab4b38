//! Draws scenes in space: the camera that turns about a point, shaded surfaces sorted by their depth, and springs.

use super::{View, shape_buffer::ShapeBuffer};
use crate::{
    app::{canvas::Options, colour::Scale},
    obstacles::Triangulation,
    snapshot::{Field, Snapshot},
};
use eframe::egui::{Align2, Color32, FontId, Painter, Pos2, Rect, pos2, vec2};

/// Half of the angle of view \[rad\].
const HALF_VIEW: f64 = 0.3;

/// Part of the stage that the scene fills when all of it is seen.
const FILLED: f64 = 0.8;

/// Number of the pair of colours of obstacles.
const OBSTACLE: u8 = 2;

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
    /// Depth of each vertex \[m\].
    depths: Vec<f64>,
    /// Sum of the normals of the triangles at each vertex, seen from the eye: right, up, back.
    normals: Vec<[f32; 3]>,
    /// The triangles, the farthest first.
    order: Vec<Facet>,
}

/// A triangle to be drawn.
#[derive(Clone, Copy)]
struct Facet {
    /// Sum of the depths of its corners \[m\].
    depth: f32,
    corners: [u32; 3],
    /// Number of the colours of its two sides.
    pair: u8,
    /// Place of its value among those of the snapshot; `u32::MAX` if it has none.
    value: u32,
}

/// No value.
const PLAIN: u32 = u32::MAX;

impl Surfaces {
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
        self.order.clear();
        self.normals.clear();
        self.normals.resize(points.len(), [0.0; 3]);
        let at = |vertex: u32| snapshot.position(vertex as usize);
        let membranes = snapshot.membranes.iter().map(|membrane| membrane.elements.corners());
        let nets = snapshot.nets.iter().map(|net| net.faces.as_slice());
        let (is_coloured, mut value) = (options.field != Field::None && options.field == snapshot.field, 0);
        let membranes = membranes.map(|corners| (corners, is_coloured));
        for (number, (corners, has_values)) in membranes.chain(nets.map(|corners| (corners, false))).enumerate() {
            for corners in corners {
                self.add(&at, camera, *corners, ((number % 2) as u8, if has_values { value } else { PLAIN }));
                value += u32::from(has_values);
            }
        }
        // The corners of obstacles come after the vertices of the scene.
        let (mut all_points, mut first) = (points.to_vec(), points.len() as u32);
        let factor = (0.3 * diagonal(&snapshot.start)).max(1.0);
        for obstacle in obstacles {
            for point in (0..obstacle.points.len()).filter_map(|corner| obstacle.drawn(corner, factor)) {
                let (seen, depth) = camera.seen(point);
                all_points.push(seen);
                self.depths.push(depth);
            }
            self.normals.resize(all_points.len(), [0.0; 3]);
            let at = |corner: u32| obstacle.drawn((corner - first) as usize, factor);
            for corners in &obstacle.triangles {
                self.add(&at, camera, corners.map(|corner| first + corner), (OBSTACLE, PLAIN));
            }
            first = all_points.len() as u32;
        }
        self.order.sort_unstable_by(|a, b| b.depth.total_cmp(&a.depth));
        let [one, other] = view.theme.candy;
        let colors = [[one, view.theme.icing], [other, view.theme.icing], [view.theme.wall, view.theme.wall]];
        let first = buffer.len();
        // Each vertex twice: in the colour of the front and in that of the back, for each of the two pairs of colours.
        let pairs = self.order.iter().map(|facet| usize::from(facet.pair) + 1).max().unwrap_or(0);
        for (point, normal) in all_points.iter().zip(&self.normals) {
            for pair in colors.iter().take(pairs) {
                for (color, side) in pair.iter().zip([1.0, -1.0]) {
                    buffer.vertex(*point, shaded(*color, normal.map(|axis| side * axis)));
                }
            }
        }
        let stride = 2 * pairs as u32;
        for Facet { corners, pair, value, .. } in &self.order {
            let [a, b, c] = corners.map(|corner| all_points[corner as usize]);
            let is_back = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x) > 0.0;
            if let Some(value) = snapshot.values.get(*value as usize) {
                let (color, side) = (scale.at(scale.share(*value)), if is_back { -1.0 } else { 1.0 });
                let lit = |corner: u32| shaded(color, self.normals[corner as usize].map(|axis| side * axis));
                let [a, b, c] = corners.map(|corner| buffer.vertex(all_points[corner as usize], lit(corner)));
                buffer.triangle(a, b, c);
                continue;
            }
            let side = 2 * u32::from(*pair) + u32::from(is_back);
            let [a, b, c] = corners.map(|corner| first + stride * corner + side);
            buffer.triangle(a, b, c);
        }
        Self::lines(buffer, view, snapshot, options, points);
    }

    /// Value of the nearest triangle at a point of the screen.
    pub fn value_at(&self, snapshot: &Snapshot, points: &[Pos2], at: Pos2) -> Option<f64> {
        let turn = |a: Pos2, b: Pos2| (b.x - a.x) * (at.y - a.y) - (b.y - a.y) * (at.x - a.x);
        let is_inside = |facet: &&Facet| {
            let [Some(a), Some(b), Some(c)] = facet.corners.map(|corner| points.get(corner as usize).copied()) else {
                return false;
            };
            let turns = [turn(a, b), turn(b, c), turn(c, a)];
            turns.iter().all(|&turn| turn >= 0.0) || turns.iter().all(|&turn| turn <= 0.0)
        };
        snapshot.values.get(self.order.iter().rev().find(is_inside)?.value as usize).copied()
    }

    /// Adds a triangle to the normals and to the order.
    fn add(
        &mut self,
        at: &dyn Fn(u32) -> Option<[f64; 3]>,
        camera: &SpaceCamera,
        corners: [u32; 3],
        (pair, value): (u8, u32),
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
        // What lies on an obstacle is drawn after it.
        let depth = if pair == OBSTACLE { 3.0 * depths.copied().fold(0.0, f64::max) } else { depths.sum() };
        self.order.push(Facet { depth: depth as f32, corners, pair, value });
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

/// A colour lit from above left, by a normal of any length as the eye sees it: right, up, back.
fn shaded(color: Color32, [right, up, back]: [f32; 3]) -> Color32 {
    const LIGHT: [f32; 3] = [-0.4, 0.65, 0.65];
    let length = (right * right + up * up + back * back).sqrt();
    let along = if length > 0.0 { (right * LIGHT[0] + up * LIGHT[1] + back * LIGHT[2]) / length } else { 0.0 };
    color.lerp_to_gamma(Color32::BLACK, (0.5 - 0.5 * along).clamp(0.0, 0.75))
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
mod tests {
    use super::*;

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

    #[test]
    fn from_the_front_x_is_to_the_right_and_y_up() {
        let canvas = Rect::from_min_max(pos2(0.0, 0.0), pos2(400.0, 400.0));
        let camera = SpaceCamera::new(Orbit { centre: [0.0; 3], radius: 1.0, yaw: 0.0, pitch: 0.0 }, canvas);
        let middle = camera.seen([0.0; 3]);
        assert!(camera.seen([0.5, 0.0, 0.0]).0.x > middle.0.x && camera.seen([0.0, 0.5, 0.0]).0.y < middle.0.y);
        assert!(camera.seen([0.0, 0.0, 0.5]).1 < middle.1, "z is towards the eye");
    }
}
