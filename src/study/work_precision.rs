//! Work-precision diagram: one trial with many settings; and the cheapest setting for a given error.

use super::{
    MeasuredOrder, NoOrder, Outcome, Progress, Reference, ReferenceJob, Sample, Setting, Status, StudyError, Trial,
    TrialRun, ladder,
    march::{Deadline, March, Repetitions, spread},
    measured_order, threads,
    trial::limit,
};
use crate::{
    command::Command,
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
        if plan.substeps.is_empty() {
            let most = MOST_WORK / (FRAMES * trial.scene.vertices().max(1) as f64);
            let mut kept = vec![0; plan.integrators.len()];
            slots.retain(|slot| {
                kept[slot.curve] += 1;
                slot.point.current || slot.weight <= most || kept[slot.curve] <= FEWEST
            });
        }
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

/// Greatest work of a run: evaluations of the force on a vertex. Settings that need more are left out.
const MOST_WORK: f64 = 1e8;
/// Number of settings of each scheme that are run in any case, the cheapest ones.
const FEWEST: usize = 4;
/// Frames of a run.
const FRAMES: f64 = 60.0;

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

/// Estimated force evaluations per frame. A solve counts as 40. The order of runs and the progress depend on it, and which runs are too long.
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

/// Measure of the cost of a setting.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Price {
    /// Measured processor time per second of simulated time \[ms\].
    #[default]
    Time,
    /// Evaluations of all forces. Equal on every machine, but without the cost of solving equations.
    ForceEvaluations,
}

impl Price {
    /// Cost of an outcome.
    pub fn of(self, outcome: &Outcome) -> f64 {
        match self {
            Self::Time => outcome.ms_per_second,
            Self::ForceEvaluations => outcome.counts.force_evaluations as f64,
        }
    }
}

/// Recommended setting.
#[derive(Clone, Debug, PartialEq)]
pub struct Suggestion {
    /// Integrator and steps per frame.
    pub setting: Setting,
    /// Measured error and cost of the setting.
    pub outcome: Outcome,
    /// Outcome of the current setting, if it was measured.
    pub current: Option<Outcome>,
    price: Price,
}

/// Error bounds that are tried in order where none is given.
pub const USUAL_ERRORS: [f64; 2] = [0.01, 0.1];

/// Upper limit of the reference error and of round-off for usable errors.
const GREATEST: f64 = 0.1;

/// Reason why errors are not usable, so that nothing is suggested.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NoErrors {
    /// The motion \[m\] is zero or round-off.
    #[error(
        "Nothing moves here: the reference moves by {0:.1e} m, which is round-off. There is no error to measure, and nothing is \
         recommended. Let a force act, stretch a body or begin from a state that moves"
    )]
    NothingMoves(f64),
    /// Round-off relative to the motion is too large.
    #[error(
        "Errors are round-off here: rounding alone makes {} of the motion. Nothing is recommended. Study a larger motion or a \
         longer time",
        share(.0)
    )]
    RoundOff(f64),
    /// The error of the reference relative to the motion is too large.
    #[error(
        "The reference is not fine enough here: its error may be {} of the motion. Errors tell nothing, and nothing is \
         recommended. Study a shorter time or a larger motion",
        share(.0)
    )]
    CoarseReference(f64),
}

fn share(of: &f64) -> String {
    if of.is_finite() { format!("{:.0} %", 100.0 * of) } else { "all".to_owned() }
}

impl NoErrors {
    /// Reason why errors against a reference are not usable. `None` if they are.
    pub(super) fn of(reference: &Reference) -> Option<Self> {
        if reference.is_still() {
            Some(Self::NothingMoves(reference.motion))
        } else if reference.round_off() >= GREATEST {
            Some(Self::RoundOff(reference.round_off()))
        } else if reference.own_error >= GREATEST {
            Some(Self::CoarseReference(reference.own_error))
        } else {
            None
        }
    }
}

impl WorkPrecision {
    /// First of the [`USUAL_ERRORS`] that some setting reaches, and the cheapest setting for it. `None` if there is
    /// none.
    pub fn suggest_usual(&self, price: Price) -> Option<(f64, Suggestion)> {
        USUAL_ERRORS.into_iter().find_map(|error| Some((error, self.suggest(error, price)?)))
    }

    /// Cheapest of the settings measured so far whose mean error is at most `error`.
    /// The error of the reference and round-off are added. `None` if there is no such setting, or if errors are not
    /// usable.
    pub fn suggest(&self, error: f64, price: Price) -> Option<Suggestion> {
        let reference = self.reference().filter(|reference| NoErrors::of(reference).is_none())?;
        let own_error = reference.own_error + reference.round_off();
        let curves = self.curves();
        let measured = || {
            let points = curves.iter().flat_map(|curve| &curve.points);
            points.filter_map(|point| Some((point, point.outcome.as_ref()?)))
        };
        let good = measured().filter(|(_, outcome)| outcome.status == Status::Ok && outcome.error + own_error <= error);
        let (point, outcome) = good.min_by(|(_, a), (_, b)| price.of(a).total_cmp(&price.of(b)))?;
        let current = measured().find(|(point, _)| point.current).map(|(_, outcome)| outcome.clone());
        Some(Suggestion { setting: point.setting.clone(), outcome: outcome.clone(), current, price })
    }
}

impl Suggestion {
    /// Cost of the current setting over that of the suggestion, if the current setting was measured and is not
    /// unstable.
    /// Below 1 the suggestion costs more, but is accurate enough.
    pub fn saves(&self) -> Option<f64> {
        let current = self.price.of(self.current.as_ref().filter(|current| current.status != Status::Unstable)?);
        Some(current / self.price.of(&self.outcome).max(f64::MIN_POSITIVE))
    }

    /// Commands that apply the suggestion to a sandbox.
    pub fn commands(&self) -> Vec<Command> {
        self.setting.commands()
    }
}

impl std::fmt::Display for Suggestion {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Outcome { error, greatest_error, ms_per_second, .. } = &self.outcome;
        let (label, error, greatest) = (self.setting.label(), per_cent(*error), per_cent(*greatest_error));
        write!(out, "{label}: mean error {error} (largest {greatest}), {ms_per_second:.1} ms per simulated second")?;
        match (self.saves(), &self.current) {
            (_, Some(now)) if now.status == Status::Unstable => write!(out, "; the setting of now is unstable"),
            (Some(factor), Some(now)) if factor >= 1.0 => {
                write!(out, "; {factor:.1} times cheaper than now (mean error {})", per_cent(now.error))
            }
            (Some(factor), Some(now)) => {
                write!(out, "; {:.1} times dearer than now (mean error {})", 1.0 / factor, per_cent(now.error))
            }
            _ => Ok(()),
        }
    }
}

/// Error in per cent. A small error is not rounded to zero.
fn per_cent(error: f64) -> String {
    if error == 0.0 || error >= 5e-4 { format!("{:.2} %", 100.0 * error) } else { format!("{:.1e} %", 100.0 * error) }
}
