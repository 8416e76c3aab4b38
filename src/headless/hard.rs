//! `gingerbread hard`: the gallery of hard cases as a table.

use super::HeadlessError;
use crate::{
    files,
    hard::{COLUMNS, Case, Entry, Method, Sweep, Trial, row},
    materials::Model,
    study::{StudyError, threads},
};
use std::{fmt::Write as _, path::PathBuf, sync::Arc, time::Duration};

/// Which hard cases to run, with what.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct Hard {
    /// Names of cases, or case files; all that come with the program if none is named.
    pub cases: Vec<PathBuf>,
    /// About how many triangles a case should have, instead of its own.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=200_000))]
    pub triangles: Option<u32>,
    /// How many times as long as its own time a case goes on.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub times: Option<u32>,
    /// Runs the cases that start in an irregular shape from so many of them, and counts how many are held.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub seeds: Option<u32>,
    /// One constitutive model instead of all.
    #[arg(long, value_parser = super::model)]
    pub model: Option<Model>,
    /// One integrator instead of `SymplecticEuler`, `ImplicitEuler` and `Bdf2`.
    #[arg(long, value_parser = method)]
    pub integrator: Option<Method>,
    /// Number of threads; as many as there are if not given.
    #[arg(long, value_parser = super::thread_count)]
    pub threads: Option<usize>,
    /// Write the table here, as CSV.
    #[arg(long, conflicts_with = "seeds")]
    pub csv: Option<PathBuf>,
}

/// What came out of hard cases.
pub struct Hardness {
    /// The table to print.
    pub table: String,
    /// Runs that were not held without a reason in the file of their case.
    pub unexplained: usize,
}

/// Runs hard cases. Shows progress on a terminal.
///
/// # Errors
/// [`HeadlessError`] says what to mend.
pub fn hard(request: &Hard) -> Result<Hardness, HeadlessError> {
    let cases = read(request)?;
    let models = request.model.map_or(Model::ALL.to_vec(), |model| vec![model]);
    let methods = request.integrator.map_or(Method::ALL.to_vec(), |method| vec![method]);
    let seeds: Vec<Option<u32>> = request.seeds.map_or(vec![None], |count| (0..count).map(Some).collect());
    let mut trials = Vec::new();
    for (name, case) in &cases {
        let seeded = |seed: &Option<u32>| seed.map_or_else(|| Some(case.clone()), |seed| case.with_seed(seed));
        let starts: Vec<_> = seeds.iter().filter_map(seeded).map(Arc::new).collect();
        for (&model, &method) in models.iter().flat_map(|model| methods.iter().map(move |method| (model, method))) {
            let trial = |case| Trial { name: name.clone(), case: Arc::clone(case), model, method };
            trials.extend(starts.iter().map(trial));
        }
    }
    let fail = |why| HeadlessError::Study { file: "hard cases".to_owned(), why };
    if trials.is_empty() {
        return Err(fail(StudyError::NotHere("none of these starts from a seed: leave --seeds out")));
    }
    let mut sweep = Sweep::new(trials, request.threads.unwrap_or_else(threads));
    super::study::with_progress(|budget: Duration| Ok(sweep.advance(budget))).map_err(fail)?;
    let mut csv = format!("{COLUMNS}\n");
    for (trial, entry) in sweep.entries() {
        match &entry.verdict {
            Some(Ok(verdict)) => csv += &(row(trial, verdict) + "\n"),
            Some(Err(why)) => {
                return Err(HeadlessError::Level { file: trial.name.clone(), why: why.clone().into() });
            }
            None => {}
        }
    }
    if let Some(path) = &request.csv {
        files::write_text(path, &csv)?;
    }
    let table = if request.seeds.is_some() { counts(&sweep, seeds.len()) } else { lines(&sweep) };
    let unexplained =
        |(trial, entry): &(&Trial, &Entry)| !held(entry) && trial.case.cannot(trial.model, trial.method).is_none();
    // What a file says is about its own seed.
    let unexplained = if request.seeds.is_some() { 0 } else { sweep.entries().filter(unexplained).count() };
    Ok(Hardness { table, unexplained })
}

fn read(request: &Hard) -> Result<Vec<(String, Case)>, HeadlessError> {
    let all = || Case::names().map(PathBuf::from).collect();
    let paths: Vec<PathBuf> = if request.cases.is_empty() { all() } else { request.cases.clone() };
    let mut cases = Vec::new();
    for path in paths {
        let mut case = Case::read(&path)?;
        if let Some(triangles) = request.triangles {
            case = case
                .with_triangles(triangles)
                .map_err(|why| HeadlessError::Study { file: path.display().to_string(), why })?;
        }
        if let Some(times) = request.times {
            case = case.lasting(times).map_err(|_| HeadlessError::Study {
                file: path.display().to_string(),
                why: StudyError::NotHere("it would go on for longer than a simulation can"),
            })?;
        }
        cases.push((path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy().into_owned(), case));
    }
    Ok(cases)
}

fn held(entry: &Entry) -> bool {
    matches!(&entry.verdict, Some(Ok(verdict)) if verdict.held())
}

/// A line for every run.
fn lines(sweep: &Sweep) -> String {
    let widest = sweep.entries().map(|(trial, _)| trial.name.len()).max().unwrap_or(0);
    let mut text = format!("{:<widest$}  {:<17} {:<16}          ms  result", "case", "model", "integrator");
    for (trial, entry) in sweep.entries() {
        let Some(Ok(verdict)) = &entry.verdict else { continue };
        let why = trial.case.cannot(trial.model, trial.method);
        let mark = match (verdict.held(), why) {
            (true, _) => "passed".to_owned(),
            (false, None) => "FAILED".to_owned(),
            (false, Some(why)) => format!("not passed, as expected: {why}"),
        };
        let (name, model, method) = (&trial.name, trial.model.name(), trial.method.name());
        let (ms, decided) = (1e3 * entry.seconds, verdict.decided_by());
        // Writing to a string cannot fail.
        let _ = write!(text, "\n{name:<widest$}  {model:<17} {method:<16} {ms:>11.1}  {mark} ({decided})");
    }
    text
}

/// A line for every case, model and method: how many of so many starts came to their expected end, how many of the others do
/// when they are untangled, and the least and the greatest energy left in those [J].
fn counts(sweep: &Sweep, starts: usize) -> String {
    let mut text =
        format!("{:<12} {:<17} {:<16} passed        by Untangle  energy left [J]", "case", "model", "integrator");
    let entries: Vec<_> = sweep.entries().collect();
    for group in entries.chunks(starts) {
        let Trial { name, model, method, .. } = group[0].0;
        let (model, method) = (model.name(), method.name());
        let opens = |entry: &Entry| matches!(&entry.verdict, Some(Ok(verdict)) if verdict.numbers.opens);
        let count = group.iter().filter(|(_, entry)| held(entry)).count();
        let opened = group.iter().filter(|(_, entry)| !held(entry) && opens(entry)).count();
        let energy = |(_, entry): &(&Trial, &Entry)| match &entry.verdict {
            Some(Ok(verdict)) if !verdict.held() => Some(verdict.numbers.elastic),
            _ => None,
        };
        let left = group.iter().filter_map(energy);
        let (least, most) = left.fold((f64::INFINITY, 0.0), |(least, most), j| (j.min(least), j.max(most)));
        let left = if least <= most { format!("{least:.1e} to {most:.1e}") } else { String::new() };
        let held = format!("{count} of {starts}");
        // Writing to a string cannot fail.
        let _ = write!(text, "\n{name:<12} {model:<17} {method:<16} {held:<13} {opened:<12} {left}");
        text.truncate(text.trim_end().len());
    }
    text
}

fn method(text: &str) -> Result<Method, String> {
    let names = Method::ALL.map(Method::name);
    let known = Method::ALL.into_iter().find(|method| method.name().eq_ignore_ascii_case(text));
    known.ok_or_else(|| format!("expected one of {}", names.join(", ")))
}
