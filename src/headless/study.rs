//! `gingerbread study`: measures accuracy and its cost.

use super::{Ending, HeadlessError, Interrupt, Outputs, PER_CENT, Progress as Shown, ProgressOptions, ending};
use crate::{
    elements::ElementKind,
    files,
    integrators::IntegratorKind,
    level::{Level, Substeps},
    study::{
        Curve, Dial, DialPlan, Drift, ErrorBudget, ErrorSource, Invariant, Locking, LockingNumber, Measure, MeshMoment,
        MeshPlan, MeshPoint, MeshStudy, Outcome, Plan, Point, Price, Progress, Reached, Reference, Status, StudyError,
        Trial, USUAL_ERRORS, WorkPrecision, order_in_words, price_in_words, threads,
    },
    table::remark,
    terminal,
};
use std::{fmt::Write as _, path::PathBuf, str::FromStr as _, time::Duration};

/// What to study and what to write.
#[derive(Clone, Debug, clap::Args)]
pub struct Study {
    /// A level file, or the name of a built-in level.
    pub level: PathBuf,
    /// Integrators to compare, by name, separated by commas; all if not given.
    #[arg(long, value_delimiter = ',', value_parser = IntegratorKind::from_str)]
    pub integrators: Vec<IntegratorKind>,
    /// Steps per 1/60 s, separated by commas; what suits each integrator if not given.
    #[arg(long, value_delimiter = ',', value_parser = substeps)]
    pub steps: Vec<Substeps>,
    /// Compares meshes in place of integrators: numbers of triangles, separated by commas; without any, from 1/64 of the level's
    /// own to 4 times as many.
    #[arg(long, value_delimiter = ',', num_args = 0.., conflicts_with_all = ["integrators", "steps"])]
    #[arg(value_parser = clap::value_parser!(u32).range(2..=1_000_000))]
    pub meshes: Option<Vec<u32>>,
    /// Kinds of elements to compare on meshes of the same numbers of triangles, separated by commas: `Linear`, `MeanDilatation`, `Quadratic`.
    #[arg(long, value_delimiter = ',', value_parser = element, requires = "meshes")]
    pub elements: Vec<ElementKind>,
    /// Also compares adaptive meshes of each kind of elements: from the coarsest one on, the triangles with the greatest estimated error of the stress are divided. Pins or
    /// rollers must hold the bodies.
    #[arg(long, requires = "meshes")]
    pub adaptive: bool,
    /// What is compared between meshes: `deflection`, `energy` or `stress` (the greatest von Mises stress).
    #[arg(long, default_value = "deflection", value_parser = measure)]
    pub measure: Measure,
    /// Follows energy and momentum over time, a course for each integrator, in place of errors.
    #[arg(long, conflicts_with = "meshes")]
    pub drift: bool,
    /// Tells how much of the error comes from the time step, the mesh, the elements, contact, sleep, and each effect, in place of comparing integrators.
    #[arg(long, conflicts_with_all = ["meshes", "drift", "integrators", "steps"])]
    pub budget: bool,
    /// Finds for each integrator the cheapest step with which 95 % of the frames are within these errors [%], separated by commas, in place
    /// of comparing steps.
    #[arg(long, value_delimiter = ',', value_parser = per_cent)]
    #[arg(conflicts_with_all = ["meshes", "drift", "budget", "steps", "error"])]
    pub wanted: Vec<f64>,
    /// Simulated time \[s\].
    #[arg(long, default_value = "1", value_parser = super::seconds)]
    pub seconds: f64,
    /// Suggests the cheapest setting under this mean error [%]; if not given, 1, or 10 if nothing reaches 1.
    #[arg(long, value_parser = per_cent)]
    pub error: Option<f64>,
    /// Number of threads; as many as there are if not given.
    #[arg(long, value_parser = super::thread_count)]
    pub threads: Option<usize>,
    /// Write the table here, as CSV.
    #[arg(long)]
    pub csv: Option<PathBuf>,
    /// How progress is shown.
    #[command(flatten)]
    pub progress_options: ProgressOptions,
}

/// Studies a level and writes the table. Shows progress. A signal stops the study early.
///
/// # Errors
/// [`HeadlessError`] with the cause and the remedy.
pub fn study(request: &Study) -> Result<Ending, HeadlessError> {
    let level = super::read(&request.level)?;
    let mut outputs = Outputs::new(&[("--csv", request.csv.as_ref())], &super::inputs(&request.level, &level))?;
    let fail = |why| HeadlessError::Study { file: request.level.display().to_string(), why };
    let Studied { mut table, csv, done } = match &request.meshes {
        Some(triangles) => meshes(request, &level, triangles.clone()).map_err(fail)?,
        None if request.drift => drift(request, &level).map_err(fail)?,
        None if request.budget => budget(request, &level).map_err(fail)?,
        None if !request.wanted.is_empty() => dial(request, &level).map_err(fail)?,
        None => integrators(request, &level).map_err(fail)?,
    };
    let stopped = Interrupt::seen().filter(|_| done < 1.0);
    let partial = stopped.map(|signal| format!("stopped by {signal} at about {:.1} % of the work", 100.0 * done));
    outputs.write("--csv", |_| Ok(partial.as_ref().map_or(String::new(), |partial| remark("partial", partial)) + &csv));
    if !level.actions.is_empty() {
        table.push_str("\n\nThe scripted actions of this level are not performed in a study.");
    }
    if let Some(partial) = &partial {
        // Writing to a string cannot fail.
        let _ = write!(table, "\n\nPartial: {partial}.");
    }
    let mut ending = Ending::new(table, outputs, 0, stopped);
    ending.remarks.extend(partial.map(|partial| format!("the results are partial: {partial}")));
    Ok(ending)
}

/// Result of a study.
struct Studied {
    /// Table for the terminal.
    table: String,
    /// Table as CSV.
    csv: String,
    /// Share of the work done.
    done: f64,
}

/// Prints warnings about the start of a trial. From then on signals stop the work.
fn begin(request: &Study, trial: &Trial) {
    ending::warn(&request.level.display().to_string(), &trial.scene.warnings(&trial.start));
    Interrupt::watch();
}

/// Trial of the study. Checks that every named integrator can step it.
fn trial(request: &Study, level: &Level) -> Result<Trial, StudyError> {
    let trial = Trial::new(level, &files::Disk, request.seconds)?;
    request.integrators.iter().try_for_each(|integrator| trial.check(integrator))?;
    Ok(trial)
}

fn integrators(request: &Study, level: &Level) -> Result<Studied, StudyError> {
    let mut plan = Plan { substeps: request.steps.clone(), integrators: request.schemes(), ..Plan::default() };
    plan.threads = request.threads();
    let trial = trial(request, level)?;
    begin(request, &trial);
    let mut diagram = WorkPrecision::new(trial, plan);
    let done = with_progress(&request.progress_options, |budget| diagram.advance(budget))?;
    let mut table = format!("{}, {} s simulated", terminal::line(&level.name), diagram.trial().seconds());
    if let Some(reference) = diagram.reference() {
        // Writing to a string cannot fail.
        let _ = write!(table, "; reference: {}", reference.source);
        if !reference.is_still() {
            let _ = write!(table, " (own error at most {:.1e})", reference.own_error);
            table += "\nerror: relative RMS position error, mean over frames and vertices; largest: the largest over frames\nms/s: ";
            table += &price_in_words();
            for curve in diagram.curves() {
                table += &lines(&curve, reference);
            }
        }
    }
    table += "\n\n";
    table += &advice(request.error, &diagram);
    Ok(Studied { table, csv: diagram.csv(), done })
}

/// Text with the cheapest setting for an error [%], or the reason why there is none.
fn advice(asked: Option<f64>, diagram: &WorkPrecision) -> String {
    if let Some(why) = diagram.no_errors() {
        return format!("{why}.");
    }
    if let Some(per_cent) = asked {
        return match diagram.suggest(0.01 * per_cent, Price::Time) {
            Some(suggestion) => format!("Cheapest under {per_cent} %: {suggestion}"),
            None => format!("Nothing measured is under {per_cent} %."),
        };
    }
    let [least, .., greatest] = USUAL_ERRORS.map(|error| 100.0 * error);
    match diagram.suggest_usual(Price::Time) {
        Some((error, suggestion)) if 100.0 * error == least => format!("Cheapest under {least} %: {suggestion}"),
        Some((error, suggestion)) => {
            format!("Nothing measured is under {least} %. Cheapest under {} %: {suggestion}", 100.0 * error)
        }
        None => format!("Nothing measured is under {greatest} %."),
    }
}

/// Lines of one integrator.
fn lines(curve: &Curve, reference: &Reference) -> String {
    let kind = curve.integrator.kind();
    let measured = if curve.order.is_ok() { "measured " } else { "" };
    let order = order_in_words(&curve.order);
    let mut text = format!("\n\n{} (order {}, {measured}{order})\n", kind.title(), kind.order());
    text += "  steps/frame  tolerance      error    largest    ms/s  runs     forces     solves";
    for Point { setting, outcome, current } in &curve.points {
        let Some(outcome) = outcome else { continue };
        let tolerance = setting.tolerance().map_or("-".to_owned(), |tolerance| format!("{tolerance:.0e}"));
        let Outcome { error, greatest_error, status, counts, ms_per_second, runs, .. } = outcome;
        let [error, largest, note] = if *status == Status::Unstable {
            ["unstable".to_owned(), "-".to_owned(), String::new()]
        } else {
            let note = reference.limits().note(*error).map_or_else(String::new, |note| format!("  {}", note.words()));
            [format!("{error:.2e}"), format!("{greatest_error:.2e}"), note]
        };
        let mut remarks = note;
        if *status == Status::Unconverged {
            remarks += "  not all steps converged";
        }
        if *current {
            remarks += "  <- now";
        }
        let (forces, solves) = (counts.force_evaluations, counts.factorisations);
        // Writing to a string cannot fail.
        let _ = write!(
            text,
            "\n  {:>11}  {tolerance:>9}  {error:>9}  {largest:>9}  {ms_per_second:>6.1}  {runs:>4}  {forces:>9}  {solves:>9}{remarks}",
            setting.substeps.get(),
        );
    }
    text
}

fn meshes(request: &Study, level: &Level, triangles: Vec<u32>) -> Result<Studied, StudyError> {
    let elements = request.elements.clone();
    let (measure, adaptive) = (request.measure, request.adaptive);
    let mut plan = MeshPlan { triangles, elements, adaptive, measure, ..MeshPlan::default() };
    plan.threads = request.threads();
    if !Trial::new(level, &files::Disk, request.seconds)?.scene.is_held() {
        plan.moment = MeshMoment::AtTheEnd;
        if adaptive {
            return Err(StudyError::NotHere(
                "adaptive meshes need an equilibrium, but no pins or rollers hold the bodies of this level",
            ));
        }
    }
    let mut study = MeshStudy::new(level, &files::Disk, request.seconds, plan)?;
    begin(request, study.trial());
    let mut done = with_progress(&request.progress_options, |budget| Ok(study.advance(budget)))?;
    let (measure, moment) = (study.plan().measure, study.plan().moment);
    let mut table = format!("{}: {} [{}] {moment}", terminal::line(&level.name), measure.title(), measure.unit());
    // Writing to a string cannot fail.
    let _ = match study.reference() {
        Some(Ok(reference)) => {
            let own = 100.0 * reference.own_error;
            write!(table, "; extrapolated {:.6e} (estimated to {own:.2} %)", reference.value)
        }
        Some(Err(why)) => write!(table, "\n{why}."),
        None => Ok(()),
    };
    let _ = write!(table, "\nms: {}", price_in_words());
    table += "\n\n  triangles  size [mm]         value      error [%]        ms  runs";
    table += if request.elements.is_empty() && !adaptive { "" } else { "  series" };
    for point in study.points() {
        let word = if point.status == Status::Ok { "not done" } else { point.status.word() };
        let value = point.value.map_or(word.to_owned(), |value| format!("{value:.6e}"));
        let error = study.error_of(point).map_or("-".to_owned(), |error| format!("{:.4}", 100.0 * error));
        let MeshPoint { triangles, ms, runs, .. } = *point;
        let size = 1e3 * point.size;
        let _ = write!(table, "\n  {triangles:>9}  {size:>9.2}  {value:>12}  {error:>13}  {ms:>8.1}  {runs:>4}");
        let word = point.series.word();
        let _ = if word.is_empty() { Ok(()) } else { write!(table, "  {word}") };
    }
    table += "\n";
    for series in study.series() {
        let word = series.word();
        let of = if word.is_empty() { word } else { format!(" of {word}") };
        let _ = write!(table, "\nMeasured order{of}: {}", order_in_words(&study.order(series)));
    }
    for (kind, why) in study.left_out() {
        let _ = write!(table, "\n{} is left out: {}", kind.title(), terminal::line(why));
    }
    for sentence in study.as_exact_in_words() {
        table = table + "\n" + &sentence;
    }
    let mut locking = Vec::new();
    if moment == MeshMoment::AtRest && study.is_telling() && done == 1.0 {
        match self::locking(request, level) {
            Ok((numbers, share)) => (locking, done) = (numbers, 0.5 + 0.5 * share),
            // The study is complete, so its results are kept.
            Err(error) => drop(write!(table, "\nLocking was not measured: {}", terminal::line(&error.to_string()))),
        }
    }
    for number in &locking {
        let _ = write!(table, "\nLocking at nu = {}: {}", number.poisson, number.words());
    }
    Ok(Studied { table, csv: study.csv(&locking), done })
}

/// Locking numbers, and the share of the work done.
fn locking(request: &Study, level: &Level) -> Result<(Vec<LockingNumber>, f64), StudyError> {
    let mut locking = Locking::new(level, &files::Disk)?;
    let done = with_progress(&request.progress_options, |_| Ok(locking.advance()))?;
    Ok((locking.numbers(), done))
}

fn drift(request: &Study, level: &Level) -> Result<Studied, StudyError> {
    let trial = trial(request, level)?;
    let mut settings = Vec::new();
    for substeps in request.steps.iter().copied().map(Some).chain(request.steps.is_empty().then_some(None)) {
        settings.extend(Drift::settings(&trial, &request.schemes(), substeps));
    }
    begin(request, &trial);
    let mut drift = Drift::new(trial, settings, request.threads());
    let done = with_progress(&request.progress_options, |budget| Ok(drift.advance(budget)))?;
    let mut table = format!("{}, {} s simulated", terminal::line(&level.name), drift.trial().seconds());
    let nothing = drift.nothing_of(Invariant::Energy);
    if nothing.is_none() {
        // Writing to a string cannot fail.
        let _ = write!(table, "; energy over {:.3e} J, the greatest kinetic energy", drift.scale());
    }
    for invariant in Invariant::ALL {
        let reasons = drift.changed_by(invariant).join(", ");
        let remark = drift.nothing_of(invariant).map(str::to_owned);
        let remark = remark.or_else(|| (!reasons.is_empty()).then(|| format!("changed by {reasons} by right")));
        let _ = remark.map(|remark| write!(table, "\n{}: {remark}", invariant.title()));
    }
    let touching: Vec<_> = drift.touching().map(|run| run.setting.label()).collect();
    let valid = drift.runs().iter().filter(|run| drift.status(run) != Status::Unstable).count();
    if !touching.is_empty() {
        let who = if touching.len() == valid { "all that stayed stable".to_owned() } else { touching.join("; ") };
        let _ = write!(table, "\nmomentum: changed by walls that are touched by right, for {who}");
    }
    let widest = drift.runs().iter().map(|run| run.setting.label().len()).max().unwrap_or(0);
    let _ =
        write!(table, "\n\n  {:<widest$}     energy   [kg m/s]  [kg m2/s]  energy at the end", "greatest change of");
    for run in drift.runs() {
        let [energy, linear, angular] = Invariant::ALL.map(|invariant| drift.greatest_change(run, invariant));
        let end = run.moments.last().map_or(0.0, |moment| drift.change(run, Invariant::Energy, moment));
        let (energy, end) = match (drift.status(run), nothing) {
            (Status::Unstable, _) => (format!("{energy:.2e}"), "unstable".to_owned()),
            (_, Some(_)) => ("-".to_owned(), "-".to_owned()),
            (_, None) => (format!("{energy:.2e}"), format!("{:+.4} %", 100.0 * end)),
        };
        let label = run.setting.label();
        let _ = write!(table, "\n  {label:<widest$}  {energy:>9}  {linear:>9.2e}  {angular:>9.2e}  {end:>17}");
    }
    for (integrator, order) in drift.orders() {
        let (title, order) = (integrator.kind().title(), order_in_words(&order));
        let _ = write!(table, "\nOrder of the greatest energy change, {title}: {order}");
    }
    Ok(Studied { table, csv: drift.csv(), done })
}

impl Study {
    /// Integrators to compare.
    fn schemes(&self) -> Vec<IntegratorKind> {
        if self.integrators.is_empty() { IntegratorKind::all() } else { self.integrators.clone() }
    }

    fn threads(&self) -> usize {
        self.threads.unwrap_or_else(threads)
    }
}

/// For each wanted error the cheapest step of each integrator.
fn dial(request: &Study, level: &Level) -> Result<Studied, StudyError> {
    let wanted = request.wanted.iter().map(|per_cent| 0.01 * per_cent).collect();
    let plan = DialPlan { integrators: request.schemes(), wanted, threads: request.threads() };
    let trial = trial(request, level)?;
    begin(request, &trial);
    let mut dial = Dial::new(trial, plan);
    let done = with_progress(&request.progress_options, |budget| dial.advance(budget))?;
    let mut table = format!("{}, {} s simulated", terminal::line(&level.name), dial.trial().seconds());
    // Writing to a string cannot fail.
    let _ = dial.reference().map(|reference| {
        write!(table, "; reference: {} (own error at most {:.1e})", reference.source, reference.own_error)
    });
    if let Some(why) = dial.no_errors() {
        let _ = write!(table, "\n\n{why}.");
        return Ok(Studied { table, csv: dial.csv(), done });
    }
    table +=
        "\nerror: what 95 % of the frames are within: RMS over the vertices, over the RMS motion of all frames\nms/s: ";
    table += &price_in_words();
    for wanted in dial.plan().wanted.clone() {
        let _ = write!(table, "\n\nWanted: {} %", 100.0 * wanted);
        if !dial.tells(wanted) {
            table += "\n  The reference is not exact enough to tell.";
            continue;
        }
        table += "\n  scheme                    steps/frame  tolerance      error    ms/s  runs";
        for (integrator, reached) in dial.reached(wanted) {
            let title = integrator.kind().title();
            let Some(Reached { setting, outcome }) = reached else {
                let _ = write!(table, "\n  {title:<24}  {:>11}", "-");
                continue;
            };
            let tolerance = setting.tolerance().map_or("-".to_owned(), |tolerance| format!("{tolerance:.1e}"));
            let Outcome { usual_error, ms_per_second, runs, .. } = outcome;
            let _ = write!(
                table,
                "\n  {title:<24}  {:>11}  {tolerance:>9}  {usual_error:>9.2e}  {ms_per_second:>6.1}  {runs:>4}",
                setting.substeps.get(),
            );
        }
        let _ = write!(table, "\n  {}", cheapest(&dial, wanted));
    }
    table += "\n\nA line without numbers: the error is not reached, or costs far more than with another scheme.";
    Ok(Studied { table, csv: dial.csv(), done })
}

/// Sentence about the cheapest setting for an error, and what it costs with the scheme of the level.
fn cheapest(dial: &Dial, wanted: f64) -> String {
    let Some(Reached { setting, outcome }) = dial.cheapest(wanted) else {
        return "Nothing reaches it.".to_owned();
    };
    let own = dial.trial().current.integrator.name();
    let of_level = dial.reached(wanted).find(|(integrator, _)| integrator.name() == own);
    let than_level = match of_level.map(|(_, reached)| reached) {
        Some(Some(same)) if same.setting == *setting => String::new(),
        Some(Some(level)) => format!(
            "; {:.1} times cheaper than {}, which the level uses",
            level.outcome.ms_per_second / outcome.ms_per_second,
            level.setting.label()
        ),
        Some(None) => "; the scheme of the level does not reach it".to_owned(),
        None => String::new(),
    };
    format!("Cheapest: {}, {:.1} ms per simulated second{than_level}.", setting.label(), outcome.ms_per_second)
}

/// The error budget.
fn budget(request: &Study, level: &Level) -> Result<Studied, StudyError> {
    Interrupt::watch();
    let mut budget = ErrorBudget::new(level, &files::Disk, request.seconds, request.threads())?;
    let done = with_progress(&request.progress_options, |time| budget.advance(time))?;
    let whole = budget
        .ms_per_second()
        .map_or_else(String::new, |ms| format!(", {ms:.1} ms per second of simulated time as it is"));
    let mut table = format!(
        "{}, {} s simulated{whole}\n\n{:<22} {:<26} {:>9} {:>9} {:>7}",
        terminal::line(&level.name),
        request.seconds,
        "source",
        "changed to",
        "moves by",
        "error",
        "price"
    );
    let share = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{:.3} %", 100.0 * value));
    for ErrorSource { name, change, moved, error, price, trouble, .. } in budget.sources() {
        let price = price.map_or("-".to_owned(), |price| format!("{price:.2}"));
        // Writing to a string cannot fail.
        let _ = write!(table, "\n{name:<22} {change:<26} {:>9} {:>9} {price:>7}", share(*moved), share(*error));
        if let Some(trouble) = trouble {
            let _ = write!(table, "  {}", terminal::line(trouble));
        }
    }
    table.push_str(
        "\n\nFirst what can be refined, by the distance for its price, then all of it together and other elements, then the effects. Moves by: relative distance of the run from that of the level as it \
         is. Error: what is left of it by the order of its convergence. Price: processor time as a multiple of that of the level as it is.",
    );
    Ok(Studied { table, csv: budget.csv(), done })
}

/// Runs a job until it is finished or a signal asks for a stop, with progress. Returns the share of the work done.
pub(super) fn with_progress(
    progress_options: &ProgressOptions,
    mut advance: impl FnMut(Duration) -> Result<Progress, StudyError>,
) -> Result<f64, StudyError> {
    let shown = Shown::new(progress_options, 1000, PER_CENT);
    let mut done = 0.0;
    while Interrupt::seen().is_none() {
        let progress = advance(Duration::from_millis(200))?;
        done = progress.done;
        shown.set((1e3 * done) as u64);
        if progress.finished {
            return Ok(1.0);
        }
    }
    // An unfinished job never shows 100 %.
    Ok(done.min(0.999))
}

fn substeps(text: &str) -> Result<Substeps, String> {
    let count = text.parse().map_err(|_| format!("expected whole numbers in [1, {}]", Substeps::MAX))?;
    Substeps::new(count)
}

fn element(text: &str) -> Result<ElementKind, String> {
    let names = || ElementKind::ALL.map(|kind| format!("{kind:?}")).join(", ");
    let is_meant = |kind: &&ElementKind| format!("{kind:?}").eq_ignore_ascii_case(text);
    ElementKind::ALL.iter().find(is_meant).copied().ok_or_else(|| format!("expected one of {}", names()))
}

fn measure(text: &str) -> Result<Measure, String> {
    match text {
        "deflection" => Ok(Measure::TipDeflection),
        "energy" => Ok(Measure::ElasticEnergy),
        "stress" => Ok(Measure::GreatestStress),
        _ => Err("expected deflection, energy or stress".to_owned()),
    }
}

fn per_cent(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "expected a number of per cent".to_owned())?;
    if value > 0.0 && value <= 100.0 {
        Ok(value)
    } else {
        Err("expected per cent, greater than 0 and at most 100".to_owned())
    }
}
