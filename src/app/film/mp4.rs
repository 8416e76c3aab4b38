//! Films as MP4, coded by Cisco's encoder of H.264.

use super::FilmEncoder;
use crate::picture::Picture;
use muxide::api::{Muxer, MuxerBuilder, VideoCodec};
use openh264::{
    OpenH264API,
    encoder::{Encoder, EncoderConfig, FrameRate, FrameType, IntraFramePeriod, RateControlMode, VuiConfig},
    formats::{RgbaSliceU8, YUVBuffer},
};

/// Greatest sides of a frame \[pixels\], the longer one first.
const MOST: [usize; 2] = [3840, 2160];

/// Frames after which one is coded without the ones before it, so that a player can jump there.
const INTRA: u32 = 50;

/// Encoder of an MP4 file.
pub struct Mp4 {
    encoder: Encoder,
    muxer: Muxer<Vec<u8>>,
    planes: YUVBuffer,
    size: [usize; 2],
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
        let [width, height] = size;
        let config = EncoderConfig::new()
            .max_frame_rate(FrameRate::from_hz(rate as f32))
            // All frames are as good as each other, however many bytes they take.
            .rate_control_mode(RateControlMode::Off)
            .skip_frames(false)
            // One thread: the same frames give the same bytes.
            .num_threads(1)
            .intra_frame_period(IntraFramePeriod::from_num_frames(INTRA))
            // The conversion from RGB is that of BT.601 with limited range.
            .vui(VuiConfig::bt601());
        let encoder =
            Encoder::with_api_config(OpenH264API::from_source(), config).map_err(|error| error.to_string())?;
        let [wide, high] = size.map(|pixels| pixels as u32);
        let muxer = MuxerBuilder::new(Vec::new())
            .video(VideoCodec::H264, wide, high, f64::from(rate))
            .with_fast_start(true)
            .build()
            .map_err(|error| error.to_string())?;
        Ok(Self { encoder, muxer, planes: YUVBuffer::new(width, height), size, rate, frames: 0 })
    }
}

impl FilmEncoder for Mp4 {
    fn add(&mut self, picture: Picture) -> Result<(), String> {
        let [width, height] = self.size;
        self.planes.read_rgb8(RgbaSliceU8::new(&picture.rgba, (width, height)));
        let coded = self.encoder.encode(&self.planes).map_err(|error| error.to_string())?;
        let is_key = matches!(coded.frame_type(), FrameType::IDR | FrameType::I);
        let time = f64::from(self.frames) / f64::from(self.rate);
        self.frames += 1;
        self.muxer.write_video(time, &coded.to_vec(), is_key).map_err(|error| error.to_string())
    }

    fn finish(mut self: Box<Self>) -> Result<Vec<u8>, String> {
        self.muxer.finish_in_place().map_err(|error| error.to_string())?;
        Ok(self.muxer.into_writer())
    }
}
