//! The studies of the window and their results; and runs of hard cases.

use super::Task;
use crate::{
    elements::ElementKind,
    files::Disk,
    hard::{self, COLUMNS, Case, Entry, Method, Sweep, row},
    integrators::IntegratorKind,
    level::Level,
    materials::{Model, TypedEnergy},
    study::{
        Curve, Dial, DialPlan, Drift, ErrorBudget, ErrorSource, Invariant, Limits, Locking, LockingNumber, Measure,
        MeasuredOrder, MeshMoment, MeshPlan, MeshPoint, MeshReference, MeshSeries, MeshStudy, NoErrors,
        NoMeshReference, Plan, Price, Progress, Reached, Reference, Saving, Savings, Setting, Status, StudyError,
        Suggestion, Trial, USUAL_ERRORS, WorkPrecision,
    },
};
use std::{path::Path, sync::Arc, time::Duration};

/// Target errors for which the cheapest setting is searched.
pub const TARGETS: [f64; 4] = [0.1, 0.01, 0.001, 0.0001];

/// Simulated time of the error studies, and of meshes that do not come to rest \[s\].
pub const SECONDS: f64 = 1.0;

/// Number of threads for a study. One thread is left for the running scene.
pub(super) fn threads() -> usize {
    crate::study::threads().saturating_sub(1).max(1)
}

/// Results of the work-precision diagram.
#[derive(Clone, Default)]
pub struct Diagram {
    /// Title of the level.
    pub level: String,
    /// One curve for each scheme.
    pub curves: Vec<Curve>,
    /// Reference of the errors, and its own error.
    pub reference: Option<(String, f64)>,
    /// Limits below which an error is not meaningful.
    pub limits: Limits,
    /// Reason why there are no errors.
    pub no_errors: Option<NoErrors>,
    /// The cheapest setting for each of [`TARGETS`], by time and by force evaluations.
    pub suggestions: Vec<[Option<Suggestion>; 2]>,
    /// The table as comma-separated values.
    pub csv: String,
}

impl Diagram {
    /// Number of the default target in [`TARGETS`]: the first usual error that some setting reaches at this price.
    pub fn usual_target(&self, price: usize) -> usize {
        let number = |error: &f64| TARGETS.iter().position(|target| target == error);
        let reached = |number: &usize| {
            self.suggestions.get(*number).and_then(|by_price| by_price.get(price)).is_some_and(Option::is_some)
        };
        let mut usual = USUAL_ERRORS.iter().filter_map(number);
        usual.clone().find(reached).or_else(|| usual.next()).unwrap_or_default()
    }
}

/// Results of the accuracy dial.
#[derive(Clone, Default)]
pub struct DialFindings {
    /// Wanted error.
    pub wanted: f64,
    /// The cheapest setting that keeps it.
    pub cheapest: Option<Reached>,
    /// The cheapest setting for ten times the error.
    pub tenfold: Option<Reached>,
    /// Reason why no error can be kept.
    pub trouble: Option<String>,
}

/// Prepares the accuracy dial of a level from its state, for a wanted error and for ten times as much.
pub fn dial(level: &Level, wanted: f64) -> Result<Dial, StudyError> {
    let plan = DialPlan { wanted: vec![10.0 * wanted, wanted], threads: threads(), ..DialPlan::default() };
    Ok(Dial::new(Trial::new(level, &Disk, SECONDS)?, plan))
}

impl Task for Dial {
    type Results = DialFindings;

    fn advance(&mut self, budget: Duration) -> Result<Progress, StudyError> {
        Self::advance(self, budget)
    }

    fn results(&self) -> DialFindings {
        let [tenfold, wanted] = [0, 1].map(|number| self.plan().wanted.get(number).copied().unwrap_or_default());
        let unclear = || (self.reference().is_some() && !self.tells(wanted)).then_some(());
        let unclear = unclear().map(|()| "the motion is chaotic, or too stiff to tell so small an error".to_owned());
        DialFindings {
            wanted,
            cheapest: self.cheapest(wanted).cloned(),
            tenfold: self.cheapest(tenfold).cloned(),
            trouble: self.no_errors().map(|why| why.to_string()).or(unclear),
        }
    }
}

/// Prepares the work-precision diagram of a level from its state.
pub fn accuracy(level: &Level) -> Result<WorkPrecision, StudyError> {
    let plan = Plan { threads: threads(), ..Plan::default() };
    Ok(WorkPrecision::new(Trial::new(level, &Disk, SECONDS)?, plan))
}

impl Task for WorkPrecision {
    type Results = Diagram;

    fn advance(&mut self, budget: Duration) -> Result<Progress, StudyError> {
        Self::advance(self, budget)
    }

    fn results(&self) -> Diagram {
        let prices = [Price::Time, Price::ForceEvaluations];
        Diagram {
            level: self.trial().name.clone(),
            curves: self.curves(),
            reference: self.reference().map(|reference| (reference.source.to_string(), reference.own_error)),
            limits: self.reference().map(Reference::limits).unwrap_or_default(),
            no_errors: self.no_errors(),
            suggestions: TARGETS.map(|target| prices.map(|price| self.suggest(target, price))).to_vec(),
            csv: self.csv(),
        }
    }
}

/// A mesh study, followed by the measurement of locking for the level's mesh.
pub struct Meshes {
    level: Level,
    study: MeshStudy,
    locking: Option<Locking>,
}

/// A mesh with its results.
#[derive(Clone)]
pub struct Mesh {
    /// The mesh and its value.
    pub point: MeshPoint,
    /// Relative error of the value, once it is known.
    pub error: Option<f64>,
    /// Whether it is the level's own mesh.
    pub current: bool,
}

/// Results of a mesh study.
#[derive(Clone, Default)]
pub struct MeshFindings {
    /// Title of the level.
    pub level: String,
    /// Measure that is compared.
    pub measure: Measure,
    /// Time at which the measure is taken.
    pub moment: MeshMoment,
    /// Meshes, one series after the other, each from coarse to fine.
    pub meshes: Vec<Mesh>,
    /// Reference of the values, or the reason why there is none.
    pub reference: Option<Result<MeshReference, NoMeshReference>>,
    /// Order of the error in the size of the triangles for each series, or the reason why it cannot be measured.
    pub orders: Vec<(MeshSeries, MeasuredOrder)>,
    /// Which meshes are as exact as the finest of linear triangles, and what they cost; and which kinds the level cannot have. A sentence for each
    /// kind.
    pub remarks: Vec<String>,
    /// Locking of the level's mesh.
    pub locking: Vec<LockingNumber>,
    /// The table as comma-separated values.
    pub csv: String,
}

/// Prepares a mesh study of a level: at rest if pins hold it, else after [`SECONDS`].
pub fn meshes(level: &Level, measure: Measure, adaptive: bool) -> Result<Meshes, StudyError> {
    let elements = ElementKind::ALL.to_vec();
    let plan = |moment| MeshPlan { measure, moment, elements, adaptive, threads: threads(), ..MeshPlan::default() };
    let trial = Trial::new(level, &Disk, SECONDS)?;
    let moment = if trial.scene.is_held() { MeshMoment::AtRest } else { MeshMoment::AtTheEnd };
    let study = MeshStudy::new(level, &Disk, SECONDS, plan(moment))?;
    Ok(Meshes { level: level.clone(), study, locking: None })
}

impl Task for Meshes {
    type Results = MeshFindings;

    fn advance(&mut self, budget: Duration) -> Result<Progress, StudyError> {
        /// Approximate share of the mesh study in the whole work.
        const MESHES: f64 = 0.7;
        let compared = self.study.advance(budget);
        let alone = self.study.plan().moment == MeshMoment::AtTheEnd || !self.study.is_telling();
        if !compared.finished || alone {
            return Ok(compared);
        }
        if self.locking.is_none() {
            self.locking = Some(Locking::new(&self.level, &Disk)?);
        }
        let locking = self.locking.as_mut().map_or(Progress::FINISHED, Locking::advance);
        Ok(Progress { done: MESHES + (1.0 - MESHES) * locking.done, ..locking })
    }

    fn results(&self) -> MeshFindings {
        let study = &self.study;
        let left_out = |(kind, why): &(ElementKind, String)| format!("{} is left out: {why}.", kind.title());
        let mesh = |point: &MeshPoint| Mesh {
            point: point.clone(),
            error: study.error_of(point),
            current: study.is_current(point),
        };
        let locking = self.locking.as_ref().map(Locking::numbers).unwrap_or_default();
        MeshFindings {
            level: study.trial().name.clone(),
            measure: study.plan().measure,
            moment: study.plan().moment,
            meshes: study.points().map(mesh).collect(),
            reference: study.reference(),
            orders: study.reference().map_or_else(Vec::new, |_| {
                study.series().into_iter().map(|series| (series, study.order(series))).collect()
            }),
            remarks: study.as_exact_in_words().into_iter().chain(study.left_out().iter().map(left_out)).collect(),
            csv: study.csv(&locking),
            locking,
        }
    }
}

/// Results of one scheme over time.
#[derive(Clone)]
pub struct Course {
    /// Scheme and step.
    pub setting: Setting,
    /// Whether these are the level's own scheme and step.
    pub current: bool,
    /// Status of the run.
    pub status: Status,
    /// For each of [`Invariant::ALL`]: time \[s\] and the greatest change so far.
    pub changes: [Vec<[f64; 2]>; 3],
    /// Change of the energy at the end; negative for a loss.
    pub gain: f64,
}

/// Results of energy and momentum over time.
#[derive(Clone, Default)]
pub struct Courses {
    /// Title of the level.
    pub level: String,
    /// Simulated time \[s\].
    pub seconds: f64,
    /// One course for each scheme.
    pub each: Vec<Course>,
    /// Stable schemes that touched a wall, so that a change of energy and momentum is physical.
    pub touching: Vec<&'static str>,
    /// For each of [`Invariant::ALL`]: the physical causes of a change, and the reason why there is no curve.
    pub words: [(String, Option<&'static str>); 3],
    /// The table as comma-separated values.
    pub csv: String,
}

/// Prepares the drift study of a level from its state, for a time \[s\].
pub fn drift(level: &Level, seconds: f64) -> Result<Drift, StudyError> {
    let trial = Trial::new(level, &Disk, seconds)?;
    let settings = Drift::settings(&trial, &IntegratorKind::all(), None);
    Ok(Drift::new(trial, settings, threads()))
}

impl Task for Drift {
    type Results = Courses;

    fn advance(&mut self, budget: Duration) -> Result<Progress, StudyError> {
        Ok(Self::advance(self, budget))
    }

    fn results(&self) -> Courses {
        let course = |run: &crate::study::DriftRun| {
            let changes = Invariant::ALL.map(|invariant| {
                let mut greatest = 0.0_f64;
                let points = run.moments.iter().map(|moment| {
                    greatest = greatest.max(self.change(run, invariant, moment).abs());
                    [moment.time, greatest]
                });
                points.collect()
            });
            let gain = run.moments.last().map_or(0.0, |last| self.change(run, Invariant::Energy, last));
            let current = run.setting == self.trial().current;
            Course { setting: run.setting.clone(), current, status: self.status(run), changes, gain }
        };
        Courses {
            level: self.trial().name.clone(),
            seconds: self.trial().seconds(),
            each: self.runs().iter().map(course).collect(),
            touching: self.touching().map(|run| run.setting.integrator.kind().title()).collect(),
            words: Invariant::ALL.map(|invariant| (self.changed_by(invariant).join(", "), self.nothing_of(invariant))),
            csv: self.csv(),
        }
    }
}

/// Results of the error budget.
#[derive(Clone, Default)]
pub struct Budget {
    /// Title of the level.
    pub level: String,
    /// Processor time of the level as it is, per second of simulated time \[ms\]; `None` before its run is over.
    pub ms_per_second: Option<f64>,
    /// Sources of error, in the order of [`ErrorBudget::sources`].
    pub sources: Vec<ErrorSource>,
    /// The table as comma-separated values.
    pub csv: String,
}

/// Prepares the error budget of a level, from its start.
pub fn budget(level: &Level) -> Result<ErrorBudget, StudyError> {
    ErrorBudget::new(level, &Disk, SECONDS, threads())
}

impl Task for ErrorBudget {
    type Results = Budget;

    fn advance(&mut self, budget: Duration) -> Result<Progress, StudyError> {
        Self::advance(self, budget)
    }

    fn results(&self) -> Budget {
        let sources = self.sources().cloned().collect();
        Budget { level: self.name().to_owned(), ms_per_second: self.ms_per_second(), sources, csv: self.csv() }
    }
}

/// Results of the time saved by skipping effects.
#[derive(Clone, Default)]
pub struct Saved {
    /// Saving of each effect, elements first.
    pub each: Vec<Saving>,
    /// Time of a whole frame with skipping, and with every effect forced \[s\].
    pub whole: Option<[f64; 2]>,
}

/// Prepares the measurement of the time saved by skipping effects, from the level's state.
pub fn savings(level: &Level) -> Result<Savings, StudyError> {
    Savings::new(level, &Disk)
}

impl Task for Savings {
    type Results = Saved;

    fn advance(&mut self, budget: Duration) -> Result<Progress, StudyError> {
        Ok(Self::advance(self, budget))
    }

    fn results(&self) -> Saved {
        Saved { each: self.each(), whole: self.whole() }
    }
}

/// Selection of runs of hard cases; a field without a value selects all.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Choice {
    /// Name of a case.
    pub case: Option<&'static str>,
    /// Constitutive model.
    pub model: Option<Model>,
    /// Typed energy in place of those of all models.
    pub energy: Option<Arc<TypedEnergy>>,
    /// Method of time integration.
    pub method: Option<Method>,
    /// Whether the undamped twins are selected, or the cases themselves.
    pub undamped: bool,
}

impl Choice {
    /// Whether a run is selected.
    pub fn takes(&self, trial: &hard::Trial) -> bool {
        self.case.is_none_or(|case| case == trial.name)
            && self.model.is_none_or(|model| model == trial.model)
            && self.energy.as_ref() == trial.case.energy()
            && self.method.is_none_or(|method| method == trial.method)
            && self.undamped == trial.case.is_undamped_twin()
    }
}

/// Results of the hard cases.
#[derive(Clone, Default)]
pub struct Known {
    /// All runs that were started.
    pub runs: Vec<(hard::Trial, Entry)>,
}

impl Known {
    /// Table of all finished runs as comma-separated values.
    pub fn csv(&self) -> String {
        let over = self.runs.iter().filter_map(|(trial, entry)| match &entry.verdict {
            Some(Ok(verdict)) => Some(row(trial, verdict, None)),
            _ => None,
        });
        over.fold(COLUMNS.to_owned(), |text, line| text + "\n" + &line) + "\n"
    }
}

/// Runs in progress, and the results of earlier runs.
pub struct Hard {
    before: Vec<(hard::Trial, Entry)>,
    sweep: Sweep,
}

impl Hard {
    /// Prepares the selected runs; other results stay.
    pub fn new(choice: &Choice, known: Known) -> Result<Self, StudyError> {
        let mut trials = Vec::new();
        for name in Case::names() {
            let case = Case::read(Path::new(name)).map_err(|_| StudyError::NotHere("a hard case cannot be read"))?;
            let case = if choice.undamped { case.undamped_twin() } else { Some(case) };
            let Some(case) = case.map(|case| Arc::new(case.with_energy(choice.energy.clone()))) else { continue };
            for (&model, method) in Model::ALL.iter().flat_map(|model| Method::ALL.map(|method| (model, method))) {
                trials.push(hard::Trial { name: name.to_owned(), case: Arc::clone(&case), model, method });
            }
        }
        trials.retain(|trial| choice.takes(trial));
        let mut before = known.runs;
        before.retain(|(trial, entry)| entry.verdict.is_some() && !choice.takes(trial));
        Ok(Self { before, sweep: Sweep::new(trials, threads(), true) })
    }
}

impl Task for Hard {
    type Results = Known;

    fn advance(&mut self, budget: Duration) -> Result<Progress, StudyError> {
        Ok(self.sweep.advance(budget))
    }

    fn results(&self) -> Known {
        let now = self.sweep.entries().map(|(trial, entry)| (trial.clone(), entry.clone()));
        Known { runs: self.before.iter().cloned().chain(now).collect() }
    }
}
