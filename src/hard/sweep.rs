//! Many runs of hard cases on several threads.

use super::{Case, Method, Run, Verdict};
use crate::{
    materials::Model,
    scene::SceneError,
    study::{Deadline, Progress, spread},
};
use std::{sync::Arc, time::Duration};
use web_time::Instant;

/// Case with the model and the method under test.
#[derive(Clone, Debug)]
pub struct Trial {
    /// Name of the case.
    pub name: String,
    /// Case.
    pub case: Arc<Case>,
    /// Constitutive model of every body.
    pub model: Model,
    /// Integrator and step.
    pub method: Method,
}

/// State of a trial.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Share of the run done.
    pub done: f64,
    /// Time spent on the run \[s\].
    pub seconds: f64,
    /// Verdict, or the reason why the case cannot be run. `None` until the end.
    pub verdict: Option<Result<Verdict, SceneError>>,
}

/// Runs of several trials on several threads. The results do not depend on the number of threads, except for the times.
pub struct Sweep {
    slots: Vec<SweepSlot>,
    threads: usize,
}

struct SweepSlot {
    trial: Trial,
    run: Option<Box<Run>>,
    entry: Entry,
}

impl Sweep {
    /// Prepares trials for a number of threads.
    pub fn new(trials: Vec<Trial>, threads: usize) -> Self {
        let waiting = Entry { done: 0.0, seconds: 0.0, verdict: None };
        let slots = trials.into_iter().map(|trial| SweepSlot { trial, run: None, entry: waiting.clone() });
        Self { slots: slots.collect(), threads }
    }

    /// Works for about `budget`.
    pub fn advance(&mut self, budget: Duration) -> Progress {
        let deadline = Deadline::after(budget);
        let open: Vec<_> = self.slots.iter_mut().filter(|slot| slot.entry.verdict.is_none()).collect();
        spread(self.threads, open, |slot| {
            slot.advance(deadline);
            !deadline.passed()
        });
        let done: f64 = self.slots.iter().map(|slot| slot.entry.done).sum();
        let finished = self.slots.iter().all(|slot| slot.entry.verdict.is_some());
        Progress { done: done / self.slots.len().max(1) as f64, finished }
    }

    /// Trials with their states, in order.
    pub fn entries(&self) -> impl Iterator<Item = (&Trial, &Entry)> {
        self.slots.iter().map(|slot| (&slot.trial, &slot.entry))
    }
}

impl SweepSlot {
    /// Runs until the deadline or the end, whichever comes first.
    fn advance(&mut self, deadline: Deadline) {
        let begin = Instant::now();
        self.entry.verdict = self.until(deadline).transpose();
        self.entry.seconds += begin.elapsed().as_secs_f64();
        self.entry.done = self.run.as_ref().map_or(0.0, |run| run.done());
        if self.entry.verdict.is_some() {
            self.entry.done = 1.0;
            self.run = None;
        }
    }

    fn until(&mut self, deadline: Deadline) -> Result<Option<Verdict>, SceneError> {
        let Trial { case, model, method, .. } = &self.trial;
        let run = match &mut self.run {
            Some(run) => run,
            none => none.insert(Box::new(Run::new(case, *model, *method)?)),
        };
        loop {
            let verdict = run.advance()?;
            if verdict.is_some() || deadline.passed() {
                return Ok(verdict);
            }
        }
    }
}
