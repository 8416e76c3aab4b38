//! Studies.

use crate::{Interruptible, level::Level, value_error};
use gingerbread::{
    files::Disk,
    integrators::IntegratorKind,
    study::{Plan, Trial, WorkPrecision},
};
use pyo3::prelude::*;
use std::time::Duration;

/// Error against cost as the text of a table.
#[pyfunction]
#[pyo3(signature = (level, seconds, integrators=None))]
pub fn work_precision_csv(
    py: Python<'_>,
    level: &Level,
    seconds: f64,
    integrators: Option<Vec<String>>,
) -> PyResult<String> {
    let level = level.0.clone();
    py.detach(|| {
        let trial = Trial::new(&level, &Disk, seconds).map_err(value_error)?;
        let integrators = match integrators {
            Some(names) => names
                .iter()
                .map(|name| name.parse::<IntegratorKind>())
                .collect::<Result<Vec<_>, _>>()
                .map_err(value_error)?,
            None => IntegratorKind::all().into_iter().filter(|integrator| trial.suits(integrator)).collect(),
        };
        for integrator in &integrators {
            trial.check(integrator).map_err(value_error)?;
        }
        let mut diagram = WorkPrecision::new(trial, Plan { integrators, ..Plan::default() });
        let mut interruptible = Interruptible::new();
        while !diagram.advance(Duration::from_millis(50)).map_err(value_error)?.finished {
            if !interruptible.goes_on() {
                break;
            }
        }
        interruptible.end().map(|()| diagram.csv())
    })
}
