//! Step lengths of each body and net in the report.

use crate::{report::SubstepPlan, simulation::Simulation};
use serde::Serialize;

/// Substeps of a body or net that was stepped at its own pace.
#[derive(Debug, Serialize)]
pub struct SubstepReport {
    /// Name of the body or net.
    pub name: String,
    /// In how many equal parts it took every step.
    pub steps: u32,
    /// Length of a part [s].
    pub step_seconds: f64,
    /// Its longest stable step at rest under symplectic Euler [s]; null if nothing in it is stiff.
    pub critical_step_seconds: Option<f64>,
}

/// Reports of the bodies, then of the nets. Empty if all took the same steps.
pub(super) fn substep_reports(simulation: &Simulation) -> Vec<SubstepReport> {
    let scene = simulation.scene();
    let names = scene.bodies.iter().map(|body| &body.name).chain(scene.nets.iter().map(|net| &net.name));
    let row = |(name, plan): (&String, SubstepPlan)| SubstepReport {
        name: name.clone(),
        steps: plan.steps,
        step_seconds: plan.step,
        critical_step_seconds: plan.limit,
    };
    names.zip(simulation.substep_plans()).map(row).collect()
}
