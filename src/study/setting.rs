//! Setting of a study: integrator and steps per frame.

use crate::{
    command::Command,
    integrators::{Class, IntegratorKind},
    level::{Level, Substeps},
    scene::Scene,
    stability::critical_step,
    state::State,
};

/// Integrator with its parameters, and number of steps per frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// Integrator.
    pub integrator: IntegratorKind,
    /// Steps per 1/60 s.
    pub substeps: Substeps,
}

impl Setting {
    /// Setting of a level.
    pub fn of(level: &Level) -> Self {
        Self { integrator: level.integrator.clone(), substeps: level.substeps }
    }

    /// Commands that apply the setting to a sandbox. Positions and velocities stay.
    pub fn commands(&self) -> Vec<Command> {
        vec![
            Command::EndGesture,
            Command::SetIntegrator(self.integrator.clone()),
            Command::SetSubsteps(self.substeps),
            Command::EndGesture,
        ]
    }

    /// Relative tolerance, if the scheme controls its error.
    pub fn tolerance(&self) -> Option<f64> {
        let mut integrator = self.integrator.clone();
        let parameters = tolerances(&mut integrator);
        parameters.first().map(|tolerance| tolerance.get())
    }

    /// Label, such as `RK4, 12 steps a frame` or `Dormand-Prince 5(4), tolerance 1e-4`.
    pub fn label(&self) -> String {
        let title = self.integrator.kind().title();
        match (self.tolerance(), self.substeps.get()) {
            (Some(tolerance), 1) => format!("{title}, tolerance {tolerance:e}"),
            (Some(tolerance), substeps) => format!("{title}, tolerance {tolerance:e}, {substeps} steps a frame"),
            (None, 1) => format!("{title}, 1 step a frame"),
            (None, substeps) => format!("{title}, {substeps} steps a frame"),
        }
    }
}

/// Tolerances of a scheme, the relative one first. Empty if it does not control its error.
fn tolerances(integrator: &mut IntegratorKind) -> Vec<&mut dyn crate::quantity::Quantity> {
    if integrator.kind().class() != Class::ErrorControlled {
        return Vec::new();
    }
    let parameters = integrator.kind_mut().parameters();
    let mut tolerances: Vec<_> =
        parameters.into_iter().filter(|parameter| parameter.spec().name.contains("tolerance")).collect();
    tolerances.sort_by_key(|tolerance| !tolerance.spec().name.contains("relative"));
    tolerances
}

/// Scheme with all tolerances set to a value. `None` if it has none, or if the value is out of range.
pub(super) fn with_tolerance(integrator: &IntegratorKind, value: f64) -> Option<IntegratorKind> {
    let mut integrator = integrator.clone();
    let mut tolerances = tolerances(&mut integrator);
    if tolerances.is_empty() || !tolerances.iter_mut().all(|tolerance| tolerance.set(value).is_ok()) {
        return None;
    }
    drop(tolerances);
    Some(integrator)
}

/// Steps per frame at the stability limit of symplectic Euler near a state; 1 if nothing is stiff.
pub(super) fn limit(scene: &Scene, start: &State) -> f64 {
    let steps = [&scene.start, start].into_iter().filter_map(|state| critical_step(scene, state));
    steps.reduce(f64::min).map_or(1.0, |step| 1.0 / (60.0 * step))
}

/// Settings to try for a scheme, cheapest first.
/// Explicit schemes: steps from just above the stability limit of symplectic Euler to 1/64 of it (1/16 from order 4
/// on). Implicit schemes: 1 to 32 steps per frame. Error control: tolerances from 1e-3 to 1e-9. With looser ones,
/// which also apply in metres, a step could move vertices across whole triangles.
pub fn ladder(integrator: &IntegratorKind, scene: &Scene, start: &State) -> Vec<Setting> {
    let at = |count: f64| Setting { integrator: integrator.clone(), substeps: Substeps::nearest(count) };
    let mut settings: Vec<Setting> = match integrator.kind().class() {
        Class::Explicit => {
            let limit = limit(scene, start);
            // The first step is too long for symplectic Euler, but not for every scheme.
            let shares = [0.75, 1.1, 1.5, 2.0, 3.0, 4.0, 8.0, 16.0, 32.0, 64.0];
            // A scheme of high order is below all errors of interest long before 1/64.
            let finest = if integrator.kind().order() >= 4 { 16.0 } else { 64.0 };
            shares.into_iter().filter(|share| *share <= finest).map(|share| at(share * limit)).collect()
        }
        Class::Implicit => [1.0, 2.0, 4.0, 8.0, 16.0, 32.0].into_iter().map(at).collect(),
        Class::ErrorControlled => (3..=9)
            .filter_map(|digits| {
                let integrator = with_tolerance(integrator, libm::pow(10.0, -f64::from(digits)))?;
                Some(Setting { integrator, substeps: Substeps::nearest(1.0) })
            })
            .collect(),
    };
    settings.dedup();
    settings
}
