//! Studies of accuracy and processor time: errors against a reference of known accuracy, and measured times.
//!
//! A [`Trial`] is a scene, a start and a simulated time. A [`Reference`] is its solution: exact, or far more accurate
//! than the settings under study, with a bound on its own error. A [`WorkPrecision`] diagram runs the trial with many
//! [`Setting`]s. A [`Suggestion`] is the cheapest of them for an error. A [`MeshStudy`] varies the mesh instead of
//! the step. A [`Twin`] measures the error of a running simulation. A [`Difference`] compares two runs. A [`Drift`]
//! measures the changes of energy and momentum by a scheme.
//!
//! Long computations are jobs: `advance(budget)` works for about that time and returns its [`Progress`]. Partial
//! results can be read at any time. Dropping a job cancels it. Results do not depend on budgets or on the number of
//! threads, except for the measured times.

mod difference;
mod drift;
mod exact;
#[cfg(feature = "csv")]
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
#[cfg(feature = "csv")]
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

/// Progress of a job.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Progress {
    /// Estimated share of the work done, in [0, 1].
    pub done: f64,
    /// Whether the job is finished.
    pub finished: bool,
}

impl Progress {
    /// Progress of a finished job.
    pub const FINISHED: Self = Self { done: 1.0, finished: true };
}

/// Reason why a study is impossible.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StudyError {
    /// The level cannot be built.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The run for the reference stopped with a fault.
    #[error("there is no reference to measure errors against, as it stopped at {substeps} substeps: {fault}")]
    NoReference {
        /// Steps per 1/60 s of the last attempt.
        substeps: u32,
        /// Fault that stopped it.
        fault: Box<Fault>,
    },
    /// The level lacks what this study needs.
    #[error("{0}")]
    NotHere(&'static str),
}
