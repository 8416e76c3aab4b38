//! Drawing of the stage: one file for each kind of thing on it, and the camera, which maps between world and screen.

pub mod arrows;
pub mod body;
mod cloth;
pub mod ghost;
pub mod house;
pub mod legends;
pub mod marks;
pub mod net;
pub mod shape_buffer;
pub mod space;

use super::theme::Theme;
use eframe::egui::{Align2, Color32, CornerRadius, FontId, Painter, Pos2, Rect, pos2, vec2};

/// Camera and theme of a drawing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Camera of the stage.
    pub camera: Camera,
    /// Colours of the theme.
    pub theme: &'static Theme,
}

impl View {
    /// Length on the screen of a length of the world \[m\], limited to stay readable [points].
    fn size(&self, metres: f32, least: f32, most: f32) -> f32 {
        self.camera.length(metres).clamp(least, most)
    }
}

/// Draws text on a card, which keeps it readable on any background, inside `within`. Returns the card.
fn card(painter: &Painter, view: View, within: Rect, at: (Pos2, Align2), text: (&str, FontId, Color32)) -> Rect {
    let (text, font, color) = text;
    let galley = painter.layout_no_wrap(text.to_owned(), font, color);
    let padding = vec2(7.0, 3.0);
    let mut rect = at.1.anchor_size(at.0, galley.size() + 2.0 * padding);
    let inside = within.shrink(4.0);
    rect = rect.translate(vec2((inside.left() - rect.left()).max(0.0), (inside.top() - rect.top()).max(0.0)));
    rect = rect.translate(vec2((inside.right() - rect.right()).min(0.0), (inside.bottom() - rect.bottom()).min(0.0)));
    painter.rect_filled(rect, CornerRadius::same(6), view.theme.card);
    painter.galley(rect.min + padding, galley, color);
    rect
}

/// Pseudo-random number from 0 to 1, fixed by its two seeds.
fn scatter(seed: usize, salt: u32) -> f32 {
    let mut hash = (seed as u32).wrapping_mul(0x9E37_79B9) ^ salt.wrapping_mul(0x85EB_CA6B);
    hash = (hash ^ (hash >> 15)).wrapping_mul(0x2C1B_3C6D);
    hash = (hash ^ (hash >> 12)).wrapping_mul(0x297A_2D39);
    (hash ^ (hash >> 15)) as f32 / u32::MAX as f32
}

/// Margins beside, above and below the world square, relative to its side: room for the eaves, the roof and the ground.
const MARGINS: [f32; 3] = [0.085, 0.105, 0.065];

/// Largest screen coordinate [points]. Larger ones are limited to it, so that an exploding body does not break the drawing.
const FARTHEST: f64 = 1e5;

/// Maps the world, y up \[m\], to the screen, y down [points].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// World origin on the screen. In single precision it would shake under a close view.
    origin: [f64; 2],
    /// Scale [points/m].
    scale: f64,
    /// Width of the world \[m\].
    width: f32,
}

/// The part of a scene in the plane that is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Zoom {
    /// Point of the world in the middle of the stage \[m\].
    pub centre: [f64; 2],
    /// Scale, as a multiple of that at which the whole world fits the stage.
    pub factor: f64,
}

impl Camera {
    /// Creates a camera that shows the world as large as possible in the middle of a canvas. The world is `width` \[m\] wide about
    /// x = 1/2 and 1 m high. The lowest `below` points of the canvas stay free.
    pub fn new(canvas: Rect, width: f32, below: f32) -> Self {
        let [beside, above, under] = MARGINS;
        let height = canvas.height() - below;
        let scale = (canvas.width() / (width + 2.0 * beside)).min(height / (1.0 + above + under)).max(1.0);
        let spare = 0.5 * (height - scale * (1.0 + above + under));
        let origin = [canvas.center().x - 0.5 * scale, canvas.top() + spare + scale * (1.0 + above)];
        Self { origin: origin.map(f64::from), scale: f64::from(scale), width }
    }

    /// Creates a camera with a scale [points/m], for the sizes of marks in a scene in space.
    pub fn of_scale(canvas: Rect, scale: f32) -> Self {
        Self { origin: [canvas.min.x, canvas.min.y].map(f64::from), scale: f64::from(scale), width: 1.0 }
    }

    /// This camera of the whole world, closer or moved.
    #[must_use]
    pub fn zoomed(self, canvas: Rect, Zoom { centre: [x, y], factor }: Zoom) -> Self {
        let (middle, scale) = (canvas.center(), self.scale * factor);
        Self { origin: [f64::from(middle.x) - scale * x, f64::from(middle.y) + scale * y], scale, ..self }
    }

    /// Scale [points/m].
    pub const fn scale(&self) -> f64 {
        self.scale
    }

    /// Maps a point of the world \[m\] to the screen.
    pub fn screen_from_world(&self, [x, y]: [f64; 2]) -> Pos2 {
        let [x, y] = [self.origin[0] + self.scale * x, self.origin[1] - self.scale * y];
        let place = |at: f64| at.clamp(-FARTHEST, FARTHEST) as f32;
        pos2(place(x), place(y))
    }

    /// Maps a point of the screen to the world \[m\].
    pub fn world_from_screen(&self, point: Pos2) -> [f64; 2] {
        [(f64::from(point.x) - self.origin[0]) / self.scale, (self.origin[1] - f64::from(point.y)) / self.scale]
    }

    /// Maps a length of the world \[m\] to the screen.
    pub fn length(&self, metres: f32) -> f32 {
        self.scale as f32 * metres
    }

    /// The world on the screen: a square, unless it is wider than 1 m.
    pub fn world(&self) -> Rect {
        let beside = 0.5 * (f64::from(self.width) - 1.0);
        Rect::from_two_pos(self.screen_from_world([-beside, 0.0]), self.screen_from_world([1.0 + beside, 1.0]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::{Rect, pos2};

    #[test]
    fn goes_there_and_back() {
        let canvas = Rect::from_min_max(pos2(240.0, 50.0), pos2(960.0, 770.0));
        for width in [1.0, 2.0] {
            let camera = Camera::new(canvas, width, 40.0);
            assert!(canvas.contains_rect(camera.world()));
            assert!((camera.world().width() - width * camera.world().height()).abs() < 1e-3);
            for point in [[0.0, 0.0], [1.0, 1.0], [0.3, -0.7]] {
                let back = camera.world_from_screen(camera.screen_from_world(point));
                assert!((back[0] - point[0]).abs() < 1e-6 && (back[1] - point[1]).abs() < 1e-6, "{point:?} {back:?}");
            }
            assert!(camera.screen_from_world([0.0, 1.0]).y < camera.screen_from_world([0.0, 0.0]).y);
        }
    }

    #[test]
    fn a_zoom_puts_its_centre_in_the_middle() {
        let canvas = Rect::from_min_max(pos2(240.0, 50.0), pos2(960.0, 770.0));
        let home = Camera::new(canvas, 1.0, 0.0);
        for factor in [0.5, 1.0, 1e6] {
            let camera = home.zoomed(canvas, Zoom { centre: [0.3, 0.7], factor });
            assert_eq!(camera.screen_from_world([0.3, 0.7]), canvas.center());
            let beside = camera.screen_from_world([0.3 + 50.0 / camera.scale(), 0.7]);
            assert!((beside.x - canvas.center().x - 50.0).abs() < 1e-3, "{factor}: {beside:?}");
        }
    }
}
