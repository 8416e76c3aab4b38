//! Finish: how cloth looks, by its colours, its pattern or image, and its sheen. Nothing of it is physics.
//!
//! ```
//! use gingerbread::{files, finish::{Colour, Finish, Pattern}};
//!
//! let finish: Finish = files::parse_as(r##"(front: "#c0392b", pattern: Checks)"##, "finish")?;
//! assert_eq!((finish.front, finish.pattern), (Some(Colour([0xc0, 0x39, 0x2b])), Pattern::Checks));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod image;

pub use image::Image;

use crate::quantity::PatternSize;
use serde::{Deserialize, Serialize};
use std::fmt;

/// How the two sides of a cloth look.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Finish {
    /// Colour of the front; without it that of the theme.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub front: Option<Colour>,
    /// Colour of the back; without it that of the theme, or that of the front if there is a pattern.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub back: Option<Colour>,
    /// Pattern of both sides.
    pub pattern: Pattern,
    /// Second colour of the pattern; without it that of the theme.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub second: Option<Colour>,
    /// Size of a field of the pattern.
    pub size: PatternSize,
    /// Image on both sides in place of colours and pattern, stretched over the flat shape.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub image: Option<Image>,
    /// How it reflects light.
    pub sheen: Sheen,
}

impl Default for Finish {
    fn default() -> Self {
        let (pattern, size, sheen) = (Pattern::Plain, PatternSize::literal(0.1), Sheen::Matte);
        Self { front: None, back: None, pattern, second: None, size, image: None, sheen }
    }
}

/// Pattern of a cloth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Pattern {
    /// None.
    #[default]
    Plain,
    /// Squares of two colours in turn.
    Checks,
    /// Stripes of two colours in turn.
    Stripes,
    /// Threads of two colours, which pass over and under each other and stand out.
    Weave,
}

impl Pattern {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Plain, Self::Checks, Self::Stripes, Self::Weave];

    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Plain => "Plain",
            Self::Checks => "Checks",
            Self::Stripes => "Stripes",
            Self::Weave => "Weave",
        }
    }

    /// Its share of the second colour, and its brightness, at a point of a period of two fields each way, from 0 to 1.
    pub fn at(self, [u, v]: [f64; 2]) -> [f64; 2] {
        /// Brightness where a thread passes under another.
        const UNDER: f64 = 0.55;
        let second = |x: f64| x.rem_euclid(1.0) >= 0.5;
        match self {
            Self::Plain => [0.0, 1.0],
            Self::Checks => [f64::from(u8::from(second(u) != second(v))), 1.0],
            Self::Stripes => [f64::from(u8::from(second(u))), 1.0],
            Self::Weave => {
                let (along, across) = if second(u) == second(v) { (u, v) } else { (v, u) };
                // A thread is round across, and bends up where it passes over.
                let [height, crown] =
                    [across, along].map(|x| libm::sin(std::f64::consts::PI * (2.0 * x).rem_euclid(1.0)));
                let brightness = UNDER + (1.0 - UNDER) * height.sqrt() * (0.6 + 0.4 * crown);
                [f64::from(u8::from(second(u) != second(v))), brightness]
            }
        }
    }
}

/// How a cloth reflects light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Sheen {
    /// The same from all sides.
    #[default]
    Matte,
    /// A wide, weak highlight.
    Satin,
    /// A narrow highlight.
    Gloss,
    /// A narrow, bright highlight of a clear coat over a matte colour.
    Coat,
    /// Metal: bright where it mirrors the light of the sky, and dark beside that.
    Foil,
}

impl Sheen {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Matte, Self::Satin, Self::Gloss, Self::Coat, Self::Foil];

    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Matte => "Matte",
            Self::Satin => "Satin",
            Self::Gloss => "Gloss",
            Self::Coat => "Clear coat",
            Self::Foil => "Foil",
        }
    }
}

/// Colour in a level file: `#` and two hexadecimal digits each of red, green and blue.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Colour(pub [u8; 3]);

impl fmt::Display for Colour {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self([red, green, blue]) = self;
        write!(f, "#{red:02x}{green:02x}{blue:02x}")
    }
}

impl From<Colour> for String {
    fn from(colour: Colour) -> Self {
        colour.to_string()
    }
}

impl TryFrom<String> for Colour {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        let digits = text.strip_prefix('#').filter(|digits| digits.len() == 6 && digits.is_ascii());
        let number = digits.and_then(|digits| u32::from_str_radix(digits, 16).ok());
        let why = || format!("\"{text}\" is not a colour. Write # and six hexadecimal digits, such as \"#c0392b\".");
        // A sign is a digit for the parser.
        let [_, red, green, blue] = number.filter(|_| !text.contains('+')).ok_or_else(why)?.to_be_bytes();
        Ok(Self([red, green, blue]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_read_as_they_are_written() {
        for text in ["#000000", "#c0392b", "#ffffff"] {
            assert_eq!(Colour::try_from(text.to_owned()).map(String::from), Ok(text.to_owned()));
        }
        for text in ["", "c0392b", "#c0392", "#c0392bff", "#c0392g", "#+12345", "#äöü"] {
            let why = Colour::try_from(text.to_owned());
            assert!(why.as_ref().is_err_and(|why| why.contains("six hexadecimal digits")), "{text}: {why:?}");
        }
    }

    #[test]
    fn patterns_repeat_and_both_colours_take_half() {
        const STEPS: u32 = 40;
        for pattern in Pattern::ALL {
            let mut share = 0.0;
            for (i, j) in (0..STEPS).flat_map(|i| (0..STEPS).map(move |j| (i, j))) {
                let at = [i, j].map(|number| (f64::from(number) + 0.5) / f64::from(STEPS));
                let [second, brightness] = pattern.at(at);
                let next = pattern.at([at[0] + 1.0, at[1] - 2.0]);
                assert!((next[0] - second).abs() < 1e-9 && (next[1] - brightness).abs() < 1e-9, "{pattern:?} repeats");
                assert!((0.0..=1.0).contains(&brightness), "{pattern:?}: brightness {brightness}");
                share += second / f64::from(STEPS * STEPS);
            }
            let wanted = if pattern == Pattern::Plain { 0.0 } else { 0.5 };
            assert!((share - wanted).abs() < 1e-9, "{pattern:?}: {share}");
        }
    }
}
