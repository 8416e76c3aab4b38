//! Nets of particles and springs. Each kind is one file; [`NetKind`] lists them all.
//! Every net passes through [`Net::new`], which refuses invalid nets.
//!
//! ```
//! use gingerbread::nets::{Link, Net, Role};
//!
//! let spring = Link { ends: [0, 1], stiffness: 10.0, rest: 1.0, role: Role::Structural };
//! let net = Net::new(vec![[0.0, 0.0], [1.5, 0.0]], vec![spring])?;
//! assert_eq!(net.links()[0].length(net.points().as_flattened()), 1.5);
//! assert!(Net::new(vec![[0.0, 0.0]], vec![spring]).is_err(), "there is no second particle");
//! # Ok::<(), gingerbread::nets::NetError>(())
//! ```

mod chain;
mod lattice;
mod links;
mod net;
mod sheet;

pub use chain::Chain;
pub use lattice::Lattice;
pub use links::Links;
pub use net::{Link, Net, NetError, Role};
pub use sheet::{Sheet, SpringOrder};

use crate::{quantity::Quantity, registry::registry};

registry! {
    /// Where a net's particles and springs come from.
    pub enum NetKind: dyn NetSource {
        Chain(Chain),
        Sheet(Sheet),
        Lattice(Lattice),
        Links(Links),
    }
}

/// Recipe for a net.
pub trait NetSource {
    /// Builds the net. The same recipe always gives the same bits.
    ///
    /// # Errors
    /// [`NetError`] with the reason in the recipe.
    fn build(&self) -> Result<Net, NetError>;

    /// Quantities that a panel may change while time runs. None of them moves a particle.
    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        Vec::new()
    }
}
