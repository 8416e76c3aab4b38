//! How surfaces in space look: light and shade, sheen, and patterns as textures.

use super::super::theme::Theme;
use crate::{
    finish::{Colour, Finish, Pattern, Sheen},
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
    /// Its pattern, which takes the place of the colours.
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

/// The looks of all cloths of a scene.
#[derive(Default)]
pub struct Looks {
    all: Vec<Look>,
    textures: Vec<(Pattern, [Color32; 2], TextureHandle)>,
    /// Place in its pattern of each vertex of the scene, in periods.
    places: Vec<Pos2>,
    /// The generation of the scene and the sizes of patterns that the places are for.
    made_for: Option<(u64, Vec<f64>)>,
}

impl Looks {
    /// Follows the finishes of the level.
    pub fn follow(&mut self, context: &Context, theme: &Theme, snapshot: &Snapshot) {
        let level = &snapshot.level;
        let finishes = || {
            let nets = level.nets.iter().map(|net| net.finish);
            nets.chain(level.membranes.iter().map(|membrane| membrane.finish))
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
            let texture = (finish.pattern != Pattern::Plain).then(|| {
                let key = (finish.pattern, [front, of(finish.second, theme.icing)]);
                let known = self.textures.iter().position(|(pattern, colors, _)| (*pattern, *colors) == key);
                let place = known.unwrap_or_else(|| {
                    let texture = context.load_texture("pattern", image(key), TextureOptions::LINEAR_REPEAT);
                    self.textures.push((key.0, key.1, texture));
                    self.textures.len() - 1
                });
                used.push(place);
                self.textures[place].2.id()
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

    fn find_places(&mut self, snapshot: &Snapshot, finishes: impl Iterator<Item = Finish>) {
        let sizes: Vec<_> =
            finishes.map(|finish| if finish.pattern == Pattern::Plain { 0.0 } else { finish.size.get() }).collect();
        let made_for = (snapshot.generation, sizes);
        if self.made_for.as_ref() == Some(&made_for) {
            return;
        }
        let sizes = &made_for.1;
        self.places.clear();
        if sizes.iter().any(|size| *size > 0.0) {
            self.places.resize(snapshot.start.len() / snapshot.dimension, Pos2::ZERO);
            let place = |[x, y]: [f64; 2], size: f64| pos2((0.5 * x / size) as f32, (0.5 * y / size) as f32);
            for (net, size) in snapshot.nets.iter().zip(sizes).filter(|(_, size)| **size > 0.0) {
                let own = &snapshot.start.as_chunks::<3>().0[net.vertices.clone()];
                let [one, other] = widest(own);
                for (at, point) in self.places[net.vertices.clone()].iter_mut().zip(own) {
                    *at = place([point[one], point[other]], *size);
                }
            }
            let sizes = sizes.iter().skip(snapshot.nets.len());
            for (membrane, size) in snapshot.membranes.iter().zip(sizes).filter(|(_, size)| **size > 0.0) {
                for (at, point) in self.places[membrane.vertices.clone()].iter_mut().zip(membrane.mesh.points()) {
                    *at = place([point[0], point[1]], *size);
                }
            }
        }
        self.made_for = Some(made_for);
    }

    /// Look of a net or membrane, nets first.
    pub fn get(&self, number: usize) -> Option<&Look> {
        self.all.get(number)
    }

    /// Whether any has a pattern.
    pub fn has_patterns(&self) -> bool {
        self.all.iter().any(|look| look.texture.is_some())
    }

    /// Place of a vertex in its pattern, in periods.
    pub fn place(&self, vertex: u32) -> Pos2 {
        self.places.get(vertex as usize).copied().unwrap_or_default()
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
fn image((pattern, [first, second]): (Pattern, [Color32; 2])) -> ColorImage {
    const SIDE: usize = 64;
    let pixels = (0..SIDE * SIDE).map(|pixel| {
        let at = [pixel % SIDE, pixel / SIDE].map(|place| (place as f64 + 0.5) / SIDE as f64);
        let [share, brightness] = pattern.at(at);
        let color = first.lerp_to_gamma(second, share as f32);
        color.lerp_to_gamma(Color32::BLACK, 1.0 - brightness as f32)
    });
    ColorImage::new([SIDE, SIDE], pixels.collect())
}
