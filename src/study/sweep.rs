//! Work-precision diagram: one trial with many settings.

use super::{
    MeasuredOrder, NoErrors, NoOrder, Outcome, Progress, Reference, ReferenceJob, Sample, Setting, Status, StudyError,
    Trial, TrialRun, ladder,
    march::{Deadline, March},
    measured_order,
    repetition::Repetitions,
    setting::limit,
    threads,
    workers::spread,
};
use crate::{
    integrators::{Class, IntegratorKind},
    level::Substeps,
};
use std::time::Duration;

/// Plan of a work-precision diagram.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Integrators.
    pub integrators: Vec<IntegratorKind>,
    /// Steps per 1/60 s for every scheme without error control. If empty, the [`ladder`] of each scheme is used.
    pub substeps: Vec<Substeps>,
    /// Smallest error of interest. The reference is a hundred times more accurate, if possible.
    pub smallest_error: f64,
    /// Number of threads. The results do not depend on it.
    pub threads: usize,
}

impl Default for Plan {
    fn default() -> Self {
        Self { integrators: IntegratorKind::all(), substeps: Vec::new(), smallest_error: 5e-6, threads: threads() }
    }
}

/// Setting and its outcome.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// Integrator and steps per frame.
    pub setting: Setting,
    /// Outcome. `None` until the run is over.
    pub outcome: Option<Outcome>,
    /// Whether this is the setting of the level.
    pub current: bool,
}

/// All points of one scheme, from the longest step to the shortest.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Integrator with the parameters of the plan.
    pub integrator: IntegratorKind,
    /// The points.
    pub points: Vec<Point>,
    /// Measured order of the error in the number of steps, by [`measured_order`], or the reason why there is none.
    /// Error-controlled schemes count accepted and rejected inner steps.
    pub order: MeasuredOrder,
}

/// Point and its run.
struct Slot {
    curve: usize,
    point: Point,
    run: Option<Box<TrialRun>>,
    /// Processor time of the first run.
    spent: Duration,
    /// Whether one more run is due in this round.
    due: bool,
    again: Option<Box<March>>,
    /// Estimated work [force evaluations per frame].
    weight: f64,
}

/// Work-precision diagram as a job.
pub struct WorkPrecision {
    trial: Trial,
    plan: Plan,
    reference: ReferenceJob,
    /// In the order of execution, the cheapest first.
    slots: Vec<Slot>,
    repetitions: Repetitions,
    finished: bool,
}

impl WorkPrecision {
    /// Prepares a diagram of a trial with those schemes of the plan that suit it.
    /// The trial's current setting is one of the points if its scheme is in the plan.
    pub fn new(trial: Trial, mut plan: Plan) -> Self {
        plan.integrators.retain(|integrator| trial.suits(integrator));
        let reference = ReferenceJob::new(&trial, plan.smallest_error);
        let limit = limit(&trial.scene, &trial.start);
        let mut slots = Vec::new();
        for (curve, integrator) in plan.integrators.iter().enumerate() {
            for (setting, current) in settings(integrator, &trial, &plan.substeps) {
                let weight = weight(&setting, limit);
                let point = Point { setting, outcome: None, current };
                slots.push(Slot { curve, point, run: None, spent: Duration::ZERO, due: false, again: None, weight });
            }
        }
        slots.sort_by(|a, b| a.weight.total_cmp(&b.weight));
        Self { trial, plan, reference, slots, repetitions: Repetitions::default(), finished: false }
    }

    /// Trial that is run.
    pub const fn trial(&self) -> &Trial {
        &self.trial
    }

    /// Plan of the diagram.
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
        if reference.is_still() {
            self.finished = true;
            return Ok(Progress::FINISHED);
        }
        let trial = &self.trial;
        let open = self.slots.iter_mut().filter(|slot| slot.point.outcome.is_none()).collect();
        spread(self.plan.threads, open, |slot: &mut Slot| {
            let run = slot.run.get_or_insert_with(|| Box::new(TrialRun::new(trial, &slot.point.setting)));
            slot.point.outcome = run.until(trial, reference, deadline);
            let over = slot.point.outcome.is_some();
            if over {
                slot.spent = run.spent();
                slot.run = None;
            }
            over && !deadline.passed()
        });
        self.repeat(deadline);
        Ok(self.progress())
    }

    /// Repeats short runs in turns, after all have run once. The stated time is the least of all repetitions.
    fn repeat(&mut self, deadline: Deadline) {
        while self.slots.iter().all(|slot| slot.point.outcome.is_some()) && !self.finished && !deadline.passed() {
            if self.slots.iter().all(|slot| !slot.due) {
                let whole = |slot: &Slot| slot.point.outcome.as_ref().is_some_and(|o| o.status != Status::Unstable);
                let costs: Vec<_> = self.slots.iter().map(|slot| whole(slot).then_some(slot.spent)).collect();
                let first = self.reference.spent() + self.slots.iter().map(|slot| slot.spent).sum::<Duration>();
                let chosen = self.repetitions.next(&costs, first);
                self.finished = chosen.is_empty();
                for number in chosen {
                    self.slots[number].due = true;
                }
            }
            let trial = &self.trial;
            let due = self.slots.iter_mut().filter(|slot| slot.due).collect();
            spread(self.plan.threads, due, |slot: &mut Slot| {
                let march = slot.again.get_or_insert_with(|| Box::new(trial.march(&slot.point.setting)));
                if !march.repeat(deadline) {
                    return false;
                }
                if let Some(outcome) = &mut slot.point.outcome {
                    outcome.ms_per_second = outcome.ms_per_second.min(march.ms_per_second());
                    outcome.runs += 1;
                }
                (slot.due, slot.again) = (false, None);
                !deadline.passed()
            });
        }
    }

    fn progress(&self) -> Progress {
        let total: f64 = self.slots.iter().map(|slot| slot.weight).sum();
        let share = |slot: &Slot| match (&slot.point.outcome, &slot.run) {
            (Some(_), _) => 1.0,
            (None, Some(run)) => run.done(),
            (None, None) => 0.0,
        };
        let done = self.slots.iter().map(|slot| slot.weight * share(slot)).sum::<f64>() / total.max(1.0);
        let first = REFERENCE_SHARE + (1.0 - REFERENCE_SHARE - REPEATED_SHARE) * done;
        let done = first + REPEATED_SHARE * self.repetitions.done();
        Progress { done: if self.finished { 1.0 } else { done }, finished: self.finished }
    }

    /// Reason why errors are not usable, once the reference is known.
    pub fn no_errors(&self) -> Option<NoErrors> {
        self.reference().and_then(NoErrors::of)
    }

    /// Reference, once it is known.
    pub fn reference(&self) -> Option<&Reference> {
        self.reference.result().and_then(|result| result.as_ref().ok())
    }

    /// Curves so far, one per scheme, in the order of the plan.
    pub fn curves(&self) -> Vec<Curve> {
        let reference = self.reference();
        let curve = |(number, integrator): (usize, &IntegratorKind)| {
            let own = self.slots.iter().filter(|slot| slot.curve == number);
            let mut points: Vec<_> = own.map(|slot| slot.point.clone()).collect();
            points.sort_by(|a, b| place(&a.setting).total_cmp(&place(&b.setting)));
            let order = order(&points, reference);
            Curve { integrator: integrator.clone(), points, order }
        };
        self.plan.integrators.iter().enumerate().map(curve).collect()
    }
}

/// Estimated share of the reference in the total work.
const REFERENCE_SHARE: f64 = 0.1;
/// Estimated share of the repetitions of short runs.
const REPEATED_SHARE: f64 = 0.2;

/// Sort key of a setting on its curve. It grows with the accuracy.
fn place(setting: &Setting) -> f64 {
    setting.tolerance().map_or(1.0, |tolerance| 1.0 / tolerance) * f64::from(setting.substeps.get())
}

/// Settings of one curve, with a flag for the current one.
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

/// Estimated force evaluations per frame. A solve counts as 40. Only the order of runs and the progress depend on it.
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
fn order(points: &[Point], reference: Option<&Reference>) -> MeasuredOrder {
    let reference = reference.ok_or(NoOrder::NoReference)?;
    if reference.is_still() {
        return Err(NoOrder::NothingMoves);
    }
    let sample = |point: &Point| {
        let outcome = point.outcome.as_ref().filter(|outcome| outcome.status == Status::Ok)?;
        let steps = (outcome.counts.inner_steps + outcome.counts.rejected) as f64;
        Some(Sample { h: 1.0 / steps, error: outcome.error })
    };
    measured_order(points.iter().filter_map(sample), reference.limits())
}
