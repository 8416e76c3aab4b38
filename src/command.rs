//! Commands: every user action on a sandbox as data. The sandbox changes by commands alone, so that a list of commands
//! is a replay, a bug report and the unit of undo.
//!
//! ```
//! use gingerbread::{command::Command, files, levels, materials::Model, meshes::NoFiles, sandbox::Sandbox};
//!
//! let level = files::parse(levels::built_in("gingerbread").ok_or("there is no such level")?, "gingerbread.ron")?;
//! let mut sandbox = Sandbox::new(level, Box::new(NoFiles))?;
//! for command in [Command::SetModel(Model::NeoHookean), Command::Undo] {
//!     sandbox.apply(command)?;
//! }
//! assert_eq!(sandbox.document().level.bodies[0].material.model(), Model::Corotated);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::{
    effects::EffectKind,
    elements::ElementKind,
    finish::Finish,
    impulse::Impulse,
    integrators::IntegratorKind,
    level::{
        BodyLevel, EffectLevel, Level, MassLevel, Note, Pin, Place, RunMode, Sleep, SpacePlace, SubstepMode, Substeps,
        Toggle,
    },
    materials::{MaterialParameters, Model, TypedEnergy},
    meshes::MeshKind,
    nets::NetKind,
    quantity::{ParticleMass, Thickness},
    toys::ToyKind,
};

/// Mode of the sandbox.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// Edit: time is stopped; clicks pin and unpin.
    #[default]
    Edit,
    /// Simulate: time runs, without the effects of collide mode.
    Simulate,
    /// Collide: time runs, with gravity, walls and the other effects of this mode.
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

/// Start shape of a test level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pose {
    /// The stretch of the level's test.
    Stretched,
    /// The compression of the level's test.
    Compressed,
}

/// A place of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Spot {
    /// A vertex, by its number in the scene.
    Vertex(usize),
    /// A point \[m\]; in the plane its third coordinate is not used.
    Place([f64; 3]),
}

/// One user action. Commands that change the document (the level) can be undone.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// Changes the mode; positions and velocities stay.
    SetMode(Mode),
    /// Pauses, or lets time run. In edit mode running goes to the level's own mode.
    SetRunning(bool),
    /// Takes one step, paused.
    StepOnce,
    /// Takes the steps of a frame of 1/60 s, at least one, paused.
    StepFrame,
    /// Resets positions and velocities to the start.
    Reset,
    /// Rewinds by a time \[s\], as far as the buffer reaches, and pauses; clears a fault.
    Rewind(f64),
    /// Resets tangled bodies to a shape without folds; time continues from there.
    Untangle,
    /// Begins to pull a vertex (by its number in the scene) towards a point \[m\]; in the plane its third coordinate is not used.
    Grab(usize, [f64; 3]),
    /// Moves the point that the grabbed vertex is pulled to \[m\].
    Pull([f64; 3]),
    /// Ends the pull.
    Release,
    /// Changes the velocities near a point at once.
    Impulse(Impulse),
    /// Starts over and records pulls and pushes as scripted actions of the level, or ends this and pauses. Other commands than these and those
    /// of time end it too.
    Record(bool),

    /// Replaces the whole document and starts it, in edit mode. Undo restores the old one.
    Open(Box<Level>),
    /// Sets the constitutive model of every body; positions and velocities are reset to the start.
    SetModel(Model),
    /// Sets the material of a body (by number).
    SetMaterial(usize, MaterialParameters),
    /// Sets the typed energy of a body or membrane, by the number of the part, or goes back to its model.
    SetEnergy(usize, Option<TypedEnergy>),
    /// Adds bodies, and starts over. They get other names where their own are taken.
    AddBodies(Vec<BodyLevel>),
    /// Adds a copy of a body, net or membrane (by number, in this order) to the right of all others, with its pins, and starts over.
    CopyPart(usize),
    /// Removes a body, net or membrane (by number, in this order), and starts over.
    RemovePart(usize),
    /// Sets the mesh of a body (by number). Everything is reset; pins stay at their places.
    SetMesh(usize, MeshKind),
    /// Sets where a body (by number) is, how far it is turned and how large it is. Everything is reset; pinned vertices stay pinned.
    SetPlace(usize, Place),
    /// Sets where a net or membrane (by number: nets first, then membranes) is in space, how it is turned and how large it is. Everything is reset; pinned vertices
    /// stay pinned.
    SetSpacePlace(usize, SpacePlace),
    /// Divides triangles (by their numbers in the scene: of the bodies, then of the membranes), and goes on from the present state.
    Refine(Vec<usize>),
    /// Divides the fewest triangles that have together half of the sum of the squared errors of the stress, and goes on from the present state.
    RefineWorst,
    /// Sets the kind of the elements of a body (by number). Everything is reset; pins stay at their places.
    SetElement(usize, ElementKind),
    /// Sets the mass of a body (by number).
    SetMass(usize, MassLevel),
    /// Sets the material of a membrane (by number), its thickness and its mass.
    SetMembrane(usize, MaterialParameters, Thickness, MassLevel),
    /// Sets how a net or membrane looks (by number: nets first, then membranes).
    SetFinish(usize, Finish),
    /// Sets the springs of a net (by number) and the mass of its particles, which stay in place.
    SetNet(usize, NetKind, ParticleMass),
    /// Sets the parameters of the toy and restarts it.
    SetToy(ToyKind),
    /// Sets the steps per 1/60 s.
    SetSubsteps(Substeps),
    /// Sets the mode of multirate stepping.
    SetSubstepMode(SubstepMode),
    /// Sets the time-stepping scheme, with its parameters; positions and velocities stay.
    SetIntegrator(IntegratorKind),
    /// Sets the time-stepping scheme and the steps per 1/60 s as one change.
    SetStepping(IntegratorKind, Substeps),
    /// Switches the guard.
    SetGuard(Toggle),
    /// Switches sleep.
    SetSleep(Sleep),
    /// Replaces an effect of the level's list (by number), with its switch.
    SetEffect(usize, EffectLevel),
    /// Adds an effect to the level's list.
    AddEffect(EffectKind),
    /// Switches every damping effect on, or all off; adds one if the level has none.
    SetDamping(bool),
    /// Switches wind on or off; adds one if the level has cloth in space and no wind.
    SetWind(bool),
    /// Sets the rules by which a body, net or membrane is pinned (by number: bodies first, then nets, then membranes).
    SetPins(usize, Vec<Pin>),
    /// Pins a vertex (by its number in the scene), or frees it.
    TogglePin(usize),
    /// Pins vertices (by their numbers in the scene), or frees them.
    PinAll(Vec<usize>, bool),
    /// Frees all vertices.
    ClearPins,
    /// Prescribes the path of a vertex (by its number in the scene) from now on, given by times from now \[s\] and displacements from its present place \[m\]; if it is pinned, all pinned vertices of its
    /// body, net or membrane move with it.
    MoveAlong(usize, Vec<(f64, [f64; 3])>),
    /// Adds a note.
    AddNote(Spot),
    /// Replaces all notes.
    SetNotes(Vec<Note>),
    /// Sets the start of a test level and begins there.
    SetPose(Pose),
    /// Shows one body for each constitutive model, side by side, in a test level; or a single one again.
    SetSideBySide(bool),
    /// Ends a gesture: the next change of the same slider is undone on its own.
    EndGesture,
    /// Undoes the last change of the document.
    Undo,
    /// Redoes the last undone change.
    Redo,
}

/// Subject of a command: two runs of the same experiment may differ in numerics.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum About {
    /// The experiment: scene, effects and time.
    Experiment,
    /// The numerics: scheme, step, constitutive model, mesh.
    Method,
}

impl Command {
    /// Whether the command belongs to a pull: the pointer sends pulls in every frame.
    pub const fn is_of_the_hand(&self) -> bool {
        matches!(self, Self::Grab(..) | Self::Pull(_) | Self::Release)
    }

    /// Whether the command can be recorded as a scripted action.
    pub const fn is_recorded(&self) -> bool {
        self.is_of_the_hand() || matches!(self, Self::Impulse(_))
    }

    /// Whether the command lets time run, stops it, or ends a gesture: it changes nothing else.
    pub const fn is_of_time(&self) -> bool {
        matches!(self, Self::SetRunning(_) | Self::StepOnce | Self::StepFrame | Self::EndGesture)
    }

    /// Subject of the command.
    pub const fn about(&self) -> About {
        match self {
            Self::SetModel(_)
            | Self::SetEnergy(..)
            | Self::SetMesh(..)
            | Self::Refine(_)
            | Self::RefineWorst
            | Self::SetElement(..)
            | Self::SetSubsteps(_)
            | Self::SetSubstepMode(_)
            | Self::SetIntegrator(_)
            | Self::SetStepping(..)
            | Self::SetGuard(_)
            | Self::SetSleep(_) => About::Method,
            Self::SetMode(_)
            | Self::SetRunning(_)
            | Self::StepOnce
            | Self::StepFrame
            | Self::Reset
            | Self::Rewind(_)
            | Self::Untangle
            | Self::Grab(..)
            | Self::Pull(_)
            | Self::Release
            | Self::Impulse(_)
            | Self::Record(_)
            | Self::Open(_)
            | Self::SetMaterial(..)
            | Self::AddBodies(_)
            | Self::CopyPart(_)
            | Self::RemovePart(_)
            | Self::SetPlace(..)
            | Self::SetSpacePlace(..)
            | Self::SetMass(..)
            | Self::SetMembrane(..)
            | Self::SetNet(..)
            | Self::SetFinish(..)
            | Self::SetToy(_)
            | Self::SetEffect(..)
            | Self::AddEffect(_)
            | Self::SetDamping(_)
            | Self::SetWind(_)
            | Self::SetPins(..)
            | Self::TogglePin(_)
            | Self::PinAll(..)
            | Self::ClearPins
            | Self::MoveAlong(..)
            | Self::AddNote(_)
            | Self::SetNotes(_)
            | Self::SetPose(_)
            | Self::SetSideBySide(_)
            | Self::EndGesture
            | Self::Undo
            | Self::Redo => About::Experiment,
        }
    }
}
