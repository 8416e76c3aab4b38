//! A command at work: progress on standard error, and signals that stop it.
//!
//! The first SIGINT or SIGTERM stops a command after the present step, the second ends it at once.

use crate::clock::Instant;
use crate::terminal;
use indicatif::{ProgressBar, ProgressStyle};
use signal_hook::{
    consts::{SIGINT, SIGTERM},
    flag,
};
use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering},
        mpsc::{self, RecvTimeoutError, Sender},
    },
    thread::JoinHandle,
    time::Duration,
};

/// How progress is shown.
#[derive(Clone, Debug, clap::Args)]
pub struct ProgressOptions {
    /// Seconds between two lines of progress where standard error is not a terminal; 0 for none.
    #[arg(long, value_name = "SECONDS", default_value = "10", value_parser = super::seconds)]
    pub progress: f64,
}

impl Default for ProgressOptions {
    fn default() -> Self {
        Self { progress: 10.0 }
    }
}

/// Progress display, shown until it is dropped.
pub struct Progress {
    bar: ProgressBar,
    done: Arc<AtomicU64>,
    ticker: Option<(Sender<()>, JoinHandle<()>)>,
}

impl Progress {
    /// Progress of `total` parts. `unit` names them in the lines.
    pub fn new(progress_options: &ProgressOptions, total: u64, unit: &'static str) -> Self {
        let bar = ProgressBar::new(total);
        let template =
            if unit == PER_CENT { "{bar:40} {percent} %, {elapsed}" } else { "{bar:40} {pos}/{len} steps, {eta} left" };
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        let done = Arc::new(AtomicU64::new(0));
        let (stop, stopped) = mpsc::channel::<()>();
        let ticker = Ticker { done: Arc::clone(&done), total, unit, begin: Instant::now() };
        let every = Duration::from_secs_f64(progress_options.progress);
        let lines = bar.is_hidden() && !every.is_zero();
        let tick = move || {
            let mut next = every;
            let wake = if lines { POLL_INTERVAL.min(every) } else { POLL_INTERVAL };
            while stopped.recv_timeout(wake) == Err(RecvTimeoutError::Timeout) {
                // The work may be in a long step and may not have seen the signal yet.
                Interrupt::tell();
                if lines && ticker.begin.elapsed() >= next && Interrupt::seen().is_none() {
                    terminal::report(&ticker.line());
                    next += every;
                }
            }
        };
        let ticker = Some((stop, std::thread::spawn(tick)));
        Self { bar, done, ticker }
    }

    /// Sets the number of finished parts.
    pub fn set(&self, done: u64) {
        self.done.store(done, Ordering::Relaxed);
        self.bar.set_position(done);
    }
}

/// Longest time between two checks for a signal.
const POLL_INTERVAL: Duration = Duration::from_millis(200);

/// Data of a progress line.
struct Ticker {
    done: Arc<AtomicU64>,
    total: u64,
    unit: &'static str,
    begin: Instant,
}

impl Ticker {
    fn line(&self) -> String {
        let (done, elapsed) = (self.done.load(Ordering::Relaxed), self.begin.elapsed().as_secs_f64());
        let share = if self.unit == PER_CENT {
            format!("{:.1} %", done as f64 / 10.0)
        } else {
            format!("{done} of {} {}", self.total, self.unit)
        };
        format!("gingerbread: {share} done after {elapsed:.0} s")
    }
}

/// Unit for a total of 1000 parts, shown in per cent.
pub const PER_CENT: &str = "%";

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
        if let Some((stop, ticker)) = self.ticker.take() {
            drop(stop);
            // Waits until a line that is being printed is complete.
            let _ = ticker.join();
        }
        Interrupt::tell();
    }
}

static ASKED: AtomicBool = AtomicBool::new(false);
static TOLD: AtomicBool = AtomicBool::new(false);
static SIGNAL: AtomicUsize = AtomicUsize::new(0);

/// Signal that asked a command to stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Interrupt(usize);

impl Interrupt {
    /// Makes SIGINT and SIGTERM ask for a stop from now on. Before this call they end the program.
    pub fn watch() {
        for signal in [SIGINT, SIGTERM] {
            // If a signal cannot be watched, it ends the program as before. The action registered first is called
            // first.
            let second = flag::register_conditional_shutdown(signal, 128 + signal, &ASKED);
            let first = flag::register(signal, &ASKED);
            let which = flag::register_usize(signal, &SIGNAL, usize::try_from(signal).unwrap_or(0));
            let _ = (second, first, which);
        }
    }

    /// Signal received, if any.
    pub fn seen() -> Option<Self> {
        ASKED.load(Ordering::SeqCst).then(|| Self(SIGNAL.load(Ordering::SeqCst)))
    }

    /// Reports once that a signal was received and what follows.
    pub(super) fn tell() {
        if let Some(signal) = Self::seen()
            && !TOLD.swap(true, Ordering::SeqCst)
        {
            crate::terminal::report(&format!(
                "gingerbread: {signal}: what there is will be written after the present step; another signal ends the program at once"
            ));
        }
    }

    /// Exit code: 130 for SIGINT, 143 for SIGTERM.
    pub fn exit_code(self) -> u8 {
        u8::try_from(128 + self.0).unwrap_or(u8::MAX)
    }
}

impl std::fmt::Display for Interrupt {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        out.write_str(if i32::try_from(self.0) == Ok(SIGTERM) { "SIGTERM" } else { "SIGINT" })
    }
}
