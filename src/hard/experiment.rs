//! Experiments that show why a run of a hard case is not stable.

use super::{Case, Failure, Method, Reference, Run, Verdict};
use crate::{
    effects::{Compression, EffectKind},
    materials::Model,
    scene::SceneError,
};
use serde::{Deserialize, Serialize};

/// A run that differs from an unstable one in one point, and is stable: that point is the cause. Or the motion itself is the
/// cause.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Experiment {
    /// Steps so many times as short.
    Shorter(u32),
    /// The motion ends like that: the reference, which gains no energy, has inverted or folded triangles, strain or speed
    /// at its end too.
    Motion,
    /// With the effect `Compression`, which opposes inversion as the model St. Venant-Kirchhoff does not.
    Compression,
    /// Another constitutive model.
    Model(Model),
    /// Another integrator.
    By(Method),
    /// With damping: the case itself instead of its undamped twin.
    Damped,
}

impl std::fmt::Display for Experiment {
    /// Continues "stable".
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Shorter(times) => write!(out, "in steps {times} times as short"),
            Self::Motion => write!(out, "never: the reference ends like that"),
            Self::Compression => write!(out, "with the compression effect"),
            Self::Model(model) => write!(out, "with the model {}", model.name()),
            Self::By(method) => write!(out, "with {}", method.name()),
            Self::Damped => write!(out, "with damping"),
        }
    }
}

impl Experiment {
    /// Experiments in the order in which a cause is looked for.
    pub fn all() -> impl Iterator<Item = Self> {
        let models = [Model::StableNeoHookean, Model::FixedCorotated, Model::Corotated, Model::NeoHookean];
        let methods = [Method::ImplicitEuler, Method::SymplecticEuler, Method::Bdf2];
        [Self::Compression, Self::Shorter(4), Self::Shorter(16), Self::Motion]
            .into_iter()
            .chain(methods.map(Self::By))
            .chain(models.map(Self::Model))
            .chain([Self::Damped])
    }

    /// The run of the experiment for a run of a case; `None` if it is that run itself.
    ///
    /// # Errors
    /// If its level cannot be built.
    pub fn prepare(self, case: &Case, model: Model, method: Method) -> Result<Option<Run>, SceneError> {
        let run = match self {
            Self::Shorter(times) => Run::new(case, model, method)?.finer(times),
            Self::Motion => Run::new(case, model, Method::VelocityVerlet)?.finer(Reference::FINER),
            Self::Compression => {
                let listed =
                    case.level.effects.iter().any(|listed| matches!(listed.effect, EffectKind::Compression(_)));
                if listed || model != Model::StVenantKirchhoff || case.level.bodies.is_empty() {
                    return Ok(None);
                }
                let mut case = case.clone();
                case.level = case.level.with_effect(Compression::default());
                Run::new(&case, model, method)?
            }
            Self::Model(other) if other != model => Run::new(case, other, method)?,
            Self::By(other) if other != method => Run::new(case, model, other)?,
            Self::Damped if case.is_undamped_twin() => Run::new(case.damped(), model, method)?,
            _ => return Ok(None),
        };
        Ok(Some(run))
    }

    /// Runs the experiment. Returns its verdict; `None` if it is the run itself.
    ///
    /// # Errors
    /// If a scene cannot be built.
    pub fn verdict(self, case: &Case, model: Model, method: Method) -> Result<Option<Verdict>, SceneError> {
        let Some(mut run) = self.prepare(case, model, method)? else { return Ok(None) };
        run.finish().map(Some)
    }

    /// Experiment that shows why a run is not stable: that of its known failure, or the first of all; `None` if none does.
    pub fn cause(case: &Case, model: Model, method: Method, failure: Failure) -> Option<Self> {
        let known = case.cannot(model, method).and_then(|cannot| cannot.shown_by);
        let shows = |experiment: &Self| experiment.shows(case, model, method, failure) == Ok(true);
        known.filter(shows).or_else(|| Self::all().find(shows))
    }

    /// Whether the experiment shows the cause of a failure.
    ///
    /// # Errors
    /// If a scene cannot be built.
    pub fn shows(self, case: &Case, model: Model, method: Method, failure: Failure) -> Result<bool, SceneError> {
        let ends = |failure| matches!(failure, Failure::Inverted | Failure::Wound | Failure::Strain | Failure::Motion);
        if self == Self::Motion && !ends(failure) {
            return Ok(false);
        }
        let Some(verdict) = self.verdict(case, model, method)? else { return Ok(false) };
        Ok(if self == Self::Motion { verdict.failure.is_some_and(ends) } else { verdict.is_stable() })
    }
}
