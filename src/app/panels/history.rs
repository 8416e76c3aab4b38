//! Energies of the last seconds.

use crate::{
    level::Level,
    snapshot::{Energies, Snapshot},
    study::{Setting, head},
    table::Table,
};
use std::collections::VecDeque;

/// Length of the history [s of simulated time].
pub const WINDOW: f64 = 10.0;

/// Minimum time between two samples [s].
const APART: f64 = 1.0 / 120.0;

/// Energies of the last seconds.
#[derive(Default)]
pub struct History {
    samples: VecDeque<(f64, Energies)>,
    generation: u64,
}

impl History {
    /// Records the present energies. It clears the history if time went backwards or the scene has changed.
    pub fn record(&mut self, now: &Snapshot) {
        let back = self.samples.back().is_some_and(|(time, _)| now.time < *time);
        if back || self.generation != now.generation {
            self.samples.clear();
            self.generation = now.generation;
        }
        let kept = self.samples.len();
        // The newest sample is replaced until it is far enough from the one before.
        if kept >= 2 && now.time - self.samples[kept - 2].0 < APART || kept == 1 && now.time == self.samples[0].0 {
            self.samples.pop_back();
        }
        self.samples.push_back((now.time, now.energies));
        while self.samples.front().is_some_and(|(time, _)| now.time - time > WINDOW) {
            self.samples.pop_front();
        }
    }

    /// The samples as comma-separated values, with a head that states their origin; `level` is the level that was run.
    pub fn csv(&self, level: &Level) -> String {
        let about = [
            ("stepped_by", Setting::of(level).label()),
            (
                "reference",
                "none: these are the energies of the scene as it ran, with all that was done to it".to_owned(),
            ),
        ];
        let columns = ["time_s", "kinetic_j", "elastic_j", "potential_j", "total_j"];
        let mut table = Table::new(head(&level.name, 1, &about), &columns);
        for (time, of) in &self.samples {
            table.row([*time, of.kinetic, of.elastic, of.potential, of.total()].map(|number| number.to_string()));
        }
        table.text()
    }

    /// Samples, oldest first.
    pub fn samples(&self) -> impl Iterator<Item = &(f64, Energies)> {
        self.samples.iter()
    }

    /// The newest sample.
    pub fn last(&self) -> Option<&(f64, Energies)> {
        self.samples.back()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(time: f64) -> Snapshot {
        Snapshot { time, ..Snapshot::default() }
    }

    #[test]
    fn the_plot_drops_old_samples_and_restarts_with_time() {
        let mut history = History::default();
        for frame in 0..3000 {
            history.record(&at(f64::from(frame) / 60.0));
        }
        assert!((590..=602).contains(&history.samples.len()), "{}", history.samples.len());
        history.record(&at(0.0));
        assert_eq!(history.samples.len(), 1);
    }

    #[test]
    fn slow_motion_does_not_fill_the_memory() {
        let mut history = History::default();
        for frame in 0..10_000 {
            history.record(&at(f64::from(frame) * 1e-4));
        }
        assert!(history.samples.len() <= 122, "{}", history.samples.len());
    }
}
