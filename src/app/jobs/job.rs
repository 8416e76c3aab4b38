//! A study in the background: started, polled and cancelled.

use crate::study::{Progress, StudyError};
use std::{
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    time::Duration,
};

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
