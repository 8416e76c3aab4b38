//! SIGINT and SIGTERM: the first stops a command after the present step, the second ends it at once.

use signal_hook::{
    consts::{SIGINT, SIGTERM},
    flag,
};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

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
