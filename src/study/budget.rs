//! Error budget: how far a run moves if one source of error at a time is refined, and what that costs.
//!
//! The level runs as it is, with guard and sleep. Then it runs once for each source: with half of the time step, with four times as many triangles,
//! with contact twice as stiff, without sleep, with quadratic elements, and without each effect. The relative distance of two runs is
//!
//! ```text
//! sqrt(sum |x_B - x_A|²) / sqrt(sum |x_A - x_start|²)
//! ```
//!
//! over the vertices of the level's own mesh and all frames of 1/60 s. If the error falls as h^p, refining h by 2 moves the run by the share 1 - 2^-p of the error
//! (Richardson, *The Deferred Approach to the Limit*, 1927), so that the error is that distance over 1 - 2^-p. This holds where the distances are small; a run
//! whose motion is chaotic moves by as much for any reason.

use super::{
    Progress, StudyError,
    difference::positions,
    march::{Deadline, spread},
    other_meshes::{with_elements, with_triangles},
    reference::STILL,
};
use crate::{
    clock::{RESOLUTION, Stopwatch},
    effects::EffectKind,
    elements::ElementKind,
    integrators::{Class, Integrator as _, IntegratorKind},
    level::{Level, RunMode, Sleep, Substeps, Switch, When},
    meshes::{Files, NoFiles},
    quantity::SkinModulus,
    scene::{Correspondence, Scene},
    simulation::Simulation,
};
use std::time::Duration;

/// Order of the error of linear triangles in their size, and of quadratic ones where all bodies have them.
const MESH_ORDERS: [f64; 2] = [2.0, 3.0];

/// Factor by which the tolerance of an error-controlled scheme is refined.
const TOLERANCE: f64 = 0.1;

/// A source of error, and what came of refining it.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    /// Its name.
    pub name: String,
    /// What was done to it.
    pub change: String,
    /// Its kind.
    pub kind: SourceKind,
    /// Relative distance of the run from that of the level as it is; `None` before the run, or if it stopped.
    pub moved: Option<f64>,
    /// Relative error from this source, by the order of its convergence; `None` if none is known.
    pub error: Option<f64>,
    /// Processor time, as a multiple of that of the level as it is.
    pub price: Option<f64>,
    /// Why the run could not be made, or stopped.
    pub trouble: Option<String>,
}

/// Kind of a source of error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SourceKind {
    /// A part of the computation that can be refined.
    Numerical,
    /// All parts of the computation at once.
    Together,
    /// A part that was replaced by a better one, which removes some of the same errors as refining others.
    Replaced,
    /// An effect, which was left out.
    Effect,
}

impl Source {
    /// Distance that refining it moves the run, over the additional price; infinite if it costs nothing.
    pub fn worth(&self) -> Option<f64> {
        let (moved, extra) = (self.moved?, (self.price? - 1.0).max(0.0));
        Some(if moved == 0.0 { 0.0 } else { moved / extra })
    }
}

/// A run that is compared.
struct Run {
    source: Source,
    level: Level,
    /// Order by which the error is estimated.
    order: Option<f64>,
    /// Its frames so far; `None` before it begins.
    march: Option<Box<Frames>>,
    is_over: bool,
}

/// Frames of a level while it runs with guard and sleep.
struct Frames {
    simulation: Simulation,
    /// Material points at the vertices of the level as it is, where the mesh is another.
    places: Option<Correspondence>,
    /// Number of frames to compute.
    count: usize,
    /// Positions at the end of each frame of 1/60 s \[m\].
    all: Vec<Vec<f64>>,
    /// Processor time of stepping \[s\].
    seconds: f64,
}

/// The run of the level as it is.
struct Base {
    scene: Scene,
    /// Number of frames.
    count: usize,
    /// Positions at the end of each \[m\]; empty before its end.
    frames: Vec<Vec<f64>>,
    /// Sum of the squares of all displacements from the start \[m²\].
    motion: f64,
    /// Processor time of stepping \[s\].
    seconds: f64,
}

impl Base {
    /// Whether what moves is round-off.
    fn is_still(&self) -> bool {
        let start = &self.scene.start.x;
        let extent = start.iter().fold(0.0_f64, |greatest, x| greatest.max(x.abs()));
        (self.motion / (self.count * start.len()) as f64).sqrt() <= STILL * extent
    }
}

/// Error budget as a job.
pub struct ErrorBudget {
    name: String,
    runs: Vec<Run>,
    base: Base,
    /// The run of the level as it is, until its end.
    march: Option<Frames>,
    threads: usize,
}

impl ErrorBudget {
    /// Prepares the run of a level as it is for a number of seconds, and the runs that are compared with it.
    ///
    /// # Errors
    /// If the level cannot be built, has a saved state that does not fit, or a toy.
    pub fn new(level: &Level, files: &dyn Files, seconds: f64, threads: usize) -> Result<Self, StudyError> {
        if level.toy.is_some() {
            return Err(StudyError::NotHere(
                "a toy problem has no mesh and no effects: its errors are in the usual study",
            ));
        }
        // As in other studies, scripted actions are not performed.
        let level = Level { state: None, recorded: None, actions: Vec::new(), ..level.clone() };
        let count = (60.0 * seconds).round().max(1.0) as usize;
        let scene = Scene::build(&level, level.mode, files, None)?;
        let march = Some(Frames::new(&level, count, &scene)?);
        let runs = runs(&level, &scene);
        let base = Base { scene, count, frames: Vec::new(), motion: 0.0, seconds: 0.0 };
        Ok(Self { name: level.name, runs, base, march, threads })
    }

    /// Works for about `budget`.
    ///
    /// # Errors
    /// If the level as it is stops, or nothing moves in it.
    pub fn advance(&mut self, budget: Duration) -> Result<Progress, StudyError> {
        let (deadline, all) = (Deadline::after(budget), 1.0 + self.runs.len() as f64);
        if let Some(mut march) = self.march.take() {
            if !march.advance(deadline)? {
                let done = march.done() / all;
                self.march = Some(march);
                return Ok(Progress { done, finished: false });
            }
            let base = &mut self.base;
            (base.frames, base.seconds) = (march.all, march.seconds);
            let start = &base.scene.start.x;
            let square = |x: &Vec<f64>| x.iter().zip(start).map(|(x, start)| (x - start) * (x - start)).sum::<f64>();
            base.motion = base.frames.iter().map(square).sum();
        }
        if self.base.is_still() {
            return Err(StudyError::NotHere("nothing moves in this level, so that there is no error"));
        }
        let base = &self.base;
        let open: Vec<_> = self.runs.iter_mut().filter(|run| !run.is_over).collect();
        spread(self.threads, open, |run: &mut Run| {
            run.advance(base, deadline);
            !deadline.passed()
        });
        let share = |run: &Run| match (run.is_over, &run.march) {
            (true, _) => 1.0,
            (false, Some(frames)) => frames.done(),
            (false, None) => 0.0,
        };
        let done = (1.0 + self.runs.iter().map(share).sum::<f64>()) / all;
        Ok(Progress { done, finished: self.runs.iter().all(|run| run.is_over) })
    }

    /// Name of the level.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Simulated time \[s\].
    pub fn seconds(&self) -> f64 {
        self.base.count as f64 / 60.0
    }

    /// Number of threads.
    pub const fn threads(&self) -> usize {
        self.threads
    }

    /// The sources of error: first those that can be refined, by the distance that their refinement moves the run for its price, then all of
    /// them together, then what is replaced, then the effects, by the distance without them. What is not measured comes last.
    pub fn sources(&self) -> impl Iterator<Item = &Source> {
        let rank = |source: &Source| {
            let moved = source.moved.unwrap_or(-1.0);
            match source.kind {
                SourceKind::Numerical => (0, -source.worth().unwrap_or(-1.0)),
                SourceKind::Together => (1, 0.0),
                SourceKind::Replaced => (2, 0.0),
                SourceKind::Effect => (3, -moved),
            }
        };
        let mut all: Vec<_> = self.runs.iter().map(|run| &run.source).collect();
        all.sort_by(|a, b| rank(a).0.cmp(&rank(b).0).then(rank(a).1.total_cmp(&rank(b).1)));
        all.into_iter()
    }

    /// Processor time of the level as it is, per second of simulated time \[ms\]; `None` before its run is over.
    pub fn ms_per_second(&self) -> Option<f64> {
        (self.base.motion > 0.0).then(|| 1e3 * self.base.seconds / self.seconds())
    }
}

impl Run {
    fn new(name: &str, change: &str, kind: SourceKind, level: Level, order: Option<f64>) -> Self {
        let (name, change) = (name.to_owned(), change.to_owned());
        let source = Source { name, change, kind, moved: None, error: None, price: None, trouble: None };
        Self { source, level, order, march: None, is_over: false }
    }

    /// Computes frames until the deadline, and compares them at the end.
    fn advance(&mut self, base: &Base, deadline: Deadline) {
        let march = match self.march.take() {
            Some(march) => Ok(march),
            None => Frames::new(&self.level, base.count, &base.scene).map(Box::new),
        };
        let done = march.and_then(|mut march| Ok((march.advance(deadline)?, march)));
        match done {
            Ok((false, march)) => self.march = Some(march),
            Ok((true, march)) => self.compare(base, &march),
            Err(why) => (self.source.trouble, self.is_over) = (Some(why.to_string()), true),
        }
    }

    fn compare(&mut self, base: &Base, frames: &Frames) {
        self.is_over = true;
        let square = |(a, b): (&Vec<f64>, &Vec<f64>)| a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
        let apart: f64 = base.frames.iter().zip(&frames.all).map(square).sum();
        let moved = (apart / base.motion).sqrt();
        self.source.moved = Some(moved);
        self.source.error = self.order.map(|order| moved / (1.0 - libm::pow(2.0, -order)));
        self.source.price = Some(frames.seconds / base.seconds.max(RESOLUTION.as_secs_f64()));
    }
}

impl Frames {
    /// Prepares the run of a level. Meshes of files are those of the scene of the level as it is.
    fn new(level: &Level, count: usize, own: &Scene) -> Result<Self, StudyError> {
        let scene = Scene::build(level, level.mode, &NoFiles, Some(own))?;
        let places = Correspondence::new(own, &scene);
        let simulation = Simulation::open(scene, level, level.mode)?;
        Ok(Self { simulation, places, count, all: Vec::with_capacity(count), seconds: 0.0 })
    }

    /// Share of the frames computed.
    fn done(&self) -> f64 {
        self.all.len() as f64 / self.count as f64
    }

    /// Computes frames until the deadline. Returns whether all are there.
    fn advance(&mut self, deadline: Deadline) -> Result<bool, StudyError> {
        let step = self.simulation.scene().step;
        while self.all.len() < self.count {
            let due = ((self.all.len() + 1) as f64 / (60.0 * step)).round() as u64;
            let stopwatch = Stopwatch::start();
            let left = due.saturating_sub(self.simulation.state().steps);
            self.simulation.advance(left, &mut || !deadline.passed());
            self.seconds += stopwatch.elapsed().as_secs_f64();
            if let Some(fault) = self.simulation.fault() {
                return Err(StudyError::Stopped(Box::new(fault.clone())));
            }
            if self.simulation.state().steps < due {
                return Ok(false);
            }
            let x = positions(self.simulation.scene(), &self.simulation.state().x);
            self.all.push(self.places.as_ref().map_or_else(|| x.to_vec(), |places| places.seen(&x).into_owned()));
        }
        Ok(true)
    }
}

/// The runs that are compared with a level.
fn runs(level: &Level, scene: &Scene) -> Vec<Run> {
    let mut all = Vec::new();
    let mut together = level.clone();
    let order = f64::from(scene.integrator.kind().order());
    if scene.integrator.kind().class() == Class::ErrorControlled {
        if let IntegratorKind::DormandPrince(own) = &mut together.integrator {
            for tolerance in own.parameters() {
                let _ = tolerance.set(TOLERANCE * tolerance.get());
            }
        }
        let level = Level { integrator: together.integrator.clone(), ..level.clone() };
        all.push(Run::new("time step", "tolerances of a tenth", SourceKind::Numerical, level, None));
    } else if let Ok(substeps) = Substeps::new(level.substeps.get().saturating_mul(2)) {
        together.substeps = substeps;
        all.push(Run::new(
            "time step",
            "half of it",
            SourceKind::Numerical,
            Level { substeps, ..level.clone() },
            Some(order),
        ));
    }
    if let Ok(finer) = with_triangles(level, 4.0)
        && finer.bodies != level.bodies
    {
        together.bodies.clone_from(&finer.bodies);
        let [linear, quadratic] = MESH_ORDERS;
        let is_quadratic = level.bodies.iter().all(|body| body.element == ElementKind::Quadratic);
        let order = if is_quadratic { quadratic } else { linear };
        all.push(Run::new("mesh", "4 times as many triangles", SourceKind::Numerical, finer, Some(order)));
    }
    let stiffened = |listed: &EffectKind| match listed {
        EffectKind::Contact(own) => SkinModulus::new(2.0 * own.modulus.get()).ok(),
        _ => None,
    };
    for number in 0..level.effects.len() {
        if let Some(modulus) = stiffened(&level.effects[number].effect) {
            let mut stiffer = level.clone();
            for level in [&mut stiffer, &mut together] {
                if let EffectKind::Contact(own) = &mut level.effects[number].effect {
                    own.modulus = modulus;
                }
            }
            all.push(Run::new("contact", "twice as stiff", SourceKind::Numerical, stiffer, None));
        }
    }
    if level.sleep != Sleep::Off {
        together.sleep = Sleep::Off;
        all.push(Run::new("sleep", "off", SourceKind::Numerical, Level { sleep: Sleep::Off, ..level.clone() }, None));
    }
    if all.len() > 1 {
        all.push(Run::new("all of these", "together", SourceKind::Together, together, None));
    }
    if let Ok(quadratic) = with_elements(level, Some(ElementKind::Quadratic), 1.0)
        && level.bodies.iter().any(|body| body.element != ElementKind::Quadratic)
    {
        all.push(Run::new("elements", "quadratic ones", SourceKind::Replaced, quadratic, None));
    }
    for number in 0..level.effects.len() {
        let listed = &level.effects[number];
        if listed.switch.is_on() && (listed.when == When::Always || level.mode == RunMode::Collide) {
            let mut without = level.clone();
            without.effects[number].switch = Switch::Off;
            all.push(Run::new(
                &listed.effect.kind().title().to_lowercase(),
                "left out",
                SourceKind::Effect,
                without,
                None,
            ));
        }
    }
    all
}
