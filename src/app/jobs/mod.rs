//! Study jobs: everything that is measured beside the running scene.

mod hard;
mod job;
mod studies;

pub use hard::{Choice, Hard, Known};
pub use job::{Findings, Study};
pub use studies::{Course, Courses, Diagram, Mesh, MeshFindings, Meshes, SECONDS, TARGETS};

use super::advice::Limit;
use crate::{
    command::Mode,
    level::Level,
    sandbox::Sandbox,
    stability::StabilityProbe,
    state::State,
    study::{Drift, Measure, Savings, Twin, WorkPrecision},
};
use std::{sync::Arc, time::Duration};

/// For how many coordinates, about as many as there are triangles, the stability limit is looked for in one frame: two rounds for so many
/// take a third of a millisecond.
const PER_FRAME: usize = 7500;
/// Rounds of a look while something moves, and at most while nothing does.
const ROUNDS: [usize; 2] = [2, 16];
/// A change of the limit by a look, as a share of it, at which it is settled.
const SETTLED: f64 = 5e-5;

/// What a study is about.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Topic {
    /// Errors of schemes and steps against time: the work-precision diagram.
    #[default]
    Accuracy,
    /// Errors of meshes against time.
    Meshes,
    /// Energy and momentum over time.
    Drift,
}

/// What the panels may ask for. There is one study at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum JobRequest {
    /// Measure the work-precision diagram from the present state.
    Accuracy,
    /// Compare meshes by this.
    Meshes(Measure),
    /// Follow energy and momentum from the present state for so long [s].
    Drift(f64),
    /// Run hard cases.
    Hard(Choice),
    /// Stop the study that is worked on; what is known stays.
    Cancel,
    /// Measure what passing effects over saves.
    Savings,
    /// Run a twin beside the scene, or stop it.
    Twin(bool),
}

/// All studies of a window.
#[derive(Default)]
pub struct Jobs {
    probe: StabilityProbe,
    limit: Option<f64>,
    /// Frames since the probe was last worked on.
    unprobed: usize,
    /// The shape for which the limit has settled.
    settled: Option<u64>,
    rest: RestLimit,
    twin: Option<Twin>,
    /// The work-precision diagram.
    pub accuracy: Study<WorkPrecision>,
    /// The price of spatial accuracy.
    pub meshes: Study<Meshes>,
    /// Energy and momentum over time.
    pub drift: Study<Drift>,
    /// The gallery of hard cases.
    pub hard: Study<Hard>,
    /// What passing effects over saves.
    pub savings: Study<Savings>,
}

/// The longest stable step of a scene at rest, measured once somebody asks for it.
#[derive(Default)]
struct RestLimit {
    /// The level and the mode that it is measured for.
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
        let limit = rest.probe.refine(scene, &state, rounds).map(|limit| 0.5 * reach * limit);
        rest.settled = match (rest.limit, limit) {
            (Some(before), Some(now)) => (before - now).abs() <= SETTLED * now,
            (_, None) => true,
            (None, _) => false,
        };
        rest.limit = limit;
        !rest.settled
    }

    /// Longest stable step of an undamped vibration near the present state [s], as far as it is known.
    pub const fn limit(&self) -> Option<f64> {
        self.limit
    }

    /// The twin that measures the error now.
    pub const fn twin(&self) -> Option<&Twin> {
        self.twin.as_ref()
    }

    /// Whether a study is being worked on.
    pub const fn is_running(&self, topic: Topic) -> bool {
        match topic {
            Topic::Accuracy => self.accuracy.is_running(),
            Topic::Meshes => self.meshes.is_running(),
            Topic::Drift => self.drift.is_running(),
        }
    }

    /// Whether any study is being worked on.
    pub const fn is_busy(&self) -> bool {
        self.accuracy.is_running()
            || self.meshes.is_running()
            || self.drift.is_running()
            || self.hard.is_running()
            || self.savings.is_running()
    }

    /// How much of a study is done, if it was ever begun.
    pub fn done(&self, topic: Topic) -> Option<f64> {
        match topic {
            Topic::Accuracy => self.accuracy.findings().map(|findings| findings.progress.done),
            Topic::Meshes => self.meshes.findings().map(|findings| findings.progress.done),
            Topic::Drift => self.drift.findings().map(|findings| findings.progress.done),
        }
    }

    /// Does what a panel asked for.
    pub fn grant(&mut self, request: JobRequest, sandbox: &Sandbox) {
        if !matches!(request, JobRequest::Twin(_)) {
            // Two at once would disturb each other's times.
            self.cancel();
        }
        let level = || sandbox.saved();
        match request {
            JobRequest::Accuracy => {
                let level = level();
                self.accuracy.start(move || studies::accuracy(&level));
            }
            JobRequest::Meshes(measure) => {
                let level = level();
                self.meshes.start(move || studies::meshes(&level, measure));
            }
            JobRequest::Drift(seconds) => {
                let level = level();
                self.drift.start(move || studies::drift(&level, seconds));
            }
            JobRequest::Hard(choice) => {
                let known = self.hard.findings().map(|findings| findings.results.clone()).unwrap_or_default();
                self.hard.start(move || Hard::new(choice, known));
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
        self.meshes.cancel();
        self.drift.cancel();
        self.hard.cancel();
        self.savings.cancel();
    }

    /// Takes note of what the scene does; call it before anything is changed from outside.
    pub fn follow(&mut self, sandbox: &Sandbox) {
        if let Some(twin) = &mut self.twin {
            twin.follow(sandbox.simulation());
        }
    }

    /// Works for a small part of a frame; looks for the longest stable step only where that is shown. Returns whether there is
    /// more to do.
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
        self.meshes.collect();
        self.drift.collect();
        self.hard.collect();
        self.savings.collect();
        behind || self.is_busy() || doubtful && !sandbox.is_busy()
    }

    /// Looks for the longest stable step.
    fn probe(&mut self, sandbox: &Sandbox) {
        let (simulation, size) = (sandbox.simulation(), sandbox.simulation().scene().rest.len());
        let [few, many] = ROUNDS;
        let (rounds, per_frame) = if sandbox.is_busy() {
            (few, PER_FRAME)
        } else {
            ((many * PER_FRAME / size.max(1)).clamp(few, many), many / few * PER_FRAME)
        };
        // The limit moves slowly and a look at it costs as much as some steps: a large scene is looked at every few frames.
        self.unprobed += 1;
        if self.limit.is_some() && self.unprobed <= size / per_frame {
            return;
        }
        self.unprobed = 0;
        let limit = self.probe.refine(simulation.scene(), simulation.state(), rounds);
        let settled = match (self.limit, limit) {
            (Some(before), Some(now)) => (before - now).abs() <= SETTLED * now,
            (_, None) => true,
            (None, _) => false,
        };
        (self.limit, self.settled) = (limit, settled.then_some(simulation.shape()));
    }
}
