//! Background job: runs of hard cases.

use super::{job::Task, studies::threads};
use crate::{
    hard::{COLUMNS, Case, Entry, Method, Sweep, Trial, row},
    materials::Model,
    study::{Progress, StudyError},
};
use std::{path::Path, sync::Arc, time::Duration};

/// Selection of runs of hard cases; a field without a value selects all.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Choice {
    /// Name of a case.
    pub case: Option<&'static str>,
    /// Constitutive model.
    pub model: Option<Model>,
    /// Method of time integration.
    pub method: Option<Method>,
}

impl Choice {
    /// Whether a run is selected.
    pub fn takes(&self, trial: &Trial) -> bool {
        self.case.is_none_or(|case| case == trial.name)
            && self.model.is_none_or(|model| model == trial.model)
            && self.method.is_none_or(|method| method == trial.method)
    }
}

/// Results of the hard cases.
#[derive(Clone, Default)]
pub struct Known {
    /// All runs that were started.
    pub runs: Vec<(Trial, Entry)>,
}

impl Known {
    /// Table of all finished runs as comma-separated values.
    pub fn csv(&self) -> String {
        let over = self.runs.iter().filter_map(|(trial, entry)| match &entry.verdict {
            Some(Ok(verdict)) => Some(row(trial, verdict)),
            _ => None,
        });
        over.fold(COLUMNS.to_owned(), |text, line| text + "\n" + &line) + "\n"
    }
}

/// Runs in progress, and the results of earlier runs.
pub struct Hard {
    before: Vec<(Trial, Entry)>,
    sweep: Sweep,
}

impl Hard {
    /// Prepares the selected runs; other results stay.
    pub fn new(choice: Choice, known: Known) -> Result<Self, StudyError> {
        let mut trials = Vec::new();
        for name in Case::names() {
            let case = Case::read(Path::new(name)).map_err(|_| StudyError::NotHere("a hard case cannot be read"))?;
            let case = Arc::new(case);
            for (&model, method) in Model::ALL.iter().flat_map(|model| Method::ALL.map(|method| (model, method))) {
                trials.push(Trial { name: name.to_owned(), case: Arc::clone(&case), model, method });
            }
        }
        trials.retain(|trial| choice.takes(trial));
        let mut before = known.runs;
        before.retain(|(trial, entry)| entry.verdict.is_some() && !choice.takes(trial));
        Ok(Self { before, sweep: Sweep::new(trials, threads()) })
    }
}

impl Task for Hard {
    type Results = Known;

    fn advance(&mut self, budget: Duration) -> Result<Progress, StudyError> {
        Ok(self.sweep.advance(budget))
    }

    fn results(&self) -> Known {
        let now = self.sweep.entries().map(|(trial, entry)| (trial.clone(), entry.clone()));
        Known { runs: self.before.iter().cloned().chain(now).collect() }
    }
}
