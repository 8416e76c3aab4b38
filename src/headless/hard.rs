//! `gingerbread hard`: runs hard cases and prints a table.

use super::{Ending, HeadlessError, Interrupt, Outputs, ProgressOptions, ending};
use crate::{
    guard::Guard,
    hard::{
        ACCURATE, COLUMNS, Case, Entry, Experiment, Failure, Method, Sweep, Trial, Verdict,
        random::{Outcome, Variation},
        row,
    },
    levels,
    materials::{MaterialParameters, Model, TypedEnergy},
    meshes::NoFiles,
    scene::Scene,
    study::{Deadline, Progress, StudyError, spread, threads},
    table::remark,
    terminal,
};
use std::{fmt::Write as _, path::PathBuf, str::FromStr as _, sync::Arc, time::Duration};

/// Which undamped twins to run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Twins {
    /// Cases and their undamped twins.
    #[default]
    Both,
    /// Undamped twins only.
    Only,
    /// Cases only.
    None,
}

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
    #[arg(long, value_parser = Model::from_str)]
    pub model: Option<Model>,
    /// A typed energy instead of all models: a formula of I1 and J [J/m²] that knows mu, lambda, E and nu of the materials of the cases.
    #[arg(long, value_name = "FORMULA", value_parser = energy, conflicts_with = "model")]
    pub energy: Option<Arc<TypedEnergy>>,
    /// One integrator instead of all.
    #[arg(long, value_parser = method)]
    pub integrator: Option<Method>,
    /// Undamped twins of the cases, beside the cases or alone.
    #[arg(long, value_enum, default_value_t = Twins::Both)]
    pub twins: Twins,
    /// No comparison with reference motions, which takes most of the time.
    #[arg(long)]
    pub no_reference: bool,
    /// Looks for the cause of every run that is not stable, by experiments.
    #[arg(long)]
    pub experiments: bool,
    /// Runs so many random variations of the built-in levels instead, with all integrators and models, for 100 steps each.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..), conflicts_with_all = ["cases", "csv", "seeds", "triangles", "times", "model", "energy", "integrator", "twins", "no_reference", "experiments"])]
    pub random: Option<u32>,
    /// Random scenes of contact instead of variations of the built-in levels: bodies and cloth that fly at each other and at moving obstacles.
    #[arg(long, requires = "random")]
    pub contact: bool,
    /// Seed of the random variations.
    #[arg(long, default_value_t = 1, requires = "random")]
    pub seed: u32,
    /// Number of the first random variation.
    #[arg(long, default_value_t = 0, requires = "random")]
    pub first: u32,
    /// Number of threads; as many as there are if not given.
    #[arg(long, value_parser = super::thread_count)]
    pub threads: Option<usize>,
    /// Write the table here, as CSV.
    #[arg(long, conflicts_with = "seeds")]
    pub csv: Option<PathBuf>,
    /// How progress is shown.
    #[command(flatten)]
    pub progress_options: ProgressOptions,
}

/// Runs hard cases or random variations and writes the table. Shows progress. A signal stops the runs early.
///
/// # Errors
/// [`HeadlessError`] with the cause and the remedy.
pub fn hard(request: &Hard) -> Result<Ending, HeadlessError> {
    if let Some(count) = request.random {
        return random(request, count);
    }
    let cases: Vec<_> =
        read(request)?.into_iter().map(|(name, case)| (name, case.with_energy(request.energy.clone()))).collect();
    let mut outputs = Outputs::new(&[("--csv", request.csv.as_ref())], &request.cases)?;
    let model = request.model.or_else(|| request.energy.as_ref().map(|_| Case::TYPED));
    let models = model.map_or(Model::ALL.to_vec(), |model| vec![model]);
    let methods = request.integrator.map_or(Method::ALL.to_vec(), |method| vec![method]);
    let seeds: Vec<Option<u32>> = request.seeds.map_or(vec![None], |count| (0..count).map(Some).collect());
    let mut trials = Vec::new();
    let twins = cases.iter().flat_map(|(name, case)| {
        let own = (request.twins != Twins::Only).then(|| case.clone());
        let twin = (request.twins != Twins::None).then(|| case.undamped_twin()).flatten();
        own.into_iter().chain(twin).map(move |case| (name, case))
    });
    for (name, case) in twins {
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
    for (name, case) in &cases {
        // A case that cannot be built is reported at the end, with the results of the others.
        let warnings = Scene::build(&case.level, case.level.mode, &NoFiles, None).and_then(|scene| {
            let start = scene.first_state(case.level.state.as_ref())?;
            Ok(scene.warnings(&start))
        });
        ending::warn(name, &warnings.unwrap_or_default());
    }
    Interrupt::watch();
    let threads = request.threads.unwrap_or_else(threads);
    let mut sweep = Sweep::new(trials, threads, !request.no_reference && request.seeds.is_none());
    let done = super::study::with_progress(&request.progress_options, |budget: Duration| Ok(sweep.advance(budget)))
        .map_err(fail)?;
    let mut explanations = Explanations::default();
    if request.experiments && done >= 1.0 {
        explanations = Explanations::new(&sweep, threads);
        super::study::with_progress(&request.progress_options, |budget| Ok(explanations.advance(budget)))
            .map_err(fail)?;
    }
    let stopped = Interrupt::seen().filter(|_| done < 1.0);
    let partial = stopped.map(|signal| format!("stopped by {signal} at about {:.1} % of the work", 100.0 * done));
    outputs.write("--csv", |_| Ok(csv(&sweep, &explanations, partial.as_deref())));
    let mut table = if request.seeds.is_some() { counts(&sweep, seeds.len()) } else { lines(&sweep, &explanations) };
    if let Some(partial) = &partial {
        // Writing to a string cannot fail.
        let _ = write!(table, "\n\nPartial: {partial}.");
    }
    let unexplained = |(trial, entry): &(&Trial, &Entry)| {
        matches!(&entry.verdict, Some(Ok(verdict)) if !verdict.is_stable())
            && trial.case.cannot(trial.model, trial.method).is_none()
    };
    // The entries `cannot` of a case file hold for its own seed only.
    let unexplained = request.seeds.is_none() && sweep.entries().any(|entry| unexplained(&entry));
    let refused = |(trial, entry): (&Trial, &Entry)| match &entry.verdict {
        Some(Err(why)) => Some(format!("{}: {why}", trial.name)),
        _ => None,
    };
    let mut refused: Vec<_> = sweep.entries().filter_map(refused).collect();
    refused.dedup();
    let code = if refused.is_empty() { u8::from(unexplained) } else { 2 };
    let mut ending = Ending::new(table, outputs, code, stopped);
    ending.remarks.extend(refused);
    ending.remarks.extend(partial.map(|partial| format!("the results are partial: {partial}")));
    Ok(ending)
}

/// Runs random variations and counts how they end.
fn random(request: &Hard, count: u32) -> Result<Ending, HeadlessError> {
    Interrupt::watch();
    let mut runs = Vec::new();
    for number in request.first..request.first.saturating_add(count) {
        let draw = if request.contact { Variation::contact } else { Variation::new };
        let variation = draw(request.seed, number).map_err(|_| HeadlessError::Study {
            file: "levels".to_owned(),
            why: StudyError::NotHere("one cannot be read"),
        })?;
        runs.push((variation, None));
    }
    let threads = request.threads.unwrap_or_else(threads);
    let done = super::study::with_progress(&request.progress_options, |budget| {
        let deadline = Deadline::after(budget);
        let open: Vec<_> = runs.iter_mut().filter(|(_, outcome)| outcome.is_none()).collect();
        spread(threads, open, |(variation, outcome)| {
            *outcome = Some(variation.run());
            !deadline.passed()
        });
        let over = runs.iter().filter(|(_, outcome)| outcome.is_some()).count();
        Ok(Progress { done: over as f64 / f64::from(count), finished: over == runs.len() })
    })
    .map_err(|why| HeadlessError::Study { file: "random variations".to_owned(), why })?;
    let stopped = Interrupt::seen().filter(|_| done < 1.0);
    let over: Vec<_> = runs.iter().filter_map(|(variation, outcome)| Some((variation, outcome.as_ref()?))).collect();
    let of = |wanted: fn(&Outcome) -> bool| over.iter().filter(|(_, outcome)| wanted(outcome)).count();
    let wrong: Vec<_> = over.iter().filter_map(|(variation, outcome)| Some((variation, outcome.wrong()?))).collect();
    let slowest = over.iter().map(|(_, outcome)| outcome.seconds).fold(0.0, f64::max);
    let mut table = format!(
        "{} runs of {} steps, seed {}\n{:>7} went to the end\n{:>7} of them with divided steps\n{:>7} stopped with a cause\n\
         {:>7} refused before the first step\n{:>7} wrong: energy from nowhere beyond {} times what was put in, surfaces that crossed, not finite, or over {} s\n\
         slowest run {slowest:.1} s",
        over.len(),
        Variation::STEPS,
        request.seed,
        of(|outcome| outcome.refused.is_none() && outcome.fault.is_none()),
        of(|outcome| outcome.fault.is_none() && outcome.guarded > 0),
        of(|outcome| outcome.fault.is_some()),
        of(|outcome| outcome.refused.is_some()),
        wrong.len(),
        Guard::EXCESS,
        Variation::SECONDS,
    );
    for (Variation { number, base, model, level, .. }, why) in &wrong {
        let (model, integrator) = (model.name(), level.integrator.name());
        // Writing to a string cannot fail.
        let _ = write!(table, "\nnumber {number}: {base}, {model}, {integrator}: {why}");
    }
    let outputs = Outputs::new(&[], &[])?;
    Ok(Ending::new(table, outputs, u8::from(!wrong.is_empty()), stopped))
}

/// Causes of runs that are not stable, found by experiments.
#[derive(Default)]
struct Explanations {
    /// Unstable runs of one case and model each, with the verdict of [`Experiment::Motion`].
    groups: Vec<(Vec<Explanation>, Option<Verdict>)>,
    threads: usize,
}

/// Unstable run, whether its cause was looked for, and the experiment that shows it, if one does.
struct Explanation {
    trial: Trial,
    failure: Failure,
    is_done: bool,
    cause: Option<Experiment>,
}

impl Explanations {
    /// Prepares those of the unstable runs of a sweep.
    fn new(sweep: &Sweep, threads: usize) -> Self {
        let mut groups: Vec<(Vec<Explanation>, Option<Verdict>)> = Vec::new();
        for (trial, entry) in sweep.entries() {
            let Some(Ok(Verdict { failure: Some(failure), .. })) = &entry.verdict else { continue };
            let explanation = Explanation { trial: trial.clone(), failure: *failure, is_done: false, cause: None };
            let is_shared =
                |known: &Explanation| Arc::ptr_eq(&known.trial.case, &trial.case) && known.trial.model == trial.model;
            match groups.last_mut() {
                Some((group, _)) if group.first().is_some_and(is_shared) => group.push(explanation),
                _ => groups.push((vec![explanation], None)),
            }
        }
        Self { groups, threads }
    }

    /// Works for about `budget`.
    fn advance(&mut self, budget: Duration) -> Progress {
        let deadline = Deadline::after(budget);
        let is_open = |(group, _): &&mut (Vec<Explanation>, _)| group.iter().any(|explanation| !explanation.is_done);
        let open: Vec<_> = self.groups.iter_mut().filter(is_open).collect();
        spread(self.threads, open, |(group, motion)| {
            for explanation in group.iter_mut().filter(|explanation| !explanation.is_done) {
                explanation.cause = Experiment::cause(&explanation.trial, explanation.failure, motion);
                explanation.is_done = true;
                if deadline.passed() {
                    return false;
                }
            }
            true
        });
        let all = self.groups.iter().flat_map(|(group, _)| group);
        let (count, done) = (all.clone().count(), all.filter(|explanation| explanation.is_done).count());
        Progress { done: done as f64 / count.max(1) as f64, finished: done == count }
    }

    /// Experiment that shows the cause of a run, if it was found.
    fn of(&self, trial: &Trial) -> Option<Experiment> {
        let is_own = |known: &&Explanation| {
            Arc::ptr_eq(&known.trial.case, &trial.case)
                && (known.trial.model, known.trial.method) == (trial.model, trial.method)
        };
        self.groups.iter().flat_map(|(group, _)| group).find(is_own)?.cause
    }
}

/// Table so far as CSV.
fn csv(sweep: &Sweep, explanations: &Explanations, partial: Option<&str>) -> String {
    let mut text = partial.map_or(String::new(), |partial| remark("partial", partial));
    text += COLUMNS;
    text.push('\n');
    for (trial, entry) in sweep.entries() {
        if let Some(Ok(verdict)) = &entry.verdict {
            text += &(row(trial, verdict, explanations.of(trial)) + "\n");
        }
    }
    text
}

fn read(request: &Hard) -> Result<Vec<(String, Case)>, HeadlessError> {
    let all = || Case::names().map(PathBuf::from).collect();
    let paths: Vec<PathBuf> = if request.cases.is_empty() { all() } else { request.cases.clone() };
    let mut cases = Vec::new();
    for path in paths {
        let mut case = Case::read(&path)
            .map_err(|error| super::missing(&path, error, "hard case", levels::HARD.iter().map(|(file, _)| *file)))?;
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

fn stable(entry: &Entry) -> bool {
    matches!(&entry.verdict, Some(Ok(verdict)) if verdict.is_stable())
}

/// Lines of the table, one per run, and the numbers of runs that are stable and held.
fn lines(sweep: &Sweep, explanations: &Explanations) -> String {
    let widest = sweep.entries().map(|(trial, _)| terminal::line(&trial.title()).chars().count()).max().unwrap_or(0);
    let mut text =
        format!("{:<widest$}  {:<17} {:<21}          ms  stable; how far off", "case", "model", "integrator");
    let [mut all, mut stable, mut held] = [0_usize; 3];
    for (trial, entry) in sweep.entries() {
        let Some(Ok(verdict)) = &entry.verdict else { continue };
        all += 1;
        stable += usize::from(verdict.is_stable());
        held += usize::from(verdict.held());
        let why = trial.case.cannot(trial.model, trial.method).map(|cannot| terminal::line(&cannot.why));
        let mut mark = match (verdict.is_stable(), why) {
            (true, _) => "stable".to_owned(),
            (false, None) => "NOT STABLE".to_owned(),
            (false, Some(why)) => format!("not stable, as expected: {why}"),
        };
        if let Some(experiment) = explanations.of(trial) {
            // Writing to a string cannot fail.
            let _ = write!(mark, " [{experiment}]");
        }
        let (name, model, method) = (terminal::line(&trial.title()), trial.material(), trial.method.name());
        let (ms, decided, accuracy) = (1e3 * entry.seconds, verdict.decided_by(), verdict.accuracy());
        // Writing to a string cannot fail.
        let _ = write!(text, "\n{name:<widest$}  {model:<17} {method:<21} {ms:>9.1}  {mark} ({decided}); {accuracy}");
    }
    text + &format!(
        "\n{stable} of {all} runs are stable, {held} held: stable and no farther off than {:.0} %",
        100.0 * ACCURATE
    )
}

/// Lines of counts, one per case, model and method.
/// Each states from how many starts the runs are stable, how many of the others are after untangling, and the least and
/// greatest energy left in those \[J\].
fn counts(sweep: &Sweep, starts: usize) -> String {
    let mut text =
        format!("{:<20} {:<17} {:<21} stable        by Untangle  energy left [J]", "case", "model", "integrator");
    let entries: Vec<_> = sweep.entries().collect();
    for group in entries.chunks(starts) {
        let trial = group[0].0;
        let Trial { name, case, method, .. } = trial;
        let undamped = if case.is_undamped_twin() { ", undamped" } else { "" };
        let (name, model, method) = (format!("{}{undamped}", terminal::line(name)), trial.material(), method.name());
        let over = group.iter().filter(|(_, entry)| entry.verdict.is_some()).count();
        let opens = |entry: &Entry| matches!(&entry.verdict, Some(Ok(verdict)) if verdict.numbers.opens);
        let count = group.iter().filter(|(_, entry)| stable(entry)).count();
        let opened = group.iter().filter(|(_, entry)| !stable(entry) && opens(entry)).count();
        let energy = |(_, entry): &(&Trial, &Entry)| match &entry.verdict {
            Some(Ok(verdict)) if !verdict.is_stable() => Some(verdict.numbers.elastic),
            _ => None,
        };
        let left = group.iter().filter_map(energy);
        let (least, most) = left.fold((f64::INFINITY, 0.0), |(least, most), j| (j.min(least), j.max(most)));
        let left = if least <= most { format!("{least:.1e} to {most:.1e}") } else { String::new() };
        let held = format!("{count} of {over}");
        // Writing to a string cannot fail.
        let _ = write!(text, "\n{name:<20} {model:<17} {method:<21} {held:<13} {opened:<12} {left}");
        text.truncate(text.trim_end().len());
    }
    text
}

fn energy(text: &str) -> Result<Arc<TypedEnergy>, String> {
    let energy = TypedEnergy::new(text, Vec::new()).map_err(|why| why.to_string())?;
    let parameters = MaterialParameters::default().try_with_model(Case::TYPED).map_err(|why| why.to_string())?;
    energy.material(parameters)?;
    Ok(Arc::new(energy))
}

fn method(text: &str) -> Result<Method, String> {
    let names = Method::ALL.map(Method::name);
    let known = Method::ALL.into_iter().find(|method| method.name().eq_ignore_ascii_case(text));
    known.ok_or_else(|| format!("expected one of {}", names.join(", ")))
}
