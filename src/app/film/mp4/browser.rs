//! The browser's encoder of H.264 (WebCodecs), which codes in the background.

use super::{
    super::{LARGEST, Recorder},
    CodedFrame, INTRA,
};
use crate::picture::Picture;
use std::{
    cell::{Cell, RefCell},
    collections::VecDeque,
    rc::Rc,
};
use wasm_bindgen::{JsCast, JsValue, closure::Closure};
use wasm_bindgen_futures::{JsFuture, spawn_local};
use web_sys::{
    DomException, EncodedVideoChunk, EncodedVideoChunkType, VideoEncoder, VideoEncoderConfig,
    VideoEncoderEncodeOptions, VideoEncoderInit, VideoFrame, VideoFrameBufferInit, VideoPixelFormat,
};

/// Baseline profile, level 3.1.
const CODEC: &str = "avc1.42001f";

/// Greatest sides of a frame of this level \[pixels\], the longer one first.
pub(super) const MOST: [usize; 2] = [1280, 720];

/// Bits that a pixel of a frame may take.
const BITS: f64 = 0.6;

/// Output of the encoder so far.
#[derive(Default)]
struct Told {
    coded: VecDeque<CodedFrame>,
    error: Option<String>,
    is_done: bool,
}

/// An encoder that codes while the page goes on.
pub(super) struct Coder {
    encoder: VideoEncoder,
    size: [u32; 2],
    rate: u32,
    is_ending: bool,
    told: Rc<RefCell<Told>>,
    /// Callbacks of the encoder, which are kept as long as it is.
    _calls: (Closure<dyn FnMut(EncodedVideoChunk)>, Closure<dyn FnMut(DomException)>),
}

/// Whether the browser has an encoder of H.264. The first call asks, and its answer comes a moment later.
pub fn is_available() -> bool {
    thread_local! {
        static TOLD: Cell<Option<bool>> = const { Cell::new(None) };
    }
    TOLD.get().unwrap_or_else(|| {
        TOLD.set(Some(false));
        let has_class = js_sys::Reflect::has(&js_sys::global(), &JsValue::from_str("VideoEncoder")).unwrap_or(false);
        if has_class && let Ok(config) = config(LARGEST, Recorder::RATE) {
            let asked = JsFuture::from(VideoEncoder::is_config_supported(&config));
            spawn_local(async move {
                let supported = asked.await.ok().and_then(|answer| answer.get_supported());
                TOLD.set(Some(supported == Some(true)));
            });
        }
        false
    })
}

/// What the encoder is asked for: a size \[pixels\], and frames in a second.
fn config(size: [usize; 2], rate: u32) -> Result<VideoEncoderConfig, JsValue> {
    let [width, height] = size.map(|pixels| pixels as u32);
    let config = VideoEncoderConfig::new(CODEC, height, width);
    config.set_framerate(f64::from(rate));
    config.set_bitrate_f64((BITS * f64::from(width) * f64::from(height) * f64::from(rate)).round());
    let stream = js_sys::Object::new();
    js_sys::Reflect::set(&stream, &"format".into(), &"annexb".into())?;
    js_sys::Reflect::set(&config, &"avc".into(), &stream)?;
    Ok(config)
}

/// Message of an error of the browser.
fn words(error: &JsValue) -> String {
    error.dyn_ref::<js_sys::Error>().map_or_else(|| format!("{error:?}"), |error| String::from(error.message()))
}

impl Coder {
    pub fn new(size: [usize; 2], rate: u32) -> Result<Self, String> {
        let config = config(size, rate).map_err(|error| words(&error))?;
        let told = Rc::new(RefCell::new(Told::default()));
        let (of_frames, of_errors) = (Rc::clone(&told), Rc::clone(&told));
        let take = Closure::<dyn FnMut(EncodedVideoChunk)>::new(move |chunk: EncodedVideoChunk| {
            let number = (chunk.timestamp() * f64::from(rate) / 1e6).round() as u32;
            let mut bytes = vec![0; chunk.byte_length() as usize];
            let is_copied = chunk.copy_to_with_u8_slice(&mut bytes);
            let is_key = chunk.type_() == EncodedVideoChunkType::Key;
            let mut told = of_frames.borrow_mut();
            told.coded.push_back(CodedFrame { number, bytes, is_key });
            told.error = told.error.take().or_else(|| is_copied.err().map(|error| words(&error)));
        });
        let fail = Closure::<dyn FnMut(DomException)>::new(move |error: DomException| {
            of_errors.borrow_mut().error = Some(error.message());
        });
        let calls = VideoEncoderInit::new(fail.as_ref().unchecked_ref(), take.as_ref().unchecked_ref());
        let encoder = VideoEncoder::new(&calls).map_err(|error| words(&error))?;
        encoder.configure(&config).map_err(|error| words(&error))?;
        let size = size.map(|pixels| pixels as u32);
        Ok(Self { encoder, size, rate, is_ending: false, told, _calls: (take, fail) })
    }

    /// Whether so many frames wait to be coded that no more are to be added yet.
    pub fn is_busy(&self) -> bool {
        /// Frames that may wait, of a megabyte each.
        const MOST: u32 = 4;
        self.encoder.encode_queue_size() >= MOST
    }

    /// Hands a frame to the encoder.
    pub fn add(&mut self, number: u32, picture: &Picture) -> Result<(), String> {
        let time = (1e6 * f64::from(number) / f64::from(self.rate)).round();
        let init = VideoFrameBufferInit::new_with_f64(self.size[1], self.size[0], VideoPixelFormat::Rgba, time);
        let options = VideoEncoderEncodeOptions::new();
        options.set_key_frame(number.is_multiple_of(INTRA));
        let pixels = js_sys::Uint8Array::from(picture.rgba.as_slice());
        let coded = VideoFrame::new_with_u8_array_and_video_frame_buffer_init(&pixels, &init).and_then(|frame| {
            let coded = self.encoder.encode_with_options(&frame, &options);
            frame.close();
            coded
        });
        // Where the encoder has failed before, that is the cause.
        coded.map_err(|error| self.told.borrow_mut().error.take().unwrap_or_else(|| words(&error)))
    }

    /// The next frame that is coded, if one is.
    pub fn next(&mut self) -> Result<Option<CodedFrame>, String> {
        let mut told = self.told.borrow_mut();
        told.error.take().map_or_else(|| Ok(told.coded.pop_front()), Err)
    }

    /// Whether all frames are coded. No more are added after the first call.
    pub fn is_done(&mut self) -> bool {
        if !std::mem::replace(&mut self.is_ending, true) {
            let (flushed, told) = (JsFuture::from(self.encoder.flush()), Rc::clone(&self.told));
            spawn_local(async move {
                let flushed = flushed.await;
                let mut told = told.borrow_mut();
                told.is_done = true;
                if let Err(error) = flushed {
                    told.error.get_or_insert_with(|| words(&error));
                }
            });
        }
        self.told.borrow().is_done
    }
}

impl Drop for Coder {
    /// Ends the encoder, so that it makes no more calls. One that has failed has ended.
    fn drop(&mut self) {
        drop(self.encoder.close());
    }
}
