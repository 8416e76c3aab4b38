//! Processor time of a thread, which excludes other programs; wall time where the system does not state it.

use std::time::Duration;
use web_time::Instant;

/// Kind of the measured times, in plain words.
pub const CLOCK: &str =
    if cfg!(target_arch = "wasm32") { "wall time" } else { "processor time of the thread that computes" };

/// Stopwatch. It is started and read in the same thread.
pub(super) struct Stopwatch {
    wall: Instant,
    #[cfg(not(target_arch = "wasm32"))]
    processor: Option<cpu_time::ThreadTime>,
}

impl Stopwatch {
    /// Starts the stopwatch.
    pub fn start() -> Self {
        Self {
            wall: Instant::now(),
            #[cfg(not(target_arch = "wasm32"))]
            processor: cpu_time::ThreadTime::try_now().ok(),
        }
    }

    /// Time since the start.
    pub fn elapsed(&self) -> Duration {
        #[cfg(not(target_arch = "wasm32"))]
        if let Some(elapsed) = self.processor.and_then(|processor| processor.try_elapsed().ok()) {
            return elapsed;
        }
        self.wall.elapsed()
    }
}
