//! Commands: every user action on a sandbox as data. Nothing else changes it, so a list of commands is a replay, a bug report and what undo
//! works on.

use crate::{
    effects::EffectKind,
    integrators::IntegratorKind,
    level::{EffectLevel, Level, MassLevel, RunMode, SubstepMode, Substeps, Toggle},
    materials::{MaterialParameters, Model},
    meshes::MeshKind,
    nets::NetKind,
    quantity::ParticleMass,
    toys::ToyKind,
};

/// What the sandbox is doing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// Nothing moves; clicks pin and unpin.
    #[default]
    Edit,
    /// Time runs, without the effects that only collide mode has.
    Simulate,
    /// Time runs, with gravity, walls and whatever else the level keeps for this mode.
    Collide,
}

impl From<RunMode> for Mode {
    fn from(mode: RunMode) -> Self {
        match mode {
            RunMode::Simulate => Self::Simulate,
            RunMode::Collide => Self::Collide,
        }
    }
}

/// The shape a test level starts from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pose {
    /// As stretched as the level's test says.
    Stretched,
    /// As compressed as the level's test says.
    Compressed,
}

/// One thing to do. Commands that change the document (the level) can be undone.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// Goes to a mode; positions and velocities stay.
    SetMode(Mode),
    /// Pauses, or lets time run. In edit mode running goes to the level's own mode.
    SetRunning(bool),
    /// Takes one step, paused.
    StepOnce,
    /// Puts positions and velocities back to the start.
    Reset,
    /// Turns time back by so much [s], as far as the last seconds are kept, and pauses; a fault is forgotten.
    Rewind(f64),
    /// Puts bodies that lie over themselves where they are free of folds; time goes on from there.
    Untangle,
    /// Begins to pull a vertex (by its number in the scene) towards a point [m].
    Grab(usize, [f64; 2]),
    /// Moves the point that the grabbed vertex is pulled to [m].
    Pull([f64; 2]),
    /// Lets go.
    Release,

    /// Replaces the whole document and starts it, in edit mode. The old one can be had back with undo.
    Open(Box<Level>),
    /// Every body follows this model; positions and velocities go back to the start.
    SetModel(Model),
    /// What a body (by number) is made of.
    SetMaterial(usize, MaterialParameters),
    /// Where a body (by number) gets its triangles from. Everything starts over; pins stay at their places.
    SetMesh(usize, MeshKind),
    /// How heavy a body (by number) is.
    SetMass(usize, MassLevel),
    /// What a net (by number) is made of, and the mass of its particles. Its particles stay where they are.
    SetNet(usize, NetKind, ParticleMass),
    /// The numbers of the toy; it starts over.
    SetToy(ToyKind),
    /// Steps per 1/60 s.
    SetSubsteps(Substeps),
    /// Who takes how many steps.
    SetSubstepMode(SubstepMode),
    /// The time-stepping scheme, with its parameters; positions and velocities stay.
    SetIntegrator(IntegratorKind),
    /// Whether an unstable step is taken again in shorter ones.
    SetGuard(Toggle),
    /// Whether what has come to rest sleeps.
    SetSleep(Toggle),
    /// Replaces an effect of the level's list (by number), with its switch.
    SetEffect(usize, EffectLevel),
    /// Adds an effect to the level's list.
    AddEffect(EffectKind),
    /// Switches every damping effect on, or all off; adds one if the level has none.
    SetDamping(bool),
    /// Pins a vertex (by its number in the scene), or frees it.
    TogglePin(usize),
    /// Frees all vertices.
    ClearPins,
    /// Sets the start of a test level and begins there.
    SetPose(Pose),
    /// Shows one body for each constitutive model, side by side, in a test level; or a single one again.
    SetSideBySide(bool),
    /// Ends a gesture: the next change of the same slider is undone on its own.
    EndGesture,
    /// Takes the last change of the document back.
    Undo,
    /// Makes it again.
    Redo,
}

/// What a command is about: two runs of one experiment may be computed differently.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum About {
    /// What happens: the scene, what acts on it, and time.
    Experiment,
    /// How that is computed: scheme, step, constitutive model, mesh.
    Method,
}

impl Command {
    /// Whether it is a pull, as the pointer asks for it in every frame.
    pub const fn is_of_the_hand(&self) -> bool {
        matches!(self, Self::Grab(..) | Self::Pull(_) | Self::Release)
    }

    /// What it is about.
    pub const fn about(&self) -> About {
        match self {
            Self::SetModel(_)
            | Self::SetMesh(..)
            | Self::SetSubsteps(_)
            | Self::SetSubstepMode(_)
            | Self::SetIntegrator(_)
            | Self::SetGuard(_)
            | Self::SetSleep(_) => About::Method,
            Self::SetMode(_)
            | Self::SetRunning(_)
            | Self::StepOnce
            | Self::Reset
            | Self::Rewind(_)
            | Self::Untangle
            | Self::Grab(..)
            | Self::Pull(_)
            | Self::Release
            | Self::Open(_)
            | Self::SetMaterial(..)
            | Self::SetMass(..)
            | Self::SetNet(..)
            | Self::SetToy(_)
            | Self::SetEffect(..)
            | Self::AddEffect(_)
            | Self::SetDamping(_)
            | Self::TogglePin(_)
            | Self::ClearPins
            | Self::SetPose(_)
            | Self::SetSideBySide(_)
            | Self::EndGesture
            | Self::Undo
            | Self::Redo => About::Experiment,
        }
    }
}
