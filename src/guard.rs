//! Guard: detects unstable steps by their energy.

use crate::{level::SavedGuard, report::Energies, scene::Scene};

/// Watches one run for energy that comes from nowhere.
///
/// Between two changes from outside, nothing in a scene supplies energy: gravity and springs only convert it, damping and
/// contact take it. With the mechanical energy M (kinetic, elastic) and the potential P, `M + P` can never exceed what was put in.
/// A moving obstacle is outside: what its push on each vertex does, impulse times velocity of the obstacle there, is booked as
/// put in. Where a scheme solves for the rest of a body with what was pushed held, that is an estimate; while it brings a body out of
/// a wall it began in, all that came is.
/// Schemes err by a bounded share even when they are stable (symplectic Euler by up to h w / 2 of a vibration w), and explicit ones
/// may drift slowly, which is a lesson rather than an accident. So a step counts as unstable only if both hold: M is above twice
/// what is available, and M + P grew by 8 % of M in this one step, as it does near and above the stability limit.
///
/// What came in before it was noticed, up to about twice what there was, is only taken back as far as the last 10 to 20 steps go.
///
/// Looking at all energies costs as much as a step. It is only done when the kinetic energy, which is cheap, has grown by half
/// since the last look.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Guard {
    /// What was put in so far, from the energies' zero [J]; found when it is first needed.
    put_in: Option<f64>,
    /// The energy at the start, and what changes from outside have added since [J].
    start: f64,
    /// Kinetic energy up to which nothing is looked at [J].
    kinetic_threshold: f64,
    /// Mechanical energy and total after the last step, where every step is looked at [J].
    last: Option<[f64; 2]>,
    /// Every step is taken in 2^level shorter ones.
    level: u32,
    /// Steps since it last had to be raised.
    stable_steps: u32,
    /// How many there have to be before longer steps are tried again; doubled whenever that failed.
    retry_after: u32,
}

/// What the guard makes of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Nothing to object.
    Fine,
    /// Energy came from nowhere.
    Unstable,
    /// The energies before the step are needed to tell.
    Unknown,
}

impl Guard {
    /// A step is taken in up to 2^6 = 64 shorter ones.
    pub const MOST: u32 = SavedGuard::MOST_LEVEL;

    /// Longer steps are tried again after so many steps without trouble, at first and at most.
    const RETRY_STEPS: [u32; 2] = [32, 2048];

    /// As a level file holds it, with the hash of the state that it belongs to; `None` before the first step, or if an energy is not
    /// finite.
    pub fn saved(&self, state: u64) -> Option<SavedGuard> {
        let (supplied, last) = (self.put_in?, self.last.map(|[mechanical, total]| (mechanical, total)));
        let (mechanical, total) = last.unwrap_or_default();
        let finite = [supplied, self.start, self.kinetic_threshold, mechanical, total].into_iter().all(f64::is_finite);
        finite.then_some(SavedGuard {
            state,
            supplied,
            start: self.start,
            threshold: self.kinetic_threshold,
            last,
            level: self.level,
            quiet: self.stable_steps,
            retry: self.retry_after,
        })
    }

    /// How many shorter steps a step is made of: 2^level.
    pub const fn level(&self) -> u32 {
        self.level
    }

    /// Forgets all: the state was put somewhere else.
    pub fn reset(&mut self) {
        *self = Self::default();
    }

    /// Whether it needs the energies at the start.
    pub const fn is_new(&self) -> bool {
        self.put_in.is_none()
    }

    /// Takes note of the energies at the start.
    pub fn begin(&mut self, energies: Energies) {
        self.put_in = Some(energies.total());
        self.start = energies.total();
    }

    /// What was put in so far, if it is known [J].
    pub const fn put_in(&self) -> Option<f64> {
        self.put_in
    }

    /// Goes back to what was put in up to an earlier moment.
    pub const fn set_put_in(&mut self, put_in: Option<f64>) {
        self.put_in = put_in;
    }

    /// Takes note of work of moving obstacles [J].
    pub fn supply(&mut self, work: f64) {
        if let Some(put_in) = &mut self.put_in {
            *put_in += work;
        }
    }

    /// Takes energies of a stable scheme for what they are, where more was put in than is known; see [`Self::is_possible`].
    pub fn allow(&mut self, after: Energies) {
        self.put_in = self.put_in.map(|put_in| put_in.max(after.total()));
        self.last = None;
    }

    /// Whether something in a scene can have supplied energy up to this total [J]: not more than a hundred times what its elements
    /// store at a stretch of one, or what was there at the start.
    pub fn is_possible(&self, scene: &Scene, total: f64) -> bool {
        total <= 100.0 * scale(scene).max(self.start.abs())
    }

    /// Whether nothing at all can have: not even an obstacle that moves faster than anything that is modelled here. What such an
    /// obstacle seems to have supplied to a body that explodes is no work.
    fn is_impossible(&self, scene: &Scene, total: f64) -> bool {
        total > 1e6 * scale(scene).max(self.start.abs())
    }

    /// Takes note of a change from outside, such as a pull: what it added to the energies, or took, was put in.
    pub fn changed(&mut self, before: Energies, after: Energies) {
        if let Some(put_in) = &mut self.put_in {
            // What was dissipated since is gone, but an excess stays one.
            *put_in = put_in.min(before.total()) + after.total() - before.total();
            self.start += after.total() - before.total();
        }
        (self.kinetic_threshold, self.last) = (0.0, None);
    }

    /// Whether the kinetic energy after a step [J] asks for a look at all energies.
    pub fn exceeds_threshold(&self, kinetic: f64) -> bool {
        self.last.is_some() || kinetic > self.kinetic_threshold
    }

    /// The greatest kinetic energy that is not suspicious [J]; less than nothing if any is.
    pub const fn kinetic_threshold(&self) -> f64 {
        if self.last.is_some() { -1.0 } else { self.kinetic_threshold }
    }

    /// Judges a step by the energies after it, and those before it, if they are known.
    pub fn judge(&mut self, scene: &Scene, before: Option<Energies>, after: Energies) -> Verdict {
        let slack = negligible(scene);
        if self.put_in.is_some() && self.is_impossible(scene, after.total()) {
            return Verdict::Unstable;
        }
        let mechanical = after.kinetic + after.elastic;
        let available = self.put_in.unwrap_or(f64::INFINITY) - after.potential;
        if mechanical <= 2.0 * available.max(0.0) + slack {
            self.last = None;
            self.kinetic_threshold = 1.5 * after.kinetic + slack;
            return Verdict::Fine;
        }
        let known = before.map(|before| [before.kinetic + before.elastic, before.total()]).or(self.last);
        let Some([was, total]) = known else { return Verdict::Unknown };
        if after.total() - total > 0.08 * was + slack || after.total().is_nan() {
            return Verdict::Unstable;
        }
        self.last = Some([mechanical, after.total()]);
        Verdict::Fine
    }

    /// Takes shorter steps from now on, if it may. Returns whether it does.
    pub fn refine(&mut self) -> bool {
        (self.kinetic_threshold, self.last, self.stable_steps) = (0.0, None, 0);
        self.retry_after = self.retry_after.saturating_mul(2).clamp(Self::RETRY_STEPS[0], Self::RETRY_STEPS[1]);
        let may = self.level < Self::MOST;
        self.level += u32::from(may);
        may
    }

    /// Once more as short, after a length that held: just below the stability limit a scheme is stable, but its energy swings
    /// widely.
    pub fn refine_further(&mut self) {
        self.level = (self.level + 1).min(Self::MOST);
    }

    /// Takes energies for what they are: something supplied them.
    pub fn accept(&mut self, level: u32, energies: Energies) {
        self.restore_level(level);
        self.put_in = Some(energies.total());
    }

    /// Back to the length of steps there was.
    pub fn restore_level(&mut self, level: u32) {
        (self.level, self.kinetic_threshold, self.last) = (level, 0.0, None);
    }

    /// Books a step without trouble. Returns whether steps are longer from now on.
    pub fn record_stable_step(&mut self) -> bool {
        if self.level == 0 {
            return false;
        }
        self.stable_steps = self.stable_steps.saturating_add(1);
        let longer = self.stable_steps >= self.retry_after;
        if longer {
            (self.level, self.stable_steps) = (self.level - 1, 0);
        }
        longer
    }
}

impl From<&SavedGuard> for Guard {
    fn from(saved: &SavedGuard) -> Self {
        Self {
            put_in: Some(saved.supplied),
            start: saved.start,
            kinetic_threshold: saved.threshold,
            last: saved.last.map(|(mechanical, total)| [mechanical, total]),
            level: saved.level.min(Self::MOST),
            stable_steps: saved.quiet,
            retry_after: saved.retry,
        }
    }
}

/// An energy that is round-off to a scene [J].
pub(crate) fn negligible(scene: &Scene) -> f64 {
    1e-12 * scale(scene)
}

/// What the elements of a scene store at a stretch of one [J].
fn scale(scene: &Scene) -> f64 {
    let bodies = scene.bodies.iter().map(|body| body.elements.lame().mu * body.elements.rest_areas().sum::<f64>());
    let links = scene.nets.iter().flat_map(|net| net.springs.links());
    bodies.sum::<f64>() + links.map(|link| link.stiffness * link.rest * link.rest).sum::<f64>()
}
