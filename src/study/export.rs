//! CSV tables of the studies, and their header lines: level, commit and machine.

use super::{
    Dial, Drift, ErrorBudget, ErrorSource, Invariant, LockingNumber, MOST_RUNS, MeasuredOrder, MeshStudy, Outcome,
    Reached, Status, Trial, WorkPrecision, order_in_words,
};
use crate::clock::CLOCK;
use crate::table::{Table, remark};
use std::sync::OnceLock;

/// Origin of exported numbers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Origin {
    /// Name and version of the package.
    pub package: String,
    /// Commit of the build, or `unknown`.
    pub commit: String,
    /// Model name of the processor, or `unknown`.
    pub processor: String,
}

impl Origin {
    /// This program on this machine.
    pub fn here() -> &'static Self {
        static HERE: OnceLock<Origin> = OnceLock::new();
        let unknown = || "unknown".to_owned();
        HERE.get_or_init(|| Self {
            package: format!("{} {}", env!("CARGO_PKG_NAME"), env!("CARGO_PKG_VERSION")),
            commit: option_env!("GINGERBREAD_COMMIT").map_or_else(unknown, str::to_owned),
            processor: processor().unwrap_or_else(unknown),
        })
    }
}

/// Model name of the processor, if the system has `/proc/cpuinfo`.
#[cfg(not(target_arch = "wasm32"))]
fn processor() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

#[cfg(target_arch = "wasm32")]
fn processor() -> Option<String> {
    None
}

/// Whether a column holds measured times. They differ from run to run; all other columns are equal on every machine.
pub fn is_time_column(name: &str) -> bool {
    name.starts_with("ms_")
}

/// Header lines, which begin with `#`: the level, the entries of `about`, the origin and the number of threads.
pub fn head(level: &str, threads: usize, about: &[(&str, String)]) -> String {
    let Origin { package, commit, processor } = Origin::here();
    let origin = [("package", package), ("commit", commit), ("processor", processor)];
    let mut lines = vec![("level", level.to_owned())];
    lines.extend(about.iter().cloned());
    lines.extend(origin.map(|(name, value)| (name, value.clone())));
    lines.push(("threads", threads.to_string()));
    lines.iter().map(|(name, value)| remark(name, value)).collect()
}

/// Definition of the values in columns of times.
pub fn price_in_words() -> String {
    format!("{CLOCK}, least of 1 to {MOST_RUNS} runs: short ones are repeated in turns")
}

/// Columns of a measured order: the number, and the reason if there is none.
fn order_columns(order: &MeasuredOrder) -> [String; 2] {
    match order {
        Ok(order) => [format!("{order:.4}"), String::new()],
        Err(reason) => [String::new(), format!("not measurable here: {reason}")],
    }
}

/// Number as text; empty if it is not finite.
fn finite(number: f64) -> String {
    if number.is_finite() { format!("{number:e}") } else { String::new() }
}

/// Header of a table about a trial, with the data of its start.
fn head_of(trial: &Trial, threads: usize, more: &[(&str, String)]) -> String {
    let mut about = vec![
        ("start_hash", format!("{:016x}", trial.start.hash())),
        ("vertices", trial.scene.vertices().to_string()),
        ("triangles", trial.scene.triangles.len().to_string()),
        ("simulated_seconds", trial.seconds().to_string()),
    ];
    about.extend(more.iter().cloned());
    about.extend(trial.scene.warnings(&trial.start).into_iter().map(|warning| ("warning", warning)));
    head(&trial.name, threads, &about)
}

impl WorkPrecision {
    /// Diagram so far as CSV, one row per point.
    pub fn csv(&self) -> String {
        let reference = self.reference().map_or("none yet".to_owned(), |reference| reference.source.to_string());
        let told = self.reference().filter(|reference| !reference.is_still());
        let [own, motion] = [told.map(|reference| reference.own_error), self.reference().map(|known| known.motion)]
            .map(|number| number.map_or_else(String::new, finite));
        let mut more = vec![
            ("reference", reference),
            ("reference_error_at_most", own),
            ("reference_motion_m", motion),
            (
                "error",
                "relative RMS position error, mean over frames and vertices: \
                 sqrt(mean |x - x_ref|^2) / sqrt(mean |x_ref - x_start|^2)"
                    .to_owned(),
            ),
            ("greatest_error", "the largest over frames of the RMS over vertices, over the same motion".to_owned()),
            ("ms_per_simulated_s", price_in_words()),
        ];
        more.extend(self.no_errors().map(|why| ("remark", why.to_string())));
        let columns = [
            "integrator",
            "order",
            "measured_order",
            "order_remark",
            "substeps",
            "step_s",
            "tolerance",
            "current",
            "status",
            "error",
            "greatest_error",
            "above_floor",
            "error_remark",
            "steps",
            "inner_steps",
            "rejected",
            "force_evaluations",
            "newton_iterations",
            "factorisations",
            "ms_per_simulated_s",
            "ms_least_of_runs",
        ];
        let mut table = Table::new(head_of(self.trial(), self.plan().threads, &more), &columns);
        let optional = |number: Option<f64>| number.map_or(String::new(), |number| format!("{number:.4e}"));
        for curve in self.curves() {
            let [order, order_remark] = order_columns(&curve.order);
            for point in &curve.points {
                let Some(outcome) = &point.outcome else { continue };
                let Outcome { error, greatest_error, status, counts, ms_per_second, runs, .. } = outcome;
                let note =
                    self.reference().filter(|_| *status != Status::Unstable).map(|known| known.limits().note(*error));
                let remark = note.flatten().map_or("", |note| note.words());
                let setting = &point.setting;
                table.row([
                    curve.integrator.name().to_owned(),
                    curve.integrator.kind().order().to_string(),
                    order.clone(),
                    order_remark.clone(),
                    setting.substeps.get().to_string(),
                    format!("{:e}", setting.substeps.step()),
                    optional(setting.tolerance()),
                    point.current.to_string(),
                    status.word().to_owned(),
                    finite(*error),
                    finite(*greatest_error),
                    (note == Some(None)).to_string(),
                    remark.to_owned(),
                    counts.steps.to_string(),
                    counts.inner_steps.to_string(),
                    counts.rejected.to_string(),
                    counts.force_evaluations.to_string(),
                    counts.newton_iterations.to_string(),
                    counts.factorisations.to_string(),
                    format!("{ms_per_second:.4}"),
                    runs.to_string(),
                ]);
            }
        }
        table.text()
    }
}

impl Dial {
    /// Dial so far as CSV, one row per wanted error and scheme.
    pub fn csv(&self) -> String {
        let reference = self.reference().map_or("none yet".to_owned(), |reference| reference.source.to_string());
        let own = self.reference().map_or_else(String::new, |reference| finite(reference.own_error));
        let mut more = vec![
            ("reference", reference),
            ("reference_error_at_most", own),
            (
                "usual_error",
                "what 95 % of the frames are within: RMS over vertices, over the RMS motion of all frames".to_owned(),
            ),
            ("ms_per_simulated_s", price_in_words()),
        ];
        more.extend(self.no_errors().map(|why| ("remark", why.to_string())));
        let columns = [
            "wanted",
            "integrator",
            "reached",
            "substeps",
            "tolerance",
            "usual_error",
            "error",
            "greatest_error",
            "force_evaluations",
            "factorisations",
            "ms_per_simulated_s",
            "ms_least_of_runs",
        ];
        let mut table = Table::new(head_of(self.trial(), self.plan().threads, &more), &columns);
        for wanted in &self.plan().wanted {
            for (integrator, reached) in self.reached(*wanted) {
                let named = [wanted.to_string(), integrator.name().to_owned(), reached.is_some().to_string()];
                let Some(Reached { setting, outcome }) = reached else {
                    table.row(named.into_iter().chain(std::iter::repeat_n(String::new(), columns.len() - 3)));
                    continue;
                };
                table.row(named.into_iter().chain([
                    setting.substeps.get().to_string(),
                    setting.tolerance().map_or_else(String::new, |tolerance| format!("{tolerance:.4e}")),
                    finite(outcome.usual_error),
                    finite(outcome.error),
                    finite(outcome.greatest_error),
                    outcome.counts.force_evaluations.to_string(),
                    outcome.counts.factorisations.to_string(),
                    format!("{:.4}", outcome.ms_per_second),
                    outcome.runs.to_string(),
                ]));
            }
        }
        table.text()
    }
}

impl ErrorBudget {
    /// Budget so far as CSV, one row per source.
    pub fn csv(&self) -> String {
        let number = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:.6e}"));
        let about = [
            ("simulated_seconds", self.seconds().to_string()),
            ("ms_per_simulated_s", self.ms_per_second().map_or_else(String::new, |ms| format!("{ms:.4}"))),
            ("moved", "relative distance of the run from that of the level as it is".to_owned()),
            ("ms_price", "processor time as a multiple of that of the level as it is".to_owned()),
        ];
        let columns = ["source", "change", "moved", "error", "ms_price", "trouble"];
        let mut table = Table::new(head(self.name(), self.threads(), &about), &columns);
        for ErrorSource { name, change, moved, error, price, trouble, .. } in self.sources() {
            let trouble = trouble.clone().unwrap_or_default();
            table.row([name.clone(), change.clone(), number(*moved), number(*error), number(*price), trouble]);
        }
        table.text()
    }
}

impl MeshStudy {
    /// Study so far as CSV, one row per mesh. The header holds the locking numbers.
    pub fn csv(&self, locking: &[LockingNumber]) -> String {
        let reference = match self.reference() {
            None => String::from("none yet"),
            Some(Ok(of)) => {
                format!("{:e}, extrapolated with order {:.3} of the three finest meshes", of.value, of.order)
            }
            Some(Err(why)) => why.to_string(),
        };
        let own = self.reference().and_then(Result::ok).map_or(f64::NAN, |reference| reference.own_error);
        let mut more = vec![
            ("quantity", format!("{} [{}]", self.plan().measure.title(), self.plan().measure.unit())),
            ("moment", self.plan().moment.to_string()),
            ("reference", reference),
            ("reference_error_estimate", finite(own)),
            ("ms_of_computing", price_in_words()),
        ];
        for series in self.series() {
            let order = order_in_words(&self.order(series));
            let word = series.word();
            more.push(("measured_order", if word.is_empty() { order } else { format!("{word}: {order}") }));
        }
        let name = |of: &LockingNumber| if of.is_tight() { "locking_at_nu_0.4999" } else { "locking_at_nu_0.3" };
        more.extend(locking.iter().map(|of| (name(of), of.words())));
        let columns = [
            "element",
            "refinement",
            "triangles",
            "vertices",
            "size_m",
            "status",
            "value",
            "error",
            "ms_of_computing",
            "ms_least_of_runs",
        ];
        let mut table = Table::new(head_of(self.trial(), self.plan().threads, &more), &columns);
        for point in self.points() {
            let Some(value) = point.value else { continue };
            table.row([
                point.series.element.map_or_else(String::new, |kind| format!("{kind:?}")),
                format!("{:?}", point.series.refinement),
                point.triangles.to_string(),
                point.vertices.to_string(),
                format!("{:e}", point.size),
                point.status.word().to_owned(),
                format!("{value:e}"),
                self.error_of(point).map_or_else(String::new, finite),
                format!("{:.4}", point.ms),
                point.runs.to_string(),
            ]);
        }
        table.text()
    }
}

impl Drift {
    /// Runs so far as CSV, one row per moment of each run.
    pub fn csv(&self) -> String {
        let nothing = self.nothing_of(Invariant::Energy);
        let mut more = vec![
            ("energy_change", "E(t) - E(0), over energy_scale_j".to_owned()),
            ("energy_scale_j", format!("{:e}, the greatest kinetic energy, median of the schemes", self.scale())),
            ("energy_is_changed_by", self.changed_by(Invariant::Energy).join(", ")),
            ("momentum_is_changed_by", self.changed_by(Invariant::Momentum).join(", ")),
            (
                "touches_walls",
                "whether walls changed energy and momentum too; nothing where a scheme is unstable".to_owned(),
            ),
        ];
        for (integrator, order) in self.orders() {
            more.push(("order_of_energy_change", format!("{}: {}", integrator.name(), order_in_words(&order))));
        }
        more.extend(nothing.map(|why| ("remark", why.to_owned())));
        let columns = [
            "integrator",
            "substeps",
            "tolerance",
            "status",
            "touches_walls",
            "time_s",
            "energy_j",
            "energy_change",
            "momentum_x",
            "momentum_y",
            "angular_momentum",
        ];
        let in_space = self.trial().scene.dimension == 3;
        let more_columns = ["momentum_z", "angular_momentum_x", "angular_momentum_y"];
        let columns: Vec<_> = columns.into_iter().chain(more_columns.into_iter().filter(|_| in_space)).collect();
        let mut table = Table::new(head_of(self.trial(), self.threads(), &more), &columns);
        for run in self.runs() {
            let tolerance = run.setting.tolerance().map_or(String::new(), |tolerance| format!("{tolerance:e}"));
            let status = self.status(run);
            let walls = if status == Status::Unstable { String::new() } else { run.touches().to_string() };
            for moment in &run.moments {
                let ([px, py, pz], [lx, ly, lz]) = (moment.momentum, moment.angular);
                let change = nothing.is_none().then(|| self.change(run, Invariant::Energy, moment));
                let row = [
                    run.setting.integrator.name().to_owned(),
                    run.setting.substeps.get().to_string(),
                    tolerance.clone(),
                    status.word().to_owned(),
                    walls.clone(),
                    format!("{:.6}", moment.time),
                    format!("{:e}", moment.energy),
                    change.map_or_else(String::new, finite),
                    format!("{px:e}"),
                    format!("{py:e}"),
                    format!("{lz:e}"),
                ];
                let more = [pz, lx, ly].into_iter().filter(|_| in_space).map(|number| format!("{number:e}"));
                table.row(row.into_iter().chain(more));
            }
        }
        table.text()
    }
}
