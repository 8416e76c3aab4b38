//! Draws and encodes the frames of a film.

use super::{FilmEncoder, FilmFormat, Recorder, Shot};
use crate::app::stage::Stage;

/// The stage and the encoder of a film.
pub(super) struct Drawer {
    stage: Stage,
    encoder: Box<dyn FilmEncoder>,
    is_first: bool,
}

impl Drawer {
    /// Starts a film of a size \[pixels\].
    pub fn new(format: FilmFormat, size: [usize; 2], stage: Stage) -> Result<Self, String> {
        Ok(Self { stage, encoder: format.encoder(size, Recorder::RATE)?, is_first: true })
    }

    /// Appends a frame.
    pub fn draw(&mut self, Shot { snapshot, options, viewpoint }: Shot) -> Result<(), String> {
        self.stage.set_options(options);
        self.stage.see_from(viewpoint);
        let picture = if std::mem::take(&mut self.is_first) {
            self.stage.first_picture(&snapshot)
        } else {
            self.stage.picture(&snapshot, 1.0 / f64::from(Recorder::RATE))
        };
        self.encoder.add(picture)
    }

    /// Whether more frames are to wait.
    #[cfg(target_arch = "wasm32")]
    pub fn is_busy(&self) -> bool {
        self.encoder.is_busy()
    }

    /// Whether all frames are coded. No more are drawn after the first call.
    #[cfg(target_arch = "wasm32")]
    pub fn is_coded(&mut self) -> Result<bool, String> {
        self.encoder.is_coded()
    }

    /// The bytes of the film.
    pub fn finish(self) -> Result<Vec<u8>, String> {
        self.encoder.finish()
    }
}
