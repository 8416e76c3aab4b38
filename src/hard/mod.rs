//! Hard cases: scenes that test the stability of integrators and models.
//!
//! A [`Case`] is a level with scripted [`ScriptedAction`]s and what is expected at its end; each is one file of `levels/hard/`. A [`Run`]
//! takes a case with one constitutive model and one [`Method`] frame by frame of 1/60 s and ends with a [`Verdict`]. A [`Sweep`]
//! is many runs on several threads: the whole table of cases, models and methods.
//!
//! What decides, for every case:
//! - the simulation goes on: no fault, and never a number that is none;
//! - the energy is never above what was put in (see [`Ledger`]), but for [`Method::energy_tolerance`];
//! - nothing gets farther than [`OUTSIDE`] of its size through walls, or out of the box the case names;
//! - a body that should come home has no inverted triangle at the end, and no triangle whose area is off by more than [`AREA`].

mod case;
mod fence;
mod ledger;
mod method;
mod run;
mod sweep;
mod table;
mod verdict;

pub use case::{Cannot, Case, Expects, Lasts};
pub use fence::Fence;
pub use ledger::Ledger;
pub use method::Method;
pub use run::Run;
pub use sweep::{Entry, Sweep, Trial};
pub use table::{COLUMNS, row};
pub use verdict::{AREA, Failure, Numbers, OUTSIDE, Verdict};
