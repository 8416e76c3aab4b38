//! Films are drawn between the frames of the window: a page has one thread.

use super::{FilmFormat, Shot, drawer::Drawer};
use crate::app::stage::Stage;
use std::collections::VecDeque;

/// Largest film \[pixels\]: the window waits while a frame is drawn.
pub(super) const LARGEST: [usize; 2] = [640, 480];

/// A film that is drawn frame by frame.
pub(super) struct Worker {
    drawer: Option<Drawer>,
    shots: VecDeque<Shot>,
    drawn: u64,
    has_ended: bool,
}

impl Worker {
    /// Starts it, with what makes the stage.
    pub fn start(format: FilmFormat, size: [usize; 2], stage: impl FnOnce() -> Stage) -> Result<Self, String> {
        let drawer = Some(Drawer::new(format, size, stage())?);
        Ok(Self { drawer, shots: VecDeque::new(), drawn: 0, has_ended: false })
    }

    /// Takes a shot; gives it back while another one is not drawn.
    pub fn take(&mut self, shot: Shot) -> Option<Shot> {
        if !self.shots.is_empty() {
            return Some(shot);
        }
        self.shots.push_back(shot);
        None
    }

    /// Takes the last shot, if one has waited, and ends the film with it.
    pub fn end(&mut self, last: Option<Shot>) {
        self.shots.extend(last);
        self.has_ended = true;
    }

    /// Number of frames drawn.
    pub const fn drawn(&self) -> u64 {
        self.drawn
    }

    /// Draws a frame. The film, or why there is none, once it is finished.
    pub fn poll(&mut self) -> Option<Result<Vec<u8>, String>> {
        if self.drawer.as_ref()?.is_busy() {
            return None;
        }
        let mut drawer = self.drawer.take()?;
        if let Some(shot) = self.shots.pop_front() {
            if let Err(why) = drawer.draw(shot) {
                return Some(Err(why));
            }
            self.drawn += 1;
        } else if self.has_ended {
            match drawer.is_coded() {
                Ok(true) => return Some(drawer.finish()),
                Ok(false) => {}
                Err(why) => return Some(Err(why)),
            }
        }
        self.drawer = Some(drawer);
        None
    }
}
