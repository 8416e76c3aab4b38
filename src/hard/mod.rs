//! Hard cases: scenes that test the stability of integrators and models.
//!
//! A [`Case`] is a level with [scripted actions](crate::level::ScriptedAction) and an expected end. Each is one file of `levels/hard/`. A
//! [`Run`] advances a case with one constitutive model and one [`Method`] in frames of 1/60 s and ends with a
//! [`Verdict`]. A [`Sweep`] is a table of runs of cases, models and methods on several threads. [`random`] holds variations of
//! the built-in levels.
//!
//! Criteria for every case:
//! - the simulation goes on: no fault, and no value that is not finite;
//! - the energy does not exceed the energy put in (see [`Ledger`]) by more than [`Method::energy_tolerance`];
//! - nothing gets farther than [`OUTSIDE`] of its size through walls, or out of the box of the case;
//! - a body that should return to its rest shape has no inverted triangle at the end, and no triangle whose area
//!   differs by more than [`AREA`].

mod case;
pub mod random;
mod run;
mod sweep;
#[cfg(feature = "csv")]
mod table;
mod verdict;

pub use case::{Cannot, Case, Expects, Lasts, Method};
pub use run::{Fence, Ledger, Run};
pub use sweep::{Entry, Sweep, Trial};
#[cfg(feature = "csv")]
pub use table::{COLUMNS, row};
pub use verdict::{AREA, Failure, Numbers, OUTSIDE, Verdict};
