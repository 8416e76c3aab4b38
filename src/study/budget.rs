//! Error budget: how far a run moves if one source of error at a time is refined, and what that costs.
//!
//! The level runs as it is, with guard and sleep. Then it runs once for each source: with half of the time step, with four times as many triangles, with contact twice as
//! stiff, without sleep, and without each effect. The relative distance of two runs is
//!
//! ```text
//! sqrt(sum |x_B - x_A|²) / sqrt(sum |x_A - x_start|²)
//! ```
//!
//! over the vertices of the level's own mesh and all frames of 1/60 s. If the error falls as h^p, refining h by 2 moves the run by the share 1 - 2^-p of the error
//! (Richardson, *The Deferred Approach to the Limit*, 1927), so that the error is that distance over 1 - 2^-p. This holds where the distances are small; a run
//! whose motion is chaotic moves by as much for any reason.

use super::{
    Correspondence, Progress, StudyError,
    difference::positions,
    march::{Stopwatch, spread},
    mesh_study::with_triangles,
};
use crate::{
    effects::EffectKind,
    integrators::{Class, Integrator as _, IntegratorKind},
    level::{Level, RunMode, Substeps, Switch, Toggle, When},
    meshes::{Files, NoFiles},
    quantity::SkinModulus,
    scene::Scene,
    simulation::Simulation,
};

/// Order of the error of linear triangles in their size.
const MESH_ORDER: f64 = 2.0;

/// Factor by which the tolerance of an error-controlled scheme is refined.
const TOLERANCE: f64 = 0.1;

/// A source of error, and what came of refining it.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    /// Its name.
    pub name: String,
    /// What was done to it.
    pub change: String,
    /// Relative distance of the run from that of the level as it is; `None` before the run, or if it stopped.
    pub moved: Option<f64>,
    /// Relative error from this source, by the order of its convergence; `None` if none is known.
    pub error: Option<f64>,
    /// Processor time, as a multiple of that of the level as it is.
    pub price: Option<f64>,
    /// Why the run could not be made, or stopped.
    pub trouble: Option<String>,
}

/// A run that is compared.
struct Run {
    source: Source,
    level: Level,
    /// Order by which the error is estimated.
    order: Option<f64>,
    is_over: bool,
}

/// The run of the level as it is.
struct Base {
    scene: Scene,
    /// Positions at the end of each frame \[m\].
    frames: Vec<Vec<f64>>,
    /// Sum of the squares of all displacements from the start \[m²\].
    motion: f64,
    seconds: f64,
}

/// Error budget as a job.
pub struct ErrorBudget {
    runs: Vec<Run>,
    base: Base,
    threads: usize,
}

impl ErrorBudget {
    /// Runs a level as it is for a number of seconds, and prepares the runs that are compared with it.
    ///
    /// # Errors
    /// If the level cannot be built, has a saved state or a toy, or stops, or nothing moves in it.
    pub fn new(level: &Level, files: &dyn Files, seconds: f64, threads: usize) -> Result<Self, StudyError> {
        if level.toy.is_some() {
            return Err(StudyError::NotHere(
                "a toy problem has no mesh and no effects: its errors are in the usual study",
            ));
        }
        // As in other studies, scripted actions are not performed.
        let level = Level { state: None, recorded: None, actions: Vec::new(), ..level.clone() };
        let frames = (60.0 * seconds).round().max(1.0) as usize;
        let scene = Scene::build(&level, level.mode, files, None)?;
        let (positions, seconds) = run(&level, frames, &scene)?;
        let start = &scene.start.x;
        let square = |x: &Vec<f64>| x.iter().zip(start).map(|(x, start)| (x - start) * (x - start)).sum::<f64>();
        let motion = positions.iter().map(square).sum();
        if motion == 0.0 {
            return Err(StudyError::NotHere("nothing moves in this level, so that there is no error"));
        }
        let base = Base { scene, frames: positions, motion, seconds };
        Ok(Self { runs: runs(&level, &base.scene), base, threads })
    }

    /// Makes the next runs, one for each thread.
    pub fn advance(&mut self) -> Progress {
        let base = &self.base;
        let open: Vec<_> = self.runs.iter_mut().filter(|run| !run.is_over).take(self.threads.max(1)).collect();
        spread(self.threads, open, |run: &mut Run| {
            run.compare(base);
            true
        });
        let over = self.runs.iter().filter(|run| run.is_over).count();
        Progress { done: over as f64 / self.runs.len().max(1) as f64, finished: over == self.runs.len() }
    }

    /// The sources of error, first the numerical ones, then the effects.
    pub fn sources(&self) -> impl Iterator<Item = &Source> {
        self.runs.iter().map(|run| &run.source)
    }

    /// Processor time of the level as it is, per second of simulated time \[ms\].
    pub fn ms_per_second(&self) -> f64 {
        1e3 * self.base.seconds * 60.0 / self.base.frames.len() as f64
    }
}

impl Run {
    fn new(name: &str, change: &str, level: Level, order: Option<f64>) -> Self {
        let (name, change) = (name.to_owned(), change.to_owned());
        let source = Source { name, change, moved: None, error: None, price: None, trouble: None };
        Self { source, level, order, is_over: false }
    }

    fn compare(&mut self, base: &Base) {
        self.is_over = true;
        let (frames, seconds) = match run(&self.level, base.frames.len(), &base.scene) {
            Ok(found) => found,
            Err(why) => {
                self.source.trouble = Some(why.to_string());
                return;
            }
        };
        let square = |(a, b): (&Vec<f64>, &Vec<f64>)| a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
        let apart: f64 = base.frames.iter().zip(&frames).map(square).sum();
        let moved = (apart / base.motion).sqrt();
        self.source.moved = Some(moved);
        self.source.error = self.order.map(|order| moved / (1.0 - libm::pow(2.0, -order)));
        self.source.price = Some(seconds / base.seconds.max(super::RESOLUTION.as_secs_f64()));
    }
}

/// Positions at the end of each frame of 1/60 s of the material points at the vertices of the level as it is, and the processor time of stepping \[s\]. Meshes of
/// files are those of that scene.
fn run(level: &Level, frames: usize, own: &Scene) -> Result<(Vec<Vec<f64>>, f64), StudyError> {
    let scene = Scene::build(level, level.mode, &NoFiles, Some(own))?;
    let places = Correspondence::new(own, &scene);
    let mut simulation = Simulation::open(scene, level, level.mode)?;
    let (mut all, mut seconds) = (Vec::with_capacity(frames), 0.0);
    let step = simulation.scene().step;
    for frame in 1..=frames {
        let due = (frame as f64 / (60.0 * step)).round() as u64;
        let stopwatch = Stopwatch::start();
        let left = due.saturating_sub(simulation.state().steps);
        simulation.advance(left, &mut || true);
        seconds += stopwatch.elapsed().as_secs_f64();
        if let Some(fault) = simulation.fault() {
            return Err(StudyError::Stopped(Box::new(fault.clone())));
        }
        let x = positions(simulation.scene(), &simulation.state().x);
        all.push(places.as_ref().map_or_else(|| x.to_vec(), |places| places.seen(&x).into_owned()));
    }
    Ok((all, seconds))
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
        all.push(Run::new("time step", "tolerances of a tenth", level, None));
    } else if let Ok(substeps) = Substeps::new(level.substeps.get().saturating_mul(2)) {
        together.substeps = substeps;
        all.push(Run::new("time step", "half of it", Level { substeps, ..level.clone() }, Some(order)));
    }
    if let Ok(finer) = with_triangles(level, 4.0)
        && finer.bodies != level.bodies
    {
        together.bodies.clone_from(&finer.bodies);
        all.push(Run::new("mesh", "4 times as many triangles", finer, Some(MESH_ORDER)));
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
            all.push(Run::new("contact", "twice as stiff", stiffer, None));
        }
    }
    if level.sleep == Toggle::On {
        together.sleep = Toggle::Off;
        all.push(Run::new("sleep", "off", Level { sleep: Toggle::Off, ..level.clone() }, None));
    }
    if all.len() > 1 {
        all.push(Run::new("all of these", "together", together, None));
    }
    for number in 0..level.effects.len() {
        let listed = &level.effects[number];
        if listed.switch.is_on() && (listed.when == When::Always || level.mode == RunMode::Collide) {
            let mut without = level.clone();
            without.effects[number].switch = Switch::Off;
            all.push(Run::new(&listed.effect.kind().title().to_lowercase(), "left out", without, None));
        }
    }
    all
}
