//! `gingerbread sweep`: runs every combination of some parameters of a level into one table, which several computers can share; and
//! `gingerbread merge`, which joins their tables.

use super::{Ending, HeadlessError, Interrupt, Outputs, ProgressOptions, read, start, step_count, thread_count};
use crate::{
    files::{self, FileError},
    level::Level,
    link,
    probe::Probe,
    simulation::Simulation,
    study::{Progress, share_partitions, spread, threads},
    table::{Table, remark},
    terminal,
};
use std::{
    path::{Path, PathBuf},
    str::FromStr,
    sync::Mutex,
    time::Duration,
};

/// Most combinations of a sweep.
const MOST_RUNS: usize = 1_000_000;

/// What to run, with what.
#[derive(Clone, Debug, clap::Args)]
pub struct SweepRequest {
    /// A level file, or the name of a built-in level.
    pub level: PathBuf,
    /// A parameter and its values: `--vary young=1e3,1e4,1e5`. Parameters are those of addresses, such as model, integrator, step, young, poisson, gravity and
    /// triangles. Every combination is run; the last parameter changes first.
    #[arg(long, required = true, value_name = "NAME=VALUES")]
    pub vary: Vec<Variation>,
    /// Simulated time of each run \[s\].
    #[arg(long, default_value_t = 2.0, value_parser = super::seconds, allow_negative_numbers = true)]
    pub seconds: f64,
    /// Quantities at the end of each run, separated by commas, as those of `run --csv`; energy, or those of a toy, if not given.
    #[arg(long, value_name = "PROBES", value_delimiter = ',')]
    pub probe: Vec<Probe>,
    /// Runs only the share I of N: those whose number is I - 1 more than a multiple of N. `merge` joins the tables.
    #[arg(long, value_name = "I/N", default_value = "1/1")]
    pub shard: Shard,
    /// Number of runs at a time; as many as there are cores if not given.
    #[arg(long, value_parser = thread_count)]
    pub threads: Option<usize>,
    /// Write the table here.
    #[arg(long, default_value = "-")]
    pub csv: PathBuf,
    /// How progress is shown.
    #[command(flatten)]
    pub progress_options: ProgressOptions,
}

/// Tables of a sweep to join.
#[derive(Clone, Debug, clap::Args)]
pub struct MergeRequest {
    /// Tables of all shares of a sweep, in any order. A run may be in several of them, if it is the same.
    #[arg(required = true)]
    pub tables: Vec<PathBuf>,
    /// Write the joined table here: the bytes are those of a sweep that was not shared.
    #[arg(long, default_value = "-")]
    pub csv: PathBuf,
}

/// A parameter and its values.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Variation {
    name: String,
    values: Vec<String>,
}

impl FromStr for Variation {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let expected = || "expected a parameter and its values, such as young=1e3,1e4".to_owned();
        let (name, values) = text.split_once('=').ok_or_else(expected)?;
        let values: Vec<_> = values.split(',').map(|value| value.trim().to_owned()).collect();
        if name.is_empty() || values.iter().any(String::is_empty) {
            return Err(expected());
        }
        Ok(Self { name: name.to_owned(), values })
    }
}

/// The share I of N runs, I from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    own: usize,
    all: usize,
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = text.split_once('/').and_then(|(own, all)| Some((own.parse().ok()?, all.parse().ok()?)));
        let shard = numbers.map(|(own, all)| Self { own, all }).filter(|shard| (1..=shard.all).contains(&shard.own));
        shard.ok_or_else(|| "expected I/N with I from 1 to N, such as 2/7".to_owned())
    }
}

/// Columns before and after those of the probes, beside the parameters.
const FIRST: &str = "run";
const LAST: [&str; 7] = ["steps", "time", "inner_steps", "force_evaluations", "guarded_steps", "state_hash", "outcome"];

/// Runs the combinations of a share and writes their table. Nothing in it depends on the machine, or on the number of threads.
///
/// # Errors
/// [`HeadlessError`] if a parameter is not known, a value is wrong, or a probe does not suit the level. A combination that cannot be built or stops says so in its row.
pub fn sweep(request: &SweepRequest) -> Result<Ending, HeadlessError> {
    let base = Level { state: None, recorded: None, ..read(&request.level)? };
    let mut outputs = Outputs::new(&[("--csv", Some(&request.csv))], std::slice::from_ref(&request.level))?;
    let counts: Vec<usize> = request.vary.iter().map(|variation| variation.values.len()).collect();
    let count = counts.iter().try_fold(1_usize, |all, own| all.checked_mul(*own)).filter(|all| *all <= MOST_RUNS);
    let refuse = |why: String| HeadlessError::File(FileError::Access { file: "--vary".to_owned(), why });
    let count = count.ok_or_else(|| refuse(format!("expected at most {MOST_RUNS} combinations")))?;
    // Each value alone is checked before the work.
    for variation in &request.vary {
        for value in &variation.values {
            link::set_parameter(&mut base.clone(), &variation.name, value)?;
        }
    }
    let probes = probes(request, &start(&base, &request.level)?).map_err(refuse)?;
    share_partitions(1);
    Interrupt::watch();
    let threads = request.threads.unwrap_or_else(threads);
    let numbers: Vec<usize> = (0..count).filter(|run| run % request.shard.all + 1 == request.shard.own).collect();
    let rows = Mutex::new(Vec::with_capacity(numbers.len()));
    let mut left = numbers.clone();
    super::study::with_progress(&request.progress_options, |_: Duration| {
        let several = left.split_off(left.len().saturating_sub(4 * threads));
        spread(threads, several, |run| {
            let row = row_of(request, &base, (run, &counts), &probes);
            rows.lock().unwrap_or_else(std::sync::PoisonError::into_inner).extend(row);
            Interrupt::seen().is_none()
        });
        let finished = left.is_empty() || Interrupt::seen().is_some();
        Ok(Progress { done: 1.0 - left.len() as f64 / numbers.len().max(1) as f64, finished })
    })
    .map_err(|why| HeadlessError::Study { file: request.level.display().to_string(), why })?;
    let mut rows = rows.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    rows.sort_unstable_by_key(|(run, _): &(usize, Vec<String>)| *run);
    let partial = rows.len() < numbers.len();
    let mut head = remark("sweep", &base.name) + &remark("runs", &count.to_string());
    head += &remark("seconds", &format!("{}", request.seconds));
    if partial {
        head += &remark("partial", &format!("{} of {} runs", rows.len(), numbers.len()));
    }
    let names = request.vary.iter().map(|variation| variation.name.clone());
    let columns = std::iter::once(FIRST.to_owned()).chain(names).chain(probes.1.iter().cloned());
    let columns: Vec<_> = columns.chain(LAST.map(str::to_owned)).collect();
    let mut table = Table::new(head, &columns.iter().map(String::as_str).collect::<Vec<_>>());
    let stopped = rows.iter().filter(|(_, cells)| cells.last().is_some_and(|outcome| outcome != DONE)).count();
    let text = format!("{} of {count} runs, {stopped} of them stopped or could not be built", rows.len());
    for (_, cells) in rows {
        table.row(cells);
    }
    outputs.write("--csv", |_| Ok(table.text()));
    Ok(Ending::new(text, outputs, 0, Interrupt::seen().filter(|_| partial)))
}

/// Outcome of a run that came to its end.
const DONE: &str = "done";

/// The probes and the names of their columns.
fn probes(request: &SweepRequest, simulation: &Simulation) -> Result<(Vec<Probe>, Vec<String>), String> {
    let scene = simulation.scene();
    let usual = [if scene.toy.is_some() { Probe::Numbers } else { Probe::Energy }];
    let probes = if request.probe.is_empty() { usual.to_vec() } else { request.probe.clone() };
    probes.iter().try_for_each(|probe| probe.check(scene))?;
    let columns = probes.iter().flat_map(|probe| probe.columns(scene)).map(|column| column.name).collect();
    Ok((probes, columns))
}

/// Runs one combination; `None` if a signal stopped it.
fn row_of(
    request: &SweepRequest,
    base: &Level,
    (run, counts): (usize, &[usize]),
    (probes, columns): &(Vec<Probe>, Vec<String>),
) -> Option<(usize, Vec<String>)> {
    let mut level = base.clone();
    // The last parameter changes first.
    let mut rest = run;
    let mut places = vec![0; counts.len()];
    for (place, count) in places.iter_mut().zip(counts).rev() {
        (*place, rest) = (rest % count, rest / count);
    }
    let chosen: Vec<_> = request.vary.iter().zip(places).map(|(own, place)| (&own.name, &own.values[place])).collect();
    let mut cells = vec![run.to_string()];
    cells.extend(chosen.iter().map(|(_, value)| (*value).clone()));
    let changed = chosen.iter().try_for_each(|(name, value)| link::set_parameter(&mut level, name, value));
    let started = changed.map_err(HeadlessError::from).and_then(|()| start(&level, &request.level));
    let checked = started.map_err(|error| error.to_string()).and_then(|simulation| {
        probes.iter().try_for_each(|probe| probe.check(simulation.scene())).map(|()| simulation)
    });
    let mut simulation = match checked {
        Ok(simulation) => simulation,
        Err(why) => {
            cells.extend(std::iter::repeat_n(String::new(), columns.len() + LAST.len() - 1));
            cells.push(terminal::line(&why));
            return Some((run, cells));
        }
    };
    let steps = step_count(request.seconds, &simulation);
    simulation.advance(steps, &mut || Interrupt::seen().is_none());
    if simulation.fault().is_none() && simulation.state().steps < steps {
        return None;
    }
    simulation.check_energy();
    // 17 significant digits restore the same bits.
    cells.extend(probes.iter().flat_map(|probe| probe.numbers(&simulation)).map(|number| format!("{number:.16e}")));
    let (state, counts) = (simulation.state(), simulation.counts());
    cells.extend([state.steps.to_string(), format!("{:.16e}", state.time)]);
    cells.extend([counts.inner_steps, counts.force_evaluations, counts.guarded].map(|count| count.to_string()));
    cells.push(format!("{:016x}", state.hash()));
    cells.push(simulation.fault().map_or(DONE.to_owned(), |fault| terminal::line(&fault.to_string())));
    Some((run, cells))
}

/// Joins the tables of the shares of a sweep.
///
/// # Errors
/// [`HeadlessError::File`] if a table is of another sweep, a run differs between two of them, or runs are missing.
pub fn merge(request: &MergeRequest) -> Result<Ending, HeadlessError> {
    let mut outputs = Outputs::new(&[("--csv", Some(&request.csv))], &request.tables)?;
    let fail = |path: &Path, why: String| FileError::Access { file: path.display().to_string(), why };
    let mut head: Option<String> = None;
    let mut rows: Vec<Option<(String, &Path)>> = Vec::new();
    for path in &request.tables {
        let text = files::read_text(path)?;
        let (own, lines) = parts(&text).ok_or_else(|| fail(path, "this is no table of a sweep".to_owned()))?;
        let known = head.get_or_insert_with(|| own.clone());
        if *known != own {
            return Err(fail(path, "this table is of another sweep than the first one".to_owned()).into());
        }
        let count = own.lines().find_map(|line| line.strip_prefix("# runs: ")?.parse::<usize>().ok());
        rows.resize(count.filter(|count| *count <= MOST_RUNS).unwrap_or(0).max(rows.len()), None);
        for line in lines {
            let run = line.split(',').next().and_then(|run| run.parse::<usize>().ok());
            let slot = run.and_then(|run| rows.get_mut(run));
            let slot = slot.ok_or_else(|| fail(path, format!("expected a row of a run, got `{line}`")))?;
            match slot {
                Some((other, first)) if other != line => {
                    let why = format!("run {} differs from that in {}", run.unwrap_or(0), first.display());
                    return Err(fail(path, why).into());
                }
                Some(_) => {}
                None => *slot = Some((line.to_owned(), path)),
            }
        }
    }
    let missing: Vec<_> = (0..rows.len()).filter(|run| rows[*run].is_none()).map(|run| run.to_string()).collect();
    if !missing.is_empty() {
        let some = missing[..missing.len().min(8)].join(", ");
        let more = if missing.len() > 8 { " and others" } else { "" };
        let why = format!("{} of {} runs are in no table: {some}{more}", missing.len(), rows.len());
        return Err(fail(&request.tables[0], why).into());
    }
    let text = format!("{} runs of {} tables", rows.len(), request.tables.len());
    outputs.write("--csv", |_| {
        let rows = rows.iter().flatten().map(|(row, _)| row.clone() + "\n");
        Ok(head.unwrap_or_default() + &rows.collect::<String>())
    });
    Ok(Ending::new(text, outputs, 0, None))
}

/// Head of a table up to its columns, without that it is partial; and its rows.
fn parts(text: &str) -> Option<(String, Vec<&str>)> {
    let mut lines = text.lines();
    let mut head = String::new();
    for line in lines.by_ref() {
        if line.starts_with("# partial:") {
            continue;
        }
        head += line;
        head += "\n";
        if !line.starts_with('#') {
            let is_sweep = head.starts_with("# sweep:") && line.starts_with(&format!("{FIRST},"));
            return is_sweep.then(|| (head, lines.filter(|line| !line.is_empty()).collect()));
        }
    }
    None
}
