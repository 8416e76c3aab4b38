//! Cheapest setting for a given error.

use super::{Outcome, Reference, Setting, Status, WorkPrecision};
use crate::command::Command;

/// Measure of the cost of a setting.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Price {
    /// Measured processor time per second of simulated time [ms].
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
    /// The motion [m] is zero or round-off.
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
