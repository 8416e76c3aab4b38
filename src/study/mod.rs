//! Studies of accuracy and processor time: errors against a reference of known accuracy, and measured times.
//!
//! A [`Trial`] is a scene, a start and a simulated time. A [`Reference`] is its solution: exact, or far more accurate
//! than the settings under study, with a bound on its own error. A [`WorkPrecision`] diagram runs the trial with many
//! [`Setting`]s. A [`Suggestion`] is the cheapest of them for an error. A [`MeshStudy`] varies the mesh instead of
//! the step. A [`Twin`] measures the error of a running simulation. A [`Difference`] compares two runs. A [`Drift`]
//! measures the changes of energy and momentum by a scheme. An [`ErrorBudget`] tells how much of the error comes from where. A [`Dial`]
//! finds the cheapest step of each scheme for an error that is wanted.
//!
//! Long computations are jobs: `advance(budget)` works for about that time and returns its [`Progress`]. Partial
//! results can be read at any time. Dropping a job cancels it. Results do not depend on budgets or on the number of
//! threads, except for the measured times.
//!
//! ```
//! use gingerbread::{files, integrators::RungeKutta4, levels, meshes::NoFiles,
//!     study::{Plan, Trial, WorkPrecision}};
//! use std::time::Duration;
//!
//! let level = files::parse(levels::built_in("chain").ok_or("there is no such level")?, "chain.ron")?;
//! let plan = Plan { integrators: vec![RungeKutta4::default().into()], ..Plan::default() };
//! let mut diagram = WorkPrecision::new(Trial::new(&level, &NoFiles, 0.1)?, plan);
//! while !diagram.advance(Duration::from_millis(50))?.finished {}
//! let points = &diagram.curves()[0].points;
//! assert!(points.iter().any(|point| point.outcome.as_ref().is_some_and(|outcome| outcome.error < 1e-3)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod budget;
mod dial;
mod difference;
mod drift;
#[cfg(feature = "csv")]
mod export;
mod locking;
mod march;
mod measure;
mod mesh_study;
mod other_meshes;
mod reference;
mod savings;
mod solutions;
mod trial;
mod twin;
mod work_precision;

pub use budget::{ErrorBudget, Source as ErrorSource, SourceKind};
pub use dial::{Dial, DialPlan, Reached};
pub use difference::{Apart, Difference, counterpart};
pub use drift::{Drift, DriftRun, Invariant, Moment};
#[cfg(feature = "csv")]
pub use export::{Origin, head, is_time_column, price_in_words};
pub use locking::{Locking, LockingNumber, MeshKindOf};
pub(crate) use march::{Deadline, spread};
pub use march::{MOST_RUNS, share_partitions, threads};
pub use measure::Measure;
pub use mesh_study::{
    MeshMoment, MeshPlan, MeshPoint, MeshReference, MeshSeries, MeshStudy, NoMeshReference, Refinement,
};
pub(crate) use other_meshes::with_triangles;
pub use reference::{
    ErrorNote, Limits, MeasuredOrder, NoOrder, Reference, ReferenceJob, Sample, Source, measured_order, order_in_words,
};
pub use savings::{Saving, Savings};
pub use solutions::ClosedForm;
pub use trial::{Outcome, Setting, Status, Trial, TrialRun, ladder};
pub use twin::Twin;
pub use work_precision::{Curve, NoErrors, Plan, Point, Price, Suggestion, USUAL_ERRORS, WorkPrecision};

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
    /// A run stopped with a fault.
    #[error("it stopped: {0}")]
    Stopped(Box<Fault>),
    /// The level lacks what this study needs.
    #[error("{0}")]
    NotHere(&'static str),
}
