//! Mesh study: convergence of a quantity under refinement.

use super::{
    Limits, Measure, MeasuredOrder, NoOrder, Progress, Sample, Setting, Status, StudyError, Trial,
    march::{Deadline, March},
    measured_order,
    refine::with_triangles,
    repetition::Repetitions,
    setting::limit,
    statics,
    stopwatch::Stopwatch,
    threads,
    workers::spread,
};
use crate::{
    integrators::Class,
    level::{Level, Substeps},
    meshes::{Files, NoFiles},
    scene::Scene,
    state::State,
};
use std::{ops::ControlFlow, time::Duration};

/// When a quantity is taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MeshMoment {
    /// At rest under what acts; for levels that hold their bodies by pins.
    #[default]
    AtRest,
    /// At the end of the trial's time.
    AtTheEnd,
}

/// What to vary and what to compare.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshPlan {
    /// Numbers of triangles to aim for; if empty, 1/64, 1/16, 1/4 and 1 times the level's own, and 4 times as the reference.
    pub triangles: Vec<u32>,
    /// What is compared.
    pub measure: Measure,
    /// When it is taken.
    pub moment: MeshMoment,
    /// How many meshes are worked on at once. The results are the same for every number.
    pub threads: usize,
}

impl Default for MeshPlan {
    fn default() -> Self {
        let (measure, moment) = (Measure::default(), MeshMoment::default());
        Self { triangles: Vec::new(), measure, moment, threads: threads() }
    }
}

impl std::fmt::Display for MeshMoment {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        out.write_str(match self {
            Self::AtRest => "at rest",
            Self::AtTheEnd => "at the end of the simulated time",
        })
    }
}

/// One mesh and what came out of it.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshPoint {
    /// Number of triangles it has; before it is made, the number aimed for.
    pub triangles: usize,
    /// Number of vertices.
    pub vertices: usize,
    /// Size of its triangles: the square root of twice their mean area, the side of a cell of two [m].
    pub size: f64,
    /// The quantity; `None` as long as it is not known, or if it cannot be had.
    pub value: Option<f64>,
    /// How it ended; `Unconverged` if no position of rest was found.
    pub status: Status,
    /// Processor time of computing: to find the rest, or for a second of simulated time [ms]; the least of so many runs.
    pub ms: f64,
    /// How many runs that is the least of.
    pub runs: u32,
}

struct Slot {
    level: Level,
    point: MeshPoint,
    /// Greatest displacement of any vertex [m].
    moved: f64,
    run_state: RunState,
    /// Processor time of the first run.
    spent: Duration,
    /// What is run again.
    scene: Option<Box<Scene>>,
    /// Whether it is to be run once more in this round, and the run that does.
    due: bool,
    again: Option<Box<March>>,
}

enum RunState {
    Waiting,
    Marching(Box<March>),
    Over,
}

/// The study as a job.
pub struct MeshStudy {
    trial: Trial,
    plan: MeshPlan,
    /// Stability limit of the trial's own mesh, in steps a frame.
    limit: f64,
    /// From coarse to fine.
    slots: Vec<Slot>,
    repetitions: Repetitions,
    finished: bool,
}

/// What the values on meshes are compared with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshReference {
    /// The values on the three finest meshes, extrapolated to no size at all.
    pub value: f64,
    /// How far it may be off, as a share of it: how far it goes beyond the finest mesh.
    pub own_error: f64,
    /// The order p of the differences, which shrink as h^p.
    pub order: f64,
}

/// Orders with which values are extrapolated: linear triangles have 2, less beside corners.
const ORDERS: std::ops::RangeInclusive<f64> = 0.5..=2.5;

/// Why there is nothing to compare the values on meshes with.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NoMeshReference {
    /// The greatest displacement is zero or round-off.
    #[error("Nothing moves here, so there is nothing to compare: let something act, or begin with a stretch")]
    NothingMoves,
    /// The mesh does not matter.
    #[error("Every mesh gives the same number: it does not depend on the mesh here, as where pins prescribe it")]
    Same,
    /// Three are needed.
    #[error("No reference: fewer than three meshes have a value. Ask for more meshes")]
    TooFewMeshes,
    /// The differences of the three finest meshes do not shrink as they should.
    #[error(
        "No reference: the meshes' differences do not shrink as h^p with 0.5 <= p <= 2.5 ({}), so the values cannot be extrapolated \
         and no errors are given. Known is the value on the finest mesh, {finest:.6e}; the last refinement changed it by {:.2} %. The true \
         value may be much farther away: so it is where triangles lock, and where each mesh moves in its own way. Ask for finer meshes, \
         cross the diagonals of rectangles, or compare at a shorter time",
        shown(*.order),
        100.0 * last
    )]
    NotShrinking {
        /// The order that they show; nothing if they change sign.
        order: Option<f64>,
        /// The value on the finest mesh.
        finest: f64,
        /// What the last refinement changed, as a share of it.
        last: f64,
    },
}

fn shown(order: Option<f64>) -> String {
    order.map_or_else(|| "they change sign".to_owned(), |order| format!("here p = {order:.2}"))
}

impl MeshStudy {
    /// Prepares a study of a level from its start (not from a saved state, which belongs to one mesh).
    ///
    /// # Errors
    /// If the level cannot be built, has no mesh with a resolution, or does not say where it is held while a rest is asked for.
    pub fn new(level: &Level, files: &dyn Files, seconds: f64, plan: MeshPlan) -> Result<Self, StudyError> {
        let level = Level { state: None, ..level.clone() };
        let trial = Trial::new(&level, files, seconds)?;
        if plan.moment == MeshMoment::AtRest && trial.scene.pins.len() < 2 {
            return Err(StudyError::NotHere(
                "this level does not hold its bodies, so they do not come to rest: compare meshes at the end of some time",
            ));
        }
        let own = trial.scene.triangles.len() as f64;
        let mut wanted = plan.triangles.clone();
        if wanted.is_empty() {
            wanted.extend([1.0 / 64.0, 1.0 / 16.0, 0.25, 1.0, 4.0].map(|share| (own * share).round().max(1.0) as u32));
        }
        wanted.sort_unstable();
        let mut slots: Vec<Slot> = Vec::new();
        for triangles in wanted {
            let level = with_triangles(&level, f64::from(triangles) / own)?;
            // Two wishes for what is the same mesh are one.
            if slots.iter().all(|slot| slot.level.bodies != level.bodies) {
                let (triangles, status) = (triangles as usize, Status::Ok);
                let point = MeshPoint { triangles, vertices: 0, size: 0.0, value: None, status, ms: 0.0, runs: 0 };
                let (run_state, spent) = (RunState::Waiting, Duration::ZERO);
                slots.push(Slot { level, point, moved: 0.0, run_state, spent, scene: None, due: false, again: None });
            }
        }
        let limit = limit(&trial.scene, &trial.start);
        Ok(Self { trial, plan, limit, slots, repetitions: Repetitions::default(), finished: false })
    }

    /// The trial on the level's own mesh.
    pub const fn trial(&self) -> &Trial {
        &self.trial
    }

    /// What is varied and compared.
    pub const fn plan(&self) -> &MeshPlan {
        &self.plan
    }

    /// Works for about `budget`; making a mesh and finding a rest are done in one go.
    pub fn advance(&mut self, budget: Duration) -> Progress {
        let deadline = Deadline::after(budget);
        let Self { trial, plan, limit, slots, .. } = self;
        let open = slots.iter_mut().filter(|slot| !matches!(slot.run_state, RunState::Over)).collect();
        spread(plan.threads, open, |slot: &mut Slot| {
            slot.until(trial, plan, *limit, deadline);
            matches!(slot.run_state, RunState::Over) && !deadline.passed()
        });
        self.repeat(deadline);
        let weight = |slot: &Slot| libm::pow(slot.point.triangles as f64, 1.5);
        let done = |slot: &Slot| match &slot.run_state {
            RunState::Waiting => 0.0,
            RunState::Marching(march) => march.done(),
            RunState::Over => 1.0,
        };
        let total: f64 = self.slots.iter().map(weight).sum();
        let done = self.slots.iter().map(|slot| weight(slot) * done(slot)).sum::<f64>() / total.max(1.0);
        let done = (1.0 - REPEATED_SHARE) * done + REPEATED_SHARE * self.repetitions.done();
        Progress { done: if self.finished { 1.0 } else { done }, finished: self.finished }
    }

    /// Whether all meshes have run once.
    fn is_known(&self) -> bool {
        self.slots.iter().all(|slot| matches!(slot.run_state, RunState::Over))
    }

    /// Runs short runs again, in turns, once all have run: prices are the least of several.
    fn repeat(&mut self, deadline: Deadline) {
        while self.is_known() && !self.finished && !deadline.passed() {
            if self.slots.iter().all(|slot| !slot.due) {
                let cost = |slot: &Slot| slot.point.value.map(|_| slot.spent);
                let costs: Vec<_> = self.slots.iter().map(cost).collect();
                let chosen = self.repetitions.next(&costs, self.slots.iter().map(|slot| slot.spent).sum());
                self.finished = chosen.is_empty();
                for number in chosen {
                    self.slots[number].due = true;
                }
            }
            let Self { trial, plan, limit, slots, .. } = self;
            let due = slots.iter_mut().filter(|slot| slot.due).collect();
            spread(plan.threads, due, |slot: &mut Slot| {
                slot.again(trial, plan, *limit, deadline);
                !slot.due && !deadline.passed()
            });
        }
        if self.finished {
            self.slots.iter_mut().for_each(|slot| slot.scene = None);
        }
    }

    /// The meshes, from coarse to fine.
    pub fn points(&self) -> impl Iterator<Item = &MeshPoint> {
        self.slots.iter().map(|slot| &slot.point)
    }

    /// Whether a point is the level's own mesh.
    pub fn is_current(&self, point: &MeshPoint) -> bool {
        point.vertices == self.trial.start.x.len() / 2 && point.triangles == self.trial.scene.triangles.len()
    }

    /// What values are compared with: the values on the three finest meshes, extrapolated to no size at all with the order that their
    /// differences show; or why there is none. Known when all have run.
    pub fn reference(&self) -> Option<Result<MeshReference, NoMeshReference>> {
        self.is_known().then(|| self.extrapolate())
    }

    fn extrapolate(&self) -> Result<MeshReference, NoMeshReference> {
        let values: Vec<_> = self.slots.iter().filter_map(|slot| Some((slot.point.size, slot.point.value?))).collect();
        let extent = self.trial.scene.rest.iter().fold(0.0_f64, |greatest, x| greatest.max(x.abs()));
        let moved = self.slots.iter().map(|slot| slot.moved).fold(0.0, f64::max);
        if moved <= 1e-12 * extent {
            return if values.is_empty() {
                Err(NoMeshReference::TooFewMeshes)
            } else {
                Err(NoMeshReference::NothingMoves)
            };
        }
        let same = |(_, value): &(f64, f64)| (value - values[0].1).abs() <= ROUND_OFF * values[0].1.abs();
        if values.len() > 1 && values.iter().all(same) {
            return Err(NoMeshReference::Same);
        }
        let &[.., (h2, v2), (h1, v1), (h0, v0)] = values.as_slice() else { return Err(NoMeshReference::TooFewMeshes) };
        let shrinking = (v2 - v1) / (v1 - v0);
        let order = (shrinking > 0.0).then(|| order_of_differences([h0, h1, h2], shrinking));
        let Some(order) = order.filter(|order| ORDERS.contains(order)) else {
            let last = ((v0 - v1) / v0).abs();
            return Err(NoMeshReference::NotShrinking { order, finest: v0, last });
        };
        let beyond = (v0 - v1) / (libm::pow(h1 / h0, order) - 1.0);
        let value = v0 + beyond;
        Ok(MeshReference { value, own_error: (beyond / value).abs(), order })
    }

    /// Whether the values depend on the mesh. Known when all have run.
    pub fn is_telling(&self) -> bool {
        let nothing = |why: &NoMeshReference| matches!(why, NoMeshReference::NothingMoves | NoMeshReference::Same);
        self.reference().is_some_and(|reference| !reference.err().as_ref().is_some_and(nothing))
    }

    /// Relative error of the value on a mesh, if there is a reference.
    pub fn error_of(&self, point: &MeshPoint) -> Option<f64> {
        let reference = self.reference()?.ok()?.value;
        Some(((point.value? - reference) / reference).abs())
    }

    /// Measured order: how steeply the error falls with the size of the triangles, by [`measured_order`]. The finest mesh does not
    /// count: the reference was made from it.
    ///
    /// # Errors
    /// [`NoOrder`] says why none can be told.
    pub fn order(&self) -> MeasuredOrder {
        let reference = match self.reference() {
            Some(Ok(reference)) => reference,
            Some(Err(NoMeshReference::NothingMoves)) => return Err(NoOrder::NothingMoves),
            Some(Err(NoMeshReference::Same)) => return Err(NoOrder::RoundOff),
            Some(Err(NoMeshReference::TooFewMeshes)) => return Err(NoOrder::TooFewPoints),
            Some(Err(NoMeshReference::NotShrinking { .. })) | None => return Err(NoOrder::NoReference),
        };
        let sample = |point: &MeshPoint| Some(Sample { h: point.size, error: self.error_of(point)? });
        let mut samples: Vec<_> = self.points().filter_map(sample).collect();
        samples.pop();
        measured_order(samples, Limits { round_off: ROUND_OFF, reference: reference.own_error })
    }
}

/// Relative differences up to this come from solving equations and from rounding.
const ROUND_OFF: f64 = 1e-9;
/// About how large a share of the work repetitions are.
const REPEATED_SHARE: f64 = 0.2;

/// The p for which `(h2^p - h1^p) / (h1^p - h0^p)` is this much: exact for every ratio of sizes, found by halving.
fn order_of_differences([h0, h1, h2]: [f64; 3], shrinking: f64) -> f64 {
    let grown = |p: f64| (libm::pow(h2 / h0, p) - libm::pow(h1 / h0, p)) / (libm::pow(h1 / h0, p) - 1.0);
    // Never at 0, where nothing over nothing is left.
    let (mut low, mut high) = (-20.0, 21.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if grown(middle) < shrinking { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

impl Slot {
    fn until(&mut self, trial: &Trial, plan: &MeshPlan, limit: f64, deadline: Deadline) {
        if matches!(self.run_state, RunState::Waiting) {
            self.run_state = self.begin(trial, plan, limit);
        }
        let RunState::Marching(march) = &mut self.run_state else { return };
        if march.advance(deadline, &mut |_, _| ControlFlow::Continue(())) {
            let simulation = &march.simulation;
            (self.point.ms, self.point.runs, self.spent) = (march.ms_per_second(), 1, march.spent);
            if simulation.fault().is_some() {
                self.point.status = Status::Unstable;
            } else {
                let (scene, x) = (simulation.scene(), &simulation.state().x);
                self.point.value = Some(plan.measure.of(scene, x));
                self.moved = Measure::TipDeflection.of(scene, x);
                self.scene = Some(Box::new(scene.clone()));
            }
            self.run_state = RunState::Over;
        }
    }

    /// Makes the mesh; finds the rest, or gets ready to march.
    fn begin(&mut self, trial: &Trial, plan: &MeshPlan, own_limit: f64) -> RunState {
        // Files were read for the trial's own scene; what cannot be refined is taken from there.
        let built = Scene::build(&self.level, self.level.mode, &NoFiles, Some(&trial.scene));
        let Ok(scene) = built else {
            self.point.status = Status::Unconverged;
            return RunState::Over;
        };
        let count = scene.triangles.len();
        let area: f64 = scene.bodies.iter().flat_map(|body| body.elements.rest_areas()).sum();
        (self.point.triangles, self.point.vertices) = (count, scene.rest.len() / 2);
        self.point.size = (2.0 * area / count as f64).sqrt();
        if plan.moment == MeshMoment::AtTheEnd {
            return RunState::Marching(march(&scene, trial, own_limit));
        }
        let stopwatch = Stopwatch::start();
        let rest = statics::rest(&scene);
        self.spent = stopwatch.elapsed();
        (self.point.ms, self.point.runs) = (self.spent.as_secs_f64() * 1e3, 1);
        match rest {
            Some((x, counts)) if counts.unconverged == 0 => {
                self.point.value = Some(plan.measure.of(&scene, &x));
                self.moved = Measure::TipDeflection.of(&scene, &x);
                self.scene = Some(Box::new(scene));
            }
            _ => self.point.status = Status::Unconverged,
        }
        RunState::Over
    }

    /// Runs what has run before, for its price.
    fn again(&mut self, trial: &Trial, plan: &MeshPlan, own_limit: f64, deadline: Deadline) {
        let Some(scene) = self.scene.as_deref() else {
            self.due = false;
            return;
        };
        let ms = if plan.moment == MeshMoment::AtTheEnd {
            let march = self.again.get_or_insert_with(|| march(scene, trial, own_limit));
            if !march.repeat(deadline) {
                return;
            }
            march.ms_per_second()
        } else {
            let stopwatch = Stopwatch::start();
            statics::rest(scene);
            stopwatch.elapsed().as_secs_f64() * 1e3
        };
        self.point.ms = self.point.ms.min(ms);
        self.point.runs += 1;
        (self.due, self.again) = (false, None);
    }
}

/// A run of the trial on a mesh with another stability limit.
fn march(scene: &Scene, trial: &Trial, own_limit: f64) -> Box<March> {
    let state: &State = &scene.start;
    let setting = scaled(&trial.current, limit(scene, state) / own_limit);
    Box::new(March::new(scene, state, &setting, trial.frames))
}

/// The setting for a mesh that is stiffer by a factor: an explicit scheme keeps its distance from the stability limit.
fn scaled(setting: &Setting, factor: f64) -> Setting {
    let substeps = match setting.integrator.kind().class() {
        Class::Explicit => Substeps::nearest(f64::from(setting.substeps.get()) * factor),
        Class::Implicit | Class::ErrorControlled => setting.substeps,
    };
    Setting { substeps, ..setting.clone() }
}
