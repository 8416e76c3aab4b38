//! Repeats short runs to measure their processor time.

use std::time::Duration;

/// Rounds of repetitions after the first runs.
const ROUNDS: u32 = 4;
/// Budget of all repetitions, as a share of the processor time of the first runs; and the least budget.
const SHARE: f64 = 0.4;
const LEAST: Duration = Duration::from_millis(100);

/// Greatest number of runs of one setting. The stated time is the least of them.
pub const MOST_RUNS: u32 = 1 + ROUNDS;

/// Repetition rounds of one study.
#[derive(Default)]
pub(super) struct Repetitions {
    round: u32,
    /// Time budget of the remaining rounds. `None` before the first round.
    budget: Option<Duration>,
}

impl Repetitions {
    /// Runs to repeat in the next round, the shortest first. Empty after the last round.
    /// `costs` holds the time of each run, `first` the time of all first runs. A round takes at most half of the
    /// remaining budget, the last round all of it.
    pub fn next(&mut self, costs: &[Option<Duration>], first: Duration) -> Vec<usize> {
        if self.round == ROUNDS {
            return Vec::new();
        }
        self.round += 1;
        let budget = self.budget.unwrap_or_else(|| first.mul_f64(SHARE).max(LEAST));
        let most = if self.round == ROUNDS { budget } else { budget / 2 };
        let mut known: Vec<_> =
            costs.iter().enumerate().filter_map(|(number, cost)| Some((number, (*cost)?))).collect();
        known.sort_by_key(|(_, cost)| *cost);
        let mut spent = Duration::ZERO;
        let chosen = known.iter().take_while(|(_, cost)| {
            let fits = spent + *cost <= most;
            spent += if fits { *cost } else { Duration::ZERO };
            fits
        });
        let chosen: Vec<_> = chosen.map(|(number, _)| *number).collect();
        self.budget = Some(budget.saturating_sub(spent));
        chosen
    }

    /// Share of the rounds that have begun.
    pub fn done(&self) -> f64 {
        f64::from(self.round) / f64::from(ROUNDS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repetitions_are_bounded_by_time_and_by_number() {
        let ms = Duration::from_millis;
        let costs = [Some(ms(400)), None, Some(ms(10)), Some(ms(100))];
        let (mut repetitions, mut runs) = (Repetitions::default(), [0; 4]);
        for _ in 0..10 {
            for number in repetitions.next(&costs, ms(1000)) {
                runs[number] += 1;
            }
        }
        assert_eq!(runs, [0, 0, 4, 3], "at most 0.4 s, the shortest most often");
    }
}
