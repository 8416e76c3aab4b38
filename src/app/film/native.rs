//! Films are drawn by a thread.

use super::{FilmFormat, Shot, drawer::Drawer};
use crate::app::stage::Stage;
use std::{
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
        mpsc::{Receiver, SyncSender, TryRecvError, TrySendError, sync_channel},
    },
    thread,
};

/// Largest film \[pixels\].
pub(super) const LARGEST: [usize; 2] = [3840, 2160];

/// Shots on their way to the thread.
const ROOM: usize = 4;

/// The thread that draws a film.
pub(super) struct Worker {
    /// Where shots go while the recording goes on.
    shots: Option<SyncSender<Shot>>,
    drawn: Arc<AtomicU64>,
    film: Receiver<Result<Vec<u8>, String>>,
}

impl Worker {
    /// Starts it, with what makes the stage.
    pub fn start(
        format: FilmFormat,
        size: [usize; 2],
        stage: impl FnOnce() -> Stage + Send + 'static,
    ) -> Result<Self, String> {
        let (shots, taken) = sync_channel::<Shot>(ROOM);
        let (sender, film) = sync_channel(1);
        let drawn = Arc::new(AtomicU64::new(0));
        let count = Arc::clone(&drawn);
        let draw = move || {
            let mut drawer = Drawer::new(format, size, stage())?;
            for shot in &taken {
                drawer.draw(shot)?;
                count.fetch_add(1, Ordering::Relaxed);
            }
            drawer.finish()
        };
        // The recording may have been given up.
        let begun = thread::Builder::new().name("film".to_owned()).spawn(move || drop(sender.send(draw())));
        begun.map_err(|error| format!("A film needs a thread of its own, which cannot be had here: {error}."))?;
        Ok(Self { shots: Some(shots), drawn, film })
    }

    /// Takes a shot; gives it back if there is no room yet.
    pub fn take(&mut self, shot: Shot) -> Option<Shot> {
        // A thread that has ended tells why through the film.
        match self.shots.as_ref()?.try_send(shot) {
            Err(TrySendError::Full(shot)) => Some(shot),
            _ => None,
        }
    }

    /// Takes the last shot, if one has waited for room, and ends the film with it.
    pub fn end(&mut self, last: Option<Shot>) {
        if let (Some(shots), Some(last)) = (self.shots.take(), last) {
            // The last frame may wait for the others, but the window may not.
            thread::spawn(move || drop(shots.send(last)));
        }
    }

    /// Number of frames drawn.
    pub fn drawn(&self) -> u64 {
        self.drawn.load(Ordering::Relaxed)
    }

    /// The film, or why there is none, once it is finished.
    pub fn poll(&mut self) -> Option<Result<Vec<u8>, String>> {
        match self.film.try_recv() {
            Ok(film) => Some(film),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Err("the film could not be drawn".to_owned())),
        }
    }
}
