//! Report of a run: energies, counts and costs.

use super::{
    EndState,
    substep_report::{SubstepReport, substep_reports},
};
use crate::{
    files,
    level::{Level, RunMode, Switch, When},
    report::{EffectCost, Energies},
    simulation::Simulation,
    study::{Saving, Savings},
    terminal,
    untangle::Tangle,
};
use serde::Serialize;
use std::time::Duration;

/// Report of a run. Field names are stable.
#[derive(Debug, Serialize)]
pub struct RunReport {
    /// Title of the level.
    pub level: String,
    /// Warnings about how the level begins.
    pub warnings: Vec<String>,
    /// Which signal stopped the run, and after how many of how many steps; null if it came to its end.
    pub partial: Option<String>,
    /// Whether the state at the end is physical.
    pub end_state: EndState,
    /// Energies at the end [J].
    pub energy: EnergyReport,
    /// Least det F of all triangles at the end; null if there are none.
    pub min_j: Option<f64>,
    /// Number of triangles with det F <= 0 at the end.
    pub inverted: usize,
    /// Number of vertices at the end whose triangles do not go round them exactly once: folds.
    pub wound: usize,
    /// Number of triangles.
    pub triangles: usize,
    /// Number of vertices.
    pub vertices: usize,
    /// Length of a step [s].
    pub step_seconds: f64,
    /// How each body and net stepped that went at its own pace; empty if all took the same steps.
    pub paces: Vec<SubstepReport>,
    /// Steps taken.
    pub steps: u64,
    /// Simulated time at the end [s].
    pub time: f64,
    /// Evaluations of all forces together.
    pub force_evaluations: u64,
    /// Name of the integrator.
    pub integrator: &'static str,
    /// Steps inside the steps; more than `steps` if the integrator controls its error.
    pub inner_steps: u64,
    /// Steps inside the steps taken again, shorter, for their error.
    pub rejected_steps: u64,
    /// Iterations of Newton's method.
    pub newton_iterations: u64,
    /// Newton steps cut by the line search.
    pub line_search_cuts: u64,
    /// Sparse factorisations.
    pub factorisations: u64,
    /// Factorisations repeated with another matrix, as it was not positive definite.
    pub indefinite: u64,
    /// Steps whose equations were not solved to tolerance.
    pub unconverged_steps: u64,
    /// Iterations of conjugate gradients for linear systems.
    pub linear_iterations: u64,
    /// Linear systems solved with what had been factorised for an earlier one.
    pub reused_factors: u64,
    /// Solves whose linear systems were factorised after all, as iterations were too slow.
    pub abandoned_iterations: u64,
    /// Steps that the guard had taken in shorter ones.
    pub guarded_steps: u64,
    /// Steps that brought out what began inside a wall or beyond an edge of the world.
    pub pushed_out_steps: u64,
    /// Steps in which everything slept: they were not computed.
    pub slept_steps: u64,
    /// Their share of all steps; null if there were none.
    pub slept_share: Option<f64>,
    /// Triangles of bodies that were awake, summed over the steps: those that were computed.
    pub triangle_steps: u64,
    /// Share of all triangles times all steps that was not computed, as the bodies slept; null if there were none.
    pub slept_triangle_share: Option<f64>,
    /// Attempts at a step that the guard threw away.
    pub retaken_steps: u64,
    /// Time spent stepping, without clocks in the effects [s].
    pub wall_seconds: f64,
    /// Time per computed step [s]; null if none was computed.
    pub seconds_per_step: Option<f64>,
    /// Time per computed triangle and step [ns]; null if none was computed.
    pub ns_per_triangle_step: Option<f64>,
    /// What each effect cost, its times measured in a second run of the same steps; empty where no report is written.
    pub effects: Vec<EffectReport>,
    /// Fingerprint of the last positions and velocities, equal on every machine.
    pub state_hash: String,
    /// Why the run stopped early, if it did.
    pub fault: Option<String>,
}

impl RunReport {
    /// Report of a run that took `wall_seconds` [s].
    pub(super) fn new(level: &Level, simulation: &Simulation, wall_seconds: f64) -> Self {
        let (scene, state, counts) = (simulation.scene(), simulation.state(), simulation.counts());
        let (min_j, inverted) = simulation.inversion();
        let (triangles, steps) = (scene.triangles.len(), counts.steps);
        Self {
            level: level.name.clone(),
            warnings: Vec::new(),
            partial: None,
            end_state: EndState::default(),
            energy: simulation.energies().into(),
            min_j: (triangles > 0).then_some(min_j),
            inverted,
            wound: Tangle::of_all(scene, &state.x).wound,
            triangles,
            vertices: scene.vertices(),
            step_seconds: scene.step,
            paces: substep_reports(simulation),
            steps,
            time: state.time,
            force_evaluations: counts.force_evaluations,
            integrator: scene.integrator.name(),
            inner_steps: counts.inner_steps,
            rejected_steps: counts.rejected,
            newton_iterations: counts.newton_iterations,
            line_search_cuts: counts.line_search_cuts,
            factorisations: counts.factorisations,
            indefinite: counts.indefinite,
            unconverged_steps: counts.unconverged,
            linear_iterations: counts.linear_iterations,
            reused_factors: counts.reused_factors,
            abandoned_iterations: counts.abandoned_iterations,
            guarded_steps: counts.guarded,
            pushed_out_steps: counts.pushed_out,
            slept_steps: counts.slept,
            slept_share: ratio(counts.slept as f64, steps as f64),
            triangle_steps: counts.triangle_steps,
            slept_triangle_share: ratio(counts.triangle_steps as f64, triangles as f64 * steps as f64)
                .map(|computed| 1.0 - computed),
            retaken_steps: counts.retaken,
            wall_seconds,
            seconds_per_step: ratio(wall_seconds, counts.computed() as f64),
            ns_per_triangle_step: ratio(wall_seconds * 1e9, counts.triangle_steps as f64),
            effects: Vec::new(),
            state_hash: format!("{:016x}", state.hash()),
            fault: simulation.fault().map(ToString::to_string),
        }
    }

    /// Sets the costs of the effects from a run with clocks.
    pub(super) fn set_effects(&mut self, level: &Level, timed: &Simulation) {
        self.effects = ledger(level, timed, &measured(level));
    }
}

impl std::fmt::Display for RunReport {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { level, steps, time, wall_seconds, energy, slept_steps, .. } = self;
        let plural = if *steps == 1 { "" } else { "s" };
        let level = terminal::line(level);
        write!(out, "{level}: {steps} step{plural} to {time:.4} s in {wall_seconds:.3} s")?;
        match (self.seconds_per_step, self.ns_per_triangle_step) {
            (Some(_), Some(each)) => write!(out, " ({each:.1} ns per computed triangle and step)")?,
            (Some(step), None) => write!(out, " ({:.2} µs per computed step)", 1e6 * step)?,
            (None, _) => write!(out, " (no step computed)")?,
        }
        if let Some(share) = self.slept_share.filter(|_| *slept_steps > 0) {
            write!(out, "; {slept_steps} of {steps} steps slept ({:.1} %)", 100.0 * share)?;
        }
        if let Some(share) = self.slept_triangle_share.filter(|share| Some(*share) != self.slept_share) {
            write!(out, "; {:.1} % of triangles times steps slept", 100.0 * share)?;
        }
        write!(out, "; energy {:.6} J", energy.total)?;
        if let Some(min_j) = self.min_j {
            write!(out, ", smallest J {min_j:.4}")?;
        }
        write!(out, ", state {}", self.state_hash)
    }
}

/// Energies [J].
#[derive(Debug, Serialize)]
pub struct EnergyReport {
    /// Of motion.
    pub kinetic: f64,
    /// Of deformation.
    pub elastic: f64,
    /// Of gravity and springs.
    pub potential: f64,
    /// The sum.
    pub total: f64,
}

/// Cost of one effect.
#[derive(Debug, Serialize)]
pub struct EffectReport {
    /// Name of the effect.
    pub name: &'static str,
    /// `On`, `Auto` or `Off`.
    pub switch: Switch,
    /// Time spent in it [s].
    pub seconds: f64,
    /// The same in a frame of 1/60 s of simulated time in which it was computed [ms]; null if all steps slept.
    pub ms_per_frame: Option<f64>,
    /// Its share of the time spent in all effects.
    pub share: f64,
    /// Number of calls.
    pub calls: u64,
    /// Elements touched, summed over the calls.
    pub elements: u64,
    /// How often it was passed over.
    pub skipped: u64,
    /// Steps in which what it acts on slept: they do not count for `ms_per_frame`.
    pub slept_steps: u64,
    /// Why it was passed over, if it was when it last could have been called.
    pub reason: Option<&'static str>,
    /// What passing it over saves [ms in a frame], measured beside the run against everything forced, from the start of the
    /// run on; null if it is not there.
    pub saved_ms_per_frame: Option<f64>,
}

/// Quotient. `None` if the divisor is not positive.
fn ratio(of: f64, by: f64) -> Option<f64> {
    (by > 0.0).then(|| of / by)
}

/// Savings by skipped effects at the start of a run.
fn measured(level: &Level) -> Vec<Saving> {
    const BUDGET: Duration = Duration::from_millis(300);
    let savings = Savings::new(level, &files::Disk).map(|mut savings| {
        savings.advance(BUDGET);
        savings.each()
    });
    // The level was built before, so an error is not expected.
    savings.unwrap_or_default()
}

/// Rows of the active effects, elements first, then of those switched off or meant for another mode.
fn ledger(level: &Level, simulation: &Simulation, savings: &[Saving]) -> Vec<EffectReport> {
    let frames = |slept: u64| 60.0 * simulation.scene().step * (simulation.counts().steps - slept) as f64;
    let all: f64 = simulation.costs().iter().map(|cost| cost.time.as_secs_f64()).sum();
    let row = |(number, cost): (usize, &EffectCost)| EffectReport {
        name: cost.name,
        switch: if cost.auto { Switch::Auto } else { Switch::On },
        seconds: cost.time.as_secs_f64(),
        ms_per_frame: ratio(1e3 * cost.time.as_secs_f64(), frames(cost.slept)),
        share: if all > 0.0 { cost.time.as_secs_f64() / all } else { 0.0 },
        calls: cost.calls,
        elements: cost.elements,
        skipped: cost.skipped,
        slept_steps: cost.slept,
        reason: cost.idle,
        saved_ms_per_frame: savings.get(number).map(|saving| 1e3 * saving.saved()),
    };
    let there = simulation.costs().iter().enumerate().map(row);
    let absent = level
        .effects
        .iter()
        .filter(|listed| !listed.switch.is_on() || (listed.when == When::Collide && level.mode == RunMode::Simulate));
    let absent = absent.map(|listed| EffectReport {
        switch: Switch::Off,
        saved_ms_per_frame: None,
        ..row((usize::MAX, &EffectCost::none(listed.effect.kind().title(), false)))
    });
    there.chain(absent).collect()
}

impl From<Energies> for EnergyReport {
    fn from(energies: Energies) -> Self {
        let Energies { kinetic, elastic, potential } = energies;
        Self { kinetic, elastic, potential, total: energies.total() }
    }
}
