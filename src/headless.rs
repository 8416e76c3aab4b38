//! The program without a window: `run` steps a level and writes what came out, `check` reads files and says what is wrong,
//! `study` tells what accuracy costs, `hard` runs the gallery of hard cases.

mod hard;
mod paces;
mod solves;
mod study;

pub use hard::{Hard, Hardness, hard};
pub use paces::PaceReport;
pub use solves::SolveReport;
pub use study::{Study, study};

use crate::{
    files::{self, FileError},
    level::{Level, RunMode, Switch, When},
    materials::Model,
    report::{EffectCost, Energies},
    sandbox::Refused,
    scene::Scene,
    simulation::Simulation,
    study::{Saving, Savings, threads},
    untangle::{Tangle, untangled},
};
use serde::Serialize;
use std::{
    fmt::Write as _,
    path::{Path, PathBuf},
    time::Duration,
};
use web_time::Instant;

/// What to run and what to write.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct Run {
    /// A level file, or the name of a built-in level.
    pub level: PathBuf,
    /// Simulated time to run [s].
    #[arg(long, conflicts_with = "steps", value_parser = seconds, allow_negative_numbers = true)]
    pub seconds: Option<f64>,
    /// Number of steps to take.
    #[arg(long)]
    pub steps: Option<u64>,
    /// Put bodies that lie over themselves where they are free of folds, before the first step.
    #[arg(long)]
    pub untangle: bool,
    /// Constitutive model for every body, instead of the level's own.
    #[arg(long, value_parser = model)]
    pub model: Option<Model>,
    /// Number of threads for one large body, at most two; as many as there are if not given. The same bits come of any number.
    #[arg(long)]
    pub threads: Option<usize>,
    /// Write the last positions and velocities here, as CSV: vertex,x,y,vx,vy.
    #[arg(long)]
    pub state: Option<PathBuf>,
    /// Write energies, counts and costs here, as JSON.
    #[arg(long)]
    pub report: Option<PathBuf>,
    /// Save the level with its last state here, to go on from.
    #[arg(long)]
    pub save: Option<PathBuf>,
}

/// Why a headless command stopped.
#[derive(Debug, thiserror::Error)]
pub enum HeadlessError {
    /// A file cannot be read or written, or is not a level.
    #[error(transparent)]
    File(#[from] FileError),
    /// A level cannot be built.
    #[error("{file}: {why}")]
    Level {
        /// Name of the file.
        file: String,
        /// What is wrong.
        why: Refused,
    },
    /// A level cannot be studied.
    #[error("{file}: {why}")]
    Study {
        /// Name of the file.
        file: String,
        /// What is wrong, and what to do.
        why: crate::study::StudyError,
    },
    /// The simulation stopped.
    #[error("{0}")]
    Fault(crate::fault::Fault),
}

impl HeadlessError {
    /// 2 for what the user can mend in files and arguments, 1 for a simulation that stopped.
    pub const fn exit_code(&self) -> u8 {
        match self {
            Self::Fault(_) | Self::Study { why: crate::study::StudyError::NoReference { .. }, .. } => 1,
            _ => 2,
        }
    }
}

/// What a run cost and came to; field names are stable.
#[derive(Debug, Serialize)]
pub struct RunReport {
    /// Title of the level.
    pub level: String,
    /// Energies at the end [J].
    pub energy: EnergyReport,
    /// Least det F of all triangles at the end; null if there are none.
    pub min_j: Option<f64>,
    /// Number of triangles with det F <= 0 at the end.
    pub inverted: usize,
    /// Number of vertices at the end whose triangles do not go round them exactly once: folds.
    pub wound: usize,
    /// Number of triangles.
    pub triangles: usize,
    /// Number of vertices.
    pub vertices: usize,
    /// Length of a step [s].
    pub step_seconds: f64,
    /// How each body and net stepped that went at its own pace; empty if all took the same steps.
    pub paces: Vec<PaceReport>,
    /// Steps taken.
    pub steps: u64,
    /// Simulated time at the end [s].
    pub time: f64,
    /// Evaluations of all forces together.
    pub force_evaluations: u64,
    /// Name of the integrator.
    pub integrator: &'static str,
    /// Steps inside the steps; more than `steps` if the integrator controls its error.
    pub inner_steps: u64,
    /// Steps inside the steps taken again, shorter, for their error.
    pub rejected_steps: u64,
    /// What solving equations took.
    #[serde(flatten)]
    pub solves: SolveReport,
    /// Steps that the guard had taken in shorter ones.
    pub guarded_steps: u64,
    /// Steps in which everything slept.
    pub slept_steps: u64,
    /// Attempts at a step that the guard threw away.
    pub retaken_steps: u64,
    /// Time spent stepping [s].
    pub wall_seconds: f64,
    /// Time per triangle and step [ns]; null if there are none.
    pub ns_per_triangle_step: Option<f64>,
    /// What each effect cost.
    pub effects: Vec<EffectReport>,
    /// Fingerprint of the last positions and velocities, equal on every machine.
    pub state_hash: String,
    /// Why the run stopped early, if it did.
    pub fault: Option<String>,
}

impl std::fmt::Display for RunReport {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { level, steps, time, wall_seconds, energy, .. } = self;
        write!(out, "{level}: {steps} steps to {time:.4} s in {wall_seconds:.3} s")?;
        if let Some(each) = self.ns_per_triangle_step {
            write!(out, " ({each:.1} ns per triangle and step)")?;
        }
        write!(out, "; energy {:.6} J", energy.total)?;
        if let Some(min_j) = self.min_j {
            write!(out, ", least J {min_j:.4}")?;
        }
        write!(out, ", state {}", self.state_hash)
    }
}

/// Energies [J].
#[derive(Debug, Serialize)]
pub struct EnergyReport {
    /// Of motion.
    pub kinetic: f64,
    /// Of deformation.
    pub elastic: f64,
    /// Of gravity and springs.
    pub potential: f64,
    /// The sum.
    pub total: f64,
}

/// What one effect cost.
#[derive(Debug, Serialize)]
pub struct EffectReport {
    /// Name of the effect.
    pub name: &'static str,
    /// `On`, `Auto` or `Off`.
    pub switch: Switch,
    /// Time spent in it [s].
    pub seconds: f64,
    /// The same in a frame of 1/60 s of simulated time [ms].
    pub ms_per_frame: f64,
    /// Its share of the time spent in all effects.
    pub share: f64,
    /// Number of calls.
    pub calls: u64,
    /// Elements touched, summed over the calls.
    pub elements: u64,
    /// How often it was passed over.
    pub skipped: u64,
    /// Why it was passed over, if it was when it last could have been called.
    pub reason: Option<&'static str>,
    /// What passing it over saves [ms in a frame], measured beside the run against everything forced, from the start of the
    /// run on; null if it is not there.
    pub saved_ms_per_frame: Option<f64>,
}

/// Runs a level to the end and writes what was asked for. Shows progress on a terminal.
///
/// # Errors
/// [`HeadlessError`]; what could be written has been.
pub fn run(request: &Run) -> Result<RunReport, HeadlessError> {
    let mut level = files::read(&request.level)?;
    if let Some(model) = request.model {
        level.bodies.iter_mut().for_each(|body| body.material = body.material.with_model(model));
    }
    let mut simulation = start(&level, &request.level)?;
    if request.untangle
        && let Some(free) = untangled(simulation.scene(), simulation.state())
    {
        simulation.set_state(free);
    }
    simulation.set_timed(request.report.is_some());
    simulation.set_threads(request.threads.unwrap_or_else(threads));
    let seconds = request.seconds.unwrap_or(2.0);
    let steps = request.steps.unwrap_or_else(|| (seconds / simulation.scene().step).round() as u64);
    let begin = Instant::now();
    step_with_progress(&mut simulation, steps);
    let wall_seconds = begin.elapsed().as_secs_f64();
    let savings = if request.report.is_some() { measured(&level) } else { Vec::new() };
    let report = report(&level, &simulation, wall_seconds, &savings);
    if let Some(path) = &request.state {
        files::write_text(path, &csv(&simulation))?;
    }
    if let Some(path) = &request.report {
        let json = serde_json::to_string_pretty(&report).map_err(|error| access(path, &error))?;
        files::write_text(path, &(json + "\n"))?;
    }
    if let Some(path) = &request.save {
        let state = crate::document::saved(simulation.state());
        files::save(path, &Level { state, ..level })?;
    }
    simulation.fault().cloned().map_or(Ok(report), |fault| Err(HeadlessError::Fault(fault)))
}

/// Reads and builds a level, and says in a line what it is.
///
/// # Errors
/// [`HeadlessError`] with the place of the mistake.
pub fn check(path: &Path) -> Result<String, HeadlessError> {
    let level = files::read(path)?;
    let simulation = start(&level, path)?;
    let scene = simulation.scene();
    let mut line = format!(
        "{}: ok, {}{} vertices, {} pinned",
        path.display(),
        elements(scene),
        scene.rest.len() / 2,
        scene.pins.len()
    );
    for message in &scene.messages {
        // Writing to a string cannot fail.
        let _ = write!(line, "\n  {message}");
    }
    Ok(line)
}

/// How many triangles and springs there are, as far as there are any.
fn elements(scene: &Scene) -> String {
    let springs = scene.nets.iter().map(|net| net.springs.links().len()).sum();
    let mut text = String::new();
    for (count, name) in [(scene.triangles.len(), "triangles"), (springs, "springs")] {
        if count > 0 {
            // Writing to a string cannot fail.
            let _ = write!(text, "{count} {name}, ");
        }
    }
    text
}

fn start(level: &Level, path: &Path) -> Result<Simulation, HeadlessError> {
    let fail = |why| HeadlessError::Level { file: path.display().to_string(), why: Refused::Scene(why) };
    let mode: RunMode = level.mode;
    let scene = Scene::build(level, mode, &files::Disk, None).map_err(fail)?;
    let state = scene.first_state(level.state.as_ref()).map_err(fail)?;
    Ok(Simulation::new(scene, state))
}

fn step_with_progress(simulation: &mut Simulation, steps: u64) {
    let bar = indicatif::ProgressBar::new(steps);
    if let Ok(style) = indicatif::ProgressStyle::with_template("{bar:40} {pos}/{len} steps, {eta} left") {
        bar.set_style(style);
    }
    let mut left = steps;
    while left > 0 && simulation.fault().is_none() {
        let taken = simulation.advance(left.min(200), &mut || true);
        left -= taken;
        bar.inc(taken);
    }
    bar.finish_and_clear();
}

/// What passing effects over saves in the beginning of a run.
fn measured(level: &Level) -> Vec<Saving> {
    const BUDGET: Duration = Duration::from_millis(300);
    let savings = Savings::new(level, &files::Disk).map(|mut savings| {
        savings.advance(BUDGET);
        savings.each()
    });
    // The level was built before, so there is no trouble to tell of.
    savings.unwrap_or_default()
}

/// The effects that are there, elements first, and then what is switched off or for another mode.
fn ledger(level: &Level, simulation: &Simulation, savings: &[Saving]) -> Vec<EffectReport> {
    let frames = 60.0 * simulation.scene().step * simulation.counts().steps as f64;
    let all: f64 = simulation.costs().iter().map(|cost| cost.time.as_secs_f64()).sum();
    let row = |(number, cost): (usize, &EffectCost)| EffectReport {
        name: cost.name,
        switch: if cost.auto { Switch::Auto } else { Switch::On },
        seconds: cost.time.as_secs_f64(),
        ms_per_frame: if frames > 0.0 { 1e3 * cost.time.as_secs_f64() / frames } else { 0.0 },
        share: if all > 0.0 { cost.time.as_secs_f64() / all } else { 0.0 },
        calls: cost.calls,
        elements: cost.elements,
        skipped: cost.skipped,
        reason: cost.idle,
        saved_ms_per_frame: savings.get(number).map(|saving| 1e3 * saving.saved()),
    };
    let there = simulation.costs().iter().enumerate().map(row);
    let absent = level
        .effects
        .iter()
        .filter(|listed| !listed.switch.is_on() || (listed.when == When::Collide && level.mode == RunMode::Simulate));
    let absent = absent.map(|listed| EffectReport {
        switch: Switch::Off,
        saved_ms_per_frame: None,
        ..row((usize::MAX, &EffectCost::none(listed.effect.kind().title(), false)))
    });
    there.chain(absent).collect()
}

fn report(level: &Level, simulation: &Simulation, wall_seconds: f64, savings: &[Saving]) -> RunReport {
    let (scene, state, counts) = (simulation.scene(), simulation.state(), simulation.counts());
    let (min_j, inverted) = simulation.inversion();
    let (triangles, steps) = (scene.triangles.len(), counts.steps);
    RunReport {
        level: level.name.clone(),
        energy: simulation.energies().into(),
        min_j: (triangles > 0).then_some(min_j),
        inverted,
        wound: Tangle::of_all(scene, &state.x).wound,
        triangles,
        vertices: scene.rest.len() / 2,
        step_seconds: scene.step,
        paces: paces::paces(simulation),
        steps,
        time: state.time,
        force_evaluations: counts.force_evaluations,
        integrator: scene.integrator.name(),
        inner_steps: counts.inner_steps,
        rejected_steps: counts.rejected,
        solves: counts.into(),
        guarded_steps: counts.guarded,
        slept_steps: counts.slept,
        retaken_steps: counts.retaken,
        wall_seconds,
        ns_per_triangle_step: (triangles > 0).then(|| wall_seconds * 1e9 / (triangles as f64 * steps.max(1) as f64)),
        effects: ledger(level, simulation, savings),
        state_hash: format!("{:016x}", state.hash()),
        fault: simulation.fault().map(ToString::to_string),
    }
}

/// One line a vertex with 17 significant digits, enough to read back the same bits.
fn csv(simulation: &Simulation) -> String {
    let state = simulation.state();
    let mut text = String::from("vertex,x,y,vx,vy\n");
    for (vertex, (x, v)) in state.x.chunks_exact(2).zip(state.v.chunks_exact(2)).enumerate() {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{vertex},{:.16e},{:.16e},{:.16e},{:.16e}", x[0], x[1], v[0], v[1]);
    }
    text
}

impl From<Energies> for EnergyReport {
    fn from(energies: Energies) -> Self {
        let Energies { kinetic, elastic, potential } = energies;
        Self { kinetic, elastic, potential, total: energies.total() }
    }
}

fn access(path: &Path, error: &dyn std::error::Error) -> FileError {
    FileError::Access { file: path.display().to_string(), why: error.to_string() }
}

fn seconds(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "expected a number of seconds".to_owned())?;
    if value.is_finite() && (0.0..=1e9).contains(&value) {
        Ok(value)
    } else {
        Err("expected seconds in [0, 1e9]".to_owned())
    }
}

fn model(text: &str) -> Result<Model, String> {
    let names: Vec<_> = Model::ALL.iter().map(|model| model.name()).collect();
    let known = Model::ALL.iter().find(|model| model.name().eq_ignore_ascii_case(text));
    known.copied().ok_or_else(|| format!("expected one of {}", names.join(", ")))
}
