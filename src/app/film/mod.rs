//! Films: moving pictures of the stage, in one of several formats.

#[cfg(target_arch = "wasm32")]
mod browser;
mod drawer;
mod filming;
mod gif;
mod mp4;
#[cfg(not(target_arch = "wasm32"))]
mod native;
mod recorder;

#[cfg(target_arch = "wasm32")]
use browser::{LARGEST, Worker};
#[cfg(not(target_arch = "wasm32"))]
use native::{LARGEST, Worker};

pub use recorder::{Progress, Recorder, Shot};

use crate::picture::Picture;

/// Format of a film.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FilmFormat {
    /// H.264 in an MP4 file.
    Mp4,
    /// An animated GIF.
    Gif,
}

/// An encoder of a film.
pub trait FilmEncoder {
    /// Appends a frame.
    ///
    /// # Errors
    /// The encoder's own words.
    fn add(&mut self, picture: Picture) -> Result<(), String>;

    /// Whether more frames are to wait. An encoder may code in the background.
    fn is_busy(&self) -> bool {
        false
    }

    /// Whether all frames are coded, so that the film can be finished. No more are added after the first call.
    ///
    /// # Errors
    /// The encoder's own words.
    fn is_coded(&mut self) -> Result<bool, String> {
        Ok(true)
    }

    /// The bytes of the file.
    ///
    /// # Errors
    /// The encoder's own words.
    fn finish(self: Box<Self>) -> Result<Vec<u8>, String>;
}

impl FilmFormat {
    /// All formats.
    const ALL: &[Self] = &[Self::Mp4, Self::Gif];

    /// Greatest number of frames of a film, which is kept in memory until it is written.
    pub const MOST_FRAMES: u64 = 10_000;

    /// The formats that can be made here: a browser may have no encoder of MP4.
    pub fn offered() -> impl Iterator<Item = Self> {
        #[cfg(target_arch = "wasm32")]
        let has_mp4 = mp4::is_available();
        #[cfg(not(target_arch = "wasm32"))]
        let has_mp4 = true;
        Self::ALL.iter().copied().filter(move |format| has_mp4 || *format != Self::Mp4)
    }

    /// Ending of a file name, without the dot.
    pub const fn extension(self) -> &'static str {
        match self {
            Self::Mp4 => "mp4",
            Self::Gif => "gif",
        }
    }

    /// Its name, and what it is good for.
    pub const fn titles(self) -> [&'static str; 2] {
        match self {
            Self::Mp4 => ["MP4", "Small files with all colours, for players."],
            Self::Gif => ["GIF", "256 colours a frame, for slides and web pages."],
        }
    }

    /// The format with this ending of a file name, in any case.
    pub fn of_extension(extension: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|format| format.extension().eq_ignore_ascii_case(extension))
    }

    /// Checks the size \[pixels\] and the number of frames in a second.
    ///
    /// # Errors
    /// What the format allows instead.
    pub fn check(self, size: [usize; 2], rate: u32) -> Result<(), String> {
        match self {
            Self::Mp4 => mp4::check(size),
            Self::Gif => gif::check(rate),
        }?;
        if size.contains(&0) || rate == 0 { Err("a film needs pixels and frames".to_owned()) } else { Ok(()) }
    }

    /// Starts an encoder for frames of a size \[pixels\], so many in a second.
    ///
    /// # Errors
    /// What the format allows instead, or the encoder's own words.
    pub fn encoder(self, size: [usize; 2], rate: u32) -> Result<Box<dyn FilmEncoder>, String> {
        self.check(size, rate)?;
        Ok(match self {
            Self::Mp4 => Box::new(mp4::Mp4::new(size, rate)?),
            Self::Gif => Box::new(gif::Gif::new(size, rate)?),
        })
    }
}
