//! Records the stage while simulated time runs. Frames are taken at equal intervals of simulated time, and drawn and encoded beside the
//! window; where that is slower, simulated time waits for it, and the window does not.

use super::{FilmFormat, Worker};
use crate::{
    app::{
        canvas::{Options, Viewpoint},
        language::Language,
        stage::Stage,
    },
    snapshot::Snapshot,
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
    worker: Worker,
    /// A shot that waits for the ones before it.
    waiting: Option<Shot>,
    /// Whether more frames are taken.
    records: bool,
    taken: u64,
    /// Simulated time between two frames, and since the last \[s\].
    interval: f64,
    since: f64,
    /// Time at the start of the recording, for the name of the file \[s\].
    pub start: f64,
}

impl Recorder {
    /// Frames in a second of the film. In real time the longest step is half the time between them, and every step divides it.
    pub const RATE: u32 = 30;

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
        let (start, options) = (first.snapshot.time, first.options);
        // The film may be drawn by another thread, which has a language of its own.
        let language = Language::chosen();
        let stage = move || {
            language.choose();
            Stage::new((size, 1), is_dark, options)
        };
        let worker = Worker::start(format, size, stage)?;
        let interval = pace / f64::from(Self::RATE);
        let mut recorder = Self { format, worker, waiting: None, records: true, taken: 0, interval, since: 0.0, start };
        recorder.add(first);
        Ok(recorder)
    }

    /// How far it is.
    pub fn progress(&self) -> Progress {
        Progress { format: self.format, taken: self.taken, drawn: self.worker.drawn(), records: self.records }
    }

    /// Number of steps \[s\] until the next frame, which is zero while frames wait to be drawn.
    pub fn steps_to_frame(&mut self, step: f64) -> u64 {
        if !self.records {
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
        let is_due = self.records && self.since >= self.interval - Self::ROUND_OFF * step;
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
        if std::mem::take(&mut self.records) {
            self.pass_on();
            self.worker.end(self.waiting.take());
        }
    }

    /// The film, or why there is none, once it is finished.
    pub fn poll(&mut self) -> Option<Result<Vec<u8>, String>> {
        self.worker.poll()
    }

    /// Passes the waiting shot on if there is room.
    fn pass_on(&mut self) {
        self.waiting = self.waiting.take().and_then(|shot| self.worker.take(shot));
    }
}
