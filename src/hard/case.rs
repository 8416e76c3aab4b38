//! A hard case: level, duration and expectation; and the methods that it runs with.

use crate::{
    files::{self, FileError},
    integrators::{Bdf2, ImplicitEuler, IntegratorKind, SymplecticEuler},
    level::{BodyLevel, Level, ScriptedAction, Substeps},
    levels,
    materials::Model,
    meshes::NoFiles,
    quantity::{OutOfRange, Point, Time},
    scene::{Scene, SceneError},
    stability::critical_step,
    study::{StudyError, with_triangles},
};
use serde::{Deserialize, Serialize};
use std::path::Path;

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
    /// What decides beside numbers, energy and walls.
    pub expects: Expects,
    /// Corners of a box that nothing may leave, beside the walls of the level: what is thrown at a thin wall stays before it \[m\].
    #[serde(default)]
    pub within: Option<(Point, Point)>,
    /// What cannot be held, and why.
    #[serde(default)]
    pub cannot: Vec<Cannot>,
    /// Whether its meshes were made finer.
    #[serde(skip)]
    fine: bool,
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
    /// Bodies are back in their rest shapes.
    Home,
    /// Nothing beyond what is expected all the time.
    Bounded,
}

/// Models and methods that cannot hold a case, and the reason.
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
    /// Why, in a sentence for people.
    pub why: String,
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

    /// Level with the case's actions, one model for all bodies, and the integrator of a method.
    pub fn level(&self, model: Model, method: Method) -> Level {
        let body = |body: &BodyLevel| BodyLevel { material: body.material.with_model(model), ..body.clone() };
        let bodies = self.level.bodies.iter().map(body).collect();
        let actions = self.level.actions.iter().chain(&self.actions).cloned().collect();
        Level { bodies, actions, integrator: method.integrator(), ..self.level.clone() }
    }

    /// Level as in [`Self::level`], with the first step of the method, for use outside the gallery.
    ///
    /// # Errors
    /// If the level cannot be built.
    pub fn watched(&self, model: Model, method: Method) -> Result<Level, SceneError> {
        let level = Level { substeps: Substeps::nearest(1.0), ..self.level(model, method) };
        if !method.is_explicit() {
            return Ok(level);
        }
        let scene = Scene::build(&level, level.mode, &NoFiles, None)?;
        let limit = critical_step(&scene, &scene.start, None).unwrap_or(f64::INFINITY);
        Ok(Level { substeps: Substeps::nearest(1.0 / (60.0 * Method::SHARE * limit)), ..level })
    }

    /// Reason why a model and a method cannot hold this case, if any.
    pub fn cannot(&self, model: Model, method: Method) -> Option<&str> {
        let listed = |cannot: &&Cannot| {
            (self.fine || !cannot.fine)
                && (cannot.models.is_empty() || cannot.models.contains(&model))
                && (cannot.methods.is_empty() || cannot.methods.contains(&method))
        };
        self.cannot.iter().find(listed).map(|cannot| cannot.why.as_str())
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

/// Integrator and step of a hard case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Method {
    /// Symplectic Euler at [`Self::SHARE`] of its longest stable step, which is found again at every frame.
    SymplecticEuler,
    /// Implicit Euler with steps of 1/60 s.
    ImplicitEuler,
    /// BDF2 with steps of 1/60 s.
    Bdf2,
}

impl Method {
    /// All methods, in the order of the table.
    pub const ALL: [Self; 3] = [Self::SymplecticEuler, Self::ImplicitEuler, Self::Bdf2];

    /// Greatest share of the longest stable step that an explicit scheme takes.
    pub const SHARE: f64 = 0.25;

    /// Energy tolerance of an implicit scheme, relative to the greatest possible mechanical energy.
    const IMPLICIT: f64 = 0.02;

    /// Name in case files and tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::SymplecticEuler => "SymplecticEuler",
            Self::ImplicitEuler => "ImplicitEuler",
            Self::Bdf2 => "Bdf2",
        }
    }

    /// Name in plain words.
    pub const fn title(self) -> &'static str {
        match self {
            Self::SymplecticEuler => "Symplectic Euler",
            Self::ImplicitEuler => "Implicit Euler",
            Self::Bdf2 => "BDF2",
        }
    }

    /// Description of the step, for a tooltip.
    pub const fn about(self) -> &'static str {
        match self {
            Self::SymplecticEuler => "A quarter of its longest stable step, found again at every frame.",
            Self::ImplicitEuler | Self::Bdf2 => "Steps of 1/60 s, however stiff the scene is.",
        }
    }

    /// Integrator.
    pub fn integrator(self) -> IntegratorKind {
        match self {
            Self::SymplecticEuler => IntegratorKind::SymplecticEuler(SymplecticEuler::default()),
            Self::ImplicitEuler => IntegratorKind::ImplicitEuler(ImplicitEuler::default()),
            Self::Bdf2 => IntegratorKind::Bdf2(Bdf2::default()),
        }
    }

    /// Whether the scheme is explicit, so that its step is limited by the fastest vibration.
    pub const fn is_explicit(self) -> bool {
        matches!(self, Self::SymplecticEuler)
    }

    /// Energy tolerance, relative to the greatest possible mechanical energy.
    ///
    /// Symplectic Euler keeps `E - h/2 v . dU/dx`, not E. For a vibration w at a step `h = s 2/w`, E swings by up to
    /// `s / (1 - s)` above its start value at rest (Hairer, Lubich and Wanner, *Geometric Numerical Integration*,
    /// section I.1).
    pub fn energy_tolerance(self) -> f64 {
        if self.is_explicit() { Self::SHARE / (1.0 - Self::SHARE) } else { Self::IMPLICIT }
    }
}
