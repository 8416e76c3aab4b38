//! Energy account of a run.

use crate::{
    guard::{Guard, negligible},
    report::Energies,
    scene::Scene,
    simulation::Simulation,
};
use std::collections::VecDeque;

/// Records that are remembered: more than the steps that a guard takes back at once.
const REMEMBERED: usize = 64;

/// Energy account of a run.
///
/// With the mechanical energy M (with that of contact), the potential P and the work W done from outside (mouse, moved pins, moving obstacles,
/// reversed gravity), `A = M + P - W` never increases: gravity and springs convert energy, damping and contact dissipate
/// it. Energy from nowhere is the rise of A above its least value so far, so that energy which was dissipated cannot hide
/// it. It is stated as a share of the energy put in, the greatest M that start and work allow: `M0 + P0 + W - P`. With e, the energy that counts as
/// round-off, and [`Guard::EXCESS`] x, it is the rise over that plus e/x, and at least e: what the guard allows, x times the energy put in and e, is a
/// share of x then.
#[derive(Clone, Debug)]
pub struct Account {
    /// M + P at the start \[J\].
    start: f64,
    /// W \[J\].
    work: f64,
    /// Least A so far \[J\].
    least: f64,
    /// Numbers of the last steps that were recorded, and the least A before each \[J\].
    recent: VecDeque<(u64, f64)>,
    /// Energy that counts as round-off \[J\].
    negligible: f64,
    /// Energy put in \[J\]; zero if none was.
    put_in: f64,
    gain: f64,
}

impl Account {
    /// Opens the account of a scene with its energies.
    pub fn new(scene: &Scene, energies: Energies) -> Self {
        let (start, negligible) = (energies.total(), negligible(scene));
        let recent = VecDeque::new();
        let mut account = Self { start, work: 0.0, least: start, recent, negligible, put_in: 0.0, gain: 0.0 };
        account.record(energies);
        account
    }

    /// Records a change from outside.
    pub fn changed(&mut self, before: Energies, after: Energies) {
        self.record(before);
        self.work += after.total() - before.total();
        self.record(after);
    }

    /// Adds work of moving obstacles \[J\].
    pub fn supply(&mut self, work: f64) {
        self.work += work;
    }

    /// Records the energies of a simulation after steps. States that its guard went back before since the last call no longer count for the
    /// least energy: what was lost in them alone is still there in the steps that replaced them. What start and work allowed at a check
    /// of the guard since then counts as put in.
    pub fn record_steps(&mut self, simulation: &mut Simulation) {
        let taken_back = simulation.taken_back().unwrap_or(u64::MAX);
        while let Some((_, least)) = self.recent.pop_back_if(|(step, _)| *step > taken_back) {
            self.least = least;
        }
        if let Some(potential) = simulation.take_least_potential() {
            let changes = self.work - simulation.work_of_obstacles();
            self.put_in = self.put_in.max(self.start + changes - potential);
        }
        self.recent.push_back((simulation.state().steps, self.least));
        if self.recent.len() > REMEMBERED {
            self.recent.pop_front();
        }
        self.record(simulation.energies());
    }

    /// Records the present energies.
    pub fn record(&mut self, energies: Energies) {
        self.put_in = self.put_in.max(self.start + self.work - energies.potential);
        let balance = energies.total() - self.work;
        let rise = balance - self.least;
        // Where nothing rises, there may be no energy put in.
        let gain =
            if rise <= 0.0 { 0.0 } else { rise / (self.put_in + self.negligible / Guard::EXCESS).max(self.negligible) };
        // NaN counts as an infinite gain.
        self.gain = if gain.is_nan() { f64::INFINITY } else { self.gain.max(gain) };
        self.least = self.least.min(balance);
    }

    /// Greatest energy from nowhere, as a share of the energy put in.
    pub const fn gain(&self) -> f64 {
        self.gain
    }

    /// Energy put in \[J\].
    pub const fn put_in(&self) -> f64 {
        self.put_in.max(self.negligible)
    }
}
