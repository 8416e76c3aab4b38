//! Films as GIF.

use super::FilmEncoder;
use crate::picture::Picture;

/// Greatest number of frames in a second that players keep to.
const MOST: u32 = 50;

/// Encoder of a GIF.
pub struct Gif {
    encoder: gif::Encoder<Vec<u8>>,
    size: [u16; 2],
    /// Frames in a second, and frames so far.
    rate: u32,
    frames: u32,
}

/// Checks the number of frames in a second.
pub fn check(rate: u32) -> Result<(), String> {
    if rate <= MOST { Ok(()) } else { Err(format!("a GIF has at most {MOST} frames a second, not {rate}")) }
}

impl Gif {
    pub fn new(size: [usize; 2], rate: u32) -> Result<Self, String> {
        let size = size.map(|pixels| pixels.min(usize::from(u16::MAX)) as u16);
        let mut encoder = gif::Encoder::new(Vec::new(), size[0], size[1], &[]).map_err(|error| error.to_string())?;
        encoder.set_repeat(gif::Repeat::Infinite).map_err(|error| error.to_string())?;
        Ok(Self { encoder, size, rate, frames: 0 })
    }
}

impl FilmEncoder for Gif {
    fn add(&mut self, mut picture: Picture) -> Result<(), String> {
        /// Between 1, the best choice of colours, and 30, the fastest.
        const SPEED: i32 = 10;
        // Frames last a whole number of hundredths of a second, and begin at the one that is nearest.
        let begins = |frame: u32| (200 * u64::from(frame) + u64::from(self.rate)) / (2 * u64::from(self.rate));
        let delay = (begins(self.frames + 1) - begins(self.frames)) as u16;
        self.frames += 1;
        let [width, height] = self.size;
        let frame = gif::Frame::from_rgba_speed(width, height, &mut picture.rgba, SPEED);
        self.encoder.write_frame(&gif::Frame { delay, ..frame }).map_err(|error| error.to_string())
    }

    fn finish(self: Box<Self>) -> Result<Vec<u8>, String> {
        self.encoder.into_inner().map_err(|error| error.to_string())
    }
}
