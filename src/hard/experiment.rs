//! Experiments that show why a run of a hard case is not stable.

use super::{Case, Failure, Method, Reference, Run, Trial, Verdict};
use crate::{
    effects::{Compression, EffectKind},
    level::Substeps,
    materials::Model,
    scene::SceneError,
};
use serde::{Deserialize, Serialize};

/// A run that differs from an unstable one in one point, and in which the failure does not happen: that point is the cause. Or
/// the motion itself is the cause.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Experiment {
    /// Steps so many times as short.
    Shorter(Substeps),
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
    /// The damped motion ends like that: its reference has inverted or folded triangles, strain or speed at its end too.
    DampedMotion,
}

/// Whether a failure is one of the last state.
const fn ends(failure: Failure) -> bool {
    matches!(failure, Failure::Tangled | Failure::Inverted | Failure::Wound | Failure::Strain | Failure::Motion)
}

impl std::fmt::Display for Experiment {
    /// Says where the failure does not happen.
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Shorter(times) => write!(out, "not in steps {} times as short", times.get()),
            Self::Motion => write!(out, "in the reference too"),
            Self::Compression => write!(out, "not with the compression effect"),
            Self::Model(model) => write!(out, "not with the model {}", model.name()),
            Self::By(method) => write!(out, "not with {}", method.name()),
            Self::Damped => write!(out, "not with damping"),
            Self::DampedMotion => write!(out, "in the reference with damping too"),
        }
    }
}

impl Experiment {
    /// Experiments in the order in which a cause is looked for. A scheme that is stable at no step is a cause itself.
    pub fn all(method: Method) -> Vec<Self> {
        let shorter = |times: f64| Self::Shorter(Substeps::nearest(times));
        let steps = [Self::Motion, shorter(4.0), shorter(16.0)];
        let schemes = [Method::SymplecticEuler, Method::ImplicitEuler, Method::Bdf2].map(Self::By);
        let models = [Model::StableNeoHookean, Model::FixedCorotated, Model::Corotated, Model::NeoHookean];
        let [first, then] = if method.is_never_stable() { [schemes, steps] } else { [steps, schemes] };
        [&[Self::Compression][..], &first, &then, &models.map(Self::Model), &[Self::Damped, Self::DampedMotion]]
            .concat()
    }

    /// The run of the experiment for a run of a case; `None` if it is that run itself.
    ///
    /// # Errors
    /// If its level cannot be built.
    pub fn prepare(self, case: &Case, model: Model, method: Method) -> Result<Option<Run>, SceneError> {
        let run = match self {
            Self::Shorter(times) => Run::new(case, model, method)?.finer(times.get()),
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
            Self::Model(other) if other != model || case.energy().is_some() => {
                Run::new(&case.clone().with_energy(None), other, method)?
            }
            Self::By(other) if other != method => Run::new(case, model, other)?,
            Self::Damped if case.is_undamped_twin() => Run::new(case.damped(), model, method)?,
            Self::DampedMotion if case.is_undamped_twin() => {
                Run::new(case.damped(), model, Method::VelocityVerlet)?.finer(Reference::FINER)
            }
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
    /// `motion` is the verdict of [`Self::Motion`], which all methods share, once it is known.
    #[cfg(all(feature = "cli", not(target_arch = "wasm32")))]
    pub(crate) fn cause(trial: &Trial, failure: Failure, motion: &mut Option<Verdict>) -> Option<Self> {
        let Trial { case, model, method, .. } = trial;
        let known = case.cannot(*model, *method).and_then(|cannot| cannot.shown_by);
        let mut shows = |experiment: &Self| experiment.shows_with(trial, failure, motion) == Ok(true);
        known.filter(&mut shows).or_else(|| Self::all(*method).into_iter().find(shows))
    }

    /// Whether the experiment shows the cause of a failure, as [`Self::shows`]. `motion` keeps the verdict of [`Self::Motion`], which all
    /// methods share.
    ///
    /// # Errors
    /// If a scene cannot be built.
    pub fn shows_with(
        self,
        Trial { case, model, method, .. }: &Trial,
        failure: Failure,
        motion: &mut Option<Verdict>,
    ) -> Result<bool, SceneError> {
        if self != Self::Motion || !ends(failure) {
            return self.shows(case, *model, *method, failure);
        }
        if motion.is_none() {
            *motion = Self::Motion.verdict(case, *model, *method)?;
        }
        Ok(motion.as_ref().and_then(|motion| motion.failure).is_some_and(ends))
    }

    /// Whether the experiment shows the cause of a failure: it is stable. A failure before the end is shown as well by a run
    /// that fails at its end only.
    ///
    /// # Errors
    /// If a scene cannot be built.
    pub fn shows(self, case: &Case, model: Model, method: Method, failure: Failure) -> Result<bool, SceneError> {
        let is_motion = matches!(self, Self::Motion | Self::DampedMotion);
        if is_motion && !ends(failure) {
            return Ok(false);
        }
        let Some(verdict) = self.verdict(case, model, method)? else { return Ok(false) };
        let fails_at_end = verdict.failure.is_some_and(ends);
        Ok(if is_motion { fails_at_end } else { verdict.is_stable() || fails_at_end && !ends(failure) })
    }
}
