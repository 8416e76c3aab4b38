//! Nets: particles held together by springs. Each kind is one file; [`NetKind`] lists them all.
//! Whatever a kind makes passes through [`Net::new`], which refuses what cannot be a net.

mod chain;
mod links;
mod net;
mod sheet;

pub use chain::Chain;
pub use links::Links;
pub use net::{Link, Net, NetError, Role};
pub use sheet::Sheet;

use crate::{quantity::Quantity, registry::registry};

registry! {
    /// Where a net's particles and springs come from.
    pub enum NetKind: dyn NetSource {
        Chain(Chain),
        Sheet(Sheet),
        Links(Links),
    }
}

/// A recipe for a net.
pub trait NetSource {
    /// Makes the net; the same recipe always gives the same bits.
    ///
    /// # Errors
    /// [`NetError`] says what is wrong with the recipe.
    fn build(&self) -> Result<Net, NetError>;

    /// The numbers a panel may change while time runs: none of them moves a particle.
    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        Vec::new()
    }
}
