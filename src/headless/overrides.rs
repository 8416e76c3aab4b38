//! Settings of a level that the command line replaces.

use super::HeadlessError;
use crate::{
    integrators::IntegratorKind,
    level::{Level, Substeps},
    materials::Model,
    sandbox::Refused,
};
use std::{path::Path, str::FromStr as _};

/// What replaces a level's own settings.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct Overrides {
    /// Constitutive model for every body and membrane, instead of the level's own.
    #[arg(long, value_parser = Model::from_str)]
    pub model: Option<Model>,
    /// Integrator, instead of the level's own; also e, t, r and i for forward Euler, the trapezoidal scheme (Heun), classical Runge-Kutta and implicit Euler.
    #[arg(long, value_parser = IntegratorKind::from_str)]
    pub integrator: Option<IntegratorKind>,
    /// Longest time step \[s\], instead of the level's own; a frame of 1/60 s has a whole number of steps.
    #[arg(long, value_name = "SECONDS", value_parser = step, allow_negative_numbers = true)]
    pub step: Option<Substeps>,
}

impl Overrides {
    /// Replaces the settings of a level.
    ///
    /// # Errors
    /// If no body or membrane has a model, or one cannot have this.
    pub fn apply(&self, level: &mut Level, path: &Path) -> Result<(), HeadlessError> {
        let fail = |why| HeadlessError::Level { file: path.display().to_string(), why };
        if self.model.is_some() || self.integrator.is_some() || self.step.is_some() {
            // A changed level leads elsewhere.
            level.recorded = None;
        }
        if let Some(model) = self.model {
            if level.bodies.is_empty() && level.membranes.is_empty() {
                return Err(fail(Refused::NotHere("there is no body or membrane here to be of another model")));
            }
            level.set_model(model).map_err(|why| fail(Refused::Material(why)))?;
        }
        if let Some(integrator) = &self.integrator {
            level.integrator = integrator.clone();
        }
        if let Some(step) = self.step {
            level.substeps = step;
        }
        if let Some(state) = level.state.as_mut().filter(|_| self.integrator.is_some() || self.step.is_some()) {
            // What a scheme remembers of earlier steps is of no use to another one, or to steps of another length.
            state.memory.clear();
            state.checkpoints.clear();
        }
        Ok(())
    }
}

fn step(text: &str) -> Result<Substeps, String> {
    let least = 1.0 / (60.0 * f64::from(Substeps::MAX));
    let steps = text.parse().ok().and_then(Substeps::for_step);
    steps.ok_or_else(|| format!("expected a number of seconds in [{least:.3e}, 1/60]"))
}
