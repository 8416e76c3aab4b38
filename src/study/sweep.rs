//! The work-precision diagram: one trial with many settings.

use super::{
    Outcome, Progress, Reference, ReferenceJob, Run, Setting, Status, StudyError, Trial, fit::steady_slope, ladder,
    march::Deadline, setting::limit, threads, workers::spread,
};
use crate::{
    integrators::{Class, IntegratorKind},
    level::Substeps,
};
use std::time::Duration;

/// What to sweep over.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The schemes.
    pub integrators: Vec<IntegratorKind>,
    /// Steps per 1/60 s for every scheme that does not control its error; if empty, what suits each scheme (see [`ladder`]).
    pub substeps: Vec<Substeps>,
    /// The smallest error of interest: the reference is a hundred times better, if it can be had.
    pub smallest_error: f64,
    /// How many runs go on at once. The results are the same for every number.
    pub threads: usize,
}

impl Default for Plan {
    fn default() -> Self {
        Self { integrators: IntegratorKind::all(), substeps: Vec::new(), smallest_error: 5e-6, threads: threads() }
    }
}

/// One setting and what came out of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// How the trial was stepped.
    pub setting: Setting,
    /// What came out; `None` as long as it has not run to its end.
    pub outcome: Option<Outcome>,
    /// Whether this is how the level itself is stepped.
    pub current: bool,
}

/// All points of one scheme, from the longest step to the shortest.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// The scheme, with the parameters it has by default.
    pub integrator: IntegratorKind,
    /// The points.
    pub points: Vec<Point>,
    /// Measured order: how steeply the error falls with the number of steps; `None` if there are too few points to tell.
    ///
    /// Least squares of log error over log steps (of an error-controlled scheme: taken and rejected inner steps), in the
    /// asymptotic regime: points with an error of at most 10 % and above the floor of the reference, beginning
    /// with the two finest and going on to coarser ones while the local slope stays within 0.3 of theirs.
    pub order: Option<f64>,
}

/// A point with the run that works on it.
struct Slot {
    curve: usize,
    point: Point,
    run: Option<Box<Run>>,
    /// About how much work it is, in force evaluations a frame.
    weight: f64,
}

/// The diagram as a job.
pub struct WorkPrecision {
    trial: Trial,
    plan: Plan,
    reference: ReferenceJob,
    /// In the order they are run: the cheapest first.
    slots: Vec<Slot>,
}

impl WorkPrecision {
    /// Prepares a diagram of a trial, of those schemes of the plan that suit it. The trial's current setting is one of the points if its scheme is in the plan.
    pub fn new(trial: Trial, mut plan: Plan) -> Self {
        plan.integrators.retain(|integrator| trial.suits(integrator));
        let reference = ReferenceJob::new(&trial, plan.smallest_error);
        let limit = limit(&trial.scene, &trial.start);
        let mut slots = Vec::new();
        for (curve, integrator) in plan.integrators.iter().enumerate() {
            for (setting, current) in settings(integrator, &trial, &plan.substeps) {
                let weight = weight(&setting, limit);
                slots.push(Slot { curve, point: Point { setting, outcome: None, current }, run: None, weight });
            }
        }
        slots.sort_by(|a, b| a.weight.total_cmp(&b.weight));
        Self { trial, plan, reference, slots }
    }

    /// What is run.
    pub const fn trial(&self) -> &Trial {
        &self.trial
    }

    /// What is swept over.
    pub const fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Works for about `budget`.
    ///
    /// # Errors
    /// If there is no reference to measure errors against.
    pub fn advance(&mut self, budget: Duration) -> Result<Progress, StudyError> {
        let deadline = Deadline::after(budget);
        let finding = self.reference.until(&self.trial, self.plan.threads, deadline);
        let reference = match self.reference.result() {
            Some(Ok(reference)) => reference,
            Some(Err(error)) => return Err(error.clone()),
            None => return Ok(Progress { done: REFERENCE_SHARE * finding.done, finished: false }),
        };
        let trial = &self.trial;
        let open = self.slots.iter_mut().filter(|slot| slot.point.outcome.is_none()).collect();
        spread(self.plan.threads, open, |slot: &mut Slot| {
            let run = slot.run.get_or_insert_with(|| Box::new(Run::new(trial, &slot.point.setting)));
            slot.point.outcome = run.until(trial, reference, deadline);
            let over = slot.point.outcome.is_some();
            if over {
                slot.run = None;
            }
            over && !deadline.passed()
        });
        Ok(self.progress())
    }

    fn progress(&self) -> Progress {
        let total: f64 = self.slots.iter().map(|slot| slot.weight).sum();
        let share = |slot: &Slot| match (&slot.point.outcome, &slot.run) {
            (Some(_), _) => 1.0,
            (None, Some(run)) => run.done(),
            (None, None) => 0.0,
        };
        let done = self.slots.iter().map(|slot| slot.weight * share(slot)).sum::<f64>() / total.max(1.0);
        let finished = self.slots.iter().all(|slot| slot.point.outcome.is_some());
        Progress { done: if finished { 1.0 } else { REFERENCE_SHARE + (1.0 - REFERENCE_SHARE) * done }, finished }
    }

    /// What errors are measured against, once it is known.
    pub fn reference(&self) -> Option<&Reference> {
        self.reference.result().and_then(|result| result.as_ref().ok())
    }

    /// The diagram as far as it is: a line for every scheme, in the order of the plan.
    pub fn curves(&self) -> Vec<Curve> {
        let floor = self.reference().map_or(0.0, Reference::floor);
        let curve = |(number, integrator): (usize, &IntegratorKind)| {
            let own = self.slots.iter().filter(|slot| slot.curve == number);
            let mut points: Vec<_> = own.map(|slot| slot.point.clone()).collect();
            points.sort_by(|a, b| place(&a.setting).total_cmp(&place(&b.setting)));
            let order = order(&points, floor);
            Curve { integrator: integrator.clone(), points, order }
        };
        self.plan.integrators.iter().enumerate().map(curve).collect()
    }
}

/// About how large a share of the work the reference is.
const REFERENCE_SHARE: f64 = 0.1;

/// Where a setting stands on its curve: the more accurate, the greater.
fn place(setting: &Setting) -> f64 {
    setting.tolerance().map_or(1.0, |tolerance| 1.0 / tolerance) * f64::from(setting.substeps.get())
}

/// The settings of one curve, and which of them is the current one.
fn settings(integrator: &IntegratorKind, trial: &Trial, substeps: &[Substeps]) -> Vec<(Setting, bool)> {
    let mut settings = if substeps.is_empty() || integrator.kind().class() == Class::ErrorControlled {
        ladder(integrator, &trial.scene, &trial.start)
    } else {
        substeps.iter().map(|&substeps| Setting { integrator: integrator.clone(), substeps }).collect()
    };
    if trial.current.integrator.name() == integrator.name() && !settings.contains(&trial.current) {
        settings.push(trial.current.clone());
    }
    settings.into_iter().map(|setting| (setting.clone(), setting == trial.current)).collect()
}

/// About how many force evaluations a frame takes; a solve is counted as 40. Only order and progress depend on it.
fn weight(setting: &Setting, limit: f64) -> f64 {
    let substeps = f64::from(setting.substeps.get());
    let kind = setting.integrator.kind();
    let order = f64::from(kind.order());
    match kind.class() {
        Class::Explicit => substeps * order,
        Class::Implicit => substeps * 40.0,
        Class::ErrorControlled => {
            let tolerance = setting.tolerance().unwrap_or(1e-3);
            substeps.max(limit * libm::pow(1e-2 / tolerance, 1.0 / order)) * (order + 2.0)
        }
    }
}

/// See [`Curve::order`].
fn order(points: &[Point], floor: f64) -> Option<f64> {
    let asymptotic = |point: &Point| {
        let outcome = point.outcome.as_ref().filter(|outcome| outcome.status == Status::Ok)?;
        let steps = (outcome.counts.inner_steps + outcome.counts.rejected) as f64;
        (outcome.error > floor.max(1e-13) && outcome.error <= 0.1).then(|| [libm::log(steps), libm::log(outcome.error)])
    };
    let mut finest_first: Vec<_> = points.iter().rev().filter_map(asymptotic).collect();
    finest_first.dedup_by(|a, b| a[0] == b[0]);
    steady_slope(&finest_first).map(|slope| -slope)
}
