//! Guard: detects unstable steps by their energy.
//!
//! ```
//! use gingerbread::{files, levels, meshes::NoFiles, scene::Scene, simulation::Simulation, stability};
//!
//! let level = files::parse(levels::built_in("jelly_disk").ok_or("there is no such level")?, "jelly_disk.ron")?;
//! let scene = Scene::build(&level, level.mode, &NoFiles, None)?;
//! // Three times the longest stable step.
//! let step = 3.0 * stability::critical_step(&scene, &scene.start, None).ok_or("it has stiffness")?;
//! let state = scene.start.clone();
//! let mut simulation = Simulation::new(Scene { step, ..scene }, state);
//! simulation.advance(100, &mut || true);
//! assert!(simulation.fault().is_none() && simulation.guard_substeps() > 1, "steps are divided");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::{
    level::{SavedGuard, Substeps},
    report::Energies,
    scene::Scene,
};

/// Energy check of one run.
///
/// Between two changes from outside, nothing in a scene supplies energy: gravity and springs convert it, damping and
/// contact dissipate it. The mechanical energy M (kinetic, elastic) and the potential P satisfy M + P <= supplied
/// energy. A moving obstacle is external: its work on each vertex is added to the supplied energy, and so is that of a decreasing
/// initial penetration. Schemes have a bounded relative error even when they are stable
/// (symplectic Euler by up to h w / 2 of a vibration w), and explicit ones may drift slowly, which is a property to
/// show. So a step counts as unstable if M is above twice the available energy and M + P grew by 8 % of M in this one
/// step, as it does near and above the stability limit.
///
/// Slow growth adds up. Energy from nowhere is the rise of M + P, less what was supplied since, above its least value at
/// a check; so dissipated energy does not hide it. It may be no more than [`Self::EXCESS`] times the greatest energy
/// that was available since the last change from outside, and the energy that counts as round-off. A step beyond that counts as unstable however little
/// it adds. What contact stores is available. A stricter bound leaves it out, so that a small motion beside a great contact energy is watched too; it
/// counts what attempts found available that were taken back.
///
/// All energies cost as much as a step. They are computed when the kinetic energy, which is cheap, has grown by half
/// since the last check, and at the end of each frame of 1/60 s, where every state keeps the bound. Energy gained before
/// detection is only removed as far as the last 10 to 20 steps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Guard {
    /// Supplied energy so far \[J\]; computed when it is first needed.
    put_in: Option<f64>,
    /// Least M + P at a check, moved by energy supplied since \[J\].
    least: f64,
    /// Energy at the start, and changes from outside since \[J\].
    start: f64,
    /// Work of moving obstacles since the state was set \[J\].
    work: f64,
    /// Greatest supplied energy less the potential and that of contact since the last change from outside \[J\], in attempts that were taken back as well.
    reference: f64,
    /// Greatest supplied energy less the potential since then \[J\], in steps that were kept.
    available: f64,
    /// Kinetic energy up to which no check is made \[J\].
    kinetic_threshold: f64,
    /// Mechanical energy and total after the last step, while every step is checked \[J\].
    last: Option<[f64; 2]>,
    /// Refinement level: every step is divided into 2^level shorter ones.
    level: u32,
    /// Stable steps since the level was last raised.
    stable_steps: u32,
    /// Stable steps before longer steps are tried again; doubled whenever that failed.
    retry_after: u32,
    /// Steps in a row whose equations were left unsolved while triangles were inverted.
    unsolved: u32,
}

/// Result of the check of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Stable.
    Fine,
    /// Unexplained energy.
    Unstable,
    /// The energies before the step are needed.
    Unknown,
}

impl Guard {
    /// Greatest level: up to 2^6 = 64 shorter steps.
    pub const MOST: u32 = SavedGuard::MOST_LEVEL;

    /// Greatest level to which unsolved equations alone raise it.
    pub const UNSOLVED: u32 = 3;

    /// Greatest level for a step \[s\], which bounds the work; see [`Substeps::most_parts`].
    pub fn most_level(step: f64) -> u32 {
        let most = Substeps::most_parts(step);
        (1..=Self::MOST).take_while(|level| f64::from(1 << level) <= most).last().unwrap_or(0)
    }

    /// Steps in a row whose equations may be left unsolved while triangles are inverted. An inverted body that is approached from inside
    /// itself has no contact force there, so that no position without a crossing may solve them; and each such step takes every iteration
    /// of [`Newton`](crate::solvers::Newton::ITERATIONS).
    pub const UNSOLVED_STEPS: u32 = 8;

    /// Energy from nowhere that is allowed over a run, as a multiple of the available energy.
    pub const EXCESS: f64 = 1.5;

    /// Stable steps before longer steps are tried again, at first and at most.
    const RETRY_STEPS: [u32; 2] = [32, 2048];

    /// The guard for a level file, with the hash of its state; `None` before the first step, or if an energy is not
    /// finite.
    pub fn saved(&self, state: u64) -> Option<SavedGuard> {
        let (supplied, last) = (self.put_in?, self.last.map(|[mechanical, total]| (mechanical, total)));
        let (mechanical, total) = last.unwrap_or_default();
        let finite = [
            supplied,
            self.least,
            self.start,
            self.reference,
            self.available,
            self.kinetic_threshold,
            mechanical,
            total,
        ]
        .into_iter()
        .all(f64::is_finite);
        finite.then_some(SavedGuard {
            state,
            supplied,
            least: Some(self.least),
            start: self.start,
            reference: self.reference,
            available: Some(self.available),
            threshold: self.kinetic_threshold,
            last,
            level: self.level,
            quiet: self.stable_steps,
            retry: self.retry_after,
            unsolved: self.unsolved,
        })
    }

    /// Refinement level; a step is divided into 2^level shorter ones.
    pub const fn level(&self) -> u32 {
        self.level
    }

    /// Resets the guard after the state was set.
    pub fn reset(&mut self) {
        *self = Self::default();
    }

    /// Whether it needs the energies at the start.
    pub const fn is_new(&self) -> bool {
        self.put_in.is_none()
    }

    /// Sets the energies at the start.
    pub fn begin(&mut self, energies: Energies) {
        let total = energies.total();
        (self.put_in, self.least, self.start) = (Some(total), total, total);
    }

    /// Restores the supplied energy of an earlier moment.
    pub const fn restore_supplied(&mut self, earlier: &Self) {
        (self.put_in, self.least, self.work) = (earlier.put_in, earlier.least, earlier.work);
    }

    /// Keeps the least energy that was found before the last steps were replayed: a replay finds none between them. Obstacles may do other work in it.
    pub fn keep_least(&mut self, before: &Self) {
        self.least = self.least.min(before.least + self.work - before.work);
    }

    /// Restores the available energy of an earlier moment: what was available in steps that are taken back never was.
    pub const fn restore_available(&mut self, earlier: &Self) {
        self.available = earlier.available;
    }

    /// Work of moving obstacles since the state was set \[J\].
    pub const fn work(&self) -> f64 {
        self.work
    }

    /// Adds work of moving obstacles \[J\].
    pub fn supply(&mut self, work: f64) {
        self.work += work;
        self.least += work;
        if let Some(put_in) = &mut self.put_in {
            *put_in += work;
        }
    }

    /// Whether a scene can have supplied energy up to this total \[J\]: at most 100 times the energy of its elements at a
    /// strain of one, or the energy at the start.
    pub fn is_possible(&self, scene: &Scene, total: f64) -> bool {
        total <= 100.0 * scale(scene).max(self.start.abs())
    }

    /// Whether elements store more than anything can have supplied, even a fast obstacle. The apparent work of an obstacle
    /// on an exploding body is no work.
    pub fn is_impossible(&self, scene: &Scene, elastic: f64) -> bool {
        let scale = scale(scene);
        scale > 0.0 && elastic > 1e6 * scale.max(self.start.abs())
    }

    /// Adds the energy difference of a change from outside, such as a pull, to the supplied energy.
    pub fn changed(&mut self, before: Energies, after: Energies) {
        if let Some(put_in) = &mut self.put_in {
            // Dissipated energy is not available again, but an excess stays.
            let change = after.total() - before.total();
            *put_in = put_in.min(before.total()) + change;
            self.least = self.least.min(before.total()) + change;
            self.start += change;
        }
        (self.reference, self.available) = (0.0, 0.0);
        (self.kinetic_threshold, self.last) = (0.0, None);
    }

    /// Whether the kinetic energy after a step \[J\] requires a check of all energies.
    pub fn exceeds_threshold(&self, kinetic: f64) -> bool {
        self.last.is_some() || kinetic > self.kinetic_threshold
    }

    /// Checks a step by the energies after it, and those before it, if they are known.
    pub fn judge(&mut self, scene: &Scene, before: Option<Energies>, after: Energies) -> Verdict {
        let slack = negligible(scene);
        if self.put_in.is_some() && self.is_impossible(scene, after.elastic) || !self.keeps_bound(scene, after) {
            return Verdict::Unstable;
        }
        let mechanical = after.kinetic + after.elastic;
        let available = self.put_in.unwrap_or(f64::INFINITY) - after.external();
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

    /// Records energies. Returns whether energy from nowhere is within its bound; NaN is not.
    pub fn keeps_bound(&mut self, scene: &Scene, energies: Energies) -> bool {
        let (Some(put_in), total) = (self.put_in, energies.total()) else { return true };
        self.reference = self.reference.max(put_in - energies.external());
        self.available = self.available.max(put_in - energies.potential);
        let bound = Self::EXCESS * self.reference.min(self.available) + negligible(scene);
        let keeps = total - self.least <= bound;
        self.least = self.least.min(total);
        keeps
    }

    /// Raises the refinement level, at most to `most`. Returns whether it did.
    pub fn refine(&mut self, most: u32) -> bool {
        (self.kinetic_threshold, self.last, self.stable_steps) = (0.0, None, 0);
        self.retry_after = self.retry_after.saturating_mul(2).clamp(Self::RETRY_STEPS[0], Self::RETRY_STEPS[1]);
        let may = self.level < most;
        self.level += u32::from(may);
        may
    }

    /// Whether a step \[s\] whose equations were not solved is taken again in shorter ones: at most in [`Self::UNSOLVED`] halvings, as each attempt is
    /// costly. Beyond that it counts as any other step.
    pub fn divides_unsolved(&self, step: f64) -> bool {
        self.level < Self::UNSOLVED.min(Self::most_level(step))
    }

    /// Records whether the equations of a step were left unsolved while triangles were inverted. Returns whether stepping may go on.
    pub const fn record_unsolved(&mut self, unsolved: bool) -> bool {
        self.unsolved = if unsolved { self.unsolved.saturating_add(1) } else { 0 };
        self.unsolved < Self::UNSOLVED_STEPS
    }

    /// Raises the level once more after a stable length: just below the stability limit the energy of a scheme
    /// oscillates widely.
    pub fn refine_further(&mut self, most: u32) {
        self.level = (self.level + 1).min(most.max(self.level));
    }

    /// Accepts a gain as supplied by the scene \[J\], and goes back to the steps of an earlier moment.
    pub fn accept(&mut self, earlier: &Self, gain: f64) {
        self.restore_level(earlier.level);
        self.retry_after = earlier.retry_after;
        self.supply(gain);
    }

    /// Restores an earlier refinement level.
    pub fn restore_level(&mut self, level: u32) {
        (self.level, self.kinetic_threshold, self.last) = (level, 0.0, None);
    }

    /// Records a stable step. Returns whether the level was lowered.
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
            least: saved.least.unwrap_or(saved.supplied),
            start: saved.start,
            work: 0.0,
            reference: saved.reference,
            available: saved.available.unwrap_or(saved.reference),
            kinetic_threshold: saved.threshold,
            last: saved.last.map(|(mechanical, total)| [mechanical, total]),
            level: saved.level.min(Self::MOST),
            stable_steps: saved.quiet,
            retry_after: saved.retry,
            unsolved: saved.unsolved,
        }
    }
}

/// Energy that counts as round-off in a scene \[J\].
pub(crate) fn negligible(scene: &Scene) -> f64 {
    1e-12 * scale(scene)
}

/// Energy scale of the elements of a scene, at a strain of one \[J\].
fn scale(scene: &Scene) -> f64 {
    scene.parts.iter().map(|part| part.energy_scales()[0]).sum()
}
