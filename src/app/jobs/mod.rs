//! Study jobs: all measurements beside the running scene. Each is started, polled and cancelled.

mod studies;

pub use studies::{Budget, Course, Courses, Diagram, DialFindings, Mesh, MeshFindings, Meshes, SECONDS, TARGETS};
pub use studies::{Choice, Hard, Known};

use super::advice::Limit;
use crate::{
    command::Mode,
    level::Level,
    sandbox::Sandbox,
    stability::StabilityProbe,
    state::State,
    study::{Dial, Drift, ErrorBudget, Measure, Progress, Savings, StudyError, Twin, WorkPrecision},
};
use std::{
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    time::Duration,
};

/// Number of coordinates, about equal to that of triangles, that the stability limit is computed for in one frame.
/// Two rounds for this number take a third of a millisecond.
const PER_FRAME: usize = 7500;
/// Rounds of one call of the probe while something moves, and at most while nothing moves.
const ROUNDS: [usize; 2] = [2, 16];
/// Relative change of the limit in one call below which the limit has settled.
const SETTLED: f64 = 5e-5;

/// Topic of a study.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Topic {
    /// Errors of schemes and steps against time: the work-precision diagram.
    #[default]
    Accuracy,
    /// Errors of meshes against time.
    Meshes,
    /// Energy and momentum over time.
    Drift,
    /// Sources of error.
    Budget,
}

/// Requests of the panels. Only one study runs at a time.
#[derive(Clone, Debug, PartialEq)]
pub enum JobRequest {
    /// Measure the work-precision diagram from the present state.
    Accuracy,
    /// Compare meshes by this measure, and perhaps also such as are refined by error.
    Meshes(Measure, bool),
    /// Find the cheapest scheme and step for this error, from the present state.
    Dial(f64),
    /// Follow energy and momentum from the present state for this simulated time \[s\].
    Drift(f64),
    /// Measure the sources of error of the level from its start.
    Budget,
    /// Run hard cases.
    Hard(Choice),
    /// Stop the running study; its findings stay.
    Cancel,
    /// Measure the time saved by skipping effects.
    Savings,
    /// Run a twin beside the scene, or stop it.
    Twin(bool),
}

/// All studies of the window.
#[derive(Default)]
pub struct Jobs {
    probe: StabilityProbe,
    limit: Option<f64>,
    /// Frames since the last call of the probe.
    unprobed: usize,
    /// Shape for which the limit has settled.
    settled: Option<u64>,
    rest: RestLimit,
    twin: Option<Twin>,
    /// The work-precision diagram.
    pub accuracy: Study<WorkPrecision>,
    /// The accuracy dial.
    pub dial: Study<Dial>,
    /// Errors of meshes against time.
    pub meshes: Study<Meshes>,
    /// Energy and momentum over time.
    pub drift: Study<Drift>,
    /// Sources of error.
    pub budget: Study<ErrorBudget>,
    /// Runs of hard cases.
    pub hard: Study<Hard>,
    /// Time saved by skipping effects.
    pub savings: Study<Savings>,
}

/// Longest stable step of a scene at rest, measured on request.
#[derive(Default)]
struct RestLimit {
    /// Level and mode of the measurement.
    of: Option<(Arc<Level>, Mode)>,
    probe: StabilityProbe,
    limit: Option<f64>,
    settled: bool,
}

impl Jobs {
    /// Longest stable step of the scheme at rest, once it is known.
    pub const fn limit_at_rest(&self) -> Limit {
        match (self.rest.settled, self.rest.limit) {
            (false, _) => Limit::Unknown,
            (true, None) => Limit::Nothing,
            (true, Some(limit)) => Limit::Step(limit),
        }
    }

    /// Measures the longest stable step at rest for a part of a frame. Returns whether there is more to do.
    pub fn measure_rest_limit(&mut self, sandbox: &Sandbox) -> bool {
        let (scene, rest) = (sandbox.simulation().scene(), &mut self.rest);
        let known = |(level, mode): &(Arc<Level>, Mode)| Arc::ptr_eq(level, &sandbox.shown) && *mode == sandbox.mode;
        if !rest.of.as_ref().is_some_and(known) {
            *rest = RestLimit { of: Some((Arc::clone(&sandbox.shown), sandbox.mode)), ..RestLimit::default() };
        }
        if rest.settled {
            return false;
        }
        let reach = scene.integrator.kind().stability_limit();
        let Some(reach) = reach.filter(|_| scene.toy.is_none()) else {
            rest.settled = true;
            return false;
        };
        let rounds = (ROUNDS[1] * PER_FRAME / scene.rest.len().max(1)).clamp(ROUNDS[0], ROUNDS[1]);
        let state = State { x: scene.rest.clone(), ..scene.start.clone() };
        let limit = rest.probe.refine(scene, &state, None, rounds).map(|limit| 0.5 * reach * limit);
        rest.settled = match (rest.limit, limit) {
            (Some(before), Some(now)) => (before - now).abs() <= SETTLED * now,
            (_, None) => true,
            (None, _) => false,
        };
        rest.limit = limit;
        !rest.settled
    }

    /// Longest stable step of an undamped vibration near the present state \[s\], as far as it is known.
    pub const fn limit(&self) -> Option<f64> {
        self.limit
    }

    /// The twin that measures the present error.
    pub const fn twin(&self) -> Option<&Twin> {
        self.twin.as_ref()
    }

    /// Whether the study of a topic is running.
    pub const fn is_running(&self, topic: Topic) -> bool {
        match topic {
            Topic::Accuracy => self.accuracy.is_running(),
            Topic::Meshes => self.meshes.is_running(),
            Topic::Drift => self.drift.is_running(),
            Topic::Budget => self.budget.is_running(),
        }
    }

    /// Whether any study is running.
    pub const fn is_busy(&self) -> bool {
        self.accuracy.is_running()
            || self.dial.is_running()
            || self.meshes.is_running()
            || self.drift.is_running()
            || self.budget.is_running()
            || self.hard.is_running()
            || self.savings.is_running()
    }

    /// Completed share of a study, if it was ever started.
    pub fn done(&self, topic: Topic) -> Option<f64> {
        match topic {
            Topic::Accuracy => self.accuracy.findings().map(|findings| findings.progress.done),
            Topic::Meshes => self.meshes.findings().map(|findings| findings.progress.done),
            Topic::Drift => self.drift.findings().map(|findings| findings.progress.done),
            Topic::Budget => self.budget.findings().map(|findings| findings.progress.done),
        }
    }

    /// Starts or stops what a panel requested.
    pub fn grant(&mut self, request: JobRequest, sandbox: &Sandbox) {
        if !matches!(request, JobRequest::Twin(_)) {
            // Two studies at once would disturb each other's times.
            self.cancel();
        }
        let level = || sandbox.saved();
        match request {
            JobRequest::Accuracy => {
                let level = level();
                self.accuracy.start(move || studies::accuracy(&level));
            }
            JobRequest::Dial(wanted) => {
                let level = level();
                self.dial.start(move || studies::dial(&level, wanted));
            }
            JobRequest::Meshes(measure, adaptive) => {
                let level = level();
                self.meshes.start(move || studies::meshes(&level, measure, adaptive));
            }
            JobRequest::Drift(seconds) => {
                let level = level();
                self.drift.start(move || studies::drift(&level, seconds));
            }
            JobRequest::Budget => {
                let level = level();
                self.budget.start(move || studies::budget(&level));
            }
            JobRequest::Hard(choice) => {
                let known = self.hard.findings().map(|findings| findings.results.clone()).unwrap_or_default();
                self.hard.start(move || Hard::new(&choice, known));
            }
            JobRequest::Savings => {
                let level = level();
                self.savings.start(move || studies::savings(&level));
            }
            JobRequest::Cancel => {}
            JobRequest::Twin(on) => self.twin = on.then(|| Twin::new(sandbox.simulation())),
        }
    }

    fn cancel(&mut self) {
        self.accuracy.cancel();
        self.dial.cancel();
        self.meshes.cancel();
        self.drift.cancel();
        self.budget.cancel();
        self.hard.cancel();
        self.savings.cancel();
    }

    /// Advances the twin with the scene. Call it before any change from outside.
    pub fn follow(&mut self, sandbox: &Sandbox) {
        if let Some(twin) = &mut self.twin {
            twin.follow(sandbox.simulation());
        }
    }

    /// Computes for a small part of a frame and returns whether there is more to do. It updates the longest stable step only while
    /// `gauge` is true, that is while the step is shown.
    pub fn advance(&mut self, sandbox: &Sandbox, gauge: bool) -> bool {
        let simulation = sandbox.simulation();
        let doubtful = gauge && self.settled != Some(simulation.shape());
        if doubtful {
            self.probe(sandbox);
        }
        let behind = self.twin.as_mut().is_some_and(|twin| {
            twin.follow(simulation);
            !twin.advance(simulation, Duration::from_millis(8))
        });
        self.accuracy.collect();
        self.dial.collect();
        self.meshes.collect();
        self.drift.collect();
        self.budget.collect();
        self.hard.collect();
        self.savings.collect();
        behind || self.is_busy() || doubtful && !sandbox.is_busy()
    }

    /// Updates the longest stable step.
    fn probe(&mut self, sandbox: &Sandbox) {
        let (simulation, size) = (sandbox.simulation(), sandbox.simulation().scene().rest.len());
        let [few, many] = ROUNDS;
        let (rounds, per_frame) = if sandbox.is_busy() {
            (few, PER_FRAME)
        } else {
            ((many * PER_FRAME / size.max(1)).clamp(few, many), many / few * PER_FRAME)
        };
        // The limit changes slowly, and one call costs as much as some steps. So a large scene is probed only every few frames.
        self.unprobed += 1;
        if self.limit.is_some() && self.unprobed <= size / per_frame {
            return;
        }
        self.unprobed = 0;
        let limit = self.probe.refine(simulation.scene(), simulation.state(), simulation.grab(), rounds);
        let settled = match (self.limit, limit) {
            (Some(before), Some(now)) => (before - now).abs() <= SETTLED * now,
            (_, None) => true,
            (None, _) => false,
        };
        (self.limit, self.settled) = (limit, settled.then_some(simulation.shape()));
    }
}

/// A study that is computed in small parts.
pub trait Task: Send + 'static {
    /// Type of the results, to be drawn.
    type Results: Clone + Default + Send + 'static;

    /// Computes for about `budget`.
    ///
    /// # Errors
    /// If there is nothing to study.
    fn advance(&mut self, budget: Duration) -> Result<Progress, StudyError>;

    /// Results so far.
    fn results(&self) -> Self::Results;
}

/// State of a study.
#[derive(Clone, Default)]
pub struct Findings<R> {
    /// Results so far.
    pub results: R,
    /// Progress of the study.
    pub progress: Progress,
    /// Reason why there are no results.
    pub trouble: Option<String>,
    /// Number of changes, so that a reader sees when there are new results.
    version: u64,
}

/// A study of the window: the findings of the last run, and its job while it runs.
pub struct Study<W: Task> {
    findings: Option<Findings<W::Results>>,
    job: Option<Job<W>>,
}

impl<W: Task> Default for Study<W> {
    fn default() -> Self {
        Self { findings: None, job: None }
    }
}

impl<W: Task> Study<W> {
    /// Findings of the study, if it was ever started.
    pub const fn findings(&self) -> Option<&Findings<W::Results>> {
        self.findings.as_ref()
    }

    /// Whether the study is running.
    pub const fn is_running(&self) -> bool {
        self.job.is_some()
    }

    /// Starts the study again. `prepare` is part of the job: it may take as long as making a mesh.
    pub fn start(&mut self, prepare: impl FnOnce() -> Result<W, StudyError> + Send + 'static) {
        self.cancel();
        self.findings = Some(Findings::default());
        self.job = Some(Job::start(Bench::Waiting(Box::new(prepare))));
    }

    /// Stops the study; its findings stay.
    pub fn cancel(&mut self) {
        if let Some(job) = self.job.take() {
            job.cancelled.store(true, Ordering::Relaxed);
        }
    }

    /// Fetches the findings since the last call.
    pub fn collect(&mut self) {
        let Some(job) = &mut self.job else { return };
        #[cfg(target_arch = "wasm32")]
        job.bench.step(&job.shared, Duration::from_millis(8));
        let shared = job.shared.lock().unwrap_or_else(PoisonError::into_inner);
        if self.findings.as_ref().is_none_or(|known| known.version != shared.version) {
            self.findings = Some(shared.clone());
        }
        let over = shared.progress.finished || shared.trouble.is_some();
        drop(shared);
        if over {
            self.job = None;
        }
    }
}

impl<W: Task> Drop for Study<W> {
    fn drop(&mut self) {
        self.cancel();
    }
}

/// A running job: in a thread of its own, or between frames where there are no threads.
struct Job<W: Task> {
    shared: Arc<Mutex<Findings<W::Results>>>,
    cancelled: Arc<AtomicBool>,
    #[cfg(target_arch = "wasm32")]
    bench: Bench<W>,
}

impl<W: Task> Job<W> {
    fn start(bench: Bench<W>) -> Self {
        let (shared, cancelled) = (Arc::default(), Arc::new(AtomicBool::new(false)));
        #[cfg(not(target_arch = "wasm32"))]
        {
            let (shared, cancelled, mut bench) = (Arc::clone(&shared), Arc::clone(&cancelled), bench);
            std::thread::spawn(move || {
                while !cancelled.load(Ordering::Relaxed) && bench.step(&shared, Duration::from_millis(100)) {}
            });
        }
        Self {
            shared,
            cancelled,
            #[cfg(target_arch = "wasm32")]
            bench,
        }
    }
}

/// State of the work of a job.
enum Bench<W> {
    Waiting(Box<dyn FnOnce() -> Result<W, StudyError> + Send>),
    Working(W),
    Cleared,
}

impl<W: Task> Bench<W> {
    /// Computes for about `budget` and shares the results. Returns whether there is more to do.
    fn step(&mut self, shared: &Mutex<Findings<W::Results>>, budget: Duration) -> bool {
        let begun = match std::mem::replace(self, Self::Cleared) {
            Self::Waiting(prepare) => prepare(),
            Self::Working(work) => Ok(work),
            Self::Cleared => return false,
        };
        let done = begun.and_then(|mut work| {
            let progress = work.advance(budget)?;
            let results = work.results();
            *self = Self::Working(work);
            Ok((progress, results))
        });
        let mut shared = shared.lock().unwrap_or_else(PoisonError::into_inner);
        shared.version += 1;
        match done {
            Ok((progress, results)) => {
                (shared.progress, shared.results) = (progress, results);
                !progress.finished
            }
            Err(error) => {
                shared.trouble = Some(error.to_string());
                false
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Counts to three.
    struct Count(u32);

    impl Task for Count {
        type Results = u32;
        fn advance(&mut self, _: Duration) -> Result<Progress, StudyError> {
            self.0 += 1;
            Ok(Progress { done: f64::from(self.0) / 3.0, finished: self.0 == 3 })
        }
        fn results(&self) -> u32 {
            self.0
        }
    }

    /// It ends when the work is done.
    #[test]
    fn work_shares_its_results_after_every_step() {
        let shared = Mutex::default();
        let mut bench = Bench::Waiting(Box::new(|| Ok(Count(0))));
        for known in 1..=3 {
            assert_eq!(bench.step(&shared, Duration::ZERO), known < 3);
            assert_eq!(shared.lock().map(|shared| shared.results).ok(), Some(known));
        }
    }

    #[test]
    fn what_cannot_be_prepared_is_told_and_ends() {
        let shared = Mutex::default();
        let mut bench: Bench<Count> = Bench::Waiting(Box::new(|| Err(StudyError::NotHere("no mesh"))));
        assert!(!bench.step(&shared, Duration::ZERO) && !bench.step(&shared, Duration::ZERO));
        assert_eq!(shared.lock().ok().and_then(|shared| shared.trouble.clone()), Some("no mesh".to_owned()));
    }
}
