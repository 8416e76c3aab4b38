//! Draws bodies: filled triangles, rim, icing that moves with the body, and mesh lines.

use super::{
    View,
    shape_buffer::{Detail, Fill, ShapeBuffer},
};
use crate::{
    app::{canvas::Options, colour::Scale},
    meshes::{Embedded, IcingColor, Mesh},
    snapshot::{BodySnapshot, Field, Snapshot},
};
use eframe::egui::{Color32, Pos2, pos2, vec2};

/// Width of the baked rim \[m\].
const RIM: f32 = 0.016;

/// Width of the outline of a body whose full drawing would fill too much [points].
const OUTLINE: f32 = 1.5;

/// If one of this many triangles is inverted, the body has come apart.
const CRUMBLED: usize = 10;

/// Data that do not change while a body moves.
struct ConstantPart {
    /// Boundary loops, with the body on the left.
    loops: Vec<Vec<u32>>,
    /// Whether there is room for the line of icing beside each of their vertices at rest.
    room: Vec<Vec<bool>>,
    /// Edges, each once.
    edges: Vec<[u32; 2]>,
    /// Positions of sugar and spice.
    specks: Vec<Embedded>,
    /// Scale from the mesh to the world.
    scale: f32,
}

/// Drawing data of all bodies of a scene.
#[derive(Default)]
pub struct Bodies {
    generation: Option<u64>,
    constant: Vec<ConstantPart>,
    /// Vertices on the screen.
    points: Vec<Pos2>,
    line: Vec<Pos2>,
}

impl Bodies {
    /// The points, to be set for a scene in space.
    pub const fn points_mut(&mut self) -> &mut Vec<Pos2> {
        &mut self.points
    }

    /// Maps the vertices of a scene in the plane to the screen.
    pub fn place(&mut self, snapshot: &Snapshot, view: View) {
        if self.generation != Some(snapshot.generation) || self.constant.len() != snapshot.bodies.len() {
            self.generation = Some(snapshot.generation);
            let scale = |i: usize| snapshot.level.bodies.get(i).map_or(1.0, |body| body.place.scale.get() as f32);
            self.constant =
                snapshot.bodies.iter().enumerate().map(|(i, body)| ConstantPart::new(body, scale(i))).collect();
        }
        self.points.clear();
        let positions = snapshot.positions.chunks_exact(2);
        self.points.extend(positions.map(|point| view.camera.screen_from_world([point[0], point[1]])));
    }

    /// Vertices on the screen, from the last [`Self::place`].
    pub fn points(&self) -> &[Pos2] {
        &self.points
    }

    /// Value of the triangle under a point of the screen.
    pub fn value_at(&self, snapshot: &Snapshot, at: Pos2) -> Option<f64> {
        snapshot.values.get(self.triangle_at(snapshot, at)?).copied()
    }

    /// The triangle under a point of the screen; of several, the one drawn last.
    pub fn triangle_at(&self, snapshot: &Snapshot, at: Pos2) -> Option<usize> {
        let turn = |a: Pos2, b: Pos2| (b.x - a.x) * (at.y - a.y) - (b.y - a.y) * (at.x - a.x);
        let is_inside = |triangle: &[u32; 3]| {
            let [Some(a), Some(b), Some(c)] = triangle.map(|vertex| self.points.get(vertex as usize).copied()) else {
                return false;
            };
            let turns = [turn(a, b), turn(b, c), turn(c, a)];
            turns.iter().all(|&turn| turn >= 0.0) || turns.iter().all(|&turn| turn <= 0.0)
        };
        snapshot.triangles.iter().rposition(is_inside)
    }

    /// Draws all bodies in the order of the level, with less detail when the filled area is too large.
    pub fn draw(
        &mut self,
        (buffer, fill): (&mut ShapeBuffer, &mut Fill),
        view: View,
        snapshot: &Snapshot,
        options: &Options,
        scale: &Scale,
    ) {
        let field = options.field != Field::None && options.field == snapshot.field;
        for (body, constant_part) in snapshot.bodies.iter().zip(&self.constant) {
            let Some(points) = self.points.get(body.vertices.clone()) else { continue };
            let values = snapshot.values.get(body.triangles.clone()).filter(|_| field);
            match fill.choose(constant_part.areas(fill, (body, points), snapshot.inverted > 0, options.wireframe, view))
            {
                Detail::Full => {}
                Detail::Outline => {
                    constant_part.outline(buffer, view, points, &mut self.line);
                    continue;
                }
                Detail::Points => {
                    dots(buffer, points, view.theme.dough);
                    continue;
                }
            }
            if let Some(values) = values {
                buffer.facets(points, body.mesh.triangles(), scale.colors(values));
            } else {
                buffer.sheet(points, body.mesh.triangles(), view.theme.dough);
                asleep(buffer, view, snapshot, body, points);
            }
            constant_part.rim(buffer, view, points, &mut self.line, values.is_none());
            if options.wireframe {
                constant_part.wireframe(buffer, view, points, values.is_some());
            }
            if values.is_none() {
                constant_part.specks(buffer, view, body, points);
            }
            let inverted = if snapshot.inverted > 0 { inside_out(buffer, view, body, points) } else { 0 };
            let opacity = if values.is_some() || options.wireframe { 0.55 } else { 1.0 };
            let style = IcingStyle { opacity, scale: constant_part.scale };
            if inverted * CRUMBLED > body.triangles.len() {
                // Icing would hide the rest of the body.
            } else if body.mesh.icing().is_empty() {
                let loops = (&constant_part.loops[..], &constant_part.room[..]);
                icing_edge(buffer, view, loops, points, &mut self.line, style);
            } else {
                icing_strokes(buffer, view, &body.mesh, points, &mut self.line, style);
            }
            if options.vertices {
                vertices(buffer, view, points);
            }
        }
    }
}

/// Darkens the triangles of a body that are not computed because their regions sleep.
fn asleep(buffer: &mut ShapeBuffer, view: View, snapshot: &Snapshot, body: &BodySnapshot, points: &[Pos2]) {
    let Some(still) = snapshot.still.get(body.vertices.clone()) else { return };
    let rests = |corners: &&[u32; 3]| corners.iter().all(|corner| still[*corner as usize]);
    let resting: Vec<_> = body.mesh.triangles().iter().filter(rests).copied().collect();
    buffer.sheet(points, &resting, view.theme.crust.gamma_multiply(0.35));
}

impl ConstantPart {
    fn new(body: &BodySnapshot, scale: f32) -> Self {
        let triangles = body.mesh.triangles();
        let mut edges: Vec<[u32; 2]> = triangles
            .iter()
            .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]].map(|[p, q]| [p.min(q), p.max(q)]))
            .collect();
        edges.sort_unstable();
        edges.dedup();
        let loops = body.mesh.boundary_loops();
        Self { room: room(&body.mesh, &loops), loops, edges, specks: specks(body), scale }
    }

    /// Upper bounds of the area that the body fills on the stage, in full and as an outline [square points].
    fn areas(
        &self,
        fill: &Fill,
        (body, points): (&BodySnapshot, &[Pos2]),
        inverted: bool,
        wireframe: bool,
        view: View,
    ) -> [f32; 2] {
        let turns = |vertices: &Vec<u32>| {
            let next = vertices.iter().cycle().skip(1);
            vertices.iter().zip(next).map(|(a, b)| [*a, *b]).collect::<Vec<_>>()
        };
        let boundary = fill.lines(points, self.loops.iter().flat_map(turns), 1.0);
        // The dough counts twice with inverted triangles. The icing is about as wide as the rim.
        let dough = fill.triangles(points, body.mesh.triangles()) * if inverted { 2.0 } else { 1.0 };
        let edges = if wireframe { fill.lines(points, self.edges.iter().copied(), 2.0) } else { 0.0 };
        [dough + 2.0 * self.rim_width(view) * boundary + edges, OUTLINE * boundary]
    }

    fn rim_width(&self, view: View) -> f32 {
        view.size(RIM * self.scale, 2.0, 40.0)
    }

    fn outline(&self, buffer: &mut ShapeBuffer, view: View, points: &[Pos2], line: &mut Vec<Pos2>) {
        for vertices in &self.loops {
            gather(line, points, vertices);
            buffer.line(line, true, OUTLINE, view.theme.dough);
        }
    }

    fn rim(&self, buffer: &mut ShapeBuffer, view: View, points: &[Pos2], line: &mut Vec<Pos2>, baked: bool) {
        let (width, pixel) = (self.rim_width(view), buffer.pixel());
        for vertices in &self.loops {
            gather(line, points, vertices);
            if baked {
                let distances = [-0.5 * pixel, 0.5 * pixel, 0.25 * width, 0.6 * width, width];
                buffer.bands(line, true, &distances, &[0.0, 1.0, 0.9, 0.4, 0.0], view.theme.crust);
            } else {
                buffer.line(line, true, 1.5, view.theme.crust);
            }
        }
    }

    fn wireframe(&self, buffer: &mut ShapeBuffer, view: View, points: &[Pos2], colored: bool) {
        let color = if colored { Color32::from_black_alpha(120) } else { view.theme.crust };
        buffer.threads(points, &self.edges, buffer.pixel(), color.gamma_multiply(0.9));
    }

    fn specks(&self, buffer: &mut ShapeBuffer, view: View, body: &BodySnapshot, points: &[Pos2]) {
        let size = view.size(0.0022, 0.7, 4.0);
        for (number, speck) in self.specks.iter().enumerate() {
            let color = if number % 3 == 0 { view.theme.icing.gamma_multiply(0.35) } else { view.theme.crust };
            buffer.dot(place(speck, body.mesh.triangles(), points), size, color.gamma_multiply(0.8));
        }
    }
}

/// Fixed pseudo-random points of a body.
fn specks(body: &BodySnapshot) -> Vec<Embedded> {
    let triangles = body.mesh.triangles().len();
    let count = ((body.mesh.area() * 500.0) as usize).clamp(12, 150);
    let speck = |i| {
        let place = |salt| f64::from(super::scatter(i, salt));
        let (mut a, mut b) = (place(5), place(6));
        if a + b > 1.0 {
            (a, b) = (1.0 - a, 1.0 - b);
        }
        let triangle = ((place(7) * triangles as f64) as usize).min(triangles - 1) as u32;
        Embedded { triangle, weights: [1.0 - a - b, a, b] }
    };
    (0..if triangles == 0 { 0 } else { count }).map(speck).collect()
}

/// Copies the points of a loop to `line`.
fn gather(line: &mut Vec<Pos2>, points: &[Pos2], vertices: &[u32]) {
    line.clear();
    line.extend(vertices.iter().filter_map(|&vertex| points.get(vertex as usize)));
}

/// Draws the inverted triangles, which have the opposite orientation on the screen, and returns their number.
fn inside_out(buffer: &mut ShapeBuffer, view: View, body: &BodySnapshot, points: &[Pos2]) -> usize {
    let mut count = 0;
    for triangle in body.mesh.triangles() {
        let [a, b, c] = triangle.map(|vertex| points[vertex as usize]);
        let (u, v) = (b - a, c - a);
        // The screen's y axis points down: a counter-clockwise triangle has a negative cross product.
        if u.x * v.y - u.y * v.x >= 0.0 {
            let [a, b, c] = [a, b, c].map(|corner| buffer.vertex(corner, view.theme.pull));
            buffer.triangle(a, b, c);
            count += 1;
        }
    }
    count
}

/// Draws small points for the vertices of a body or net that would fill too much.
pub(super) fn dots(buffer: &mut ShapeBuffer, points: &[Pos2], color: Color32) {
    for &point in points {
        buffer.dot(point, 1.2, color);
    }
}

fn vertices(buffer: &mut ShapeBuffer, view: View, points: &[Pos2]) {
    let size = view.size(0.0028, 1.7, 6.0);
    for &point in points {
        buffer.dot(point, size, view.theme.annotation);
    }
}

/// Point of a body on the screen, from its vertices on the screen.
fn place(point: &Embedded, triangles: &[[u32; 3]], points: &[Pos2]) -> Pos2 {
    let mut sum = vec2(0.0, 0.0);
    for (&vertex, &weight) in triangles[point.triangle as usize].iter().zip(&point.weights) {
        sum += points[vertex as usize].to_vec2() * weight as f32;
    }
    sum.to_pos2()
}

/// Style of a body's icing.
#[derive(Clone, Copy, Debug)]
struct IcingStyle {
    /// Opacity: 1 hides what is below, 0 hides the icing.
    pub opacity: f32,
    /// Scale from the mesh to the world.
    pub scale: f32,
}

/// Draws the icing strokes of the mesh, each with a small shadow below.
fn icing_strokes(
    buffer: &mut ShapeBuffer,
    view: View,
    mesh: &Mesh,
    points: &[Pos2],
    line: &mut Vec<Pos2>,
    style: IcingStyle,
) {
    let theme = view.theme;
    let lift = vec2(0.0, view.size(0.0025 * style.scale, 0.7, 6.0));
    let shade = theme.crust.gamma_multiply(0.7 * style.opacity);
    for stroke in mesh.icing() {
        let color = match stroke.color {
            IcingColor::White => theme.icing,
            IcingColor::Red => theme.candy[0],
            IcingColor::Green => theme.candy[1],
        };
        line.clear();
        line.extend(stroke.points.iter().map(|point| place(point, mesh.triangles(), points) + lift));
        let width = view.camera.length(stroke.width as f32 * style.scale).max(1.5);
        for (color, back) in [(shade, vec2(0.0, 0.0)), (color.gamma_multiply(style.opacity), -lift)] {
            for point in line.iter_mut() {
                *point += back;
            }
            if stroke.filled {
                buffer.area(line, color);
            } else {
                buffer.line(line, stroke.closed, width, color);
            }
        }
    }
}

/// Distance of the line of icing from the boundary \[m\].
const INSET: f32 = 0.016;

/// Whether the line of icing beside each vertex of the loops keeps its distance from the whole boundary at rest. In a sharp tip it does not.
fn room(mesh: &Mesh, loops: &[Vec<u32>]) -> Vec<Vec<bool>> {
    /// Longest boundary that is examined, which takes the square of it.
    const MOST: usize = 2000;
    /// Least distance, as a fraction of that of the line.
    const LEAST: f32 = 0.8;
    if loops.iter().map(Vec::len).sum::<usize>() > MOST {
        return loops.iter().map(|vertices| vec![true; vertices.len()]).collect();
    }
    let at = |vertex: u32| {
        let [x, y] = mesh.points()[vertex as usize];
        pos2(x as f32, y as f32)
    };
    let sides: Vec<[Pos2; 2]> = loops
        .iter()
        .flat_map(|vertices| vertices.iter().zip(vertices.iter().cycle().skip(1)).map(|(a, b)| [at(*a), at(*b)]))
        .collect();
    let distance = |point: Pos2, [a, b]: [Pos2; 2]| {
        let along = b - a;
        let share = ((point - a).dot(along) / along.length_sq().max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
        point.distance(a + share * along)
    };
    // A ray upwards crosses the boundary an odd number of times.
    let crosses = |point: Pos2, [a, b]: [Pos2; 2]| {
        (a.x <= point.x) != (b.x <= point.x) && a.y + (point.x - a.x) / (b.x - a.x) * (b.y - a.y) > point.y
    };
    let is_inside = |point: Pos2| sides.iter().filter(|side| crosses(point, **side)).count() % 2 == 1;
    let of_loop = |vertices: &Vec<u32>| {
        let count = vertices.len();
        let has_room = |place: usize| {
            let [before, here, after] = [count - 1, 0, 1].map(|by| at(vertices[(place + by) % count]));
            let (before, after) = ((here - before).normalized(), (after - here).normalized());
            let along = (before + after).normalized();
            // The body is on the left.
            let inside = vec2(-along.y, along.x) / along.dot(before).abs().max(0.45);
            let icing = here + INSET * inside;
            is_inside(icing) && sides.iter().all(|side| distance(icing, *side) >= LEAST * INSET)
        };
        (0..count).map(has_room).collect()
    };
    loops.iter().map(of_loop).collect()
}

/// Draws a plain line of icing along the boundary of a body without icing strokes, where there is room for it.
fn icing_edge(
    buffer: &mut ShapeBuffer,
    view: View,
    (loops, room): (&[Vec<u32>], &[Vec<bool>]),
    points: &[Pos2],
    line: &mut Vec<Pos2>,
    style: IcingStyle,
) {
    let (inset, half, pixel) =
        (view.size(INSET * style.scale, 3.0, 60.0), view.size(0.003 * style.scale, 0.9, 12.0), buffer.pixel());
    let distances = [-half - 0.5 * pixel, 0.5 * pixel - half, half - 0.5 * pixel, half + 0.5 * pixel];
    let distances = distances.map(|distance| inset + distance);
    let color = view.theme.icing.gamma_multiply(style.opacity);
    for (vertices, room) in loops.iter().zip(room) {
        let Some(gap) = room.iter().position(|has_room| !has_room) else {
            gather(line, points, vertices);
            buffer.bands(line, true, &distances, &[0.0, 1.0, 1.0, 0.0], color);
            continue;
        };
        // From a gap on, each run of vertices with room is a line.
        let places: Vec<usize> = (0..vertices.len()).map(|by| (gap + by) % vertices.len()).collect();
        for run in places.split(|place| !room[*place]).filter(|run| run.len() > 1) {
            line.clear();
            line.extend(run.iter().filter_map(|place| points.get(vertices[*place] as usize)));
            buffer.bands(line, false, &distances, &[0.0, 1.0, 1.0, 0.0], color);
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a failing test should panic")]
mod tests {
    use super::*;
    use crate::meshes::{MeshKind, NoFiles};

    #[test]
    fn icing_goes_around_a_disk_and_leaves_sharp_tips_out() {
        let options = ron::Options::default();
        let options = options.with_default_extension(ron::extensions::Extensions::UNWRAP_VARIANT_NEWTYPES);
        let built = |text: &str| options.from_str::<MeshKind>(text).unwrap().kind().build(&NoFiles).unwrap();
        let disk = built("Disk(radius: 0.2, rings: 8)");
        assert!(room(&disk, &disk.boundary_loops()).concat().iter().all(|has_room| *has_room));
        let wedge = built("Outline(points: [(0, 0), (1, 0), (1, 0.2)], resolution: 300)");
        let loops = wedge.boundary_loops();
        let with_room = room(&wedge, &loops);
        for (vertex, has_room) in loops.concat().into_iter().zip(with_room.concat()) {
            let [x, y] = wedge.points()[vertex as usize];
            // The wedge is 0.2 x wide.
            assert!(!has_room || x > 0.1, "icing at {x} {y}");
            assert!(has_room || x < 0.2, "no icing at {x} {y}");
        }
    }
}
