//! Converts real time to steps. Simulated time slows down when the computer is too slow; steps are never skipped or lengthened.
//! The module reads no system clock, so it can be tested with plain numbers.

/// Bounds of the time that may be owed \[s\]. The limit is two frames of recent length. More is dropped, so that a stalled or hidden
/// window does not catch up in a burst.
const MOST_DEBT: (f64, f64) = (2.0 / 60.0, 0.1);

/// Time constant of the shown rates \[s\].
const MEMORY: f64 = 0.4;

/// Update interval of the shown rates, long enough to read them \[s\].
const REFRESH: f64 = 0.25;

/// The accumulator between real and simulated time.
#[derive(Clone, Debug, Default)]
pub struct Clock {
    debt: f64,
    paid: f64,
    real: f64,
    physics: f64,
    frame: f64,
    /// Presented frames, and steps computed in them; both fade like `real`.
    frames: f64,
    work: f64,
    undivided: f64,
    interval: f64,
    since_shown: f64,
    shown: Option<Rates>,
}

/// Wanted simulated time over real time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pace(usize);

impl Pace {
    const FACTORS: [(f64, &str); 9] = [
        (1.0 / 1000.0, "1/1000"),
        (1.0 / 300.0, "1/300"),
        (1.0 / 100.0, "1/100"),
        (1.0 / 30.0, "1/30"),
        (1.0 / 10.0, "1/10"),
        (1.0 / 3.0, "1/3"),
        (1.0, "1"),
        (3.0, "3"),
        (10.0, "10"),
    ];

    /// All of them, the slowest first.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..Self::FACTORS.len()).map(Self)
    }

    /// Simulated time over real time.
    pub const fn factor(self) -> f64 {
        Self::FACTORS[self.0].0
    }

    /// The factor as it is shown.
    pub const fn label(self) -> &'static str {
        Self::FACTORS[self.0].1
    }

    /// The next one, or itself.
    #[must_use]
    pub fn faster(self) -> Self {
        Self((self.0 + 1).min(Self::FACTORS.len() - 1))
    }

    /// The one before, or itself.
    #[must_use]
    pub const fn slower(self) -> Self {
        Self(self.0.saturating_sub(1))
    }
}

impl Default for Pace {
    /// Real time.
    fn default() -> Self {
        Self(6)
    }
}

/// Rates that the panels show.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rates {
    /// Simulated time that passed, as a share of that which should have passed at the chosen pace.
    pub factor: f64,
    /// Time of stepping in a frame \[s\].
    pub physics: f64,
    /// Time that the program needs for a whole frame \[s\], without the time of the graphics card.
    pub frame: f64,
    /// Frame rate from the time between frames, so that painting is included [1/s].
    pub frames: f64,
    /// Ratio of computed steps to undivided steps: above 1 the guard divides or repeats steps.
    pub effort: f64,
}

/// Data of a frame in which simulated time ran.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spent {
    /// Real time since the last frame \[s\].
    pub elapsed: f64,
    /// How long a step takes on the clock at the chosen pace \[s\].
    pub step: f64,
    /// Steps owed, from [`Clock::owe`].
    pub owed: u64,
    /// Steps taken.
    pub taken: u64,
    /// Time of stepping \[s\].
    pub physics: f64,
    /// Time of the whole last frame \[s\].
    pub frame: f64,
    /// Number of computed steps, and their number if the guard divided none.
    pub work: [u64; 2],
}

impl Clock {
    /// Adds real time \[s\] and returns the number of whole steps that are owed, each of this length on the clock \[s\].
    pub fn owe(&mut self, elapsed: f64, step: f64) -> u64 {
        if !elapsed.is_finite() || !step.is_finite() || step <= 0.0 {
            return 0;
        }
        let most = (2.0 * self.interval).clamp(MOST_DEBT.0, MOST_DEBT.1).max(step);
        self.interval += 0.2 * (elapsed.clamp(0.0, MOST_DEBT.1) - self.interval);
        self.debt = (self.debt + elapsed.max(0.0)).min(most);
        // A frame of exactly n steps must not give n - 1 because of round-off.
        (self.debt / step + 1e-9).floor() as u64
    }

    /// Records the steps taken. Owed steps that were not taken are dropped, except the fraction of a step.
    pub fn pay(&mut self, spent: Spent) {
        let whole = spent.owed as f64 * spent.step;
        self.debt = (self.debt - whole).clamp(0.0, spent.step);
        let fade = (-spent.elapsed / MEMORY).exp();
        self.paid = self.paid * fade + spent.taken as f64 * spent.step;
        self.real = self.real * fade + spent.elapsed;
        self.physics = blend(self.physics, spent.physics, fade);
        self.frame = blend(self.frame, spent.frame, fade);
        self.frames = self.frames * fade + 1.0;
        self.work = self.work * fade + spent.work[0] as f64;
        self.undivided = self.undivided * fade + spent.work[1] as f64;
        self.since_shown += spent.elapsed;
        if self.shown.is_none() || self.since_shown >= REFRESH {
            self.since_shown = 0.0;
            let factor = if self.real > 0.0 { self.paid / self.real } else { 1.0 };
            let frames = if self.real > 0.0 { self.frames / self.real } else { 0.0 };
            let effort = if self.undivided > 0.0 { (self.work / self.undivided).max(1.0) } else { 1.0 };
            self.shown = Some(Rates { factor, physics: self.physics, frame: self.frame, frames, effort });
        }
    }

    /// Clears the owed time and the rates, because simulated time stopped.
    pub fn stop(&mut self) {
        *self = Self { shown: None, ..Self::default() };
    }

    /// Rates to show; `None` while simulated time is stopped.
    pub const fn rates(&self) -> Option<Rates> {
        self.shown
    }
}

/// Time of a frame \[s\], smoothed for steps about as long as frames. A frame of almost a whole number of steps takes exactly that
/// number, so that jitter of the display does not make the motion stutter.
pub fn steadied(elapsed: f64, step: f64) -> f64 {
    let steps = (elapsed / step).round();
    if step > 0.004 && steps >= 1.0 && (elapsed / step - steps).abs() < 0.1 { steps * step } else { elapsed }
}

fn blend(old: f64, new: f64, fade: f64) -> f64 {
    if old == 0.0 { new } else { old * fade + new * (1.0 - fade) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const H: f64 = 1.0 / 6000.0;

    fn run(clock: &mut Clock, frames: usize, elapsed: f64, affordable: u64) -> u64 {
        let mut total = 0;
        for _ in 0..frames {
            let owed = clock.owe(elapsed, H);
            let taken = owed.min(affordable);
            clock.pay(Spent { elapsed, step: H, owed, taken, physics: 0.004, frame: 0.006, work: [taken; 2] });
            total += taken;
        }
        total
    }

    #[test]
    fn a_second_of_frames_is_a_second_of_steps_at_any_display_rate() {
        for rate in [30_usize, 60, 75, 144, 240] {
            let mut clock = Clock::default();
            let total = run(&mut clock, rate, 1.0 / rate as f64, u64::MAX);
            assert!((5900..=6000).contains(&total), "{rate} Hz gave {total} steps");
        }
    }

    #[test]
    fn a_slow_machine_slows_time_down_and_says_so() {
        let mut clock = Clock::default();
        run(&mut clock, 200, 1.0 / 60.0, 43);
        let factor = clock.rates().map(|rates| rates.factor);
        assert!(factor.is_some_and(|factor| (factor - 0.43).abs() < 1e-6), "{factor:?}");
    }

    #[test]
    fn what_could_not_be_paid_is_not_caught_up_later() {
        let mut clock = Clock::default();
        run(&mut clock, 60, 1.0 / 60.0, 10);
        assert!(run(&mut clock, 1, 1.0 / 60.0, u64::MAX) <= 101);
    }

    #[test]
    fn a_stall_does_not_cause_a_burst() {
        let mut clock = Clock::default();
        run(&mut clock, 100, 1.0 / 60.0, u64::MAX);
        assert_eq!(clock.owe(3600.0, H), 200);
    }

    #[test]
    fn a_slow_display_does_not_slow_time_down() {
        let mut clock = Clock::default();
        run(&mut clock, 30, 1.0 / 15.0, u64::MAX);
        assert_eq!(run(&mut clock, 15, 1.0 / 15.0, u64::MAX), 6000);
    }

    #[test]
    fn a_step_longer_than_two_frames_is_still_taken() {
        let mut clock = Clock::default();
        let steps: u64 = (0..60)
            .map(|_| {
                let owed = clock.owe(1.0 / 60.0, 0.1);
                clock.pay(Spent { elapsed: 1.0 / 60.0, step: 0.1, owed, taken: owed, ..Spent::default() });
                owed
            })
            .sum();
        assert!((9..=10).contains(&steps), "{steps}");
    }

    #[test]
    fn nonsense_from_a_clock_owes_nothing() {
        let mut clock = Clock::default();
        assert_eq!(clock.owe(-5.0, H) + clock.owe(f64::NAN, H) + clock.owe(1.0, 0.0), 0);
    }

    #[test]
    fn the_frame_rate_counts_the_time_between_frames() {
        for rate in [0.19, 12.0, 60.0] {
            let mut clock = Clock::default();
            run(&mut clock, 200, 1.0 / rate, u64::MAX);
            let shown = clock.rates().map_or(0.0, |rates| rates.frames);
            assert!((shown - rate).abs() < 1e-6 * rate, "{shown} in place of {rate} frames per second");
        }
    }

    #[test]
    fn the_effort_counts_what_the_guard_adds() {
        for divided in [1, 8] {
            let mut clock = Clock::default();
            for _ in 0..60 {
                let owed = clock.owe(1.0 / 60.0, H);
                let work = [divided * owed, owed];
                clock.pay(Spent { elapsed: 1.0 / 60.0, step: H, owed, taken: owed, work, ..Spent::default() });
            }
            assert_eq!(clock.rates().map(|rates| rates.effort), Some(divided as f64));
        }
    }

    #[test]
    fn the_paces_rise_to_real_time_and_beyond() {
        let all: Vec<_> = Pace::all().collect();
        assert!(all.windows(2).all(|pair| pair[0].faster() == pair[1] && pair[1].slower() == pair[0]));
        assert!(all.windows(2).all(|pair| pair[0].factor() < pair[1].factor()));
        assert_eq!((Pace::default().factor(), Pace::default().label()), (1.0, "1"));
        assert_eq!((all[0].slower(), all[8].faster()), (all[0], all[8]));
    }

    #[test]
    fn standing_still_has_no_rate() {
        let mut clock = Clock::default();
        run(&mut clock, 10, 1.0 / 60.0, u64::MAX);
        clock.stop();
        assert_eq!(clock.rates(), None);
    }
}
