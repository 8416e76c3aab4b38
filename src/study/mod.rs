//! What accuracy costs in time, measured: errors against a reference that is known to be better, beside the time they took.
//!
//! A [`Trial`] is a scene, a start and a simulated time. A [`Reference`] is its solution, exact or far more accurate than what
//! is asked about, with a bound on its own error. A [`WorkPrecision`] diagram runs the trial with many [`Setting`]s and a
//! [`Suggestion`] is the cheapest of them. A [`MeshStudy`] varies the mesh in place of the step, a [`Twin`] tells the error of a
//! running simulation, a [`Difference`] how far two runs are apart, a [`Drift`] what a scheme does to energy and momentum.
//!
//! Whatever takes long is a job: `advance(budget)` works for about that long and returns its [`Progress`]. What is there can
//! be read at any time, and dropping a job cancels it. Results do not depend on budgets or on the number of threads, except for
//! the measured times.

mod difference;
mod drift;
mod exact;
mod export;
mod locking;
mod march;
mod measure;
mod mesh_study;
mod order;
mod reference;
mod refine;
mod repetition;
mod savings;
mod setting;
mod statics;
mod stopwatch;
mod strip;
mod suggestion;
mod sweep;
mod trial;
mod twin;
mod workers;

pub use difference::{Apart, Correspondence, Difference, counterpart};
pub use drift::{Drift, DriftRun, Invariant, Moment};
pub use exact::ClosedForm;
pub use export::{Origin, head, is_time_column, price_in_words};
pub use locking::{Locking, LockingNumber, MeshKindOf};
pub use measure::Measure;
pub use mesh_study::{MeshMoment, MeshPlan, MeshPoint, MeshReference, MeshStudy, NoMeshReference};
pub use order::{Limits, MeasuredOrder, NoOrder, Sample, measured_order, order_in_words};
pub use reference::{ErrorNote, Reference, ReferenceJob, Source};
pub use repetition::MOST_RUNS;
pub use savings::{Saving, Savings};
pub use setting::{Setting, ladder};
pub use stopwatch::CLOCK;
pub use suggestion::{NoErrors, Price, Suggestion, USUAL_ERRORS};
pub use sweep::{Curve, Plan, Point, WorkPrecision};
pub use trial::{Outcome, Status, Trial, TrialRun};
pub use twin::Twin;
pub use workers::{share_partitions, threads};
pub(crate) use {march::Deadline, refine::with_triangles, workers::spread};

use crate::{fault::Fault, scene::SceneError};

/// How far a job is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Progress {
    /// Share of the work done, by an estimate, in [0, 1].
    pub done: f64,
    /// Whether there is nothing left to do.
    pub finished: bool,
}

impl Progress {
    /// Nothing left to do.
    pub const FINISHED: Self = Self { done: 1.0, finished: true };
}

/// Why there is nothing to study.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StudyError {
    /// The level cannot be built.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// Even the finest reference stopped.
    #[error("there is no reference to measure errors against, as it stopped at {substeps} substeps: {fault}")]
    NoReference {
        /// Steps per 1/60 s of the last attempt.
        substeps: u32,
        /// Why it stopped.
        fault: Box<Fault>,
    },
    /// The level does not have what this study is about.
    #[error("{0}")]
    NotHere(&'static str),
}
