//! Rewind buffer: states of the last seconds.
//!
//! ```
//! use gingerbread::{files, levels, meshes::NoFiles, rewind::Rewind, scene::Scene, simulation::Simulation};
//!
//! let level = files::parse(levels::built_in("chain").ok_or("there is no such level")?, "chain.ron")?;
//! let scene = Scene::build(&level, level.mode, &NoFiles, None)?;
//! let mut simulation = Simulation::open(scene, &level, level.mode)?;
//! let mut rewind = Rewind::default();
//! for _ in 0..60 {
//!     rewind.keep(&simulation);
//!     simulation.advance(u64::from(level.substeps.get()), &mut || true);
//! }
//! let before = rewind.back(simulation.state().time, 0.5).ok_or("it is in the buffer")?;
//! simulation.resume(&before);
//! assert!((simulation.state().time - 0.5).abs() < 0.02);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::simulation::{Restart, Simulation};
use std::collections::VecDeque;

/// Restart data of the last seconds, one for every frame of simulated time, as far as the memory limit allows.
#[derive(Debug, Default)]
pub struct Rewind {
    moments: VecDeque<Restart>,
}

impl Rewind {
    /// Length of the recorded time \[s\].
    pub const SECONDS: f64 = 10.0;
    /// Time between two recorded states \[s\].
    pub const FRAME: f64 = 1.0 / 60.0;
    /// Maximum number of recorded values: 128 MB.
    const MOST: usize = 16_000_000;

    /// Records the present moment of a run, unless the last one is less than a frame older. A moment of an earlier
    /// time, or of another scene, clears the buffer.
    pub fn keep(&mut self, run: &Simulation) {
        let state = run.state();
        if let Some(Restart { state: last, .. }) = self.moments.back() {
            let elsewhere = state.steps < last.steps || state.x.len() != last.x.len();
            if elsewhere {
                self.moments.clear();
            } else if state.time - last.time < Self::FRAME * (1.0 - 1e-6) {
                return;
            }
        }
        let numbers = self.moments.back().map_or(0, Restart::len).max(1);
        let full = self.moments.len() > Self::MOST / numbers;
        let old = self.moments.front().is_some_and(|first| first.state.time < state.time - Self::SECONDS);
        // Buffers of the dropped moment are reused.
        let mut kept = if full || old { self.moments.pop_front().unwrap_or_default() } else { Restart::default() };
        run.write_restart(&mut kept);
        self.moments.push_back(kept);
    }

    /// Returns the latest moment that is older than a time by at least this much \[s\], or the oldest one, and drops later moments. A moment
    /// later than the time is never returned.
    pub fn back(&mut self, now: f64, seconds: f64) -> Option<Restart> {
        let wanted = now - seconds + 1e-6 * Self::FRAME;
        while self.moments.len() > 1 && self.moments.back().is_some_and(|last| last.state.time > wanted) {
            self.moments.pop_back();
        }
        self.moments.back().filter(|last| last.state.time <= now).cloned()
    }

    /// The moments, the oldest first.
    pub fn moments(&self) -> impl Iterator<Item = &Restart> {
        self.moments.iter()
    }

    /// Length of the recorded time before a time \[s\].
    pub fn length(&self, now: f64) -> f64 {
        self.moments.front().map_or(0.0, |first| (now - first.state.time).max(0.0))
    }

    /// Clears the buffer.
    pub fn clear(&mut self) {
        self.moments.clear();
    }
}
