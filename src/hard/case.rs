//! A hard case: level, duration, expectation and known failures.

use super::{Experiment, Method};
use crate::{
    files::{self, FileError},
    level::{BodyLevel, Level, MembraneLevel, ScriptedAction, Substeps},
    levels,
    materials::{Model, TypedEnergy},
    meshes::NoFiles,
    quantity::{OutOfRange, Position, Time},
    scene::{Scene, SceneError},
    study::{StudyError, with_triangles},
};
use serde::{Deserialize, Serialize};
use std::{path::Path, sync::Arc};

/// Hard case: a level, its scripted actions and the expected end.
/// The text of the level states its purpose. Its step, integrator and models are not used, because each model and
/// method is tested.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// What there is at the start.
    pub level: Level,
    /// Scripted actions; also read under the earlier key `acts`.
    #[serde(default, alias = "acts")]
    pub actions: Vec<ScriptedAction>,
    /// How long it goes on.
    pub lasts: Lasts,
    /// Expected state at the end.
    pub expects: Expects,
    /// Corners of a box that nothing may leave, beside the walls of the level: what is thrown at a thin wall stays before it \[m\].
    #[serde(default)]
    pub within: Option<(Position, Position)>,
    /// Runs that are known to be unstable, and why.
    #[serde(default)]
    pub cannot: Vec<Cannot>,
    /// Whether its meshes were made finer.
    #[serde(skip)]
    fine: bool,
    /// A typed energy in place of those of all models.
    #[serde(skip)]
    energy: Option<Arc<TypedEnergy>>,
    /// The case that this one is the undamped twin of.
    #[serde(skip)]
    damped: Option<Arc<Case>>,
}

/// Duration of a case.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Lasts {
    /// For a time \[s\].
    Seconds(Time),
    /// For a number of steps, however long they are.
    Steps(u32),
}

/// Expected state of a case at its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Expects {
    /// Bodies are at rest in their rest shapes.
    Home,
    /// No triangle is inverted and none folded over.
    Bounded,
}

/// Models and methods with which a case is known to be unstable, the reason, and the experiment that shows it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cannot {
    /// By which constitutive models; all, if none is named.
    #[serde(default)]
    pub models: Vec<Model>,
    /// By which methods; all, if none is named.
    #[serde(default)]
    pub methods: Vec<Method>,
    /// Only on finer meshes than the case's own.
    #[serde(default)]
    pub fine: bool,
    /// Only in the undamped twin of the case.
    #[serde(default)]
    pub undamped: bool,
    /// Why, in a sentence.
    pub why: String,
    /// Run that differs in one point and is stable; without one the reason is not shown.
    #[serde(default)]
    pub shown_by: Option<Experiment>,
}

impl Case {
    /// Names of the built-in cases, in the order of the gallery.
    pub fn names() -> impl Iterator<Item = &'static str> {
        levels::HARD.iter().map(|(file, _)| file.strip_suffix(".ron").unwrap_or(file))
    }

    /// Reads a built-in case by its name, or a case from a file.
    ///
    /// # Errors
    /// [`FileError`] with the place and the reason.
    pub fn read(path: &Path) -> Result<Self, FileError> {
        let name = path.display().to_string();
        match levels::hard_case(&name) {
            Some(text) => files::parse_as(text, &format!("{name}.ron")),
            None => files::parse_as(&files::read_text(path)?, &name),
        }
    }

    /// Model whose elastic moduli a typed energy knows.
    pub const TYPED: Model = Model::NeoHookean;

    /// The same case with a typed energy for all bodies and membranes, or with the energies of the models again.
    #[must_use]
    pub fn with_energy(mut self, energy: Option<Arc<TypedEnergy>>) -> Self {
        self.damped = self.damped.map(|damped| Arc::new(Self::clone(&damped).with_energy(energy.clone())));
        self.energy = energy;
        self
    }

    /// The typed energy of all bodies and membranes, if there is one.
    pub const fn energy(&self) -> Option<&Arc<TypedEnergy>> {
        self.energy.as_ref()
    }

    /// Level with the case's actions, one model (or the typed energy) for all bodies and membranes, and the integrator of a method.
    pub fn level(&self, model: Model, method: Method) -> Level {
        let energy = self.energy.as_deref();
        let body = |body: &BodyLevel| BodyLevel {
            material: body.material.with_model(model),
            energy: energy.cloned(),
            ..body.clone()
        };
        let cloth = |cloth: &MembraneLevel| MembraneLevel {
            material: cloth.material.with_model(model),
            energy: energy.cloned(),
            ..cloth.clone()
        };
        let bodies = self.level.bodies.iter().map(body).collect();
        let membranes = self.level.membranes.iter().map(cloth).collect();
        let actions = self.level.actions.iter().chain(&self.actions).cloned().collect();
        Level { bodies, membranes, actions, integrator: method.integrator(), ..self.level.clone() }
    }

    /// Level as in [`Self::level`], with the first step of the method, for use outside the gallery.
    ///
    /// # Errors
    /// If the level cannot be built.
    pub fn watched(&self, model: Model, method: Method) -> Result<Level, SceneError> {
        let level = Level { substeps: Substeps::nearest(1.0), ..self.level(model, method) };
        let scene = Scene::build(&level, level.mode, &NoFiles, None)?;
        Ok(Level { substeps: Substeps::nearest(method.steps_a_frame(&scene)), ..level })
    }

    /// Known failure of a model and a method in this case, if any.
    pub fn cannot(&self, model: Model, method: Method) -> Option<&Cannot> {
        if self.energy.is_some() {
            return None;
        }
        let listed = |cannot: &&Cannot| {
            (self.fine || !cannot.fine)
                && (self.is_undamped_twin() || !cannot.undamped)
                && (cannot.models.is_empty() || cannot.models.contains(&model))
                && (cannot.methods.is_empty() || cannot.methods.contains(&method))
        };
        self.cannot.iter().find(listed)
    }

    /// Same case without damping by effects; `None` if it has none. Bodies are not expected to come to rest.
    #[must_use]
    pub fn undamped_twin(&self) -> Option<Self> {
        let mut twin = self.clone();
        twin.level.effects.retain(|listed| !listed.effect.kind().is_damping());
        if twin.level.effects.len() == self.level.effects.len() {
            return None;
        }
        (twin.expects, twin.damped) = (Expects::Bounded, Some(Arc::new(self.clone())));
        Some(twin)
    }

    /// Whether this is the undamped twin of a case.
    pub const fn is_undamped_twin(&self) -> bool {
        self.damped.is_some()
    }

    /// The case that this one is the undamped twin of, or the case itself.
    pub fn damped(&self) -> &Self {
        self.damped.as_deref().unwrap_or(self)
    }

    /// Same case on meshes with about `triangles` triangles in total.
    ///
    /// # Errors
    /// If the level cannot be built, or a pin names a vertex by number, which differs in another mesh.
    pub fn with_triangles(&self, triangles: u32) -> Result<Self, StudyError> {
        let scene = Scene::build(&self.level, self.level.mode, &NoFiles, None)?;
        let share = f64::from(triangles) / scene.triangles.len().max(1) as f64;
        Ok(Self { level: with_triangles(&self.level, share)?, fine: share > 1.0, ..self.clone() })
    }

    /// Same case with `times` times the duration. The times of the scripted actions stay.
    ///
    /// # Errors
    /// [`OutOfRange`] if the duration exceeds the range of a time.
    pub fn lasting(&self, times: u32) -> Result<Self, OutOfRange> {
        let lasts = match self.lasts {
            Lasts::Seconds(time) => Lasts::Seconds(Time::new(time.get() * f64::from(times))?),
            Lasts::Steps(steps) => Lasts::Steps(steps.saturating_mul(times)),
        };
        Ok(Self { lasts, ..self.clone() })
    }

    /// Same case from another start: the seeds of its start shapes increase by `by`. `None` if it has no such start.
    pub fn with_seed(&self, by: u32) -> Option<Self> {
        let mut case = self.clone();
        let mut seeded = false;
        for seed in case.level.bodies.iter_mut().filter_map(|body| body.start.seed_mut()) {
            *seed = seed.wrapping_add(by);
            seeded = true;
        }
        seeded.then_some(case)
    }
}
