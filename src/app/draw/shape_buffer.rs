//! Shape buffer: collects smooth shapes in one triangle mesh, which egui copies unchanged; and a limit of the filled area.

use eframe::egui::{Color32, Mesh, Pos2, Rect, Shape, TextureId, Vec2, epaint::Vertex, vec2};
use std::{f32::consts::TAU, sync::Arc};

/// A layer of the drawing. Later shapes cover earlier ones; edges fade out over one pixel.
pub struct ShapeBuffer {
    mesh: Mesh,
    shown: Arc<Mesh>,
    /// Meshes of earlier textures in this frame, and those of the last result.
    before: Vec<Arc<Mesh>>,
    shown_before: Vec<Arc<Mesh>>,
    pixel: f32,
    /// Directions across a line; the buffer is reused.
    across: Vec<Vec2>,
}

impl Default for ShapeBuffer {
    fn default() -> Self {
        let (before, shown_before, across) = (Vec::new(), Vec::new(), Vec::new());
        Self { mesh: Mesh::default(), shown: Arc::default(), before, shown_before, pixel: 1.0, across }
    }
}

impl ShapeBuffer {
    /// Removes all shapes and keeps the memory.
    pub fn clear(&mut self, pixels_per_point: f32) {
        self.mesh.indices.clear();
        self.mesh.vertices.clear();
        self.mesh.texture_id = TextureId::default();
        self.before.clear();
        self.pixel = 1.0 / pixels_per_point.max(0.1);
    }

    /// Returns the shapes drawn since `clear`. egui releases the mesh before the next frame, so two buffers suffice.
    pub fn finish(&mut self) -> Shape {
        match Arc::get_mut(&mut self.shown) {
            Some(shown) => std::mem::swap(shown, &mut self.mesh),
            None => self.shown = Arc::new(std::mem::take(&mut self.mesh)),
        }
        std::mem::swap(&mut self.before, &mut self.shown_before);
        self.again()
    }

    /// Draws the following triangles with a texture; without one in the colours of their corners. Corners from before must not be used
    /// again if it changes.
    pub fn texture(&mut self, texture: Option<TextureId>) {
        let texture_id = texture.unwrap_or_default();
        if texture_id != self.mesh.texture_id {
            let before = std::mem::replace(&mut self.mesh, Mesh::with_texture(texture_id));
            self.before.push(Arc::new(before));
        }
    }

    /// Adds a corner with a place in the texture.
    pub fn textured_vertex(&mut self, pos: Pos2, uv: Pos2, color: Color32) -> u32 {
        self.mesh.vertices.push(Vertex { pos, uv, color });
        self.mesh.vertices.len() as u32 - 1
    }

    /// Returns the last result of `finish` again.
    pub fn again(&self) -> Shape {
        let last = Shape::Mesh(Arc::clone(&self.shown));
        if self.shown_before.is_empty() {
            return last;
        }
        Shape::Vec(self.shown_before.iter().cloned().map(Shape::Mesh).chain([last]).collect())
    }

    /// Width of a pixel [points].
    pub fn pixel(&self) -> f32 {
        self.pixel
    }

    /// Number of corners so far.
    pub const fn len(&self) -> u32 {
        self.mesh.vertices.len() as u32
    }

    /// Adds a corner for [`Self::triangle`].
    pub fn vertex(&mut self, at: Pos2, color: Color32) -> u32 {
        self.mesh.colored_vertex(at, color);
        self.mesh.vertices.len() as u32 - 1
    }

    /// Adds a triangle and blends the colours of its corners.
    pub fn triangle(&mut self, a: u32, b: u32, c: u32) {
        self.mesh.add_triangle(a, b, c);
    }

    /// Adds triangles with shared corners in one colour.
    pub fn sheet(&mut self, points: &[Pos2], triangles: &[[u32; 3]], color: Color32) {
        let first = self.mesh.vertices.len() as u32;
        self.mesh.vertices.extend(points.iter().map(|&point| Vertex::untextured(point, color)));
        self.mesh.indices.reserve(3 * triangles.len());
        for triangle in triangles {
            self.mesh.indices.extend_from_slice(&triangle.map(|corner| first + corner));
        }
    }

    /// Adds triangles, each in its own colour.
    pub fn facets(&mut self, points: &[Pos2], triangles: &[[u32; 3]], colors: impl Iterator<Item = Color32>) {
        let first = self.mesh.vertices.len() as u32;
        self.mesh.vertices.reserve(3 * triangles.len());
        for (triangle, color) in triangles.iter().zip(colors) {
            let corner = |vertex: u32| Vertex::untextured(points[vertex as usize], color);
            self.mesh.vertices.extend_from_slice(&triangle.map(corner));
        }
        self.mesh.indices.extend(first..self.mesh.vertices.len() as u32);
    }

    /// Adds thin straight lines between points, which fade out to both sides over a `reach`. The lines share the vertices at the
    /// points, because fewer vertices matter for thousands of lines.
    pub fn threads(&mut self, points: &[Pos2], lines: &[[u32; 2]], reach: f32, color: Color32) {
        let Mesh { vertices, indices, .. } = &mut self.mesh;
        let first = vertices.len() as u32;
        vertices.reserve(points.len() + 4 * lines.len());
        indices.reserve(12 * lines.len());
        vertices.extend(points.iter().map(|&point| Vertex::untextured(point, color)));
        for &[from, to] in lines {
            let (a, b) = (points[from as usize], points[to as usize]);
            let along = b - a;
            let length = (along.x * along.x + along.y * along.y).sqrt();
            let across = if length > 0.0 { along.rot90() * (reach / length) } else { Vec2::ZERO };
            let (side, from, to) = (vertices.len() as u32, first + from, first + to);
            let sides = [a - across, b - across, a + across, b + across];
            vertices.extend_from_slice(&sides.map(|at| Vertex::untextured(at, Color32::TRANSPARENT)));
            let one = [side, from, side + 1, from, to, side + 1];
            let other = [from, side + 2, to, side + 2, side + 3, to];
            indices.extend_from_slice(&one);
            indices.extend_from_slice(&other);
        }
    }

    /// Adds a rectangle with a gradient from its top to its bottom.
    pub fn gradient(&mut self, rect: Rect, [top, bottom]: [Color32; 2]) {
        let a = self.vertex(rect.left_top(), top);
        let b = self.vertex(rect.right_top(), top);
        let c = self.vertex(rect.right_bottom(), bottom);
        let d = self.vertex(rect.left_bottom(), bottom);
        self.triangle(a, b, c);
        self.triangle(a, c, d);
    }

    /// Fills an outline.
    pub fn area(&mut self, outline: &[Pos2], color: Color32) {
        self.shaded(outline, |_| color);
    }

    /// Fills an outline, each corner in its own colour.
    pub fn shaded(&mut self, outline: &[Pos2], color: impl Fn(Pos2) -> Color32) {
        let first = self.mesh.vertices.len() as u32;
        for &point in outline {
            self.vertex(point, color(point));
        }
        cut_ears(outline, |[a, b, c]| self.mesh.add_triangle(first + a, first + b, first + c));
        if let Some(&point) = outline.first() {
            self.line(outline, true, self.pixel, color(point));
        }
    }

    /// Adds a disc.
    pub fn disc(&mut self, center: Pos2, radius: f32, color: Color32) {
        let pixel = self.pixel;
        let count = ((radius / pixel).sqrt() * 5.0).clamp(6.0, 64.0) as u32;
        let middle = self.vertex(center, color);
        for i in 0..count {
            let (sin, cos) = (TAU * i as f32 / count as f32).sin_cos();
            let out = vec2(cos, sin);
            let inner = self.vertex(center + out * (radius - 0.5 * pixel).max(0.0), color);
            let outer = self.vertex(center + out * (radius + 0.5 * pixel), Color32::TRANSPARENT);
            let next = middle + 1 + 2 * ((i + 1) % count);
            self.triangle(middle, inner, next);
            self.triangle(inner, outer, next + 1);
            self.triangle(inner, next + 1, next);
        }
    }

    /// Adds a small disc with a rough edge, for shapes that are drawn by the thousand.
    pub fn dot(&mut self, center: Pos2, radius: f32, color: Color32) {
        let first = self.mesh.vertices.len() as u32;
        for (x, y) in [(1.0, 0.0), (0.5, 0.87), (-0.5, 0.87), (-1.0, 0.0), (-0.5, -0.87), (0.5, -0.87)] {
            self.vertex(center + vec2(x, y) * radius, color);
        }
        for i in 1..5 {
            self.triangle(first, first + i, first + i + 1);
        }
    }

    /// Adds a disc that fades from its centre to its edge.
    pub fn halo(&mut self, center: Pos2, radius: f32, color: Color32) {
        let count = 32;
        let middle = self.vertex(center, color);
        for i in 0..count {
            self.vertex(center + Vec2::angled(TAU * i as f32 / count as f32) * radius, Color32::TRANSPARENT);
            self.triangle(middle, middle + 1 + i, middle + 1 + (i + 1) % count);
        }
    }

    /// Adds a line through points, with round ends if it is open.
    pub fn line(&mut self, points: &[Pos2], closed: bool, width: f32, color: Color32) {
        if points.len() < 2 || width <= 0.0 {
            return;
        }
        let (half, color) = if width < self.pixel {
            (0.5 * self.pixel, color.gamma_multiply(width / self.pixel))
        } else {
            (0.5 * width, color)
        };
        let fade = 0.5 * self.pixel;
        let sides = [(half + fade, 0.0), ((half - fade).max(0.0), 1.0)];
        let [(outer, _), (inner, _)] = sides;
        self.bands(points, closed, &[outer, inner, -inner, -outer], &[0.0, 1.0, 1.0, 0.0], color);
        if !closed && half > self.pixel {
            self.disc(points[0], half, color);
            self.disc(points[points.len() - 1], half, color);
        }
    }

    /// Adds bands along a line: for each distance to its left (on screen, going forward), the share of the colour.
    pub fn bands(&mut self, points: &[Pos2], closed: bool, distances: &[f32], shares: &[f32], color: Color32) {
        self.find_across(points, closed);
        let across = std::mem::take(&mut self.across);
        let first = self.mesh.vertices.len() as u32;
        for (&point, &across) in points.iter().zip(&across) {
            for (&distance, &share) in distances.iter().zip(shares) {
                self.vertex(point + across * distance, color.gamma_multiply(share));
            }
        }
        self.across = across;
        let (rows, columns) = (points.len() as u32, distances.len() as u32);
        for row in 0..if closed { rows } else { rows - 1 } {
            for column in 0..columns - 1 {
                let here = first + row * columns + column;
                let there = first + (row + 1) % rows * columns + column;
                self.mesh.add_triangle(here, here + 1, there);
                self.mesh.add_triangle(here + 1, there + 1, there);
            }
        }
    }

    /// Computes the direction across the line at each point, longer at corners so that the line keeps its width there.
    fn find_across(&mut self, points: &[Pos2], closed: bool) {
        let count = points.len();
        self.across.clear();
        for i in 0..count {
            let before =
                if i > 0 || closed { (points[i] - points[(i + count - 1) % count]).normalized() } else { Vec2::ZERO };
            let after =
                if i + 1 < count || closed { (points[(i + 1) % count] - points[i]).normalized() } else { Vec2::ZERO };
            let sum = (before + after).normalized();
            let along = if sum == Vec2::ZERO { before } else { sum };
            let cosine = if before == Vec2::ZERO || after == Vec2::ZERO { 1.0 } else { along.dot(before).abs() };
            self.across.push(along.rot90() / cosine.max(0.45));
        }
    }
}

/// Calls `triangle` with point numbers of triangles that fill an outline of either direction. An outline that crosses itself
/// is also filled, but not in a defined way.
fn cut_ears(outline: &[Pos2], mut triangle: impl FnMut([u32; 3])) {
    let mut left: Vec<u32> = (0..outline.len() as u32).collect();
    let at = |i: u32| outline[i as usize];
    let turned: f32 = (0..outline.len()).map(|i| cross(Pos2::ZERO, outline[i], outline[(i + 1) % outline.len()])).sum();
    let sign = if turned < 0.0 { -1.0 } else { 1.0 };
    let mut start = 0;
    while left.len() > 3 {
        let count = left.len();
        let corner = |i: usize| [left[(i + count - 1) % count], left[i % count], left[(i + 1) % count]];
        let is_ear = |i: usize| {
            let [a, b, c] = corner(i).map(at);
            sign * cross(a, b, c) >= 0.0
                && !left.iter().any(|&p| !corner(i).contains(&p) && is_inside(at(p), [a, b, c], sign))
        };
        let ear = (start..start + count).find(|&i| is_ear(i)).unwrap_or(start);
        triangle(corner(ear));
        left.remove(ear % count);
        // Continuing behind the ear avoids that all triangles share one corner.
        start = ear % count;
    }
    if let [a, b, c] = left[..] {
        triangle([a, b, c]);
    }
}

fn cross(a: Pos2, b: Pos2, c: Pos2) -> f32 {
    (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)
}

fn is_inside(point: Pos2, [a, b, c]: [Pos2; 3], sign: f32) -> bool {
    [(a, b), (b, c), (c, a)].into_iter().all(|(from, to)| sign * cross(from, to, point) > 0.0)
}

/// Maximum area that bodies and nets fill in a frame, relative to the area of the stage.
const MOST: f32 = 4.0;

/// Level of detail of a body or net.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Detail {
    /// Everything.
    Full,
    /// The outline alone.
    Outline,
    /// A point for each vertex.
    Points,
}

/// Remaining area that can be filled in a frame.
pub struct Fill {
    stage: Rect,
    left: f32,
}

impl Fill {
    /// The area for a whole frame.
    pub fn new(stage: Rect) -> Self {
        Self { stage, left: MOST * stage.area() }
    }

    /// Returns the first detail whose area fits into the remaining area, and subtracts it. Points always fit.
    pub fn choose(&mut self, areas: [f32; 2]) -> Detail {
        for (detail, area) in [Detail::Full, Detail::Outline].into_iter().zip(areas) {
            if area <= self.left {
                self.left -= area;
                return detail;
            }
        }
        Detail::Points
    }

    /// Upper bound of the area of triangles on the stage [square points].
    pub fn triangles(&self, points: &[Pos2], triangles: &[[u32; 3]]) -> f32 {
        let area = |corners: &[u32; 3]| {
            let [a, b, c] = corners.map(|corner| points[corner as usize]);
            let (u, v) = (b - a, c - a);
            let seen = Rect::from_points(&[a, b, c]).intersect(self.stage);
            if seen.is_negative() { 0.0 } else { (0.5 * (u.x * v.y - u.y * v.x)).abs().min(seen.area()) }
        };
        triangles.iter().map(area).sum()
    }

    /// Upper bound of the area of lines of a width on the stage [square points].
    pub fn lines(&self, points: &[Pos2], lines: impl IntoIterator<Item = [u32; 2]>, width: f32) -> f32 {
        let length = |ends: [u32; 2]| {
            let [a, b] = ends.map(|end| points[end as usize]);
            let seen = Rect::from_two_pos(a, b).intersect(self.stage);
            if seen.is_negative() { 0.0 } else { seen.size().length() }
        };
        width * lines.into_iter().map(length).sum::<f32>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::{pos2, vec2};

    #[test]
    fn fills_an_arrow_head() {
        let outline = [pos2(0.0, 0.0), pos2(2.0, 3.0), pos2(4.0, 0.0), pos2(2.0, 1.0)];
        let mut area = 0.0;
        cut_ears(&outline, |corners| {
            let [a, b, c] = corners.map(|i| outline[i as usize]);
            area += 0.5 * cross(a, b, c).abs();
        });
        assert!((area - 4.0).abs() < 1e-6, "{area}");
    }

    const STAGE: Rect = Rect::from_min_max(pos2(0.0, 0.0), pos2(100.0, 100.0));

    #[test]
    fn areas_are_clipped_to_the_stage() {
        let fill = Fill::new(STAGE);
        let points = [pos2(10.0, 10.0), pos2(30.0, 10.0), pos2(10.0, 40.0), pos2(1e5, -1e5), pos2(-1e5, 1e5)];
        assert_eq!(fill.triangles(&points, &[[0, 1, 2]]), 300.0);
        assert!(fill.triangles(&points, &[[0, 3, 4]]) <= STAGE.area());
        let aside = points.map(|point| point + vec2(200.0, 0.0));
        assert_eq!(fill.triangles(&aside, &[[0, 1, 2]]), 0.0);
        assert_eq!(fill.lines(&points, [[0, 1]], 2.0), 40.0);
        assert!(fill.lines(&points, [[3, 4]], 2.0) <= 2.0 * STAGE.size().length() + 1e-3);
    }

    #[test]
    fn a_spent_budget_leaves_outlines_and_then_points() {
        let mut fill = Fill::new(STAGE);
        assert_eq!(fill.choose([30_000.0, 100.0]), Detail::Full);
        assert_eq!(fill.choose([30_000.0, 100.0]), Detail::Outline);
        assert_eq!(fill.choose([30_000.0, 20_000.0]), Detail::Points);
    }
}
