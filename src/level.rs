//! Levels: the data of a level file.
//!
//! Levels are RON. Unknown fields, wrong types and numbers out of range are refused with the line and column
//! (see [`crate::files`]). The level is also the document that the window edits, undoes and saves.

mod builders;
mod check;
mod note;
mod saved;
mod script;
mod steps;

pub use crate::meshes::Pin;
pub use check::{Check, CheckPlace};
pub use note::{Note, NotePlace};
pub use saved::{SavedGuard, SavedState};
pub use script::{Action, RecordedEnd, ScriptedAction, frame};
pub use steps::{SubstepMode, Substeps};

use crate::{
    effects::EffectKind,
    elements::{ElementKind, OwnMaterial},
    finish::Finish,
    integrators::IntegratorKind,
    materials::{MaterialParameters, TypedEnergy},
    meshes::{MeshKind, natural},
    nets::NetKind,
    obstacles::Similarity,
    quantity::{
        Angle, Coordinate, Density, Factor, Mass, Noise, ParticleMass, Point, Quantity, SleepTolerance, SpacePoint,
        Spin, Thickness, Velocity,
    },
    toys::ToyKind,
};
use serde::{Deserialize, Serialize, Serializer};

/// Everything a file says about a scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Level {
    /// Title in the level picker.
    pub name: String,
    /// One or two sentences on what there is to see.
    #[serde(default)]
    pub about: String,
    /// Mode of headless runs, and of the window when play is pressed in edit mode.
    #[serde(default, skip_serializing_if = "is_default")]
    pub mode: RunMode,
    /// Steps per 1/60 s of simulated time.
    #[serde(default)]
    pub substeps: Substeps,
    /// Multirate stepping: whether a body or net divides the step by its own stability limit.
    #[serde(default, skip_serializing_if = "is_default")]
    pub paces: SubstepMode,
    /// The time-stepping scheme.
    #[serde(default)]
    pub integrator: IntegratorKind,
    /// Whether an unstable step is repeated as shorter ones.
    #[serde(default, skip_serializing_if = "is_default")]
    pub guard: Toggle,
    /// Whether a body or net at rest, or a part of a body, sleeps until something acts on it.
    #[serde(default, skip_serializing_if = "is_default")]
    pub sleep: Sleep,
    /// The deformable bodies.
    #[serde(default)]
    pub bodies: Vec<BodyLevel>,
    /// Particles held together by springs.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub nets: Vec<NetLevel>,
    /// Cloth and other thin sheets in space.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub membranes: Vec<MembraneLevel>,
    /// A small system with an exact solution, in place of bodies, nets and effects.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub toy: Option<ToyKind>,
    /// What acts on them, in this order.
    #[serde(default)]
    pub effects: Vec<EffectLevel>,
    /// Makes this a test level: Up and Down set these stretches.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub test: Option<StretchTest>,
    /// Scripted actions. Times count from the start, also where the level was saved while running.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub actions: Vec<ScriptedAction>,
    /// Numbers that it is known to lead to.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub checks: Vec<Check>,
    /// Texts on the stage.
    #[serde(default, skip_serializing_if = "Vec::is_empty", deserialize_with = "note::notes")]
    pub notes: Vec<Note>,
    /// Where the scripted actions led when they were recorded: a replay stops there, and tells whether its state is the same.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub recorded: Option<RecordedEnd>,
    /// Where everything is now, if the level was saved while running. Rest shapes are never changed by saving.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub state: Option<SavedState>,
}

/// One deformable body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodyLevel {
    /// Name in the panels and reports.
    pub name: String,
    /// Its rest shape.
    pub mesh: MeshKind,
    /// The kind of its elements.
    #[serde(default, skip_serializing_if = "is_default")]
    pub element: ElementKind,
    /// Where the rest shape is put.
    #[serde(default, skip_serializing_if = "is_default")]
    pub place: Place,
    /// What it is made of.
    pub material: MaterialParameters,
    /// A material from outside the crate in place of the model. The elastic moduli stay those of `material`, and
    /// [`Plane::StressExact`](crate::materials::Plane::StressExact) is the same as plane stress.
    #[serde(skip_deserializing, skip_serializing_if = "Option::is_none", serialize_with = "refuse")]
    pub own_material: Option<OwnMaterial>,
    /// A typed energy in place of that of the model, whose elastic moduli it knows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub energy: Option<TypedEnergy>,
    /// How heavy it is.
    pub mass: MassLevel,
    /// Factors in x and y applied at the start about the middle of its bottom edge: the body starts out of its rest shape.
    #[serde(default = "unstretched", skip_serializing_if = "is_unstretched")]
    pub stretch: (Factor, Factor),
    /// Where its vertices are then put.
    #[serde(default, skip_serializing_if = "is_default")]
    pub start: StartShape,
    /// Velocity at the start [m/s].
    #[serde(default = "no_velocity", skip_serializing_if = "is_at_rest")]
    pub velocity: (Velocity, Velocity),
    /// Angular velocity at the start about the centre of mass, counter-clockwise [rad/s].
    #[serde(default = "no_spin", skip_serializing_if = "is_not_spinning")]
    pub spin: Spin,
    /// Vertices that do not move.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pins: Vec<Pin>,
    /// Sides whose vertices may slide along it but not leave it, like on rollers.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub slides: Vec<Side>,
}

/// Particles held together by springs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NetLevel {
    /// Name in the panels and reports.
    pub name: String,
    /// Its particles and springs.
    pub net: NetKind,
    /// Mass of each particle.
    pub mass: ParticleMass,
    /// Velocity at the start [m/s].
    #[serde(default = "no_velocity", skip_serializing_if = "is_at_rest")]
    pub velocity: (Velocity, Velocity),
    /// Particles that do not move.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pins: Vec<Pin>,
    /// Where it is put in space. Without it the net is in the plane.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub space: Option<SpacePlace>,
    /// How it looks in space, if it has faces.
    #[serde(default, skip_serializing_if = "is_default")]
    pub finish: Finish,
}

/// A thin sheet in space, such as a cloth: triangles of a material that may bend freely.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MembraneLevel {
    /// Name in the panels and reports.
    pub name: String,
    /// Its rest shape, which is flat.
    pub mesh: MeshKind,
    /// What it is made of.
    pub material: MaterialParameters,
    /// A typed energy in place of that of the model, whose elastic moduli it knows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub energy: Option<TypedEnergy>,
    /// Thickness.
    pub thickness: Thickness,
    /// How heavy it is.
    pub mass: MassLevel,
    /// Where the rest shape is put in space.
    #[serde(default, skip_serializing_if = "is_default")]
    pub space: SpacePlace,
    /// Factors in x and y of the flat shape applied at the start about the middle of its bottom edge.
    #[serde(default = "unstretched", skip_serializing_if = "is_unstretched")]
    pub stretch: (Factor, Factor),
    /// Where its vertices are then put, relative to its plane.
    #[serde(default, skip_serializing_if = "is_default")]
    pub start: StartShape,
    /// Vertices that do not move.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pins: Vec<Pin>,
    /// How it looks.
    #[serde(default, skip_serializing_if = "is_default")]
    pub finish: Finish,
}

/// A similarity transform of a flat shape into space: scaled about its origin, turned about the x axis, then about y, then about z, and moved.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SpacePlace {
    /// Scale of the flat shape, with the rest lengths of springs. Thickness, stiffnesses and masses of particles stay. Pins are named in the scaled shape.
    #[serde(skip_serializing_if = "is_same_size")]
    pub scale: Factor,
    /// Turns about x, y and z \[degrees\].
    pub turn: (Angle, Angle, Angle),
    /// Move \[m\].
    pub offset: SpacePoint,
    /// Velocity at the start [m/s].
    #[serde(skip_serializing_if = "is_at_rest_in_space")]
    pub velocity: (Velocity, Velocity, Velocity),
}

impl Default for SpacePlace {
    fn default() -> Self {
        let (angle, zero, still) = (Angle::literal(0.0), Coordinate::literal(0.0), Velocity::literal(0.0));
        let (turn, offset) = ((angle, angle, angle), SpacePoint(zero, zero, zero));
        Self { scale: Factor::literal(1.0), turn, offset, velocity: (still, still, still) }
    }
}

impl SpacePlace {
    /// A vector of the scaled flat shape in space, turned but not moved.
    pub fn turned(&self, [x, y]: [f64; 2]) -> [f64; 3] {
        self.turned_from_plane([x, y, 0.0])
    }

    /// A vector relative to the scaled flat shape, with the component across its plane, turned but not moved.
    pub fn turned_from_plane(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let turn = |[a, b]: [f64; 2], angle: Angle| {
            let angle = angle.get().to_radians();
            if angle == 0.0 {
                return [a, b];
            }
            let (c, s) = (libm::cos(angle), libm::sin(angle));
            [c * a - s * b, s * a + c * b]
        };
        let (about_x, about_y, about_z) = self.turn;
        let [y, z] = turn([y, z], about_x);
        let [z, x] = turn([z, x], about_y);
        let [x, y] = turn([x, y], about_z);
        [x, y, z]
    }

    /// A point of the scaled flat shape in space \[m\].
    pub fn placed(&self, [x, y]: [f64; 2]) -> [f64; 3] {
        self.placed_from_plane([x, y, 0.0])
    }

    /// A point relative to the scaled flat shape, with its distance from its plane, in space \[m\].
    pub fn placed_from_plane(&self, point: [f64; 3]) -> [f64; 3] {
        let ([x, y, z], [dx, dy, dz]) = (self.turned_from_plane(point), self.offset.get());
        [x + dx, y + dy, z + dz]
    }

    /// The place after a similarity transform; velocities stay. `None` if a number would leave its range.
    pub fn arranged(&self, by: &Similarity) -> Option<Self> {
        let mut arranged = *self;
        arranged.offset = by.of_space_point(self.offset)?;
        arranged.scale.set(by.scale * self.scale.get()).ok()?;
        if by.turn != 0.0 {
            // The columns of the matrix R = Rz Ry Rx of the turns afterwards.
            let [a, b, c] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
                .map(|axis| by.direction(self.turned_from_plane(axis)));
            // R31 = -sin y, (R32, R33) = cos y (sin x, cos x), and (R21, R11) = cos y (sin z, cos z).
            let cosine = libm::hypot(a[0], a[1]);
            let about_y = libm::atan2(-a[2], cosine);
            let [about_x, about_z] = if cosine > 1e-9 {
                [libm::atan2(b[2], c[2]), libm::atan2(a[1], a[0])]
            } else {
                // x and z turn about the same axis then: all of it is x.
                [libm::atan2(-c[1], b[1]), 0.0]
            };
            // Round-off of a whole number of degrees is no part of the level.
            let angle = |radians: f64| Angle::new(libm::round(1e9 * radians.to_degrees()) / 1e9).ok();
            arranged.turn = (angle(about_x)?, angle(about_y)?, angle(about_z)?);
        }
        Some(arranged)
    }
}

fn is_same_size(scale: &Factor) -> bool {
    scale.get() == 1.0
}

fn is_at_rest_in_space(velocity: &(Velocity, Velocity, Velocity)) -> bool {
    *velocity == SpacePlace::default().velocity
}

/// A similarity transform of the rest shape: scaled and turned about the origin, then moved.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Place {
    /// Scale.
    pub scale: Factor,
    /// Turn \[degrees\], counter-clockwise.
    pub turn: Angle,
    /// Move \[m\].
    pub offset: Point,
}

impl Default for Place {
    fn default() -> Self {
        let zero = Coordinate::literal(0.0);
        Self { scale: Factor::literal(1.0), turn: Angle::literal(0.0), offset: Point(zero, zero) }
    }
}

impl Place {
    /// The map from a point of the rest shape to its place \[m\].
    pub fn map(&self) -> impl Fn([f64; 2]) -> [f64; 2] + use<> {
        let (scale, turn, [dx, dy]) = (self.scale.get(), self.turn.get().to_radians(), self.offset.get());
        let (c, s) = if turn == 0.0 { (scale, 0.0) } else { (scale * libm::cos(turn), scale * libm::sin(turn)) };
        move |[x, y]| [c * x - s * y + dx, s * x + c * y + dy]
    }
}

/// Start shape of a body, relative to its rest shape. Pinned vertices stay, and vertices on rollers stay on their side. The
/// seed determines everything irregular.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum StartShape {
    /// Its rest shape.
    #[default]
    Rest,
    /// Every vertex anywhere in the box around the body, all places equally likely; that of a membrane is as deep as it is long.
    Scrambled {
        /// Seed of the random positions.
        #[serde(deserialize_with = "natural")]
        seed: u32,
    },
    /// Pressed flat onto a line through its middle, of any direction.
    Line {
        /// Seed of the direction and the noise.
        #[serde(deserialize_with = "natural")]
        seed: u32,
        /// Greatest random offset in x and in y, as a fraction of the longer side of the box around the body.
        #[serde(default = "slight")]
        noise: Noise,
    },
    /// Shrunk to the point in its middle.
    Point {
        /// Seed of the noise.
        #[serde(deserialize_with = "natural")]
        seed: u32,
        /// Greatest random offset in x and in y, as a fraction of the longer side of the box around the body.
        #[serde(default = "slight")]
        noise: Noise,
    },
    /// Turned inside out: its mirror image across a line through its middle, of any direction.
    Mirrored {
        /// Seed of the direction and the noise.
        #[serde(deserialize_with = "natural")]
        seed: u32,
        /// Greatest random offset in x and in y, as a fraction of the longer side of the box around the body.
        #[serde(default = "slight")]
        noise: Noise,
    },
}

impl StartShape {
    /// The seed, to be changed, if there is one.
    pub const fn seed_mut(&mut self) -> Option<&mut u32> {
        match self {
            Self::Rest => None,
            Self::Scrambled { seed }
            | Self::Line { seed, .. }
            | Self::Point { seed, .. }
            | Self::Mirrored { seed, .. } => Some(seed),
        }
    }
}

const fn slight() -> Noise {
    Noise::literal(0.001)
}

/// How a body's mass is given to its vertices.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum MassLevel {
    /// Lumped: a third of `density * area` of every triangle goes to each of its corners.
    Density(Density),
    /// Consistent mass matrix of a density: a triangle of mass m has m/6 at each corner, and m/12 between each two.
    Consistent(Density),
    /// The same share of a total for every vertex.
    Total(Mass),
}

/// A side of a body, judged on the rest shape: all vertices at its least or greatest coordinate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Side {
    /// Greatest y.
    Top,
    /// Least y.
    Bottom,
    /// Least x.
    Left,
    /// Greatest x.
    Right,
}

impl Side {
    /// The coordinate that is the same all along the side (0 is x, 1 is y), and whether it is the greatest.
    pub const fn across(self) -> (usize, bool) {
        match self {
            Self::Top => (1, true),
            Self::Bottom => (1, false),
            Self::Left => (0, false),
            Self::Right => (0, true),
        }
    }
}

/// One effect with its switch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EffectLevel {
    /// What it does.
    pub effect: EffectKind,
    /// Whether it acts.
    #[serde(default, skip_serializing_if = "is_default")]
    pub switch: Switch,
    /// In which modes it acts.
    #[serde(default, skip_serializing_if = "is_default")]
    pub when: When,
}

impl EffectLevel {
    /// Whether it acts in a mode.
    pub fn acts_in(&self, mode: RunMode) -> bool {
        self.switch.is_on() && (self.when == When::Always || mode == RunMode::Collide)
    }
}

/// Whether an effect acts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Switch {
    /// It is evaluated in every step.
    On,
    /// It is skipped where it changes nothing. Every bit is the same as with [`Self::On`].
    #[default]
    Auto,
    /// It does not act.
    Off,
}

impl Switch {
    /// Whether the effect is present: on, or skipped where it changes nothing.
    pub const fn is_on(self) -> bool {
        matches!(self, Self::On | Self::Auto)
    }
}

/// Switch of a part of the program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Toggle {
    /// The part acts.
    #[default]
    On,
    /// The part does not act.
    Off,
}

impl From<bool> for Toggle {
    fn from(on: bool) -> Self {
        if on { Self::On } else { Self::Off }
    }
}

/// What sleeps at rest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub enum Sleep {
    /// Bodies, nets and membranes, each as a whole.
    #[default]
    On,
    /// Nothing.
    Off,
    /// As `On`; also regions of pinned bodies beside which hardly anything moves, while the rest of the body does. The number is the motion that a region may
    /// ignore, as a share of its size.
    Regions(SleepTolerance),
}

impl Sleep {
    /// Tolerance of [`Self::Regions`] unless another is chosen.
    pub const TOLERANCE: SleepTolerance = SleepTolerance::literal(1e-3);
}

/// In which modes an effect acts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum When {
    /// In simulate and in collide mode.
    #[default]
    Always,
    /// In collide mode only.
    Collide,
}

/// The two ways a scene can run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum RunMode {
    /// Without the effects marked `when: Collide`.
    #[default]
    Simulate,
    /// With all effects.
    Collide,
}

/// Start heights of a compression and stretch test, as factors of the rest height.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StretchTest {
    /// Height factor of the stretched shape (key Up).
    pub stretched: Factor,
    /// Height factor of the compressed shape (key Down).
    pub compressed: Factor,
}

/// A file cannot hold what another crate made.
#[expect(clippy::ref_option, reason = "serde passes a reference to the field")]
fn refuse<S: Serializer>(own: &Option<OwnMaterial>, _: S) -> Result<S::Ok, S::Error> {
    Err(serde::ser::Error::custom(format!("a level file cannot hold the material {own:?}, which is made in code")))
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

const fn unstretched() -> (Factor, Factor) {
    (Factor::literal(1.0), Factor::literal(1.0))
}

fn is_unstretched(stretch: &(Factor, Factor)) -> bool {
    *stretch == unstretched()
}

const fn no_velocity() -> (Velocity, Velocity) {
    (Velocity::literal(0.0), Velocity::literal(0.0))
}

fn is_at_rest(velocity: &(Velocity, Velocity)) -> bool {
    *velocity == no_velocity()
}

const fn no_spin() -> Spin {
    Spin::literal(0.0)
}

fn is_not_spinning(spin: &Spin) -> bool {
    *spin == no_spin()
}
