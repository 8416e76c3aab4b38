//! The cheapest measured setting that is accurate enough.

use super::{Outcome, Setting, Status, WorkPrecision};
use crate::command::Command;

/// What a setting is priced by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Price {
    /// Measured time for a second of simulated time.
    #[default]
    Time,
    /// Evaluations of all forces: the same on every machine, but blind to the price of solving equations.
    ForceEvaluations,
}

impl Price {
    /// What an outcome cost.
    pub fn of(self, outcome: &Outcome) -> f64 {
        match self {
            Self::Time => outcome.ms_per_second,
            Self::ForceEvaluations => outcome.counts.force_evaluations as f64,
        }
    }
}

/// A setting to change to.
#[derive(Clone, Debug, PartialEq)]
pub struct Suggestion {
    /// How to step.
    pub setting: Setting,
    /// What it was measured to do: the error it promises, and what it costs.
    pub outcome: Outcome,
    /// What the current setting was measured to do, if it was.
    pub current: Option<Outcome>,
    price: Price,
}

impl WorkPrecision {
    /// The cheapest of the settings measured so far whose error is at most `error`, counting the reference's own; `None` if none is.
    pub fn suggest(&self, error: f64, price: Price) -> Option<Suggestion> {
        let own_error = self.reference()?.own_error;
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
    /// How many times cheaper it is than the current setting, if that was measured; below 1 it is dearer, but accurate enough.
    pub fn saves(&self) -> Option<f64> {
        let current = self.price.of(self.current.as_ref()?);
        Some(current / self.price.of(&self.outcome).max(f64::MIN_POSITIVE))
    }

    /// What to send to a sandbox to follow it.
    pub fn commands(&self) -> Vec<Command> {
        self.setting.commands()
    }
}

impl std::fmt::Display for Suggestion {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Outcome { error, ms_per_second, .. } = &self.outcome;
        write!(
            out,
            "{}: error {:.2} %, {ms_per_second:.1} ms per simulated second",
            self.setting.label(),
            100.0 * error
        )?;
        match (self.saves(), &self.current) {
            (Some(factor), Some(now)) if factor >= 1.0 => {
                write!(out, "; {factor:.1} times cheaper than now (error {:.2} %)", 100.0 * now.error)
            }
            (Some(factor), Some(now)) => {
                write!(out, "; {:.1} times dearer than now (error {:.2} %)", 1.0 / factor, 100.0 * now.error)
            }
            _ => Ok(()),
        }
    }
}
