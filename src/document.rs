//! The editable document: a level and the state of its stretch test, with undo.
//!
//! ```
//! use gingerbread::{files, levels, meshes::NoFiles, sandbox::Sandbox};
//!
//! let level = files::parse(levels::built_in("gingerbread").ok_or("there is no such level")?, "gingerbread.ron")?;
//! let sandbox = Sandbox::new(level, Box::new(NoFiles))?;
//! assert_eq!(sandbox.document().shown().bodies.len(), sandbox.simulation().scene().bodies.len());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::{
    command::Pose,
    level::{BodyLevel, EffectLevel, Level, Pin, Place, StretchTest, Switch, When},
    materials::Model,
    meshes::MeshKind,
    quantity::{Factor, Point},
    scene::Owner,
    simulation::Restart,
};

/// The document of a sandbox.
#[derive(Clone, Debug, PartialEq)]
pub struct Document {
    /// The level, with a single body if a test shows several.
    pub level: Level,
    /// Last pose of a test level.
    pub pose: Option<Pose>,
    /// Least and greatest x of the first body at rest \[m\], while a test level shows one body for each model.
    pub side_by_side: Option<[f64; 2]>,
}

/// Undo history: past and future documents. An entry has the restart data of the run that its change replaced, if any.
#[derive(Clone, Default)]
pub struct History {
    past: Vec<(Document, Option<Restart>)>,
    future: Vec<(Document, Option<Restart>)>,
    /// Subject of the last change, while its gesture lasts.
    gesture: Option<Gesture>,
    /// Number of all recorded changes.
    count: u64,
}

/// Subject of a change; changes of the same subject in one gesture are undone as one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gesture {
    /// The material of a body.
    Material(usize),
    /// The mesh of a body.
    Mesh(usize),
    /// The place of a body.
    Place(usize),
    /// The place of a net or membrane.
    SpacePlace(usize),
    /// The mass of a body.
    Mass(usize),
    /// Mass and springs of a net.
    Net(usize),
    /// Material, thickness and mass of a membrane.
    Membrane(usize),
    /// How a net or membrane looks.
    Finish(usize),
    /// The typed energy of a part.
    Energy(usize),
    /// The parameters of the toy.
    Toy,
    /// An effect of the list.
    Effect(usize),
    /// The notes.
    Notes,
    /// The number of steps per frame.
    Substeps,
    /// The parameters of the time-stepping scheme; a change to another scheme is a change of its own.
    Integrator(&'static str),
}

/// Maximum number of changes in the history.
const DEPTH: usize = 200;

/// Minimum distance between the centres of strips side by side, in widths: a compressed strip bulges.
const APART: f64 = 1.4;

/// Maximum number of values in the states of the history: 128 MB.
const STATES: usize = 1 << 24;

impl History {
    /// Records a document before a change. `state` is the run that the change replaces.
    pub fn record(&mut self, document: Document, state: Option<Restart>, gesture: Option<Gesture>) {
        self.future.clear();
        if gesture.is_some() && gesture == self.gesture {
            return;
        }
        self.gesture = gesture;
        self.past.push((document, state));
        self.count += 1;
        let states = |past: &[(Document, Option<Restart>)]| {
            past.iter().filter_map(|(_, state)| state.as_ref()).map(Restart::len).sum::<usize>()
        };
        while self.past.len() > DEPTH || (self.past.len() > 1 && states(&self.past) > STATES) {
            self.past.remove(0);
        }
    }

    /// Ends a gesture: the next change is recorded separately.
    pub fn end_gesture(&mut self) {
        self.gesture = None;
    }

    /// The document of the next undo (or, if `forth`, redo), with its state.
    pub fn next(&self, forth: bool) -> Option<&(Document, Option<Restart>)> {
        if forth { self.future.last() } else { self.past.last() }
    }

    /// Completes an undo or redo; the document from before is kept for the opposite.
    pub fn went(&mut self, forth: bool, before: Document, replaced: Option<Restart>) {
        let (from, to) = if forth { (&mut self.future, &mut self.past) } else { (&mut self.past, &mut self.future) };
        from.pop();
        to.push((before, replaced));
        self.gesture = None;
    }

    /// Number of all recorded changes: it grows with each change that does not continue a gesture.
    pub const fn count(&self) -> u64 {
        self.count
    }

    /// Whether there is something to undo.
    pub fn can_undo(&self) -> bool {
        !self.past.is_empty()
    }

    /// Whether there is something to redo.
    pub fn can_redo(&self) -> bool {
        !self.future.is_empty()
    }
}

impl Document {
    /// Creates a document that shows a level unchanged.
    pub const fn new(level: Level) -> Self {
        Self { level, pose: None, side_by_side: None }
    }

    /// Starts every body at a pose of the test.
    pub fn set_pose(&mut self, pose: Pose, test: StretchTest) {
        let height = match pose {
            Pose::Stretched => test.stretched,
            Pose::Compressed => test.compressed,
        };
        for body in &mut self.level.bodies {
            body.stretch = (Factor::literal(1.0), height);
        }
        self.level.state = None;
        self.pose = Some(pose);
    }

    /// The level as it is simulated. For a test shown side by side it has the first body once for every model, spread evenly over the
    /// unit square or, if that is too narrow, beyond it.
    pub fn shown(&self) -> Level {
        let mut level = self.level.clone();
        if let (Some([left, right]), Some(body)) = (self.side_by_side, self.level.bodies.first()) {
            let count = Model::ALL.len() as f64;
            let pitch = (APART * (right - left)).max(1.0 / count);
            let place = |(number, &model): (usize, &Model)| {
                let by = 0.5 + pitch * (number as f64 - 0.5 * (count - 1.0)) - 0.5 * (left + right);
                let pins = body.pins.iter().map(|pin| match *pin {
                    Pin::Nearest(point) => Pin::Nearest(moved(point, by)),
                    other => other,
                });
                BodyLevel {
                    name: model.title().to_owned(),
                    material: body.material.with_model(model),
                    energy: None,
                    place: Place { offset: moved(body.place.offset, by), ..body.place },
                    pins: pins.collect(),
                    ..body.clone()
                }
            };
            level.bodies = Model::ALL.iter().enumerate().map(place).collect();
        }
        level
    }

    /// Number of the document's body for a body number of the shown level.
    pub const fn source(&self, body: usize) -> usize {
        if self.side_by_side.is_some() { 0 } else { body }
    }

    /// Pinning rules of a body, net or membrane, by its number in the shown level: bodies first, then nets, then membranes.
    pub fn pins_mut(&mut self, part: usize) -> Option<&mut Vec<Pin>> {
        let source = self.source(part);
        let Level { bodies, nets, membranes, .. } = &mut self.level;
        let lists = bodies.iter_mut().map(|body| &mut body.pins).chain(nets.iter_mut().map(|net| &mut net.pins));
        lists.chain(membranes.iter_mut().map(|membrane| &mut membrane.pins)).nth(source)
    }

    /// Mesh of a body or membrane, by its number in the shown level: bodies first, then nets, which have none, then membranes.
    pub fn mesh_mut(&mut self, part: usize) -> Option<&mut MeshKind> {
        let source = self.source(part);
        let Level { bodies, nets, membranes, .. } = &mut self.level;
        let others = bodies.len() + nets.len();
        match source.checked_sub(others) {
            Some(number) => membranes.get_mut(number).map(|membrane| &mut membrane.mesh),
            None => bodies.get_mut(source).map(|body| &mut body.mesh),
        }
    }

    /// Replaces the pinning rules of a body, net or membrane by vertices.
    pub fn set_pinned(&mut self, owner: Owner, pins: &[u32]) {
        let rules = match owner {
            Owner::Body(number) => {
                let source = self.source(number);
                self.level.bodies.get_mut(source).map(|body| &mut body.pins)
            }
            Owner::Net(number) => self.level.nets.get_mut(number).map(|net| &mut net.pins),
            Owner::Membrane(number) => self.level.membranes.get_mut(number).map(|membrane| &mut membrane.pins),
        };
        if let Some(rules) = rules {
            *rules = pins.iter().copied().map(Pin::Vertex).collect();
        }
    }

    /// Replaces the mesh of a body. Vertices that are pinned by number become pinned by place; `rest` are the old places of the
    /// vertices \[m\].
    pub fn set_mesh(&mut self, body: usize, mesh: MeshKind, rest: &[Point]) {
        let Some(body) = self.level.bodies.get_mut(body) else { return };
        for pin in &mut body.pins {
            if let Pin::Vertex(vertex) = *pin {
                *pin = rest.get(vertex as usize).map_or(*pin, |point| Pin::Nearest(*point));
            }
        }
        body.mesh = mesh;
        self.level.state = None;
    }

    /// Frees all vertices.
    pub fn clear_pins(&mut self) {
        self.level.bodies.iter_mut().for_each(|body| body.pins.clear());
        self.level.nets.iter_mut().for_each(|net| net.pins.clear());
        self.level.membranes.iter_mut().for_each(|membrane| membrane.pins.clear());
    }

    /// Switches all damping effects. It adds one if there is none, unless the level has a toy.
    pub fn set_damping(&mut self, on: bool) {
        let switch = if on { Switch::default() } else { Switch::Off };
        let mut damping = self.level.effects.iter_mut().filter(|listed| listed.effect.kind().is_damping()).peekable();
        if damping.peek().is_none() && on {
            drop(damping);
            if self.level.toy.is_some() {
                return;
            }
            let effect = crate::effects::EffectKind::Rayleigh(crate::effects::Rayleigh::default());
            self.level.effects.push(EffectLevel { effect, switch, when: When::Always });
        } else {
            damping.for_each(|listed| listed.switch = switch);
        }
    }
}

fn moved(point: Point, by: f64) -> Point {
    let [x, y] = point.get();
    Point::new([x + by, y]).unwrap_or(point)
}
