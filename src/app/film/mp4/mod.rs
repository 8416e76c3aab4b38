//! Films as MP4, coded as H.264.

#[cfg(target_arch = "wasm32")]
mod browser;
#[cfg(not(target_arch = "wasm32"))]
mod native;

#[cfg(target_arch = "wasm32")]
pub use browser::is_available;
#[cfg(target_arch = "wasm32")]
use browser::{Coder, MOST};
#[cfg(not(target_arch = "wasm32"))]
use native::{Coder, MOST};

use super::FilmEncoder;
use crate::picture::Picture;
use muxide::api::{Muxer, MuxerBuilder, VideoCodec};

/// Frames after which one is coded without the ones before it, so that a player can jump there.
const INTRA: u32 = 50;

/// A frame in the byte stream format of H.264 (Annex B of ITU-T H.264).
struct CodedFrame {
    /// Number of the frame, from 0.
    number: u32,
    bytes: Vec<u8>,
    /// Whether it is coded without the ones before it.
    is_key: bool,
}

/// Encoder of an MP4 file.
pub struct Mp4 {
    coder: Coder,
    muxer: Muxer<Vec<u8>>,
    rate: u32,
    frames: u32,
}

/// Checks the size \[pixels\].
pub fn check(size: [usize; 2]) -> Result<(), String> {
    let [width, height] = size;
    if !width.is_multiple_of(2) || !height.is_multiple_of(2) {
        return Err(format!("the sides of an MP4 film are even; {width} x {height} are not"));
    }
    let (longer, shorter) = (width.max(height), width.min(height));
    if longer > MOST[0] || shorter > MOST[1] {
        return Err(format!("an MP4 film has at most {} x {} pixels", MOST[0], MOST[1]));
    }
    Ok(())
}

impl Mp4 {
    pub fn new(size: [usize; 2], rate: u32) -> Result<Self, String> {
        let coder = Coder::new(size, rate)?;
        let [width, height] = size.map(|pixels| pixels as u32);
        let muxer = MuxerBuilder::new(Vec::new())
            .video(VideoCodec::H264, width, height, f64::from(rate))
            .with_fast_start(true)
            .build()
            .map_err(|error| error.to_string())?;
        Ok(Self { coder, muxer, rate, frames: 0 })
    }

    /// Writes the frames that are coded.
    fn write(&mut self) -> Result<(), String> {
        while let Some(CodedFrame { number, bytes, is_key }) = self.coder.next()? {
            let time = f64::from(number) / f64::from(self.rate);
            self.muxer.write_video(time, &bytes, is_key).map_err(|error| error.to_string())?;
        }
        Ok(())
    }
}

impl FilmEncoder for Mp4 {
    fn add(&mut self, picture: Picture) -> Result<(), String> {
        self.coder.add(self.frames, &picture)?;
        self.frames += 1;
        self.write()
    }

    fn is_busy(&self) -> bool {
        self.coder.is_busy()
    }

    fn is_coded(&mut self) -> Result<bool, String> {
        let is_coded = self.coder.is_done();
        self.write()?;
        Ok(is_coded)
    }

    fn finish(mut self: Box<Self>) -> Result<Vec<u8>, String> {
        self.muxer.finish_in_place().map_err(|error| error.to_string())?;
        Ok(self.muxer.into_writer())
    }
}
