//! `gingerbread break`: searches for random runs of a level that go wrong.

use super::{Ending, HeadlessError, Interrupt, Outputs, ProgressOptions, read, start, thread_count};
use crate::clock::Instant;
use crate::{
    files::{self, FileError},
    guard::Guard,
    hard::{Search, random::Variation},
    level::Level,
    link,
    study::{Progress, StudyError, threads},
    terminal,
};
use std::{
    fmt::Write as _,
    path::{Path, PathBuf},
};

/// What to search, and for how long.
#[derive(Clone, Debug, clap::Args)]
pub struct BreakRequest {
    /// A level file, or the name of a built-in level.
    pub level: PathBuf,
    /// How long to search, in minutes.
    #[arg(long, default_value_t = 1.0, value_parser = minutes, allow_negative_numbers = true)]
    pub minutes: f64,
    /// Seed of the random variations.
    #[arg(long, default_value_t = 1)]
    pub seed: u32,
    /// Number of the first random variation.
    #[arg(long, default_value_t = 0)]
    pub first: u32,
    /// Save the least level of each run that went wrong in this folder, as `LEVEL_NUMBER.ron`.
    #[arg(long, value_name = "FOLDER")]
    pub save: Option<PathBuf>,
    /// Number of runs at a time; as many as there are cores if not given.
    #[arg(long, value_parser = thread_count)]
    pub threads: Option<usize>,
    /// How progress is shown.
    #[command(flatten)]
    pub progress_options: ProgressOptions,
}

fn minutes(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "expected a number of minutes".to_owned())?;
    if value > 0.0 && value <= 1e6 {
        Ok(value)
    } else {
        Err("expected minutes, greater than 0 and at most 1e6".to_owned())
    }
}

/// Runs random variations of a level for some time, and makes the level of each run that went wrong as small as it can. Ends with 1 if there are any.
///
/// # Errors
/// [`HeadlessError`] if the level cannot be read or built, or is a toy.
pub fn search(request: &BreakRequest) -> Result<Ending, HeadlessError> {
    let level = read(&request.level)?;
    start(&level, &request.level)?;
    let file = request.level.display().to_string();
    if level.toy.is_some() {
        let why = StudyError::NotHere("a toy has nothing that could be varied");
        return Err(HeadlessError::Study { file, why });
    }
    if let Some(folder) = &request.save {
        std::fs::create_dir_all(folder).map_err(|error| access(folder, &error.to_string()))?;
    }
    let is_link = request.level.to_str().and_then(link::level).is_some();
    let name = if is_link { Some("link".as_ref()) } else { request.level.file_stem() };
    let name = name.unwrap_or_default().to_string_lossy().into_owned();
    Interrupt::watch();
    let threads = request.threads.unwrap_or_else(threads);
    let mut search = Search::new(&name, &level, (request.seed, request.first), threads);
    let (begin, whole) = (Instant::now(), 60.0 * request.minutes);
    super::study::with_progress(&request.progress_options, |budget| {
        search.advance(budget);
        let done = begin.elapsed().as_secs_f64() / whole;
        Ok(Progress { done: done.min(1.0), finished: done >= 1.0 })
    })
    .map_err(|why| HeadlessError::Study { file: file.clone(), why })?;
    let [ended, stopped, refused] = search.counts();
    let mut text = format!(
        "{}: {} runs of {} steps in {:.1} min, seed {}\n{ended:>7} went to the end\n{stopped:>7} stopped with a cause\n{refused:>7} refused before the first step\n\
         {:>7} wrong: energy from nowhere beyond {} times what was put in, surfaces that crossed, not finite, or over {} s",
        terminal::line(&level.name),
        ended + stopped + refused,
        Variation::STEPS,
        begin.elapsed().as_secs_f64() / 60.0,
        request.seed,
        search.found().len(),
        Guard::EXCESS,
        Variation::SECONDS,
    );
    for found in search.found() {
        let Variation { number, model, level, .. } = &found.variation;
        let (model, integrator) = (model.name(), level.integrator.name());
        // Writing to a string cannot fail.
        let _ = write!(text, "\nnumber {number}: {model}, {integrator}: {}", found.wrong);
        if let Some(folder) = &request.save {
            let path = folder.join(format!("{name}_{number}.ron"));
            save(&path, &found.least, &format!("{model}, {integrator}: {}", found.wrong))?;
            let _ = write!(text, "; {}", path.display());
        }
    }
    let code = u8::from(!search.found().is_empty());
    let signal = Interrupt::seen().filter(|_| begin.elapsed().as_secs_f64() < whole);
    Ok(Ending::new(text, Outputs::new(&[], &[])?, code, signal))
}

/// Saves a level that goes wrong, with what is wrong in its description.
fn save(path: &Path, level: &Level, wrong: &str) -> Result<(), HeadlessError> {
    let about = format!("Goes wrong within {} steps: {wrong}.", Variation::STEPS);
    let text = files::text_at(path, &Level { about, ..level.clone() })?;
    std::fs::write(path, text).map_err(|error| access(path, &error.to_string()))
}

fn access(path: &Path, why: &str) -> HeadlessError {
    FileError::Access { file: path.display().to_string(), why: why.to_owned() }.into()
}
