//! Sleep: the forces of a body or net at rest are not computed and its vertices stay in place, until something acts on
//! it. Those that press on each other sleep together and wake each other; all others sleep independently.
//!
//! L is the size of the body or net at rest, and tau = [`WINDOW`]. It falls asleep when
//!
//! 1. for tau no vertex has been faster than theta L / tau, at which it would move no farther than theta L;
//! 2. released from rest, with the reactions of walls and friction, its acceleration is no more than 2 theta L / tau²
//!    (root mean square over its mass), by which it would move no farther than theta L either;
//! 3. the net force on all its vertices is no more than [`BALANCE`] of the external forces: a body that begins to fall,
//!    however slowly, is not at rest.
//!
//! A body that has exploded ([`Scene::has_exploded`]) does not sleep, although walls may hold what is left of it.
//!
//! Neither limit is below round-off: a position of size X has an error of X 2^-52, which is a speed of that over h and,
//! with the fastest vibration that h resolves, w = 2/h, an acceleration of that times w².
//!
//! Velocities of a sleeping body are zero; its positions keep every bit, asleep and on waking.

use super::{BATCH, Simulation, contacts::surface_contact};
use crate::{effects::Motion, elements::ElasticElements, level::Sleep, scene::Scene, state::State};
use std::{ops::Range, sync::Arc};

/// tau: time below the sleep threshold before sleep \[s\].
pub(super) const WINDOW: f64 = 0.5;

/// theta: allowed displacement in that time, as a fraction of its size.
const THETA: f64 = 1e-4;

/// Net force that counts as zero, as a fraction of the external forces.
const BALANCE: f64 = 1e-3;

/// Rate of checks, if steps are short enough [1/s].
const CHECK_RATE: f64 = 120.0;

/// Value of [`State::slow_checks`](crate::state::State::slow_checks) of a sleeping body.
pub(super) const ASLEEP: u32 = u32::MAX;

/// A body or a net.
struct Island {
    vertices: Range<usize>,
    /// Its numbers in the state.
    numbers: Range<usize>,
    /// Diagonal of the box around it at rest \[m\].
    size: f64,
    /// Mass of its free coordinates \[kg\].
    mass: f64,
}

/// All bodies and nets, with the sleep parameters.
#[derive(Default)]
pub(super) struct Islands {
    all: Vec<Island>,
    /// Whether sleep is possible in this scene.
    possible: bool,
    /// Number of sleeping bodies and nets.
    asleep: usize,
    /// Steps between two checks.
    every: u64,
    /// Number of consecutive checks below the threshold before sleep.
    checks: u32,
    /// External forces.
    force: Vec<f64>,
}

impl Islands {
    /// Makes those of a scene, all awake.
    pub fn new(scene: &Scene) -> Self {
        let island = |part: &Arc<dyn ElasticElements>| {
            let vertices = part.vertices();
            let numbers = scene.numbers(&vertices);
            let masses = scene.mass[numbers.clone()].iter().zip(&scene.inverse_mass[numbers.clone()]);
            let mass = masses.filter(|(_, inverse)| **inverse != 0.0).map(|(mass, _)| mass).sum::<f64>();
            let mass = mass / scene.dimension as f64;
            Island { numbers, size: scene.size(&vertices), vertices, mass }
        };
        let every = BATCH * (1.0 / (CHECK_RATE * scene.step * BATCH as f64)).round().max(1.0) as u64;
        let checks = (WINDOW / (every as f64 * scene.step)).ceil() as u32 + 1;
        let is_steady = scene.effects.iter().all(|effect| effect.is_steady()) && !scene.couples_parts();
        let possible = scene.sleep != Sleep::Off && scene.toy.is_none() && is_steady;
        Self { all: scene.parts.iter().map(island).collect(), possible, asleep: 0, every, checks, force: Vec::new() }
    }
}

impl Island {
    /// Sleep threshold of the speed along an axis [m/s], at a distance from the origin \[m\] and with steps of length h
    /// \[s\].
    fn speed_threshold(&self, distance: f64, h: f64) -> f64 {
        (THETA * self.size / WINDOW).max(f64::EPSILON * distance / h)
    }
}

impl Simulation {
    /// Whether each body, and then each net, sleeps.
    pub fn sleeping(&self) -> impl Iterator<Item = bool> {
        let slow_checks = self.state.slow_checks.get(..self.islands.all.len()).filter(|_| self.islands.asleep > 0);
        slow_checks.unwrap_or_default().iter().map(|slow_checks| *slow_checks == ASLEEP)
    }

    /// Whether all bodies and nets sleep: steps then cost nothing and change nothing visible.
    pub const fn is_asleep(&self) -> bool {
        let count = self.islands.all.len();
        count > 0 && self.islands.asleep == count
    }

    /// Advances time by steps in which everything sleeps.
    pub(super) fn pass(&mut self, steps: u64) {
        for _ in 0..steps {
            self.state.time += self.scene.step;
        }
        self.state.steps += steps;
        self.revision += 1;
        self.scratch.counts.steps += steps;
        self.scratch.counts.slept += steps;
        for cost in &mut self.scratch.costs {
            cost.skipped += steps;
            cost.slept += steps;
            cost.idle = Some(EVERYTHING);
        }
        self.stale = true;
    }

    /// Updates sleep from the state, after it or the scene was changed.
    pub(super) fn apply_sleep(&mut self) {
        let Self { islands, regions, scene, state, scratch, .. } = self;
        if !islands.possible || state.slow_checks.len() != islands.all.len() + regions.count() {
            state.slow_checks.clear();
        }
        for number in 0..islands.all.len().min(state.slow_checks.len()) {
            if state.slow_checks[number] == ASLEEP && has_exploded(scene, number, state) {
                state.slow_checks[number] = 0;
            }
        }
        regions.update(scene, state);
        let asleep = islands.all.iter().zip(&state.slow_checks).map(|(_, slow_checks)| *slow_checks == ASLEEP);
        islands.asleep = asleep.clone().filter(|asleep| *asleep).count();
        scratch.set_sleeping(scene, regions.effects(scene), asleep.clone(), regions.asleep());
        for (island, _) in islands.all.iter().zip(asleep).filter(|(_, asleep)| *asleep) {
            scratch.constrain_sleeping(island.numbers.clone());
        }
        for region in regions.asleep() {
            scratch.constrain_sleeping(regions.numbers(*region));
        }
    }

    /// Wakes the bodies and nets of vertices; of a body with regions, those around them.
    pub(super) fn wake(&mut self, vertices: &[usize]) {
        for vertex in vertices {
            self.regions.wake_around(&mut self.state, *vertex);
            for (slow_checks, island) in self.state.slow_checks.iter_mut().zip(&self.islands.all) {
                if island.vertices.contains(vertex) {
                    *slow_checks = 0;
                }
            }
        }
        if self.islands.asleep > 0 || self.sleeping_regions()[0] > 0 {
            self.stale = true;
            self.apply_sleep();
        }
    }

    /// Wakes a body, with all its regions.
    pub(super) fn wake_whole(&mut self, body: usize) {
        self.regions.wake_all_of(&mut self.state, body);
        if let Some(slow_checks) = self.state.slow_checks.get_mut(body) {
            *slow_checks = 0;
        }
        self.wake(&[self.scene.bodies[body].vertices.start]);
    }

    /// Wakes all bodies and nets after a change. The counters of awake ones stay if `keep_counters` is set.
    pub(super) fn wake_all(&mut self, keep_counters: bool) {
        if !keep_counters {
            self.state.slow_checks.clear();
        }
        self.state
            .slow_checks
            .iter_mut()
            .filter(|slow_checks| **slow_checks == ASLEEP)
            .for_each(|slow_checks| *slow_checks = 0);
        self.apply_sleep();
    }

    /// Counts checks below the sleep threshold, if a check is due; to be called before the checkpoint of a step is set.
    pub(super) fn count_slow_checks(&mut self) {
        let islands = &self.islands;
        if !islands.possible || !self.state.steps.is_multiple_of(islands.every) {
            return;
        }
        self.state.slow_checks.resize(islands.all.len() + self.regions.count(), 0);
        let pulled = self.grab.map(|grab| grab.vertex);
        for (number, (slow_checks, island)) in self.state.slow_checks.iter_mut().zip(&islands.all).enumerate() {
            if *slow_checks == ASLEEP {
                continue;
            }
            let own = island.numbers.clone();
            let fastest = greatest(&self.state.v[own.clone()]);
            let h = self.multirate.step(number, self.scene.step);
            let slow = fastest <= island.speed_threshold(greatest(&self.state.x[own]), h);
            let is_released = pulled.is_none_or(|vertex| !island.vertices.contains(&vertex));
            *slow_checks = if slow && is_released { *slow_checks + 1 } else { 0 };
        }
        self.count_slow_regions();
    }

    /// Puts bodies and nets to sleep that were below the threshold for long enough and stay at rest when released; to
    /// be called after the checkpoint of a step was set.
    pub(super) fn fall_asleep(&mut self) {
        let checks = self.islands.checks;
        if !self.islands.possible || self.guard.level() > 0 {
            return;
        }
        if self.state.steps.is_multiple_of(self.islands.every) {
            self.regions_fall_asleep(checks);
        }
        let mut of_parts = self.state.slow_checks.iter().take(self.islands.all.len());
        if !of_parts.any(|slow_checks| *slow_checks >= checks && *slow_checks != ASLEEP) {
            return;
        }
        self.wake_regions_of_slow(checks);
        self.step_from_rest();
        let islands = std::mem::take(&mut self.islands.all);
        let rest: Vec<_> = islands
            .iter()
            .enumerate()
            .map(|(number, island)| {
                let slow_checks = self.checkpoint.state.slow_checks[number];
                let slow = slow_checks >= checks && slow_checks != ASLEEP;
                slow && !has_exploded(&self.scene, number, &self.checkpoint.state) && self.rests(number, island)
            })
            .collect();
        let (sleeps, waits) = self.all_pressing(rest);
        for (number, island) in islands.iter().enumerate() {
            let slow_checks = self.checkpoint.state.slow_checks[number];
            if slow_checks >= checks && slow_checks != ASLEEP && !waits[number] {
                self.checkpoint.state.slow_checks[number] = if sleeps[number] { ASLEEP } else { 0 };
                // Its regions have the same time to come to rest.
                self.regions.wake_all_of(&mut self.checkpoint.state, number);
                if sleeps[number] {
                    self.checkpoint.state.v[island.numbers.clone()].fill(0.0);
                    self.joined = false;
                }
            }
        }
        self.islands.all = islands;
        self.state.clone_from(&self.checkpoint.state);
        self.scratch.displacement_bound = -1.0;
        self.revision += 1;
        self.shape += 1;
        self.apply_sleep();
    }

    /// Of the bodies and nets that rest, those on which only such ones, and sleeping ones, press at the checkpoint; and those
    /// that wait for others, which are slow but not for long enough yet.
    fn all_pressing(&self, mut rest: Vec<bool>) -> (Vec<bool>, Vec<bool>) {
        let mut waits = vec![false; rest.len()];
        let Some(contact) = surface_contact(&self.scene) else { return (rest, waits) };
        let state = &self.checkpoint.state;
        let mut pressing = Vec::new();
        contact.each_pressing(self.scene.motion(state, self.grab), &mut |owners, vertices| {
            pressing.push((owners, self.regions.asleep_sides(&self.scene, &state.slow_checks, owners, vertices)));
        });
        let mut changes = true;
        while std::mem::take(&mut changes) {
            for ([a, b], [a_sleeps, b_sleeps]) in &pressing {
                for (one, other, sleeps) in [(*a, *b, *b_sleeps), (*b, *a, *a_sleeps)] {
                    if rest[one] && !rest[other] && !sleeps {
                        (rest[one], waits[one], changes) = (false, state.slow_checks[other] > 0, true);
                    }
                }
            }
        }
        (rest, waits)
    }

    /// Wakes sleeping bodies and nets on which others press.
    pub(super) fn wake_pressed(&mut self) {
        if self.islands.asleep == 0 || self.is_asleep() {
            return;
        }
        let Self { scratch, scene, state, grab, regions, .. } = self;
        let Some(contact) = surface_contact(scene) else { return };
        scratch.contacts.update(scene, &state.x);
        let motion = Motion { candidates: Some(&scratch.contacts.candidates), ..scene.motion(state, *grab) };
        let mut woken = Vec::new();
        contact.each_pressing(motion, &mut |owners, vertices| {
            let is_whole = |number: usize| state.slow_checks.get(number) == Some(&ASLEEP);
            let sides = regions.asleep_sides(scene, &state.slow_checks, owners, vertices);
            // A region wakes by what moves beside it.
            if matches!(sides, [true, false] | [false, true]) && owners.map(is_whole).contains(&true) {
                woken.extend(vertices.iter().map(|vertex| *vertex as usize));
            }
        });
        woken.sort_unstable();
        woken.dedup();
        if !woken.is_empty() {
            self.wake(&woken);
        }
    }

    /// Takes one step from rest, one substep of each body and net, and measures the external forces. Statistics are not
    /// changed; the state is that after the step.
    fn step_from_rest(&mut self) {
        let clear_box = self.scratch.clear_box.take();
        self.state.v.fill(0.0);
        let motion = self.scene.motion(&self.state, self.grab);
        self.islands.force.clear();
        self.islands.force.resize(self.state.x.len(), 0.0);
        for effect in &self.scene.effects[self.scene.element_count()..] {
            effect.force(motion, &mut self.scratch.effects[..effect.scratch()], &mut self.islands.force);
        }
        let guard = self.guard.clone();
        self.multirate.stop_early(true);
        self.step();
        self.multirate.stop_early(false);
        self.guard.restore_supplied(&guard);
        self.scratch.clear_box = clear_box;
        self.scratch.counts = self.checkpoint.counts;
        self.scratch.costs.clone_from(&self.checkpoint.costs);
    }

    /// Whether a body or net stays at rest after the step from rest.
    fn rests(&self, number: usize, island: &Island) -> bool {
        let own = island.numbers.clone();
        let h = self.multirate.step(number, self.scene.step);
        let (mass, inverse) = (&self.scene.mass, &self.scene.inverse_mass);
        let free = |number: &usize| inverse[*number] != 0.0;
        let acceleration = |number: usize| self.state.v[number] / h;
        let squares: f64 = own.clone().filter(free).map(|i| mass[i] * acceleration(i) * acceleration(i)).sum();
        let outside: f64 = own.clone().filter(free).map(|i| self.islands.force[i].abs()).sum();
        // Sum of the magnitudes of the coordinates of the net force.
        let along = |axis: usize| own.clone().skip(axis).step_by(self.scene.dimension).filter(free);
        let net_force: f64 = (0..self.scene.dimension)
            .map(|axis| along(axis).map(|i| mass[i] * acceleration(i)).sum::<f64>().abs())
            .sum();
        let round_off = f64::EPSILON * greatest(&self.state.x[own]) * 4.0 / (h * h);
        let limit = (2.0 * THETA * island.size / (WINDOW * WINDOW)).max(round_off);
        let balanced = outside == 0.0 || net_force <= (BALANCE * outside).max(island.mass * round_off);
        squares <= limit * limit * island.mass && balanced
    }
}

/// Whether a body or net has exploded in a state.
fn has_exploded(scene: &Scene, number: usize, state: &State) -> bool {
    let energy = scene.parts[number].energy(scene.motion(state, None));
    scene.has_exploded(number, energy, &state.x)
}

/// Reason for skipping all effects.
const EVERYTHING: &str = "everything sleeps";

/// Greatest magnitude; infinite if any value is NaN.
fn greatest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most: f64, value| if value.abs() <= most { most } else { value.abs().max(most) })
}
