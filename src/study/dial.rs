//! Accuracy dial: for a wanted error, the cheapest step of each scheme, and what it costs.
//!
//! An error is reached if 95 % of the frames are within it: root mean square over the vertices, over the root mean square of the motion of
//! all frames. The reference is a hundred times as accurate, if that is possible. Each scheme is run with a step near its stability limit,
//! or with one step a frame. As its error falls as h^p, the next step is one with which seven tenths of the wanted error are expected, until
//! the error is between a half of what is wanted and all of it. A scheme that costs more than half as much again as another one is not searched
//! further, and its run is stopped; that of the level may cost up to 50 times as much.

use super::{
    NoErrors, Outcome, Progress, Reference, ReferenceJob, Setting, Status, StudyError, Trial, TrialRun,
    march::{Deadline, March, Repetitions, spread},
    threads,
    trial::{limit, with_tolerance},
};
use crate::{
    integrators::{Class, IntegratorKind},
    level::Substeps,
};
use std::time::Duration;

/// What the dial searches.
#[derive(Clone, Debug, PartialEq)]
pub struct DialPlan {
    /// Integrators.
    pub integrators: Vec<IntegratorKind>,
    /// Wanted errors, the greatest first.
    pub wanted: Vec<f64>,
    /// Number of threads.
    pub threads: usize,
}

impl Default for DialPlan {
    fn default() -> Self {
        Self { integrators: IntegratorKind::all(), wanted: vec![0.01, 0.001], threads: threads() }
    }
}

/// A setting that reaches an error, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct Reached {
    /// Integrator and steps per frame.
    pub setting: Setting,
    /// Its outcome.
    pub outcome: Outcome,
}

/// Part of the wanted error that is aimed at.
const AIM: f64 = 0.7;
/// Part of the wanted error above which no longer step is searched.
const NEAR: f64 = 0.5;
/// Ratio of two steps between which none is searched.
const CLOSE: f64 = 1.2;
/// Greatest ratio of two steps that follow each other, and that after an unstable one; and those of two tolerances.
const LEAP: [f64; 2] = [8.0, 2.0];
const LEAP_OF_TOLERANCES: [f64; 2] = [1e3, 10.0];
/// Most unstable runs of a scheme.
const MOST_UNSTABLE: usize = 5;
/// Most runs of a scheme for one error.
const MOST: usize = 8;
/// Price, as a multiple of the least known one, above which a scheme is not searched further; and that for the scheme of the level.
const DEAR: [f64; 2] = [1.5, 50.0];
/// Greatest and least tolerance of schemes that control their error.
const TOLERANCES: [f64; 2] = [1e-2, 1e-11];

/// A scheme and its runs so far.
struct Search {
    integrator: IntegratorKind,
    /// Price, as a multiple of the least known one, above which it is not searched further.
    dear: f64,
    /// Fineness with which it begins, which is also the least; see [`Search::setting`].
    first: f64,
    tried: Vec<(f64, Reached)>,
    /// Whether a run cost more than any is worth.
    is_dear: bool,
    run: Option<(f64, Setting, Box<TrialRun>)>,
    again: Option<Box<March>>,
}

/// The dial as a job.
pub struct Dial {
    trial: Trial,
    plan: DialPlan,
    reference: ReferenceJob,
    searches: Vec<Search>,
    repetitions: Repetitions,
    /// Runs to be repeated: numbers of a search and of a run in it.
    due: Vec<(usize, usize)>,
    finished: bool,
}

impl Search {
    fn new(integrator: IntegratorKind, trial: &Trial) -> Self {
        let first = match integrator.kind().class() {
            Class::Explicit => {
                // Without a limit of its own a scheme is tried near that of symplectic Euler.
                let reach = integrator.kind().stability_limit().filter(|reach| *reach > 0.0).unwrap_or(2.0);
                libm::ceil(1.05 * limit(&trial.scene, &trial.start) * 2.0 / reach).max(1.0)
            }
            Class::Implicit => 1.0,
            Class::ErrorControlled => 1.0 / TOLERANCES[0],
        };
        let dear = DEAR[usize::from(integrator.name() == trial.current.integrator.name())];
        Self { integrator, dear, first, tried: Vec::new(), is_dear: false, run: None, again: None }
    }

    fn is_controlled(&self) -> bool {
        self.integrator.kind().class() == Class::ErrorControlled
    }

    /// Setting of a fineness: the number of steps per frame, or 1 over the tolerance. `None` beyond what is possible.
    fn setting(&self, fineness: f64) -> Option<Setting> {
        if self.is_controlled() {
            let tolerance = 1.0 / fineness;
            let integrator = with_tolerance(&self.integrator, tolerance).filter(|_| tolerance >= TOLERANCES[1])?;
            return Some(Setting { integrator, substeps: Substeps::nearest(1.0) });
        }
        let substeps = Substeps::new(fineness as u32).ok().filter(|_| fineness <= f64::from(Substeps::MAX))?;
        Some(Setting { integrator: self.integrator.clone(), substeps })
    }

    /// Number for a fineness that is possible.
    fn rounded(&self, fineness: f64) -> f64 {
        if self.is_controlled() { fineness } else { libm::ceil(fineness) }
    }

    /// The coarsest run within an error.
    fn reached(&self, wanted: f64) -> Option<usize> {
        let good = |number: &usize| is_within(&self.tried[*number].1.outcome, wanted);
        (0..self.tried.len()).filter(good).min_by(|a, b| self.tried[*a].0.total_cmp(&self.tried[*b].0))
    }

    /// Next fineness to be tried for the first error that asks for one; `least` are the least known prices of these errors.
    fn next(&self, wanted: &[f64], least: &[f64]) -> Option<f64> {
        if self.is_dear || self.tried.len() >= MOST * wanted.len() {
            return None;
        }
        if self.tried.is_empty() {
            return Some(self.first);
        }
        let of_one = |(wanted, least): (&f64, &f64)| {
            let next = self.next_for(*wanted)?;
            let (dear, is_new) =
                (self.price(next) > self.dear * least, self.tried.iter().all(|(known, _)| *known != next));
            (!dear && is_new && self.setting(next).is_some()).then_some(next)
        };
        wanted.iter().zip(least).find_map(of_one)
    }

    /// Next fineness for one error; `None` if no coarser one needs to be tried.
    fn next_for(&self, wanted: f64) -> Option<f64> {
        let order = if self.is_controlled() { 1.0 } else { f64::from(self.integrator.kind().order()) };
        let factor = |outcome: &Outcome| libm::pow(outcome.usual_error / (AIM * wanted), 1.0 / order);
        let Some(good) = self.reached(wanted) else {
            let (finest, Reached { outcome, .. }) = self.tried.iter().max_by(|(a, _), (b, _)| a.total_cmp(b))?;
            let is_unstable = |(_, Reached { outcome, .. }): &&(f64, Reached)| {
                outcome.status == Status::Unstable || !outcome.usual_error.is_finite()
            };
            if self.tried.iter().filter(is_unstable).count() >= MOST_UNSTABLE {
                return None;
            }
            let [most, blind] = if self.is_controlled() { LEAP_OF_TOLERANCES } else { LEAP };
            let known = outcome.status != Status::Unstable && outcome.usual_error.is_finite();
            return Some(self.rounded(finest * if known { factor(outcome).clamp(CLOSE, most) } else { blind }));
        };
        let (fineness, Reached { outcome, .. }) = &self.tried[good];
        let failed = self.tried.iter().map(|(other, _)| *other).filter(|other| other < fineness).fold(0.0, f64::max);
        if outcome.usual_error >= NEAR * wanted || *fineness <= self.first || *fineness <= CLOSE * failed {
            return None;
        }
        let next = self.rounded((fineness * factor(outcome)).max(self.first));
        let between = if next > failed { next } else { self.rounded((fineness * failed).sqrt()) };
        (between < *fineness && between > failed).then_some(between)
    }

    /// Expected time for a simulated second \[ms\].
    fn price(&self, fineness: f64) -> f64 {
        let grows = |from: f64| if self.is_controlled() { libm::pow(fineness / from, 0.2) } else { fineness / from };
        let near = self.tried.iter().filter(|(_, reached)| reached.outcome.status != Status::Unstable);
        let near =
            near.min_by(|(a, _), (b, _)| libm::log(a / fineness).abs().total_cmp(&libm::log(b / fineness).abs()));
        near.map_or(0.0, |(from, reached)| reached.outcome.ms_per_second * grows(*from))
    }
}

/// Whether 95 % of the frames of a run are within an error.
fn is_within(outcome: &Outcome, wanted: f64) -> bool {
    outcome.status == Status::Ok && outcome.usual_error <= wanted
}

impl Dial {
    /// Prepares the dial for a trial, with those schemes of the plan that suit it.
    pub fn new(trial: Trial, mut plan: DialPlan) -> Self {
        plan.integrators.retain(|integrator| trial.suits(integrator));
        plan.wanted.sort_by(|a, b| b.total_cmp(a));
        let reference = ReferenceJob::new(&trial, plan.wanted.last().copied().unwrap_or(1.0));
        let searches = plan.integrators.iter().map(|integrator| Search::new(integrator.clone(), &trial)).collect();
        let (repetitions, due) = (Repetitions::default(), Vec::new());
        Self { trial, plan, reference, searches, repetitions, due, finished: false }
    }

    /// The trial.
    pub const fn trial(&self) -> &Trial {
        &self.trial
    }

    /// The plan.
    pub const fn plan(&self) -> &DialPlan {
        &self.plan
    }

    /// Works for about `budget`.
    ///
    /// # Errors
    /// If there is no reference to measure errors against.
    pub fn advance(&mut self, budget: Duration) -> Result<Progress, StudyError> {
        /// Estimated shares of the reference, and of reference and runs.
        const SHARES: [f64; 2] = [0.2, 0.9];
        let deadline = Deadline::after(budget);
        let finding = self.reference.until(&self.trial, self.plan.threads, deadline);
        match self.reference.result() {
            Some(Ok(_)) => {}
            Some(Err(error)) => return Err(error.clone()),
            None => return Ok(Progress { done: SHARES[0] * finding.done, finished: false }),
        }
        self.finished |= self.no_errors().is_some();
        while !self.finished && !deadline.passed() {
            if self.search(deadline) {
                self.repeat(deadline);
            }
        }
        if self.finished {
            return Ok(Progress::FINISHED);
        }
        // As errors are approached, more runs are as likely as not.
        let share = |search: &Search| 1.0 - libm::pow(0.5, 0.5 * search.tried.len() as f64);
        let all = self.searches.iter().map(share).sum::<f64>() / self.searches.len().max(1) as f64;
        let runs = SHARES[0] + (SHARES[1] - SHARES[0]) * all;
        Ok(Progress { done: runs + (1.0 - SHARES[1]) * self.repetitions.done(), finished: false })
    }

    /// Runs the next setting of each scheme until the deadline. Returns whether there is none left.
    fn search(&mut self, deadline: Deadline) -> bool {
        let Some(Ok(reference)) = self.reference.result() else { return true };
        let wanted = &self.plan.wanted;
        let least: Vec<_> = wanted.iter().map(|wanted| self.least(*wanted)).collect();
        let trial = &self.trial;
        let greatest = 1e-3 * least.iter().copied().fold(0.0, f64::max) * trial.seconds();
        for search in self.searches.iter_mut().filter(|search| search.run.is_none()) {
            let next = search.next(wanted, &least);
            search.run = next.and_then(|fineness| {
                let setting = search.setting(fineness)?;
                let run = Box::new(TrialRun::new(trial, &setting));
                Some((fineness, setting, run))
            });
        }
        let open: Vec<_> = self.searches.iter_mut().filter(|search| search.run.is_some()).collect();
        let none = open.is_empty();
        spread(self.plan.threads, open, |search: &mut Search| {
            let Some((fineness, setting, mut run)) = search.run.take() else { return true };
            match run.until(trial, reference, deadline) {
                Some(outcome) => search.tried.push((fineness, Reached { setting, outcome })),
                None if run.spent().as_secs_f64() > search.dear * greatest => search.is_dear = true,
                None => search.run = Some((fineness, setting, run)),
            }
            !deadline.passed()
        });
        none
    }

    /// Repeats short runs that reach an error, so that their times are the least of several.
    fn repeat(&mut self, deadline: Deadline) {
        if self.due.is_empty() {
            let reached = |(number, search): (usize, &Search)| {
                let runs = self.plan.wanted.iter().filter_map(|wanted| search.reached(*wanted));
                runs.map(|run| (number, run)).collect::<Vec<_>>()
            };
            let mut runs: Vec<_> = self.searches.iter().enumerate().flat_map(reached).collect();
            runs.dedup();
            let time = |(search, run): &(usize, usize)| {
                let outcome = &self.searches[*search].tried[*run].1.outcome;
                Some(Duration::from_secs_f64(1e-3 * outcome.ms_per_second * self.trial.seconds()))
            };
            let costs: Vec<_> = runs.iter().map(time).collect();
            let all = costs.iter().flatten().sum::<Duration>() + self.reference.spent();
            self.due = self.repetitions.next(&costs, all).into_iter().map(|number| runs[number]).collect();
            self.finished = self.due.is_empty();
        }
        let trial = &self.trial;
        while let Some((search, run)) = self.due.last().copied().filter(|_| !deadline.passed()) {
            let Search { tried, again, .. } = &mut self.searches[search];
            let Reached { setting, outcome } = &mut tried[run].1;
            let march = again.get_or_insert_with(|| Box::new(trial.march(setting)));
            if !march.repeat(deadline) {
                return;
            }
            outcome.ms_per_second = outcome.ms_per_second.min(march.ms_per_second());
            outcome.runs += 1;
            *again = None;
            self.due.pop();
        }
    }

    /// Least price of all settings known to be within an error \[ms per second\].
    fn least(&self, wanted: f64) -> f64 {
        let known = self.searches.iter().filter_map(|search| Some(&search.tried[search.reached(wanted)?].1));
        known.map(|reached| reached.outcome.ms_per_second).fold(f64::INFINITY, f64::min)
    }

    /// Reference, once it is known.
    pub fn reference(&self) -> Option<&Reference> {
        self.reference.result().and_then(|result| result.as_ref().ok())
    }

    /// Reason why no error can be reached, once the reference is known: nothing moves, or the reference is too inexact even for the
    /// greatest wanted error, as where the motion is chaotic.
    pub fn no_errors(&self) -> Option<NoErrors> {
        let reference = self.reference()?;
        let greatest = self.plan.wanted.first().copied().unwrap_or(1.0);
        NoErrors::of(reference)
            .or_else(|| (!tells(reference, greatest)).then_some(NoErrors::CoarseReference(reference.own_error)))
    }

    /// Whether the reference is exact enough to tell that an error is reached.
    pub fn tells(&self, wanted: f64) -> bool {
        self.reference().is_some_and(|reference| tells(reference, wanted))
    }

    /// For each scheme, in the order of the plan, the cheapest of its settings that reaches an error; `None` for a scheme that does not, or
    /// that costs far more than another one.
    pub fn reached(&self, wanted: f64) -> impl Iterator<Item = (&IntegratorKind, Option<&Reached>)> {
        let is_told = self.tells(wanted);
        self.searches.iter().map(move |search| {
            let run = search.reached(wanted).filter(|_| is_told);
            (&search.integrator, run.map(|run| &search.tried[run].1))
        })
    }

    /// The cheapest setting that reaches an error.
    pub fn cheapest(&self, wanted: f64) -> Option<&Reached> {
        let known = self.reached(wanted).filter_map(|(_, reached)| reached);
        known.min_by(|a, b| a.outcome.ms_per_second.total_cmp(&b.outcome.ms_per_second))
    }
}

/// Whether a reference is exact enough to tell that an error is reached.
fn tells(reference: &Reference, wanted: f64) -> bool {
    /// Greatest error of a reference as a part of what is measured with it.
    const PART: f64 = 0.2;
    reference.own_error + reference.round_off() <= PART * wanted
}
