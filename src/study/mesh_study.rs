//! The price of spatial accuracy: a quantity on coarser and finer meshes of the same level.

use super::{
    Measure, Progress, Setting, Status, StudyError, Trial,
    fit::steady_slope,
    march::{Deadline, March},
    refine::with_triangles,
    setting::limit,
    statics, threads,
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
use web_time::Instant;

/// Time that is enough to measure what finding a rest takes.
const ENOUGH: Duration = Duration::from_millis(20);

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
    /// Time of computing: to find the rest, or for a second of simulated time [ms].
    pub ms: f64,
}

struct Slot {
    level: Level,
    point: MeshPoint,
    /// Greatest displacement of any vertex [m].
    moved: f64,
    work: Work,
}

enum Work {
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
                let point = MeshPoint { triangles, vertices: 0, size: 0.0, value: None, status, ms: 0.0 };
                slots.push(Slot { level, point, moved: 0.0, work: Work::Waiting });
            }
        }
        let limit = limit(&trial.scene, &trial.start);
        Ok(Self { trial, plan, limit, slots })
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
        let Self { trial, plan, limit, slots } = self;
        let open = slots.iter_mut().filter(|slot| !matches!(slot.work, Work::Over)).collect();
        spread(plan.threads, open, |slot: &mut Slot| {
            slot.until(trial, plan, *limit, deadline);
            matches!(slot.work, Work::Over) && !deadline.passed()
        });
        let weight = |slot: &Slot| libm::pow(slot.point.triangles as f64, 1.5);
        let done = |slot: &Slot| match &slot.work {
            Work::Waiting => 0.0,
            Work::Marching(march) => march.done(),
            Work::Over => 1.0,
        };
        let total: f64 = self.slots.iter().map(weight).sum();
        let finished = self.slots.iter().all(|slot| matches!(slot.work, Work::Over));
        let done = self.slots.iter().map(|slot| weight(slot) * done(slot)).sum::<f64>() / total.max(1.0);
        Progress { done: if finished { 1.0 } else { done }, finished }
    }

    /// The meshes, from coarse to fine.
    pub fn points(&self) -> impl Iterator<Item = &MeshPoint> {
        self.slots.iter().map(|slot| &slot.point)
    }

    /// Whether a point is the level's own mesh.
    pub fn is_current(&self, point: &MeshPoint) -> bool {
        point.vertices == self.trial.start.x.len() / 2 && point.triangles == self.trial.scene.triangles.len()
    }

    /// Why the values tell nothing about meshes, in words; known when all is done.
    pub fn remark(&self) -> Option<&'static str> {
        if !self.slots.iter().all(|slot| matches!(slot.work, Work::Over)) {
            return None;
        }
        let mut known = self.slots.iter().filter_map(|slot| Some((slot.moved, slot.point.value?)));
        let (_, first) = known.clone().next()?;
        if known.clone().all(|(moved, _)| moved < 1e-12) {
            Some("Nothing moves here, so there is nothing to compare: let something act, or begin with a stretch.")
        } else if known.all(|(_, value)| (value - first).abs() <= 1e-9 * first.abs()) {
            Some("Every mesh gives the same number: it does not depend on the mesh here, as where pins prescribe it.")
        } else {
            None
        }
    }

    /// What values are compared with, and how far it may be off: the values on the three finest meshes, extrapolated to no
    /// size at all with the order that they show (between 0.5 and 3, else 2), and how far that goes beyond the finest. Known when all is done.
    pub fn reference(&self) -> Option<(f64, f64)> {
        if !self.slots.iter().all(|slot| matches!(slot.work, Work::Over)) || self.remark().is_some() {
            return None;
        }
        let known: Vec<_> = self.points().filter_map(|point| Some((point.size, point.value?))).collect();
        let &[.., (h1, v1), (h0, v0)] = known.as_slice() else { return None };
        let shown = match known.as_slice() {
            &[.., (h2, v2), _, _] => libm::log((v2 - v1) / (v1 - v0)) / libm::log(((h2 * h1) / (h1 * h0)).sqrt()),
            _ => f64::NAN,
        };
        let order = if (0.5..=3.0).contains(&shown) { shown } else { 2.0 };
        let beyond = (v0 - v1) / (libm::pow(h1 / h0, order) - 1.0);
        Some((v0 + beyond, (beyond / (v0 + beyond)).abs()))
    }

    /// Relative error of the value on a mesh.
    pub fn error_of(&self, point: &MeshPoint) -> Option<f64> {
        let (reference, _) = self.reference()?;
        Some(((point.value? - reference) / reference).abs())
    }

    /// Measured order: how steeply the error falls with the size of the triangles, from the finest but one on, as far as it is
    /// steady to 0.15.
    pub fn order(&self) -> Option<f64> {
        let measured = |point: &MeshPoint| Some([libm::log(point.size), libm::log(self.error_of(point)?)]);
        let mut points: Vec<_> = self.points().filter_map(measured).collect();
        // The finest is what the others are compared with.
        points.pop()?;
        points.reverse();
        steady_slope(&points)
    }
}

impl Slot {
    fn until(&mut self, trial: &Trial, plan: &MeshPlan, limit: f64, deadline: Deadline) {
        if matches!(self.work, Work::Waiting) {
            self.work = self.begin(trial, plan, limit);
        }
        let Work::Marching(march) = &mut self.work else { return };
        if march.advance(deadline, &mut |_, _| ControlFlow::Continue(())) {
            let simulation = &march.simulation;
            self.point.ms = march.ms_per_second();
            if simulation.fault().is_some() {
                self.point.status = Status::Unstable;
            } else {
                let (scene, x) = (simulation.scene(), &simulation.state().x);
                self.point.value = Some(plan.measure.of(scene, x));
                self.moved = Measure::TipDeflection.of(scene, x);
            }
            self.work = Work::Over;
        }
    }

    /// Makes the mesh; finds the rest, or gets ready to march.
    fn begin(&mut self, trial: &Trial, plan: &MeshPlan, own_limit: f64) -> Work {
        // Files were read for the trial's own scene; what cannot be refined is taken from there.
        let built = Scene::build(&self.level, self.level.mode, &NoFiles, Some(&trial.scene));
        let Ok(scene) = built else {
            self.point.status = Status::Unconverged;
            return Work::Over;
        };
        let count = scene.triangles.len();
        let area: f64 = scene.bodies.iter().flat_map(|body| body.elements.rest_areas()).sum();
        (self.point.triangles, self.point.vertices) = (count, scene.rest.len() / 2);
        self.point.size = (2.0 * area / count as f64).sqrt();
        if plan.moment == MeshMoment::AtTheEnd {
            let state: &State = &scene.start;
            let setting = scaled(&trial.current, limit(&scene, state) / own_limit);
            return Work::Marching(Box::new(March::new(&scene, state, &setting, trial.frames)));
        }
        let (rest, ms) = timed(|| statics::rest(&scene));
        self.point.ms = ms;
        match rest {
            Some((x, counts)) if counts.unconverged == 0 => {
                self.point.value = Some(plan.measure.of(&scene, &x));
                self.moved = Measure::TipDeflection.of(&scene, &x);
            }
            _ => self.point.status = Status::Unconverged,
        }
        Work::Over
    }
}

/// What some work comes to, and the least time that it took [ms]: what is soon done is done again, as the first time pays for cold
/// memory.
fn timed<T>(work: impl Fn() -> T) -> (T, f64) {
    let (mut spent, mut least) = (Duration::ZERO, Duration::MAX);
    loop {
        let begin = Instant::now();
        let result = work();
        let taken = begin.elapsed();
        (spent, least) = (spent + taken, least.min(taken));
        if spent >= ENOUGH {
            return (result, least.as_secs_f64() * 1e3);
        }
    }
}

/// The setting for a mesh that is stiffer by a factor: an explicit scheme keeps its distance from the stability limit.
fn scaled(setting: &Setting, factor: f64) -> Setting {
    let substeps = match setting.integrator.kind().class() {
        Class::Explicit => Substeps::nearest(f64::from(setting.substeps.get()) * factor),
        Class::Implicit | Class::ErrorControlled => setting.substeps,
    };
    Setting { substeps, ..setting.clone() }
}
