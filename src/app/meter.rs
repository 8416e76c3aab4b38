//! Cost of each effect in a frame of 1/60 s.

use crate::{report::EffectCost, snapshot::Snapshot};

/// Simulated time between two readings [s].
const REFRESH: f64 = 0.25;

/// Cost of an effect in a frame of 1/60 s of simulated time in which it is computed; zero if it always slept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Use {
    /// Name of the effect.
    pub name: &'static str,
    /// Time [s].
    pub time: f64,
    /// Share of steps in which its bodies and nets slept. These steps do not count for time, calls and elements.
    pub slept: f64,
    /// Number of calls.
    pub calls: f64,
    /// Number of elements touched, summed over the calls.
    pub elements: f64,
    /// Number of skipped calls; here the slept steps count.
    pub skipped: f64,
}

/// Measures the cost of effects in a running scene.
#[derive(Default)]
pub struct Meter {
    /// Simulated time [s], step and costs at the start of the present reading.
    since: (f64, u64, Vec<EffectCost>),
    shown: Vec<Use>,
}

impl Meter {
    /// Reads the costs of a frame. It starts again if the scene or the direction of time has changed.
    pub fn read(&mut self, now: &Snapshot) {
        let (began, steps, before) = &self.since;
        let same = before.len() == now.costs.len()
            && before
                .iter()
                .zip(&now.costs)
                .all(|(a, b)| a.name == b.name && a.calls <= b.calls && a.skipped <= b.skipped);
        let elapsed = now.time - began;
        if !same || elapsed < 0.0 || now.steps < *steps {
            self.shown.clear();
        } else if elapsed < REFRESH {
            return;
        } else {
            let (frames, steps) = (60.0 * elapsed, (now.steps - steps).max(1) as f64);
            let over = |of: f64, by: f64| if by > 0.0 { of / by } else { 0.0 };
            let pairs = || before.iter().zip(&now.costs);
            let time = |before: &EffectCost, now: &EffectCost| now.time.saturating_sub(before.time).as_secs_f64();
            let used = |(before, now): (&EffectCost, &EffectCost)| {
                let slept = now.slept.saturating_sub(before.slept) as f64 / steps;
                let computed = frames * (1.0 - slept).max(0.0);
                Use {
                    name: now.name,
                    time: over(time(before, now), computed),
                    slept,
                    calls: over((now.calls - before.calls) as f64, computed),
                    elements: over((now.elements - before.elements) as f64, computed),
                    skipped: over((now.skipped - before.skipped) as f64, frames),
                }
            };
            self.shown = pairs().map(used).collect();
        }
        (self.since.0, self.since.1) = (now.time, now.steps);
        self.since.2.clone_from(&now.costs);
    }

    /// Clears the measurement, because the ledger is closed.
    pub fn stop(&mut self) {
        *self = Self::default();
    }

    /// The last reading; empty before the first quarter of a second.
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
        Snapshot { time, steps: (100.0 * time) as u64, costs: vec![cost], ..Snapshot::default() }
    }

    #[test]
    fn a_reading_is_per_frame_and_begins_anew_when_time_goes_back() {
        let mut meter = Meter::default();
        meter.read(&at(1.0, 1000));
        assert!(meter.shown().is_empty());
        meter.read(&at(1.5, 4000));
        let used = Use { name: "a", time: 100e-6, slept: 0.0, calls: 100.0, elements: 700.0, skipped: 0.0 };
        assert_eq!(meter.shown(), [used]);
        meter.read(&at(0.2, 0));
        assert!(meter.shown().is_empty());
    }

    #[test]
    fn a_reading_is_per_frame_that_was_computed() {
        let mut meter = Meter::default();
        meter.read(&at(1.0, 1000));
        let mut half_asleep = at(2.0, 4000);
        half_asleep.costs[0].slept = 50;
        meter.read(&half_asleep);
        let [used] = meter.shown() else { unreachable!("one effect") };
        assert_eq!((used.time, used.calls, used.slept), (100e-6, 100.0, 0.5));
        let mut asleep = at(3.0, 4000);
        asleep.costs[0].slept = 150;
        meter.read(&asleep);
        assert_eq!((meter.shown()[0].time, meter.shown()[0].slept), (0.0, 1.0));
    }
}
