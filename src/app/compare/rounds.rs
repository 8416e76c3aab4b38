//! Synchronises two panes with different step lengths.

use crate::{sandbox::Sandbox, simulation::Restart};
use web_time::Instant;

/// Number of steps that a pane takes in one go, if its rounds are short.
const LEAP: u64 = 10;

/// Time constant of the costs [s of simulated time].
const MEMORY: f64 = 0.5;

/// Progress of both panes within a round, and the cost of their steps.
#[derive(Default)]
pub struct Rounds {
    /// Steps that A and B still take before they have the same time, and the number of rounds that these steps belong to.
    left: [u64; 2],
    bunch: u64,
    /// Whether B is computed first. The panes alternate, because the first one finds cold caches.
    b_first: bool,
    /// States of both panes at their last common time.
    met: [Restart; 2],
    /// Computing time [s] and its simulated time [s], both fading. Slept steps do not count.
    spent: [f64; 2],
    simulated: [f64; 2],
}

impl Rounds {
    /// Number of steps of A and of B in a round.
    fn steps(a: &Sandbox, b: &Sandbox) -> [u64; 2] {
        let counts = [a, b].map(|sandbox| u64::from(sandbox.shown.substeps.get()));
        counts.map(|count| count / greatest_common_divisor(counts))
    }

    /// Length of a round [s].
    pub fn length(a: &Sandbox, b: &Sandbox) -> f64 {
        Self::steps(a, b)[0] as f64 * a.step_length()
    }

    /// Whether a round has begun and not ended.
    pub const fn is_between(&self) -> bool {
        self.left[0] > 0 || self.left[1] > 0
    }

    /// Completes the round that has begun and takes up to `rounds` more, as long as `more` returns true. Returns the number completed.
    pub fn advance(&mut self, mut panes: [&mut Sandbox; 2], rounds: u64, more: &mut dyn FnMut() -> bool) -> u64 {
        let (steps, length) = (Self::steps(panes[0], panes[1]), Self::length(panes[0], panes[1]));
        let mut taken = 0;
        loop {
            if !self.is_between() {
                if taken >= rounds || (taken > 0 && !more()) {
                    return taken;
                }
                self.bunch = (LEAP / steps[0].max(steps[1])).clamp(1, rounds - taken);
                self.left = steps.map(|count| count * self.bunch);
                self.b_first = !self.b_first;
                for (met, pane) in self.met.iter_mut().zip(&panes) {
                    pane.simulation().write_restart(met);
                }
            }
            for number in if self.b_first { [1, 0] } else { [0, 1] } {
                let (begin, pane) = (Instant::now(), &mut panes[number]);
                let computed = pane.simulation().counts().computed();
                if self.left[number] > 0 {
                    self.left[number] -= pane.advance(self.left[number], more);
                }
                let steps = pane.simulation().counts().computed().saturating_sub(computed);
                self.simulated[number] += steps as f64 * pane.step_length();
                self.spent[number] += begin.elapsed().as_secs_f64();
                if !pane.is_live() {
                    let stopped = pane.simulation().state().time;
                    self.catch_up(panes[1 - number], stopped, 1 - number);
                    return taken;
                }
                if self.left[number] > 0 {
                    return taken;
                }
            }
            taken += self.bunch;
            self.record_time(self.bunch as f64 * length);
        }
    }

    /// One pane has stopped: the other one runs from the last common time to the time of the stop, or as near as its steps allow.
    fn catch_up(&mut self, other: &mut Sandbox, stopped: f64, number: usize) {
        other.resume(&self.met[number]);
        self.left = [0, 0];
        // A difference of less than half a millionth of a step is round-off.
        let steps = ((stopped - self.met[number].state.time) / other.step_length() + 5e-7).max(0.0);
        other.advance(steps as u64, &mut || true);
    }

    fn record_time(&mut self, simulated: f64) {
        let fade = libm::exp(-simulated / MEMORY);
        // The newest computing time is already in the sums.
        self.spent.iter_mut().chain(&mut self.simulated).for_each(|known| *known *= fade);
    }

    /// Returns both panes to their last common time.
    pub fn go_back(&mut self, panes: [&mut Sandbox; 2]) {
        if self.is_between() {
            for (pane, met) in panes.into_iter().zip(&self.met) {
                pane.resume(met);
            }
            self.left = [0, 0];
        }
    }

    /// Computing time for a second of simulated time without slept steps [s]; `None` before both panes have computed some.
    pub fn prices(&self) -> Option<[f64; 2]> {
        let [a, b] = [0, 1].map(|pane| (self.simulated[pane] > 0.0).then(|| self.spent[pane] / self.simulated[pane]));
        Some([a?, b?])
    }
}

const fn greatest_common_divisor([mut a, mut b]: [u64; 2]) -> u64 {
    while b > 0 {
        (a, b) = (b, a % b);
    }
    a
}
