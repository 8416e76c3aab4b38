//! How surfaces in space look: light and shade, sheen, and patterns and images as textures.

use super::super::theme::Theme;
use crate::{
    finish::{Colour, Finish, Image, Pattern, Sheen},
    picture::Picture,
    snapshot::Snapshot,
};
use eframe::egui::{Color32, ColorImage, Context, Pos2, TextureHandle, TextureId, TextureOptions, pos2};

/// Direction to the light as the eye sees it: right, up, back. Of length one.
const LIGHT: [f32; 3] = [-0.399, 0.648, 0.648];

/// How a cloth is drawn.
#[derive(Clone, Copy)]
pub struct Look {
    /// Colours of its front and its back.
    pub sides: [Color32; 2],
    /// Its pattern or image, which takes the place of the colours.
    pub texture: Option<TextureId>,
    sheen: Sheen,
}

impl Look {
    /// A matte surface in the same colour on both sides.
    pub const fn matte(color: Color32) -> Self {
        Self { sides: [color, color], texture: None, sheen: Sheen::Matte }
    }

    /// Colour of a side, 0 for the front and 1 for the back, that is lit by a normal of any length towards the eye: right, up, back.
    pub fn lit(&self, side: usize, normal: [f32; 3]) -> Color32 {
        let color = if self.texture.is_some() { Color32::WHITE } else { self.sides[side] };
        shaded(color, self.sheen, normal)
    }
}

/// A colour lit from above left, by a normal of any length as the eye sees it: right, up, back.
pub fn shaded(color: Color32, sheen: Sheen, normal: [f32; 3]) -> Color32 {
    let length = normal.iter().map(|part| part * part).sum::<f32>().sqrt();
    let normal = if length > 0.0 { normal.map(|part| part / length) } else { [0.0; 3] };
    let along: f32 = normal.iter().zip(LIGHT).map(|(part, light)| part * light).sum();
    let shade = (0.5 - 0.5 * along).clamp(0.0, 0.75);
    // The light that a mirror sends to the eye, which is far away in the direction back.
    let mirrored = (2.0 * along * normal[2] - LIGHT[2]).max(0.0);
    let (shade, highlight) = match sheen {
        Sheen::Matte => (shade, 0.0),
        Sheen::Satin => (shade, 0.3 * mirrored.powi(6)),
        Sheen::Gloss => (shade, 0.55 * mirrored.powi(24)),
        Sheen::Coat => (shade, 0.85 * mirrored.powi(90)),
        Sheen::Foil => {
            // What a mirror sees above is bright, and dark at the horizon.
            let up = 2.0 * normal[1] * normal[2];
            (0.75 - 0.7 * (up + 0.35).abs().min(1.0).powf(0.8), 0.9 * mirrored.powi(16))
        }
    };
    color.lerp_to_gamma(Color32::BLACK, shade.clamp(0.0, 0.8)).lerp_to_gamma(Color32::WHITE, highlight.clamp(0.0, 1.0))
}

/// Colour of a direction of space: x, y and z from -1 to 1 are no to full red, green and blue.
pub fn of_direction(direction: [f32; 3]) -> Color32 {
    let length = direction.iter().map(|part| part * part).sum::<f32>().sqrt().max(f32::MIN_POSITIVE);
    let [red, green, blue] = direction.map(|part| (127.5 * (1.0 + part / length)).round() as u8);
    Color32::from_rgb(red, green, blue)
}

/// What a texture shows.
#[derive(Clone)]
enum Print {
    Pattern(Pattern, [Color32; 2]),
    Image(Image),
}

impl Print {
    fn is(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Pattern(pattern, colors), Self::Pattern(other, others)) => (pattern, colors) == (other, others),
            (Self::Image(image), Self::Image(other)) => image.is(other),
            _ => false,
        }
    }

    /// Its pixels, and how it continues at its edges.
    fn texture(&self) -> (ColorImage, TextureOptions) {
        match self {
            Self::Pattern(pattern, colors) => (period(*pattern, *colors), TextureOptions::LINEAR_REPEAT),
            Self::Image(image) => {
                // The text was read as an image before.
                let picture = image.picture().unwrap_or(Picture { size: [1, 1], rgba: vec![255; 4] });
                (ColorImage::from_rgba_unmultiplied(picture.size, &picture.rgba), TextureOptions::LINEAR)
            }
        }
    }
}

/// How a texture lies on a cloth.
#[derive(Clone, Copy, PartialEq)]
enum Covering {
    None,
    /// Fields of a pattern of this size \[m\].
    Fields(f64),
    /// Once over the whole.
    Whole,
}

/// The looks of all cloths of a scene.
#[derive(Default)]
pub struct Looks {
    all: Vec<Look>,
    textures: Vec<(Print, TextureHandle)>,
    /// Place in its texture of each vertex of the scene.
    places: Vec<Pos2>,
    /// The generation of the scene and the coverings that the places are for.
    made_for: Option<(u64, Vec<Covering>)>,
}

impl Looks {
    /// Follows the finishes of the level.
    pub fn follow(&mut self, context: &Context, theme: &Theme, snapshot: &Snapshot) {
        let level = &snapshot.level;
        let finishes = || {
            let nets = level.nets.iter().map(|net| &net.finish);
            nets.chain(level.membranes.iter().map(|membrane| &membrane.finish))
        };
        self.all.clear();
        let mut used = Vec::new();
        for (number, finish) in finishes().enumerate() {
            let of = |colour: Option<Colour>, or: Color32| {
                colour.map_or(or, |Colour([red, green, blue])| Color32::from_rgb(red, green, blue))
            };
            // Cloths beside each other have different colours; membranes count first.
            let candy = theme.candy[if number < level.nets.len() {
                (number + level.membranes.len()) % 2
            } else {
                (number - level.nets.len()) % 2
            }];
            let front = of(finish.front, candy);
            let print = match &finish.image {
                Some(image) => Some(Print::Image(image.clone())),
                None if finish.pattern == Pattern::Plain => None,
                None => Some(Print::Pattern(finish.pattern, [front, of(finish.second, theme.icing)])),
            };
            let texture = print.map(|print| {
                let known = self.textures.iter().position(|(other, _)| other.is(&print));
                let place = known.unwrap_or_else(|| {
                    let (pixels, options) = print.texture();
                    self.textures.push((print, context.load_texture("cloth", pixels, options)));
                    self.textures.len() - 1
                });
                used.push(place);
                self.textures[place].1.id()
            });
            let back = of(finish.back, if finish.front.is_some() { front } else { theme.icing });
            self.all.push(Look { sides: [front, back], texture, sheen: finish.sheen });
        }
        // Textures of other colours, as while one is chosen, are dropped once they are many.
        if self.textures.len() > 16 + used.len() {
            let mut place = 0;
            self.textures.retain(|_| {
                place += 1;
                used.contains(&(place - 1))
            });
        }
        self.find_places(snapshot, finishes());
    }

    fn find_places<'a>(&mut self, snapshot: &Snapshot, finishes: impl Iterator<Item = &'a Finish>) {
        let covering = |finish: &Finish| match (&finish.image, finish.pattern) {
            (Some(_), _) => Covering::Whole,
            (None, Pattern::Plain) => Covering::None,
            (None, _) => Covering::Fields(finish.size.get()),
        };
        let made_for = (snapshot.generation, finishes.map(covering).collect::<Vec<_>>());
        if self.made_for.as_ref() == Some(&made_for) {
            return;
        }
        let coverings = &made_for.1;
        self.places.clear();
        if coverings.iter().any(|covering| *covering != Covering::None) {
            self.places.resize(snapshot.start.len() / snapshot.dimension, Pos2::ZERO);
            for (net, covering) in snapshot.nets.iter().zip(coverings) {
                let own = &snapshot.start.as_chunks::<3>().0[net.vertices.clone()];
                let [one, other] = widest(own);
                let flat: Vec<_> = own.iter().map(|point| [point[one], point[other]]).collect();
                covering.place(&flat, &mut self.places[net.vertices.clone()]);
            }
            for (membrane, covering) in snapshot.membranes.iter().zip(coverings.iter().skip(snapshot.nets.len())) {
                covering.place(membrane.mesh.points(), &mut self.places[membrane.vertices.clone()]);
            }
        }
        self.made_for = Some(made_for);
    }

    /// Look of a net or membrane, nets first.
    pub fn get(&self, number: usize) -> Option<&Look> {
        self.all.get(number)
    }

    /// Whether any has a pattern or an image.
    pub fn has_patterns(&self) -> bool {
        self.all.iter().any(|look| look.texture.is_some())
    }

    /// Place of a vertex in its texture.
    pub fn place(&self, vertex: u32) -> Pos2 {
        self.places.get(vertex as usize).copied().unwrap_or_default()
    }
}

impl Covering {
    /// Places in the texture of the points of a flat shape \[m\].
    fn place(self, points: &[[f64; 2]], places: &mut [Pos2]) {
        let range = |axis: usize| {
            let along = || points.iter().map(|point| point[axis]);
            [along().fold(f64::INFINITY, f64::min), along().fold(f64::NEG_INFINITY, f64::max)]
        };
        let [[left, right], [bottom, top]] = [range(0), range(1)];
        let share = |at: f64, from: f64, to: f64| if to == from { 0.0 } else { (at - from) / (to - from) };
        for (place, [x, y]) in places.iter_mut().zip(points) {
            let [u, v] = match self {
                Self::None => [0.0; 2],
                Self::Fields(size) => [0.5 * x / size, 0.5 * y / size],
                // Rows of an image begin at its top.
                Self::Whole => [share(*x, left, right), share(*y, top, bottom)],
            };
            *place = pos2(u as f32, v as f32);
        }
    }
}

/// The two axes along which some points extend most, in their order.
fn widest(points: &[[f64; 3]]) -> [usize; 2] {
    let extent = |axis: usize| {
        let all = || points.iter().map(|point| point[axis]);
        all().fold(f64::NEG_INFINITY, f64::max) - all().fold(f64::INFINITY, f64::min)
    };
    let thinnest = (0..3).min_by(|a, b| extent(*a).total_cmp(&extent(*b))).unwrap_or(2);
    [[1, 2], [0, 2], [0, 1]][thinnest]
}

/// One period of a pattern.
fn period(pattern: Pattern, [first, second]: [Color32; 2]) -> ColorImage {
    const SIDE: usize = 64;
    let pixels = (0..SIDE * SIDE).map(|pixel| {
        let at = [pixel % SIDE, pixel / SIDE].map(|place| (place as f64 + 0.5) / SIDE as f64);
        let [share, brightness] = pattern.at(at);
        let color = first.lerp_to_gamma(second, share as f32);
        color.lerp_to_gamma(Color32::BLACK, 1.0 - brightness as f32)
    });
    ColorImage::new([SIDE, SIDE], pixels.collect())
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a failing test should panic")]
mod tests {
    use super::*;

    /// The first row of the image is at the top edge of the cloth, its first column at the left one.
    #[test]
    fn an_image_covers_the_whole_cloth_the_right_way_up() {
        let points = [[1.0, 5.0], [3.0, 5.0], [3.0, 9.0], [2.0, 6.0]];
        let mut places = [Pos2::ZERO; 4];
        Covering::Whole.place(&points, &mut places);
        assert_eq!(places, [pos2(0.0, 1.0), pos2(1.0, 1.0), pos2(1.0, 0.0), pos2(0.5, 0.75)]);
        let picture = Picture { size: [1, 2], rgba: vec![255, 0, 0, 255, 0, 0, 255, 255] };
        let image = Image::of_file(&picture.png().unwrap()).unwrap();
        let (pixels, _) = Print::Image(image).texture();
        assert_eq!(pixels.pixels, [Color32::from_rgb(255, 0, 0), Color32::from_rgb(0, 0, 255)]);
    }
}
