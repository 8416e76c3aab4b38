//! The program without a window: `run` steps a level and writes what came out, `check` reads files and says what is wrong,
//! `study` tells what accuracy costs, `hard` runs the gallery of hard cases.

mod hard;
mod paces;
mod report;
mod study;

pub use hard::{Hard, Hardness, hard};
pub use paces::PaceReport;
pub use report::{EffectReport, EnergyReport, RunReport};
pub use study::{Study, study};

use crate::{
    files::{self, FileError},
    hard::Case,
    level::{Level, RunMode},
    materials::Model,
    sandbox::Refused,
    scene::Scene,
    simulation::Simulation,
    study::threads,
    untangle::untangled,
};
use std::{
    fmt::Write as _,
    path::{Path, PathBuf},
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
    #[arg(long, value_parser = thread_count)]
    pub threads: Option<usize>,
    /// Write the last positions and velocities here, as CSV: vertex,x,y,vx,vy.
    #[arg(long)]
    pub state: Option<PathBuf>,
    /// Write energies, counts and costs here, as JSON. What each effect takes is measured in a second run of the same steps, because
    /// clocks slow it down; all other times are those of the first, without clocks.
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

/// Runs a level to the end and writes what was asked for. Shows progress on a terminal.
///
/// # Errors
/// [`HeadlessError`]; what could be written has been.
pub fn run(request: &Run) -> Result<RunReport, HeadlessError> {
    let mut level = files::read(&request.level)?;
    if level.bodies.is_empty() && (request.model.is_some() || request.untangle) {
        let why = Refused::NotHere("there is no body here to be of another material or to be untangled");
        return Err(HeadlessError::Level { file: request.level.display().to_string(), why });
    }
    if let Some(model) = request.model {
        level.bodies.iter_mut().for_each(|body| body.material = body.material.with_model(model));
    }
    let mut simulation = prepared(request, &level)?;
    simulation.set_threads(request.threads.unwrap_or_else(threads));
    let seconds = request.seconds.unwrap_or(2.0);
    let steps = request.steps.unwrap_or_else(|| (seconds / simulation.scene().step).round() as u64);
    let begin = Instant::now();
    step_with_progress(&mut simulation, steps);
    let wall_seconds = begin.elapsed().as_secs_f64();
    let mut report = RunReport::new(&level, &simulation, wall_seconds);
    if request.report.is_some() {
        let mut timed = prepared(request, &level)?;
        timed.set_timed(true);
        step_with_progress(&mut timed, steps);
        report.set_effects(&level, &timed);
    }
    if let Some(path) = &request.state {
        files::write_text(path, &csv(&simulation))?;
    }
    if let Some(path) = &request.report {
        let json = serde_json::to_string_pretty(&report).map_err(|error| access(path, &error))?;
        files::write_text(path, &(json + "\n"))?;
    }
    if let Some(path) = &request.save {
        let state = crate::document::saved(&simulation.scene().listed_state(simulation.state()));
        files::save(path, &Level { state, pulled: simulation.scripted_pull(), ..level })?;
    }
    simulation.fault().cloned().map_or(Ok(report), |fault| Err(HeadlessError::Fault(fault)))
}

/// Reads and builds a level, and says in a line what it is.
///
/// # Errors
/// [`HeadlessError`] with the place of the mistake.
pub fn check(path: &Path) -> Result<String, HeadlessError> {
    let level = files::read(path)?;
    if path.is_file() && files::is_case(&files::read_text(path)?) {
        Case::read(path)?;
    }
    let simulation = start(&level, path)?;
    let scene = simulation.scene();
    let mut line = format!(
        "{}: ok, {}{} vertices, {} pinned",
        path.display(),
        elements(scene),
        scene.rest.len() / 2,
        scene.pins.len()
    );
    let inside = simulation.count_inside();
    let pushed_out = (inside > 0).then(|| match inside {
        1 => "1 vertex begins inside a wall or beyond the world: it is pushed out slowly, if there is a way".to_owned(),
        many => format!(
            "{many} vertices begin inside walls or beyond the world: they are pushed out slowly, if there is a way"
        ),
    });
    for message in scene.messages.iter().chain(&pushed_out) {
        // Writing to a string cannot fail.
        let _ = write!(line, "\n  {message}");
    }
    Ok(line)
}

/// Reads a level and makes sure that it can be built.
///
/// # Errors
/// [`HeadlessError`] with the place of the mistake.
pub fn open(path: &Path) -> Result<Level, HeadlessError> {
    let level = files::read(path)?;
    start(&level, path)?;
    Ok(level)
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
    let mut simulation = Simulation::new(scene, state);
    simulation.follow(level, mode, level.pulled);
    Ok(simulation)
}

/// The simulation that is asked for, before its first step.
fn prepared(request: &Run, level: &Level) -> Result<Simulation, HeadlessError> {
    let mut simulation = start(level, &request.level)?;
    if request.untangle
        && let Some(free) = untangled(simulation.scene(), simulation.state())
    {
        simulation.set_state(free);
    }
    Ok(simulation)
}

fn step_with_progress(simulation: &mut Simulation, steps: u64) {
    let bar = indicatif::ProgressBar::new(steps);
    if let Ok(style) = indicatif::ProgressStyle::with_template("{bar:40} {pos}/{len} steps, {eta} left") {
        bar.set_style(style);
    }
    let (mut left, piece) = (steps, steps.div_ceil(100).max(200));
    while left > 0 && simulation.fault().is_none() {
        let taken = simulation.advance(left.min(piece), &mut || true);
        left -= taken;
        bar.inc(taken);
    }
    bar.finish_and_clear();
}

/// One line a vertex with 17 significant digits, enough to read back the same bits.
fn csv(simulation: &Simulation) -> String {
    let (scene, state) = (simulation.scene(), simulation.state());
    let (x, v) = (scene.listed(&state.x), scene.listed(&state.v));
    let mut text = String::from("vertex,x,y,vx,vy\n");
    for (vertex, (x, v)) in x.chunks_exact(2).zip(v.chunks_exact(2)).enumerate() {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{vertex},{:.16e},{:.16e},{:.16e},{:.16e}", x[0], x[1], v[0], v[1]);
    }
    text
}

fn access(path: &Path, error: &dyn std::error::Error) -> FileError {
    FileError::Access { file: path.display().to_string(), why: error.to_string() }
}

/// A number of threads.
fn thread_count(text: &str) -> Result<usize, String> {
    let count = text.parse().ok().filter(|count| (1..=1024).contains(count));
    count.ok_or_else(|| "expected a number of threads in [1, 1024]".to_owned())
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
