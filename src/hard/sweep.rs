//! Many runs of hard cases on several threads.

use super::{Case, Method, Reference, Run, Verdict, reference::ReferenceRun};
use crate::clock::Instant;
use crate::{
    materials::Model,
    scene::SceneError,
    study::{Deadline, Progress, spread},
};
use std::{sync::Arc, time::Duration};

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

impl Trial {
    /// Name of the material: that of the model, or `Typed`.
    pub fn material(&self) -> &'static str {
        if self.case.energy().is_some() { "Typed" } else { self.model.name() }
    }

    /// The same with the formula and the parameters of a typed energy.
    pub fn whole_material(&self) -> String {
        self.case.energy().map_or_else(
            || self.model.name().to_owned(),
            |energy| {
                let parameters = energy.parameters().iter().map(|(name, value)| format!("; {name} = {value}"));
                format!("Typed {}{}", energy.text(), parameters.collect::<String>())
            },
        )
    }

    /// Name of the case, with a mark if this is its undamped twin.
    pub fn title(&self) -> String {
        let twin = if self.case.is_undamped_twin() { " undamped" } else { "" };
        format!("{}{twin}", self.name)
    }
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
///
/// Trials of the same case and model that follow each other share the reference and are computed by one thread.
pub struct Sweep {
    groups: Vec<Group>,
    threads: usize,
}

/// Trials with the same reference.
struct Group {
    slots: Vec<SweepSlot>,
    reference: Arc<Reference>,
    /// Computation of the reference, while it goes on.
    computing: Option<Box<ReferenceRun>>,
    /// Whether the reference is still to be computed.
    is_due: bool,
}

struct SweepSlot {
    trial: Trial,
    run: Option<Box<Run>>,
    entry: Entry,
}

impl Sweep {
    /// Prepares trials for a number of threads. With `compares`, the runs are compared with references, whose computation
    /// takes several times as long as a run.
    pub fn new(trials: Vec<Trial>, threads: usize, compares: bool) -> Self {
        let mut groups: Vec<Group> = Vec::new();
        for trial in trials {
            let entry = Entry { done: 0.0, seconds: 0.0, verdict: None };
            let slot = SweepSlot { trial, run: None, entry };
            match groups.last_mut().filter(|group| group.takes(&slot.trial)) {
                Some(group) => group.slots.push(slot),
                None => groups.push(Group {
                    slots: vec![slot],
                    reference: Arc::default(),
                    computing: None,
                    is_due: compares,
                }),
            }
        }
        Self { groups, threads }
    }

    /// Works for about `budget`.
    pub fn advance(&mut self, budget: Duration) -> Progress {
        let deadline = Deadline::after(budget);
        let open: Vec<_> = self.groups.iter_mut().filter(|group| !group.is_finished()).collect();
        spread(self.threads, open, |group| {
            group.advance(deadline);
            !deadline.passed()
        });
        let done: f64 = self.groups.iter().map(Group::done).sum();
        let finished = self.groups.iter().all(Group::is_finished);
        Progress { done: done / self.entries().count().max(1) as f64, finished }
    }

    /// Trials with their states, in order.
    pub fn entries(&self) -> impl Iterator<Item = (&Trial, &Entry)> {
        self.groups.iter().flat_map(|group| &group.slots).map(|slot| (&slot.trial, &slot.entry))
    }
}

impl Group {
    fn takes(&self, trial: &Trial) -> bool {
        self.slots
            .last()
            .is_some_and(|slot| Arc::ptr_eq(&slot.trial.case, &trial.case) && slot.trial.model == trial.model)
    }

    fn is_finished(&self) -> bool {
        self.slots.iter().all(|slot| slot.entry.verdict.is_some())
    }

    /// Number of runs done; the reference counts as half of the first.
    fn done(&self) -> f64 {
        let reference = match (&self.computing, self.is_due) {
            (Some(computing), _) => 0.5 * computing.done(),
            (None, true) => 0.0,
            (None, false) => 0.5,
        };
        let runs: f64 = self.slots.iter().map(|slot| slot.entry.done).sum();
        if runs > 0.0 { runs } else { reference }
    }

    /// Works until the deadline or the end, whichever comes first.
    fn advance(&mut self, deadline: Deadline) {
        if self.is_due {
            match self.advance_reference(deadline) {
                Ok(true) => self.is_due = false,
                Ok(false) => return,
                // The runs state why their scene cannot be built.
                Err(_) => (self.is_due, self.computing) = (false, None),
            }
        }
        for slot in self.slots.iter_mut().filter(|slot| slot.entry.verdict.is_none()) {
            slot.advance(&self.reference, deadline);
            if deadline.passed() {
                return;
            }
        }
    }

    /// Returns whether the reference is complete.
    fn advance_reference(&mut self, deadline: Deadline) -> Result<bool, SceneError> {
        let Some(SweepSlot { trial, .. }) = self.slots.first() else { return Ok(true) };
        let computing = match &mut self.computing {
            Some(computing) => computing,
            none => none.insert(Box::new(ReferenceRun::new(&trial.case, trial.model)?)),
        };
        while !computing.advance()? {
            if deadline.passed() {
                return Ok(false);
            }
        }
        self.reference = self.computing.take().map_or_else(Arc::default, |computing| Arc::new(computing.finish()));
        Ok(true)
    }
}

impl SweepSlot {
    /// Runs until the deadline or the end, whichever comes first.
    fn advance(&mut self, reference: &Arc<Reference>, deadline: Deadline) {
        let begin = Instant::now();
        self.entry.verdict = self.until(reference, deadline).transpose();
        self.entry.seconds += begin.elapsed().as_secs_f64();
        self.entry.done = self.run.as_ref().map_or(0.0, |run| run.done());
        if self.entry.verdict.is_some() {
            self.entry.done = 1.0;
            self.run = None;
        }
    }

    fn until(&mut self, reference: &Arc<Reference>, deadline: Deadline) -> Result<Option<Verdict>, SceneError> {
        let Trial { case, model, method, .. } = &self.trial;
        let run = match &mut self.run {
            Some(run) => run,
            none => none.insert(Box::new(Run::new(case, *model, *method)?.compared_with(Arc::clone(reference)))),
        };
        loop {
            let verdict = run.advance()?;
            if verdict.is_some() || deadline.passed() {
                return Ok(verdict);
            }
        }
    }
}
