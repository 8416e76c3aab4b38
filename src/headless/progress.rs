//! Progress of a long command: a bar on a terminal, elsewhere a line on standard error every few seconds.

use crate::terminal;
use indicatif::{ProgressBar, ProgressStyle};
use std::{
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
        mpsc::{self, RecvTimeoutError, Sender},
    },
    thread::JoinHandle,
    time::Duration,
};
use web_time::Instant;

/// How progress is shown.
#[derive(Clone, Debug, clap::Args)]
pub struct Pace {
    /// Seconds between two lines of progress where standard error is not a terminal; 0 for none.
    #[arg(long, value_name = "SECONDS", default_value = "10", value_parser = super::seconds)]
    pub progress: f64,
}

impl Default for Pace {
    fn default() -> Self {
        Self { progress: 10.0 }
    }
}

/// Progress that is shown until it is dropped.
pub struct Progress {
    bar: ProgressBar,
    done: Arc<AtomicU64>,
    ticker: Option<(Sender<()>, JoinHandle<()>)>,
}

impl Progress {
    /// Of a work of so many parts, called `unit` in the lines.
    pub fn new(pace: &Pace, total: u64, unit: &'static str) -> Self {
        let bar = ProgressBar::new(total);
        let template =
            if unit == PER_CENT { "{bar:40} {percent} %, {elapsed}" } else { "{bar:40} {pos}/{len} steps, {eta} left" };
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        let done = Arc::new(AtomicU64::new(0));
        let hidden = bar.is_hidden() && pace.progress > 0.0;
        let ticker = hidden.then(|| {
            let (stop, stopped) = mpsc::channel::<()>();
            let (done, every, begin) = (Arc::clone(&done), Duration::from_secs_f64(pace.progress), Instant::now());
            let tick = move || {
                while stopped.recv_timeout(every) == Err(RecvTimeoutError::Timeout) {
                    let (done, elapsed) = (done.load(Ordering::Relaxed), begin.elapsed().as_secs_f64());
                    let share = if unit == PER_CENT {
                        format!("{:.1} {unit}", done as f64 / 10.0)
                    } else {
                        format!("{done} of {total} {unit}")
                    };
                    terminal::report(&format!("gingerbread: {share} done after {elapsed:.0} s"));
                }
            };
            (stop, std::thread::spawn(tick))
        });
        Self { bar, done, ticker }
    }

    /// So many parts are done.
    pub fn set(&self, done: u64) {
        self.done.store(done, Ordering::Relaxed);
        self.bar.set_position(done);
    }
}

/// The unit of a work of 1000 parts, told in per cent.
pub const PER_CENT: &str = "%";

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
        if let Some((stop, ticker)) = self.ticker.take() {
            drop(stop);
            // A line that is being printed is finished first.
            let _ = ticker.join();
        }
    }
}
