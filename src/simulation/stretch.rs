//! Many steps of one body at a stretch.
//!
//! A stretch is walked without looking at the whole: who walks knows when the guard or the walls want a word, and stops there. What
//! is found then to be unsound is gone back from and stepped in the plain way, with all checkpoints on the way, so that it does not
//! matter how long stretches are, nor how many threads share them.

use super::{
    BATCH, Simulation,
    companion::Companion,
    system::{System, shrunk},
};
use crate::{
    elements::{Board, Caches, Looks, More, Outcome, Parts, Triangles, UniformForce, Walker, Way},
    integrators::{IntegratorKind, StepCounts},
};
use std::sync::Arc;

/// How many steps a stretch has at most: if the last one is found unsound all of them are taken again.
const LONGEST: u64 = 400 * BATCH;

/// No two checkpoints lie farther apart [steps].
pub(super) const MOST_BETWEEN: u64 = LONGEST + BATCH;

/// Those who step a body.
#[derive(Default)]
pub(super) struct Team {
    /// How many threads there may be.
    threads: usize,
    /// Those that steps are arranged for, if not [`Caches::here`].
    caches: Option<Caches>,
    /// One for each part, or for the whole.
    walkers: Vec<Walker>,
    /// Those who walk beside this thread, for the second and further parts.
    companions: Vec<Companion>,
    /// The revision of the simulation that they arrived at and what they knew then: while it is the same, they are where
    /// everything is.
    arrived: Option<(u64, Outcome)>,
    /// How many steps were taken at a stretch, and how many of them together.
    steps: [u64; 2],
    /// How many were under way at once in the last stretch.
    at_once: u32,
    /// Whether steps after the last checkpoint, and between that and the one before, were taken in a stretch.
    walked: [bool; 2],
    /// Up to this step nobody walks.
    plain_until: u64,
    /// The step that was just gone back to: the checkpoint there is as it was.
    seen: Option<u64>,
}

impl Team {
    /// Whether this is the step that was just gone back to.
    pub fn has_seen(&mut self, step: u64) -> bool {
        self.seen.take() == Some(step)
    }

    /// Everything was put somewhere else.
    pub const fn stand_anew(&mut self) {
        (self.plain_until, self.seen) = (0, None);
    }

    /// Calls companions, if there are too few of them for so many parts. Returns whether there are enough: where no thread is to be had
    /// they are not asked for again.
    fn is_complete(&mut self, parts: usize) -> bool {
        while self.companions.len() + 1 < parts {
            let Ok(companion) = Companion::new() else {
                self.threads = 1;
                return false;
            };
            self.companions.push(companion);
        }
        true
    }

    /// Whether the steps after the last checkpoint, and those between that and the one before, were taken in a stretch.
    pub const fn walked(&self) -> [bool; 2] {
        self.walked
    }

    /// Takes that, and the step that was just gone back to, from an earlier part of the run.
    pub const fn recall(&mut self, walked: [bool; 2], seen: Option<u64>) {
        (self.walked, self.seen) = (walked, seen);
    }

    /// Takes note of a checkpoint.
    pub const fn pass_checkpoint(&mut self) {
        self.walked = [false, self.walked[0]];
    }
}

impl Simulation {
    /// How many threads may step one large body together; the same bits come of any number. At first it is one, and more than two
    /// are not used.
    pub const fn set_threads(&mut self, threads: usize) {
        self.team.threads = threads;
    }

    /// Steps are arranged for caches of so many bytes, in place of this processor's; the same bits come of any.
    pub const fn set_caches(&mut self, caches: Caches) {
        self.team.caches = Some(caches);
    }

    /// How many steps several threads have taken together, tries included.
    pub const fn steps_together(&self) -> u64 {
        self.team.steps[1]
    }

    /// How many steps were taken at a stretch, without a look at the whole between them; tries included.
    pub const fn steps_at_a_stretch(&self) -> u64 {
        self.team.steps[0]
    }

    /// How many steps were under way at once in the last stretch; zero before the first.
    pub const fn steps_at_once(&self) -> u32 {
        self.team.at_once
    }

    /// The body that alone is to be moved, and what acts on it everywhere, if there is nothing else to do.
    fn only_work(&self) -> Option<(usize, Arc<Triangles>, UniformForce)> {
        let &[number] = self.scratch.plan.elements.as_slice() else { return None };
        let plain = matches!(self.scene.integrator, IntegratorKind::SymplecticEuler(_)) && !self.paces.differ();
        let free = self.scratch.plan.constraints.is_empty() || self.scratch.free.is_some();
        let body = self.scene.bodies.get(number).filter(|_| plain && free && self.guard.level() == 0)?;
        let motion = self.scene.motion(&self.state, self.grab);
        let uniform_force = self.scratch.uniform_force(&self.scene, motion)?;
        // What is not asked while nothing moves is asked from the next step on.
        let starts = self.scratch.plan.forces.iter().any(|number| self.scene.effects[*number].idle(motion).is_some())
            && motion.stillness().is_some();
        (!starts).then(|| (number, Arc::clone(&body.elements), uniform_force))
    }

    /// Takes a stretch of up to so many steps from a checkpoint, as long as there is `more` to do, if that is only to move the vertices of
    /// one body; nothing, if it is not. Returns how many were taken: zero if they were found unsound and gone back from, which may be to
    /// before they began.
    pub(super) fn stride(&mut self, most: u64, more: More<'_>) -> Option<u64> {
        if self.state.steps < self.team.plain_until {
            return None;
        }
        let (number, body, uniform_force) = self.only_work()?;
        let parts = if self.team.threads < 2 { None } else { body.parts() };
        let steps = most.min(LONGEST);
        let most_kinetic = if self.is_guarded() { self.guard.unsuspicious() } else { f64::INFINITY };
        if steps < BATCH || most_kinetic < 0.0 || !parts.is_none_or(|parts| self.team.is_complete(parts.count())) {
            return None;
        }
        if self.scratch.room < 0.0 {
            self.measure_room();
        }
        let known = self.team.arrived.filter(|(revision, _)| *revision == self.revision).map(|(_, known)| known);
        // An elastic and, maybe, a viscous one at each vertex.
        let (count, forces) = parts.map_or((1, 0), |parts| (parts.count(), 2 * parts.seam()));
        let way = Way {
            board: Arc::new(Board::new(count, forces, steps as u32)),
            steps: steps as u32,
            wave: self.team.caches.unwrap_or_else(Caches::here).steps_at_once(body.bytes()),
            step: self.scene.step,
            uniform_force,
            most_kinetic,
            looks: self.looks(number),
            start: Outcome { steps: 0, room: self.scratch.room, ..known.unwrap_or_default() },
            lightest: self.scratch.lightest,
            shrink: shrunk,
        };
        let outcome = self.walk((&body, parts), (&way, more), known.is_some());
        let (taken, looks) = (u64::from(outcome.steps), outcome.steps > way.looks.first);
        (self.scratch.kinetic, self.scratch.room) = (Some(outcome.kinetic), outcome.room);
        self.team.walked[0] = true;
        self.team.steps[0] += taken;
        self.team.at_once = way.wave;
        self.book_stretch(taken);
        self.team.arrived = Some((self.revision, outcome));
        if outcome.late || !self.is_sound() {
            return Some(self.step_plainly(taken));
        }
        if looks {
            self.book_looks();
        }
        Some(taken)
    }

    /// A stretch by a thread for each part, or by this one alone; the walkers may have arrived where everything is.
    fn walk(
        &mut self,
        (body, parts): (&Arc<Triangles>, Option<&Parts>),
        (way, more): (&Way, More<'_>),
        arrived: bool,
    ) -> Outcome {
        let Self { scene, state, scratch, team, checkpoint, .. } = self;
        let count = parts.map_or(1, Parts::count);
        let arrived = arrived && team.walkers.len() == count;
        if team.walkers.len() != count {
            team.walkers = (0..count).map(Walker::new).collect();
        }
        let inverse_mass = if scratch.held.is_empty() { &scene.inverse_mass } else { &scratch.held };
        if !arrived {
            let whole: [&[f64]; 4] = [&state.x, &state.v, &scene.mass, inverse_mass];
            team.walkers.iter_mut().for_each(|walker| walker.set_out(parts, whole));
        }
        let (own, others) = team.walkers.split_at_mut(1);
        for (walker, companion) in others.iter_mut().zip(&team.companions) {
            companion.send(walker, body, way);
        }
        for walker in own {
            body.walk(walker, parts, way, more);
        }
        for (walker, companion) in others.iter_mut().zip(&mut team.companions) {
            *walker = companion.receive();
        }
        // Of parts only those of one body arrive.
        if parts.is_none() || scene.bodies.len() + scene.nets.len() == 1 {
            checkpoint.take_over(state);
        } else {
            checkpoint.keep(state);
        }
        for walker in &team.walkers {
            walker.arrive(parts, [&mut state.x, &mut state.v]);
        }
        let outcome = team.walkers.first().map(|walker| walker.outcome).unwrap_or_default();
        if count > 1 {
            team.steps[1] += u64::from(outcome.steps);
        }
        outcome
    }

    /// After which of the next steps somebody looks who is calm, where only one body moves.
    fn looks(&self, number: usize) -> Looks {
        let every = self.islands.every();
        let [first, every] =
            [every - self.state.steps % every, every].map(|steps| steps.try_into().unwrap_or(u32::MAX));
        Looks { first, every, calm: self.calm_energy(number, self.scratch.reach) }
    }

    /// Books steps that were taken at a stretch.
    fn book_stretch(&mut self, taken: u64) {
        let Self { scene, state, scratch, grab, .. } = &mut *self;
        for _ in 0..taken {
            let mut system = System { scene, scratch, grab: *grab, time: [0.0; 2] };
            system.book_kick(&state.x, &state.v);
            if scratch.free.is_some() {
                scratch.pass_over_constraints();
            }
            scratch.counts.add(&StepCounts::ONE);
            state.time += scene.step;
        }
        scratch.book_steps(taken);
        state.steps += taken;
        self.revision += taken;
        self.shape += 1;
    }

    /// Whether the steps since the checkpoints that a failed step is taken again from were all taken in the plain way.
    pub(super) const fn was_plain(&self) -> bool {
        !(self.team.walked[0] || self.joined && self.team.walked[1])
    }

    /// After a stretch that was not sound: back as far as the guard may want to go, and on to the start of the stretch in the plain
    /// way, with everything that is done between single steps. The steps of the stretch are to be taken again.
    pub(super) fn step_plainly(&mut self, taken: u64) -> u64 {
        let (start, end) = (self.state.steps - taken, self.state.steps);
        if self.joined {
            std::mem::swap(&mut self.checkpoint, &mut self.older);
            self.joined = false;
        }
        self.scratch.free = None;
        self.guard = self.checkpoint.guard.clone();
        self.go_back_to(self.checkpoint.state.steps);
        (self.team.plain_until, self.team.seen, self.team.walked) = (end, Some(self.state.steps), [false; 2]);
        self.team.arrived = None;
        while self.state.steps < start && self.fault.is_none() {
            self.take_steps(1, &mut || true);
        }
        0
    }
}
