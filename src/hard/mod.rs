//! Hard cases: scenes that test the stability and accuracy of integrators and models.
//!
//! A [`Case`] is a level with [scripted actions](crate::level::ScriptedAction) and an expected end. Each is one file of
//! `levels/hard/`. A [`Run`] advances a case with one constitutive model and one [`Method`] in frames of 1/60 s and ends
//! with a [`Verdict`]. A [`Sweep`] is a table of runs of cases, models and methods on several threads. Every case with damping
//! has an [undamped twin](Case::undamped_twin).
//!
//! A run is stable if
//! - the simulation goes on: no fault, and no value that is not finite;
//! - the energy from nowhere (see [`Account`]) is at most [`Method::energy_tolerance`] of the energy put in;
//! - nothing gets farther than [`OUTSIDE`] of its size through walls, or out of the box of the case;
//! - no triangle is inverted at the end, and none folded over another at a vertex;
//! - a body that should return to its rest shape has no strain above [`STRAIN`] at the end and moves no faster than
//!   [`SPEED`].
//!
//! How far off a run is states its [`Distance`] from a [`Reference`]. A run is held if it is stable and no farther off than
//! [`ACCURATE`]. Why a run is not stable is shown by an [`Experiment`].

mod account;
mod case;
mod experiment;
mod method;
pub mod random;
mod random_contact;
mod reference;
mod run;
mod search;
mod sweep;
#[cfg(feature = "csv")]
mod table;
mod verdict;

pub use account::Account;
pub use case::{Cannot, Case, Expects, Lasts};
pub use experiment::Experiment;
pub use method::Method;
pub use reference::{Distance, Quantity, Reference};
pub use run::{Fence, Run};
pub use search::{Found, Search};
pub use sweep::{Entry, Sweep, Trial};
#[cfg(feature = "csv")]
pub use table::{COLUMNS, row};
pub use verdict::{ACCURATE, Failure, Numbers, OUTSIDE, SPEED, STRAIN, Verdict};
