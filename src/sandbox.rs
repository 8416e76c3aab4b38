//! Sandbox: the document, its running simulation and the history of edits.
//!
//! ```
//! use gingerbread::{command::{Command, Mode}, files, levels, meshes::NoFiles, sandbox::Sandbox};
//!
//! let level = files::parse(levels::built_in("gingerbread").ok_or("there is no such level")?, "gingerbread.ron")?;
//! let mut sandbox = Sandbox::new(level, Box::new(NoFiles))?;
//! sandbox.apply(Command::SetMode(Mode::Simulate))?;
//! sandbox.advance(10, &mut || true);
//! assert_eq!(sandbox.simulation().state().steps, 10);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod arrange;
mod drawn_path;
mod edit;
mod notes;
mod recording;
mod refine;
mod wind;

use crate::{
    command::{Command, Mode},
    document::{Document, Gesture, History},
    effects::Grab,
    impulse::Impulse,
    inversion_recovery::untangled,
    level::{Level, RunMode},
    materials::BadMaterial,
    meshes::Files,
    quantity::Point,
    rewind::Rewind,
    scene::{Body, Owner, Scene, SceneError, extent},
    simulation::{PlacedCheck, Restart, Simulation},
};
use recording::Recording;
pub use refine::MeshChange;
use std::{collections::VecDeque, rc::Rc, sync::Arc};

/// A level that is edited and run.
pub struct Sandbox {
    pub(crate) document: Document,
    pub(crate) history: History,
    pub(crate) simulation: Simulation,
    pub(crate) mode: Mode,
    pub(crate) running: bool,
    /// Counts scenes whose vertices or rest shapes differ.
    pub(crate) generation: u64,
    /// The level that is simulated, shared with snapshots.
    pub(crate) shown: Arc<Level>,
    files: Rc<dyn Files>,
    rewind: Rewind,
    /// Bodies with large meshes that are not shown, the latest last.
    shelf: VecDeque<Body>,
    recording: Option<Recording>,
    mesh_change: Option<MeshChange>,
}

/// Meshes with more triangles than this are cached, because they take long to make.
const LARGE: usize = 5000;

/// Number of cached bodies.
const SHELVED: usize = 3;

/// Reason for refusing a command; nothing has changed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Refused {
    /// The resulting level cannot be built.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The material is not possible for a body.
    #[error(transparent)]
    Material(#[from] BadMaterial),
    /// The command does not fit the present document.
    #[error("{0}")]
    NotHere(&'static str),
}

/// Effect of a change of the document on positions and velocities.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Then {
    /// Positions and velocities stay.
    Keep,
    /// Positions and velocities are reset to the saved state of the level, or to the start.
    Restart,
    /// Like [`Self::Restart`], and files are read again.
    Reload,
    /// Positions and velocities go over to other meshes of the same shapes.
    Carry,
}

impl Sandbox {
    /// Starts with a level, in edit mode.
    ///
    /// # Errors
    /// If the level cannot be built.
    pub fn new(level: Level, files: Box<dyn Files>) -> Result<Self, Refused> {
        let scene = Scene::build(&level, level.mode, files.as_ref(), None)?;
        let simulation = Simulation::open(scene, &level, level.mode)?;
        let shown = Arc::new(without_state(&level));
        let document = Document::new(level);
        let (history, files) = (History::default(), Rc::from(files));
        Ok(Self {
            document,
            history,
            simulation,
            mode: Mode::Edit,
            running: false,
            generation: 1,
            shown,
            files,
            rewind: Rewind::default(),
            shelf: VecDeque::new(),
            recording: None,
            mesh_change: None,
        })
    }

    /// Copies the sandbox with its state and history. The copy is independent.
    #[must_use]
    pub fn fork(&self) -> Self {
        let mut simulation = Simulation::new(self.simulation.scene().clone(), self.simulation.state().clone());
        simulation.follow(&self.shown, self.effect_mode(&self.document));
        simulation.resume(&self.simulation.restart());
        Self {
            document: self.document.clone(),
            history: self.history.clone(),
            simulation,
            shown: Arc::clone(&self.shown),
            files: Rc::clone(&self.files),
            rewind: Rewind::default(),
            shelf: VecDeque::new(),
            ..*self
        }
    }

    /// Continues from restart data of the same scene; the pull stays, unless scripted actions set it.
    pub(crate) fn resume(&mut self, moment: &Restart) {
        let grab = self.simulation.grab();
        self.simulation.resume(moment);
        if !self.simulation.is_scripted() {
            self.simulation.set_grab(grab);
        }
    }

    /// Resets positions and velocities to the start, without undo.
    pub(crate) fn start_over(&mut self) {
        let start = self.simulation.scene().start.clone();
        self.resume(&Restart::from(start));
        self.simulation.follow(&self.shown, self.effect_mode(&self.document));
        self.begin_anew();
    }

    /// Adds a mesh from a background job to the cache.
    #[cfg(feature = "window")]
    pub(crate) fn prepare(&mut self, body: Body) {
        self.shelve([body]);
    }

    /// Caches bodies with large meshes, so that undo and redo need not generate them again.
    fn shelve(&mut self, bodies: impl IntoIterator<Item = Body>) {
        for body in bodies.into_iter().filter(|body| body.mesh.triangles().len() > LARGE) {
            self.shelf.retain(|known| known.recipe() != body.recipe());
            self.shelf.push_back(body);
        }
        while self.shelf.len() > SHELVED {
            self.shelf.pop_front();
        }
    }

    /// The present scene with all cached meshes, if a level needs one of them.
    fn with_shelved(&self, level: &Level) -> Option<Scene> {
        let scene = self.simulation.scene();
        let wanted = |body: &&Body| level.bodies.iter().any(|listed| listed.mesh == *body.recipe());
        let found: Vec<_> = self.shelf.iter().filter(wanted).cloned().collect();
        (!found.is_empty()).then(|| {
            let mut scene = scene.clone();
            scene.bodies.extend(found);
            scene
        })
    }

    /// Clears all data of the previous scene.
    fn begin_anew(&mut self) {
        self.rewind.clear();
        self.simulation.count_anew();
    }

    /// Applies a command at once.
    ///
    /// # Errors
    /// [`Refused`] if it cannot be done; nothing has changed then.
    pub fn apply(&mut self, command: Command) -> Result<(), Refused> {
        if self.is_recording() {
            if command.is_recorded() {
                return self.record(&command);
            }
            if !command.is_of_time() {
                self.end_recording();
            }
        }
        match command {
            Command::Record(true) => self.begin_recording()?,
            Command::Record(false) => {}
            Command::SetMode(mode) => self.set_mode(mode)?,
            Command::SetRunning(running) => self.set_running(running)?,
            Command::StepOnce => self.step(1)?,
            Command::StepFrame => self.step(self.simulation.scene().steps_per_frame())?,
            Command::Reset => {
                if *self.simulation.state() != self.simulation.scene().start {
                    // The run is recorded for undo.
                    self.history.record(self.document.clone(), Some(self.simulation.restart()), None);
                }
                self.start_over();
            }
            Command::Rewind(seconds) => self.turn_back(seconds)?,
            Command::Untangle => {
                let free = untangled(self.simulation.scene(), self.simulation.state());
                self.rewind.keep(&self.simulation);
                let free = free.ok_or(Refused::NotHere("no body overlaps itself: there is nothing to untangle"))?;
                self.simulation.forget_recording();
                self.resume(&Restart::from(free));
            }
            Command::Grab(vertex, target) => self.grab(vertex, target)?,
            Command::Pull(target) => {
                if let Some(Grab { vertex, .. }) = self.simulation.grab() {
                    self.grab(vertex, target)?;
                }
            }
            Command::Release => self.simulation.set_grab(None),
            Command::Impulse(impulse) => self.give(&impulse)?,
            Command::Undo => self.travel(false)?,
            Command::Redo => self.travel(true)?,
            Command::EndGesture => self.history.end_gesture(),
            Command::Refine(triangles) => self.refine(&triangles)?,
            Command::RefineWorst => self.refine_worst()?,
            Command::Open(level) => {
                let before = std::mem::replace(&mut self.mode, Mode::Edit);
                self.change(Document::new(*level), Then::Reload, None).inspect_err(|_| self.mode = before)?;
                self.running = false;
            }
            edit => self.edit(edit)?,
        }
        Ok(())
    }

    fn change(&mut self, document: Document, then: Then, gesture: Option<Gesture>) -> Result<(), Refused> {
        let before = self.document.clone();
        let replaced = (then != Then::Keep).then(|| self.simulation.restart());
        self.show(document, then, None)?;
        self.history.record(before, replaced, gesture);
        Ok(())
    }

    fn travel(&mut self, forth: bool) -> Result<(), Refused> {
        let Some((document, state)) = self.history.next(forth).cloned() else { return Ok(()) };
        let then = if state.is_some() { Then::Restart } else { Then::Keep };
        let (before, replaced) = (self.document.clone(), state.is_some().then(|| self.simulation.restart()));
        self.show(document, then, state)?;
        self.history.went(forth, before, replaced);
        Ok(())
    }

    /// Shows a document. If it cannot be built, nothing changes.
    fn show(&mut self, document: Document, then: Then, moment: Option<Restart>) -> Result<(), Refused> {
        let shown = without_state(&document.shown());
        // Notes are no part of the scene.
        if then == Then::Keep && *self.shown == (Level { notes: self.shown.notes.clone(), ..shown.clone() }) {
            (self.shown, self.document) = (Arc::new(shown), document);
            return Ok(());
        }
        let shelved = self.with_shelved(&shown);
        let known = (then != Then::Reload).then(|| shelved.as_ref().unwrap_or(self.simulation.scene()));
        let scene = Scene::build(&shown, self.effect_mode(&document), self.files.as_ref(), known)?;
        PlacedCheck::all(&shown, &scene)?;
        let same =
            self.shown.bodies.len() == shown.bodies.len()
                && self.simulation.scene().rest == scene.rest
                && self.shown.toy == shown.toy
                && self.shown.bodies.iter().zip(&shown.bodies).all(|(a, b)| {
                    a.mesh == b.mesh && a.place == b.place && (then == Then::Keep || a.stretch == b.stretch)
                });
        let mode = self.effect_mode(&document);
        if then != Then::Keep || !same {
            let carried = if then == Then::Carry { self.carried(&scene).map(Restart::from) } else { None };
            let before = carried.as_ref().map(|_| self.measured_mesh());
            let moment = match moment.or(carried) {
                Some(moment) if moment.state.x.len() == scene.start.x.len() => moment,
                _ => Restart::read(&scene, document.level.state.as_ref())?,
            };
            self.shelve(self.simulation.scene().bodies.clone());
            self.simulation.follow_nothing();
            self.simulation.replace_scene(scene);
            self.simulation.follow(&shown, mode);
            self.simulation.resume(&moment);
            if !self.simulation.is_scripted() {
                self.simulation.set_grab(None);
            }
            self.begin_anew();
            self.generation += 1;
            let after = self.measured_mesh();
            self.mesh_change = before.map(|before| MeshChange {
                triangles: [before.0, after.0],
                energies: [before.1, after.1],
                momentum: [before.2, after.2],
            });
        } else {
            self.simulation.replace_scene(scene);
            self.simulation.follow(&shown, mode);
        }
        self.shown = Arc::new(shown);
        self.document = document;
        Ok(())
    }

    /// Least and greatest x of the first body at rest \[m\].
    fn sides(&self) -> [f64; 2] {
        let scene = self.simulation.scene();
        scene.bodies.first().map_or([0.0; 2], |body| extent(&scene.rest[scene.numbers(&body.vertices)], 0).into())
    }

    fn effect_mode(&self, document: &Document) -> RunMode {
        match self.mode {
            Mode::Edit => document.level.mode,
            Mode::Simulate => RunMode::Simulate,
            Mode::Collide => RunMode::Collide,
        }
    }

    fn set_mode(&mut self, mode: Mode) -> Result<(), Refused> {
        let before = std::mem::replace(&mut self.mode, mode);
        let effect_mode = self.effect_mode(&self.document);
        match Scene::build(&self.shown, effect_mode, self.files.as_ref(), Some(self.simulation.scene())) {
            Ok(scene) => {
                self.simulation.replace_scene(scene);
                self.simulation.follow(&self.shown, effect_mode);
                if mode == Mode::Edit {
                    self.simulation.set_grab(None);
                }
                self.running = mode != Mode::Edit && (self.running || before == Mode::Edit);
                Ok(())
            }
            Err(error) => {
                self.mode = before;
                Err(error.into())
            }
        }
    }

    fn set_running(&mut self, running: bool) -> Result<(), Refused> {
        if running && self.mode == Mode::Edit {
            self.set_mode(self.document.level.mode.into())?;
        }
        self.running = running && self.mode != Mode::Edit;
        Ok(())
    }

    fn step(&mut self, steps: u64) -> Result<(), Refused> {
        self.set_running(true)?;
        self.running = false;
        self.rewind.keep(&self.simulation);
        self.simulation.advance(steps, &mut || true);
        Ok(())
    }

    /// Rewinds and pauses.
    fn turn_back(&mut self, seconds: f64) -> Result<(), Refused> {
        let now = self.simulation.state().time;
        let length = self.simulation.state().x.len();
        let Some(moment) = self.rewind.back(now, seconds).filter(|moment| moment.state.x.len() == length) else {
            return Err(Refused::NotHere("there is nothing to go back to yet: let time run first"));
        };
        self.resume(&moment);
        self.running = false;
        Ok(())
    }

    fn grab(&mut self, vertex: usize, target: [f64; 3]) -> Result<(), Refused> {
        self.check_grab(vertex, target)?;
        self.simulation.forget_recording();
        self.simulation.set_grab(Some(Grab { vertex, target }));
        Ok(())
    }

    fn check_grab(&self, vertex: usize, target: [f64; 3]) -> Result<(), Refused> {
        if self.mode == Mode::Edit {
            return Err(Refused::NotHere("nothing can be pulled in edit mode; press M or T to let time run"));
        }
        if vertex >= self.simulation.scene().vertices() || !target.iter().all(|coordinate| coordinate.is_finite()) {
            return Err(Refused::NotHere("there is no such vertex or point to pull"));
        }
        Ok(())
    }

    fn give(&mut self, impulse: &Impulse) -> Result<(), Refused> {
        self.check_impulse(impulse)?;
        self.rewind.keep(&self.simulation);
        self.simulation.forget_recording();
        self.simulation.give(impulse);
        Ok(())
    }

    fn check_impulse(&self, impulse: &Impulse) -> Result<(), Refused> {
        if self.mode == Mode::Edit {
            return Err(Refused::NotHere("nothing can be pushed in edit mode; press M or T to let time run"));
        }
        if self.simulation.scene().toy.is_some() || !impulse.is_valid() {
            return Err(Refused::NotHere("there is nothing here that can be pushed"));
        }
        Ok(())
    }

    /// Pinned vertices of a shown body or net, by their number in its level, ascending.
    fn pins_of(&self, owner: Owner) -> Vec<u32> {
        let scene = self.simulation.scene();
        let owned = scene.pins.iter().filter_map(|pin| scene.owner_of(*pin as usize));
        let mut own: Vec<_> = owned.filter(|(other, _)| *other == owner).map(|(_, number)| number as u32).collect();
        own.sort_unstable();
        own
    }

    /// Rest positions of a shown body's vertices \[m\], in the order of the level and at the place of the document's body.
    fn rest_points(&self, body: usize) -> Vec<Point> {
        let scene = self.simulation.scene();
        let source = self.document.level.bodies.get(self.document.source(body));
        let (Some(shown), Some(listed), Some(source)) = (scene.bodies.get(body), self.shown.bodies.get(body), source)
        else {
            return Vec::new();
        };
        let ([x, y], [from_x, from_y]) = (source.place.offset.get(), listed.place.offset.get());
        let rest = scene.listed(&scene.rest);
        let rest = rest[scene.numbers(&shown.vertices)].as_chunks().0.iter();
        rest.map_while(|[at, up]| Point::new([at + x - from_x, up + y - from_y]).ok()).collect()
    }

    /// The document: the level, and how a test level is shown.
    pub const fn document(&self) -> &Document {
        &self.document
    }

    /// Length of a step \[s\].
    pub const fn step_length(&self) -> f64 {
        self.simulation.scene().step
    }

    /// The running simulation.
    pub const fn simulation(&self) -> &Simulation {
        &self.simulation
    }

    /// See [`Simulation::set_measured`].
    pub fn set_measured(&mut self, measured: bool) {
        self.simulation.set_measured(measured);
    }

    /// Whether time runs: running, not in edit mode, no fault.
    pub const fn is_live(&self) -> bool {
        self.running && self.simulation.fault().is_none()
    }

    /// Whether there is anything to compute: time runs, and not everything sleeps or a scripted action is expected.
    pub const fn is_busy(&self) -> bool {
        self.is_live() && (!self.simulation.is_asleep() || self.simulation.expects_actions())
    }

    /// Takes up to `steps` steps and returns their number; `more` is called every few steps and returns whether to
    /// continue. A failed step leaves the last finite state and a fault in the snapshot.
    pub fn advance(&mut self, steps: u64, more: &mut dyn FnMut() -> bool) -> u64 {
        if !self.is_live() {
            return 0;
        }
        // The start of every frame is recorded, so that a fault can be rewound.
        let per_frame = (Rewind::FRAME / self.step_length()).round().max(1.0) as u64;
        let mut taken = 0;
        while taken < steps && self.is_live() && (taken == 0 || more()) {
            self.rewind.keep(&self.simulation);
            let wanted = per_frame.min(steps - taken);
            let done = self.simulation.advance(wanted, more);
            taken += done;
            if done < wanted {
                break;
            }
        }
        taken
    }

    /// The moments of the rewind buffer, the oldest first, up to the present.
    pub fn recorded(&self) -> impl Iterator<Item = &Restart> {
        let now = self.simulation.state().time;
        self.rewind.moments().filter(move |moment| moment.state.time <= now)
    }

    /// Length of the rewind buffer \[s\].
    pub fn rewind_length(&self) -> f64 {
        self.rewind.length(self.simulation.state().time)
    }

    /// Whether any damping is switched on.
    pub fn damping(&self) -> bool {
        let mut damping = self.document.level.effects.iter().filter(|listed| listed.effect.kind().is_damping());
        damping.any(|listed| listed.switch.is_on())
    }

    /// Whether any wind is switched on.
    pub fn wind(&self) -> bool {
        self.document.level.effects.iter().any(|listed| wind::is_wind(listed) && listed.switch.is_on())
    }

    /// The document with the current state and mode in it, for saving. The rest shapes stay as they are.
    pub fn saved(&self) -> Level {
        let mode = self.effect_mode(&self.document);
        Level { mode, state: self.simulation.saved(), ..Level::clone(&self.shown) }
    }
}

fn without_state(level: &Level) -> Level {
    Level { state: None, ..level.clone() }
}
