//! `gingerbread study`: what accuracy costs, as a table and as CSV.

use super::HeadlessError;
use crate::{
    files,
    integrators::IntegratorKind,
    level::{Level, Substeps},
    study::{
        Curve, Drift, Invariant, Locking, LockingNumber, Measure, MeshMoment, MeshPlan, MeshPoint, MeshStudy, Outcome,
        Plan, Point, Price, Progress, Reference, Status, StudyError, Trial, USUAL_ERRORS, WorkPrecision,
        order_in_words, price_in_words, threads,
    },
};
use std::{fmt::Write as _, path::PathBuf, time::Duration};

/// What to study and what to write.
#[derive(Clone, Debug, clap::Args)]
pub struct Study {
    /// A level file, or the name of a built-in level.
    pub level: PathBuf,
    /// Integrators to compare, by name, separated by commas; all if not given.
    #[arg(long, value_delimiter = ',', value_parser = integrator)]
    pub integrators: Vec<IntegratorKind>,
    /// Steps per 1/60 s, separated by commas; what suits each integrator if not given.
    #[arg(long, value_delimiter = ',', value_parser = substeps)]
    pub steps: Vec<Substeps>,
    /// Compares meshes in place of integrators: numbers of triangles, separated by commas; without any, from 1/64 of the level's
    /// own to 4 times as many.
    #[arg(long, value_delimiter = ',', num_args = 0.., conflicts_with_all = ["integrators", "steps"])]
    #[arg(value_parser = clap::value_parser!(u32).range(2..=1_000_000))]
    pub meshes: Option<Vec<u32>>,
    /// What is compared between meshes: `deflection` or `energy`.
    #[arg(long, default_value = "deflection", value_parser = measure)]
    pub measure: Measure,
    /// Follows energy and momentum over time, a course for each integrator, in place of errors.
    #[arg(long, conflicts_with = "meshes")]
    pub drift: bool,
    /// Simulated time [s].
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
}

/// Studies a level and returns the table to print. Shows progress on a terminal.
///
/// # Errors
/// [`HeadlessError`] says what to mend.
pub fn study(request: &Study) -> Result<String, HeadlessError> {
    let level = files::read(&request.level)?;
    let fail = |why| HeadlessError::Study { file: request.level.display().to_string(), why };
    let (table, csv) = match &request.meshes {
        Some(triangles) => meshes(request, &level, triangles.clone()).map_err(fail)?,
        None if request.drift => drift(request, &level).map_err(fail)?,
        None => integrators(request, &level).map_err(fail)?,
    };
    if let Some(path) = &request.csv {
        files::write_text(path, &csv)?;
    }
    Ok(table)
}

/// What is to be studied, which every integrator that was named can step.
fn trial(request: &Study, level: &Level) -> Result<Trial, StudyError> {
    let trial = Trial::new(level, &files::Disk, request.seconds)?;
    request.integrators.iter().try_for_each(|integrator| trial.check(integrator))?;
    Ok(trial)
}

fn integrators(request: &Study, level: &Level) -> Result<(String, String), StudyError> {
    let mut plan = Plan { substeps: request.steps.clone(), integrators: request.schemes(), ..Plan::default() };
    plan.threads = request.threads();
    let trial = trial(request, level)?;
    let mut diagram = WorkPrecision::new(trial, plan);
    with_progress(|budget| diagram.advance(budget))?;
    let mut table = format!("{}, {} s simulated", level.name, diagram.trial().seconds());
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
    Ok((table, diagram.csv()))
}

/// The cheapest setting under an error [%], or why there is none.
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

/// The lines of one integrator.
fn lines(curve: &Curve, reference: &Reference) -> String {
    let kind = curve.integrator.kind();
    let measured = if curve.order.is_ok() { "measured " } else { "" };
    let order = order_in_words(&curve.order);
    let mut text = format!("\n\n{} (order {}, {measured}{order})\n", kind.title(), kind.order());
    text += "  steps/frame  tolerance      error    largest    ms/s  runs     forces     solves";
    for Point { setting, outcome, current } in &curve.points {
        let Some(outcome) = outcome else { continue };
        let tolerance = setting.tolerance().map_or("-".to_owned(), |tolerance| format!("{tolerance:.0e}"));
        let Outcome { error, greatest_error, status, counts, ms_per_second, runs } = outcome;
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

fn meshes(request: &Study, level: &Level, triangles: Vec<u32>) -> Result<(String, String), StudyError> {
    let mut plan = MeshPlan { triangles, measure: request.measure, ..MeshPlan::default() };
    plan.threads = request.threads();
    if Trial::new(level, &files::Disk, request.seconds)?.scene.pins.len() < 2 {
        plan.moment = MeshMoment::AtTheEnd;
    }
    let mut study = MeshStudy::new(level, &files::Disk, request.seconds, plan)?;
    with_progress(|budget| Ok(study.advance(budget)))?;
    let (measure, moment) = (study.plan().measure, study.plan().moment);
    let mut table = format!("{}: {} [{}] {moment}", level.name, measure.title(), measure.unit());
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
    for point in study.points() {
        let value = point.value.map_or(point.status.word().to_owned(), |value| format!("{value:.6e}"));
        let error = study.error_of(point).map_or("-".to_owned(), |error| format!("{:.4}", 100.0 * error));
        let MeshPoint { triangles, ms, runs, .. } = *point;
        let size = 1e3 * point.size;
        let _ = write!(table, "\n  {triangles:>9}  {size:>9.2}  {value:>12}  {error:>13}  {ms:>8.1}  {runs:>4}");
    }
    let _ = write!(table, "\n\nMeasured order: {}", order_in_words(&study.order()));
    let locking = if moment == MeshMoment::AtRest && study.is_telling() { locking(level)? } else { Vec::new() };
    for number in &locking {
        let _ = write!(table, "\nLocking at nu = {}: {}", number.poisson, number.words());
    }
    Ok((table, study.csv(&locking)))
}

fn locking(level: &Level) -> Result<Vec<LockingNumber>, StudyError> {
    let mut locking = Locking::new(level, &files::Disk)?;
    with_progress(|_| Ok(locking.advance()))?;
    Ok(locking.numbers())
}

fn drift(request: &Study, level: &Level) -> Result<(String, String), StudyError> {
    let trial = trial(request, level)?;
    let mut settings = Vec::new();
    for substeps in request.steps.iter().copied().map(Some).chain(request.steps.is_empty().then_some(None)) {
        settings.extend(Drift::settings(&trial, &request.schemes(), substeps));
    }
    let mut drift = Drift::new(trial, settings, request.threads());
    with_progress(|budget| Ok(drift.advance(budget)))?;
    let mut table = format!("{}, {} s simulated", level.name, drift.trial().seconds());
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
        let _ = write!(table, "\nenergy and momentum: changed by walls that are touched by right, for {who}");
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
    Ok((table, drift.csv()))
}

impl Study {
    /// The integrators to compare.
    fn schemes(&self) -> Vec<IntegratorKind> {
        if self.integrators.is_empty() { IntegratorKind::all() } else { self.integrators.clone() }
    }

    fn threads(&self) -> usize {
        self.threads.unwrap_or_else(threads)
    }
}

/// Works until a job is finished, with a bar where there is a terminal.
pub(super) fn with_progress(
    mut advance: impl FnMut(Duration) -> Result<Progress, StudyError>,
) -> Result<(), StudyError> {
    let bar = indicatif::ProgressBar::new(1000);
    if let Ok(style) = indicatif::ProgressStyle::with_template("{bar:40} {percent} %, {elapsed}") {
        bar.set_style(style);
    }
    loop {
        let progress = advance(Duration::from_millis(200));
        bar.set_position(progress.as_ref().map_or(0.0, |progress| 1e3 * progress.done) as u64);
        if progress.as_ref().map_or(true, |progress| progress.finished) {
            bar.finish_and_clear();
            return progress.map(|_| ());
        }
    }
}

fn integrator(text: &str) -> Result<IntegratorKind, String> {
    let mut known = IntegratorKind::all();
    let names: Vec<_> = known.iter().map(IntegratorKind::name).collect();
    let found = names.iter().position(|name| name.eq_ignore_ascii_case(text));
    found.map(|at| known.swap_remove(at)).ok_or_else(|| format!("expected one of {}", names.join(", ")))
}

fn substeps(text: &str) -> Result<Substeps, String> {
    let count = text.parse().map_err(|_| format!("expected whole numbers in [1, {}]", Substeps::MAX))?;
    Substeps::new(count)
}

fn measure(text: &str) -> Result<Measure, String> {
    match text {
        "deflection" => Ok(Measure::TipDeflection),
        "energy" => Ok(Measure::ElasticEnergy),
        _ => Err("expected deflection or energy".to_owned()),
    }
}

fn per_cent(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "expected a number of per cent".to_owned())?;
    if value > 0.0 && value <= 100.0 { Ok(value) } else { Err("expected per cent in (0, 100]".to_owned()) }
}
