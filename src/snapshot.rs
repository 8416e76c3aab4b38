//! Snapshot: a copy of everything that the window shows.
//!
//! ```
//! use gingerbread::{elements::Field, files, levels, meshes::NoFiles, sandbox::Sandbox, snapshot::Snapshot};
//!
//! let level = files::parse(levels::built_in("gingerbread").ok_or("there is no such level")?, "gingerbread.ron")?;
//! let sandbox = Sandbox::new(level, Box::new(NoFiles))?;
//! let mut snapshot = Snapshot::default();
//! sandbox.snapshot(Field::VonMises, &mut snapshot);
//! assert_eq!((snapshot.time, snapshot.values.len()), (0.0, snapshot.triangles.len()));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::clock::Instant;
use crate::{
    command::{Mode, Pose},
    effects::{Effect as _, EffectKind, Grab},
    elements::{BodyMaterial, Diagnostics, Elements, Membranes, NetSprings},
    fault::Fault,
    guard::negligible,
    inversion_recovery::Tangle,
    level::{Check, Level},
    materials::Model,
    meshes::Mesh,
    report::EffectCost,
    sandbox::{MeshChange, Sandbox},
    scene::{Body, extent},
};
use std::{ops::Range, sync::Arc, time::Duration};

pub use crate::{
    elements::Field,
    report::{Energies, SubstepPlan},
    toys::Reading,
};

/// Data for drawing a frame of the window. Buffers are reused from frame to frame.
#[derive(Clone, Debug, Default)]
pub struct Snapshot {
    /// The document, as it would be saved, without the current state.
    pub level: Arc<Level>,
    /// Changes whenever bodies, meshes or rest shapes change.
    pub generation: u64,
    /// The bodies, in the order of the level.
    pub bodies: Vec<BodySnapshot>,
    /// The nets, in the order of the level.
    pub nets: Vec<NetSnapshot>,
    /// The membranes, in the order of the level.
    pub membranes: Vec<MembraneSnapshot>,
    /// The toy, if the level has one.
    pub toy: Option<ToySnapshot>,
    /// Number of coordinates of a vertex: 2 in the plane, 3 in space.
    pub dimension: usize,
    /// Triangles of all bodies (scene vertex numbers), in the order of the bodies.
    pub triangles: Arc<Vec<[u32; 3]>>,
    /// Current positions, the coordinates of each vertex \[m\].
    pub positions: Vec<f64>,
    /// Start positions, the coordinates of each vertex \[m\].
    pub start: Arc<Vec<f64>>,
    /// Pinned vertices, ascending.
    pub pins: Arc<Vec<u32>>,
    /// Vertices on rollers along a side, and the fixed coordinate (0 is x, 1 is y).
    pub rollers: Arc<Vec<(u32, usize)>>,
    /// The mouse spring, while it pulls.
    pub pull: Option<Pull>,
    /// Field that colours the triangles.
    pub field: Field,
    /// One value a triangle, unless the field is `None`.
    pub values: Vec<f64>,
    /// Estimated relative error of the stress, while its shares are the field.
    pub stress_error: Option<f64>,
    /// Vertices of the notes of the level, by their numbers in the scene; `None` for one at a point.
    pub note_vertices: Vec<Option<usize>>,
    /// What the last refinement of meshes changed.
    pub mesh_change: Option<MeshChange>,
    /// Energies now.
    pub energies: Energies,
    /// Energy that is at most round-off of the energy this scene can store \[J\].
    pub negligible: f64,
    /// Least det F of all triangles; infinite if there are none.
    pub min_j: f64,
    /// Number of triangles that are inside out (det F <= 0).
    pub inverted: usize,
    /// Inverted triangles, folds and metastable bodies.
    pub tangle: Tangle,
    /// Crossings of the surfaces of bodies, by an exact test, and the time that it took; `None` if contact has no potential.
    pub crossings: Option<(usize, Duration)>,
    /// Simulated time \[s\].
    pub time: f64,
    /// Steps taken.
    pub steps: u64,
    /// Mode of the sandbox.
    pub mode: Mode,
    /// Whether time runs (in simulate or collide mode).
    pub running: bool,
    /// Last pose of a test level.
    pub pose: Option<Pose>,
    /// Whether all models are shown side by side.
    pub side_by_side: bool,
    /// Width of the world about x = 1/2 \[m\]: 1, or the width of the strips of a test at their start.
    pub width: f64,
    /// What effects can be added to.
    pub elements: Arc<Elements>,
    /// Whether any damping effect is switched on.
    pub damping: bool,
    /// Whether any wind is switched on.
    pub wind: bool,
    /// Number of shorter steps that the guard takes for one now.
    pub guard_substeps: u32,
    /// Number of steps that the guard divided.
    pub guarded: u64,
    /// Whether a vertex is inside a wall, and whether it is pushed out.
    pub inside: usize,
    /// Multirate substeps of each body and then each net; empty without multirate stepping.
    pub substep_plans: Vec<SubstepPlan>,
    /// Number of sleeping bodies and nets.
    pub asleep: usize,
    /// Number of regions that sleep in bodies that are awake otherwise, and of all regions.
    pub regions: [usize; 2],
    /// Which vertices sleep with those regions; empty while none does.
    pub still: Vec<bool>,
    /// Number of triangles of bodies that are awake: those that a step computes.
    pub computed: usize,
    /// Name and elastic energy \[J\] of the first body or net that has exploded, if one has.
    pub exploded: Option<(String, f64)>,
    /// Length of the rewind buffer \[s\].
    pub rewind_length: f64,
    /// Cost of each effect so far, elements first.
    pub costs: Vec<EffectCost>,
    /// The fault that stopped time, if any.
    pub fault: Option<Fault>,
    /// Repairs and warnings from building the scene.
    pub messages: Vec<String>,
    /// Number of evaluations of all elements for snapshots: one for each shape.
    pub evaluations: u64,
    /// Number of evaluations that also computed the elastic energy, because stepping had not.
    pub energy_evaluations: u64,
    /// Generation, shape number and field of the last evaluation.
    pub(crate) seen: Option<(u64, u64, Field)>,
    /// Whether actions are recorded.
    pub records: bool,
    /// The known results of the level, now and as they were measured.
    pub checks: Vec<CheckReading>,
    /// Whether the recorded end of the level was met, once it has been reached.
    pub replayed: Option<bool>,
    /// Whether there is something to undo.
    pub can_undo: bool,
    /// Whether there is something to redo.
    pub can_redo: bool,
}

/// A known result of the level.
#[derive(Clone, Debug, PartialEq)]
pub struct CheckReading {
    /// What is known.
    pub check: Check,
    /// Its unit.
    pub unit: &'static str,
    /// Its value now.
    pub now: f64,
    /// What was measured, once its time had come.
    pub measured: Option<f64>,
    /// Whether that was within the tolerance.
    pub is_met: bool,
}

/// One body of a snapshot.
#[derive(Clone, Debug)]
pub struct BodySnapshot {
    /// Name from the level.
    pub name: String,
    /// Its material.
    pub material: BodyMaterial,
    /// Its rest mesh with icing (own vertex numbers, own coordinates: `place` is not applied).
    pub mesh: Arc<Mesh>,
    /// Its vertices in the scene.
    pub vertices: Range<usize>,
    /// Its triangles in the scene.
    pub triangles: Range<usize>,
    /// Elastic energy \[J\].
    pub energy: f64,
    /// Least det F.
    pub min_j: f64,
    /// Number of its triangles in the continued range of the model's formula.
    pub continued: usize,
    /// Width at mid height \[m\], in test levels.
    pub mid_width: f64,
    /// Vertical force that holds the top row \[N\], in test levels; positive pulls up.
    pub top_force: f64,
    /// Height over rest height.
    pub height_ratio: f64,
    /// Warning about a model that is not valid at this stretch.
    pub strip_warning: Option<String>,
}

/// One net of a snapshot.
#[derive(Clone, Debug)]
pub struct NetSnapshot {
    /// Name from the level.
    pub name: String,
    /// Its particles in the scene.
    pub vertices: Range<usize>,
    /// Its springs; their ends are scene vertex numbers.
    pub springs: NetSprings,
    /// Triangles by which it is drawn in space, by the numbers of the scene; empty if it is drawn by its springs.
    pub faces: Arc<Vec<[u32; 3]>>,
    /// Elastic energy \[J\].
    pub energy: f64,
}

/// One membrane of a snapshot.
#[derive(Clone, Debug)]
pub struct MembraneSnapshot {
    /// Name from the level.
    pub name: String,
    /// Its elements.
    pub elements: Arc<Membranes>,
    /// Its rest mesh, which is flat.
    pub mesh: Arc<Mesh>,
    /// Its vertices in the scene.
    pub vertices: Range<usize>,
    /// Elastic energy \[J\].
    pub energy: f64,
}

/// The toy of a snapshot; all points in world coordinates \[m\].
#[derive(Clone, Debug, PartialEq)]
pub struct ToySnapshot {
    /// Computed position.
    pub at: [f64; 2],
    /// Exact position.
    pub exact: [f64; 2],
    /// Pivot, if the toy has one.
    pub pivot: Option<[f64; 2]>,
    /// The exact path, and whether it closes.
    pub path: (Vec<[f64; 2]>, bool),
    /// Values to display.
    pub readings: Vec<Reading>,
}

/// The mouse spring while it pulls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pull {
    /// The vertex, by its number in the scene.
    pub vertex: usize,
    /// Target of the pull \[m\].
    pub target: [f64; 3],
    /// Force k |target - vertex| \[N\].
    pub force: f64,
}

impl Snapshot {
    /// Number of bodies, nets and membranes.
    pub const fn part_count(&self) -> usize {
        self.bodies.len() + self.nets.len() + self.membranes.len()
    }

    /// Names of the bodies, nets and membranes.
    pub fn part_names(&self) -> impl Iterator<Item = &String> {
        let nets = self.nets.iter().map(|net| &net.name);
        let membranes = self.membranes.iter().map(|membrane| &membrane.name);
        self.bodies.iter().map(|body| &body.name).chain(nets).chain(membranes)
    }

    /// Constitutive models of all bodies and membranes; `None` for a material from outside the crate.
    pub fn models(&self) -> impl Iterator<Item = Option<Model>> {
        let bodies = self.bodies.iter().map(|body| body.material.model());
        bodies.chain(self.membranes.iter().map(|membrane| membrane.elements.material().model()))
    }

    /// Whether there are triangles of a constitutive model.
    pub const fn has_models(&self) -> bool {
        !self.bodies.is_empty() || !self.membranes.is_empty()
    }

    /// Whether there is cloth in space: membranes, or nets that are drawn as surfaces.
    pub fn has_cloth(&self) -> bool {
        let is_sheet = |net: &NetSnapshot| net.springs.dimension() == 3 && !net.faces.is_empty();
        !self.membranes.is_empty() || self.nets.iter().any(is_sheet)
    }

    /// Number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.positions.len().checked_div(self.dimension).unwrap_or(0)
    }

    /// Position of a vertex \[m\]; the third coordinate is zero in the plane.
    pub fn position(&self, vertex: usize) -> Option<[f64; 3]> {
        let own = self.positions.get(self.dimension * vertex..self.dimension * (vertex + 1))?;
        Some(std::array::from_fn(|axis| own.get(axis).copied().unwrap_or(0.0)))
    }

    /// Whether everything sleeps.
    pub const fn is_asleep(&self) -> bool {
        self.asleep > 0 && self.asleep == self.part_count()
    }

    /// Whether the clock is paused although the scene runs, because everything sleeps.
    pub fn rests(&self) -> bool {
        self.running && self.mode != Mode::Edit && self.is_asleep()
    }
}

/// Most triangles of cloth that are tested for crossings in every frame.
const MOST_TESTED: usize = 5000;

impl Sandbox {
    /// Copies everything visible into `snapshot`, reusing its buffers.
    pub fn snapshot(&self, field: Field, snapshot: &mut Snapshot) {
        let (simulation, scene) = (&self.simulation, self.simulation.scene());
        let state = simulation.state();
        let x = &state.x;
        if snapshot.generation != self.generation || snapshot.level.notes != self.shown.notes {
            snapshot.note_vertices = self.note_vertices();
        }
        if snapshot.generation != self.generation {
            snapshot.generation = self.generation;
            snapshot.start = Arc::new(if scene.toy.is_none() { scene.start.x.clone() } else { Vec::new() });
            snapshot.dimension = scene.dimension;
            let (left, right) = extent(&snapshot.start, 0);
            snapshot.width = if self.shown.test.is_some() && scene.dimension == 2 {
                (1.0 - 2.0 * left.min(1.0 - right)).max(1.0)
            } else {
                1.0
            };
        }
        snapshot.level = Arc::clone(&self.shown);
        snapshot.triangles = Arc::clone(&scene.triangles);
        snapshot.pins = Arc::clone(&scene.pins);
        if scene.held().next().is_some() {
            let mut all: Vec<_> = scene.held().chain(scene.pins.iter().copied()).collect();
            all.sort_unstable();
            all.dedup();
            snapshot.pins = Arc::new(all);
        }
        snapshot.rollers = Arc::clone(&scene.rollers);
        snapshot.toy = self.toy();
        snapshot.positions.clear();
        if snapshot.toy.is_none() {
            snapshot.positions.extend_from_slice(x);
        }
        // The elements are evaluated once for each shape, however often it is drawn.
        let seen = Some((self.generation, simulation.shape(), field));
        // An impulse changes speeds and leaves the shape.
        if snapshot.seen != seen || field == Field::Speed {
            snapshot.seen = seen;
            self.diagnose(field, snapshot);
        }
        snapshot.energies = simulation.energies();
        snapshot.negligible = negligible(scene);
        snapshot.pull = simulation.grab().map(|grab| self.pull(grab));
        (snapshot.time, snapshot.steps) = (state.time, state.steps);
        (snapshot.mode, snapshot.running) = (self.mode, self.is_live());
        (snapshot.pose, snapshot.side_by_side) = (self.document.pose, self.document.side_by_side.is_some());
        snapshot.elements = Arc::clone(&scene.elements);
        (snapshot.records, snapshot.replayed) = (self.is_recording(), simulation.replayed());
        snapshot.checks.clear();
        snapshot.checks.extend(simulation.checks().map(|(placed, measured)| CheckReading {
            check: placed.check.clone(),
            unit: placed.unit,
            now: placed.value(simulation).unwrap_or(f64::NAN),
            measured,
            is_met: measured.is_some_and(|measured| placed.is_met(measured)),
        }));
        snapshot.mesh_change = self.mesh_change();
        snapshot.damping = self.damping();
        snapshot.wind = self.wind();
        snapshot.asleep = simulation.sleeping().filter(|asleep| *asleep).count();
        snapshot.regions = simulation.sleeping_regions();
        snapshot.still.clear();
        snapshot.still.extend_from_slice(simulation.still_vertices());
        snapshot.computed = simulation.computed_triangles();
        snapshot.rewind_length = self.rewind_length();
        snapshot.costs.clear();
        snapshot.costs.extend_from_slice(simulation.costs());
        snapshot.fault = simulation.fault().cloned();
        (snapshot.guard_substeps, snapshot.guarded) = (simulation.guard_substeps(), simulation.counts().guarded);
        snapshot.inside = simulation.count_inside();
        snapshot.substep_plans.clear();
        snapshot.substep_plans.extend(simulation.substep_plans());
        snapshot.messages.clone_from(&scene.messages);
        (snapshot.can_undo, snapshot.can_redo) = (self.history.can_undo(), self.history.can_redo());
    }

    /// Energies, fields and shapes, in one pass over the elements; and folds, in one over their corners.
    fn diagnose(&self, field: Field, snapshot: &mut Snapshot) {
        let (simulation, scene) = (&self.simulation, self.simulation.scene());
        let x = &simulation.state().x;
        snapshot.field = field;
        snapshot.values.clear();
        snapshot.bodies.clear();
        (snapshot.min_j, snapshot.inverted) = (f64::INFINITY, 0);
        snapshot.exploded = None;
        let mut first = 0;
        for (number, body) in scene.bodies.iter().enumerate() {
            let energy = simulation.known_energy(number);
            let shape = body.elements.diagnose_with_energy(energy, field, x, &mut snapshot.values);
            snapshot.min_j = snapshot.min_j.min(shape.least);
            snapshot.inverted += shape.inverted;
            if snapshot.exploded.is_none() && scene.has_exploded(number, shape.energy, x) {
                snapshot.exploded = Some((body.name.clone(), shape.energy));
            }
            let triangles = first..first + body.elements.corners().len();
            first = triangles.end;
            snapshot.bodies.push(self.body(body, triangles, shape));
        }
        snapshot.nets.clear();
        let known = |number: usize| simulation.known_energy(scene.bodies.len() + number);
        snapshot.nets.extend(scene.nets.iter().enumerate().map(|(number, net)| NetSnapshot {
            name: net.name.clone(),
            vertices: net.vertices.clone(),
            springs: net.springs.clone(),
            faces: Arc::clone(&net.faces),
            energy: known(number).unwrap_or_else(|| net.springs.elastic_energy(x)),
        }));
        for membrane in &scene.membranes {
            membrane.elements.add_values(field, x, &mut snapshot.values);
        }
        self.add_values_of_vertices(field, &mut snapshot.values);
        snapshot.stress_error = (field == Field::StressError).then(|| {
            let errors = scene.stress_errors(x);
            snapshot.values.extend(errors.shares().map(|share| 100.0 * share));
            errors.relative()
        });
        snapshot.membranes.clear();
        let known = |number: usize| simulation.known_energy(scene.bodies.len() + scene.nets.len() + number);
        snapshot.membranes.extend(scene.membranes.iter().enumerate().map(|(number, membrane)| MembraneSnapshot {
            name: membrane.name.clone(),
            elements: Arc::clone(&membrane.elements),
            mesh: Arc::clone(&membrane.mesh),
            vertices: membrane.vertices.clone(),
            energy: known(number).unwrap_or_else(|| membrane.elements.elastic_energy(x)),
        }));
        let nets = snapshot.nets.iter().map(|net| (&net.name, net.energy));
        let all = nets.chain(snapshot.membranes.iter().map(|membrane| (&membrane.name, membrane.energy)));
        for (number, (name, energy)) in (scene.bodies.len()..).zip(all) {
            if snapshot.exploded.is_none() && scene.has_exploded(number, energy, x) {
                snapshot.exploded = Some((name.clone(), energy));
            }
        }
        if simulation.known_energy(0).is_none() {
            snapshot.energy_evaluations += 1;
            let bodies = snapshot.bodies.iter().map(|body| body.energy);
            let nets = snapshot.nets.iter().map(|net| net.energy);
            let membranes = snapshot.membranes.iter().map(|membrane| membrane.energy);
            simulation.set_elastic_energies(bodies.chain(nets).chain(membranes));
        }
        snapshot.tangle = Tangle::of_all(scene, x);
        let start = Instant::now();
        let is_small = scene.cloth.count() <= MOST_TESTED;
        let all = || simulation.count_crossings().or_else(|| simulation.count_cloth_crossings());
        let count = if is_small { all() } else { None };
        snapshot.crossings = count.map(|count| (count, start.elapsed()));
        snapshot.evaluations += 1;
    }

    /// Appends the mean of the corners of each triangle, for a field that vertices have.
    fn add_values_of_vertices(&self, field: Field, values: &mut Vec<f64>) {
        let (scene, state) = (self.simulation.scene(), self.simulation.state());
        let of_vertex = |vertex: u32| {
            let own = scene.numbers(&(vertex as usize..vertex as usize + 1));
            let square = |number: usize| match field {
                Field::Speed => state.v[number] * state.v[number],
                _ => (state.x[number] - scene.start.x[number]) * (state.x[number] - scene.start.x[number]),
            };
            own.map(square).sum::<f64>().sqrt()
        };
        if matches!(field, Field::Speed | Field::Displacement) {
            let membranes = scene.membranes.iter().flat_map(|membrane| membrane.elements.corners());
            let all = scene.triangles.iter().chain(membranes);
            values.extend(all.map(|corners| corners.map(of_vertex).iter().sum::<f64>() / 3.0));
        }
    }

    fn body(&self, body: &Body, triangles: Range<usize>, shape: Diagnostics) -> BodySnapshot {
        let x = &self.simulation.state().x;
        let own = &x[self.simulation.scene().numbers(&body.vertices)];
        let (bottom, top) = extent(own, 1);
        let height_ratio = (top - bottom) / body.rest_height;
        let test = self.document.level.test.is_some();
        BodySnapshot {
            name: body.name.clone(),
            material: body.elements.material().clone(),
            mesh: Arc::clone(&body.mesh),
            vertices: body.vertices.clone(),
            triangles,
            energy: shape.energy,
            min_j: shape.least,
            continued: shape.continued,
            mid_width: if test { body.width_at(own, 0.5 * (bottom + top)) } else { 0.0 },
            top_force: if test { body.holding_force(x) } else { 0.0 },
            height_ratio,
            strip_warning: test.then(|| body.elements.material().strip_warning(height_ratio)).flatten(),
        }
    }

    fn toy(&self) -> Option<ToySnapshot> {
        let (state, scene) = (self.simulation.state(), self.simulation.scene());
        let (Some(toy), &[a, b]) = (&scene.toy, state.x.as_slice()) else { return None };
        let toy = toy.kind();
        Some(ToySnapshot {
            at: toy.place([a, b]),
            exact: toy.place(toy.exact(state.time)),
            pivot: toy.pivot(),
            path: toy.path(),
            readings: toy.readings(state.time, [a, b]),
        })
    }

    fn pull(&self, Grab { vertex, target }: Grab) -> Pull {
        let x = &self.simulation.state().x;
        let own = &x[self.simulation.scene().numbers(&(vertex..vertex + 1))];
        let square: f64 = own.iter().zip(target).map(|(x, target)| (target - x) * (target - x)).sum();
        let springs = self.shown.effects.iter().filter(|listed| listed.switch.is_on());
        let stiffness = springs.map(|listed| {
            if let EffectKind::MouseSpring(spring) = &listed.effect { spring.stiffness.get() } else { 0.0 }
        });
        Pull { vertex, target, force: stiffness.sum::<f64>() * square.sqrt() }
    }
}

impl Body {
    /// Distance between the outermost crossings of the boundary with a height \[m\]; `own` are its flat positions.
    fn width_at(&self, own: &[f64], height: f64) -> f64 {
        let crossings = self.boundary.iter().filter_map(|&[a, b]| {
            let point = |i: u32| [own[2 * i as usize], own[2 * i as usize + 1]];
            let ([ax, ay], [bx, by]) = (point(a), point(b));
            ((ay <= height) != (by <= height)).then(|| ax + (height - ay) / (by - ay) * (bx - ax))
        });
        let (left, right) = crossings.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, r), x| (x.min(l), x.max(r)));
        (right - left).max(0.0)
    }

    /// The vertical force that holds the top row against the elastic forces \[N\]; positive pulls up.
    fn holding_force(&self, x: &[f64]) -> f64 {
        let mut force = vec![0.0; x.len()];
        let mut scratch = vec![0.0; self.elements.scratch()];
        self.elements.elastic_force(x, &mut scratch, &mut force);
        -self.top.iter().map(|&vertex| force[2 * vertex as usize + 1]).sum::<f64>()
    }
}
