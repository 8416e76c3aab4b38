//! Command line without a window.
//!
//! `run` steps a level and writes results. `check` reads files and reports errors. `study` measures accuracy and
//! cost. `hard` runs the hard cases. `break` searches for runs of a level that go
//! wrong.

mod ending;
mod frames;
mod hard;
mod overrides;
mod progress;
mod report;
mod search;
mod series;
mod study;
mod sweep;

pub use ending::{EXIT_CODES, Ending, Outputs};
pub use frames::Frames;
pub use hard::{Hard, hard};
pub use overrides::Overrides;
pub use progress::{Interrupt, PER_CENT, Progress, ProgressOptions};
pub use report::{
    Beginning, EffectReport, EndState, EnergyReport, GREATEST_GAIN, GREATEST_J, RunReport, SubstepReport,
};
pub use search::{BreakRequest, search};
pub use series::{Recording, Series};
pub use study::{Study, study};
pub use sweep::{MergeRequest, SweepRequest, merge, sweep};

use crate::clock::Instant;
use crate::{
    archive::States,
    files::{self, FileError},
    hard::Case,
    inversion_recovery::untangled,
    level::{Level, RecordedEnd, RunMode},
    levels, link,
    probe::Probe,
    sandbox::Refused,
    scene::Scene,
    simulation::Simulation,
    study::{share_partitions, threads},
    table::{Table, remark},
    terminal,
};
use std::{
    fmt::Write as _,
    path::{Path, PathBuf},
    time::Duration,
};

/// What to run and what to write.
#[derive(Clone, Debug, Default, clap::Args)]
#[command(group(clap::ArgGroup::new("recording").multiple(true)))]
pub struct RunRequest {
    /// A level file, or the name of a built-in level.
    pub level: PathBuf,
    /// Simulated time to run \[s\]; if not given, to the end of the recording if the level has one; otherwise 2, or as long as its known results take.
    #[arg(long, conflicts_with = "steps", value_parser = seconds, allow_negative_numbers = true)]
    pub seconds: Option<f64>,
    /// Number of steps to take.
    #[arg(long)]
    pub steps: Option<u64>,
    /// Put bodies that lie over themselves where they are free of folds, before the first step.
    #[arg(long)]
    pub untangle: bool,
    /// Settings that replace the level's own.
    #[command(flatten)]
    pub overrides: Overrides,
    /// Number of threads that share large bodies; as many as there are cores if not given. The same bits come of any number.
    #[arg(long, value_parser = thread_count)]
    pub threads: Option<usize>,
    /// Write the last positions and velocities here, as CSV: vertex,x,y,vx,vy. Of a toy: time, its two numbers and the exact ones.
    #[arg(long)]
    pub state: Option<PathBuf>,
    /// Write energies, counts and costs here, as JSON. What each effect takes is measured in a second run of the same steps, because
    /// clocks slow it down; all other times are those of the first, without clocks.
    #[arg(long)]
    pub report: Option<PathBuf>,
    /// Write quantities over time here, as CSV.
    #[arg(long, group = "recording")]
    pub csv: Option<PathBuf>,
    /// Quantities over time, separated by commas: energy, momentum, `min_j`, reaction, vertex:NUMBER, forces:NUMBER, triangle:NUMBER, and of a
    /// toy its numbers; energy, or those of a toy, if not given.
    #[arg(long, value_name = "PROBES", value_delimiter = ',', requires = "csv")]
    pub probe: Vec<Probe>,
    /// Simulated time between two rows of them, or between two states \[s\]; 1/60 if not given.
    #[arg(long, value_name = "SECONDS", requires = "recording", value_parser = interval, allow_negative_numbers = true)]
    pub every: Option<f64>,
    /// Write states over time here for `ParaView`: a collection (.pvd), and beside it a file (.vtu) for each.
    #[arg(long, value_name = "FILE.pvd", group = "recording")]
    pub vtk: Option<PathBuf>,
    /// Write states over time here for `NumPy`: an archive (.npz) of times, positions, velocities, energies, triangles and springs.
    #[arg(long, value_name = "FILE.npz", group = "recording")]
    pub npz: Option<PathBuf>,
    /// Save the level with its last state here, to go on from.
    #[arg(long)]
    pub save: Option<PathBuf>,
    /// How progress is shown.
    #[command(flatten)]
    pub progress_options: ProgressOptions,
}

/// Error of a headless command.
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
        /// Reason.
        why: Refused,
    },
    /// A level cannot be studied.
    #[error("{file}: {why}")]
    Study {
        /// Name of the file.
        file: String,
        /// Reason and remedy.
        why: crate::study::StudyError,
    },
    /// The simulation stopped.
    #[error("{0}")]
    Fault(crate::fault::Fault),
}

impl HeadlessError {
    /// Exit code: 2 for errors in files and arguments, 1 for a simulation that stopped.
    pub const fn exit_code(&self) -> u8 {
        match self {
            Self::Fault(_) | Self::Study { why: crate::study::StudyError::NoReference { .. }, .. } => 1,
            _ => 2,
        }
    }
}

/// Runs a level and writes the requested outputs. Shows progress. A signal stops the run early.
///
/// # Errors
/// [`HeadlessError`] if the run cannot begin. Later failures are reported in the [`Ending`]; all other outputs are
/// written.
pub fn run(request: &RunRequest) -> Result<Ending, HeadlessError> {
    let mut level = read(&request.level)?;
    let options = [
        ("--state", &request.state),
        ("--report", &request.report),
        ("--csv", &request.csv),
        ("--vtk", &request.vtk),
        ("--npz", &request.npz),
        ("--save", &request.save),
    ]
    .map(|(option, path)| (option, path.as_ref()));
    let mut outputs = Outputs::new(&options, &inputs(&request.level, &level))?;
    if level.bodies.is_empty() && request.untangle {
        let why = Refused::NotHere("there is no body here to be untangled");
        return Err(HeadlessError::Level { file: request.level.display().to_string(), why });
    }
    request.overrides.apply(&mut level, &request.level)?;
    let mut simulation = prepared(request, &level)?;
    let warnings = simulation.scene().warnings(simulation.state());
    ending::warn(&request.level.display().to_string(), &warnings);
    Interrupt::watch();
    let beginning = Beginning::of(&simulation);
    share_partitions(request.threads.unwrap_or_else(threads));
    let asked = request.steps.or(request.seconds.map(|seconds| step_count(seconds, &simulation)));
    let known = || simulation.steps_to_last_check().unwrap_or(0).max(step_count(2.0, &simulation));
    let steps = asked.or_else(|| simulation.steps_to_end()).unwrap_or_else(known);
    let mut recording = recording(request, &simulation)?;
    let begin = Instant::now();
    step_with_progress(&request.progress_options, &mut simulation, (steps, "steps"), recording.as_mut());
    let wall_seconds = begin.elapsed().as_secs_f64();
    let mut report = RunReport::new(&level, &simulation, wall_seconds);
    (report.warnings, report.end_state) = (warnings, EndState::of(&beginning, &simulation));
    let stopped = |taken: u64| Interrupt::seen().filter(|_| taken < steps);
    let taken = simulation.counts().steps;
    report.partial = stopped(taken).map(|signal| format!("stopped by {signal} after {taken} of {steps} steps"));
    if outputs.path("--report").is_some() && report.partial.is_none() {
        let mut timed = prepared(request, &level)?;
        timed.set_measured(true);
        step_with_progress(
            &request.progress_options,
            &mut timed,
            (steps, "steps of the second run, which measures effects,"),
            None,
        );
        match stopped(timed.counts().steps) {
            None => report.set_effects(&level, &timed),
            Some(signal) => {
                report.partial = Some(format!("stopped by {signal} while the time of each effect was measured"));
            }
        }
    }
    outputs.write("--state", |_| {
        let head = report.partial.as_ref().map_or(String::new(), |partial| remark("partial", partial));
        Ok(csv(&simulation, head))
    });
    if let Some(Recording { series, frames, states, .. }) = recording {
        let head = report.partial.as_ref().map_or(String::new(), |partial| remark("partial", partial));
        if let Some(series) = series {
            outputs.write("--csv", |_| Ok(series.text(head)));
        }
        if let Some(frames) = frames {
            outputs.write("--vtk", |_| frames.text());
        }
        if let Some(states) = states {
            outputs.write("--npz", |_| states.bytes());
        }
    }
    outputs.write("--report", |_| {
        serde_json::to_string_pretty(&report).map(|json| json + "\n").map_err(|error| error.to_string())
    });
    outputs.write("--save", |path| {
        let state = Some(simulation.saved().ok_or("the state is not finite, so there is nothing to continue from")?);
        files::text_at(path, &Level { state, ..level.clone() }).map_err(|error| error.to_string())
    });
    let code = match simulation.fault() {
        Some(_) => 1,
        None if !report.end_state.physical => 3,
        None if report.replayed == Some(false) => 4,
        None if report.checks.iter().any(|check| check.met == Some(false)) => 5,
        None => 0,
    };
    let stopped = Interrupt::seen().filter(|_| report.partial.is_some());
    let mut ending = Ending::new(report.to_string(), outputs, code, stopped);
    let partial = report.partial.as_ref().map(|partial| format!("the results are partial: {partial}"));
    let told = [simulation.fault().map(ToString::to_string), report.end_state.sentence(), partial];
    ending.remarks.splice(0..0, told.into_iter().flatten());
    Ok(ending)
}

/// Reads a level from a file, by its name, or from a link.
///
/// # Errors
/// [`HeadlessError::File`]. If there is no such file, it lists the names of built-in levels.
pub fn read(path: &Path) -> Result<Level, HeadlessError> {
    if let Some(level) = path.to_str().and_then(link::level) {
        return Ok(level?);
    }
    let names = levels::BUILT_IN.iter().chain(levels::HARD).map(|(file, _)| *file);
    files::read(path).map_err(|error| missing(path, error, "level", names))
}

/// Reads a level and runs it from its start. The result has the state that this comes to as the end of a recording.
///
/// # Errors
/// [`HeadlessError`] if the level cannot be read or built, or stops.
pub fn recorded(path: &Path, seconds: f64) -> Result<Level, HeadlessError> {
    let level = Level { state: None, recorded: None, ..read(path)? };
    let mut simulation = start(&level, path)?;
    share_partitions(threads());
    let steps = step_count(seconds, &simulation);
    simulation.advance(steps, &mut || true);
    match simulation.fault() {
        Some(fault) => Err(HeadlessError::Fault(fault.clone())),
        None => Ok(Level { recorded: Some(RecordedEnd::new(simulation.state())), ..level }),
    }
}

/// Error of reading a file. If the file is missing, it names the built-in ones.
fn missing<'a>(path: &Path, error: FileError, kind: &str, names: impl Iterator<Item = &'a str>) -> HeadlessError {
    let absent = std::fs::metadata(path).is_err_and(|error| error.kind() == std::io::ErrorKind::NotFound);
    if !matches!(error, FileError::Access { .. }) || !absent || path == Path::new("-") {
        return error.into();
    }
    let names: Vec<_> = names.map(|file| file.strip_suffix(".ron").unwrap_or(file)).collect();
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let bare = path.components().count() == 1;
    let why = if bare && path.extension().is_none() {
        format!("there is no such file, and no built-in {kind} of that name; those are: {}", names.join(", "))
    } else if names.contains(&stem.as_ref()) {
        format!("there is no such file; the built-in {kind} is called {stem}")
    } else {
        "there is no such file".to_owned()
    };
    FileError::Access { file: path.display().to_string(), why }.into()
}

/// Files that a level is read from.
pub(crate) fn inputs(path: &Path, level: &Level) -> Vec<PathBuf> {
    let mut inputs = files::mesh_paths(level);
    inputs.push(path.to_path_buf());
    inputs
}

/// Reads and builds a level. Returns a description in one line.
///
/// # Errors
/// [`HeadlessError`] with the place of the mistake.
pub fn check(path: &Path) -> Result<String, HeadlessError> {
    let level = read(path)?;
    if path.is_file() && files::is_case(&files::read_text(path)?) {
        Case::read(path)?;
    }
    let simulation = start(&level, path)?;
    let scene = simulation.scene();
    let mut line = format!(
        "{}: ok, {}{} vertices, {} pinned",
        path.display(),
        elements(scene),
        scene.vertices(),
        scene.pins.len()
    );
    line = terminal::line(&line);
    for message in scene.warnings(simulation.state()) {
        // Writing to a string cannot fail.
        let _ = write!(line, "\n  {}", terminal::line(&message));
    }
    Ok(line)
}

/// Reads a level and checks that it can be built.
///
/// # Errors
/// [`HeadlessError`] with the place of the mistake.
pub fn open(path: &Path) -> Result<Level, HeadlessError> {
    let level = read(path)?;
    start(&level, path)?;
    Ok(level)
}

/// Numbers of triangles and springs as text; counts of zero are left out.
fn elements(scene: &Scene) -> String {
    let springs = scene.nets.iter().map(|net| net.springs.links().len()).sum();
    let mut text = String::new();
    let membranes: usize = scene.membranes.iter().map(|membrane| membrane.elements.corners().len()).sum();
    for (count, name) in [(scene.triangles.len() + membranes, "triangles"), (springs, "springs")] {
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
    Simulation::open(scene, level, mode).map_err(fail)
}

/// Number of steps in a time \[s\].
fn step_count(seconds: f64, simulation: &Simulation) -> u64 {
    (seconds / simulation.scene().step).round() as u64
}

/// Requested simulation before its first step.
fn prepared(request: &RunRequest, level: &Level) -> Result<Simulation, HeadlessError> {
    let mut simulation = start(level, &request.level)?;
    if request.untangle
        && let Some(free) = untangled(simulation.scene(), simulation.state())
    {
        simulation.set_state(free);
    }
    Ok(simulation)
}

/// What is recorded over time, with the first row, if something is.
fn recording(request: &RunRequest, simulation: &Simulation) -> Result<Option<Recording>, HeadlessError> {
    let refuse =
        |option: &str, path: &Path, why| FileError::Access { file: format!("{option} {}", path.display()), why };
    let series = |path: &PathBuf| {
        let usual = [if simulation.scene().toy.is_some() { Probe::Numbers } else { Probe::Energy }];
        let probes = if request.probe.is_empty() { &usual[..] } else { &request.probe };
        Series::new(probes, simulation).map_err(|why| refuse("--csv", path, why))
    };
    let frames = |path: &PathBuf| Frames::new(path, simulation.scene()).map_err(|why| refuse("--vtk", path, why));
    let states = |path: &PathBuf| {
        let is_archive = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("npz"));
        let named = if is_archive { Ok(()) } else { Err("the name of the archive must end in .npz".to_owned()) };
        named.and_then(|()| States::new(simulation.scene())).map_err(|why| refuse("--npz", path, why))
    };
    let texts = (request.csv.as_ref().map(series).transpose()?, request.vtk.as_ref().map(frames).transpose()?);
    let states = request.npz.as_ref().map(states).transpose()?;
    Ok(Recording::new(texts, states, request.every.unwrap_or(1.0 / 60.0)).begin(simulation))
}

/// Steps as many times as wanted, or less often if a fault or a signal occurs, and adds rows to a recording.
fn step_with_progress(
    progress_options: &ProgressOptions,
    simulation: &mut Simulation,
    (steps, unit): (u64, &'static str),
    mut recording: Option<&mut Recording>,
) {
    // Time between two checks for a signal and two updates of the bar. Slow steps are taken one by one.
    const POLL_INTERVAL: Duration = Duration::from_millis(200);
    let progress = Progress::new(progress_options, steps, unit);
    let most = steps.div_ceil(100).max(200);
    let (mut taken, mut piece) = (0, 1);
    while taken < steps && simulation.fault().is_none() && Interrupt::seen().is_none() {
        let begin = Instant::now();
        let to_row = recording.as_ref().map_or(u64::MAX, |recording| recording.steps_to_row(simulation));
        let asked = piece.min(steps - taken).min(to_row);
        let done = simulation.advance(asked, &mut || Interrupt::seen().is_none());
        if let Some(recording) = recording.as_mut().filter(|_| done == to_row) {
            recording.record(simulation);
        }
        taken += done;
        progress.set(taken);
        if begin.elapsed() > POLL_INTERVAL {
            piece = (piece / 2).max(1);
        } else if begin.elapsed() < POLL_INTERVAL / 4 {
            piece = (10 * piece).min(most);
        }
    }
    simulation.check_energy();
}

/// Final state as CSV: one row per vertex with 17 significant digits, which restore the same bits. A toy has one row.
fn csv(simulation: &Simulation, head: String) -> String {
    let (scene, state) = (simulation.scene(), simulation.state());
    let digits = |number: f64| format!("{number:.16e}");
    if let Some(toy) = &scene.toy {
        let toy = toy.kind();
        let [a, b] = toy.columns();
        let exact = toy.exact(state.time);
        let mut table = Table::new(head, &["time_s", a, b, &format!("exact_{a}"), &format!("exact_{b}")]);
        table.row([state.time].iter().chain(&state.x).chain(&exact).map(|number| digits(*number)));
        return table.text();
    }
    let columns: &[&str] = if scene.dimension == 3 {
        &["vertex", "x", "y", "z", "vx", "vy", "vz"]
    } else {
        &["vertex", "x", "y", "vx", "vy"]
    };
    let mut table = Table::new(head, columns);
    let (x, v) = (scene.listed(&state.x), scene.listed(&state.v));
    for (vertex, (x, v)) in x.chunks_exact(scene.dimension).zip(v.chunks_exact(scene.dimension)).enumerate() {
        table.row(std::iter::once(vertex.to_string()).chain(x.iter().chain(v).map(|number| digits(*number))));
    }
    table.text()
}

/// Parses a number of threads.
fn thread_count(text: &str) -> Result<usize, String> {
    let count = text.parse().ok().filter(|count| (1..=1024).contains(count));
    count.ok_or_else(|| "expected a number of threads in [1, 1024]".to_owned())
}

/// Parses the time between two rows of a table.
fn interval(text: &str) -> Result<f64, String> {
    let value = text.parse().ok().filter(|value: &f64| *value > 0.0 && *value <= 1e9);
    value.ok_or_else(|| "expected more than 0 and at most 1e9 seconds".to_owned())
}

/// Parses a simulated time \[s\].
///
/// # Errors
/// If it is not in range.
pub fn seconds(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "expected a number of seconds".to_owned())?;
    if value.is_finite() && (0.0..=1e9).contains(&value) {
        Ok(value)
    } else {
        Err("expected at least 0 and at most 1e9 seconds".to_owned())
    }
}
