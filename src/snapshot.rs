//! A copy of everything the window shows, with no references back: drawing can never change the simulation.

use crate::{
    command::{Mode, Pose},
    level::Level,
    materials::Model,
    meshes::Mesh,
};
use std::{ops::Range, sync::Arc};

/// What a frame of the window is drawn from. Buffers are reused from frame to frame.
#[derive(Clone, Debug, Default)]
pub struct Snapshot {
    /// The document, as it would be saved, without the current state.
    pub level: Arc<Level>,
    /// Changes whenever bodies, meshes or rest shapes change.
    pub generation: u64,
    /// The bodies, in the order of the level.
    pub bodies: Vec<BodySnapshot>,
    /// Triangles of all bodies (scene vertex numbers), in the order of the bodies.
    pub triangles: Arc<Vec<[u32; 3]>>,
    /// Current positions, x and y of each vertex [m].
    pub positions: Vec<f64>,
    /// Start positions, x and y of each vertex [m].
    pub start: Arc<Vec<f64>>,
    /// Pinned vertices, ascending.
    pub pins: Arc<Vec<u32>>,
    /// The mouse spring, while it pulls.
    pub pull: Option<Pull>,
    /// What the triangles are coloured by.
    pub field: Field,
    /// One value a triangle, unless the field is `None`.
    pub values: Vec<f64>,
    /// Energies now.
    pub energies: Energies,
    /// Least det F of all triangles.
    pub min_j: f64,
    /// Number of triangles that are inside out (det F <= 0).
    pub inverted: usize,
    /// Simulated time [s].
    pub time: f64,
    /// Steps taken.
    pub steps: u64,
    /// What is going on.
    pub mode: Mode,
    /// Whether time runs (in simulate or collide mode).
    pub running: bool,
    /// The pose a test level was last put into.
    pub pose: Option<Pose>,
    /// Whether all models are shown side by side.
    pub side_by_side: bool,
    /// Whether any damping effect is switched on.
    pub damping: bool,
    /// Why time stopped, if something went wrong.
    pub fault: Option<crate::fault::Fault>,
    /// Repairs and warnings from building the scene.
    pub messages: Vec<String>,
    /// Whether there is something to undo.
    pub can_undo: bool,
    /// Whether there is something to redo.
    pub can_redo: bool,
}

/// One body of a snapshot.
#[derive(Clone, Debug)]
pub struct BodySnapshot {
    /// Name from the level.
    pub name: String,
    /// Its constitutive model.
    pub model: Model,
    /// Its rest mesh with icing (own vertex numbers, own coordinates: `place` is not applied).
    pub mesh: Arc<Mesh>,
    /// Its vertices in the scene.
    pub vertices: Range<usize>,
    /// Its triangles in the scene.
    pub triangles: Range<usize>,
    /// Elastic energy [J].
    pub energy: f64,
    /// Least det F.
    pub min_j: f64,
    /// Width at mid height [m], in test levels.
    pub mid_width: f64,
    /// Vertical force that holds the top row [N], in test levels; positive pulls up.
    pub top_force: f64,
    /// Height over rest height.
    pub height_ratio: f64,
    /// Where the model has no honest answer at this stretch, in words.
    pub caution: Option<String>,
}

/// The mouse spring while it pulls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pull {
    /// The vertex, by its number in the scene.
    pub vertex: usize,
    /// Where it is pulled to [m].
    pub target: [f64; 2],
    /// k |target - vertex| [N].
    pub force: f64,
}

/// What triangles can be coloured by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Field {
    /// Plain gingerbread.
    #[default]
    None,
    /// Elastic energy density psi [J/m²].
    EnergyDensity,
    /// Von Mises equivalent of the Cauchy stress [Pa].
    VonMises,
    /// J = det F: area over rest area.
    Volume,
}

impl Field {
    /// All of them, in the order of the menu.
    pub const ALL: [Self; 4] = [Self::None, Self::EnergyDensity, Self::VonMises, Self::Volume];

    /// Name in the menu.
    pub const fn title(self) -> &'static str {
        match self {
            Self::None => "Gingerbread",
            Self::EnergyDensity => "Energy density",
            Self::VonMises => "Von Mises stress",
            Self::Volume => "Area ratio J",
        }
    }

    /// Unit symbol.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::None | Self::Volume => "",
            Self::EnergyDensity => "J/m²",
            Self::VonMises => "Pa",
        }
    }
}

/// Energies of a scene [J].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energies {
    /// Of motion.
    pub kinetic: f64,
    /// Of deformation.
    pub elastic: f64,
    /// Of everything else that stores: gravity, the mouse spring.
    pub potential: f64,
}

impl Energies {
    /// The sum [J].
    pub fn total(self) -> f64 {
        self.kinetic + self.elastic + self.potential
    }
}
