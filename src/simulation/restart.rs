//! Restart data: everything that a run needs to continue bit for bit, and checkpoints to return to.

use super::{BATCH, PlacedCheck, Simulation};
use crate::{
    contact::{Anchor, ContactName},
    effects::Grab,
    guard::Guard,
    level::{Level, RunMode, SavedState},
    quantity::{Coordinate, Position, Reach, Time},
    report::{Counts, EffectCost},
    scene::{ActingEffect, Scene, SceneError},
    state::State,
};
use std::sync::Arc;

/// A moment of a run, with all that influences later steps.
///
/// The state alone is not enough: the [`Guard`] has the energy supplied so far, and a rejected step is replayed from
/// one of the last two checkpoints, up to 20 steps before. Both are part of the restart data. Without the guard, or
/// where the next step sets a checkpoint anyway, no checkpoints are kept.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Restart {
    /// Positions, velocities, time, memory of the integrator, and sleep counters.
    pub state: State,
    /// The pull of the mouse.
    grab: Option<Grab>,
    guard: Guard,
    /// Checkpoints, the latest first: at most two.
    checkpoints: Vec<Earlier>,
    /// The effects that acted, by which its contacts are named; `None` if they are those of any scene that it is for.
    acting: Option<Arc<Vec<ActingEffect>>>,
}

/// A checkpoint of a [`Restart`].
#[derive(Clone, Debug, Default, PartialEq)]
struct Earlier {
    state: State,
    guard: Guard,
}

impl Restart {
    /// Reads the saved state of a level, or the start.
    ///
    /// # Errors
    /// [`SceneError::State`] if what was saved belongs to other meshes.
    pub fn read(scene: &Scene, saved: Option<&SavedState>) -> Result<Self, SceneError> {
        let mut restart = Self::from(scene.first_state(saved)?);
        let Some(saved) = saved else { return Ok(restart) };
        restart.grab = saved.pulled.and_then(|(vertex, target)| {
            Some(Grab { vertex: scene.unlisted_vertex(vertex as usize)?, target: target.get() })
        });
        let Some(account) = saved.guard.as_ref().filter(|account| account.state == hash(saved)) else {
            return Ok(restart);
        };
        restart.guard = Guard::from(account);
        let mut last = saved.steps;
        for checkpoint in &saved.checkpoints {
            // Steps are replayed from it, so it lies at most `BATCH` steps before the next one and never after it.
            if checkpoint.steps > last || last - checkpoint.steps > BATCH {
                restart.checkpoints.clear();
                break;
            }
            last = checkpoint.steps;
            let state = scene.first_state(Some(checkpoint))?;
            let guard = checkpoint.guard.as_ref().map(Guard::from).unwrap_or_default();
            restart.checkpoints.push(Earlier { state, guard });
        }
        Ok(restart)
    }

    /// The pull of the mouse.
    pub const fn grab(&self) -> Option<Grab> {
        self.grab
    }

    /// Number of floating-point numbers.
    pub fn len(&self) -> usize {
        let states = self.checkpoints.iter().map(|earlier| &earlier.state).chain([&self.state]);
        states.map(|state| state.x.len() + state.v.len() + state.memory.len() + state.calm_positions.len()).sum()
    }

    /// Whether it is empty: not taken from a run yet.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

impl From<State> for Restart {
    /// Restart data without history.
    fn from(state: State) -> Self {
        Self { state, ..Self::default() }
    }
}

impl Simulation {
    /// Opens the scene of a level, built for a mode, in its saved state or at the start; it continues as if it had not
    /// been saved.
    ///
    /// # Errors
    /// [`SceneError::State`] if what was saved belongs to other meshes, and [`SceneError::Check`] if a known result cannot be measured.
    pub fn open(scene: Scene, level: &Level, mode: RunMode) -> Result<Self, SceneError> {
        let restart = Restart::read(&scene, level.state.as_ref())?;
        PlacedCheck::all(level, &scene)?;
        let mut simulation = Self::new(scene, State::default());
        simulation.follow(level, mode);
        simulation.resume(&restart);
        Ok(simulation)
    }

    /// Restart data of the present moment.
    pub fn restart(&self) -> Restart {
        let mut restart = Restart::default();
        self.write_restart(&mut restart);
        restart
    }

    /// Writes restart data into existing buffers.
    pub fn write_restart(&self, restart: &mut Restart) {
        restart.state.clone_from(&self.state);
        restart.acting = Some(Arc::clone(&self.scene.acting));
        (restart.grab, restart.guard) = (self.grab, self.guard.clone());
        let kept = if self.stale || !self.is_guarded() {
            0
        } else {
            // The next checkpoint replaces the older of the two.
            let is_due = self.state.steps.is_multiple_of(BATCH) && self.checkpoint.state.steps < self.state.steps;
            1 + usize::from(self.joined && !is_due)
        };
        restart.checkpoints.resize_with(kept, Earlier::default);
        for (earlier, checkpoint) in restart.checkpoints.iter_mut().zip([&self.checkpoint, &self.older]) {
            earlier.state.clone_from(&checkpoint.state);
            earlier.guard.clone_from(&checkpoint.guard);
        }
    }

    /// Continues from restart data of this scene; clears the fault.
    pub fn resume(&mut self, from: &Restart) {
        // With other effects or obstacles contacts have other names: they begin anew.
        let is_same = from.acting.as_ref().is_none_or(|acting| *acting == self.scene.acting);
        let mut state = from.state.clone();
        if !is_same {
            state.anchors.clear();
        }
        self.set_state(state);
        // Without a saved pull, that of scripted actions at this time applies.
        (self.grab, self.guard) = (from.grab.or(self.grab), from.guard.clone());
        let listed = self.state.slow_checks.len();
        let mut both = from.checkpoints.iter().filter(|_| is_same).map(|earlier| {
            let Earlier { mut state, guard } = earlier.clone();
            if state.slow_checks.len() != listed {
                (state.slow_checks, state.calm_positions) = (Vec::new(), Vec::new());
            }
            Checkpoint::new(state, guard, (self.scratch.counts, &self.scratch.costs))
        });
        if let Some(latest) = both.next() {
            let older = both.next();
            self.joined = older.is_some();
            (self.checkpoint, self.older) = (latest, older.unwrap_or_default());
            self.stale = false;
        }
    }

    /// The present moment for a level file, without a pull except that of scripted actions; `None` if it is not finite.
    pub fn saved(&self) -> Option<SavedState> {
        let mut restart = self.restart();
        if restart.grab.is_some() && !self.is_scripted() && self.is_guarded() {
            restart.guard.changed(self.energies(), self.energies_with(None));
            restart.checkpoints.clear();
        }
        let mut saved = self.saved_state(&restart.state)?;
        saved.pulled = self.scripted_pull();
        if self.is_guarded() && !restart.guard.is_new() {
            saved.guard = restart.guard.saved(hash(&saved));
            for earlier in &restart.checkpoints {
                let guard = earlier.guard.saved(0);
                saved.checkpoints.push(SavedState { guard, ..self.saved_state(&earlier.state)? });
            }
        }
        Some(saved)
    }

    /// A state for a level file, without guard and checkpoints; `None` if it is not finite.
    fn saved_state(&self, state: &State) -> Option<SavedState> {
        let points =
            |flat: &[f64]| flat.chunks_exact(self.scene.dimension).map(Position::new).collect::<Option<Vec<_>>>();
        let state = self.scene.listed_state(state);
        let anchor = |anchor: &Anchor| {
            let ContactName { effect, surface, vertex } = anchor.contact;
            let point = Position::new(&anchor.point[..self.scene.dimension])?;
            Some(((effect, surface, vertex), point, Reach::new(anchor.penetration).ok()?))
        };
        Some(SavedState {
            anchors: state.anchors.iter().map(anchor).collect::<Option<_>>()?,
            calm: state.slow_checks.clone(),
            calm_positions: points(&state.calm_positions)?,
            memory: state.memory.iter().map(|number| Coordinate::new(*number).ok()).collect::<Option<_>>()?,
            ..SavedState::new((state.steps, Time::new(state.time).ok()?), points(&state.x)?, points(&state.v)?)
        })
    }
}

/// Hash of saved positions and velocities: saved guard data do not apply to an edited state.
fn hash(saved: &SavedState) -> u64 {
    let flat = |points: &[Position]| points.iter().flat_map(|point| point.coordinates()).collect();
    State { x: flat(&saved.positions), v: flat(&saved.velocities), ..State::default() }.hash()
}

/// A checkpoint.
#[derive(Clone, Default)]
pub(super) struct Checkpoint {
    pub state: State,
    /// Counts and costs at that moment.
    pub counts: Counts,
    pub costs: Vec<EffectCost>,
    /// The guard at that moment.
    pub guard: Guard,
    /// What [`Simulation::take_least_potential`] would have given then.
    pub least_potential: Option<f64>,
}

impl Checkpoint {
    /// Makes a checkpoint of an earlier part of the run, with the given counts and costs.
    pub fn new(state: State, guard: Guard, (counts, costs): (Counts, &[EffectCost])) -> Self {
        Self { state, counts, costs: costs.to_vec(), guard, least_potential: None }
    }
}

impl Simulation {
    /// Sets a checkpoint at the present state.
    pub(super) fn set_checkpoint(&mut self) {
        std::mem::swap(&mut self.checkpoint, &mut self.older);
        self.joined = !std::mem::take(&mut self.stale);
        self.checkpoint.state.clone_from(&self.state);
        self.checkpoint.counts = self.scratch.counts;
        self.checkpoint.costs.clone_from(&self.scratch.costs);
        self.checkpoint.guard = self.guard.clone();
        self.checkpoint.least_potential = self.least_potential;
    }

    /// Returns to a step since the checkpoint by replay: the same steps give the same bits.
    pub(super) fn go_back_to(&mut self, step: u64) {
        let slept = std::mem::take(&mut self.state.slow_checks);
        self.state.clone_from(&self.checkpoint.state);
        if self.state.slow_checks != slept {
            self.apply_sleep();
        }
        self.shape += 1;
        self.scratch.counts = self.checkpoint.counts;
        self.scratch.costs.clone_from(&self.checkpoint.costs);
        self.guard.restore_supplied(&self.checkpoint.guard);
        self.scratch.workspace.forget();
        self.scratch.displacement_bound = -1.0;
        self.return_to_overlaps();
        while self.state.steps < step {
            self.step();
        }
    }
}
