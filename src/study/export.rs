//! Tables to take away: CSV with a head that says where the numbers come from.

use super::{Drift, Invariant, LockingNumber, MeshStudy, Outcome, Reference, Trial, WorkPrecision};
use crate::table::{Table, remark};
use std::sync::OnceLock;

/// Where numbers come from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Origin {
    /// Name and version of the package.
    pub package: String,
    /// Commit it was built from, or `unknown`.
    pub commit: String,
    /// The processor, or `unknown`.
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

/// The model name of the processor, where the system has a file that says it.
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

/// Whether a column holds measured times, which differ from run to run; all others repeat on every machine.
pub fn is_time_column(name: &str) -> bool {
    name.starts_with("ms_")
}

/// The lines that begin with `#`: the level, what else there is to say about the numbers, and where they come from.
pub fn head(level: &str, threads: usize, about: &[(&str, String)]) -> String {
    let Origin { package, commit, processor } = Origin::here();
    let origin = [("package", package), ("commit", commit), ("processor", processor)];
    let mut lines = vec![("level", level.to_owned())];
    lines.extend(about.iter().cloned());
    lines.extend(origin.map(|(name, value)| (name, value.clone())));
    lines.push(("threads", threads.to_string()));
    lines.iter().map(|(name, value)| remark(name, value)).collect()
}

/// The head of what was measured in a trial, with what is worth knowing about its start.
fn head_of(trial: &Trial, threads: usize, more: &[(&str, String)]) -> String {
    let mut about = vec![
        ("start_hash", format!("{:016x}", trial.start.hash())),
        ("vertices", (trial.start.x.len() / 2).to_string()),
        ("triangles", trial.scene.triangles.len().to_string()),
        ("simulated_seconds", trial.seconds().to_string()),
    ];
    about.extend(more.iter().cloned());
    about.extend(trial.scene.warnings(&trial.start).into_iter().map(|warning| ("warning", warning)));
    head(&trial.name, threads, &about)
}

impl WorkPrecision {
    /// The diagram as far as it is, as CSV: one line a point.
    pub fn csv(&self) -> String {
        let reference = self.reference().map_or("none yet".to_owned(), |reference| reference.source.to_string());
        let own = self.reference().map_or(f64::NAN, |reference| reference.own_error);
        let more = [
            ("reference", reference),
            ("reference_error_at_most", format!("{own:e}")),
            (
                "error",
                "relative RMS position error, sqrt(mean |x - x_ref|^2) / sqrt(mean |x_ref - x_start|^2)".to_owned(),
            ),
        ];
        let columns = [
            "integrator",
            "order",
            "measured_order",
            "substeps",
            "step_s",
            "tolerance",
            "current",
            "status",
            "error",
            "above_floor",
            "steps",
            "inner_steps",
            "rejected",
            "force_evaluations",
            "newton_iterations",
            "factorisations",
            "ms_per_simulated_s",
        ];
        let mut table = Table::new(head_of(self.trial(), self.plan().threads, &more), &columns);
        let floor = self.reference().map_or(0.0, Reference::floor);
        let optional = |number: Option<f64>| number.map_or(String::new(), |number| format!("{number:.4e}"));
        for curve in self.curves() {
            for point in &curve.points {
                let Some(Outcome { error, status, counts, ms_per_second }) = &point.outcome else { continue };
                let setting = &point.setting;
                table.row([
                    curve.integrator.name().to_owned(),
                    curve.integrator.kind().order().to_string(),
                    optional(curve.order),
                    setting.substeps.get().to_string(),
                    format!("{:e}", setting.substeps.step()),
                    optional(setting.tolerance()),
                    point.current.to_string(),
                    status.word().to_owned(),
                    format!("{error:e}"),
                    (*error > floor).to_string(),
                    counts.steps.to_string(),
                    counts.inner_steps.to_string(),
                    counts.rejected.to_string(),
                    counts.force_evaluations.to_string(),
                    counts.newton_iterations.to_string(),
                    counts.factorisations.to_string(),
                    format!("{ms_per_second:.4}"),
                ]);
            }
        }
        table.text()
    }
}

impl MeshStudy {
    /// The study as far as it is, as CSV: one line a mesh; how much the level locks stands in the head.
    pub fn csv(&self, locking: &[LockingNumber]) -> String {
        let reference =
            self.reference().map_or(String::from("none yet"), |(value, _)| format!("{value:e}, extrapolated"));
        let own = self.reference().map_or(f64::NAN, |(_, own)| own);
        let mut more = vec![
            ("quantity", format!("{} [{}]", self.plan().measure.title(), self.plan().measure.unit())),
            ("moment", self.plan().moment.to_string()),
            ("reference", reference),
            ("reference_error_at_most", format!("{own:e}")),
            ("measured_order", self.order().map_or(String::new(), |order| format!("{order:.3}"))),
        ];
        let ratio = |of: &LockingNumber| format!("{:e} of the tip deflection of a better mesh", of.ratio());
        more.extend(
            locking
                .iter()
                .map(|of| (if of.is_tight() { "locking_at_nu_0.4999" } else { "locking_at_nu_0.3" }, ratio(of))),
        );
        more.extend(self.remark().map(|remark| ("remark", remark.to_owned())));
        let columns = ["triangles", "vertices", "size_m", "status", "value", "error", "ms_of_computing"];
        let mut table = Table::new(head_of(self.trial(), self.plan().threads, &more), &columns);
        for point in self.points() {
            let Some(value) = point.value else { continue };
            table.row([
                point.triangles.to_string(),
                point.vertices.to_string(),
                format!("{:e}", point.size),
                point.status.word().to_owned(),
                format!("{value:e}"),
                format!("{:e}", self.error_of(point).unwrap_or(f64::NAN)),
                format!("{:.4}", point.ms),
            ]);
        }
        table.text()
    }
}

impl Drift {
    /// The courses as far as they are, as CSV: one line a moment of each.
    pub fn csv(&self) -> String {
        let more = [
            ("energy_change", "E(t) - E(0), over energy_scale_j".to_owned()),
            ("energy_scale_j", format!("{:e}, the greatest kinetic energy, median of the schemes", self.scale())),
            ("energy_is_changed_by", self.changed_by(Invariant::Energy).join(", ")),
            ("momentum_is_changed_by", self.changed_by(Invariant::Momentum).join(", ")),
        ];
        let columns = [
            "integrator",
            "substeps",
            "tolerance",
            "status",
            "time_s",
            "energy_j",
            "energy_change",
            "momentum_x",
            "momentum_y",
            "angular_momentum",
        ];
        let mut table = Table::new(head_of(self.trial(), self.threads(), &more), &columns);
        for run in self.runs() {
            for moment in &run.moments {
                let ([px, py], change) = (moment.momentum, self.change(run, Invariant::Energy, moment));
                table.row([
                    run.setting.integrator.name().to_owned(),
                    run.setting.substeps.get().to_string(),
                    run.setting.tolerance().map_or(String::new(), |tolerance| format!("{tolerance:e}")),
                    run.status().word().to_owned(),
                    format!("{:.6}", moment.time),
                    format!("{:e}", moment.energy),
                    format!("{change:e}"),
                    format!("{px:e}"),
                    format!("{py:e}"),
                    format!("{:e}", moment.angular),
                ]);
            }
        }
        table.text()
    }
}
