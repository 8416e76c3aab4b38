//! Clocks: wall time, and the processor time of a thread as the price of a run.

pub use std::time::Duration;
#[cfg(not(target_arch = "wasm32"))]
pub use std::time::Instant;
#[cfg(target_arch = "wasm32")]
pub use web_time::Instant;

/// Whether [`Stopwatch`] tells processor time.
const TELLS_PROCESSOR_TIME: bool = cfg!(all(feature = "processor-time", not(target_arch = "wasm32")));

/// Kind of the measured times, in plain words.
pub const CLOCK: &str = if TELLS_PROCESSOR_TIME {
    "processor time of the thread that computes"
} else if cfg!(target_arch = "wasm32") {
    "wall time, which a browser tells to 0.1 ms"
} else {
    "wall time"
};

/// Unit of the measured times, for axes.
pub const MILLISECONDS: &str = if TELLS_PROCESSOR_TIME { "processor ms" } else { "ms" };

/// Least time that the clock tells. Browsers round it so that pages cannot time each other.
pub const RESOLUTION: Duration = if cfg!(target_arch = "wasm32") { Duration::from_micros(100) } else { Duration::ZERO };

/// Stopwatch. It is started and read in the same thread.
///
/// It tells the processor time of this thread, which excludes other programs, with the feature `processor-time` where the system states it, and
/// else wall time.
pub struct Stopwatch {
    wall: Instant,
    #[cfg(all(feature = "processor-time", not(target_arch = "wasm32")))]
    processor: Option<cpu_time::ThreadTime>,
}

impl Stopwatch {
    /// Starts the stopwatch.
    pub fn start() -> Self {
        Self {
            wall: Instant::now(),
            #[cfg(all(feature = "processor-time", not(target_arch = "wasm32")))]
            processor: cpu_time::ThreadTime::try_now().ok(),
        }
    }

    /// Time since the start.
    pub fn elapsed(&self) -> Duration {
        #[cfg(all(feature = "processor-time", not(target_arch = "wasm32")))]
        if let Some(elapsed) = self.processor.and_then(|processor| processor.try_elapsed().ok()) {
            return elapsed;
        }
        self.wall.elapsed()
    }
}
