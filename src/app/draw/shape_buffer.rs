//! Shape buffer: collects smooth shapes in one triangle mesh, which egui copies unchanged.

use super::ears;
use eframe::egui::{Color32, Mesh, Pos2, Rect, Shape, Vec2, epaint::Vertex, vec2};
use std::{f32::consts::TAU, sync::Arc};

/// A layer of the drawing. Later shapes cover earlier ones; edges fade out over one pixel.
pub struct ShapeBuffer {
    mesh: Mesh,
    shown: Arc<Mesh>,
    pixel: f32,
    /// Directions across a line; the buffer is reused.
    across: Vec<Vec2>,
}

impl Default for ShapeBuffer {
    fn default() -> Self {
        Self { mesh: Mesh::default(), shown: Arc::default(), pixel: 1.0, across: Vec::new() }
    }
}

impl ShapeBuffer {
    /// Removes all shapes and keeps the memory.
    pub fn clear(&mut self, pixels_per_point: f32) {
        self.mesh.indices.clear();
        self.mesh.vertices.clear();
        self.pixel = 1.0 / pixels_per_point.max(0.1);
    }

    /// Returns the shapes drawn since `clear`. egui releases the mesh before the next frame, so two buffers suffice.
    pub fn finish(&mut self) -> Shape {
        match Arc::get_mut(&mut self.shown) {
            Some(shown) => std::mem::swap(shown, &mut self.mesh),
            None => self.shown = Arc::new(std::mem::take(&mut self.mesh)),
        }
        self.again()
    }

    /// Returns the last result of `finish` again.
    pub fn again(&self) -> Shape {
        Shape::Mesh(Arc::clone(&self.shown))
    }

    /// Width of a pixel [points].
    pub fn pixel(&self) -> f32 {
        self.pixel
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
        ears::cut(outline, |[a, b, c]| self.mesh.add_triangle(first + a, first + b, first + c));
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
