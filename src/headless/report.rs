//! Report of a run: energies, counts, costs and step lengths; and whether its end state is physical.

use crate::{
    files,
    inversion_recovery::Tangle,
    level::{Check, Level, Switch},
    report::{EffectCost, Energies, SubstepPlan},
    simulation::{PlacedCheck, Simulation},
    study::{Saving, Savings},
    terminal,
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
    /// Energies at the end \[J\].
    pub energy: EnergyReport,
    /// Least det F of all triangles at the end; null if there are none.
    pub min_j: Option<f64>,
    /// Number of triangles with det F <= 0 at the end.
    pub inverted: usize,
    /// Number of vertices at the end whose triangles do not go round them exactly once: folds.
    pub wound: usize,
    /// Number of bodies whose elastic forces balance at the end in another shape than at rest, without folds.
    pub metastable: usize,
    /// Number of triangles.
    pub triangles: usize,
    /// Number of vertices.
    pub vertices: usize,
    /// Length of a step \[s\].
    pub step_seconds: f64,
    /// How each body and net stepped that went at its own pace; empty if all took the same steps.
    pub paces: Vec<SubstepReport>,
    /// Steps taken.
    pub steps: u64,
    /// Simulated time at the end \[s\].
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
    /// Crossings of the surfaces of bodies or of cloth at the end, by an exact test; null for bodies if contact has no potential.
    pub crossings: Option<usize>,
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
    /// Work of moving obstacles, moving pins, wind and rain, and of projection where it adds energy \[J\].
    pub obstacle_work_joules: f64,
    /// Energy that truncation of steps, projection and the filter of positions dissipated \[J\].
    pub truncated_joules: f64,
    /// Time spent stepping, without clocks in the effects \[s\].
    pub wall_seconds: f64,
    /// Time per computed step \[s\]; null if none was computed.
    pub seconds_per_step: Option<f64>,
    /// Time per computed triangle and step \[ns\]; null if none was computed.
    pub ns_per_triangle_step: Option<f64>,
    /// What each effect cost, its times measured in a second run of the same steps; empty where no report is written.
    pub effects: Vec<EffectReport>,
    /// Fingerprint of the last positions and velocities, equal on every machine.
    pub state_hash: String,
    /// Whether the state at the recorded end of the level was the recorded one, bit for bit; null if the end was not reached, or nothing was recorded.
    pub replayed: Option<bool>,
    /// The known results of the level.
    pub checks: Vec<CheckReport>,
    /// Why the run stopped early, if it did.
    pub fault: Option<String>,
}

impl RunReport {
    /// Report of a run that took `wall_seconds` \[s\].
    pub(super) fn new(level: &Level, simulation: &Simulation, wall_seconds: f64) -> Self {
        let (scene, state, counts) = (simulation.scene(), simulation.state(), simulation.counts());
        let (min_j, inverted) = simulation.inversion();
        let (triangles, steps) = (scene.triangles.len(), counts.steps);
        let tangle = Tangle::of_all(scene, &state.x);
        Self {
            level: level.name.clone(),
            warnings: Vec::new(),
            partial: None,
            end_state: EndState::default(),
            energy: simulation.energies().into(),
            min_j: (triangles > 0).then_some(min_j),
            inverted,
            wound: tangle.wound,
            metastable: tangle.metastable,
            crossings: simulation.count_crossings().or_else(|| simulation.count_cloth_crossings()),
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
            obstacle_work_joules: simulation.work_of_obstacles(),
            truncated_joules: counts.truncated_energy,
            wall_seconds,
            seconds_per_step: ratio(wall_seconds, counts.computed() as f64),
            ns_per_triangle_step: ratio(wall_seconds * 1e9, counts.triangle_steps as f64),
            effects: Vec::new(),
            state_hash: format!("{:016x}", state.hash()),
            replayed: simulation.replayed(),
            checks: simulation.checks().map(CheckReport::new).collect(),
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
        match self.crossings {
            None => {}
            Some(0) => write!(out, ", no crossing")?,
            Some(1) => write!(out, ", 1 crossing")?,
            Some(many) => write!(out, ", {many} crossings")?,
        }
        write!(out, ", state {}", self.state_hash)?;
        match self.replayed {
            None => {}
            Some(true) => write!(out, "; replay: the recorded state")?,
            Some(false) => write!(out, "; replay: not the recorded state")?,
        }
        self.checks.iter().try_for_each(|check| write!(out, "\n  {check}"))
    }
}

/// A known result of a level.
#[derive(Debug, Serialize)]
pub struct CheckReport {
    /// What it is.
    pub name: String,
    /// When it is measured \[s\].
    pub at: f64,
    /// Its unit.
    pub unit: &'static str,
    /// The known value.
    pub value: f64,
    /// How far the measured value may be from it.
    pub tolerance: f64,
    /// Formula or publication that the value is from.
    pub source: String,
    /// What was measured; null if the run did not pass that time.
    pub measured: Option<f64>,
    /// Whether that is within the tolerance; null if nothing was measured.
    pub met: Option<bool>,
}

impl CheckReport {
    fn new((placed, measured): (&PlacedCheck, Option<f64>)) -> Self {
        let Check { name, at, value, tolerance, source, .. } = placed.check.clone();
        let met = measured.map(|measured| placed.is_met(measured));
        let (at, value, tolerance) = (at.get(), value.get(), tolerance.get());
        Self { name, at, unit: placed.unit, value, tolerance, source, measured, met }
    }
}

/// Number of decimals that show five significant digits.
fn significant(value: f64) -> usize {
    if value == 0.0 { 0 } else { (4.0 - value.abs().log10().floor()).clamp(0.0, 12.0) as usize }
}

impl std::fmt::Display for CheckReport {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { name, at, unit, value, tolerance, measured, met, .. } = self;
        let name = terminal::line(name);
        let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
        match (measured, met) {
            (Some(measured), Some(met)) => {
                let verdict = if *met { "met" } else { "missed" };
                let digits = significant(*measured);
                write!(out, "{name}: {measured:.digits$}{unit} at {at} s, known {value} ± {tolerance}{unit}: {verdict}")
            }
            _ => write!(out, "{name}: known {value} ± {tolerance}{unit} at {at} s, which this run did not pass"),
        }
    }
}

/// Energies \[J\].
#[derive(Debug, Serialize)]
pub struct EnergyReport {
    /// Of motion.
    pub kinetic: f64,
    /// Of deformation.
    pub elastic: f64,
    /// Of contact.
    pub contact: f64,
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
    /// Time spent in it \[s\].
    pub seconds: f64,
    /// The same in a frame of 1/60 s of simulated time in which it was computed \[ms\]; null if all steps slept.
    pub ms_per_frame: Option<f64>,
    /// Its share of the time spent in all effects.
    pub share: f64,
    /// Energy that it dissipated \[J\].
    pub heat_joules: f64,
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
        heat_joules: cost.heat,
        calls: cost.calls,
        elements: cost.elements,
        skipped: cost.skipped,
        slept_steps: cost.slept,
        reason: cost.idle,
        saved_ms_per_frame: savings.get(number).map(|saving| 1e3 * saving.saved()),
    };
    let there = simulation.costs().iter().enumerate().map(row);
    let absent = level.effects.iter().filter(|listed| !listed.acts_in(level.mode));
    let absent = absent.map(|listed| EffectReport {
        switch: Switch::Off,
        saved_ms_per_frame: None,
        ..row((usize::MAX, &EffectCost::none(listed.effect.kind().title(), false)))
    });
    there.chain(absent).collect()
}

impl From<Energies> for EnergyReport {
    fn from(energies: Energies) -> Self {
        let Energies { kinetic, elastic, contact, potential } = energies;
        Self { kinetic, elastic, contact, potential, total: energies.total() }
    }
}

/// Substeps of a body or net that was stepped at its own pace.
#[derive(Debug, Serialize)]
pub struct SubstepReport {
    /// Name of the body or net.
    pub name: String,
    /// In how many equal parts it took every step.
    pub steps: u32,
    /// Length of a part \[s\].
    pub step_seconds: f64,
    /// Its longest stable step at rest under symplectic Euler \[s\]; null if nothing in it is stiff.
    pub critical_step_seconds: Option<f64>,
}

/// Reports of the bodies, of the nets and of the membranes. Empty if all took the same steps.
fn substep_reports(simulation: &Simulation) -> Vec<SubstepReport> {
    let scene = simulation.scene();
    let names = scene.part_names();
    let row = |(name, plan): (&String, SubstepPlan)| SubstepReport {
        name: name.clone(),
        steps: plan.steps,
        step_seconds: plan.step,
        critical_step_seconds: plan.limit,
    };
    names.zip(simulation.substep_plans()).map(row).collect()
}

/// Greatest |det F| of a physical end state: a hundredfold stretch along both axes.
pub const GREATEST_J: f64 = 1e4;

/// Greatest relative energy gain of a physical end state.
/// It is relative to the kinetic and elastic energy at the start plus the energy stored at a strain of 1.
pub const GREATEST_GAIN: f64 = 1e5;

/// Start state of a run.
pub struct Beginning {
    /// det F of every triangle, body after body.
    ratios: Vec<f64>,
    energies: Energies,
    /// Elastic energy at a strain of about 1 \[J\].
    scale: f64,
}

/// Report of the end state of a run. Field names are stable.
#[derive(Debug, Default, PartialEq, Serialize)]
pub struct EndState {
    /// Whether the state is physical: everything is finite, neither energy nor det F is absurd, and no triangle is inverted that was
    /// not at the start. Otherwise the exit code is 3.
    pub physical: bool,
    /// Number of triangles inverted at the end that were not at the start.
    pub newly_inverted: usize,
    /// Number of triangles inverted both at the start and at the end.
    pub still_inverted: usize,
    /// Total energy at the end less that at the start \[J\]; null if it is not finite.
    pub energy_gain: f64,
    /// What is wrong or worth knowing, each a sentence.
    pub remarks: Vec<String>,
}

impl Beginning {
    /// Start state of a simulation before its first step.
    pub fn of(simulation: &Simulation) -> Self {
        let scene = simulation.scene();
        let scale = scene.parts.iter().map(|part| part.energy_scales()[1]).sum();
        Self { ratios: ratios(simulation), energies: simulation.energies(), scale }
    }
}

/// det F of every triangle, body after body.
fn ratios(simulation: &Simulation) -> Vec<f64> {
    let x = &simulation.state().x;
    simulation.scene().bodies.iter().flat_map(|body| body.elements.volume_ratios(x)).collect()
}

/// Name of a triangle of the whole scene in plain words.
fn name(simulation: &Simulation, triangle: usize) -> String {
    let mut first = 0;
    for body in &simulation.scene().bodies {
        let count = body.elements.corners().len();
        if triangle < first + count {
            return format!("triangle {} of {}", body.mesh.numbering().element_name(triangle - first), body.name);
        }
        first += count;
    }
    format!("triangle {triangle}")
}

impl EndState {
    /// Report of the present state of a simulation.
    pub fn of(beginning: &Beginning, simulation: &Simulation) -> Self {
        let (scene, state, now) = (simulation.scene(), simulation.state(), simulation.energies());
        let ratios = ratios(simulation);
        let mut remarks = Vec::new();
        let finite = |values: &[f64]| values.iter().all(|value| value.is_finite());
        if !(finite(&state.x) && finite(&state.v) && now.total().is_finite() && finite(&ratios)) {
            remarks.push("positions, velocities or energies are not finite numbers".to_owned());
        }
        let energy_gain = now.total() - beginning.energies.total();
        let own = beginning.energies.kinetic + beginning.energies.elastic.abs() + beginning.scale;
        // A long fall gains a small share of the potential energy lost. That is the error of a scheme, not an
        // explosion.
        let falling = 1e-2 * (now.external() - beginning.energies.external()).abs();
        if scene.toy.is_none() && energy_gain > GREATEST_GAIN * own + falling {
            remarks.push(format!(
                "the energy grew by {energy_gain:.3e} J, which is {:.0e} times what the scene had",
                energy_gain / own
            ));
        }
        let both = || beginning.ratios.iter().zip(&ratios).enumerate();
        let absurd = both().filter(|(_, (start, end))| end.abs() > GREATEST_J * start.abs().max(1.0));
        if let Some((worst, (_, j))) = absurd.max_by(|(_, (_, a)), (_, (_, b))| a.abs().total_cmp(&b.abs())) {
            remarks.push(format!("{} has J = {j:.3e}, an absurd size", name(simulation, worst)));
        }
        let newly: Vec<_> = both().filter(|(_, (start, end))| **start > 0.0 && **end <= 0.0).collect();
        if let Some((worst, (_, j))) = newly.iter().min_by(|(_, (_, a)), (_, (_, b))| a.total_cmp(b)) {
            let worst = name(simulation, *worst);
            remarks.push(match newly.len() {
                1 => format!("{worst} is inverted (J = {j:.3e}) and was not at the start"),
                many => format!(
                    "{many} triangles are inverted that were not at the start; {worst} has the least J = {j:.3e}"
                ),
            });
        }
        let physical = remarks.is_empty();
        if !physical {
            remarks.push(
                "take more substeps or an implicit integrator, or a model that resists inversion, such as StableNeoHookean"
                    .to_owned(),
            );
        }
        let still: Vec<_> = both().filter(|(_, (start, end))| **start <= 0.0 && **end <= 0.0).collect();
        if let Some((first, (_, j))) = still.first() {
            let (first, verb) = (name(simulation, *first), if still.len() == 1 { "was" } else { "were" });
            let count = if still.len() == 1 { "1 triangle".to_owned() } else { format!("{} triangles", still.len()) };
            remarks.push(format!(
                "{count} inverted at the end {verb} inverted at the start already; the first is {first} (J = {j:.3e}); \
                 --untangle puts such bodies where they are free of folds"
            ));
        }
        Self { physical, newly_inverted: newly.len(), still_inverted: still.len(), energy_gain, remarks }
    }

    /// Message for standard error in one line. `None` if there is nothing to report.
    pub fn sentence(&self) -> Option<String> {
        let what = if self.physical { "the end state" } else { "the end state is not physical" };
        (!self.remarks.is_empty()).then(|| format!("{what}: {}", self.remarks.join("; ")))
    }
}
