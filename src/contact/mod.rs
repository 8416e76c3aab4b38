//! Contact as a term of the physics with an energy, like an element, for every integrator alike.
//!
//! Each vertex of a boundary has a thin compliant skin ([`SurfaceVertex`]). Where it is compressed against an obstacle
//! ([`ObstacleContact`]), against the boundary of a body ([`SurfaceContact`]) or against cloth ([`ClothContact`]), a bounded, smooth potential pushes back
//! ([`Potential`]), friction pulls with an elastic-plastic spring to an anchor ([`Anchor`]), and both dissipate. What touches at
//! a moment is a [`Touch`]; a [`ContactTerm`] finds all of them. What the skin cannot hold, a truncation of the step does
//! ([`Truncation`], [`TruncatedStep`]), so that nothing ever crosses. Between vertices, convex corners of obstacles touch
//! edges of bodies, and triangles of membranes touch obstacles at rest at points between their corners ([`BetweenVertices`]).
//!
//! Obstacles always act like this. Bodies and cloth touch each other where a level has the effect [`Contact`](crate::effects::Contact). The effect
//! [`VelocityFilter`](crate::effects::VelocityFilter) replaces all of it by a filter of velocities ([`ObstacleTerm::filter`]).
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

mod any_contact;
mod between_vertices;
mod candidates;
mod cloth_contact;
mod cloth_crossings;
mod cloth_meeting;
mod cloth_mesh;
mod cloth_query;
mod contact_term;
mod corner_contact;
mod crossings;
mod edge_meeting;
mod edge_query;
mod face_contact;
mod face_points;
mod friction;
mod model;
mod obstacle_contact;
mod obstacle_truncation;
mod overlap;
mod position_filter;
mod potential;
mod skin;
mod space_points;
mod stencil;
mod surface_contact;
mod surface_rules;
mod surface_term;
mod touch;
mod truncation;
mod velocity_filter;

pub use any_contact::AnyContact;
pub use between_vertices::BetweenVertices;
pub use candidates::{Candidates, Grid, Pair, Surfaces};
pub use cloth_contact::ClothContact;
pub use cloth_crossings::{ClothSurface, segment_meets_triangle};
pub use cloth_mesh::{ClothEdge, ClothMesh, ClothTriangle};
pub use contact_term::ContactTerm;
pub use crossings::count_crossings;
pub use face_points::{FacePoint, FacePoints};
pub use friction::{Anchor, ContactName};
pub use model::{ContactModel, ContactProperties, Filter};
pub use obstacle_contact::{FilteredStep, ObstacleContact, ObstacleTerm, PlacedObstacle};
pub use obstacle_truncation::{Candidate, Met, Path, TruncatedStep};
pub use overlap::Overlap;
pub use potential::{Potential, dissipation, restitution};
pub use skin::{Skin, SurfaceEdge, SurfaceVertex, SurfaceVertices};
pub use surface_contact::SurfaceContact;
pub use surface_rules::{FrictionRule, FrictionTable, Surface};
pub use surface_term::SurfaceTerm;
pub use touch::{ClothPlace, ContactParameters, Curvature, Linearised, Members, Place, Touch};
pub use truncation::{Means, Truncation};
