//! Synchronises two panes with different step lengths.

use crate::{sandbox::Sandbox, simulation::Restart};
use web_time::Instant;

/// Steps that a pane takes in one go, if its rounds are short [steps].
const LEAP: u64 = 10;

/// How fast the prices follow [s of simulated time].
const MEMORY: f64 = 0.5;

/// Where both panes are, and what it cost to get there.
#[derive(Default)]
pub struct Rounds {
    /// Steps that A and B have yet to take before they meet, and how many rounds it was.
    left: [u64; 2],
    bunch: u64,
    /// Whether B goes first: they take turns, as who goes first finds cold caches.
    b_first: bool,
    /// Where both were when they last met.
    met: [Restart; 2],
    /// Time of computing [s], and the simulated time it was for [s], both fading: steps that were slept through do not count.
    spent: [f64; 2],
    simulated: [f64; 2],
}

impl Rounds {
    /// Steps of A and of B in a round.
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

    /// Finishes what has begun and takes up to so many rounds more; `more` is asked in between. Returns how many were completed.
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

    /// One of the two has stopped: the other goes from where they last met to that time, or as near to it as its steps allow.
    fn catch_up(&mut self, other: &mut Sandbox, stopped: f64, number: usize) {
        other.resume(&self.met[number]);
        self.left = [0, 0];
        // Half a millionth of a step is rounding.
        let steps = ((stopped - self.met[number].state.time) / other.step_length() + 5e-7).max(0.0);
        other.advance(steps as u64, &mut || true);
    }

    fn record_time(&mut self, simulated: f64) {
        let fade = libm::exp(-simulated / MEMORY);
        // What was just spent is in already.
        self.spent.iter_mut().chain(&mut self.simulated).for_each(|known| *known *= fade);
    }

    /// Goes back to where both last met.
    pub fn go_back(&mut self, panes: [&mut Sandbox; 2]) {
        if self.is_between() {
            for (pane, met) in panes.into_iter().zip(&self.met) {
                pane.resume(met);
            }
            self.left = [0, 0];
        }
    }

    /// Time of computing for a second of simulated time that was computed [s]; `None` before there was any of both.
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
