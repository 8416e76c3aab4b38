//! Everything that acts on bodies beside their own elasticity. Each effect is one file with two types: its parameters,
//! which a level lists, and what is built from them to take part in a step. [`EffectKind`] lists them all.

mod boundary;
mod compression;
mod drag;
mod friction;
mod gravity;
mod mouse_spring;
mod rayleigh;
mod restitution;
mod walls;

pub use boundary::Boundary;
pub use compression::Compression;
pub use drag::Drag;
pub use friction::Friction;
pub use gravity::Gravity;
pub use mouse_spring::MouseSpring;
pub use rayleigh::Rayleigh;
pub(crate) use rayleigh::Viscous;
pub use restitution::Restitution;
pub use walls::Walls;

use crate::{
    elements::{Elements, EulerUpdate, UniformForce},
    obstacles::{ContactQuery, Depenetration, Start, Surface},
    quantity::Quantity,
    registry::registry,
    solvers::{BlockMatrix, Weights},
};

registry! {
    /// What can act on bodies.
    pub enum EffectKind: dyn EffectParameters {
        Gravity(Gravity),
        Rayleigh(Rayleigh),
        Drag(Drag),
        MouseSpring(MouseSpring),
        Boundary(Boundary),
        Walls(Walls),
        Restitution(Restitution),
        Friction(Friction),
        Compression(Compression),
    }
}

/// The parameters of an effect.
pub trait EffectParameters {
    /// Name as it is said, such as `Gravity`.
    fn title(&self) -> &'static str;

    /// What it does, with the formula, for a tooltip.
    fn about(&self) -> &'static str;

    /// The numbers a panel may change.
    fn parameters(&mut self) -> Vec<&mut dyn Quantity>;

    /// The same numbers, by what they belong to.
    fn groups(&mut self) -> Vec<Group<'_>> {
        vec![Group { title: None, solid: None, numbers: self.parameters() }]
    }

    /// Whether it is damping, which the key D switches.
    fn is_damping(&self) -> bool {
        false
    }

    /// What it means to list it more than once.
    fn duplicate_policy(&self) -> DuplicatePolicy {
        DuplicatePolicy::Both
    }

    /// Why it will never do anything as it is listed, if that is so.
    fn ineffective(&self) -> Option<&'static str> {
        None
    }

    /// What else the user should know of it.
    fn notes(&self) -> Vec<String> {
        Vec::new()
    }

    /// What a window should draw for it at a time [s], if it has a place.
    fn shapes(&self, _time: f64) -> Vec<Shape> {
        Vec::new()
    }

    /// Readies the effect for stepping.
    ///
    /// # Errors
    /// A sentence, if the parameters do not fit together.
    fn build(&self, elements: &Elements) -> Result<Box<dyn Effect>, String>;
}

/// Numbers of an effect that belong to the same thing.
pub struct Group<'a> {
    /// What that is called, if it is not the effect itself.
    pub title: Option<String>,
    /// Which of the [`Shape::Solid`]s of the effect it is, if it is one.
    pub solid: Option<usize>,
    /// The numbers.
    pub numbers: Vec<&'a mut dyn Quantity>,
}

/// What it means to list an effect more than once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DuplicatePolicy {
    /// Both act.
    Both,
    /// Both act, but hardly anybody wants that: why, in words.
    Odd(&'static str),
    /// Only one can count, and which one is not said: why, in words.
    Ambiguous(&'static str),
}

/// Something with a place that a window can draw; all points in world coordinates [m].
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// The free inside of walls: a convex polygon, counter-clockwise, cut off where there are no walls.
    Room(Vec<[f64; 2]>),
    /// A solid obstacle: its outline, counter-clockwise.
    Solid(Vec<[f64; 2]>),
    /// A rectangle that nothing leaves: least and greatest corner.
    Edges([f64; 2], [f64; 2]),
}

/// Positions, velocities and masses at one moment, flat: two numbers a vertex.
#[derive(Clone, Copy, Debug)]
pub struct Motion<'a> {
    /// Positions [m].
    pub x: &'a [f64],
    /// Velocities [m/s].
    pub v: &'a [f64],
    /// Masses [kg], one for each number of `x`.
    pub mass: &'a [f64],
    /// 1/mass [1/kg]; zero where a vertex is pinned.
    pub inverse_mass: &'a [f64],
    /// What the mouse does.
    pub grab: Option<Grab>,
}

impl Motion<'_> {
    /// That nothing moves, if that is so: why damping has nothing to do.
    pub fn stillness(&self) -> Option<&'static str> {
        self.v.iter().all(|v| *v == 0.0).then_some("nothing moves")
    }
}

/// Least and greatest corner of a box [m].
pub type Bounds = [[f64; 2]; 2];

/// Least and greatest corner of the box around the ways of all vertices.
pub fn around(before: &[f64], after: &[f64]) -> Bounds {
    let (mut least, mut greatest) = ([f64::INFINITY; 4], [f64::NEG_INFINITY; 4]);
    for (a, b) in before.chunks_exact(2).zip(after.chunks_exact(2)) {
        for (axis, value) in [a[0], a[1], b[0], b[1]].into_iter().enumerate() {
            least[axis] = if value < least[axis] { value } else { least[axis] };
            greatest[axis] = if value > greatest[axis] { value } else { greatest[axis] };
        }
    }
    [
        [0, 1].map(|axis| f64::min(least[axis], least[axis + 2])),
        [0, 1].map(|axis| f64::max(greatest[axis], greatest[axis + 2])),
    ]
}

/// Why a constraint is passed over.
pub const NO_OBSTACLE_NEAR: &str = "nothing within reach";

/// Why what changes contacts is passed over.
pub const NO_CONTACT: &str = "nothing touches";

/// Why an effect with no strength is passed over.
pub(crate) const ZERO: &str = "its strength is zero";

/// A vertex pulled towards a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grab {
    /// The vertex, by its number in the scene.
    pub vertex: usize,
    /// Where it is pulled to [m].
    pub target: [f64; 2],
}

/// A term of the physics, ready for stepping. What a term does not do is left at its empty default.
pub trait Effect: Send + Sync {
    /// Name in reports.
    fn name(&self) -> &'static str;

    /// How many elements (vertices, triangles, ...) one call touches.
    fn elements(&self, motion: Motion<'_>) -> usize;

    /// How many numbers of scratch [`Self::force`] and [`Self::stiffness_times`] need; what is in it does not matter.
    fn scratch(&self) -> usize {
        0
    }

    /// Why [`Self::force`] would add nothing at this moment, if it would: in a few words, and at less cost than adding it. Only
    /// what leaves every bit as it is counts.
    fn idle(&self, _motion: Motion<'_>) -> Option<&'static str> {
        None
    }

    /// Whether [`Self::constrain`] certainly changes nothing in steps, now and at any later time, in which the ways of all
    /// vertices lie in a box; if it cannot tell, it does not.
    fn is_clear(&self, _swept_bounds: Bounds) -> bool {
        false
    }

    /// Whether it does the same at every time. What does not keeps everything awake.
    fn is_steady(&self) -> bool {
        true
    }

    /// Stored energy [J].
    fn energy(&self, _motion: Motion<'_>) -> f64 {
        0.0
    }

    /// Adds the force on every vertex [N] to `force` (two numbers a vertex).
    fn force(&self, _motion: Motion<'_>, _scratch: &mut [f64], _force: &mut [f64]) {}

    /// What it does, if it does the same everywhere: [`Self::force`] then adds just that.
    fn uniform_force(&self) -> Option<UniformForce> {
        None
    }

    /// Elements only: computes the same forces as [`Self::force`], with those of what acts everywhere, and moves the vertices by
    /// them, each as soon as it has all of its force. There is as much scratch as any effect of the scene asks for.
    fn euler_update(&self, _vertices: &mut EulerUpdate<'_>, _scratch: &mut [f64]) {}

    /// Adds `-d force/dx * d` [N] for a displacement `d` [m], both flat, to `product`.
    fn stiffness_times(&self, _motion: Motion<'_>, _d: &[f64], _scratch: &mut [f64], _product: &mut [f64]) {}

    /// Names every couple of different vertices whose forces depend on each other, in the order in which
    /// [`Self::add_stiffness`] adds their blocks. A couple may be named more than once.
    fn sparsity_pattern(&self, _add: &mut dyn FnMut(u32, u32)) {}

    /// Adds `ax (-d force/dx) + av (-d force/dv)` to a matrix: any diagonal blocks, and one block for every couple, in the
    /// order of [`Self::sparsity_pattern`]. The matrix is symmetric; what is not, is left out and only slows Newton's method down.
    fn add_stiffness(&self, _motion: Motion<'_>, _weights: Weights, _matrix: &mut BlockMatrix) {}

    /// Rayleigh's alpha [1/s] and beta [s], if this is damping; where it differs from vertex to vertex, the largest.
    fn damping(&self, _motion: Motion<'_>) -> [f64; 2] {
        [0.0; 2]
    }

    /// How many times the displacement `d` [m] from the positions `x` may be gone, at most, for an energy with a barrier not to be
    /// left; infinite if there is nothing in the way.
    fn longest_step(&self, _x: &[f64], _d: &[f64]) -> f64 {
        f64::INFINITY
    }

    /// Calls `act` with every obstacle that this effect, which has a number, puts in the way of a step from a time to another [s] in
    /// which the ways of all vertices lie in a box.
    fn contact_queries<'a>(
        &'a self,
        _number: usize,
        _time: [f64; 2],
        _swept_bounds: Bounds,
        _act: &mut dyn FnMut(ContactQuery<'a>),
    ) {
    }

    /// Changes positions and velocities at the end of a step that are not allowed, seen from its start. What it left once it
    /// leaves unchanged. Returns how many vertices were touched.
    fn constrain(&self, _start: &Start<'_>, _x: &mut [f64], _v: &mut [f64]) -> usize {
        0
    }

    /// How many vertices are deep inside what stands in their way, at these positions [m] and this time [s].
    fn count_inside(&self, _x: &[f64], _time: f64, _exits: &[Depenetration]) -> usize {
        0
    }

    /// Changes what happens where constraints touch a vertex.
    fn set_surface(&self, _surface: &mut Surface) {}

    /// Whether it has a say where constraints touch, and nowhere else.
    fn is_surface_effect(&self) -> bool {
        false
    }

    /// Whether it constrains. Such an effect has no force.
    fn constrains(&self) -> bool {
        false
    }
}
