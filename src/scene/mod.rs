//! Scene: topology, rest shapes, masses and effects of a level, built for stepping. A scene does not change while time
//! runs; a changed level builds a new one, which reuses unchanged meshes.

mod checks;
mod correspondence;
mod effects;
mod membrane;
mod net;
mod numbering;
mod start;
mod stress_error;
mod sub_scene;

pub use crate::meshes::extent;
pub use correspondence::Correspondence;
pub use effects::ActingEffect;
pub use membrane::Membrane;
pub use net::Net;
use start::sliding;
pub use stress_error::StressErrors;
pub use sub_scene::SubScene;

use crate::{
    contact::ClothSurface,
    effects::{Effect, HeldVertices, LengthProjection, Motion},
    elements::{BodyMaterial, CoupledMass, ElasticElements, ElementKind, Elements, Triangles},
    integrators::{IntegratorKind, Scheme},
    level::{BodyLevel, Level, MassLevel, RunMode, SavedState, Sleep, Substeps, Toggle},
    materials::{MaterialParameters, TypedEnergy},
    meshes::{Files, MOST_TRIANGLES, Mesh, MeshKind, Numbering, nearest, on_edge, pinned},
    quantity::{Factor, Position},
    solvers::ConstraintRows,
    state::State,
    toys::ToyKind,
};
use std::{ops::Range, sync::Arc};

/// The constant part of a simulation.
#[derive(Clone)]
pub struct Scene {
    /// The bodies, in the order of the level.
    pub bodies: Vec<Body>,
    /// The nets, in the order of the level; their particles come after the bodies' vertices.
    pub nets: Vec<Net>,
    /// The membranes, in the order of the level; their vertices come after the nets' particles.
    pub membranes: Vec<Membrane>,
    /// The toy problem in place of bodies and nets, if any: its state is `x`, and `v` is empty.
    pub toy: Option<ToyKind>,
    /// Number of coordinates of a vertex.
    pub dimension: usize,
    /// Positions at rest, flat \[m\].
    pub rest: Vec<f64>,
    /// Positions and velocities at the start.
    pub start: State,
    /// Mass \[kg\], equal for all coordinates of a vertex.
    pub mass: Vec<f64>,
    /// What the mass matrix has beside these masses.
    pub coupled_mass: Arc<CoupledMass>,
    /// 1/mass [1/kg], flat; zero for pinned vertices, and for the fixed coordinate of rollers.
    pub inverse_mass: Vec<f64>,
    /// Pinned vertices, ascending.
    pub pins: Arc<Vec<u32>>,
    /// Vertices on rollers along a side of their body, and the fixed coordinate (0 is x, 1 is y).
    pub rollers: Arc<Vec<(u32, usize)>>,
    /// Corners of all triangles, in the order of the bodies.
    pub triangles: Arc<Vec<[u32; 3]>>,
    /// The triangles of cloth in space.
    pub cloth: Arc<ClothSurface>,
    /// What effects are built for.
    pub elements: Arc<Elements>,
    /// Elements of each body, each net and each membrane, which are also the first effects.
    pub parts: Vec<Arc<dyn ElasticElements>>,
    /// All effects, elasticity first.
    pub effects: Vec<Arc<dyn Effect>>,
    /// The effects of the level that act, in the order of the effects after the elements.
    pub acting: Arc<Vec<ActingEffect>>,
    /// Which effects may be skipped where they change nothing.
    pub auto: Vec<bool>,
    /// The time-stepping scheme.
    pub integrator: IntegratorKind,
    /// Length of a step \[s\].
    pub step: f64,
    /// Whether an unstable step is repeated in shorter ones.
    pub guard: bool,
    /// What sleeps at rest until something acts on it.
    pub sleep: Sleep,
    /// Sub-scenes of each body, each net and each membrane, with multirate stepping; empty otherwise.
    pub sub_scenes: Vec<Arc<SubScene>>,
    /// Repairs while building, and other notes for the user.
    pub messages: Vec<String>,
}

/// One body of a scene.
#[derive(Clone)]
pub struct Body {
    /// Name from the level.
    pub name: String,
    /// Parameters of the mesh.
    recipe: MeshKind,
    /// The mesh, in its own coordinates.
    pub mesh: Arc<Mesh>,
    /// Its vertices in the scene.
    pub vertices: Range<usize>,
    /// Its elements.
    pub elements: Arc<Triangles>,
    /// Edges of its boundary, by its own vertex numbers.
    pub boundary: Vec<[u32; 2]>,
    /// Vertices at the greatest rest y.
    pub top: Vec<u32>,
    /// Height at rest \[m\].
    pub rest_height: f64,
}

/// Owner of a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Owner {
    /// A body, by number.
    Body(usize),
    /// A net, by number.
    Net(usize),
    /// A membrane, by number.
    Membrane(usize),
}

/// A level that cannot be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SceneError {
    /// The level has no bodies, nets, membranes or toy.
    #[error("a level needs at least one body, net or membrane, or a toy")]
    Nothing,
    /// A toy together with bodies, nets or effects.
    #[error("a level with a toy problem has nothing else: remove its bodies, nets, membranes and effects, or the toy")]
    ToyWithOthers,
    /// The integrator needs positions and velocities, which a toy lacks.
    #[error(
        "{integrator} needs positions and velocities, but a toy problem is a system of first order; choose another integrator, such as {instead}"
    )]
    ToyIntegrator {
        /// The integrator of the level.
        integrator: &'static str,
        /// A suitable one.
        instead: &'static str,
    },
    /// An error in a body's mesh, pins or place.
    #[error("body {name:?}: {why}")]
    Body {
        /// Name of the body.
        name: String,
        /// What is wrong, and what to do.
        why: String,
    },
    /// An error in a net's particles, springs or pins.
    #[error("net {name:?}: {why}")]
    Net {
        /// Name of the net.
        name: String,
        /// What is wrong, and what to do.
        why: String,
    },
    /// An error in a membrane's mesh, pins or place.
    #[error("membrane {name:?}: {why}")]
    Membrane {
        /// Name of the membrane.
        name: String,
        /// What is wrong, and what to do.
        why: String,
    },
    /// Something in the plane together with something in space.
    #[error(
        "{plane:?} is in the plane, but {space:?} is in space: give nets a place with `space`, and make bodies membranes, or keep both apart"
    )]
    Mixed {
        /// Name of a body or net in the plane.
        plane: String,
        /// Name of a net or membrane in space.
        space: String,
    },
    /// An error in an effect's parameters.
    #[error("effect {name}: {why}")]
    Effect {
        /// Name of the effect.
        name: &'static str,
        /// What is wrong, and what to do.
        why: String,
    },
    /// A known result that cannot be measured in the scene.
    #[error("check {name:?}: {why}")]
    Check {
        /// Its name.
        name: String,
        /// What is wrong, and what to do.
        why: String,
    },
    /// An effect of another dimension than the scene.
    #[error("{effect} acts on vertices with {dimension} coordinates, but those of the scene have {scene}")]
    Dimension {
        /// Name of the effect.
        effect: &'static str,
        /// Number of coordinates that it needs.
        dimension: usize,
        /// Number of coordinates of a vertex of the scene.
        scene: usize,
    },
    /// The integrator cannot continue from positions that a projection changed.
    #[error(
        "{0} cannot step a level with Projection: it needs a scheme of one step of fixed length, such as Symplectic Euler or Position Verlet"
    )]
    Projection(&'static str),
    /// The masses of vertices do not fit to their positions.
    #[error("{masses} masses and {numbers} coordinates were given for vertices with {dimension} coordinates each")]
    Masses {
        /// Number of masses.
        masses: usize,
        /// Number of coordinates.
        numbers: usize,
        /// Number of coordinates of a vertex.
        dimension: usize,
    },
    /// The saved state belongs to other meshes.
    #[error(
        "the saved state has {positions} positions and {velocities} velocities, but the level has {vertices} vertices"
    )]
    State {
        /// Number of saved positions.
        positions: usize,
        /// Number of saved velocities.
        velocities: usize,
        /// Number of vertices.
        vertices: usize,
    },
    /// The saved state has points of the plane in a scene in space, or the other way round.
    #[error("the saved state must have points with {0} coordinates each, as the level has")]
    StateDimension(usize),
}

impl Body {
    /// Parameters of its mesh.
    pub const fn recipe(&self) -> &MeshKind {
        &self.recipe
    }

    /// Whether its mesh is that of a level.
    pub fn is_made_as(&self, level: &BodyLevel) -> bool {
        self.recipe == level.mesh && self.elements.kind().has_six_nodes() == level.element.has_six_nodes()
    }
}

impl Scene {
    /// Builds a level for one of its modes. Meshes of `previous` are reused where their parameters are the same.
    ///
    /// # Errors
    /// [`SceneError`] names the body or effect and what is wrong.
    pub fn build(level: &Level, mode: RunMode, files: &dyn Files, previous: Option<&Self>) -> Result<Self, SceneError> {
        check_kind(level)?;
        let mut scene = Self {
            toy: level.toy.clone(),
            integrator: level.integrator.clone(),
            step: level.substeps.step(),
            guard: level.guard == Toggle::On,
            sleep: level.sleep,
            ..Self::empty(dimension(level)?)
        };
        for body in &level.bodies {
            scene.add_body(body, files, previous).map_err(|why| SceneError::Body { name: body.name.clone(), why })?;
        }
        for net in &level.nets {
            scene.add_net(net).map_err(|why| SceneError::Net { name: net.name.clone(), why })?;
        }
        for membrane in &level.membranes {
            let why = |why| SceneError::Membrane { name: membrane.name.clone(), why };
            scene.add_membrane(membrane, files, previous).map_err(why)?;
        }
        if let Some(toy) = &level.toy {
            scene.start.x.extend(toy.kind().exact(0.0));
        }
        scene.finish_masses();
        scene.triangles = Arc::new(scene.bodies.iter().flat_map(|body| body.elements.corners()).copied().collect());
        scene.add_cloth();
        scene.add_effects(level, mode, files, previous)?;
        scene.finish_masses();
        scene.build_sub_scenes(level, mode, files, previous)?;
        Ok(scene)
    }

    /// A scene without anything in it.
    fn empty(dimension: usize) -> Self {
        Self {
            bodies: Vec::new(),
            nets: Vec::new(),
            membranes: Vec::new(),
            toy: None,
            dimension,
            rest: Vec::new(),
            start: State::default(),
            mass: Vec::new(),
            coupled_mass: Arc::default(),
            inverse_mass: Vec::new(),
            pins: Arc::default(),
            rollers: Arc::default(),
            triangles: Arc::default(),
            cloth: Arc::default(),
            elements: Arc::default(),
            parts: Vec::new(),
            effects: Vec::new(),
            acting: Arc::default(),
            auto: Vec::new(),
            integrator: IntegratorKind::default(),
            step: Substeps::default().step(),
            guard: true,
            sleep: Sleep::On,
            sub_scenes: Vec::new(),
            messages: Vec::new(),
        }
    }

    /// A scene of elements of any kind, in any number of dimensions: `rest` are the positions at rest \[m\], flat, and
    /// `mass` the masses of the vertices \[kg\]. It starts at rest, without pins and other effects, and no file can hold
    /// it: it has no bodies and nets with names. What else there is to say is set afterwards.
    ///
    /// ```
    /// use gingerbread::{elements::Springs, nets::{Link, Role}, scene::Scene, simulation::Simulation};
    /// use std::sync::Arc;
    ///
    /// // Two particles in space on a stretched spring.
    /// let link = Link { ends: [0, 1], role: Role::Structural, rest: 1.0, stiffness: 10.0 };
    /// let spring = Arc::new(Springs::<3>::of_links(vec![link], 0..2));
    /// let mut scene = Scene::of_elements(3, vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0], &[1.0, 1.0], vec![spring])?;
    /// scene.start.x[3] = 1.5;
    /// scene.pin(&[0]);
    /// let start = scene.start.clone();
    /// let mut simulation = Simulation::new(scene, start);
    /// simulation.advance(10, &mut || true);
    /// assert!(simulation.state().v[3] < 0.0);
    /// # Ok::<(), gingerbread::scene::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// [`SceneError::Masses`] if there is not one mass for each vertex.
    pub fn of_elements(
        dimension: usize,
        rest: Vec<f64>,
        mass: &[f64],
        parts: Vec<Arc<dyn ElasticElements>>,
    ) -> Result<Self, SceneError> {
        if dimension == 0 || mass.len() * dimension != rest.len() {
            return Err(SceneError::Masses { masses: mass.len(), numbers: rest.len(), dimension });
        }
        let start = State { v: vec![0.0; rest.len()], x: rest.clone(), ..State::default() };
        let mass = mass.iter().flat_map(|mass| std::iter::repeat_n(*mass, dimension)).collect();
        let mut scene = Self { rest, start, mass, ..Self::empty(dimension) };
        scene.set_parts(parts);
        scene.finish_masses();
        Ok(scene)
    }

    /// Makes elements the first effects.
    fn set_parts(&mut self, parts: Vec<Arc<dyn ElasticElements>>) {
        self.effects.extend(parts.iter().map(|part| Arc::clone(part) as Arc<dyn Effect>));
        self.auto = vec![true; self.effects.len()];
        self.parts = parts;
    }

    /// Pins vertices of a scene made in code.
    pub fn pin(&mut self, vertices: &[u32]) {
        Arc::make_mut(&mut self.pins).extend(vertices);
        Arc::make_mut(&mut self.pins).sort_unstable();
        self.finish_masses();
    }

    fn add_cloth(&mut self) {
        let sheets = self.nets.iter().filter(|net| net.springs.dimension() == 3).map(|net| net.faces.as_slice());
        let membranes = self.membranes.iter().map(|membrane| membrane.elements.corners());
        self.cloth = Arc::new(ClothSurface::new(sheets.chain(membranes).flatten().copied().collect()));
    }

    /// Vertices with prescribed positions.
    pub fn held(&self) -> impl Iterator<Item = u32> + '_ {
        let held = self.effects.iter().filter_map(|effect| effect.held_vertices());
        held.flat_map(HeldVertices::vertices).copied()
    }

    /// Writes the positions \[m\] and velocities [m/s] of vertices with prescribed ones at a time \[s\].
    pub fn place_held(&self, time: f64, x: &mut [f64], v: &mut [f64]) {
        let held = self.effects.iter().filter_map(|effect| effect.held_vertices());
        held.for_each(|held| held.place(time, x, v));
    }

    /// Tells constraints the accelerations of those vertices at a time \[s\].
    pub fn accelerate_held(&self, time: f64, rows: &mut ConstraintRows) {
        let held = self.effects.iter().filter_map(|effect| effect.held_vertices());
        held.for_each(|held| held.accelerate(time, rows));
    }

    /// Whether an effect acts on several bodies, nets or membranes together.
    pub fn couples_parts(&self) -> bool {
        self.parts.len() > 1 && self.effects.iter().any(|effect| effect.couples_parts())
    }

    /// Whether pinned vertices move in a step, and are put back after the projection of positions.
    pub fn puts_pins_back(&self) -> bool {
        self.effects.iter().filter_map(|effect| effect.projection()).any(LengthProjection::puts_pins_back)
    }

    /// Adds an effect that is built already. It acts on all bodies and nets together, without multirate stepping.
    ///
    /// # Errors
    /// [`SceneError::Dimension`] for walls, for example, in space.
    pub fn add_effect(&mut self, effect: Arc<dyn Effect>) -> Result<(), SceneError> {
        if let Some(dimension) = effect.dimension().filter(|dimension| *dimension != self.dimension) {
            return Err(SceneError::Dimension { effect: effect.name(), dimension, scene: self.dimension });
        }
        self.effects.push(effect);
        self.auto.push(true);
        self.check_projection()?;
        self.check_held()?;
        self.check_masses()?;
        self.finish_masses();
        Ok(())
    }

    /// The saved state of a level, or the start.
    ///
    /// # Errors
    /// [`SceneError::State`] if it belongs to other meshes.
    pub fn first_state(&self, saved: Option<&SavedState>) -> Result<State, SceneError> {
        let Some(saved) = saved else { return Ok(self.start.clone()) };
        let vertices = self.start.x.len() / self.dimension;
        if saved.positions.len() != vertices || saved.velocities.len() != self.start.v.len() / self.dimension {
            let (positions, velocities) = (saved.positions.len(), saved.velocities.len());
            return Err(SceneError::State { positions, velocities, vertices });
        }
        if saved.positions.iter().chain(&saved.velocities).any(|point| point.dimension() != self.dimension) {
            return Err(SceneError::StateDimension(self.dimension));
        }
        let flat = |points: &[Position]| points.iter().flat_map(|point| point.coordinates()).collect::<Vec<_>>();
        let mut v = self.unlisted(&flat(&saved.velocities));
        for (v, _) in v.iter_mut().zip(&self.inverse_mass).filter(|(_, inverse_mass)| **inverse_mass == 0.0) {
            *v = 0.0;
        }
        let mut x = self.unlisted(&flat(&saved.positions));
        self.place_held(saved.time.get(), &mut x, &mut v);
        Ok(State {
            x,
            v,
            time: saved.time.get(),
            steps: saved.steps,
            slow_checks: saved.calm.clone(),
            calm_positions: self.calm_positions(&flat(&saved.calm_positions)),
            anchors: self.unlisted_anchors(&saved.anchors),
            memory: saved.memory.iter().map(|number| number.get()).collect(),
        })
    }

    /// Positions for sleeping regions from how a level lists them; none if it lists others than all.
    fn calm_positions(&self, listed: &[f64]) -> Vec<f64> {
        if listed.len() == self.start.x.len() && !listed.is_empty() { self.unlisted(listed) } else { Vec::new() }
    }

    /// Number of steps in a frame of 1/60 s, rounded; at least one.
    pub fn steps_per_frame(&self) -> u64 {
        (1.0 / (60.0 * self.step)).round().max(1.0) as u64
    }

    /// A state of this scene for effects.
    pub fn motion<'a>(&'a self, state: &'a State, grab: Option<crate::effects::Grab>) -> Motion<'a> {
        Motion {
            dimension: self.dimension,
            x: &state.x,
            v: &state.v,
            mass: &self.mass,
            inverse_mass: &self.inverse_mass,
            grab,
            time: state.time,
            anchors: &state.anchors,
            candidates: None,
            pattern: &[],
            span: 0.0,
            elastic_span: 0.0,
            lag: 0.0,
        }
    }

    /// Names of the bodies, nets and membranes.
    pub fn part_names(&self) -> impl Iterator<Item = &String> {
        let nets = self.nets.iter().map(|net| &net.name);
        let membranes = self.membranes.iter().map(|membrane| &membrane.name);
        self.bodies.iter().map(|body| &body.name).chain(nets).chain(membranes)
    }

    /// Number of vertices; a toy has none.
    pub const fn vertices(&self) -> usize {
        self.rest.len() / self.dimension
    }

    /// The numbers of some vertices in flat vectors.
    pub const fn numbers(&self, vertices: &Range<usize>) -> Range<usize> {
        self.dimension * vertices.start..self.dimension * vertices.end
    }

    /// Size of the scratch that is enough for every effect.
    pub fn scratch(&self) -> usize {
        self.effects.iter().map(|effect| effect.scratch()).max().unwrap_or(0)
    }

    /// Number of effects, from the first, that are elements: their energy is elastic.
    pub const fn element_count(&self) -> usize {
        self.parts.len()
    }

    fn add_body(&mut self, level: &BodyLevel, files: &dyn Files, previous: Option<&Self>) -> Result<(), String> {
        let before = previous.into_iter().flat_map(|scene| &scene.bodies);
        let known = self.bodies.iter().chain(before).find(|body| body.is_made_as(level));
        let mesh = if let Some(body) = known {
            Arc::clone(&body.mesh)
        } else {
            let mesh = numbering::mesh(level.mesh.kind().build(files).map_err(|error| error.to_string())?);
            let has_six = level.element.has_six_nodes();
            Arc::new(if has_six {
                mesh.refined().map_err(|error| format!("divided into four, {error}"))?
            } else {
                mesh
            })
        };
        let numbering = mesh.numbering();
        let first = self.rest.len() / self.dimension;
        let vertices = first..first + mesh.points().len();
        self.rest.extend(mesh.points().iter().copied().flat_map(level.place.map()));
        let rest = &self.rest[self.numbers(&vertices)];
        if !rest.iter().all(|coordinate| coordinate.abs() <= State::LIMIT) {
            return Err(format!("its place puts it beyond {:e} m", State::LIMIT));
        }
        let total =
            mesh.triangles().len() + self.bodies.iter().map(|body| body.elements.corners().len()).sum::<usize>();
        if total > MOST_TRIANGLES {
            return Err(format!("with it the level has {total} triangles, more than {MOST_TRIANGLES}"));
        }
        let own = level.own_material.as_ref().map(|own| own.with(level.material));
        let material = own.map_or_else(|| material_of(level.energy.as_ref(), level.material), Ok)?;
        if level.element == ElementKind::MeanDilatation && !material.has_volume_measure() {
            return Err(format!(
                "{} does not say which part of its energy resists changes of volume, as elements of mean dilatation need; take quadratic or linear ones",
                material.title()
            ));
        }
        let is_same = |body: &&Body| {
            Arc::ptr_eq(&body.mesh, &mesh) && body.vertices == vertices && body.elements.kind() == level.element
        };
        let same = previous.and_then(|scene| Some((scene, scene.bodies.iter().find(is_same)?)));
        // Blocks are kept while a slider changes the material.
        let unchanged = same.filter(|(scene, _)| scene.rest.get(self.numbers(&vertices)) == Some(rest));
        let elements = if let Some((_, body)) = unchanged {
            body.elements.with_material(material)
        } else {
            let triangles = Triangles::new(&self.rest, vertices.clone(), &mesh, material);
            triangles.of_kind(level.element, &self.rest, &mesh)
        };
        let elements = Arc::new(elements);
        check_areas(elements.rest_areas(), numbering)?;
        let areas = || elements.corners().iter().copied().zip(elements.rest_areas());
        let masses = self.add_masses(level.mass, &vertices, 1.0, areas);
        let rest = &self.rest[self.numbers(&vertices)];
        let pins = pinned(&level.pins, rest, numbering)?;
        let rollers: Vec<_> = level.slides.iter().flat_map(|side| sliding(*side, rest)).collect();
        let mut start = stretched(level.stretch, rest);
        start::reshape::<2>(level.start, (&pins, &rollers), numbering, &mut start);
        self.start.v.extend(moving(level, &start, &masses));
        self.start.x.extend(start);
        Arc::make_mut(&mut self.pins).extend(pins.iter().map(|pin| pin + first as u32));
        Arc::make_mut(&mut self.rollers).extend(rollers.iter().map(|(slide, axis)| (slide + first as u32, *axis)));
        let (least, greatest) = extent(rest, 1);
        let top = on_edge(rest, 1, true).map(|i| i + first as u32).collect();
        self.messages.extend(mesh.messages().iter().map(|message| format!("{}: {message}", level.name)));
        let (name, recipe, rest_height) = (level.name.clone(), level.mesh.clone(), greatest - least);
        let boundary = mesh.boundary_edges();
        self.bodies.push(Body { name, recipe, mesh, vertices, elements, boundary, top, rest_height });
        Ok(())
    }

    /// Adds the masses of the vertices of a body or membrane with these triangles, their areas \[m²\] and a thickness \[m\], or 1 in the
    /// plane. Returns the mass of each vertex \[kg\].
    fn add_masses<T: Iterator<Item = ([u32; 3], f64)>>(
        &mut self,
        mass: MassLevel,
        vertices: &Range<usize>,
        thickness: f64,
        triangles: impl Fn() -> T,
    ) -> Vec<f64> {
        let masses = match mass {
            MassLevel::Total(total) => vec![total.get() / vertices.len() as f64; vertices.len()],
            MassLevel::Density(density) | MassLevel::Consistent(density) => {
                let mut masses = vec![0.0; vertices.len()];
                for (corner, area) in triangles().flat_map(|(corners, area)| corners.map(|corner| (corner, area))) {
                    masses[corner as usize - vertices.start] += density.get() * thickness * area / 3.0;
                }
                masses
            }
        };
        self.mass.extend(masses.iter().flat_map(|mass| std::iter::repeat_n(*mass, self.dimension)));
        if let MassLevel::Consistent(density) = mass {
            let density = density.get() * thickness;
            let coupled = CoupledMass::new(triangles().map(|(corners, area)| (corners, density * area)));
            Arc::make_mut(&mut self.coupled_mass).append(&coupled);
        }
        masses
    }

    /// Kinetic energy beside that of [`Self::mass`] \[J\]; never positive.
    pub fn coupled_energy(&self, v: &[f64]) -> f64 {
        if self.coupled_mass.is_empty() { 0.0 } else { self.coupled_mass.kinetic_energy(self.dimension, v) }
    }

    fn finish_masses(&mut self) {
        let puts_back = self.puts_pins_back();
        self.inverse_mass = self.mass.iter().map(|mass| 1.0 / mass).collect();
        let pinned = self.pins.iter().flat_map(|&pin| (0..self.dimension).map(move |axis| (pin, axis)));
        // Those of nets alone move and are put back.
        let in_net = |pin: u32| self.nets.iter().any(|net| net.vertices.contains(&(pin as usize)));
        let pinned = pinned.filter(|(pin, _)| !(puts_back && in_net(*pin)));
        for (vertex, axis) in pinned.chain(self.rollers.iter().copied()) {
            let number = self.dimension * vertex as usize + axis;
            self.inverse_mass[number] = 0.0;
            self.start.v[number] = 0.0;
        }
        let held: Vec<_> = self.held().collect();
        for vertex in held {
            let numbers = self.numbers(&(vertex as usize..vertex as usize + 1));
            self.inverse_mass[numbers].fill(0.0);
        }
        let mut start = std::mem::take(&mut self.start);
        self.place_held(0.0, &mut start.x, &mut start.v);
        self.start = start;
    }
}

/// Number of coordinates of a level: two, or three if its nets and membranes are in space.
fn dimension(level: &Level) -> Result<usize, SceneError> {
    let nets =
        |in_space: bool| level.nets.iter().filter(move |net| net.space.is_some() == in_space).map(|net| &net.name);
    let plane = level.bodies.iter().map(|body| &body.name).chain(nets(false)).next();
    let space = level.membranes.iter().map(|membrane| &membrane.name).chain(nets(true)).next();
    match (plane, space) {
        (Some(plane), Some(space)) => Err(SceneError::Mixed { plane: plane.clone(), space: space.clone() }),
        (_, Some(_)) => Ok(3),
        _ => Ok(2),
    }
}

/// Checks that a level has bodies, nets and membranes, or a toy with a suitable integrator.
fn check_kind(level: &Level) -> Result<(), SceneError> {
    let still = level.bodies.is_empty() && level.nets.is_empty() && level.membranes.is_empty();
    if level.toy.is_none() {
        return if still { Err(SceneError::Nothing) } else { Ok(()) };
    }
    if !still || !level.effects.is_empty() {
        return Err(SceneError::ToyWithOthers);
    }
    check_toy_integrator(&level.integrator)
}

/// Refuses a triangle without an area at rest.
fn check_areas(mut areas: impl Iterator<Item = f64>, numbering: &Numbering) -> Result<(), String> {
    let flat = areas.position(|area| !(area.is_normal() && area > 0.0));
    flat.map_or(Ok(()), |flat| {
        let flat = numbering.element_name(flat);
        Err(format!("its place leaves triangle {flat} no area: numbers are not fine enough there"))
    })
}

/// The material of a typed energy, or of the model.
fn material_of(energy: Option<&TypedEnergy>, parameters: MaterialParameters) -> Result<BodyMaterial, String> {
    match energy {
        Some(energy) => Ok(BodyMaterial::typed(energy.material(parameters)?, parameters.plane())),
        None => Ok(parameters.into()),
    }
}

/// Checks that an integrator suits a toy, which has no velocities.
///
/// # Errors
/// [`SceneError::ToyIntegrator`], which names one that serves.
pub fn check_toy_integrator(integrator: &IntegratorKind) -> Result<(), SceneError> {
    let suits = |kind: &IntegratorKind| matches!(kind.kind().scheme(), Scheme::First(_));
    if suits(integrator) {
        return Ok(());
    }
    let known = IntegratorKind::all();
    let instead = known.iter().find(|kind| suits(kind)).map_or("another", |kind| kind.kind().title());
    Err(SceneError::ToyIntegrator { integrator: integrator.kind().title(), instead })
}

/// The start positions: stretched about the middle of the bottom edge, flat \[m\].
fn stretched((sx, sy): (Factor, Factor), rest: &[f64]) -> Vec<f64> {
    let (sx, sy) = (sx.get(), sy.get());
    let ((left, right), (bottom, _)) = (extent(rest, 0), extent(rest, 1));
    let middle = 0.5 * (left + right);
    let along =
        |value: f64, origin: f64, factor: f64| if factor == 1.0 { value } else { origin + factor * (value - origin) };
    rest.chunks_exact(2).flat_map(|point| [along(point[0], middle, sx), along(point[1], bottom, sy)]).collect()
}

/// The start velocities: translation and spin about the centre of mass, flat [m/s].
fn moving(level: &BodyLevel, x: &[f64], masses: &[f64]) -> Vec<f64> {
    let (vx, vy, spin) = (level.velocity.0.get(), level.velocity.1.get(), level.spin.get());
    let total: f64 = masses.iter().sum();
    let centre = |axis: usize| x.iter().skip(axis).step_by(2).zip(masses).map(|(x, m)| x * m).sum::<f64>() / total;
    let (cx, cy) = (centre(0), centre(1));
    x.chunks_exact(2).flat_map(|point| [vx - spin * (point[1] - cy), vy + spin * (point[0] - cx)]).collect()
}

/// The number of the vertex nearest to a point, by flat positions; the lowest of equals.
pub fn nearest_vertex(x: &[f64], point: &[f64]) -> Option<usize> {
    nearest(0..x.len() / point.len(), x, point)
}
