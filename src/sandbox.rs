//! The document, the running simulation and what a person did to them: everything of the program but the window.

use crate::{
    command::Command,
    level::Level,
    meshes::Files,
    snapshot::{Field, Snapshot},
};

/// See the module.
pub struct Sandbox {}

/// Why a command was refused; nothing has changed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct Refused(pub String);

impl Sandbox {
    /// Starts with a level, in edit mode, ready to run.
    ///
    /// # Errors
    /// If the level cannot be built.
    pub fn new(level: Level, files: Box<dyn Files>) -> Result<Self, Refused>;

    /// Does what a command says, at once.
    ///
    /// # Errors
    /// [`Refused`] if it cannot be done; nothing has changed then.
    pub fn apply(&mut self, command: Command) -> Result<(), Refused>;

    /// Length of a step [s].
    pub fn step_length(&self) -> f64;

    /// Whether time should run now: running, not in edit mode, no fault.
    pub fn is_live(&self) -> bool;

    /// Takes up to `steps` steps; `more` is asked every few steps whether there is time for more.
    /// Returns how many were taken. A step that fails leaves the last finite state and a fault in the snapshot.
    pub fn advance(&mut self, steps: u64, more: &mut dyn FnMut() -> bool) -> u64;

    /// Copies what is to be seen into `snapshot`, reusing its buffers.
    pub fn snapshot(&self, field: Field, snapshot: &mut Snapshot);

    /// The document with the current state in it, for saving.
    pub fn saved(&self) -> Level;
}
