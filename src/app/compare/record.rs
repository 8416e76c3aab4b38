//! Recorded differences between the two panes.

use crate::{
    app::panels::WINDOW,
    sandbox::Sandbox,
    snapshot::Snapshot,
    study::{Apart, Difference, head},
    table::Table,
};
use std::collections::VecDeque;

/// Minimum time between two recorded moments [s].
const APART: f64 = 1.0 / 120.0;

/// Update interval of the shown costs [s].
const REFRESH: f64 = 0.25;

/// Difference of the panes at one simulated time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Simulated time [s].
    pub time: f64,
    /// Distance of the positions; `None` if the panes do not show the same things.
    pub positions: Option<Apart>,
    /// Total energy of B minus that of A [J].
    pub energy: f64,
    /// Computing time for a second of simulated time, A and B [s]; `None` before any was simulated.
    pub prices: Option<[f64; 2]>,
}

/// Moments of the last seconds, oldest first.
#[derive(Default)]
pub struct Record {
    moments: VecDeque<Moment>,
    difference: Option<Difference>,
    /// Time of the last update [s] and the costs shown since then.
    shown: Option<(f64, [f64; 2])>,
    /// Generations of the two recorded scenes.
    generations: [u64; 2],
    /// Name of the level, and the settings of each pane.
    level: String,
    settings: [String; 2],
}

impl Record {
    /// Records the present moment. It clears the record if time went backwards or a scene has changed.
    pub fn note(&mut self, panes: [&Sandbox; 2], seen: [&Snapshot; 2], prices: Option<[f64; 2]>) {
        let generations = seen.map(|seen| seen.generation);
        let time = seen[0].time;
        let last = self.moments.back().map(|moment| moment.time);
        if generations != self.generations || last.is_none_or(|last| time < last) {
            *self = Self { generations, ..Self::default() };
        } else if last == Some(time) {
            self.describe(seen);
            return;
        }
        self.describe(seen);
        let [a, b] = panes.map(Sandbox::simulation);
        if self.shown.is_none_or(|(since, _)| time - since >= REFRESH) {
            self.shown = prices.map(|prices| (time, prices));
        }
        let difference = self.difference.get_or_insert_with(|| Difference::new(a, b));
        let positions = difference.measure(a, b);
        let energy = seen[1].energies.total() - seen[0].energies.total();
        let kept = self.moments.len();
        // The newest moment is replaced until it is far enough from the one before.
        if kept >= 2 && time - self.moments[kept - 2].time < APART {
            self.moments.pop_back();
        }
        self.moments.push_back(Moment { time, positions, energy, prices });
        while self.moments.front().is_some_and(|moment| time - moment.time > WINDOW) {
            self.moments.pop_front();
        }
    }

    fn describe(&mut self, seen: [&Snapshot; 2]) {
        self.level.clone_from(&seen[0].level.name);
        self.settings = seen.map(|seen| super::stage::settings(seen).join(", "));
    }

    /// Recorded moments, oldest first.
    pub fn moments(&self) -> impl Iterator<Item = &Moment> {
        self.moments.iter()
    }

    /// Shown computing time for a second of simulated time, A and B [s].
    pub fn prices(&self) -> Option<[f64; 2]> {
        self.shown.map(|(_, prices)| prices)
    }

    /// The newest moment.
    pub fn last(&self) -> Option<&Moment> {
        self.moments.back()
    }

    /// The record as comma-separated values, with a head that states what is compared and measured.
    pub fn csv(&self) -> String {
        let [a, b] = self.settings.clone();
        let positions =
            "RMS distance of material points of B from A; relative: over the farthest that A was from its start (RMS)";
        let about = [
            ("A", a),
            ("B", b),
            ("positions", positions.to_owned()),
            ("energy", "total energy of B less that of A".to_owned()),
            ("ms", "time of computing for a second of simulated time that was not slept through".to_owned()),
            ("reference", "none: neither pane is a reference for the other".to_owned()),
        ];
        let columns = ["time_s", "positions_m", "positions_relative", "energy_j", "ms_a", "ms_b"];
        let mut table = Table::new(head(&self.level, 1, &about), &columns);
        for Moment { time, positions, energy, prices } in &self.moments {
            let share =
                |apart: Apart| if apart.relative.is_finite() { apart.relative.to_string() } else { String::new() };
            let [metres, relative] =
                positions.map_or([const { String::new() }; 2], |apart| [apart.metres.to_string(), share(apart)]);
            let [a, b] = prices.map_or([const { String::new() }; 2], |ms| ms.map(|s| format!("{:.4}", 1e3 * s)));
            table.row([time.to_string(), metres, relative, energy.to_string(), a, b]);
        }
        table.text()
    }
}
