//! `gingerbread study`: what accuracy costs, as a table and as CSV.

use super::HeadlessError;
use crate::{
    files,
    integrators::IntegratorKind,
    level::{Level, Substeps},
    study::{
        Curve, Drift, Invariant, Locking, LockingNumber, Measure, MeshMoment, MeshPlan, MeshStudy, Plan, Point, Price,
        Progress, StudyError, Trial, WorkPrecision, threads,
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
    /// Suggests the cheapest setting under this error [%].
    #[arg(long, default_value = "1", value_parser = per_cent)]
    pub error: f64,
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
    if !level.acts.is_empty() {
        return Ok(format!("{table}\n\nThe scripted actions of this level are not performed in a study."));
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
        let _ = write!(table, "; reference: {} (own error at most {:.1e})", reference.source, reference.own_error);
    }
    for curve in diagram.curves() {
        table += &lines(&curve);
    }
    let (allowed, per_cent) = (0.01 * request.error, request.error);
    let _ = match diagram.suggest(allowed, Price::Time) {
        Some(suggestion) => write!(table, "\n\nCheapest under {per_cent} %: {suggestion}"),
        None => write!(table, "\n\nNothing measured is under {per_cent} %."),
    };
    Ok((table, diagram.csv()))
}

/// The lines of one integrator.
fn lines(curve: &Curve) -> String {
    let kind = curve.integrator.kind();
    let order = curve.order.map_or("not measurable here".to_owned(), |order| format!("{order:.2}"));
    let mut text = format!("\n\n{} (order {}, measured {order})\n", kind.title(), kind.order());
    text += "  steps/frame  tolerance      error    ms/s     forces     solves";
    for Point { setting, outcome, current } in &curve.points {
        let Some(outcome) = outcome else { continue };
        let tolerance = setting.tolerance().map_or("-".to_owned(), |tolerance| format!("{tolerance:.0e}"));
        let error = match outcome.status {
            crate::study::Status::Unstable => "unstable".to_owned(),
            _ => format!("{:.2e}", outcome.error),
        };
        let mut remarks = String::new();
        if outcome.status == crate::study::Status::Unconverged {
            remarks += "  not all steps converged";
        }
        if *current {
            remarks += "  <- now";
        }
        let counts = &outcome.counts;
        let (forces, solves) = (counts.force_evaluations, counts.factorisations);
        // Writing to a string cannot fail.
        let _ = write!(
            text,
            "\n  {:>11}  {tolerance:>9}  {error:>9}  {:>6.1}  {forces:>9}  {solves:>9}{remarks}",
            setting.substeps.get(),
            outcome.ms_per_second,
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
    if let Some((value, own)) = study.reference() {
        // Writing to a string cannot fail.
        let _ = write!(table, "; extrapolated {value:.6e} (to {:.2} %)", 100.0 * own);
    }
    table += "\n\n  triangles  size [mm]         value      error [%]        ms";
    for point in study.points() {
        let value = point.value.map_or(point.status.word().to_owned(), |value| format!("{value:.6e}"));
        let error = study.error_of(point).map_or("-".to_owned(), |error| format!("{:.4}", 100.0 * error));
        let (triangles, size, ms) = (point.triangles, 1e3 * point.size, point.ms);
        let _ = write!(table, "\n  {triangles:>9}  {size:>9.2}  {value:>12}  {error:>13}  {ms:>8.1}");
    }
    if let Some(order) = study.order() {
        let _ = write!(table, "\n\nMeasured order: {order:.2}");
    }
    if let Some(remark) = study.remark() {
        let _ = write!(table, "\n\n{remark}");
    }
    let locking = if moment == MeshMoment::AtRest && study.remark().is_none() { locking(level)? } else { Vec::new() };
    for number in &locking {
        let (poisson, ratio) = (number.poisson, number.ratio());
        let _ = write!(table, "\nLocking at nu = {poisson}: {ratio:.3} of the deflection of a better mesh");
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
    let mut table = format!(
        "{}, {} s simulated; energy over {:.3e} J, the greatest kinetic energy",
        level.name,
        drift.trial().seconds(),
        drift.scale()
    );
    for invariant in Invariant::ALL {
        let reasons = drift.changed_by(invariant).join(", ");
        let remark = drift.nothing_of(invariant).map(str::to_owned);
        let remark = remark.or_else(|| (!reasons.is_empty()).then(|| format!("changed by {reasons} by right")));
        // Writing to a string cannot fail.
        let _ = remark.map(|remark| write!(table, "\n{}: {remark}", invariant.title()));
    }
    let widest = drift.runs().iter().map(|run| run.setting.label().len()).max().unwrap_or(0);
    let _ =
        write!(table, "\n\n  {:<widest$}     energy   [kg m/s]  [kg m2/s]  energy at the end", "greatest change of");
    for run in drift.runs() {
        let [energy, linear, angular] = Invariant::ALL.map(|invariant| drift.greatest_change(run, invariant));
        let end = run.moments.last().map_or(0.0, |moment| drift.change(run, Invariant::Energy, moment));
        let end = if run.fault().is_some() { "unstable".to_owned() } else { format!("{:+.4} %", 100.0 * end) };
        let label = run.setting.label();
        let _ = write!(table, "\n  {label:<widest$}  {energy:>9.2e}  {linear:>9.2e}  {angular:>9.2e}  {end:>17}");
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
