//! Mesh study: convergence of a quantity under refinement.

use super::{
    Limits, Measure, MeasuredOrder, NoOrder, Progress, Sample, Setting, Status, StudyError, Trial,
    march::{Deadline, March, Repetitions, spread},
    measured_order,
    other_meshes::{refine, with_elements},
    solutions, threads,
    trial::limit,
};
use crate::{
    clock::Stopwatch,
    elements::ElementKind,
    integrators::Class,
    level::{Level, Substeps},
    meshes::{Files, NoFiles},
    scene::{Scene, StressErrors},
    state::State,
};
use std::{ops::ControlFlow, time::Duration};

/// Time at which the quantity is measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MeshMoment {
    /// At rest under the acting forces. Pins or rollers must hold the bodies.
    #[default]
    AtRest,
    /// At the end of the simulated time.
    AtTheEnd,
}

/// How meshes are refined.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Refinement {
    /// Everywhere: the meshes of the level with more triangles.
    #[default]
    Uniform,
    /// Where the error of the stress is greatest. From the coarsest mesh on, the equilibrium is solved, and the triangles that have half of the sum of the
    /// [squared errors](crate::scene::StressErrors) are divided, until there are as many as wanted.
    Adaptive,
}

/// A series of meshes that are compared, from coarse to fine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MeshSeries {
    /// Kind of the elements of all bodies, if kinds are compared.
    pub element: Option<ElementKind>,
    /// How they are refined.
    pub refinement: Refinement,
}

impl MeshSeries {
    /// Its name, in plain words.
    pub fn title(self) -> String {
        let element = self.element.map_or("", ElementKind::title);
        match self.refinement {
            Refinement::Uniform => element.to_owned(),
            Refinement::Adaptive if element.is_empty() => "Adaptive".to_owned(),
            Refinement::Adaptive => format!("{element} (adaptive)"),
        }
    }

    /// Its name in one word, as the kinds of elements have it.
    pub fn word(self) -> String {
        let element = self.element.map(|kind| format!("{kind:?}"));
        let adaptive = (self.refinement == Refinement::Adaptive).then(|| "Adaptive".to_owned());
        element.into_iter().chain(adaptive).collect::<Vec<_>>().join("+")
    }
}

/// Plan of a mesh study.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshPlan {
    /// Target numbers of triangles. If empty: 1/64, 1/16, 1/4, 1 and 4 times the level's own number.
    pub triangles: Vec<u32>,
    /// Kinds of elements that are compared, each on meshes of these numbers of triangles; if empty, those of the level.
    pub elements: Vec<ElementKind>,
    /// Whether each kind of elements is also refined only where the stress has its error. For this the bodies must come to rest.
    pub adaptive: bool,
    /// Quantity that is compared.
    pub measure: Measure,
    /// Time at which the quantity is measured.
    pub moment: MeshMoment,
    /// Number of threads. The results do not depend on it.
    pub threads: usize,
}

impl Default for MeshPlan {
    fn default() -> Self {
        let (measure, moment) = (Measure::default(), MeshMoment::default());
        Self { triangles: Vec::new(), elements: Vec::new(), adaptive: false, measure, moment, threads: threads() }
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

/// Mesh and its result.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshPoint {
    /// The series that it belongs to.
    pub series: MeshSeries,
    /// Number of triangles, those that elements of six nodes are divided into. Before the mesh is built: the target number.
    pub triangles: usize,
    /// Number of vertices.
    pub vertices: usize,
    /// Size of the triangles \[m\]: `sqrt(2 · mean area)`, the side of a square cell of two triangles.
    pub size: f64,
    /// Value of the quantity. `None` before it is known, or if it cannot be computed.
    pub value: Option<f64>,
    /// Status of the run. `Unconverged` if no equilibrium was found or the mesh could not be built.
    pub status: Status,
    /// Processor time \[ms\], the least of `runs` runs: of one equilibrium, or per second of simulated time.
    pub ms: f64,
    /// Number of runs.
    pub runs: u32,
}

struct Slot {
    level: Level,
    point: MeshPoint,
    /// Greatest displacement of any vertex \[m\].
    moved: f64,
    run_state: RunState,
    /// Processor time of the first run.
    spent: Duration,
    /// Scenes that are solved again for their time: the coarser meshes of an adaptive one, and that of the mesh.
    scenes: Vec<Scene>,
    /// Whether one more run is due in this round.
    due: bool,
    again: Option<Box<March>>,
}

enum RunState {
    Waiting,
    /// The next mesh of an adaptive series is solved.
    Refining,
    Marching(Box<March>),
    Over,
}

/// Mesh study as a job.
pub struct MeshStudy {
    trial: Trial,
    plan: MeshPlan,
    /// Stability limit of the trial's own mesh [steps per frame].
    limit: f64,
    /// The kinds of elements, each with a scene whose files are read.
    kinds: Vec<(Option<ElementKind>, Scene)>,
    left_out: Vec<(ElementKind, String)>,
    /// One series after the other, each from coarse to fine.
    slots: Vec<Slot>,
    repetitions: Repetitions,
    finished: bool,
}

/// Reference value of a mesh study.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshReference {
    /// Value extrapolated from the three finest meshes to triangle size 0: of several kinds of elements, from that whose value on the finest
    /// mesh is nearest to it.
    pub value: f64,
    /// Estimated relative error: its distance from the value on the finest mesh.
    pub own_error: f64,
    /// Order p of the differences, which shrink as h^p.
    pub order: f64,
    /// Series that it is of.
    pub series: MeshSeries,
}

/// Orders for which values are extrapolated. Linear triangles have order 2; quadratic ones 3, and 4 in energies, but 2 under distributed loads, which
/// act on the four triangles that each is divided into; all less near corners.
const fn orders(kind: ElementKind) -> std::ops::RangeInclusive<f64> {
    match kind {
        ElementKind::Linear | ElementKind::MeanDilatation => 0.5..=2.5,
        ElementKind::Quadratic => 0.5..=4.5,
    }
}

/// Reason why a mesh study has no reference value.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NoMeshReference {
    /// The greatest displacement is zero or round-off.
    #[error("Nothing moves here, so there is nothing to compare: let something act, or begin with a stretch")]
    NothingMoves,
    /// All meshes give the same value.
    #[error("Every mesh gives the same number: it does not depend on the mesh here, as where pins prescribe it")]
    Same,
    /// Fewer than three meshes have a value.
    #[error("No reference: fewer than three meshes have a value. Ask for more meshes")]
    TooFewMeshes,
    /// The differences of the three finest meshes do not shrink as h^p with a valid order p.
    #[error(
        "No reference: the meshes' differences do not shrink as h^p with 0.5 <= p <= {greatest} ({}), so the values cannot be extrapolated \
         and no errors are given. Known is the value on the finest mesh, {finest:.6e}; the last refinement changed it by {:.2} %. The true \
         value may be much farther away: so it is where triangles lock, and where each mesh moves in its own way. Ask for finer meshes, \
         cross the diagonals of rectangles, or compare at a shorter time",
        shown(*.order),
        100.0 * last
    )]
    NotShrinking {
        /// Measured order. `None` if the differences change sign.
        order: Option<f64>,
        /// Greatest order that is valid for the elements.
        greatest: f64,
        /// Value on the finest mesh.
        finest: f64,
        /// Relative change by the last refinement.
        last: f64,
    },
}

fn shown(order: Option<f64>) -> String {
    order.map_or_else(|| "they change sign".to_owned(), |order| format!("here p = {order:.2}"))
}

impl MeshStudy {
    /// Prepares a study of a level from its start. A saved state is ignored, because it belongs to one mesh.
    ///
    /// # Errors
    /// If the level cannot be built, has no mesh with a resolution, or does not hold its bodies while rest is asked
    /// for.
    pub fn new(level: &Level, files: &dyn Files, seconds: f64, plan: MeshPlan) -> Result<Self, StudyError> {
        let level = Level { state: None, ..level.clone() };
        let trial = Trial::new(&level, files, seconds)?;
        if plan.moment == MeshMoment::AtRest && !trial.scene.is_held() {
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
        let (mut left_out, mut kinds) = (Vec::new(), Vec::new());
        for element in plan.elements.iter().copied() {
            let own = with_elements(&level, Some(element), 1.0)?;
            match Scene::build(&own, own.mode, files, Some(&trial.scene)) {
                Ok(scene) => kinds.push((Some(element), scene)),
                Err(why) => left_out.push((element, why.to_string())),
            }
        }
        if plan.elements.is_empty() {
            kinds.push((None, trial.scene.clone()));
        }
        let is_adaptive = plan.adaptive && plan.moment == MeshMoment::AtRest;
        for (element, _) in &kinds {
            for triangles in &wanted {
                let level = with_elements(&level, *element, f64::from(*triangles) / own)?;
                // Targets that give the same mesh are merged.
                if slots.iter().all(|slot| slot.level.bodies != level.bodies) {
                    let series = MeshSeries { element: *element, refinement: Refinement::Uniform };
                    slots.push(Slot::new(level, series, *triangles as usize));
                }
            }
            let series = MeshSeries { element: *element, refinement: Refinement::Adaptive };
            let (Some(coarsest), true) = (wanted.first(), is_adaptive) else { continue };
            let level = with_elements(&level, *element, f64::from(*coarsest) / own)?;
            let finer = wanted.iter().filter(|triangles| *triangles > coarsest);
            slots.extend(finer.map(|triangles| Slot::new(level.clone(), series, *triangles as usize)));
        }
        let limit = limit(&trial.scene, &trial.start);
        Ok(Self { trial, plan, limit, kinds, left_out, slots, repetitions: Repetitions::default(), finished: false })
    }

    /// Trial on the level's own mesh.
    pub const fn trial(&self) -> &Trial {
        &self.trial
    }

    /// Plan of the study.
    pub const fn plan(&self) -> &MeshPlan {
        &self.plan
    }

    /// Works for about `budget`. Building a mesh and solving an equilibrium are not interrupted.
    pub fn advance(&mut self, budget: Duration) -> Progress {
        let deadline = Deadline::after(budget);
        let Self { trial, plan, limit, kinds, slots, .. } = self;
        let open = slots.iter_mut().filter(|slot| !matches!(slot.run_state, RunState::Over)).collect();
        spread(plan.threads, open, |slot: &mut Slot| {
            slot.until(trial, plan, (*limit, kinds), deadline);
            matches!(slot.run_state, RunState::Over) && !deadline.passed()
        });
        self.repeat(deadline);
        let weight = |slot: &Slot| libm::pow(slot.point.triangles as f64, 1.5);
        let done = |slot: &Slot| match &slot.run_state {
            RunState::Waiting | RunState::Refining => 0.0,
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

    /// Repeats short runs in turns, after all have run once. The stated time is the least of all repetitions.
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
            self.slots.iter_mut().for_each(|slot| slot.scenes.clear());
        }
    }

    /// Meshes, one series after the other, each from coarse to fine.
    pub fn points(&self) -> impl Iterator<Item = &MeshPoint> {
        self.slots.iter().map(|slot| &slot.point)
    }

    /// Whether a point is the level's own mesh.
    pub fn is_current(&self, point: &MeshPoint) -> bool {
        let own = self.trial.scene.bodies.iter().map(|body| body.elements.kind());
        point.vertices == self.trial.scene.vertices()
            && point.triangles == self.trial.scene.triangles.len()
            && point.series.refinement == Refinement::Uniform
            && point.series.element.is_none_or(|element| own.into_iter().all(|kind| kind == element))
    }

    /// Reference value, or the reason why there is none. `None` until all meshes have run.
    /// It is extrapolated from the three finest meshes to size 0 with the order of their differences.
    pub fn reference(&self) -> Option<Result<MeshReference, NoMeshReference>> {
        self.is_known().then(|| self.extrapolate())
    }

    fn extrapolate(&self) -> Result<MeshReference, NoMeshReference> {
        // Adaptive meshes do not become finer everywhere by one factor.
        let uniform = self.series().into_iter().filter(|series| series.refinement == Refinement::Uniform);
        let found: Vec<_> = uniform.map(|series| self.extrapolate_of(series)).collect();
        let best = found.iter().flatten().min_by(|one, other| one.own_error.total_cmp(&other.own_error));
        best.map_or_else(|| found.first().copied().unwrap_or(Err(NoMeshReference::TooFewMeshes)), |best| Ok(*best))
    }

    /// The series that are compared.
    pub fn series(&self) -> Vec<MeshSeries> {
        let mut all: Vec<_> = self.points().map(|point| point.series).collect();
        all.dedup();
        all
    }

    fn extrapolate_of(&self, series: MeshSeries) -> Result<MeshReference, NoMeshReference> {
        let own = self.slots.iter().filter(|slot| slot.point.series == series);
        let values: Vec<_> = own.filter_map(|slot| Some((slot.point.size, slot.point.value?))).collect();
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
        let own = self.trial.scene.bodies.first().map_or(ElementKind::Linear, |body| body.elements.kind());
        let valid = orders(series.element.unwrap_or(own));
        let Some(order) = order.filter(|order| valid.contains(order)) else {
            let (last, greatest) = (((v0 - v1) / v0).abs(), *valid.end());
            return Err(NoMeshReference::NotShrinking { order, greatest, finest: v0, last });
        };
        let beyond = (v0 - v1) / (libm::pow(h1 / h0, order) - 1.0);
        let value = v0 + beyond;
        Ok(MeshReference { value, own_error: (beyond / value).abs(), order, series })
    }

    /// Whether the values depend on the mesh. False until all meshes have run.
    pub fn is_telling(&self) -> bool {
        let nothing = |why: &NoMeshReference| matches!(why, NoMeshReference::NothingMoves | NoMeshReference::Same);
        self.reference().is_some_and(|reference| !reference.err().as_ref().is_some_and(nothing))
    }

    /// Relative error of the value on a mesh, if there is a reference.
    pub fn error_of(&self, point: &MeshPoint) -> Option<f64> {
        let reference = self.reference()?.ok()?.value;
        Some(((point.value? - reference) / reference).abs())
    }

    /// Kinds of elements that the level cannot have, and why.
    pub fn left_out(&self) -> &[(ElementKind, String)] {
        &self.left_out
    }

    /// For each series but the first: the cheapest mesh that is as exact as the finest one of the first, and that one; nothing where there is none. If the
    /// reference is extrapolated from the first series, its finest mesh but one is taken.
    pub fn as_exact(&self) -> Vec<[&MeshPoint; 2]> {
        let [first, others @ ..] = &*self.series() else { return Vec::new() };
        let known = |series: MeshSeries| {
            let own = self.points().filter(move |point| point.series == series && point.ms > 0.0);
            own.filter_map(|point| Some((point, self.error_of(point)?)))
        };
        let Some(Ok(reference)) = self.reference() else { return Vec::new() };
        let from_end = usize::from(reference.series == *first);
        let own: Vec<_> = known(*first).collect();
        let Some((finest, error)) = own.iter().rev().nth(from_end).copied() else { return Vec::new() };
        let cheapest = |series: &MeshSeries| {
            let exact = known(*series).filter(|(_, own)| *own <= error);
            exact.map(|(point, _)| point).min_by(|one, other| one.ms.total_cmp(&other.ms))
        };
        others.iter().filter_map(cheapest).map(|point| [point, finest]).collect()
    }

    /// The same, a sentence for each.
    pub fn as_exact_in_words(&self) -> Vec<String> {
        let sentence = |[point, other]: [&MeshPoint; 2]| {
            let [name, other_name] = [point, other].map(|point| point.series.title());
            let times = other.ms / point.ms;
            let cost = match times {
                1.0.. => format!("{times:.1} times cheaper"),
                _ => format!("{:.1} times dearer", 1.0 / times),
            };
            let (few, many) = (point.triangles, other.triangles);
            format!(
                "{name} with {few} triangles is at least as exact as {} with {many}, and {cost}.",
                other_name.to_lowercase()
            )
        };
        self.as_exact().into_iter().map(sentence).collect()
    }

    /// Measured order of the error of a series in the triangle size, by [`measured_order`].
    /// The finest mesh that the reference was made from does not count.
    ///
    /// # Errors
    /// [`NoOrder`] if no order can be measured.
    pub fn order(&self, series: MeshSeries) -> MeasuredOrder {
        let reference = match self.reference() {
            Some(Ok(reference)) => reference,
            Some(Err(NoMeshReference::NothingMoves)) => return Err(NoOrder::NothingMoves),
            Some(Err(NoMeshReference::Same)) => return Err(NoOrder::RoundOff),
            Some(Err(NoMeshReference::TooFewMeshes)) => return Err(NoOrder::TooFewPoints),
            Some(Err(NoMeshReference::NotShrinking { .. })) | None => return Err(NoOrder::NoReference),
        };
        let sample = |point: &MeshPoint| Some(Sample { h: point.size, error: self.error_of(point)? });
        let mut samples: Vec<_> = self.points().filter(|point| point.series == series).filter_map(sample).collect();
        if reference.series == series {
            samples.pop();
        }
        measured_order(samples, Limits { round_off: ROUND_OFF, reference: reference.own_error })
    }
}

/// Relative error of the equation solver and of rounding.
const ROUND_OFF: f64 = 1e-9;
/// Estimated share of the repetitions in the total work.
const REPEATED_SHARE: f64 = 0.2;

/// Order p with `(h2^p - h1^p) / (h1^p - h0^p) = shrinking`, by bisection. It is exact for every ratio of sizes.
fn order_of_differences([h0, h1, h2]: [f64; 3], shrinking: f64) -> f64 {
    let grown = |p: f64| (libm::pow(h2 / h0, p) - libm::pow(h1 / h0, p)) / (libm::pow(h1 / h0, p) - 1.0);
    // The limits are asymmetric, so that no midpoint is 0, where the formula is 0/0.
    let (mut low, mut high) = (-20.0, 21.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if grown(middle) < shrinking { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

impl Slot {
    fn new(level: Level, series: MeshSeries, triangles: usize) -> Self {
        let status = Status::Ok;
        Self {
            level,
            point: MeshPoint { series, triangles, vertices: 0, size: 0.0, value: None, status, ms: 0.0, runs: 0 },
            moved: 0.0,
            run_state: RunState::Waiting,
            spent: Duration::ZERO,
            scenes: Vec::new(),
            due: false,
            again: None,
        }
    }

    fn until(
        &mut self,
        trial: &Trial,
        plan: &MeshPlan,
        (limit, kinds): (f64, &[(Option<ElementKind>, Scene)]),
        deadline: Deadline,
    ) {
        while matches!(self.run_state, RunState::Waiting | RunState::Refining) {
            let known = kinds.iter().find(|(kind, _)| *kind == self.point.series.element);
            self.run_state = self.begin(trial, plan, (limit, known.map(|(_, scene)| scene)));
            if deadline.passed() {
                return;
            }
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
                self.scenes.push(scene.clone());
            }
            self.run_state = RunState::Over;
        }
    }

    /// Builds the mesh. Then solves the equilibrium, or prepares a march.
    fn begin(&mut self, trial: &Trial, plan: &MeshPlan, (own_limit, known): (f64, Option<&Scene>)) -> RunState {
        // Files were read for the scene of each kind. Parts that cannot be refined are taken from it.
        let Ok(scene) = Scene::build(&self.level, self.level.mode, &NoFiles, known) else {
            self.point.status = Status::Unconverged;
            return RunState::Over;
        };
        let (count, wanted) = (scene.triangles.len(), self.point.triangles);
        if plan.moment == MeshMoment::AtTheEnd {
            self.describe(&scene);
            return RunState::Marching(march(&scene, trial, own_limit));
        }
        let stopwatch = Stopwatch::start();
        let rest = solutions::rest(&scene).filter(|(_, counts)| counts.unconverged == 0);
        let divided = rest.as_ref().filter(|_| self.point.series.refinement == Refinement::Adaptive && count < wanted);
        let worst = divided.map(|(x, _)| scene.stress_errors(x).worst(StressErrors::HALF));
        self.spent += stopwatch.elapsed();
        if worst.is_some_and(|worst| refine(&mut self.level, &scene, &worst)) {
            self.scenes.push(scene);
            return RunState::Refining;
        }
        self.describe(&scene);
        (self.point.ms, self.point.runs) = (self.spent.as_secs_f64() * 1e3, 1);
        let Some((x, _)) = rest else {
            self.point.status = Status::Unconverged;
            return RunState::Over;
        };
        self.point.value = Some(plan.measure.of(&scene, &x));
        self.moved = Measure::TipDeflection.of(&scene, &x);
        self.scenes.push(scene);
        RunState::Over
    }

    /// Stores the numbers of triangles and vertices, and the size of the triangles.
    fn describe(&mut self, scene: &Scene) {
        let count = scene.triangles.len();
        let area: f64 = scene.bodies.iter().flat_map(|body| body.elements.rest_areas()).sum();
        (self.point.triangles, self.point.vertices) = (count, scene.vertices());
        self.point.size = (2.0 * area / count as f64).sqrt();
    }

    /// Repeats a finished run to measure its time.
    fn again(&mut self, trial: &Trial, plan: &MeshPlan, own_limit: f64, deadline: Deadline) {
        let Some((scene, coarser)) = self.scenes.split_last() else {
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
            for scene in coarser {
                solutions::rest(scene).map(|(x, _)| scene.stress_errors(&x).worst(StressErrors::HALF));
            }
            solutions::rest(scene);
            stopwatch.elapsed().as_secs_f64() * 1e3
        };
        self.point.ms = self.point.ms.min(ms);
        self.point.runs += 1;
        (self.due, self.again) = (false, None);
    }
}

/// Run of the trial on a mesh with another stability limit.
fn march(scene: &Scene, trial: &Trial, own_limit: f64) -> Box<March> {
    let state: &State = &scene.start;
    let setting = scaled(&trial.current, limit(scene, state) / own_limit);
    Box::new(March::new(scene, state, &setting, trial.frames))
}

/// Setting for a mesh that is stiffer by a factor. An explicit scheme keeps its ratio to the stability limit.
fn scaled(setting: &Setting, factor: f64) -> Setting {
    let substeps = match setting.integrator.kind().class() {
        Class::Explicit => Substeps::nearest(f64::from(setting.substeps.get()) * factor),
        Class::Implicit | Class::ErrorControlled => setting.substeps,
    };
    Setting { substeps, ..setting.clone() }
}
