//! Reference solutions, which are closed forms or runs with a much finer step; and the order of convergence to them.

use super::{
    ClosedForm, Progress, Setting, StudyError,
    march::{Deadline, March, spread},
    trial::{Deviation, Trial, limit},
};
use crate::{
    integrators::{Class, IntegratorKind},
    level::Substeps,
};
use std::{ops::ControlFlow, time::Duration};

/// Reference solution of a trial at the end of every frame.
#[derive(Clone, Debug)]
pub struct Reference {
    /// Source of the solution.
    pub source: Source,
    /// Upper bound of its own relative RMS error; zero if it is exact.
    /// A fine run is compared with a run of twice its step. For every convergent scheme the difference exceeds the
    /// error of the finer run.
    pub own_error: f64,
    /// Motion of the scene: root mean square over frames and vertices \[m\].
    pub motion: f64,
    /// Greatest coordinate at the start \[m\].
    extent: f64,
    frames: Vec<Vec<f64>>,
}

/// Reason why a small error is not that of the setting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorNote {
    /// It is round-off.
    RoundOff,
    /// It cannot be distinguished from the error of the reference.
    NearReference,
}

impl ErrorNote {
    /// Reason in plain words.
    pub const fn words(self) -> &'static str {
        match self {
            Self::RoundOff => "round-off",
            Self::NearReference => "near the error of the reference",
        }
    }
}

impl Limits {
    /// Reason why an error is too small to be that of the setting. `None` if it is large enough.
    pub fn note(self, error: f64) -> Option<ErrorNote> {
        if error <= self.round_off {
            Some(ErrorNote::RoundOff)
        } else if error <= self.reference {
            Some(ErrorNote::NearReference)
        } else {
            None
        }
    }
}

/// Motion below this share of the greatest coordinate is round-off.
pub(super) const STILL: f64 = 1e-12;
/// Rounding error of a coordinate after many steps, as a share of the greatest coordinate.
const ROUNDING: f64 = 1e-13;

/// Source of a reference.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// Closed form, described in plain words.
    Exact(String),
    /// Run with a fine step.
    Fine(Setting),
}

impl std::fmt::Display for Source {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Exact(form) => write!(out, "exact: {form}"),
            Self::Fine(setting) => write!(out, "{}, checked by halving its step", setting.label()),
        }
    }
}

impl Reference {
    fn new(source: Source, own_error: f64, frames: Vec<Vec<f64>>, trial: &Trial) -> Self {
        let (motion, extent) = sizes(&frames, trial);
        Self { source, own_error, motion, extent, frames }
    }

    /// Greatest coordinate at the start \[m\].
    pub(super) const fn extent(&self) -> f64 {
        self.extent
    }

    /// Whether nothing moves. There are then no relative errors.
    pub fn is_still(&self) -> bool {
        self.motion <= STILL * self.extent
    }

    /// Relative error by rounding.
    pub fn round_off(&self) -> f64 {
        ROUNDING * self.extent.max(self.motion) / self.motion
    }

    /// Limits above which an error differs from rounding and from the error of the reference.
    pub fn limits(&self) -> Limits {
        Limits { round_off: self.round_off(), reference: self.floor() }
    }

    /// Ten times the reference's own error. Smaller errors cannot be distinguished from it.
    pub fn floor(&self) -> f64 {
        10.0 * self.own_error
    }

    /// Positions at the end of a frame, counted from 1.
    pub(super) fn at(&self, frame: u32) -> &[f64] {
        self.frames.get((frame as usize).saturating_sub(1)).map_or(&[], Vec::as_slice)
    }
}

/// Run that records the positions of every frame.
struct Recorded {
    march: March,
    substeps: Substeps,
    frames: Vec<Vec<f64>>,
    over: bool,
}

impl Recorded {
    fn new(trial: &Trial, integrator: &IntegratorKind, substeps: Substeps) -> Self {
        let setting = Setting { integrator: integrator.clone(), substeps };
        Self { march: trial.march(&setting), substeps, frames: Vec::new(), over: false }
    }

    fn until(&mut self, deadline: Deadline) {
        let frames = &mut self.frames;
        self.over = self.over
            || self.march.advance(deadline, &mut |_, simulation| {
                frames.push(simulation.state().x.clone());
                ControlFlow::Continue(())
            });
    }

    fn failed(&self) -> bool {
        self.march.simulation.fault().is_some()
    }
}

/// Search for a reference of a trial, as a job.
///
/// Without a closed form, the explicit scheme of the highest order runs with a step and with half of it. The step is
/// halved until the two runs differ by less than a hundredth of the smallest error of interest. It also ends when
/// halving no longer reduces the difference, or costs too much. In contact no scheme keeps its order: symplectic
/// Euler, the cheapest, replaces the scheme.
pub struct ReferenceJob {
    integrator: IntegratorKind,
    coarse: Recorded,
    fine: Recorded,
    /// Number of finished pairs of runs.
    rounds: i32,
    /// Difference of the previous pair of runs.
    before: f64,
    wanted: f64,
    touching: bool,
    spent: Duration,
    result: Option<Result<Reference, StudyError>>,
}

/// Work limit of one run [force evaluations times vertices], about 20 s.
const MOST_WORK: f64 = 5e8;

impl ReferenceJob {
    /// Begins the search for a reference for errors down to `smallest_error`.
    pub fn new(trial: &Trial, smallest_error: f64) -> Self {
        let exact = ClosedForm::of_trial(trial).map(|form| {
            let at = |frame: u32| form.positions(trial.start.time + f64::from(frame) / 60.0);
            let frames = (1..=trial.frames).map(at).collect();
            Ok(Reference::new(Source::Exact(form.words), 0.0, frames, trial))
        });
        let integrator = finest();
        let first = Substeps::nearest(2.0 * limit(&trial.scene, &trial.start));
        let [coarse, fine] = [first, first.doubled()].map(|substeps| Recorded::new(trial, &integrator, substeps));
        let (before, wanted) = (f64::INFINITY, 0.01 * smallest_error);
        Self {
            integrator,
            coarse,
            fine,
            rounds: 0,
            before,
            wanted,
            touching: false,
            spent: Duration::ZERO,
            result: exact,
        }
    }

    /// Works for about `budget`.
    pub fn advance(&mut self, trial: &Trial, threads: usize, budget: Duration) -> Progress {
        self.until(trial, threads, Deadline::after(budget))
    }

    pub(super) fn until(&mut self, trial: &Trial, threads: usize, deadline: Deadline) -> Progress {
        while self.result.is_none() {
            // The longer run comes first, so that two threads finish sooner.
            spread(threads, vec![&mut self.fine, &mut self.coarse], |run| {
                run.until(deadline);
                run.over
            });
            if !(self.fine.over && self.coarse.over) {
                // The number of further rounds is unknown. Each round counts as half of the remaining work.
                let pair = 0.25 * (self.fine.march.done() + self.coarse.march.done());
                return Progress { done: 1.0 - libm::pow(0.5, f64::from(self.rounds)) * (1.0 - pair), finished: false };
            }
            self.rounds += 1;
            self.spent += self.fine.march.spent + self.coarse.march.spent;
            self.judge(trial);
        }
        Progress::FINISHED
    }

    /// Reference, once it is found.
    pub const fn result(&self) -> Option<&Result<Reference, StudyError>> {
        self.result.as_ref()
    }

    /// Takes the fine run as the reference, or prepares the next pair.
    fn judge(&mut self, trial: &Trial) {
        let failed = self.fine.failed();
        let counts = self.fine.march.simulation.counts();
        if !failed && counts.constrained > 0 && !self.touching {
            self.touching = true;
            self.integrator = IntegratorKind::default();
            let [first, second] = [self.fine.substeps, self.fine.substeps.doubled()];
            self.coarse = Recorded::new(trial, &self.integrator, first);
            self.fine = Recorded::new(trial, &self.integrator, second);
            self.before = f64::INFINITY;
            return;
        }
        let difference = if failed { f64::INFINITY } else { self.difference(trial) };
        let per_step = counts.force_evaluations as f64 / counts.steps.max(1) as f64;
        let steps = 2.0 * f64::from(self.fine.substeps.get()) * f64::from(trial.frames);
        let affordable = steps * per_step * trial.scene.vertices().max(1) as f64 <= MOST_WORK
            && self.fine.substeps.get() < Substeps::MAX;
        let helps = difference < 0.7 * self.before || difference > 1e-2;
        if difference > self.wanted && affordable && helps && !self.is_still(trial) {
            let next = Recorded::new(trial, &self.integrator, self.fine.substeps.doubled());
            self.coarse = std::mem::replace(&mut self.fine, next);
            self.before = difference;
            return;
        }
        let substeps = self.fine.substeps;
        self.result = Some(if let Some(fault) = self.fine.march.simulation.fault() {
            Err(StudyError::NoReference { substeps: substeps.get(), fault: Box::new(fault.clone()) })
        } else {
            let source = Source::Fine(Setting { integrator: self.integrator.clone(), substeps });
            Ok(Reference::new(source, difference, std::mem::take(&mut self.fine.frames), trial))
        });
    }

    /// Whether nothing moves in the fine run. A finer run would add nothing.
    fn is_still(&self, trial: &Trial) -> bool {
        let (motion, extent) = sizes(&self.fine.frames, trial);
        !self.fine.failed() && motion <= STILL * extent
    }

    /// Processor time of all finished runs.
    pub(super) const fn spent(&self) -> Duration {
        self.spent
    }

    /// Difference of the two runs as a relative RMS error.
    fn difference(&self, trial: &Trial) -> f64 {
        if self.coarse.failed() {
            return f64::INFINITY;
        }
        let mut deviation = Deviation::new(trial.scene.dimension);
        for (coarse, fine) in self.coarse.frames.iter().zip(&self.fine.frames) {
            deviation.add(coarse, fine, &trial.start.x);
        }
        deviation.relative()
    }
}

/// Root mean square of the motion over the frames, and greatest coordinate at the start \[m\].
fn sizes(frames: &[Vec<f64>], trial: &Trial) -> (f64, f64) {
    let (mut deviation, start) = (Deviation::new(trial.scene.dimension), &trial.start.x);
    for frame in frames {
        deviation.add(frame, frame, start);
    }
    (deviation.motion(), start.iter().fold(0.0, |greatest: f64, x| greatest.max(x.abs())))
}

/// Explicit scheme of the highest order.
pub(super) fn finest() -> IntegratorKind {
    let explicit = IntegratorKind::all().into_iter().filter(|kind| kind.kind().class() == Class::Explicit);
    // Chooses the first of equals: `max_by_key` alone takes the last.
    explicit.rev().max_by_key(|kind| kind.kind().order()).unwrap_or_default()
}

/// Lower limits of errors that can be used to measure an order.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Limits {
    /// Relative error by rounding.
    pub round_off: f64,
    /// Upper limit of the relative error of the reference.
    pub reference: f64,
}

/// Step or triangle size, and the relative error for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Step \[s\] or size \[m\]. Only ratios matter.
    pub h: f64,
    /// Relative error.
    pub error: f64,
}

/// Reason why no order can be measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoOrder {
    /// Nothing moves, so there are no relative errors.
    #[error("nothing moves")]
    NothingMoves,
    /// There is no reference for errors.
    #[error("no reference")]
    NoReference,
    /// Fewer than three sizes were measured.
    #[error("too few points")]
    TooFewPoints,
    /// Errors are round-off.
    #[error("errors are round-off")]
    RoundOff,
    /// Errors are above a quarter of the motion.
    #[error("errors at the size of the motion")]
    SizeOfMotion,
    /// Errors are not far enough above the error of the reference.
    #[error("reference not fine enough")]
    CoarseReference,
    /// The error does not fall with every refinement.
    #[error("errors not monotone")]
    NotMonotone,
    /// The local slopes of the finest points differ.
    #[error("slopes do not agree")]
    SlopesDiffer,
    /// The agreeing points span less than a factor of 4.
    #[error("sizes span less than a factor 4")]
    ShortSpan,
}

/// Measured order, or the reason why there is none.
pub type MeasuredOrder = Result<f64, NoOrder>;

/// Greatest error that is used. Larger errors have the size of the motion.
const GREATEST: f64 = 0.25;
/// Least number of points of an order.
const FEWEST: usize = 3;
/// Greatest difference of a local slope from the slope of the two finest points.
const TOLERANCE: f64 = 0.2;
/// Least ratio of the greatest to the least size, with a margin for rounding.
const SPAN: f64 = 4.0 * (1.0 - 1e-6);

/// Measured order: the slope of log error over log h by least squares.
/// The fit begins with the finest point. It goes on to coarser points while the error grows and the local slope is
/// within 0.2 of the slope of the two finest points. It needs at least three points that span at least a factor of 4
/// in h. Their errors are at most 25 %, above round-off and above the limit of the reference.
///
/// # Errors
/// [`NoOrder`] if no order can be measured.
pub fn measured_order(samples: impl IntoIterator<Item = Sample>, limits: Limits) -> MeasuredOrder {
    let mut finest_first: Vec<_> = samples.into_iter().filter(|sample| sample.h > 0.0).collect();
    finest_first.sort_by(|a, b| a.h.total_cmp(&b.h));
    finest_first.dedup_by(|a, b| a.h == b.h);
    if finest_first.len() < FEWEST {
        return Err(NoOrder::TooFewPoints);
    }
    let judge = |sample: &Sample| {
        if sample.error <= limits.round_off {
            Some(NoOrder::RoundOff)
        } else if sample.error <= limits.reference {
            Some(NoOrder::CoarseReference)
        } else if sample.error <= GREATEST {
            None
        } else {
            Some(NoOrder::SizeOfMotion)
        }
    };
    let usable: Vec<_> = finest_first
        .iter()
        .skip_while(|sample| matches!(judge(sample), Some(NoOrder::RoundOff | NoOrder::CoarseReference)))
        .take_while(|sample| judge(sample).is_none())
        .map(|sample| [libm::log(sample.h), libm::log(sample.error)])
        .collect();
    if usable.len() < FEWEST {
        let reasons = || finest_first.iter().filter_map(judge);
        let count = |reason: &NoOrder| reasons().filter(|other| other == reason).count();
        return Err(reasons().max_by_key(count).unwrap_or(NoOrder::TooFewPoints));
    }
    let slope = |a: &[f64; 2], b: &[f64; 2]| (a[1] - b[1]) / (a[0] - b[0]);
    let finest = slope(&usable[0], &usable[1]);
    let agrees = |slope: f64| slope > 0.0 && (slope - finest).abs() <= TOLERANCE;
    let steady = usable.windows(2).take_while(|pair| agrees(slope(&pair[0], &pair[1]))).count();
    let fitted = &usable[..=steady];
    if fitted.len() < FEWEST {
        let falls = usable.windows(2).take(FEWEST - 1).all(|pair| slope(&pair[0], &pair[1]) > 0.0);
        return Err(if falls { NoOrder::SlopesDiffer } else { NoOrder::NotMonotone });
    }
    if fitted.last().map_or(0.0, |last| last[0] - fitted[0][0]) < libm::log(SPAN) {
        return Err(NoOrder::ShortSpan);
    }
    let mean = |axis: usize| fitted.iter().map(|point| point[axis]).sum::<f64>() / fitted.len() as f64;
    let [x, y] = [mean(0), mean(1)];
    let covariance: f64 = fitted.iter().map(|point| (point[0] - x) * (point[1] - y)).sum();
    let variance: f64 = fitted.iter().map(|point| (point[0] - x) * (point[0] - x)).sum();
    Ok(covariance / variance)
}

/// Order for a table: the number, or `not measurable here` and the reason.
pub fn order_in_words(order: &MeasuredOrder) -> String {
    match order {
        Ok(order) => format!("{order:.2}"),
        Err(reason) => format!("not measurable here: {reason}"),
    }
}
