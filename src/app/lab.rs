//! What is measured beside the running scene: the stability limit, the error now, and the diagram of accuracy against time.

use crate::{
    files::Disk,
    sandbox::Sandbox,
    stability::StabilityProbe,
    study::{Curve, Plan, Price, Progress, Suggestion, Trial, Twin, WorkPrecision},
};
use std::{
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    time::Duration,
};

/// Simulated time that the diagram measures [s].
pub const SECONDS: f64 = 1.0;

/// Errors that a cheapest setting is looked for.
pub const TARGETS: [f64; 4] = [0.1, 0.01, 0.001, 0.0001];

/// What the panels may ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wish {
    /// Measure the diagram from the present state.
    Measure,
    /// Stop measuring; what is there stays.
    Cancel,
    /// Run a twin beside the scene, or stop it.
    Twin(bool),
}

/// All studies of a window.
#[derive(Default)]
pub struct Lab {
    probe: StabilityProbe,
    limit: Option<f64>,
    twin: Option<Twin>,
    job: Option<Job>,
    /// The diagram as far as it is.
    diagram: Option<Diagram>,
}

/// What is known of a diagram.
#[derive(Clone, Default)]
pub struct Diagram {
    /// A line for every scheme.
    pub curves: Vec<Curve>,
    /// How far it is.
    pub progress: Progress,
    /// What errors are measured against, with its own error.
    pub reference: Option<(String, f64)>,
    /// The cheapest setting for each of [`TARGETS`], by time and by force evaluations.
    pub suggestions: Vec<[Option<Suggestion>; 2]>,
    /// The table as comma-separated values, once it is complete.
    pub csv: String,
    /// Why there is none.
    pub trouble: Option<String>,
    /// Counts the changes, so that a reader knows when to look.
    version: u64,
}

/// A diagram that is being measured.
struct Job {
    shared: Arc<Mutex<Diagram>>,
    cancelled: Arc<AtomicBool>,
    /// Where there are no threads, the window works on it between frames.
    #[cfg(target_arch = "wasm32")]
    work: WorkPrecision,
}

impl Lab {
    /// Longest stable step of an undamped vibration near the present state [s], as far as it is known.
    pub const fn limit(&self) -> Option<f64> {
        self.limit
    }

    /// The twin that measures the error now.
    pub const fn twin(&self) -> Option<&Twin> {
        self.twin.as_ref()
    }

    /// The diagram as far as it is.
    pub const fn diagram(&self) -> Option<&Diagram> {
        self.diagram.as_ref()
    }

    /// Whether a diagram is being measured.
    pub const fn is_measuring(&self) -> bool {
        self.job.is_some()
    }

    /// Does what a panel asked for.
    pub fn grant(&mut self, wish: Wish, sandbox: &Sandbox) {
        match wish {
            Wish::Measure => self.measure(sandbox),
            Wish::Cancel => self.cancel(),
            Wish::Twin(on) => self.twin = on.then(|| Twin::new(sandbox.simulation())),
        }
    }

    /// Takes note of what the scene does; call it before anything is changed from outside.
    pub fn follow(&mut self, sandbox: &Sandbox) {
        if let Some(twin) = &mut self.twin {
            twin.follow(sandbox.simulation());
        }
    }

    /// Works for a small part of a frame. Returns whether there is more to do.
    pub fn work(&mut self, sandbox: &Sandbox) -> bool {
        let simulation = sandbox.simulation();
        let settled = self.limit.is_some() && !sandbox.is_live();
        self.limit = self.probe.refine(simulation.scene(), simulation.state(), if settled { 1 } else { 2 });
        let behind = self.twin.as_mut().is_some_and(|twin| {
            twin.follow(simulation);
            !twin.advance(simulation, Duration::from_millis(8))
        });
        self.collect();
        behind || self.job.is_some()
    }

    fn measure(&mut self, sandbox: &Sandbox) {
        self.cancel();
        let level = sandbox.saved();
        let mut diagram = Diagram::default();
        match Trial::new(&level, &Disk, SECONDS) {
            Ok(trial) => self.job = Some(Job::start(WorkPrecision::new(trial, Plan::default()), &diagram)),
            Err(error) => diagram.trouble = Some(error.to_string()),
        }
        self.diagram = Some(diagram);
    }

    fn cancel(&mut self) {
        if let Some(job) = self.job.take() {
            job.cancelled.store(true, Ordering::Relaxed);
        }
    }

    /// Fetches what the job has found since the last time.
    fn collect(&mut self) {
        let Some(job) = &mut self.job else { return };
        #[cfg(target_arch = "wasm32")]
        step(&mut job.work, &job.shared, Duration::from_millis(8));
        let shared = job.shared.lock().unwrap_or_else(PoisonError::into_inner);
        if self.diagram.as_ref().is_none_or(|known| known.version != shared.version) {
            self.diagram = Some(shared.clone());
        }
        let over = shared.progress.finished || shared.trouble.is_some();
        drop(shared);
        if over {
            self.job = None;
        }
    }
}

impl Drop for Lab {
    fn drop(&mut self) {
        self.cancel();
    }
}

impl Job {
    fn start(work: WorkPrecision, first: &Diagram) -> Self {
        let shared = Arc::new(Mutex::new(first.clone()));
        let cancelled = Arc::new(AtomicBool::new(false));
        #[cfg(not(target_arch = "wasm32"))]
        {
            let (shared, cancelled) = (Arc::clone(&shared), Arc::clone(&cancelled));
            let mut work = work;
            std::thread::spawn(move || {
                while !cancelled.load(Ordering::Relaxed) && step(&mut work, &shared, Duration::from_millis(100)) {}
            });
        }
        Self {
            shared,
            cancelled,
            #[cfg(target_arch = "wasm32")]
            work,
        }
    }
}

/// Works on a diagram for about `budget` and shares what is known then. Returns whether there is more to do.
fn step(work: &mut WorkPrecision, shared: &Mutex<Diagram>, budget: Duration) -> bool {
    let result = work.advance(budget);
    let curves = work.curves();
    let suggestions =
        TARGETS.map(|target| [Price::Time, Price::ForceEvaluations].map(|price| work.suggest(target, price))).to_vec();
    let mut shared = shared.lock().unwrap_or_else(PoisonError::into_inner);
    shared.version += 1;
    shared.curves = curves;
    shared.suggestions = suggestions;
    shared.reference = work.reference().map(|reference| (reference.source.to_string(), reference.own_error));
    match result {
        Ok(progress) => {
            shared.progress = progress;
            if progress.finished {
                shared.csv = work.csv();
            }
            !progress.finished
        }
        Err(error) => {
            shared.trouble = Some(error.to_string());
            false
        }
    }
}
