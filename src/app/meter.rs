//! What each effect costs in a frame of 1/60 s, as it runs: differences of what was booked, steady enough to be read.

use crate::{report::EffectCost, snapshot::Snapshot};

/// Simulated time between two readings [s].
const REFRESH: f64 = 0.25;

/// What one effect takes in a frame of 1/60 s of simulated time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Use {
    /// Name of the effect.
    pub name: &'static str,
    /// Time [s].
    pub time: f64,
    /// Calls.
    pub calls: f64,
    /// Elements touched by all calls together.
    pub elements: f64,
    /// How often it was passed over.
    pub skipped: f64,
}

/// Follows the books of a running scene.
#[derive(Default)]
pub struct Meter {
    /// What was booked when the present reading began, at this time [s].
    since: (f64, Vec<EffectCost>),
    shown: Vec<Use>,
}

impl Meter {
    /// Takes note of a frame. Another scene, or another time, begins anew.
    pub fn read(&mut self, now: &Snapshot) {
        let (began, before) = &self.since;
        let same = before.len() == now.costs.len()
            && before
                .iter()
                .zip(&now.costs)
                .all(|(a, b)| a.name == b.name && a.calls <= b.calls && a.skipped <= b.skipped);
        let elapsed = now.time - began;
        if !same || elapsed < 0.0 {
            self.shown.clear();
        } else if elapsed < REFRESH {
            return;
        } else {
            let frames = 60.0 * elapsed;
            self.shown.clear();
            self.shown.extend(before.iter().zip(&now.costs).map(|(before, now)| Use {
                name: now.name,
                time: now.time.saturating_sub(before.time).as_secs_f64() / frames,
                calls: (now.calls - before.calls) as f64 / frames,
                elements: (now.elements - before.elements) as f64 / frames,
                skipped: (now.skipped - before.skipped) as f64 / frames,
            }));
        }
        self.since.0 = now.time;
        self.since.1.clone_from(&now.costs);
    }

    /// Forgets everything: nobody reads.
    pub fn stop(&mut self) {
        *self = Self::default();
    }

    /// What was read last; nothing before the first quarter of a second.
    pub fn shown(&self) -> &[Use] {
        &self.shown
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    fn at(time: f64, calls: u64) -> Snapshot {
        let cost = EffectCost {
            calls,
            elements: 7 * calls,
            time: Duration::from_micros(calls),
            ..EffectCost::none("a", true)
        };
        Snapshot { time, costs: vec![cost], ..Snapshot::default() }
    }

    #[test]
    fn a_reading_is_per_frame_and_begins_anew_when_time_goes_back() {
        let mut meter = Meter::default();
        meter.read(&at(1.0, 1000));
        assert!(meter.shown().is_empty());
        meter.read(&at(1.5, 4000));
        assert_eq!(meter.shown(), [Use { name: "a", time: 100e-6, calls: 100.0, elements: 700.0, skipped: 0.0 }]);
        meter.read(&at(0.2, 0));
        assert!(meter.shown().is_empty());
    }
}
