//! One large body, stepped by several threads.
//!
//! A stretch of steps is walked without looking at the whole: the walkers of the parts know when the guard or the walls want a
//! word, and stop there. What is found then to be unsound is gone back from and walked by one thread, with all checkpoints on the
//! way, so that it does not matter how many there were.

use super::{
    BATCH, Simulation,
    system::{System, shrunk},
};
use crate::{
    elements::{Everywhere, Triangles, Walker, Way},
    integrators::{IntegratorKind, StepCounts},
};
use std::sync::Arc;

/// How many triangles a stretch may step at most, and steps: who asks for them wants to be asked whether to go on.
const WORK: usize = 3_000_000;
const STEPS: u64 = 40 * BATCH;

/// Those who step a body together.
#[derive(Default)]
pub(super) struct Team {
    /// How many threads there may be.
    threads: usize,
    walkers: Vec<Walker>,
    /// The revision of the simulation that they arrived at: while it is the same, they are where everything is.
    arrived: Option<u64>,
    /// How many steps were taken together.
    steps: u64,
    /// Whether steps after the last checkpoint, and between that and the one before, were taken together.
    walked: [bool; 2],
    /// Up to this step one thread walks alone.
    alone_until: u64,
    /// Whether it has just gone back to a checkpoint, at which everything was looked at already.
    resumes: bool,
}

impl Team {
    /// Whether everything was looked at already where it has gone back to. Not twice.
    pub const fn resumes(&mut self) -> bool {
        std::mem::replace(&mut self.resumes, false)
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

    /// How many steps several threads have taken together, tries included.
    pub const fn steps_together(&self) -> u64 {
        self.team.steps
    }

    /// The body that alone is to be moved, and the acceleration that it is given [m/s²], if there is nothing else to do.
    fn shared_work(&self) -> Option<(Arc<Triangles>, [f64; 2])> {
        let &[number] = self.scratch.plan.elements.as_slice() else { return None };
        let plain = matches!(self.scene.integrator, IntegratorKind::SymplecticEuler(_)) && !self.paces.differ();
        let free = self.scratch.plan.constraints.is_empty() || self.scratch.free.is_some();
        let body = self.scene.bodies.get(number).filter(|_| plain && free && self.guard.level() == 0)?;
        let everywhere = self.scratch.everywhere(&self.scene, self.scene.motion(&self.state, self.grab))?;
        let alone = everywhere == Everywhere { field: everywhere.field, ..Everywhere::default() };
        alone.then(|| (Arc::clone(&body.elements), everywhere.field))
    }

    /// Takes a stretch of up to so many steps from a checkpoint with several threads, if that is worth it and nothing is to be done
    /// but to move the vertices. Returns how many were taken.
    pub(super) fn step_together(&mut self, most: u64) -> u64 {
        if self.team.threads < 2 || self.state.steps < self.team.alone_until {
            return 0;
        }
        let Some((body, field)) = self.shared_work() else { return 0 };
        let triangles = body.corners().len();
        let steps = most.min(STEPS).min((WORK / triangles.max(1)) as u64).min(self.until_look());
        let most_kinetic = if self.is_guarded() { self.guard.unsuspicious() } else { f64::INFINITY };
        let parts = body.parts();
        if steps < BATCH || most_kinetic < 0.0 || parts.count() < 2 {
            return 0;
        }
        if self.scratch.room < 0.0 {
            self.measure_room();
        }
        let mut walkers = std::mem::take(&mut self.team.walkers);
        if walkers.len() != parts.count() {
            walkers = (0..parts.count()).map(Walker::new).collect();
            self.team.arrived = None;
        }
        let arrived = self.team.arrived == Some(self.revision);
        let (h, lightest) = (self.scene.step, self.scratch.lightest);
        let way = Way {
            board: &parts.board(),
            steps: steps as u32,
            step: h,
            field,
            most_kinetic,
            room: self.scratch.room,
            shrink: &|room, kinetic| shrunk(room, kinetic, lightest, h),
        };
        let Self { scene, state, scratch, .. } = &mut *self;
        let inverse_mass = if scratch.held.is_empty() { &scene.inverse_mass } else { &scratch.held };
        let whole: [&[f64]; 4] = [&state.x, &state.v, &scene.mass, inverse_mass];
        let walk = |walker: &mut Walker| {
            if !arrived {
                walker.set_out(parts, whole);
            }
            body.walk(walker, &way);
        };
        std::thread::scope(|scope| {
            let mut walkers = walkers.iter_mut();
            let own = walkers.next();
            walkers.for_each(|walker| drop(scope.spawn(|| walk(walker))));
            own.map(walk);
        });
        for walker in &walkers {
            walker.arrive(parts, &mut state.x, &mut state.v);
        }
        let taken = walkers.first().map_or(0, |walker| {
            (scratch.kinetic, scratch.room) = (Some(walker.kinetic), walker.room);
            u64::from(walker.steps)
        });
        self.team.walkers = walkers;
        self.team.walked[0] = true;
        self.team.steps += taken;
        self.book_stretch(taken);
        self.team.arrived = Some(self.revision);
        if self.is_sound() { taken } else { self.walk_alone(taken) }
    }

    /// Steps until somebody looks who is calm.
    fn until_look(&self) -> u64 {
        let every = self.islands.every();
        every - self.state.steps % every
    }

    /// Books steps that were taken together.
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
        scratch.counts.steps += taken;
        state.steps += taken;
        self.revision += taken;
        self.shape += 1;
    }

    /// Whether the steps since the checkpoints that a failed step is taken again from were all taken alone.
    pub(super) const fn was_alone(&self) -> bool {
        !(self.team.walked[0] || self.joined && self.team.walked[1])
    }

    /// After a stretch that was not sound: back as far as the guard may want to go, and on to the start of the stretch alone, with
    /// everything that one thread does on its way. The steps of the stretch are to be taken again.
    pub(super) fn walk_alone(&mut self, taken: u64) -> u64 {
        let (start, end) = (self.state.steps - taken, self.state.steps);
        if self.joined {
            std::mem::swap(&mut self.checkpoint, &mut self.older);
            self.joined = false;
        }
        self.scratch.free = None;
        self.guard = self.checkpoint.guard.clone();
        self.go_back_to(self.checkpoint.state.steps);
        (self.team.alone_until, self.team.resumes, self.team.walked) = (end, true, [false; 2]);
        self.team.arrived = None;
        while self.state.steps < start && self.fault.is_none() {
            self.take_steps(1);
        }
        0
    }
}
