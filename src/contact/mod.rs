//! Contact as a term of the physics with an energy, like an element, for every integrator alike.
//!
//! Each vertex of a boundary has a thin compliant skin ([`SurfaceVertex`]). Where it is compressed against an obstacle
//! ([`ObstacleContact`]) or against the boundary of a body ([`SurfaceContact`]), a bounded, smooth potential pushes back
//! ([`Potential`]), friction pulls with an elastic-plastic spring to an anchor ([`Anchor`]), and both dissipate. What touches at
//! a moment is a [`Touch`]; a [`ContactTerm`] finds all of them. What the skin cannot hold, a truncation of the step does
//! ([`Truncation`]), so that nothing ever crosses. A level chooses it with the effect [`Contact`](crate::effects::Contact); without that,
//! contact is a velocity filter at the end of each step ([`crate::obstacles`]).
//!
//! ```
//! use gingerbread::contact::Potential;
//!
//! // A skin of 10 mm and 3 kPa, compressed to half of its thickness.
//! let skin = Potential { modulus: 3000.0, thickness: 0.01 };
//! let (gap, step) = (0.005, 1e-6);
//! let slope = (skin.energy(gap + step) - skin.energy(gap - step)) / (2.0 * step);
//! assert!((skin.pressure(gap) + slope).abs() < 1e-6 * skin.pressure(gap));
//! assert_eq!(skin.pressure(0.01), 0.0);
//! ```

mod candidates;
mod crossings;
mod friction;
mod obstacle_contact;
mod potential;
mod skin;
mod surface_contact;
mod touch;
mod truncation;

pub use candidates::{Candidates, Pair};
pub use crossings::count_crossings;
pub use friction::{Anchor, ContactName};
pub use obstacle_contact::{ObstacleContact, PlacedObstacle};
pub use potential::{Potential, restitution};
pub use skin::{Skin, SurfaceEdge, SurfaceVertex, SurfaceVertices};
pub use surface_contact::SurfaceContact;
pub use touch::{ContactTerm, Curvature, Linearised, Place, Touch};
pub use truncation::{Means, Truncation};
