//! Cisco's encoder of H.264.

use super::{CodedFrame, INTRA};
use crate::picture::Picture;
use openh264::{
    OpenH264API,
    encoder::{Encoder, EncoderConfig, FrameRate, FrameType, IntraFramePeriod, RateControlMode, VuiConfig},
    formats::{RgbaSliceU8, YUVBuffer},
};

/// Greatest sides of a frame \[pixels\], the longer one first.
pub(super) const MOST: [usize; 2] = [3840, 2160];

/// An encoder that is done with a frame before it takes the next one.
pub(super) struct Coder {
    encoder: Encoder,
    planes: YUVBuffer,
    size: [usize; 2],
    coded: Option<CodedFrame>,
}

impl Coder {
    pub fn new(size: [usize; 2], rate: u32) -> Result<Self, String> {
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
        Ok(Self { encoder, planes: YUVBuffer::new(size[0], size[1]), size, coded: None })
    }

    /// Whether more frames are to wait.
    #[expect(clippy::unused_self, reason = "that of a browser codes in the background")]
    pub const fn is_busy(&self) -> bool {
        false
    }

    /// Codes a frame.
    pub fn add(&mut self, number: u32, picture: &Picture) -> Result<(), String> {
        self.planes.read_rgb8(RgbaSliceU8::new(&picture.rgba, (self.size[0], self.size[1])));
        let stream = self.encoder.encode(&self.planes).map_err(|error| error.to_string())?;
        let is_key = matches!(stream.frame_type(), FrameType::IDR | FrameType::I);
        self.coded = Some(CodedFrame { number, bytes: stream.to_vec(), is_key });
        Ok(())
    }

    /// The next frame that is coded, if one is.
    #[expect(clippy::unnecessary_wraps, reason = "that of a browser tells its errors here")]
    pub fn next(&mut self) -> Result<Option<CodedFrame>, String> {
        Ok(self.coded.take())
    }

    /// Whether all frames are coded.
    #[expect(clippy::unused_self, reason = "that of a browser codes in the background")]
    pub const fn is_done(&mut self) -> bool {
        true
    }
}
