//! Simulation: a scene with its state, steps, statistics, checkpoints and faults. No state that it returns contains NaN
//! or infinity.
//!
//! ```
//! use gingerbread::{files, levels, meshes::NoFiles, scene::Scene, simulation::Simulation};
//!
//! let level = files::parse(levels::built_in("chain").ok_or("there is no such level")?, "chain.ron")?;
//! let scene = Scene::build(&level, level.mode, &NoFiles, None)?;
//! let mut simulation = Simulation::open(scene, &level, level.mode)?;
//! let before = simulation.energies().total();
//! assert_eq!(simulation.advance(100, &mut || true), 100, "{:?}", simulation.fault());
//! assert!((simulation.energies().total() - before).abs() < 0.01 * before.abs().max(1.0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod checks;
mod contacts;
mod displacement_bound;
mod energies;
mod keep_apart;
mod multirate;
mod overlaps;
mod placed_check;
mod renaming;
mod replay;
mod restart;
mod script;
mod sleep;
mod sleeping_regions;
mod system;
mod work;

use crate::{
    effects::Grab,
    fault::Fault,
    guard::{Guard, Verdict},
    impulse::Impulse,
    integrators::{Class, MeanForces, Scheme, StepCounts},
    report::{Counts, EffectCost, Energies},
    scene::Scene,
    state::State,
};
use contacts::{contacts, surface_contact};
use energies::Elastic;
use multirate::Multirate;
use overlaps::Overlaps;
pub use placed_check::PlacedCheck;
use replay::Replay;
use restart::Checkpoint;
pub use restart::Restart;
use script::Script;
use sleep::Islands;
use sleeping_regions::Regions;
use std::cell::RefCell;
use system::{Scratch, System, ToySystem};

/// A running scene.
pub struct Simulation {
    scene: Scene,
    state: State,
    /// Checkpoint to return to when a step fails.
    checkpoint: Checkpoint,
    /// The checkpoint before, and whether only steps of one length lie between the two.
    older: Checkpoint,
    joined: bool,
    /// Whether something other than a step has changed the state since the checkpoint.
    stale: bool,
    scratch: Scratch,
    islands: Islands,
    regions: Regions,
    multirate: Multirate,
    grab: Option<Grab>,
    script: Option<Script>,
    replay: Replay,
    /// Known results of the level, and what was measured of them.
    checks: Vec<PlacedCheck>,
    measured_checks: Vec<Option<f64>>,
    guard: Guard,
    /// The earliest step that the guard went back to since the last call of [`Self::taken_back`].
    taken_back: Option<u64>,
    /// Least potential energy, less the work of obstacles, since the last call of [`Self::take_least_potential`] \[J\].
    least_potential: Option<f64>,
    fault: Option<Fault>,
    overlaps: Overlaps,
    /// Counts changes of the scene, the state, the pull, and steps.
    revision: u64,
    /// Whether the last step left equations unsolved.
    is_unsolved: bool,
    /// First step that is counted; earlier ones were counted before.
    first: u64,
    /// Step at the last call of [`Self::advance`]; a fault goes back no further.
    asked_at: u64,
    /// Counts changes of shapes and materials.
    shape: u64,
    elastic: RefCell<Elastic>,
}

/// Steps between two checkpoints, and between two calls of `more`.
const BATCH: u64 = 10;

impl Simulation {
    /// Makes a simulation of a scene in a state. The state must belong to the scene (see [`Scene::first_state`]);
    /// [`Self::open`] continues a saved one.
    pub fn new(scene: Scene, state: State) -> Self {
        let mut scratch = Scratch::default();
        scratch.fit(&scene);
        let state_steps = state.steps;
        let mut simulation = Self {
            checkpoint: Checkpoint::default(),
            older: Checkpoint::default(),
            joined: false,
            stale: true,
            islands: Islands::new(&scene),
            regions: Regions::new(&scene),
            multirate: Multirate::new(&scene),
            scene,
            state,
            scratch,
            grab: None,
            script: None,
            replay: Replay::default(),
            checks: Vec::new(),
            measured_checks: Vec::new(),
            guard: Guard::default(),
            taken_back: None,
            least_potential: None,
            fault: None,
            overlaps: Overlaps::default(),
            revision: 0,
            is_unsolved: false,
            first: state_steps,
            asked_at: state_steps,
            shape: 0,
            elastic: RefCell::default(),
        };
        simulation.apply_sleep();
        simulation.begin_contacts();
        simulation
    }

    /// Replaces the scene. The state stays, and newly pinned vertices stop. A scene with other vertices needs another
    /// state at once (see [`Self::set_state`]). Counts continue, and all bodies wake.
    pub fn replace_scene(&mut self, scene: Scene) {
        let before = self.watched().filter(|_| scene.start.x.len() == self.state.x.len());
        for (v, _) in self.state.v.iter_mut().zip(&scene.inverse_mass).filter(|(_, inverse)| **inverse == 0.0) {
            *v = 0.0;
        }
        if scene.start.x.len() == self.state.x.len() {
            scene.place_held(self.state.time, &mut self.state.x, &mut self.state.v);
        }
        self.rename_contacts(&scene);
        let paced = self.scene.step == scene.step;
        (self.scene, self.stale) = (scene, true);
        self.measured_checks.clear();
        // The memory of the integrator belongs to the old system.
        self.state.memory.clear();
        self.revision += 1;
        self.shape += 1;
        self.scratch.fit(&self.scene);
        (self.islands, self.regions) = (Islands::new(&self.scene), Regions::new(&self.scene));
        self.multirate = Multirate::new(&self.scene);
        self.wake_all(paced);
        self.begin_overlaps();
        if self.state.steps == 0 {
            self.state.anchors.clear();
        }
        self.find_initial_penetrations();
        match before {
            Some(before) if self.is_guarded() => self.guard.changed(before, self.energies()),
            _ => self.guard.reset(),
        }
    }

    /// Sets the state and resets the guard, the grab and the fault. Scripted actions before its time count as
    /// performed. See [`Self::resume`].
    pub fn set_state(&mut self, state: State) {
        (self.state, self.stale) = (state, true);
        self.first = self.state.steps;
        self.revision += 1;
        self.shape += 1;
        (self.scratch.clear_box, self.scratch.displacement_bound) = (None, -1.0);
        self.grab = None;
        self.guard.reset();
        (self.fault, self.taken_back, self.least_potential) = (None, None, None);
        self.seek();
        self.await_end();
        self.forget_later_checks();
        self.apply_sleep();
        self.begin_contacts();
    }

    /// Changes velocities at once. Bodies and nets that sleep wake up.
    pub fn give(&mut self, impulse: &Impulse) {
        let before = self.watched();
        impulse.give(&self.scene, &mut self.state);
        // The memory of the integrator belongs to the old velocities.
        self.state.memory.clear();
        self.stale = true;
        self.revision += 1;
        self.wake_all(false);
        if let Some(before) = before {
            self.guard.changed(before, self.energies());
        }
    }

    /// Sets or ends the pull of the mouse.
    pub fn set_grab(&mut self, grab: Option<Grab>) {
        if self.grab == grab {
            return;
        }
        let before = self.watched();
        (self.grab, self.stale) = (grab, true);
        self.revision += 1;
        if let Some(grab) = grab {
            self.wake(&[grab.vertex]);
        }
        if let Some(before) = before {
            self.guard.changed(before, self.energies());
        }
    }

    /// Whether the guard checks steps: those of every scheme, but not of toys.
    fn is_guarded(&self) -> bool {
        self.scene.guard && self.scene.toy.is_none()
    }

    /// Energies before a change from outside, if the guard needs them.
    fn watched(&self) -> Option<Energies> {
        (self.is_guarded() && !self.guard.is_new()).then(|| self.energies())
    }

    /// Revision number; changes with the scene, the state and the pull.
    pub const fn revision(&self) -> u64 {
        self.revision
    }

    /// The pull of the mouse.
    pub const fn grab(&self) -> Option<Grab> {
        self.grab
    }

    /// The scene.
    pub const fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The state.
    pub const fn state(&self) -> &State {
        &self.state
    }

    /// The fault that stopped stepping, if any.
    pub const fn fault(&self) -> Option<&Fault> {
        self.fault.as_ref()
    }

    /// The earliest step that the guard went back to since the last call; `None` if it did not.
    pub const fn taken_back(&mut self) -> Option<u64> {
        self.taken_back.take()
    }

    /// Least potential energy, less the [work of obstacles](Self::work_of_obstacles), at a check of the guard since the last call \[J\], in steps that
    /// were kept; `None` if there was no check.
    pub const fn take_least_potential(&mut self) -> Option<f64> {
        (self.checkpoint.least_potential, self.older.least_potential) = (None, None);
        self.least_potential.take()
    }

    /// Number of shorter steps that the guard takes for one now.
    pub const fn guard_substeps(&self) -> u32 {
        1 << self.guard.level()
    }

    /// Work of moving obstacles, moving pins, wind and rain, and of projection where it adds energy, since the state was set; an estimate \[J\].
    pub const fn work_of_obstacles(&self) -> f64 {
        self.guard.work()
    }

    /// Counts so far.
    pub const fn counts(&self) -> Counts {
        self.scratch.counts
    }

    /// Resets the counts.
    pub fn count_anew(&mut self) {
        for counts in [&mut self.scratch.counts, &mut self.checkpoint.counts, &mut self.older.counts] {
            *counts = Counts::default();
        }
        self.first = self.state.steps;
    }

    /// Cost of each effect so far.
    pub fn costs(&self) -> &[EffectCost] {
        &self.scratch.costs
    }

    /// Whether the time spent in each effect and the energy that it dissipates are measured. Damping then costs twice as much.
    pub fn set_measured(&mut self, measured: bool) {
        self.scratch.measured = measured;
    }

    /// Energy dissipated by damping, contact and friction, as far as it was [measured](Self::set_measured), and by truncation \[J\]. The energy
    /// and this, less the [work of obstacles](Self::work_of_obstacles), stay equal to the order of the scheme.
    pub fn heat(&self) -> f64 {
        self.costs().iter().map(|cost| cost.heat).sum::<f64>() + self.counts().truncated_energy
    }

    /// Takes up to `steps` steps and returns their number. Calls `more` every few steps and stops after it returns
    /// false; a few more steps may be taken then.
    ///
    /// Every step is checked. If one leaves NaN or infinity, or the [`Guard`] finds it unstable, the state before it is
    /// restored exactly. In a guarded scene the step is then taken in shorter ones; if that fails too, the fault is
    /// kept until the state is set anew. A guarded scene also stops after [`Guard::UNSOLVED_STEPS`] steps whose equations were not
    /// solved while triangles were inverted. Energies are checked at the end of each frame of 1/60 s, and within a frame where
    /// the kinetic energy has grown; see [`Self::check_energy`].
    ///
    /// Scripted actions are performed at their times, and the state is compared with the recorded one of the level; see
    /// [`Self::follow`] and [`Self::replayed`].
    pub fn advance(&mut self, steps: u64, more: &mut dyn FnMut() -> bool) -> u64 {
        let mut taken = 0;
        self.asked_at = self.state.steps;
        while taken < steps && self.fault.is_none() {
            self.perform_due(&mut |_, _| {});
            let next = [self.steps_to_action(), self.steps_to_end(), self.steps_to_check()].into_iter().flatten();
            let wanted = next.fold(steps - taken, u64::min);
            let done = self.advance_freely(wanted, more);
            if done > 0 {
                self.compare_end();
                self.measure_checks();
            }
            taken += done;
            if done < wanted || (taken < steps && !more()) {
                break;
            }
        }
        taken
    }

    /// Checks the energy of a state within a frame as at the end of one, and takes the last steps again if it breaks the
    /// bound of the [`Guard`].
    pub fn check_energy(&mut self) {
        if self.fault.is_none() && self.state.steps > self.asked_at && !self.keeps_bound() {
            self.retake();
        }
    }

    /// Takes steps without scripted actions.
    fn advance_freely(&mut self, steps: u64, more: &mut dyn FnMut() -> bool) -> u64 {
        // `more` is not called again after it returned false.
        let mut enough = false;
        let more = &mut || {
            enough = enough || !more();
            !enough
        };
        let (mut taken, mut asked, began) = (0, 0, self.state.steps);
        if self.is_guarded() && self.guard.is_new() && !self.is_asleep() {
            self.guard.begin(self.energies());
        }
        while taken < steps && self.fault.is_none() {
            if taken >= asked + BATCH {
                asked = taken;
                if !more() {
                    break;
                }
            }
            if self.is_asleep() {
                self.pass(steps - taken);
                return steps;
            }
            taken += u64::from(self.take_step());
        }
        // A fault may take back steps whose energy was not finite.
        if self.fault.is_some() { self.state.steps.saturating_sub(began) } else { taken }
    }

    /// Takes a step, or sets a fault. Returns whether it was taken.
    fn take_step(&mut self) -> bool {
        if self.stale || self.state.steps.is_multiple_of(BATCH) {
            // A checkpoint that a run continues from was set at this step already.
            if self.stale || self.checkpoint.state.steps != self.state.steps {
                self.count_slow_checks();
                self.set_checkpoint();
            }
            self.fall_asleep();
            if self.is_asleep() {
                self.pass(1);
                return true;
            }
            self.find_clear_box();
        }
        self.step();
        if !self.is_sound() {
            return self.retake();
        }
        let inverted = if self.is_unsolved && self.is_guarded() { self.count_inverted() } else { 0 };
        if !self.guard.record_unsolved(inverted > 0) {
            self.fault = Some(Fault::inverted(&self.scene, &self.state, inverted));
            return true;
        }
        self.wake_pressed();
        self.wake_beside();
        // Replay from the checkpoint needs all steps since then to have one length.
        self.stale |= self.guard.record_stable_step();
        true
    }

    /// Finds the initial penetrations of a state that no step led to. One that steps led to has the memory of its contacts.
    fn begin_contacts(&mut self) {
        if self.state.steps == 0 {
            self.state.anchors.clear();
            self.begin_overlaps();
        } else {
            self.resume_overlaps();
        }
        if self.state.steps == 0 || self.state.anchors.is_empty() {
            self.find_initial_penetrations();
        }
    }

    /// Completes the memory of contacts in a scene that no step led to: vertices in an obstacle get an initial penetration.
    fn find_initial_penetrations(&mut self) {
        if self.state.x.len() != self.scene.rest.len() {
            return;
        }
        let mut anchors = Vec::new();
        let motion = self.scene.motion(&self.state, self.grab);
        contacts(&self.scene).for_each(|contact| contact.add_penetrations(motion, &mut anchors));
        anchors.sort_unstable_by_key(|anchor| anchor.contact);
        anchors.dedup_by_key(|anchor| anchor.contact);
        self.state.anchors = anchors;
    }

    /// Number of boundary edges that cross each other, where contact has a potential, by an exact test: zero is a proof that
    /// none do.
    pub fn count_crossings(&self) -> Option<usize> {
        surface_contact(&self.scene).map(|contact| contact.count_crossings(&self.state.x))
    }

    /// Number of places where cloth in space has passed through itself or other cloth, by an exact test, where there is cloth; see
    /// [`ClothSurface::count_crossings`](crate::contact::ClothSurface::count_crossings).
    pub fn count_cloth_crossings(&self) -> Option<usize> {
        (self.scene.cloth.count() > 0).then(|| self.scene.cloth.count_crossings(&self.state.x))
    }

    /// Takes one step, divided as the guard requires.
    fn step(&mut self) {
        let parts = self.guard_substeps();
        let h = self.scene.step / f64::from(parts);
        let (start, end) = (self.state.time, self.state.time + self.scene.step);
        let unsolved = self.scratch.counts.unconverged;
        let at = |part: u32| if part == parts { end } else { start + f64::from(part) * h };
        for part in 0..parts {
            self.separate(h);
            self.integrate(h, [at(part), at(part + 1)]);
        }
        self.is_unsolved = self.scratch.counts.unconverged > unsolved;
        if self.state.steps >= self.first {
            self.scratch.count_steps(1);
            self.scratch.counts.guarded += u64::from(parts > 1);
            self.scratch.counts.pushed_out += u64::from(self.scratch.pushes_out);
        }
        self.state.steps += 1;
        self.revision += 1;
        self.shape += 1;
        self.state.time = end;
    }

    /// One step of the scheme, of length h, from one time to another \[s\].
    fn integrate(&mut self, h: f64, time: [f64; 2]) {
        (self.scratch.supplied, self.scratch.pushes_out, self.scratch.kinetic) = (0.0, false, None);
        if self.multirate.is_active() {
            return self.integrate_each(h, time);
        }
        let mut workspace = std::mem::take(&mut self.scratch.workspace);
        let integrator = self.scene.integrator.kind();
        let counts = match (&self.scene.toy, integrator.scheme()) {
            (Some(toy), Scheme::First(scheme)) => {
                let mut system = ToySystem { toy: toy.kind(), counts: &mut self.scratch.counts };
                scheme.step(&mut system, &mut self.state, &mut workspace, h)
            }
            // Scenes reject toys with such a scheme.
            (Some(_), Scheme::Second(_)) => StepCounts::ONE,
            (None, _) => {
                let acting = (&self.scene, self.regions.effects(&self.scene));
                let mut system = System::begin(acting, &mut self.scratch, self.grab, time, &mut self.state);
                let counts = integrator.step(&mut system, &mut self.state, &mut workspace, h);
                system.end(h, &mut self.state);
                counts
            }
        };
        self.scratch.workspace = workspace;
        self.scratch.reduce_displacement_bound(h);
        if self.scratch.clear_box.is_some() {
            self.scratch.pass_over_obstacles();
        }
        self.scratch.counts.add(&counts);
        self.guard.supply(self.scratch.supplied);
    }

    /// Whether the last step left finite numbers and no unexplained energy.
    fn is_sound(&mut self) -> bool {
        if !self.validates() {
            return false;
        }
        if !self.is_guarded() {
            return true;
        }
        // The rest of equations whose solution keeps the energy is energy from nowhere.
        let conserves = self.scene.integrator.kind().mean_forces() == MeanForces::All;
        if self.is_unsolved && conserves && self.guard.divides_unsolved(self.scene.step) {
            return false;
        }
        if !self.needs_energy_check() {
            return !self.ends_frame() || self.keeps_bound();
        }
        let after = self.checked_energies();
        let mut verdict = self.guard.judge(&self.scene, None, after);
        if verdict == Verdict::Unknown {
            let guard = self.guard.clone();
            self.go_back_to(self.state.steps - 1);
            let before = self.energies();
            self.step();
            self.guard.keep_least(&guard);
            verdict = self.guard.judge(&self.scene, Some(before), after);
        }
        verdict == Verdict::Fine
    }

    /// Number of inverted triangles of all bodies.
    fn count_inverted(&self) -> usize {
        self.scene.parts.iter().map(|part| part.inverted(&self.state.x)[0]).sum()
    }

    /// Whether a frame ends with the last step.
    fn ends_frame(&self) -> bool {
        self.state.steps.is_multiple_of(self.scene.steps_per_frame())
    }

    /// Whether the energy from nowhere is within its bound. After an implicit step that was checked.
    fn keeps_bound(&mut self) -> bool {
        if !self.is_guarded() || self.is_asleep() || self.scene.integrator.kind().class() == Class::Implicit {
            return true;
        }
        let energies = self.checked_energies();
        self.guard.keeps_bound(&self.scene, energies)
    }

    /// Energies for a check of the guard.
    fn checked_energies(&mut self) -> Energies {
        let energies = self.energies();
        let potential = energies.potential - self.guard.work();
        self.least_potential = Some(self.least_potential.map_or(potential, |least| least.min(potential)));
        energies
    }

    /// Goes back from a failed step, to the last step since `first` whose state may be kept: its energies are finite, and where the guard is on,
    /// possible and within its bound, as those of all steps since the checkpoint.
    fn go_back_from(&mut self, failed: u64, first: u64) {
        self.go_back_to(self.checkpoint.state.steps);
        let mut kept = first;
        while self.state.steps + 1 < failed {
            self.step();
            let energies = self.energies();
            let is_sound = |guard: &mut Guard| {
                !guard.is_impossible(&self.scene, energies.elastic) && guard.keeps_bound(&self.scene, energies)
            };
            if !energies.total().is_finite() || self.is_guarded() && !is_sound(&mut self.guard) {
                break;
            }
            kept = self.state.steps.max(first);
        }
        self.go_back_to(kept);
        self.guard.restore_available(&self.checkpoint.guard);
    }

    /// Whether the guard needs all energies. After an implicit step their cost is small, and its equations may have a
    /// distant solution, with a stretched shape that hardly moves.
    fn needs_energy_check(&self) -> bool {
        self.scene.integrator.kind().class() == Class::Implicit
            || self.guard.exceeds_threshold(self.scratch.kinetic.unwrap_or_else(|| self.kinetic_energy()))
    }

    /// Replays from the checkpoint to a failed step in shorter steps, as far as the guard allows; sets a fault just
    /// before the step if that fails. Returns whether the step was taken. Steps that an error-controlled scheme gave up are not divided: it
    /// has tried shorter ones itself.
    ///
    /// In the first steps of all, what the three shortest step lengths agree on was supplied by the start, such as by surfaces that begin
    /// exactly on each other. Later nothing can supply energy that is not in the account: there the agreement would only show that
    /// an error, such as a bead far off its wire, was made before.
    fn retake(&mut self) -> bool {
        let (failed, finite, earlier_guard) = (self.state.steps, self.state.is_finite(), self.guard.clone());
        self.scratch.clear_box = None;
        // Unexplained energy arose before it was detected.
        if finite && self.joined {
            std::mem::swap(&mut self.checkpoint, &mut self.older);
            self.joined = false;
        }
        let began = self.checkpoint.state.steps;
        let mut gains = vec![(failed, self.energies().total())];
        let most = Guard::most_level(self.multirate.shortest(self.scene.step));
        let gave_up = !finite && self.scene.integrator.kind().class() == Class::ErrorControlled;
        while self.is_guarded() && !gave_up && self.guard.refine(most) {
            self.go_back_to(began);
            self.guard.restore_available(&self.checkpoint.guard);
            self.least_potential = self.checkpoint.least_potential;
            self.taken_back = Some(self.taken_back.map_or(began, |earlier| earlier.min(began)));
            self.scratch.counts.retaken += failed - began;
            self.checkpoint.counts = self.scratch.counts;
            let start = self.energies().total();
            let mut sound = true;
            while sound && self.state.steps < failed {
                self.step();
                sound = self.is_sound();
            }
            if sound && self.keeps_bound() {
                self.guard.refine_further(most);
                self.stale = true;
                return true;
            }
            gains.push((self.state.steps, self.energies().total()));
            if began == 0
                && self.guard.level() == most
                && let [.., (a, x), (b, y), (c, z)] = gains[..]
                && (a, b) == (b, c)
                && (x - z).abs().max((y - z).abs()) < 0.2 * (z - start)
                && self.guard.is_possible(&self.scene, z)
            {
                self.guard.accept(&earlier_guard, z - start);
                self.stale = true;
                return true;
            }
        }
        let earlier = self.checkpoint.state.clone();
        // All steps since the checkpoint had one length.
        self.guard.restore_level(self.checkpoint.guard.level());
        self.guard.restore_available(&self.checkpoint.guard);
        self.least_potential = self.checkpoint.least_potential;
        self.go_back_to(failed - 1);
        // The cause shows just before the failed step.
        let step = self.multirate.shortest(self.scene.step);
        let fault = Fault::find(&self.scene, [&self.state, &earlier], self.grab, step, finite);
        self.go_back_from(failed, began.max(self.asked_at));
        self.fault = Some(Fault { step: self.state.steps + 1, time: self.state.time, ..fault });
        false
    }
}
