//! Records the stage while simulated time runs. Frames are taken at equal intervals of simulated time, and drawn and encoded by another
//! thread; where it is slower, simulated time waits for it, and the window does not.

use super::FilmFormat;
use crate::{
    app::{
        canvas::{Options, Viewpoint},
        picture::Stage,
    },
    snapshot::Snapshot,
};
use std::{
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
        mpsc::{Receiver, SyncSender, TryRecvError, TrySendError, sync_channel},
    },
    thread,
};

/// What the stage shows at a moment.
pub struct Shot {
    /// The scene.
    pub snapshot: Snapshot,
    /// How it is drawn.
    pub options: Options,
    /// From where a scene in space is seen.
    pub viewpoint: Viewpoint,
}

/// How far a recording is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Format of the film.
    pub format: FilmFormat,
    /// Frames taken.
    pub taken: u64,
    /// Frames drawn and encoded.
    pub drawn: u64,
    /// Whether more frames are taken.
    pub records: bool,
}

/// A recording.
pub struct Recorder {
    format: FilmFormat,
    /// Where shots go while the recording goes on.
    shots: Option<SyncSender<Shot>>,
    /// A shot that waits for room on its way.
    waiting: Option<Shot>,
    taken: u64,
    drawn: Arc<AtomicU64>,
    film: Receiver<Result<Vec<u8>, String>>,
    /// Simulated time between two frames, and since the last \[s\].
    interval: f64,
    since: f64,
    /// Time at the start of the recording, for the name of the file \[s\].
    pub start: f64,
}

impl Recorder {
    /// Frames in a second of the film. In real time the longest step is half the time between them, and every step divides it.
    pub const RATE: u32 = 30;

    /// Shots on their way to the other thread.
    const ROOM: usize = 4;

    /// Round-off of the time of a step, as a fraction of it.
    const ROUND_OFF: f64 = 1e-6;

    /// Starts a recording with its first frame, of a size \[pixels\]. A second of the film shows `pace` seconds of simulated time; a step that
    /// is longer than a frame has one frame.
    ///
    /// # Errors
    /// If the format does not allow it.
    pub fn start(
        format: FilmFormat,
        size: [usize; 2],
        (is_dark, pace): (bool, f64),
        first: Shot,
    ) -> Result<Self, String> {
        format.check(size, Self::RATE)?;
        let (shots, taken) = sync_channel::<Shot>(Self::ROOM);
        let (sender, film) = sync_channel(1);
        let drawn = Arc::new(AtomicU64::new(0));
        let count = Arc::clone(&drawn);
        let (start, options) = (first.snapshot.time, first.options);
        let work = move || {
            let stage = Stage::new((size, 1), is_dark, options);
            // The recording may have been given up.
            let _ = sender.send(draw(format, size, stage, &taken, &count));
        };
        let begun = thread::Builder::new().name("film".to_owned()).spawn(work);
        begun.map_err(|error| format!("A film needs a thread of its own, which cannot be had here: {error}."))?;
        let (interval, shots) = (pace / f64::from(Self::RATE), Some(shots));
        let mut recorder = Self { format, shots, waiting: None, taken: 0, drawn, film, interval, since: 0.0, start };
        recorder.add(first);
        Ok(recorder)
    }

    /// How far it is.
    pub fn progress(&self) -> Progress {
        let drawn = self.drawn.load(Ordering::Relaxed);
        Progress { format: self.format, taken: self.taken, drawn, records: self.shots.is_some() }
    }

    /// Number of steps \[s\] until the next frame, which is zero while frames wait to be drawn.
    pub fn steps_to_frame(&mut self, step: f64) -> u64 {
        if self.shots.is_none() {
            return u64::MAX;
        }
        self.pass_on();
        if self.waiting.is_some() {
            return 0;
        }
        let left = self.interval - self.since;
        (left / step - Self::ROUND_OFF).ceil().max(1.0) as u64
    }

    /// Lets simulated time pass \[s\], in steps of a length \[s\]. Returns whether a frame is due.
    pub fn pass(&mut self, time: f64, step: f64) -> bool {
        self.since += time;
        let is_due = self.shots.is_some() && self.since >= self.interval - Self::ROUND_OFF * step;
        if is_due {
            self.since = (self.since - self.interval) % self.interval;
        }
        is_due
    }

    /// Adds the frame that is due. A film of [`FilmFormat::MOST_FRAMES`] ends.
    pub fn add(&mut self, shot: Shot) {
        self.taken += 1;
        self.waiting = Some(shot);
        self.pass_on();
        if self.taken >= FilmFormat::MOST_FRAMES {
            self.stop();
        }
    }

    /// Ends the recording. What was taken is still drawn.
    pub fn stop(&mut self) {
        self.pass_on();
        if let (Some(shots), Some(last)) = (self.shots.take(), self.waiting.take()) {
            // The last frame may wait for the others, but the window may not.
            thread::spawn(move || drop(shots.send(last)));
        }
    }

    /// The film, or why there is none, once it is finished.
    pub fn poll(&mut self) -> Option<Result<Vec<u8>, String>> {
        match self.film.try_recv() {
            Ok(film) => Some(film),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Err("the film could not be drawn".to_owned())),
        }
    }

    /// Passes the waiting shot on if there is room.
    fn pass_on(&mut self) {
        let (Some(shots), Some(shot)) = (&self.shots, self.waiting.take()) else { return };
        // A thread that has ended tells why through the film.
        if let Err(TrySendError::Full(shot)) = shots.try_send(shot) {
            self.waiting = Some(shot);
        }
    }
}

/// Draws and encodes all shots.
fn draw(
    format: FilmFormat,
    size: [usize; 2],
    mut stage: Stage,
    shots: &Receiver<Shot>,
    drawn: &AtomicU64,
) -> Result<Vec<u8>, String> {
    let interval = 1.0 / f64::from(Recorder::RATE);
    let mut encoder = format.encoder(size, Recorder::RATE)?;
    for Shot { snapshot, options, viewpoint } in shots {
        stage.set_options(options);
        stage.see_from(viewpoint);
        let is_first = drawn.load(Ordering::Relaxed) == 0;
        let picture = if is_first { stage.first_picture(&snapshot) } else { stage.picture(&snapshot, interval) };
        encoder.add(picture)?;
        drawn.fetch_add(1, Ordering::Relaxed);
    }
    encoder.finish()
}
