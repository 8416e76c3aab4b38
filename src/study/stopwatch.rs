//! Processor time of a thread, which does not count what other programs take; wall time where the system does not tell it.

use std::time::Duration;
use web_time::Instant;

/// What the times of studies are, in words.
pub const CLOCK: &str =
    if cfg!(target_arch = "wasm32") { "wall time" } else { "processor time of the thread that computes" };

/// Begun at a moment, to be read in the same thread.
pub(super) struct Stopwatch {
    wall: Instant,
    #[cfg(not(target_arch = "wasm32"))]
    processor: Option<cpu_time::ThreadTime>,
}

impl Stopwatch {
    /// From now on.
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
