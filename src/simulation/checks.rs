//! Measures the known results of a level while it runs.

use super::{PlacedCheck, Simulation};

impl Simulation {
    /// The known results of the level, with what was measured once their time had come. In a run that did not pass that time nothing was.
    pub fn checks(&self) -> impl Iterator<Item = (&PlacedCheck, Option<f64>)> {
        self.checks.iter().zip(self.measured_checks.iter().copied().chain(std::iter::repeat(None)))
    }

    /// Numbers of steps to the known results that are still to be measured.
    fn steps_to_checks(&self) -> impl Iterator<Item = u64> {
        let left = |check: &PlacedCheck| u64::try_from(check.steps_from(self.state.time, self.scene.step)).ok();
        self.checks.iter().filter_map(left).filter(|left| *left > 0)
    }

    /// Number of steps to the next known result that is to be measured; `None` behind the last one.
    pub fn steps_to_check(&self) -> Option<u64> {
        self.steps_to_checks().min()
    }

    /// Number of steps to the last known result; `None` behind it.
    pub fn steps_to_last_check(&self) -> Option<u64> {
        self.steps_to_checks().max()
    }

    /// Measures the results whose time has just come.
    pub(super) fn measure_checks(&mut self) {
        let is_now = |check: &PlacedCheck| check.steps_from(self.state.time, self.scene.step) == 0;
        if !self.checks.iter().any(is_now) {
            return;
        }
        let now = |(check, before): (&PlacedCheck, Option<f64>)| if is_now(check) { check.value(self) } else { before };
        self.measured_checks = self.checks().map(now).collect();
    }

    /// Forgets what was measured at later times than that of the state, which was set.
    pub(super) fn forget_later_checks(&mut self) {
        let later = self.checks.iter().map(|check| check.check.at.get() > self.state.time);
        self.measured_checks
            .iter_mut()
            .zip(later)
            .filter(|(_, later)| *later)
            .for_each(|(measured, _)| *measured = None);
    }
}
