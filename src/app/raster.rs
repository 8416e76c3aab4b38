//! Fills triangles of egui on the processor: colours of corners, textures and transparency as on a graphics card.

use eframe::egui::{
    Color32, ImageData, Mesh, Pos2, Rect, TextureWrapMode,
    epaint::{ImageDelta, Vertex},
};

/// Texture of egui.
#[derive(Default)]
pub struct Texture {
    size: [usize; 2],
    pixels: Vec<Color32>,
    repeats: bool,
}

impl Texture {
    /// Changes it as a whole or in a part.
    pub fn change(&mut self, delta: &ImageDelta) {
        let ImageData::Color(image) = &delta.image;
        self.repeats = delta.options.wrap_mode == TextureWrapMode::Repeat;
        let Some([left, top]) = delta.pos else {
            (self.size, self.pixels) = (image.size, image.pixels.clone());
            return;
        };
        let [width, height] = image.size;
        for row in 0..height {
            let to = (top + row) * self.size[0] + left;
            self.pixels[to..to + width].copy_from_slice(&image.pixels[row * width..(row + 1) * width]);
        }
    }

    /// Premultiplied colour at a place from (0, 0) to (1, 1), by its four nearest pixels: red, green, blue, alpha from 0 to 1.
    fn at(&self, u: f32, v: f32) -> [f32; 4] {
        let [width, height] = self.size;
        let place = |share: f32, size: usize| {
            let at = share * size as f32 - 0.5;
            let low = at.floor();
            let wrapped = |at: f32| {
                let at = at as isize;
                let most = size.cast_signed();
                (if self.repeats { at.rem_euclid(most) } else { at.clamp(0, most - 1) }) as usize
            };
            (wrapped(low), wrapped(low + 1.0), at - low)
        };
        let ((left, right, along), (top, bottom, down)) = (place(u, width), place(v, height));
        let pixel = |x: usize, y: usize| channels(self.pixels[y * width + x]);
        let between = |a: [f32; 4], b: [f32; 4], share: f32| [0, 1, 2, 3].map(|i| a[i] + share * (b[i] - a[i]));
        let upper = between(pixel(left, top), pixel(right, top), along);
        between(upper, between(pixel(left, bottom), pixel(right, bottom), along), down)
    }
}

/// Red, green, blue and alpha from 0 to 1, premultiplied.
fn channels(color: Color32) -> [f32; 4] {
    color.to_array().map(|channel| f32::from(channel) / 255.0)
}

/// A raster of opaque pixels, black at first.
pub struct Raster {
    size: [usize; 2],
    pixels: Vec<[f32; 3]>,
}

impl Raster {
    /// A raster of a size \[pixels\].
    pub fn new(size: [usize; 2]) -> Self {
        Self { size, pixels: vec![[0.0; 3]; size[0] * size[1]] }
    }

    /// Fills the triangles of a mesh inside a rectangle, at so many pixels a point.
    pub fn fill(&mut self, mesh: &Mesh, texture: &Texture, clip: Rect, pixels_per_point: f32) {
        if texture.pixels.is_empty() {
            return;
        }
        let limit = |least: f32, most: f32, size: usize| {
            let whole = |at: f32| (at * pixels_per_point).round().clamp(0.0, size as f32) as usize;
            [whole(least), whole(most)]
        };
        let across = limit(clip.left(), clip.right(), self.size[0]);
        let down = limit(clip.top(), clip.bottom(), self.size[1]);
        // Without a texture all corners are at its white pixel.
        let white = |corners: [&Vertex; 3]| corners.iter().all(|corner| corner.uv == corners[0].uv);
        for corners in mesh.indices.as_chunks::<3>().0 {
            let corners = corners.map(|corner| &mesh.vertices[corner as usize]);
            let sample = |u: f32, v: f32| texture.at(u, v);
            if white(corners) {
                let same = texture.at(corners[0].uv.x, corners[0].uv.y);
                self.triangle(corners, pixels_per_point, [across, down], |_, _| same);
            } else {
                self.triangle(corners, pixels_per_point, [across, down], sample);
            }
        }
    }

    /// Fills the pixels whose middles are inside a triangle, or on its left or upper sides.
    fn triangle(
        &mut self,
        corners: [&Vertex; 3],
        scale: f32,
        [across, down]: [[usize; 2]; 2],
        sample: impl Fn(f32, f32) -> [f32; 4],
    ) {
        let [mut a, mut b, c] = corners;
        let at = |corner: &Vertex| Pos2::new(corner.pos.x * scale, corner.pos.y * scale);
        let twice = |a: Pos2, b: Pos2, x: f64, y: f64| {
            let (ax, ay) = (f64::from(a.x), f64::from(a.y));
            (f64::from(b.x) - ax) * (y - ay) - (f64::from(b.y) - ay) * (x - ax)
        };
        let area = |a: &Vertex, b: &Vertex| twice(at(a), at(b), f64::from(at(c).x), f64::from(at(c).y));
        if area(a, b) < 0.0 {
            std::mem::swap(&mut a, &mut b);
        }
        let (all, corners) = (area(a, b), [a, b, c]);
        if all <= 0.0 || !all.is_finite() {
            return;
        }
        let points = corners.map(at);
        let range = |of: fn(Pos2) -> f32, [least, most]: [usize; 2]| {
            let [low, high] = [f32::min, f32::max].map(|pick| points.iter().map(|point| of(*point)).reduce(pick));
            let whole = |at: Option<f32>| at.unwrap_or(0.0).clamp(0.0, 1e6) as usize;
            whole(low).max(least)..(whole(high) + 1).min(most)
        };
        let colors = corners.map(|corner| channels(corner.color));
        // A pixel on a common side belongs to one of the two triangles.
        let sides = [[1, 2], [2, 0], [0, 1]].map(|[from, to]: [usize; 2]| (points[from], points[to]));
        let owns = sides.map(|(from, to)| to.y < from.y || to.y == from.y && to.x > from.x);
        for y in range(|point| point.y, down) {
            for x in range(|point| point.x, across) {
                let (px, py) = (x as f64 + 0.5, y as f64 + 0.5);
                let inside = sides.map(|(from, to)| twice(from, to, px, py));
                if inside.iter().zip(owns).any(|(side, owns)| *side < 0.0 || *side == 0.0 && !owns) {
                    continue;
                }
                let weights = inside.map(|side| (side / all) as f32);
                let mix = |of: [f32; 3]| (0..3).map(|i| weights[i] * of[i]).sum::<f32>();
                let texture = sample(mix(corners.map(|corner| corner.uv.x)), mix(corners.map(|corner| corner.uv.y)));
                let color: [f32; 4] = std::array::from_fn(|i| texture[i] * mix(colors.map(|color| color[i])));
                let pixel = &mut self.pixels[y * self.size[0] + x];
                *pixel = [0, 1, 2].map(|i| color[i] + (1.0 - color[3]) * pixel[i]);
            }
        }
    }

    /// The raster with pixels that are means of squares of so many pixels a side: red, green, blue and 255.
    pub fn coarser(&self, factor: usize) -> Vec<u8> {
        let [width, height] = self.size.map(|pixels| pixels / factor);
        let mut bytes = Vec::with_capacity(4 * width * height);
        for (row, column) in (0..height).flat_map(|row| (0..width).map(move |column| (row, column))) {
            let all = (0..factor * factor)
                .map(|i| self.pixels[(factor * row + i / factor) * self.size[0] + factor * column + i % factor]);
            let sum = all.fold([0.0; 3], |sum, pixel| [0, 1, 2].map(|i| sum[i] + pixel[i]));
            bytes.extend(
                sum.map(|channel| (255.0 * channel / (factor * factor) as f32).round().clamp(0.0, 255.0) as u8),
            );
            bytes.push(255);
        }
        bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::{epaint::WHITE_UV, pos2};

    fn white() -> Texture {
        Texture { size: [1, 1], pixels: vec![Color32::WHITE], repeats: false }
    }

    fn square(color: impl Fn(usize) -> Color32) -> Mesh {
        let corners = [(1.0, 1.0), (5.0, 1.0), (5.0, 5.0), (1.0, 5.0)];
        let vertices = corners.into_iter().enumerate();
        let vertices = vertices.map(|(i, (x, y))| Vertex { pos: pos2(x, y), uv: WHITE_UV, color: color(i) }).collect();
        Mesh { indices: vec![0, 1, 2, 2, 3, 0], vertices, ..Mesh::default() }
    }

    /// A translucent square of two triangles covers each of its pixels once.
    #[test]
    fn no_pixel_is_filled_twice_or_left_out() {
        let half = Color32::from_rgba_premultiplied(100, 0, 0, 128);
        let mut raster = Raster::new([6, 6]);
        raster.fill(&square(|_| half), &white(), Rect::EVERYTHING, 1.0);
        let reds: Vec<u8> = raster.coarser(1).chunks(4).map(|pixel| pixel[0]).collect();
        for (place, red) in reds.into_iter().enumerate() {
            let is_inside = (1..5).contains(&(place % 6)) && (1..5).contains(&(place / 6));
            assert_eq!(red, if is_inside { 100 } else { 0 }, "pixel {place}");
        }
    }

    #[test]
    fn colours_of_corners_blend_and_clips_hold() {
        let mut raster = Raster::new([6, 6]);
        let color = |corner| if [0, 3].contains(&corner) { Color32::BLACK } else { Color32::WHITE };
        raster.fill(&square(color), &white(), Rect::from_min_max(pos2(0.0, 2.0), pos2(6.0, 3.0)), 1.0);
        let bytes = raster.coarser(1);
        let row = |row: usize| (0..6).map(|column| bytes[4 * (6 * row + column)]).collect::<Vec<_>>();
        assert_eq!((row(1), row(2), row(3)), (vec![0; 6], vec![0, 32, 96, 159, 223, 0], vec![0; 6]));
    }

    #[test]
    fn textures_repeat_and_change_in_parts() {
        use eframe::egui::{ColorImage, TextureOptions};
        let image = ColorImage::new([2, 1], vec![Color32::BLACK, Color32::WHITE]);
        let mut texture = Texture::default();
        texture.change(&ImageDelta::full(image, TextureOptions::LINEAR_REPEAT));
        for (u, red) in [(0.25, 0.0), (0.75, 1.0), (0.5, 0.5), (0.0, 0.5), (1.75, 1.0), (-0.75, 0.0)] {
            assert!((texture.at(u, 0.5)[0] - red).abs() < 1e-6, "at {u}");
        }
        let part = ColorImage::new([1, 1], vec![Color32::from_rgb(0, 255, 0)]);
        texture.change(&ImageDelta::partial([1, 0], part, TextureOptions::LINEAR));
        assert_eq!((texture.at(0.25, 0.5), texture.at(0.9, 0.5)), ([0.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 1.0]));
    }
}
