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

    /// The bytes of the film.
    pub fn finish(self) -> Result<Vec<u8>, String> {
        self.encoder.finish()
    }
}
