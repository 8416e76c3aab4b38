//! Effects: forces on bodies beside their elasticity, and contact. Each effect is one file with two types: its
//! parameters, which a level lists, and the built effect, which takes part in a step. [`EffectKind`] lists them all.
//!
//! ```
//! use gingerbread::{effects::{Drag, EffectParameters as _, Motion}, elements::Elements};
//!
//! let drag = Drag::default().build(&Elements::default())?;
//! let (x, v) = ([0.0, 0.0], [2.0, 0.0]);
//! let motion = Motion { dimension: 2, x: &x, v: &v, mass: &[1.0; 2], inverse_mass: &[1.0; 2], ..Motion::NONE };
//! let mut force = [0.0; 2];
//! drag.force(motion, &mut [], &mut force);
//! assert_eq!(force, [-0.2, 0.0]);
//! # Ok::<(), String>(())
//! ```

mod absolute_damping;
mod air;
mod bending;
mod body_force;
mod boundary;
mod bounds;
mod compression;
mod contact;
mod drag;
mod edge_load;
mod friction;
mod gravity;
mod mouse_spring;
mod moving_pins;
mod obstacle_effect;
mod position_filter;
mod projection;
mod rain;
mod rayleigh;
mod restitution;
mod rods;
mod velocity_filter;
mod vortex;
mod walls;
mod wind;
mod wire;

pub use absolute_damping::AbsoluteDamping;
pub use bending::Bending;
pub use body_force::{BodyForce, PointFormula};
pub use boundary::Boundary;
pub use bounds::Bounds;
pub use compression::Compression;
pub use contact::Contact;
pub use drag::Drag;
pub use edge_load::EdgeLoad;
pub use friction::{Friction, SurfaceFriction};
pub use gravity::Gravity;
pub use mouse_spring::MouseSpring;
pub use moving_pins::{HeldVertices, MovingPins};
use obstacle_effect::ObstacleEffect;
pub use position_filter::PositionFilter;
pub use projection::{LengthProjection, ProjectedPins, Projection};
pub use rain::Rain;
pub use rayleigh::Rayleigh;
pub(crate) use rayleigh::Viscous;
pub use restitution::Restitution;
pub use rods::Rods;
pub use velocity_filter::VelocityFilter;
pub use vortex::Vortex;
pub use walls::Walls;
pub use wind::{MODES, Wind};
pub use wire::{Wire, WireShape};

use crate::{
    contact::{Anchor, AnyContact, Candidates, ContactProperties, ObstacleTerm, Pair, SurfaceTerm},
    elements::{Elements, EulerUpdate, UniformForce},
    meshes::Pin,
    obstacles::{ObstacleKind, Surfaces, Triangulation},
    quantity::Quantity,
    registry::registry,
    solvers::{ConstraintRows, SparseMatrix, Weights},
};
use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

registry! {
    /// Kinds of effects.
    pub enum EffectKind: dyn EffectParameters {
        Gravity(Gravity),
        Rayleigh(Rayleigh),
        Drag(Drag),
        BodyForce(BodyForce),
        EdgeLoad(EdgeLoad),
        MouseSpring(MouseSpring),
        Boundary(Boundary),
        Walls(Walls),
        Restitution(Restitution),
        Friction(Friction),
        Compression(Compression),
        Contact(Contact),
        VelocityFilter(VelocityFilter),
        PositionFilter(PositionFilter),
        Projection(Projection),
        Wind(Wind),
        Vortex(Vortex),
        Rain(Rain),
        Bending(Bending),
        MovingPins(MovingPins),
        Rods(Rods),
        Wire(Wire),
        AbsoluteDamping(AbsoluteDamping),
    }
}

impl EffectKind {
    /// Whether the effect can act on the elements of a scene.
    ///
    /// # Errors
    /// The reason why not, in words.
    pub fn fits(&self, elements: &Elements) -> Result<(), String> {
        let effect = self.kind().build(elements)?;
        match effect.dimension().filter(|dimension| *dimension != elements.dimension()) {
            Some(3) => Err("it acts in space, and the level is in the plane".to_owned()),
            Some(_) => Err("it acts in the plane, and the level is in space".to_owned()),
            None => Ok(()),
        }
    }
}

/// Rules by which an effect names vertices or edges.
pub struct Rules<'a> {
    /// Name of the body, net or membrane; all, if it is not said.
    pub of: &'a mut Option<String>,
    /// The rules.
    pub pins: &'a mut Vec<Pin>,
    /// Whether they name the edges between those vertices.
    pub are_of_edges: bool,
}

/// The parameters of an effect.
pub trait EffectParameters {
    /// Name in the window, such as `Gravity`.
    fn title(&self) -> &'static str;

    /// Description with the formula, for a tooltip.
    fn about(&self) -> &'static str;

    /// The numbers a panel may change.
    fn parameters(&mut self) -> Vec<&mut dyn Quantity>;

    /// The same numbers in groups.
    fn groups(&mut self) -> Vec<Group<'_>> {
        vec![Group { title: None, solid: None, numbers: self.parameters() }]
    }

    /// The obstacles of the effect.
    fn obstacles(&self) -> &[ObstacleKind] {
        &[]
    }

    /// The same, to be added, moved and removed; `None` if it cannot have any.
    fn obstacles_mut(&mut self) -> Option<&mut Vec<ObstacleKind>> {
        None
    }

    /// The formulas a panel may change, with their names.
    fn formulas(&mut self) -> Vec<(&'static str, &mut PointFormula)> {
        Vec::new()
    }

    /// The rules by which it names vertices or edges, if it does.
    fn rules_mut(&mut self) -> Option<Rules<'_>> {
        None
    }

    /// Whether it is damping; the key D switches damping.
    fn is_damping(&self) -> bool {
        false
    }

    /// Policy for an effect that is listed more than once.
    fn duplicate_policy(&self) -> DuplicatePolicy {
        DuplicatePolicy::Both
    }

    /// Reason why the effect has no effect as listed, if there is one.
    fn ineffective(&self) -> Option<&'static str> {
        None
    }

    /// Notes for the user.
    fn notes(&self) -> Vec<String> {
        Vec::new()
    }

    /// Shapes to draw at a time \[s\].
    fn shapes(&self, _time: f64, _surfaces: &Surfaces) -> Vec<Shape> {
        Vec::new()
    }

    /// The files of surfaces of triangles that it names.
    fn surface_paths(&self) -> Vec<&Path> {
        Vec::new()
    }

    /// The same, to be changed.
    fn surface_paths_mut(&mut self) -> Vec<&mut PathBuf> {
        Vec::new()
    }

    /// Builds the effect for stepping.
    ///
    /// # Errors
    /// A sentence, if the parameters do not fit together.
    fn build(&self, elements: &Elements) -> Result<Box<dyn Effect>, String>;
}

/// A group of parameters of an effect.
pub struct Group<'a> {
    /// Title of the group; `None` for the effect itself.
    pub title: Option<String>,
    /// Number of the [`Shape::Solid`] that it belongs to, if any.
    pub solid: Option<usize>,
    /// The numbers.
    pub numbers: Vec<&'a mut dyn Quantity>,
}

/// Policy for an effect that is listed more than once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DuplicatePolicy {
    /// Both act.
    Both,
    /// Both act, which is unusual: reason in words.
    Odd(&'static str),
    /// Only one can act, and the level does not say which: reason in words.
    Ambiguous(&'static str),
}

/// A shape to draw; all points in world coordinates \[m\].
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// The free region between walls: a convex polygon, counter-clockwise, clipped where there are no walls.
    Room(Vec<[f64; 2]>),
    /// A solid obstacle: its outline, counter-clockwise.
    Solid(Vec<[f64; 2]>),
    /// The domain: least and greatest corner.
    Edges([f64; 2], [f64; 2]),
    /// The surface of an obstacle in space.
    Surface(Triangulation),
    /// A thin line through points in the plane or in space \[m\], the third coordinate of which is zero in the plane.
    Wire {
        /// The points.
        points: Vec<[f64; 3]>,
        /// Whether it goes on from the last to the first.
        closed: bool,
    },
}

/// Positions, velocities and masses at one moment, flat.
#[derive(Clone, Copy, Debug)]
pub struct Motion<'a> {
    /// Number of coordinates of a vertex.
    pub dimension: usize,
    /// Positions \[m\].
    pub x: &'a [f64],
    /// Velocities [m/s].
    pub v: &'a [f64],
    /// Masses \[kg\], one for each number of `x`.
    pub mass: &'a [f64],
    /// 1/mass [1/kg]; zero where a vertex is pinned.
    pub inverse_mass: &'a [f64],
    /// Vertex that the mouse pulls.
    pub grab: Option<Grab>,
    /// Simulated time \[s\].
    pub time: f64,
    /// Anchors of friction, in the order of their contacts.
    pub anchors: &'a [Anchor],
    /// Pairs that may be near each other at these positions; without them they are found where they are needed.
    pub candidates: Option<&'a Candidates>,
    /// Pairs that have blocks in the stiffness matrix.
    pub pattern: &'a [Pair],
    /// Time over which forces of contact are means, centred at this moment \[s\]; zero for those at this moment.
    pub span: f64,
    /// The same for forces of elements.
    pub elastic_span: f64,
    /// Time by which velocities of obstacles are taken earlier \[s\].
    pub lag: f64,
}

impl Motion<'_> {
    /// Nothing, at the start of time.
    pub const NONE: Self = Self {
        dimension: 1,
        x: &[],
        v: &[],
        mass: &[],
        inverse_mass: &[],
        grab: None,
        time: 0.0,
        anchors: &[],
        candidates: None,
        pattern: &[],
        span: 0.0,
        elastic_span: 0.0,
        lag: 0.0,
    };

    /// Number of vertices.
    pub fn vertices(&self) -> usize {
        self.x.len() / self.dimension
    }

    /// Greatest displacement of any vertex within half of the span \[m\].
    pub fn half_displacement(&self) -> f64 {
        if self.span == 0.0 {
            return 0.0;
        }
        let square = self.v.chunks(self.dimension).map(|v| v.iter().map(|v| v * v).sum::<f64>()).fold(0.0, f64::max);
        0.5 * self.span * square.sqrt()
    }

    /// Reason to skip damping, if all velocities are zero.
    pub fn stillness(&self) -> Option<&'static str> {
        self.v.iter().all(|v| *v == 0.0).then_some("nothing moves")
    }
}

/// Reason for skipping contact.
pub const NO_OBSTACLE_NEAR: &str = "nothing within reach";

/// Reason for skipping an effect with zero strength.
pub(crate) const ZERO: &str = "its strength is zero";

/// A vertex pulled towards a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grab {
    /// The vertex, by its number in the scene.
    pub vertex: usize,
    /// Where it is pulled to \[m\]; in the plane the third coordinate is not used.
    pub target: [f64; 3],
}

/// Power of the force of an effect that needs no scratch \[W\].
fn power_of_force(effect: &impl Effect, motion: Motion<'_>, forces: &mut Vec<f64>) -> f64 {
    forces.clear();
    forces.resize(motion.x.len(), 0.0);
    effect.force(motion, &mut [], forces);
    forces.iter().zip(motion.v).map(|(force, v)| force * v).sum()
}

/// Most conditions of one effect: all are solved together by a dense factorisation.
pub(crate) const MOST_CONDITIONS: usize = 500;

/// Exact constraints on positions.
pub trait ConstraintTerm {
    /// Adds their rows at one moment.
    fn add_rows(&self, motion: Motion<'_>, rows: &mut ConstraintRows);
}

/// An effect, built for stepping. Methods that do not apply keep their empty default.
pub trait Effect: Send + Sync {
    /// Name in reports.
    fn name(&self) -> &'static str;

    /// Tells the effect its number in the scene.
    fn set_number(&mut self, _number: usize) {}

    /// Number of elements (vertices, triangles, ...) in one call.
    fn elements(&self, motion: Motion<'_>) -> usize;

    /// The effect on what moves: without the elements whose vertices all sleep, by their numbers in the scene. `None` if it leaves none out.
    fn restricted(&self, _moves: &dyn Fn(usize) -> bool) -> Option<Arc<dyn Effect>> {
        None
    }

    /// Size of the scratch of [`Self::force`] and [`Self::stiffness_times`]; its content does not matter.
    fn scratch(&self) -> usize {
        0
    }

    /// Reason why [`Self::force`] adds nothing at this moment, if so: in a few words, and at less cost than adding it.
    /// Only if every bit stays as it is.
    fn idle(&self, motion: Motion<'_>) -> Option<&'static str> {
        self.contact()?.idle(motion)
    }

    /// Obstacles only: whether nothing touches them, now and at any later time, while all vertices stay in a box; conservative.
    fn is_clear(&self, _swept_bounds: Bounds) -> bool {
        false
    }

    /// Number of coordinates of the vertices that it acts on; `None` if any number will do.
    fn dimension(&self) -> Option<usize> {
        None
    }

    /// Whether it does not depend on time. An effect that does prevents sleep.
    fn is_steady(&self) -> bool {
        true
    }

    /// Whether its forces are loads on edges, which are drawn.
    fn is_load(&self) -> bool {
        false
    }

    /// Time from which it acts in full, if it grows from the start of time \[s\].
    fn ramp(&self) -> f64 {
        0.0
    }

    /// Whether what it does to one body, net or membrane depends on the others, beside contact: parts then do not step or sleep alone.
    fn couples_parts(&self) -> bool {
        false
    }

    /// Stored energy \[J\].
    fn energy(&self, motion: Motion<'_>) -> f64 {
        self.contact().map_or(0.0, |contact| contact.energy(motion))
    }

    /// Adds the force on every vertex \[N\] to `force`, flat.
    fn force(&self, motion: Motion<'_>, _scratch: &mut [f64], force: &mut [f64]) {
        if let Some(contact) = self.contact() {
            contact.force(motion, force);
        }
    }

    /// Power that its force supplies from outside, as a wind does \[W\], with scratch for the forces; `None` if its energy or its heat
    /// accounts for the work.
    fn supplied_power(&self, _motion: Motion<'_>, _forces: &mut Vec<f64>) -> Option<f64> {
        None
    }

    /// Whether there is a [`Self::supplied_power`].
    fn supplies(&self) -> bool {
        false
    }

    /// The uniform force, if [`Self::force`] adds exactly that.
    fn uniform_force(&self) -> Option<UniformForce> {
        None
    }

    /// Elements only: whether there is an [`Self::euler_update`].
    fn has_euler_update(&self) -> bool {
        false
    }

    /// Elements only: computes the same forces as [`Self::force`], adds the uniform force, and updates each vertex by
    /// symplectic Euler as soon as its force is complete. The scratch is as large as the largest of any effect of the
    /// scene.
    fn euler_update(&self, _vertices: &mut EulerUpdate<'_>, _scratch: &mut [f64]) {}

    /// Adds `-d force/dx * d` \[N\] for a displacement `d` \[m\], both flat, to `product`.
    fn stiffness_times(&self, motion: Motion<'_>, d: &[f64], _scratch: &mut [f64], product: &mut [f64]) {
        if let Some(contact) = self.contact() {
            contact.stiffness_times(motion, d, product);
        }
    }

    /// Sparsity pattern: calls `add` for every pair of different vertices whose forces depend on each other, in the
    /// order in which [`Self::add_stiffness`] adds their blocks. A pair may occur more than once.
    fn sparsity_pattern(&self, _add: &mut dyn FnMut(u32, u32)) {}

    /// Adds `ax (-d force/dx) + av (-d force/dv)` to a matrix: any diagonal blocks, and one block for every pair, in
    /// the order of [`Self::sparsity_pattern`]. [`SparseMatrix`] gives the blocks of the dimension of the effect. The
    /// matrix is symmetric; an unsymmetric part is omitted and only slows
    /// Newton's method down.
    fn add_stiffness(&self, motion: Motion<'_>, weights: Weights, matrix: &mut dyn SparseMatrix) {
        if let Some(contact) = self.contact() {
            contact.add_stiffness(motion, weights, matrix);
        }
    }

    /// Rayleigh's alpha [1/s] and beta \[s\], if this is damping; the largest over the vertices.
    fn damping(&self, motion: Motion<'_>) -> [f64; 2] {
        self.contact().map_or([0.0; 2], |contact| contact.damping(motion))
    }

    /// Whether the rate at which it damps a vibration follows from the shape of that, so that [`Self::damping`] is only an estimate.
    /// The force is then linear in the velocities.
    fn damps_by_shape(&self) -> bool {
        false
    }

    /// Contact by a potential, if it has that: its energy and forces are those of the effect.
    fn contact(&self) -> Option<AnyContact<'_>> {
        None
    }

    /// That contact, if it is one of surfaces with each other.
    fn surface_contact(&self) -> Option<&dyn SurfaceTerm> {
        None
    }

    /// The same effect, in whose contact of surfaces these pairs of bodies, by their numbers, do not touch, and all others as the
    /// level says; `None` if it is so already.
    fn setting_aside(&self, _bodies: &[[usize; 2]]) -> Option<std::sync::Arc<dyn Effect>> {
        None
    }

    /// Contact with obstacles, if it has that, by a potential or by a filter.
    fn obstacle_contact(&self) -> Option<&dyn ObstacleTerm> {
        None
    }

    /// Projection of positions at the end of a step, if it is that.
    fn projection(&self) -> Option<&LengthProjection> {
        None
    }

    /// Exact constraints on positions, if it is that. Their reactions come after all forces.
    fn constraints(&self) -> Option<&dyn ConstraintTerm> {
        None
    }

    /// Vertices with prescribed positions, if it is that.
    fn held_vertices(&self) -> Option<&HeldVertices> {
        None
    }

    /// Sets properties of all contacts.
    fn set_properties(&self, _properties: &mut ContactProperties) {}

    /// Largest multiple of the displacement `d` \[m\] from the positions `x` that stays within the barrier of an energy;
    /// infinite without a barrier.
    fn longest_step(&self, _x: &[f64], _d: &[f64]) -> f64 {
        f64::INFINITY
    }
}
